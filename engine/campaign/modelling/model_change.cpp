// SPDX-License-Identifier: Apache-2.0
#include "campaign/modelling/model_change.h"

#include <algorithm>
#include <utility>

#include "campaign/modelling/held_terms.h"
#include "campaign/modelling/model_edit.h"
#include "campaign/modelling/model_history.h"
#include "platform/storage/digest.h"
#include "platform/storage/files.h"

namespace nonio::modelling {
namespace fs = std::filesystem;

namespace {

/// Returns nullopt if no measurement shows the effect, or not that of `edit.part`. The catalog takes time, so it is made only
/// if the model cannot be fitted or does not contain the effect.
Expected<std::optional<Compared>> compare_axis(const reading::ReadCampaign& read,
                                               const std::vector<std::string>& effects,
                                               const ModelEdit& edit) {
  const std::string& effect = edit.effect;
  if (auto right = without_mistakes(effects, read); !right) return fail(right.error());
  const bool has = find_effect(effects, effect) != nullptr;
  for (PartModel& part : bare_parts(read)) {
    set_model(part, effects, read);
    if (has && part.unfit.empty())
      fill_interpolated(part, read);
    else
      fill_catalogue(part, read);
    if (!part.shows(effect) || (!edit.part.empty() && part.part.name != edit.part)) continue;
    NONIO_TRY(auto comparison, compare_part(part));
    return Compared{std::move(part), std::move(comparison)};
  }
  return std::nullopt;
}

ModelStep step_of(const Change& change, const std::string& effect, bool add) {
  ModelStep step{.effect = effect, .added = add};
  for (const auto* side : {&change.before, &change.after})
    if (*side) {
      step.quantity = (*side)->part.deviation();
      if ((*side)->comparison.floor) step.floor = (*side)->comparison.floor->s;
    }
  if (change.before) {
    step.rms_before = change.before->comparison.fit.rms;
    step.cv_before = change.before->comparison.cv_rms;
  }
  if (change.after) {
    step.rms_after = change.after->comparison.fit.rms;
    step.cv_after = change.after->comparison.cv_rms;
  }
  return step;
}

/// Returns an error if campaign.toml is a link or has changed since it was read.
Expected<std::string> unchanged_manifest(const fs::path& folder,
                                         const reading::ReadCampaign& read) {
  std::error_code error;
  if (fs::is_symlink(folder / config::manifest_name, error))
    return fail(
        Error{"is a link; expected the file itself, which is written anew", config::manifest_name});
  auto text = storage::read_file(folder / config::manifest_name);
  if (text && storage::sha256(*text) != read.inputs.front().second)
    return fail(
        Error{"changed while the model was fitted; nothing was written", config::manifest_name});
  return text;
}

Expected<void> write(const fs::path& folder, const reading::ReadCampaign& read,
                     const CampaignEdit& edit, const std::vector<Change>& changes) {
  NONIO_TRY(const auto text, unchanged_manifest(folder, read));
  NONIO_TRY(auto edited, edited_manifest(text, edit));
  std::string history;
  std::error_code error;
  if (fs::exists(folder / history_name, error)) {
    NONIO_TRY(const auto old, storage::read_file(folder / history_name));
    if (const auto sound = parse_history(old); !sound) return fail(sound.error());
    history = old;
    if (!history.empty() && history.back() != '\n') history += '\n';
  }
  for (const Change& change : changes) history += history_line(change.step);
  return storage::publish(
      folder, {{history_name, std::move(history)}, {config::manifest_name, std::move(edited)}});
}

Expected<Change> changed(const reading::ReadCampaign& read, const std::vector<std::string>& model,
                         const ModelEdit& edit, const Compared* known) {
  const std::string& effect = edit.effect;
  const bool add = edit.add;
  Change change;
  change.effects = model;
  if (add) {
    change.effects.push_back(effect);
  } else {
    const auto found = std::find(change.effects.begin(), change.effects.end(), effect);
    if (found != change.effects.end()) change.effects.erase(found);
  }
  auto after = compare_axis(read, change.effects, edit);
  if (!after) {
    if (add) return fail(after.error());
  } else {
    change.after = std::move(*after);
  }
  if (known != nullptr && change.after && known->part.part.name == change.after->part.part.name) {
    change.before = *known;
  } else if (auto before = compare_axis(read, model, edit); before) {
    change.before = std::move(*before);
  } else {
    change.no_before = before.error().message;
  }
  if (add && !change.after)
    return fail("no measurement of this campaign can show \"" + effect + "\"");
  change.step = step_of(change, effect, add);
  change.step.why = edit.why;
  return change;
}

Expected<void> leave_out(reading::ReadCampaign& read, const Exclusion& one) {
  const auto& all = read.manifest->campaign.measurements;
  const auto m = std::find_if(all.begin(), all.end(),
                              [&](const Measurement& x) { return x.id == one.measurement; });
  const auto at = static_cast<std::size_t>(m - all.begin());
  if (m == all.end() || at >= read.observations.size())
    return fail("there is no measurement \"" + one.measurement + "\"");
  if (one.lines.empty()) return fail("expected the line of at least one reading");
  if (one.why.find_first_not_of(" \t") == std::string::npos ||
      one.why.find_first_of("\r\n") != std::string::npos)
    return fail("expected a reason in one line why these readings do not count");
  Observations& o = read.observations[at];
  std::vector<char> kept(o.size(), 1);
  for (const std::uint32_t line : one.lines) {
    bool any = false;
    for (std::size_t i = 0; i < o.size() && i < o.source_line.size(); ++i)
      if (o.source_line[i] == line) kept[i] = 0, any = true;
    if (!any)
      return fail("line " + std::to_string(line) + " of " + m->file +
                  " contains no reading that is used");
  }
  keep_rows(o, kept);
  return {};
}

Expected<void> set_period(reading::ReadCampaign& read, const Period& one) {
  constexpr double most = 1e5;  // largest screw pitch, mm
  auto& axes = read.manifest->campaign.machine.axes;
  const auto axis =
      std::find_if(axes.begin(), axes.end(), [&](const Axis& a) { return a.name == one.axis; });
  if (axis == axes.end() || axis->rotary)
    return fail("the machine has no linear axis \"" + one.axis + "\"");
  if (!(one.mm > 0.0 && one.mm <= most))
    return fail("expected a period above 0 and up to 100000 mm");
  axis->screw_pitch = one.mm * 1e-3;
  return {};
}

}  // namespace

std::vector<ModelEdit> edits_between(const std::vector<std::string>& from,
                                     const std::vector<std::string>& to) {
  const auto has = [](const std::vector<std::string>& list, const std::string& effect) {
    return std::find(list.begin(), list.end(), effect) != list.end();
  };
  std::vector<ModelEdit> edits;
  for (const std::string& effect : from)
    if (!has(to, effect)) edits.push_back({effect, false, {}});
  for (const std::string& effect : to)
    if (!has(from, effect)) edits.push_back({effect, true, {}});
  return edits;
}

Expected<std::string> edited_manifest(std::string_view text, const CampaignEdit& edit) {
  std::string out(text);
  Expected<std::string> next = out;
  for (const Exclusion& one : edit.excluded) {
    if (next = with_excluded(out, one.measurement, one.lines, one.why); !next) return next;
    out = *next;
  }
  for (const Period& one : edit.periods) {
    if (next = with_period(out, one.axis, one.mm); !next) return next;
    out = *next;
  }
  for (const ModelEdit& one : edit.model) {
    next = one.add ? with_effect(out, one.effect) : without_effect(out, one.effect);
    if (!next) return next;
    out = *next;
  }
  return out;
}

Expected<std::vector<Change>> change_campaign(const fs::path& folder, reading::ReadCampaign& read,
                                              const CampaignEdit& edit, const Compared* known) {
  std::vector<Change> changes;
  std::vector<std::string> model = read.manifest->campaign.model;
  const auto note = [&](ModelStep step) {
    if (step.why.empty()) step.why = edit.why;
    changes.push_back({std::move(step), model, {}, {}, {}});
  };
  for (const Exclusion& one : edit.excluded) {
    if (auto done = leave_out(read, one); !done) return fail(done.error());
    note({.effect = {}, .why = one.why, .excluded = one});
  }
  for (const Period& one : edit.periods) {
    if (auto done = set_period(read, one); !done) return fail(done.error());
    note({.effect = {}, .period = one});
  }
  if (!changes.empty())
    if (auto left = part_models(read, model); !left) return fail(left.error());
  for (const ModelEdit& one : edit.model) {
    auto change = changed(read, model, one, known);
    known = nullptr;
    if (!change) return fail(change.error());
    if (change->step.why.empty()) change->step.why = edit.why;
    model = change->effects;
    changes.push_back(std::move(*change));
  }
  if (auto written = write(folder, read, edit, changes); !written) return fail(written.error());
  read.manifest->campaign.model = std::move(model);
  if (const auto text = storage::read_file(folder / config::manifest_name))
    read.inputs.front().second = storage::sha256(*text);
  return changes;
}

Expected<Change> change_model(const fs::path& folder, reading::ReadCampaign& read,
                              const std::string& effect, bool add, const Compared* known,
                              const std::string& part) {
  NONIO_TRY(auto changes,
            change_campaign(folder, read, {.model = {{effect, add, {}, part}}}, known));
  return std::move(changes.front());
}

}  // namespace nonio::modelling
