// SPDX-License-Identifier: Apache-2.0
#include "campaign/modelling/model_words.h"

#include <algorithm>
#include <cmath>

#include "campaign/modelling/model_verdict.h"
#include "campaign/modelling/thermal_tests.h"
#include "nonio/math/uncertainty.h"
#include "nonio/sdk/format.h"

namespace nonio::modelling {

namespace {

using Kind = model::Verdict::Kind;
using model::Factor;

std::string kind_of(const std::string& effect) { return effect.substr(0, effect.find(':')); }

}  // namespace

std::string where_largest(const model::Place& place, const std::string& language) {
  if (!place.at || !std::isfinite(*place.at)) return {};
  const std::string number =
      localised(evidence_text({"at", *place.at, place.at_quantity}), language);
  const std::string_view unit = unit_of(place.at_quantity).symbol;
  return unit.empty() ? number : number + " " + std::string(unit);
}

std::string ModelWords::says(const std::string& id, std::vector<Number> numbers,
                             std::vector<std::pair<std::string, std::string>> texts) const {
  return finding_text(templates_, language_,
                      {.id = id, .evidence = std::move(numbers), .texts = std::move(texts)},
                      "says");
}

std::string ModelWords::prediction(const model::Prediction& p, const PartModel& part) const {
  const Quantity q = part.deviation();
  double u = 0.0;
  for (const double one : p.u) u += one / static_cast<double>(p.u.size());
  std::vector<Number> numbers = {
      {"rms", p.rms, q}, {"sd", p.sd, q}, {"U", 2.0 * u, q}, percent("inside", p.inside)};
  std::string text =
      says(p.rms < p.sd ? "prediction" : "prediction.worse", numbers, {{"part", part.part.name}});
  if (p.fails_from)
    text += " " + says("prediction.fails", {{"from", *p.fails_from, Quantity::time}}, {});
  if (p.fails_until)
    text += " " + says("prediction.fails-until", {{"until", *p.fails_until, Quantity::time}}, {});
  if (u > p.sd) text += " " + says("prediction.undetermined", {}, {});
  if (p.left_out > 0)
    text += " " + says("prediction.left-out",
                       {{"count", static_cast<double>(p.left_out), Quantity::count}}, {});
  else if (p.outside)
    text += " " + says(part.part.kind == model::Part::Kind::course ? "prediction.outside"
                                                                   : "prediction.outside-places",
                       {}, {});
  return text;
}

std::string ModelWords::place(const model::Place& place, Quantity deviation) const {
  Finding f = place_finding(place, deviation);
  std::string text = finding_text(templates_, language_, f, "says");
  if (text.empty()) {
    f.id = "place.other";
    text = finding_text(templates_, language_, f, "says");
  }
  const std::string at = where_largest(place, language_);
  if (at.empty()) return text;
  const std::string largest = says("place.largest." + to_text(place.where), {}, {{"at", at}});
  return largest.empty() ? text : text + " " + largest;
}

std::string ModelWords::differs(const model::Candidate& c) const {
  constexpr std::size_t most = 6;
  const auto number = [&](double value, Quantity q) {
    return localised(evidence_text({"", value, q}), language_);
  };
  std::string values;
  std::size_t count = 0;
  for (const model::Parameter& p : c.parameters) {
    if (p.shape || p.group.empty() || ++count > most) continue;
    const std::string_view unit = unit_of(p.quantity).symbol;
    values += (values.empty() ? "" : ", ") + p.name + " " + number(p.value, p.quantity) +
              (unit.empty() ? "" : " " + std::string(unit)) +
              (std::isfinite(p.u) ? " (U " + number(2.0 * p.u, p.quantity) + ")" : "");
  }
  if (count > most) values += ", ...";
  return says("verdict.differs", {}, {{"by", c.term.grouping->by}, {"values", values}});
}

std::string ModelWords::statement(const model::Statement& s, Quantity q) const {
  const std::vector<Number> numbers = {
      {"value", s.value, q}, {"U", 2.0 * s.u, q}, {"low", s.low, q}, {"high", s.high, q}};
  return says(s.what == model::Statement::What::reversal ? "statement.reversal" : "statement.drift",
              numbers, {});
}

namespace {

/// The effect of the parts that a plan separates from the missing one, which is then no alias.
std::string same_of_part(const model::Explanation& e) {
  if (e.verdict.kind != Kind::missing || e.candidates.empty()) return {};
  const model::Candidate& first = e.candidates.front();
  for (const model::Plan& plan : e.plans)
    if (const std::string& same = first.term.effect->of_part;
        !same.empty() && plan.other == same + ":" + first.term.axis.name)
      return plan.other;
  return {};
}

}  // namespace

std::string ModelWords::verdict(const model::Explanation& e, const PartModel& part) const {
  std::string text = finding_text(templates_, language_, verdict_finding(e, part), "says");
  if (e.verdict.kind == Kind::missing && !e.candidates.empty() &&
      e.candidates.front().term.grouping)
    text += " " + differs(e.candidates.front());
  if (e.one_growth && e.verdict.kind == Kind::missing)
    text += " " + says("one-growth", {{"at", e.one_growth->at, Quantity::length}},
                       {{"growth", e.one_growth->growth}, {"drift", e.one_growth->drift}});
  if (const std::string other = same_of_part(e); !other.empty())
    text += " " + says("or-of-part", {}, {{"other", other}});
  std::string replaceable;
  for (const model::Replaceable& r : e.replaceable)
    replaceable +=
        (replaceable.empty() ? "" : ", ") + r.effect + " (" + storage::listed(r.by) + ")";
  if (!replaceable.empty()) text += " " + says("replaceable", {}, {{"effects", replaceable}});
  if (e.verdict.kind != Kind::unknown) return text;
  for (const model::Statement& s : e.statements) text += " " + statement(s, part.deviation());
  for (const auto& [one, other] : e.cancelling) text += " " + cancelling(one, other);
  if (!e.fails.empty()) text += " " + place(e.fails.front(), part.deviation());
  return text;
}

std::string ModelWords::description(const model::Description& d, const PartModel& part) const {
  return finding_text(templates_, language_, description_finding(d, part), "says");
}

std::string ModelWords::candidate(const model::Candidate& c, const PartModel& part,
                                  double rms_before) const {
  const Quantity q = part.deviation();
  const std::vector<Number> numbers = {{"before", rms_before, q},
                                       {"after", c.rms, q},
                                       {"p", c.p, Quantity::probability},
                                       {"detectable", c.minimal_detectable, q}};
  constexpr double worth_saying = 1.05;
  const char* id = !(c.score > 0.0) ? std::isfinite(c.minimal_detectable) ? "candidate.none"
                                                                          : "candidate.no-size"
                   : !c.with_descriptions.empty() ? "candidate.with-descriptions"
                   : !c.aliases.empty()           ? "candidate.alias"
                                                  : "candidate.evidence";
  std::string text = says(id, numbers,
                          {{"effect", c.term.name()},
                           {"aliases", storage::listed(c.aliases)},
                           {"descriptions", storage::listed(c.with_descriptions)}});
  if (c.score > 0.0 && c.bias > worth_saying)
    text += " " + says("candidate.near",
                       {{"detectable", c.minimal_detectable, q}, {"bias", c.bias, Quantity::ratio}},
                       {});
  return text;
}

std::string ModelWords::unseen(const model::Candidate& c, const RowsPlace& rows) const {
  const std::string text =
      says("unseen." + c.why, {{"count", static_cast<double>(rows.count), Quantity::count}},
           {{"effect", c.term.name()}, {"file", rows.file}, {"lines", rows.lines}});
  return text.empty() ? says("unseen.other", {}, {{"effect", c.term.name()}, {"why", c.why}})
                      : text;
}

std::string ModelWords::temperature_interpolated(const RowsPlace& rows) const {
  return says("temperature-interpolated",
              {{"count", static_cast<double>(rows.count), Quantity::count}},
              {{"file", rows.file}, {"lines", rows.lines}});
}

std::string ModelWords::cancelling(const std::string& one, const std::string& other) const {
  return says("cancelling", {}, {{"one", one}, {"other", other}});
}

std::string ModelWords::plan(const model::Plan& plan) const {
  std::string text = finding_text(templates_, language_, plan_finding(plan), "says");
  if (text.empty()) return plan.id;
  return plan.separates() || !(plan.power > 0.0)
             ? text
             : text + " " +
                   says("plan.too-little", {{"enough", model::enough_power, Quantity::number}}, {});
}

std::string ModelWords::no_sign(const model::Explanation& e, const PartModel& part) const {
  std::string text;
  for (const Finding& f : no_sign_findings(e, part))
    text += (text.empty() ? "" : "; ") + finding_text(templates_, language_, f, "says");
  return text.empty() ? text : text + ".";
}

std::vector<std::string> ModelWords::next(const model::Explanation& e,
                                          const PartModel& part) const {
  std::vector<std::string> out;
  for (const Finding& f : next_findings(e, part))
    out.push_back(finding_text(templates_, language_, f, "says"));
  return out;
}

std::string ModelWords::false_alarms(const model::Verdict& v) const {
  return finding_text(templates_, language_, false_alarms_finding(v), "says");
}

Finding left_finding(const model::Comparison& c, Quantity q) {
  const double s = c.floor ? c.floor->s : 0.0;
  const double beyond = std::sqrt(std::max(0.0, c.fit.rms * c.fit.rms - s * s));
  const char* id = !(c.lack_of_fit->p < model::place_p) || !(beyond > 0.0) ? "left.noise"
                   : beyond > s                                            ? "left.far-more"
                                                                           : "left.more";
  return {.id = id, .evidence = {{"beyond", beyond, q}}};
}

std::string ModelWords::lack_of_fit(const model::Comparison& c, Quantity q) const {
  return finding_text(templates_, language_, left_finding(c, q), "says");
}

std::string ModelWords::curve(const ModelFit::Curve& c, const PartModel& part) const {
  const Quantity q = part.deviation();
  std::vector<Number> numbers{{"rms", c.rms, q}, {"low", c.low, q}, {"high", c.high, q}};
  const bool placed = c.low_at && c.high_at;
  if (placed) {
    numbers.push_back({"low_at", *c.low_at, part.position()});
    numbers.push_back({"high_at", *c.high_at, part.position()});
  }
  return says(placed ? "curve.placed" : "curve", std::move(numbers), {});
}

std::string ModelWords::suspect(const model::Suspect& s, const ReadingPlace& at, Quantity q) const {
  return says(at.run == 0 && at.direction == 0 ? "suspect.feature" : "suspect",
              {{"residual", s.residual, q},
               {"detectable", s.minimal_detectable, q},
               {"target", at.target, at.position},
               {"run", static_cast<double>(at.run), Quantity::count},
               {"line", static_cast<double>(at.line), Quantity::count}},
              {{"direction", at.direction > 0 ? "+" : "-"},
               {"measurement", at.measurement},
               {"file", at.file}});
}

std::string ModelWords::below_uncertainty(const std::string& effect) const {
  return says("below-uncertainty", {}, {{"effect", effect}});
}

std::string ModelWords::gain_too_large(const model::Parameter& gain) const {
  return says("gain-too-large",
              {{"gain", gain.value, gain.quantity},
               {"U", 2.0 * gain.u, gain.quantity},
               {"most", model::most_per_kelvin, gain.quantity}},
              {{"effect", gain.effect}});
}

std::string ModelWords::not_identifiable(const std::string& effect, std::size_t parameters) const {
  return says("not-identifiable",
              {{"parameters", static_cast<double>(parameters), Quantity::count}},
              {{"effect", effect}});
}

std::optional<double> common_scale_uncertainty(const model::Part& part, const Campaign& campaign,
                                               const std::string& axis) {
  double length = 0.0;
  for (const auto& column : part.table.axes)
    if (column.axis == axis) {
      double low = INFINITY, high = -INFINITY;
      for (const double x : column.position)
        if (std::isfinite(x)) low = std::min(low, x), high = std::max(high, x);
      length = high - low;
    }
  return math::common_scale_uncertainty(campaign, axis, length);
}

std::vector<std::string> ModelWords::scales(const PartModel& part, const model::Fit& fit,
                                            const Campaign& campaign) const {
  std::vector<std::string> known, u_of_known, alone;
  for (const model::Parameter& p : fit.parameters) {
    if (!p.effect.starts_with("scale:") || p.held || p.shape ||
        p.quantity != Quantity::deviation_per_length)
      continue;
    const std::string axis = p.effect.substr(6, p.effect.find('@') - 6);
    if (const auto u = common_scale_uncertainty(part.part, campaign, axis)) {
      known.push_back(p.effect);
      u_of_known.push_back(localised(evidence_text({"u", *u, p.quantity}), language_) + " " +
                           std::string(unit_of(p.quantity).symbol));
    } else {
      alone.push_back(p.effect);
    }
  }
  std::vector<std::string> out;
  if (!known.empty())
    out.push_back(says("scale-of-readings", {},
                       {{"effects", storage::listed(known)}, {"u", storage::listed(u_of_known)}}));
  if (!alone.empty())
    out.push_back(says("scale-of-readings-alone", {}, {{"effects", storage::listed(alone)}}));
  return out;
}

std::string ModelWords::unstated_position(const std::vector<std::string>& measurements) const {
  return says("unstated-position", {}, {{"which", storage::listed(measurements)}});
}

std::string ModelWords::unstated_feed(const std::vector<std::string>& measurements) const {
  return says("unstated-feed", {}, {{"which", storage::listed(measurements)}});
}

std::vector<std::string> ModelWords::squareness_places(const model::Fit& fit) const {
  // `along` moves with an angle that turns `turned` as the squareness does; names of ISO 230-1
  struct Turn {
    const char *squareness, *angle, *along, *turned;
  };
  constexpr Turn turns[] = {{"squareness:XY", "yaw:X", "X", "Y"},
                            {"squareness:XZ", "pitch:X", "X", "Z"},
                            {"squareness:XZ", "roll:Y", "Y", "Z"},
                            {"squareness:YZ", "roll:X", "X", "Z"},
                            {"squareness:YZ", "pitch:Y", "Y", "Z"}};
  std::vector<std::string> out;
  for (const model::Term& term : fit.terms) {
    std::vector<std::string> angles, along;
    std::string turned;
    for (const Turn& turn : turns) {
      if (term.name() != turn.squareness ||
          std::ranges::none_of(fit.terms, [&](const auto& t) { return t.name() == turn.angle; }))
        continue;
      angles.emplace_back(turn.angle), along.emplace_back(turn.along);
      turned = turn.turned;
    }
    if (!angles.empty())
      out.push_back(says("squareness-place", {},
                         {{"effect", term.name()},
                          {"angles", storage::listed(angles)},
                          {"along", storage::listed(along)},
                          {"turned", turned}}));
  }
  return out;
}

std::vector<std::string> ModelWords::noise(const model::Fit& fit, const PartModel& part) const {
  using Zero = model::Noise::Zero;
  constexpr double significant_below = 0.01;
  const model::Noise& noise = fit.noise;
  const Quantity q = part.deviation();
  std::vector<std::string> out;
  // Readings over time have correlated noise, which u includes.
  if (part.part.kind == model::Part::Kind::course) return out;
  if (noise.neighbours > 0.0 && noise.p < significant_below)
    out.push_back(says("noise.neighbours",
                       {{"r", std::round(100.0 * noise.measured) / 100.0, Quantity::number},
                        {"p", noise.p, Quantity::probability}},
                       {}));
  if (noise.zero != Zero::steady)
    out.push_back(says(noise.zero == Zero::walks    ? "noise.walks"
                       : noise.zero == Zero::of_run ? "noise.of-run"
                                                    : "noise.of-pass",
                       {{"s", noise.zero_found * fit.s_noise, q}}, {}));
  std::string open;
  for (const model::Parameter& p : fit.parameters)
    if (noise.zero_open && !p.shape && !std::isfinite(p.u))
      open += (open.empty() ? "" : ", ") + p.effect + " " + p.name;
  if (!open.empty()) out.push_back(says("noise.open", {}, {{"parameters", open}}));
  if (const auto& stretch = noise.stretch) {
    const Quantity at = part.position();
    out.push_back(says("noise.stretch",
                       {{"from", stretch->from, at},
                        {"to", stretch->to, at},
                        {"inside", stretch->inside * fit.s, q},
                        {"outside", stretch->outside * fit.s, q}},
                       {}));
  }
  if (noise.digit / std::sqrt(12.0) > fit.s)
    out.push_back(says("noise.digit", {{"q", noise.digit, q}}, {}));
  return out;
}

std::string ModelWords::order_assumed(const std::string& measurement) const {
  return says("order-assumed", {}, {{"measurement", measurement}});
}

std::vector<std::string> ModelWords::recordings(const PartModel& part,
                                                const model::Fit& fit) const {
  std::vector<std::string> out;
  for (const auto& findings :
       {channel_findings(part), restart_findings(part, fit), time_constant_findings(part, fit)})
    for (const Finding& f : findings) out.push_back(finding_text(templates_, language_, f, "says"));
  return out;
}

std::string ModelWords::order_unknown() const { return says("order-unknown", {}, {}); }

std::string ModelWords::unmeasured(const std::string& effect) const {
  return says("unmeasured", {}, {{"effect", effect}});
}

std::string ModelWords::card(const std::string& effect, const std::string& what) const {
  const std::string name = "effect." + kind_of(effect) + "." + what;
  std::string text = words(templates_, language_, name);
  if (text.empty()) text = words(templates_, "en", name);
  // A plugin may use the former name of the key.
  return text.empty() && what == "remedy" ? card(effect, "cure") : text;
}

}  // namespace nonio::modelling
