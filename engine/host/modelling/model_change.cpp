// SPDX-License-Identifier: Apache-2.0
#include "host/modelling/model_change.h"

#include <algorithm>

#include "host/modelling/model_edit.h"
#include "host/modelling/model_history.h"
#include "host/storage/digest.h"
#include "host/storage/files.h"

namespace nonio::host::modelling {
namespace fs = std::filesystem;

namespace {

/// The part that shows the effect, with this model; none if it was not measured.
Expected<std::optional<Compared>> compare_axis(const reading::ReadCampaign& read,
                                               const std::vector<std::string>& effects,
                                               const std::string& effect) {
  auto parts = part_models(read, effects);
  if (!parts) return fail(parts.error());
  for (PartModel& part : *parts) {
    if (!part.shows(effect)) continue;
    auto comparison = compare_part(part);
    if (!comparison) return fail(comparison.error());
    return Compared{std::move(part), std::move(*comparison)};
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

Expected<void> write(const fs::path& folder, const reading::ReadCampaign& read,
                     const ModelStep& step) {
  std::error_code error;
  if (fs::is_symlink(folder / config::manifest_name, error))
    return fail(
        Error{"is a link; expected the file itself, which is written anew", config::manifest_name});
  const auto text = storage::read_file(folder / config::manifest_name);
  if (!text) return fail(text.error());
  if (storage::sha256(*text) != read.inputs.front().second)
    return fail(
        Error{"changed while the model was fitted; nothing was written", config::manifest_name});
  auto edited = step.added ? with_effect(*text, step.effect) : without_effect(*text, step.effect);
  if (!edited) return fail(edited.error());
  std::string history;
  if (fs::exists(folder / history_name, error)) {
    const auto old = storage::read_file(folder / history_name);
    if (!old) return fail(old.error());
    if (const auto sound = parse_history(*old); !sound) return fail(sound.error());
    history = *old;
    if (!history.empty() && history.back() != '\n') history += '\n';
  }
  history += history_line(step);
  return storage::publish(
      folder, {{history_name, std::move(history)}, {config::manifest_name, std::move(*edited)}});
}

}  // namespace

Expected<Change> change_model(const fs::path& folder, reading::ReadCampaign& read,
                              const std::string& effect, bool add) {
  Campaign& campaign = read.manifest->campaign;
  Change change;
  change.effects = campaign.model;
  if (add) {
    change.effects.push_back(effect);
  } else {
    const auto found = std::find(change.effects.begin(), change.effects.end(), effect);
    if (found != change.effects.end()) change.effects.erase(found);
  }
  auto before = compare_axis(read, campaign.model, effect);
  if (before)
    change.before = std::move(*before);
  else
    change.no_before = before.error().message;
  auto after = compare_axis(read, change.effects, effect);
  if (!after) {
    if (add) return fail(after.error());
  } else {
    change.after = std::move(*after);
  }
  if (add && !change.after)
    return fail("no measurement of this campaign can show \"" + effect + "\"");
  change.step = step_of(change, effect, add);
  if (auto written = write(folder, read, change.step); !written) return fail(written.error());
  campaign.model = change.effects;
  if (const auto text = storage::read_file(folder / config::manifest_name))
    read.inputs.front().second = storage::sha256(*text);
  return change;
}

}  // namespace nonio::host::modelling
