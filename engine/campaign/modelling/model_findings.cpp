// SPDX-License-Identifier: Apache-2.0
// What a model means, as findings: verdict, places, plans, what to measure next.
#include <algorithm>
#include <cmath>
#include <set>

#include "campaign/modelling/model_verdict.h"
#include "campaign/modelling/model_words.h"
#include "nonio/sdk/format.h"

namespace nonio::modelling {

namespace {

using Kind = model::Verdict::Kind;
using model::Factor;

std::string id_of(Kind kind) {
  switch (kind) {
    case Kind::missing:
      return "missing";
    case Kind::nothing:
      return "nothing";
    case Kind::unknown:
      return "unknown";
    case Kind::unrepeatable:
      break;
  }
  return "unrepeatable";
}

}  // namespace

Number percent(const char* name, double share) {
  return {name, std::round(100.0 * share), Quantity::count};
}

std::string on_line(const model::Place& place) {
  return place.line.empty() ? "" : " (" + place.line + ")";
}

Finding place_finding(const model::Place& place, Quantity deviation) {
  const std::string of = place.together ? "together" : to_text(place.where);
  return {.id = (place.line.empty() ? "place." : "place.line.") + of,
          .evidence = {percent("share", place.share),
                       {"rms", place.rms, deviation},
                       {"p", place.p, Quantity::probability}},
          .texts = {{"where", to_text(place.where)}, {"line", place.line}}};
}

Finding plan_finding(const model::Plan& plan) {
  const auto minutes = [](const std::optional<double>& s) {
    return s ? fixed_text(std::max(1.0, std::round(*s / 60.0)), 0) + " min" : "";
  };
  return {.id = "plan." + plan.id,
          .evidence = {{"readings", static_cast<double>(plan.readings), Quantity::count},
                       {"power", plan.power, Quantity::number}},
          .texts = {{"one", plan.one},
                    {"other", plan.other},
                    {"of", plan.of},
                    {"duration", (plan.duration ? ", " : "") + minutes(plan.duration)},
                    {"every", minutes(plan.every)}}};
}

Finding description_finding(const model::Description& d, const PartModel& part) {
  using What = model::Description::What;
  const Quantity q = part.deviation();
  const char* of = d.what == What::reversal_at_targets ? "reversal"
                   : d.what == What::value_at_targets  ? "place"
                                                       : "course";
  return {.id = std::string("description.") + of,
          .evidence = {{"after", d.rms, q},
                       {"low", d.low, q},
                       {"high", d.high, q},
                       {"mean", d.mean, q}},
          .texts = {{"effect", d.term.name()}}};
}

Finding false_alarms_finding(const model::Verdict& v) {
  // Without a false alarm in n trials, the upper end of Wilson's 95 % interval is stated: z^2/(n +
  // z^2).
  const double n = static_cast<double>(v.trials), z2 = 1.959964 * 1.959964;
  const bool any = v.false_alarms > 0.0;
  const double share = any ? v.false_alarms : z2 / (n + z2);
  if (share > 0.4) return {.id = "false-alarms.often", .evidence = {percent("share", share)}};
  return {.id = any ? "false-alarms" : "false-alarms.none",
          .evidence = {{"times", std::round(1.0 / share), Quantity::count}}};
}

namespace {

// docs/dev/constants.md, M54.
// detectable size of an effect that the readings do not determine, in standard deviations
constexpr double undetermined_above = 10.0;
constexpr double improbable = 0.05;  // p below which readings show a sign of an effect

/// Whether the effect explains the readings as well as one of the model or of the best explanation.
bool replaces_another(const model::Explanation& e, const model::Candidate& c) {
  const auto names = [&](const std::vector<std::string>& all) {
    return std::find(all.begin(), all.end(), c.term.name()) != all.end();
  };
  return std::any_of(e.replaceable.begin(), e.replaceable.end(),
                     [&](const model::Replaceable& r) { return names(r.by); }) ||
         std::any_of(e.candidates.begin(), e.candidates.end(), [&](const model::Candidate& member) {
           return std::find(e.together.begin(), e.together.end(), member.term.name()) !=
                      e.together.end() &&
                  names(member.aliases);
         });
}

}  // namespace

std::vector<Finding> no_sign_findings(const model::Explanation& e, const PartModel& part) {
  std::vector<Finding> out;
  // The detection limit of displacements over time is not known.
  if (part.part.kind == model::Part::Kind::course) return out;
  std::vector<std::string> undetermined;
  for (const model::Candidate& c : e.candidates) {
    if (!is_ranked(c) || c.score > 0.0 || c.p < improbable) continue;
    if (replaces_another(e, c) || c.minimal_detectable > undetermined_above * e.comparison.fit.s) {
      undetermined.push_back(c.term.name());
      continue;
    }
    out.push_back({.id = out.empty() ? "no-sign.first" : "no-sign.other",
                   .evidence = {{"size", c.minimal_detectable, part.deviation()}},
                   .texts = {{"effect", c.term.name()}}});
  }
  if (!undetermined.empty())
    out.push_back({.id = out.empty() ? "no-sign.undetermined-first" : "no-sign.undetermined",
                   .evidence = {},
                   .texts = {{"effects", storage::listed(undetermined)}}});
  return out;
}

namespace {

// docs/dev/constants.md, M24.
constexpr double most_longer = 10.0;       // largest factor by which a longer test is proposed
constexpr std::size_t enough_targets = 9;  // with fewer targets, denser targets are proposed

class Next {
 public:
  Next(const model::Explanation& e, const PartModel& part) : e_(e), part_(part) {}

  std::vector<Finding> all() {
    plan();
    if (e_.sensors) sensors(*e_.sensors);
    if (e_.verdict.kind == Kind::unknown)
      for (const model::Place& place : e_.fails) at(place);
    return std::move(out_);
  }

 private:
  void add(const char* id, std::vector<Number> numbers = {},
           std::vector<std::pair<std::string, std::string>> texts = {}) {
    const std::string name = std::string("next.") + id;
    if (std::none_of(out_.begin(), out_.end(), [&](const Finding& f) { return f.id == name; }))
      out_.push_back({.id = name, .evidence = std::move(numbers), .texts = std::move(texts)});
  }

  static double rounded(double v) { return std::round(10.0 * v) / 10.0; }

  void sensors(const model::Sensors& s) {
    const auto q = part_.deviation();
    std::vector<std::string> names;
    for (const std::string& name : s.smallest) {
      const auto* channel = part_.part.table.channel(name);
      names.push_back(
          channel == nullptr || channel->place.empty() ? name : name + " (" + channel->place + ")");
    }
    const std::string needed = storage::listed(names);
    if (s.recorded > s.smallest.size())
      add("channels",
          {{"recorded", static_cast<double>(s.recorded), Quantity::count},
           {"rms", s.rms, q},
           {"smallest", s.rms_smallest, q}},
          {{"needed", needed}});
    if (!s.unseen.empty())
      add("thermometer", {{"tau_min", rounded(s.unseen_tau / 60.0), Quantity::number}},
          {{"channel", s.unseen}});
    if (s.wanted > s.measured)
      add(s.wanted > most_longer * s.measured ? "not-determined" : "longer",
          {{"percent", std::round(100.0 * s.relative_u), Quantity::count},
           {"measured_h", rounded(s.measured / 3600.0), Quantity::number},
           {"wanted_h", rounded(s.wanted / 3600.0), Quantity::number}},
          {{"effect", s.weakest}});
  }

  void plan() {
    if (e_.plans.empty()) return;
    if (is_circle() && is_one_way()) return circle();
    const auto good = std::find_if(e_.plans.begin(), e_.plans.end(),
                                   [](const model::Plan& p) { return p.separates(); });
    if (good != e_.plans.end()) return out_.push_back(plan_finding(*good));
    if (part_.part.kind == model::Part::Kind::course) return;
    const auto& lines = part_.part.table.lines;
    if (std::any_of(lines.begin(), lines.end(),
                    [](const auto& l) { return !l.body.empty() && !l.body_size_known; }))
      return add("part-size", {},
                 {{"one", e_.plans.front().one}, {"other", e_.plans.front().other}});
    const auto [low, high] = std::minmax_element(part_.part.along.begin(), part_.part.along.end());
    add("wider",
        {{"from", *low, part_.position()},
         {"to", *high, part_.position()},
         {"power", e_.plans.front().power, Quantity::number}},
        {{"one", e_.plans.front().one}, {"other", e_.plans.front().other}});
  }

  void at(const model::Place& place) {
    if (is_circle() && !place.where.has(Factor::run) && !place.where.has(Factor::temperature)) {
      circle();
    } else if (place.where.has(Factor::time) || place.where.has(Factor::run)) {
      time(place);
    } else if (place.where.has(Factor::temperature)) {
      add("settle");
    } else if (place.where.has(Factor::position) || place.where.has(Factor::screw_phase) ||
               place.where.has(Factor::angle)) {
      position(place);
    } else {
      add("both-sides");
    }
  }

  /// Whether each line is sensed in more than one direction, along the radius of its path.
  bool is_circle() const {
    const Observations& o = part_.part.table;
    if (part_.part.kind != model::Part::Kind::space || o.sense.empty()) return false;
    std::set<std::size_t> lines, paths;
    for (std::size_t i = 0; i < o.size(); ++i) {
      lines.insert(o.line_of(i));
      if (o.sense_of(i) != o.lines[o.line_of(i)].sense) paths.insert(o.line_of(i));
    }
    return paths.size() == lines.size();
  }

  bool is_one_way() const {
    const auto& way = part_.part.way;
    return std::equal(way.begin() + 1, way.end(), way.begin());
  }

  void circle() { add(is_one_way() ? "circle-other-way" : "circle-other-radius"); }

  void time(const model::Place& place) {
    const Observations& o = part_.part.table;
    const auto known = [&](const std::vector<double>& column) {
      return column.size() == o.size() &&
             std::any_of(column.begin(), column.end(), [](double v) { return std::isfinite(v); });
    };
    if (place.where.has(Factor::run) && place.at && std::isfinite(*place.at))
      add("run", {{"at", *place.at, Quantity::count}});
    if (!known(o.time))
      add("times");
    else if (!known(o.material))
      add("temperatures");
    add("settle");
  }

  void position(const model::Place& place) {
    std::set<double> targets(part_.part.along.begin(), part_.part.along.end());
    const auto count = static_cast<double>(targets.size());
    if (part_.part.kind == model::Part::Kind::axis && targets.size() < enough_targets)
      add("more-targets", {{"targets", count, Quantity::count},
                           {"wanted", static_cast<double>(enough_targets), Quantity::count}});
    else if (place.at && std::isfinite(*place.at))
      add("around", {{"at", *place.at, place.at_quantity}});
    else
      add("between");
  }

  const model::Explanation& e_;
  const PartModel& part_;
  std::vector<Finding> out_;
};

}  // namespace

std::vector<Finding> next_findings(const model::Explanation& e, const PartModel& part) {
  return Next(e, part).all();
}

std::optional<ModelFit::Curve> curve_of(const PartModel& part, const model::Fit& fit,
                                        std::size_t term) {
  if (!fit.terms[term].effect->curve) return std::nullopt;
  const std::vector<double>& says = fit.part[term];
  ModelFit::Curve out;
  double squares = 0.0, weight = 0.0;
  for (std::size_t i = 0; i < says.size(); ++i) {
    squares += fit.weight[i] * says[i] * says[i];
    weight += fit.weight[i];
  }
  const auto [low, high] = std::minmax_element(says.begin(), says.end());
  if (low == says.end() || !(weight > 0.0)) return std::nullopt;
  out.rms = std::sqrt(squares / weight);
  out.low = *low;
  out.high = *high;
  if (part.part.kind == model::Part::Kind::space) return out;
  const auto place = [&](double value) -> std::optional<double> {
    std::optional<double> at;
    for (std::size_t i = 0; i < says.size(); ++i) {
      if (!(std::fabs(says[i] - value) <= 1e-9 * (out.high - out.low))) continue;
      if (at && !(std::fabs(part.part.along[i] - *at) <= 1e-9)) return std::nullopt;
      at = part.part.along[i];
    }
    return at;
  };
  out.low_at = place(out.low);
  out.high_at = place(out.high);
  return out;
}

/// A single effect that would leave at most half of a course, but which chance may imitate.
static void put_unproven(const model::Explanation& e, Quantity q, Finding& f) {
  constexpr double at_most = 0.5, chance = 0.01;  // docs/dev/constants.md, M73
  const model::Candidate* best = nullptr;
  for (const model::Candidate& c : e.candidates)
    if (is_ranked(c) && (best == nullptr || c.rms < best->rms)) best = &c;
  if (best == nullptr || !(best->rms <= at_most * e.comparison.fit.rms) || !(best->p >= chance))
    return;
  f.id = "verdict.unknown-or-chance";
  for (auto& [key, text] : f.texts)
    if (key == "effect") text = best->term.name();
  f.evidence.push_back({"after", best->rms, q});
  f.evidence.push_back({"p", best->p, Quantity::probability});
}

Finding verdict_finding(const model::Explanation& e, const PartModel& part) {
  const model::Verdict& v = e.verdict;
  const Quantity q = part.deviation();
  Finding f{.id = "verdict." + id_of(v.kind), .attention = v.kind != Kind::nothing};
  f.evidence = {{"rms", e.comparison.fit.rms, q}, percent("suspects", v.suspects_share)};
  if (e.comparison.floor) f.evidence.push_back({"floor", e.comparison.floor->s, q});
  f.texts = {{"part", kind_of(part.part)}, {"axis", part.part.name}, {"effect", v.effect}};
  f.measurement = part.part.measurements.front();
  if (v.kind == Kind::unrepeatable) {
    const auto count = [](std::size_t n) { return static_cast<double>(n); };
    f.evidence.push_back({"count", count(e.comparison.suspects.size()), Quantity::count});
    f.evidence.push_back({"readings", count(part.part.table.size()), Quantity::count});
    if (!e.fails.empty() && e.fails.front().where == model::Where{Factor::run})
      f.id += "-run";
    else if (e.comparison.suspects.size() <= 2)
      f.id += "-two";
  }
  if (v.kind == Kind::missing && !e.candidates.empty()) {
    const model::Candidate& c = e.candidates.front();
    f.evidence.push_back({"after", c.rms, q});
    if (!c.aliases.empty()) {
      f.id = "verdict.missing-or-alias";
      f.texts.emplace_back("aliases", storage::listed(c.aliases));
    }
  }
  if ((v.kind == Kind::nothing || v.kind == Kind::unknown) && !e.comparison.floor)
    f.id += "-without-floor";
  if (v.kind == Kind::nothing && part.part.kind == model::Part::Kind::course && e.comparison.floor)
    f.id += "-over-time";
  if (const model::Fit& fit = e.comparison.fit; v.kind == Kind::nothing && e.comparison.floor &&
                                                fit.noise.zero == model::Noise::Zero::of_pass) {
    f.id += "-of-passes";
    f.evidence.push_back({"zero", fit.noise.zero_found * fit.s_noise, q});
  }
  if (v.kind == Kind::unknown && !e.together.empty() && e.comparison.floor) {
    f.id = "verdict.unknown-possible";
    f.texts.emplace_back("effects", storage::listed(e.together));
  }
  if (v.kind == Kind::unknown && part.part.kind == model::Part::Kind::course) put_unproven(e, q, f);
  if (v.below_scatter) f.id = "verdict.unknown-below-scatter";
  if (v.kind == Kind::unknown && !e.certain.empty()) {
    f.id = "verdict.certain";
    f.texts.emplace_back("effects", storage::listed(e.certain));
    f.evidence.push_back({"after", e.significant_rms, q});
  }
  return f;
}

}  // namespace nonio::modelling
