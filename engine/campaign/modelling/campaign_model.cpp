// SPDX-License-Identifier: Apache-2.0
#include "campaign/modelling/campaign_model.h"

#include <algorithm>
#include <map>

#include "campaign/modelling/held_terms.h"
#include "platform/process/guarded.h"
#include "platform/storage/nearest.h"

namespace nonio::modelling {

namespace {

std::pair<std::string, std::string> split(const std::string& effect) {
  const std::size_t colon = effect.find(':');
  if (colon == std::string::npos) return {effect, ""};
  const std::size_t axis = colon + 1;
  return {effect.substr(0, colon), effect.substr(axis, effect.find('@', axis) - axis)};
}

std::vector<std::string> known_names(const reading::ReadCampaign& read) {
  const Campaign& campaign = read.manifest->campaign;
  std::vector<std::string> names;
  for (const Effect& effect : read.effects)
    for (const Axis& axis : campaign.machine.axes)
      if (!effect.instances && !effect.is_nuisance)
        names.push_back(effect.info.name + ":" + axis.name);
  for (const model::Part& part : model::parts_of(campaign, read.observations))
    for (const Effect& effect : read.effects)
      if (effect.instances && !effect.is_nuisance)
        for (std::string& name : model::names_of(part, effect)) names.push_back(std::move(name));
  return names;
}

bool can_be_in_space(const std::string& of) {
  return !of.empty() && of.find_first_not_of("EXYZABC0123456789") == std::string::npos;
}

std::string mistake_of_channel(const std::string& effect, const Effect& known,
                               const reading::ReadCampaign& read) {
  for (const model::Part& part : model::parts_of(read.manifest->campaign, read.observations)) {
    auto terms = model::terms_of(part, read.manifest->campaign.machine, {effect}, {known});
    if (terms && !terms->empty()) return {};
    const std::string of = split(effect).second.substr(0, split(effect).second.find('/'));
    for (const model::ChannelLeft& left : part.channels_left)
      if (of == left.name && left.lacks_readings())
        return "\"" + effect + "\": measurement " + storage::listed(left.measurements) +
               " has no " +
               (left.why == model::ChannelLeft::Why::partly ? "channel " + left.name : "time_s") +
               ", and is explained together with those that have it";
    for (const model::ChannelLeft& left : part.channels_left)
      if (of == left.name && left.fails())
        return "\"" + effect + "\": the thermometer " + left.name +
               " fails in this campaign, so it has no effects; `nonio model compare` describes how";
  }
  return "\"" + effect + "\": no measurement over time has this channel" +
         (effect.find('/') == std::string::npos ? "" : " and these displacements") +
         storage::suggestion(effect, known_names(read));
}

std::string mistake_of_value(const Entry& entry, const Effect& effect, const Axis* axis) {
  if (!entry.value) return {};
  const auto value = held_value(entry, effect, axis != nullptr && axis->rotary);
  return value ? "" : value.error().message;
}

std::string mistake_of(const std::string& written, const reading::ReadCampaign& read) {
  const Entry entry = entry_of(written);
  const std::string& effect = entry.effect;
  const auto [kind, axis] = split(effect);
  const auto is_kind = [&, &k = kind](const Effect& e) { return e.info.name == k; };
  const auto known = std::find_if(read.effects.begin(), read.effects.end(), is_kind);
  // Computed only for a message, because it tests all effects on all readings.
  const auto nearest = [&] { return storage::suggestion(effect, known_names(read)); };
  if (kind.empty() || axis.empty())
    return "expected kind:axis, such as backlash:X; found \"" + effect + "\"" + nearest();
  if (known == read.effects.end()) return "there is no effect \"" + kind + "\"" + nearest();
  if (known->is_nuisance)
    return "\"" + effect + "\" belongs to the set-up: it is in every model, and not written";
  const Axis* const of = read.manifest->campaign.machine.axis(axis);
  if (std::string mistake = mistake_of_value(entry, *known, of); !mistake.empty()) return mistake;
  if (known->of_channels) return mistake_of_channel(effect, *known, read);
  if (known->instances)
    return can_be_in_space(axis)
               ? ""
               : "\"" + effect +
                     "\": expected what the effect can be of, such as straightness:EYX, " +
                     "squareness:XY or yaw:X" + nearest();
  if (of == nullptr)
    return "\"" + effect + "\": the machine has no axis \"" + axis + "\"" + nearest();
  return {};
}

}  // namespace

std::vector<std::string> PartModel::names() const {
  std::vector<std::string> out;
  for (const model::Term& t : terms)
    if (!t.effect->is_nuisance) out.push_back(t.name());
  for (const Held& h : held) out.push_back(h.text);
  return out;
}

std::vector<double> PartModel::measured() const {
  std::vector<double> out = part.table.deviation;
  for (const Held& h : held)
    for (std::size_t i = 0; i < out.size(); ++i) out[i] += h.part[i];
  return out;
}

bool PartModel::shows(const std::string& written) const {
  const std::string effect = entry_of(written).effect;
  if (part.kind == model::Part::Kind::axis && split(effect).second == part.name) return true;
  if (!model::is_for(part, effect)) return false;
  // In a displacement over time (`course`), the effect "heat:t4/x1" belongs to the term heat:t4.
  const std::string name =
      part.kind == model::Part::Kind::course ? effect.substr(0, effect.find('/')) : effect;
  for (const auto* list : {&terms, &catalogue})
    for (const model::Term& t : *list)
      if (t.name() == name) return true;
  return std::any_of(held.begin(), held.end(),
                     [&](const Held& h) { return h.term.name() == name; });
}

std::string kind_of(const model::Part& part) {
  switch (part.kind) {
    case model::Part::Kind::axis:
      return "axis";
    case model::Part::Kind::space:
      return "space";
    case model::Part::Kind::balls:
      return "balls";
    case model::Part::Kind::course:
      break;
  }
  return "course";
}

ReadingPlace place_of(const PartModel& part, const Campaign& campaign, std::size_t row) {
  const Observations& o = part.part.table;
  ReadingPlace place;
  place.measurement = part.part.measurements[part.part.measurement[row]];
  for (const Measurement& m : campaign.measurements)
    if (m.id == place.measurement) place.file = m.file;
  if (row < o.source_line.size()) place.line = o.source_line[row];
  if (row < o.run.size()) place.run = o.run[row];
  // Features of a body have no known direction of approach.
  const bool is_feature = !o.lines.empty() && !o.lines[o.line_of(row)].body.empty();
  if (!is_feature) place.direction = part.part.way[row] > 0 ? 1 : part.part.way[row] < 0 ? -1 : 0;
  place.target = part.part.along[row];
  place.position = part.position();
  return place;
}

std::vector<std::string> model_mistakes(const std::vector<std::string>& effects,
                                        const reading::ReadCampaign& read) {
  std::vector<std::string> out;
  for (std::size_t i = 0; i < effects.size(); ++i) {
    if (find_effect(effects, effects[i]) != &effects[i])
      out.push_back("\"" + entry_of(effects[i]).effect + "\" is given twice");
    else if (std::string mistake = mistake_of(effects[i], read); !mistake.empty())
      out.push_back(std::move(mistake));
  }
  return out;
}

RowsPlace place_of(const PartModel& part, const Campaign& campaign,
                   const std::vector<std::uint32_t>& rows) {
  constexpr std::size_t most = 8;
  RowsPlace out{rows.size(), {}, {}};
  for (std::size_t k = 0; k < rows.size() && k < most; ++k) {
    const ReadingPlace at = place_of(part, campaign, rows[k]);
    if (k == 0) out.file = at.file;
    out.lines += (k == 0 ? "" : ", ") + std::to_string(at.line);
  }
  if (rows.size() > most) out.lines += ", ...";
  return out;
}

Expected<void> without_mistakes(const std::vector<std::string>& effects,
                                const reading::ReadCampaign& read) {
  const auto mistakes = model_mistakes(effects, read);
  if (mistakes.empty()) return {};
  const auto line = read.manifest->lines.find("model.effects");
  return fail(Error{"model.effects: " + mistakes.front(), config::manifest_name,
                    line == read.manifest->lines.end() ? 0 : line->second});
}

namespace {

Expected<void> hold(PartModel& part, const Entry& entry, const Machine& machine,
                    const std::vector<Effect>& effects) {
  NONIO_TRY(auto terms, model::terms_of(part.part, machine, {entry.effect}, effects));
  const auto term = std::find_if(terms.begin(), terms.end(),
                                 [&](const model::Term& t) { return t.name() == entry.effect; });
  if (term == terms.end()) return {};
  NONIO_TRY(const auto value, held_value(entry, *term->effect, term->axis.rotary));
  NONIO_TRY(auto says, model::said_by(part.part.table, *term, value));
  PartModel::Held held{*term, {}, entry.text(), std::move(says)};
  held.term.held = true;
  const Effect::Parameter& p = term->effect->linear.front();
  const Quantity q = term->axis.rotary ? p.rotary : p.quantity;
  held.parameter = {entry.effect, p.name, value, 0.0, q, false, {}, true};
  for (std::size_t i = 0; i < held.part.size(); ++i) part.part.table.deviation[i] -= held.part[i];
  part.held.push_back(std::move(held));
  return {};
}

void append_held(const PartModel& part, model::Fit& fit) {
  for (const PartModel::Held& h : part.held) {
    fit.terms.push_back(h.term);
    fit.part.push_back(h.part);
    fit.parameters.push_back(h.parameter);
    if (!fit.lost.empty()) fit.lost.push_back(0);
    for (auto& row : fit.correlation) row.push_back(0.0);
    fit.correlation.emplace_back(fit.parameters.size(), 0.0).back() = 1.0;
  }
}

std::vector<model::Term> without_held(std::vector<model::Term> catalogue, const PartModel& part) {
  std::erase_if(catalogue, [&](const model::Term& t) {
    return std::any_of(part.held.begin(), part.held.end(),
                       [&](const PartModel::Held& h) { return h.term.name() == t.of_all(); });
  });
  return catalogue;
}

}  // namespace

void set_model(PartModel& part, const std::vector<std::string>& effects,
               const reading::ReadCampaign& read) {
  const Machine& machine = read.manifest->campaign.machine;
  part.part.table.deviation = part.measured();
  part.held.clear();
  part.unfit.clear();
  std::vector<std::string> fitted;
  for (const std::string& written : effects) {
    const Entry entry = entry_of(written);
    if (!entry.value)
      fitted.push_back(written);
    else if (auto done = hold(part, entry, machine, read.effects); !done)
      part.unfit = done.error().message;
  }
  auto terms = model::terms_of(part.part, machine, fitted, read.effects);
  if (!terms) part.unfit = terms.error().message;
  part.terms = terms ? std::move(*terms) : std::vector<model::Term>{};
}

std::vector<PartModel> bare_parts(const reading::ReadCampaign& read) {
  std::vector<PartModel> parts;
  for (model::Part& part : model::parts_of(read.manifest->campaign, read.observations))
    parts.push_back({std::move(part), {}, {}, {}});
  return parts;
}

std::vector<std::string> kinds_measured(const reading::ReadCampaign& read) {
  std::vector<std::string> kinds;
  for (std::size_t m = 0; m < read.observations.size(); ++m) {
    const std::string& kind = read.manifest->campaign.measurements[m].kind;
    if (read.observations[m].size() > 0 &&
        std::find(kinds.begin(), kinds.end(), kind) == kinds.end())
      kinds.push_back(kind);
  }
  return kinds;
}

namespace {

std::vector<config::Cause>::const_iterator cause_of(const std::vector<config::Cause>& library,
                                                    const model::Term& term) {
  return std::find_if(library.begin(), library.end(), [&](const config::Cause& c) {
    return c.formula.name == term.effect->info.name;
  });
}

}  // namespace

Error nothing_to_compare(const reading::ReadCampaign& read) {
  const auto kinds = kinds_measured(read);
  if (kinds.empty()) return {"no measurement of this campaign has readings"};
  return {
      "effects explain runs of an axis, straightness, diagonals, circles, centres of a ball that "
      "turns with one rotary axis, and displacements over time; this campaign has other "
      "readings: " +
      storage::listed(kinds)};
}

namespace {

void set_frequency(model::Term& term, const config::Priors& priors) {
  if (priors.campaigns > 0) term.frequency = priors.frequency(term.effect->info.name);
}

}  // namespace

void use_priors(PartModel& part, config::Priors priors) {
  part.priors = std::move(priors);
  for (model::Term& term : part.catalogue) set_frequency(term, part.priors);
}

void fill_catalogue(PartModel& part, const reading::ReadCampaign& read) {
  part.catalogue = model::catalogue(part.part, read.effects);
  std::erase_if(part.catalogue, [&](const model::Term& t) {
    return cause_of(*read.causes, t) != read.causes->end();
  });
  part.library = part.part.kind == model::Part::Kind::axis ? read.causes : nullptr;
  part.left_out = model::not_applying(part.part, read.effects);
  fill_interpolated(part, read);
}

void fill_interpolated(PartModel& part, const reading::ReadCampaign& read) {
  part.interpolated =
      place_of(part, read.manifest->campaign, model::interpolated_temperatures(part.part));
}

Expected<std::vector<PartModel>> part_models(const reading::ReadCampaign& read,
                                             const std::vector<std::string>& effects) {
  if (auto right = without_mistakes(effects, read); !right) return fail(right.error());
  std::vector<PartModel> parts = bare_parts(read);
  for (PartModel& part : parts) {
    set_model(part, effects, read);
    fill_catalogue(part, read);
  }
  return parts;
}

std::vector<std::string> unmeasured(const std::vector<std::string>& effects,
                                    const std::vector<PartModel>& parts) {
  std::vector<std::string> out;
  for (const std::string& effect : effects)
    if (std::none_of(parts.begin(), parts.end(),
                     [&](const PartModel& p) { return p.shows(effect); }))
      out.push_back(effect);
  return out;
}

Expected<model::Comparison> compare_part(const PartModel& part, const model::Groundwork* known,
                                         const model::Fitted& fitted) {
  if (!part.unfit.empty()) return fail(part.unfit);
  const model::Fitted with_held = [&](const model::Comparison& c) {
    model::Comparison all = c;
    append_held(part, all.fit);
    fitted(all);
  };
  auto out = process::guarded(kind_of(part.part) + " " + part.part.name, [&] {
    return model::compare(part.part, part.terms, known, fitted ? with_held : model::Fitted{});
  });
  if (out) append_held(part, out->fit);
  return out;
}

std::vector<model::Term> library_of(const PartModel& part, std::shared_ptr<const void>& keeps) {
  auto effects = std::make_shared<std::vector<Effect>>();
  for (const config::Cause& cause : *part.library)
    if (cause.rotary == part.part.axes.front().rotary)
      if (auto effect = cause.effect(true)) effects->push_back(std::move(*effect));
  std::vector<model::Term> terms = model::catalogue(part.part, *effects);
  std::erase_if(terms, [](const model::Term& t) { return t.grouping != nullptr; });
  for (model::Term& term : terms) {
    term.price = cause_of(*part.library, term)->price();
    term.library = true;
    set_frequency(term, part.priors);
  }
  keeps = std::move(effects);
  return terms;
}

namespace {

/// Removes candidates with a value for each group, unless they are in the chosen set or explain
/// more than one common value.
void leave_out_weaker_groups(model::Explanation& e) {
  std::map<std::string, double> score;
  for (const model::Candidate& c : e.candidates) score[c.term.name()] = c.score;
  std::erase_if(e.candidates, [&](const model::Candidate& c) {
    if (!c.term.grouping ||
        std::find(e.together.begin(), e.together.end(), c.term.name()) != e.together.end())
      return false;
    const auto plain = score.find(c.term.of_all());
    return !(c.score > 0.0) || (plain != score.end() && !(c.score > plain->second));
  });
}

/// Whether an effect may be one of the causes in another form: its shape was searched, or a quantity
/// was recorded that no effect of the catalog depends on.
bool may_imitate(const PartModel& part, const model::Candidate& c) {
  const Observations& o = part.part.table;
  return !c.term.effect->shapes.empty() || !o.air.empty() || !o.pressure.empty() ||
         !o.humidity.empty();
}

/// Whether the named effect, or another of the best set, may imitate a cause.
bool set_may_imitate(const PartModel& part, const model::Explanation& e) {
  return std::any_of(e.candidates.begin(), e.candidates.end(), [&](const model::Candidate& c) {
    return may_imitate(part, c) &&
           (&c == &e.candidates.front() ||
            std::find(e.together.begin(), e.together.end(), c.term.name()) != e.together.end());
  });
}

/// Whether runs or passes have zeros that scatter more than the readings within them.
bool has_large_zeros(const model::Comparison& c) {
  using Zero = model::Noise::Zero;
  const model::Noise& noise = c.fit.noise;
  return (noise.zero == Zero::of_run || noise.zero == Zero::of_pass) && noise.zero_found > 1.0;
}

/// Whether the named effects explain random zeros of runs or passes: few of these resemble one of
/// many causes by chance, but not down to the floor.
bool is_at_floor(const PartModel& part, const model::Explanation& e,
                 const model::Groundwork* known) {
  constexpr double down_to_floor = 1.5;  // docs/dev/constants.md, M70
  std::vector<model::Term> terms = part.terms;
  for (const model::Candidate& c : e.candidates)
    if (std::find(e.together.begin(), e.together.end(), c.term.name()) != e.together.end())
      terms.push_back(c.term);
  const auto with = model::compare(part.part, terms, known);
  return with && with->floor && with->fit.rms < down_to_floor * with->floor->s;
}

/// Searches causes together with the catalog. The result replaces `out` only if its named effect
/// has evidence by itself, and if it contains exactly one cause; if the catalog already named an
/// effect, also none, or two in a smaller set: with many causes, sets of two that imitate others are
/// likely. The rate of false alarms is that of the second search.
void look_up_library(const PartModel& part, std::uint64_t seed, const model::Groundwork* known,
                     model::Explanation& out) {
  using Kind = model::Verdict::Kind;
  if (!out.comparison.floor || part.library == nullptr) return;
  const bool explained = out.verdict.kind == Kind::missing,
             is_open = out.verdict.kind == Kind::unknown || has_large_zeros(out.comparison);
  if (explained ? !set_may_imitate(part, out) : !is_open) return;
  std::shared_ptr<const void> keeps;
  std::vector<model::Term> library = library_of(part, keeps);
  if (explained && out.explains_all) library = model::replacing(part.part, out, std::move(library));
  std::vector<model::Term> all = part.catalogue;
  all.insert(all.end(), library.begin(), library.end());
  auto more =
      model::explain(part.part, part.terms, without_held(std::move(all), part), seed, known);
  if (!more || more->verdict.kind != Kind::missing || !(more->candidates.front().alone > 0.0))
    return;
  if (out.verdict.kind == Kind::nothing && !is_at_floor(part, *more, known)) return;
  const auto causes = std::count_if(library.begin(), library.end(), [&](const model::Term& t) {
    return std::find(more->together.begin(), more->together.end(), t.name()) !=
           more->together.end();
  });
  const std::size_t before = out.together.size(), now = more->together.size();
  if (causes > (explained && now < before ? 2 : 1) ||
      (causes == 0 && (!explained || !may_imitate(part, out.candidates.front()))))
    return;
  more->keeps = std::move(keeps);
  out = std::move(*more);
}

}  // namespace

Expected<model::Explanation> explain_part(const PartModel& part, std::uint64_t seed,
                                          const model::Groundwork* known, bool with_library) {
  if (!part.unfit.empty()) return fail(part.unfit);
  return process::guarded(kind_of(part.part) + " " + part.part.name, [&] {
    auto out =
        model::explain(part.part, part.terms, without_held(part.catalogue, part), seed, known);
    if (out && with_library) look_up_library(part, seed, known, *out);
    if (out) leave_out_weaker_groups(*out);
    if (out) append_held(part, out->comparison.fit);
    if (out)
      out->candidates.insert(out->candidates.end(), part.left_out.begin(), part.left_out.end());
    return out;
  });
}

}  // namespace nonio::modelling
