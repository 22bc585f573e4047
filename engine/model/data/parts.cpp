// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <functional>
#include <map>
#include <memory>
#include <set>

#include "balls.h"
#include "courses.h"
#include "design.h"
#include "failed_channels.h"
#include "lines.h"
#include "nonio/math/rotary.h"
#include "nonio/model/explain.h"
#include "nonio/sdk/axis_readings.h"
#include "nonio/sdk/check.h"
#include "nonio/sdk/space_readings.h"
#include "thermal_tests.h"

namespace nonio::model {

namespace {

class Parts {
 public:
  Parts(const Campaign& campaign, const std::vector<Observations>& read)
      : campaign_(campaign), read_(read) {}

  std::vector<Part> made() {
    const std::size_t n = std::min(campaign_.measurements.size(), read_.size());
    for (std::size_t m = 0; m < n; ++m) sort(m);
    for (const std::size_t m : order_) {
      if (const auto& what = kind_.at(m); what == Kind::balls)
        add_balls(m);
      else if (what == Kind::course)
        append_courses(measurement(m), read_[m], parts_);
      else if (what == Kind::across)
        add_space(m);
      else if (!in_space(m))
        add_axis(m);
    }
    return std::move(parts_);
  }

 private:
  enum class Kind { axis, across, balls, course };

  const Measurement& measurement(std::size_t m) const { return campaign_.measurements[m]; }

  void sort(std::size_t m) {
    const Observations& o = read_[m];
    if (o.size() == 0 || o.axes.empty() || !check(o)) return;
    using Motion = Measurement::Motion;
    const Measurement& own = measurement(m);
    if (own.motion == Motion::time && own.axis.empty()) {
      kind_[m] = Kind::course;
      order_.push_back(m);
      return;
    }
    // Only measurements at targets or along a path are used, because effects of the model depend on
    // positions of the axes. Readings of rigid-body contain the unknown placement of the artefact.
    if (own.motion != Motion::targets && own.motion != Motion::path) return;
    if (own.kind == "ball-centres") {
      kind_[m] = Kind::balls;
    } else if (sensed_along_one_axis(o)) {
      if (campaign_.machine.axis(o.axes.front().axis) == nullptr) return;
      kind_[m] = Kind::axis;
    } else if (across(o)) {
      kind_[m] = Kind::across;
      states_.insert(state_of(measurement(m)));
      for (const std::size_t k : coordinates_of(o)) coordinates_.insert(k);
      oblique_ = oblique_ || senses_several(o);
    } else {
      return;
    }
    order_.push_back(m);
  }

  bool in_space(std::size_t m) const {
    const std::size_t k = coordinate_of(read_[m].axes.front().axis);
    if (!oblique_ || read_[m].angular || !coordinates_.contains(k)) return false;
    const std::string state = state_of(measurement(m));
    return state.empty() || states_.contains(state);
  }

  void add_axis(std::size_t m) {
    const Axis& axis = *campaign_.machine.axis(read_[m].axes.front().axis);
    auto part = std::find_if(parts_.begin(), parts_.end(), [&](const Part& p) {
      return p.kind == Part::Kind::axis && p.axes.front().name == axis.name;
    });
    if (part == parts_.end()) {
      Part fresh;
      fresh.name = axis.name;
      fresh.axes = {axis};
      part = parts_.insert(parts_.end(), std::move(fresh));
    }
    append_run(*part, read_[m], measurement(m));
  }

  void add_balls(std::size_t m) {
    const Axis* axis = campaign_.machine.axis(measurement(m).axis);
    // If a second rotary axis turns, the ball centers are not on a circle.
    if (axis == nullptr || !math::other_turning_axis(read_[m]).empty()) return;
    if (auto part = balls_of(read_[m], *axis, measurement(m).id))
      parts_.push_back(std::move(*part));
  }

  /// Measurements in space of a state; without diagonals only those of equal axis and direction.
  void add_space(std::size_t m) {
    if (done_.contains(m)) return;
    const std::string state = state_of(measurement(m));
    // A measurement without a state belongs to every state.
    if (state.empty() && oblique_ && states_.size() > 1) return;
    Part part;
    part.kind = Part::Kind::space;
    std::vector<std::size_t> members;
    for (const std::size_t other : order_)
      if (belongs(other, m, state)) members.push_back(other);
    append_space(part, campaign_, read_, members);
    done_.insert(members.begin(), members.end());
    part.name = oblique_ ? "" : "E" + measurement(m).lateral + measurement(m).axis;
    if (oblique_ || part.name.size() < 3) {
      part.name.clear();
      for (const Axis& axis : part.axes) part.name += axis.name;
    }
    if (!state.empty()) part.name += " " + state;
    parts_.push_back(std::move(part));
  }

  bool belongs(std::size_t other, std::size_t m, const std::string& state) const {
    if (kind_.at(other) == Kind::balls || kind_.at(other) == Kind::course) return false;
    const std::string its = state_of(measurement(other));
    if (oblique_)
      return (its == state || its.empty()) && (kind_.at(other) == Kind::across || in_space(other));
    return kind_.at(other) == Kind::across && its == state &&
           measurement(other).axis == measurement(m).axis &&
           measurement(other).lateral == measurement(m).lateral;
  }

  const Campaign& campaign_;
  const std::vector<Observations>& read_;
  std::map<std::size_t, Kind> kind_;
  std::vector<std::size_t> order_;
  std::set<std::string> states_;       // states of measurements across the motion
  std::set<std::size_t> coordinates_;  // coordinates that these measurements move or sense
  std::set<std::size_t> done_;
  bool oblique_ = false;
  std::vector<Part> parts_;
};

/// In space, some reading must both approach along this linear axis and sense along the axis.
bool concerns(const Part& part, const Axis& axis) {
  if (part.kind == Part::Kind::axis) return true;
  if (part.kind == Part::Kind::balls || part.kind == Part::Kind::course || axis.rotary)
    return false;
  const std::size_t k = coordinate_of(axis.name);
  const auto* column = part.table.axis(axis.name);
  if (k > 2 || column == nullptr || column->approach.size() != part.table.size()) return false;
  for (std::size_t i = 0; i < part.table.size(); ++i)
    if (column->approach[i] != 0 && std::fabs(part.table.sense_of(i)[k]) > 1e-9) return true;
  return false;
}

/// Null if the property is not stated for all measurements, or is the same for all of them.
std::shared_ptr<const Grouping> grouping_by(
    const std::string& by, const std::vector<const Measurement*>& measurements,
    const std::function<std::string(const Measurement&)>& text) {
  auto out = std::make_shared<Grouping>();
  out->by = by;
  for (const Measurement* m : measurements) {
    std::string name = text(*m);
    if (name.empty()) return nullptr;
    const auto known = std::find(out->name.begin(), out->name.end(), name);
    out->group.push_back(static_cast<std::uint32_t>(known - out->name.begin()));
    if (known == out->name.end()) out->name.push_back(std::move(name));
  }
  return out->name.size() > 1 ? out : nullptr;
}

/// Groups by stated properties first, then by measurement, without repetition. Empty unless the
/// part is an axis with several measurements.
std::vector<std::shared_ptr<const Grouping>> groupings_of(const Part& part,
                                                          const Campaign& campaign) {
  std::vector<std::shared_ptr<const Grouping>> out;
  if (part.kind != Part::Kind::axis || part.measurements.size() < 2) return out;
  // Groups are made of lines, so a part with several lines in a measurement has no groups.
  for (std::size_t i = 0; i < part.table.size(); ++i)
    if (line_of(part.table, i) >= part.measurements.size()) return out;
  std::vector<const Measurement*> measurements;
  for (const std::string& id : part.measurements)
    for (const Measurement& m : campaign.measurements)
      if (m.id == id) measurements.push_back(&m);
  const auto add = [&](const std::string& by,
                       const std::function<std::string(const Measurement&)>& text) {
    auto grouping = grouping_by(by, measurements, text);
    if (grouping && std::none_of(out.begin(), out.end(), [&](const auto& known) {
          return known->group == grouping->group;
        }))
      out.push_back(std::move(grouping));
  };
  add("adjustment", [](const Measurement& m) { return m.adjustment; });
  add("state", [](const Measurement& m) { return state_of(m); });
  add("side", [](const Measurement& m) { return m.side; });
  add("measurement", [](const Measurement& m) { return m.id; });
  return out;
}

/// Returns std::nullopt without such groups, or if the effect is a description or part of the
/// set-up.
std::optional<Term> grouped(const Part& part, Term term, const std::string& by) {
  if (term.effect->description || term.effect->is_nuisance) return std::nullopt;
  for (const auto& grouping : part.groupings)
    if (grouping->by == by) {
      term.grouping = grouping;
      return term;
    }
  return std::nullopt;
}

std::string listed_groupings(const Part& part) {
  std::string out;
  for (const auto& grouping : part.groupings) out += (out.empty() ? "" : " or ") + grouping->by;
  return out.empty() ? "two measurements of one axis" : out;
}

/// Measurements of the part with a reading that lacks something.
template <class Lacks>
std::vector<std::string> lacking(const Part& part, const Lacks& lacks) {
  std::set<std::uint32_t> which;
  for (std::size_t i = 0; i < part.table.size(); ++i)
    if (lacks(i)) which.insert(part.measurement[i]);
  std::vector<std::string> out;
  for (const std::uint32_t m : which) out.push_back(part.measurements[m]);
  return out;
}

/// Removes the channels whose effects these readings cannot determine, and stores the reason.
void leave_channels(Part& part) {
  Observations& o = part.table;
  if (part.kind == Part::Kind::course || o.channels.empty()) return;
  const auto untimed = lacking(
      part, [&](std::size_t i) { return o.time.size() != o.size() || !std::isfinite(o.time[i]); });
  std::map<std::string, ChannelLeft> all;
  for (const auto& c : o.channels) {
    ChannelLeft left{c.name, ChannelLeft::Why::speed, {}};
    if (c.is_temperature()) {
      left.why = untimed.empty() ? ChannelLeft::Why::partly : ChannelLeft::Why::untimed;
      left.measurements =
          untimed.empty()
              ? lacking(part,
                        [&](std::size_t i) {
                          return std::none_of(
                              o.channels.begin(), o.channels.end(), [&](const auto& same) {
                                return same.name == c.name &&
                                       std::binary_search(same.lines.begin(), same.lines.end(),
                                                          o.line_of(i));
                              });
                        })
              : untimed;
      if (left.measurements.empty()) continue;
    }
    all.emplace(c.name, std::move(left));
  }
  std::erase_if(o.channels, [&](const auto& c) { return all.contains(c.name); });
  for (auto& [name, left] : all) part.channels_left.push_back(std::move(left));
}

/// Whether an effect can be in this part. Effects of channels occur only in displacements over time
/// and next to recorded channels, not in ball centers; other effects occur in all parts except displacements
/// over time.
bool can_be_in(const Part& part, const Effect& effect) {
  if (!effect.of_channels) return part.kind != Part::Kind::course;
  return part.kind == Part::Kind::course ||
         (part.kind != Part::Kind::balls && !part.table.channels.empty());
}

/// `written`: axis or instance. std::nullopt if the effect cannot occur in the part, or if the part
/// has no such axis or instance. `Effect::applies` is not tested.
std::optional<Term> term_of(const Part& part, const Effect& effect, const std::string& written) {
  if (!can_be_in(part, effect)) return std::nullopt;
  if (effect.instances) {
    std::string of = written;
    if (part.kind == Part::Kind::course) {
      if (!is_for(part, written)) return std::nullopt;
      of.resize(std::min(of.find('/'), of.size()));
    }
    const auto places = effect.instances(part.table);
    if (std::find(places.begin(), places.end(), of) == places.end()) return std::nullopt;
    Axis place;
    place.name = std::move(of);
    place.rotary = part.kind == Part::Kind::course && part.table.angular;
    return Term{&effect, std::move(place), {}};
  }
  const std::string& of = written;
  for (const Axis& axis : part.axes)
    if (axis.name == of && concerns(part, axis)) {
      Term term{&effect, axis, {}};
      term.stated = stated_time_constant(part, effect, axis);
      return term;
    }
  return std::nullopt;
}

std::vector<std::string> offered_by(const Part& part, const Effect& effect) {
  if (!can_be_in(part, effect)) return {};
  if (effect.instances) return effect.instances(part.table);
  std::vector<std::string> names;
  for (const Axis& axis : part.axes)
    if (concerns(part, axis)) names.push_back(axis.name);
  return names;
}

}  // namespace

std::vector<Part> parts_of(const Campaign& campaign, const std::vector<Observations>& read) {
  std::vector<Part> parts = Parts(campaign, read).made();
  put_time_constants(campaign, read, parts);
  for (Part& part : parts) {
    leave_failed(part);
    leave_channels(part);
    part.groupings = groupings_of(part, campaign);
  }
  return parts;
}

bool is_for(const Part& part, const std::string& effect) {
  const std::size_t only = effect.find('/');
  if (part.kind != Part::Kind::course || only == std::string::npos) return true;
  const std::string names = "+" + effect.substr(only + 1) + "+";
  return names.find("+" + part.displacement + "+") != std::string::npos;
}

std::string written_for(const Part& part, const std::string& effect) {
  if (part.kind != Part::Kind::course || part.companions.size() + 1 >= part.displacements)
    return effect;
  std::vector<std::string> names = part.companion_names;
  names.push_back(part.displacement);
  std::sort(names.begin(), names.end());
  std::string of;
  for (const std::string& name : names) of += (of.empty() ? "/" : "+") + name;
  return effect + of;
}

std::vector<std::string> names_of(const Part& part, const Effect& effect) {
  std::vector<std::string> names;
  for (const std::string& of : offered_by(part, effect))
    if (const auto term = term_of(part, effect, of); term && effect.applies(part.table, term->axis))
      names.push_back(term->name());
  return names;
}

std::vector<Term> catalogue(const Part& part, const std::vector<Effect>& effects) {
  std::vector<Term> terms;
  for (const Effect& effect : effects) {
    if (effect.is_nuisance) continue;
    for (const std::string& of : offered_by(part, effect))
      if (auto term = term_of(part, effect, of); term && effect.applies(part.table, term->axis))
        terms.push_back(std::move(*term));
  }
  const std::size_t plain = terms.size();
  for (const auto& grouping : part.groupings)
    for (std::size_t t = 0; t < plain; ++t)
      if (auto term = grouped(part, terms[t], grouping->by)) terms.push_back(std::move(*term));
  return terms;
}

std::vector<Candidate> not_applying(const Part& part, const std::vector<Effect>& effects) {
  std::vector<Candidate> out;
  // No column of a file can state how a machine made the features of a part.
  const bool of_a_body = of_parts(part.table);
  for (const Effect& effect : effects) {
    if (effect.is_nuisance || effect.description || !effect.why_not) continue;
    for (const std::string& of : offered_by(part, effect)) {
      auto term = term_of(part, effect, of);
      if (!term || effect.applies(part.table, term->axis)) continue;
      WhyNot why = effect.why_not(part.table, term->axis);
      if (why.id.empty()) continue;
      Candidate c;
      c.term = std::move(*term);
      c.visible = false;
      c.why = of_a_body && why.id != "few-targets" ? "of-part" : std::move(why.id);
      c.rows = std::move(why.rows);
      out.push_back(std::move(c));
    }
  }
  return out;
}

std::vector<std::uint32_t> interpolated_temperatures(const Part& part) {
  std::vector<std::uint32_t> rows;
  for (const Axis& axis : part.axes)
    if (const auto r = readings_of(part.table, axis); r && r->temperature)
      rows.insert(rows.end(), r->interpolated.begin(), r->interpolated.end());
  std::sort(rows.begin(), rows.end());
  rows.erase(std::unique(rows.begin(), rows.end()), rows.end());
  return rows;
}

Expected<std::vector<Term>> terms_of(const Part& part, const Machine& machine,
                                     const std::vector<std::string>& names,
                                     const std::vector<Effect>& effects) {
  std::vector<Term> terms;
  for (const std::string& name : names) {
    const std::size_t colon = name.find(':');
    const std::string kind = name.substr(0, colon);
    const std::size_t at = std::min(name.find('@', colon), name.size());
    const std::string of = colon == std::string::npos ? "" : name.substr(colon + 1, at - colon - 1);
    const std::string by = at < name.size() ? name.substr(at + 1) : "";
    const auto effect = std::find_if(effects.begin(), effects.end(),
                                     [&](const Effect& e) { return e.info.name == kind; });
    if (effect == effects.end()) return fail("there is no effect \"" + kind + "\"");
    auto term = term_of(part, *effect, of);
    if (!term) {
      if (!effect->instances && machine.axis(of) == nullptr)
        return fail("effect \"" + name + "\": the machine has no axis \"" + of +
                    "\"; expected kind:axis, such as backlash:X");
      continue;
    }
    if (!effect->applies(part.table, term->axis))
      return fail("effect \"" + name +
                  "\" does not apply to these readings: " + effect->info.summary);
    if (at < name.size()) {
      auto groups = grouped(part, std::move(*term), by);
      if (!groups)
        return fail("effect \"" + name + "\": the measurements do not differ by \"" + by +
                    "\"; expected " + listed_groupings(part));
      term = std::move(groups);
    }
    terms.push_back(std::move(*term));
  }
  std::set<std::string> in_groups;
  for (const Term& term : terms)
    if (term.grouping) in_groups.insert(term.of_all());
  std::erase_if(terms, [&](const Term& term) { return in_groups.contains(term.name()); });
  for (const Effect& effect : effects) {
    if (!effect.is_nuisance) continue;
    for (const std::string& of : offered_by(part, effect))
      if (auto term = term_of(part, effect, of); term && effect.applies(part.table, term->axis))
        terms.push_back(std::move(*term));
  }
  std::stable_partition(terms.begin(), terms.end(),
                        [](const Term& term) { return !term.effect->description; });
  return terms;
}

std::vector<std::string> unstated_positions(const Part& part) {
  std::vector<bool> unstated(part.measurements.size(), false);
  for (const auto& axis : part.table.axes)
    for (std::size_t i = 0; i < axis.position.size(); ++i)
      if (std::isnan(axis.position[i])) unstated[part.measurement[i]] = true;
  std::vector<std::string> out;
  for (std::size_t m = 0; m < unstated.size(); ++m)
    if (unstated[m]) out.push_back(part.measurements[m]);
  return out;
}

}  // namespace nonio::model
