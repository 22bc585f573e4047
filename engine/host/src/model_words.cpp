// SPDX-License-Identifier: Apache-2.0
#include "nonio/host/model_words.h"

#include <cmath>

#include "nonio/sdk/format.h"

namespace nonio::host {

namespace {

using Kind = model::Verdict::Kind;

Number percent(const char* name, double share) {
  return {name, std::round(100.0 * share), Quantity::count};
}

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

std::string on_line(const model::Place& place) {
  return place.line.empty() ? "" : " (" + place.line + ")";
}

Finding place_finding(const model::Place& place, Quantity deviation) {
  return {.id = (place.line.empty() ? "place." : "place.line.") + place.where,
          .evidence = {percent("share", place.share),
                       {"rms", place.rms, deviation},
                       {"p", place.p, Quantity::probability}},
          .texts = {{"where", place.where}, {"line", place.line}}};
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
    if (!e.fails.empty() && e.fails.front().where == "run")
      f.id += "-run";
    else if (e.comparison.suspects.size() <= 2)
      f.id += "-two";
  }
  if (v.kind == Kind::missing && !e.candidates.empty()) {
    const model::Candidate& c = e.candidates.front();
    f.evidence.push_back({"after", c.rms, q});
    if (!c.aliases.empty()) {
      f.id = "verdict.missing-or-alias";
      f.texts.emplace_back("aliases", listed(c.aliases));
    }
  }
  if ((v.kind == Kind::nothing || v.kind == Kind::unknown) && !e.comparison.floor)
    f.id += "-without-floor";
  return f;
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
  const std::string largest = says("place.largest." + place.where, {}, {{"at", at}});
  return largest.empty() ? text : text + " " + largest;
}

std::string ModelWords::verdict(const model::Explanation& e, const PartModel& part) const {
  std::string text = finding_text(templates_, language_, verdict_finding(e, part), "says");
  if (e.verdict.kind != Kind::unknown) return text;
  if (!e.certain.empty())
    text = says(
        "verdict.certain", {{"rms", e.best_rms, part.deviation()}},
        {{"part", kind_of(part.part)}, {"axis", part.part.name}, {"effects", listed(e.certain)}});
  if (!e.fails.empty()) text += " " + place(e.fails.front(), part.deviation());
  return text;
}

std::string ModelWords::description(const model::Description& d, const PartModel& part) const {
  return says("description", {{"after", d.rms, part.deviation()}}, {{"effect", d.term.name()}});
}

std::string ModelWords::candidate(const model::Candidate& c, const PartModel& part,
                                  double rms_before) const {
  const Quantity q = part.deviation();
  const std::vector<Number> numbers = {{"before", rms_before, q},
                                       {"after", c.rms, q},
                                       {"p", c.p, Quantity::probability},
                                       {"detectable", c.minimal_detectable, q}};
  const char* id = c.score > 0.0 ? c.aliases.empty() ? "candidate.evidence" : "candidate.alias"
                                 : "candidate.none";
  return says(id, numbers, {{"effect", c.term.name()}, {"aliases", listed(c.aliases)}});
}

std::string ModelWords::unseen(const model::Candidate& c) const {
  const std::string text = says("unseen." + c.why, {}, {{"effect", c.term.name()}});
  return text.empty() ? says("unseen.other", {}, {{"effect", c.term.name()}, {"why", c.why}})
                      : text;
}

std::string ModelWords::plan(const model::Plan& plan) const {
  std::string text = says("plan." + plan.id,
                          {{"readings", static_cast<double>(plan.readings), Quantity::count},
                           {"power", plan.power, Quantity::number}},
                          {{"one", plan.one}, {"other", plan.other}, {"of", plan.of}});
  return text.empty() ? plan.id : text;
}

std::string ModelWords::suspect(const model::Suspect& s, const ReadingPlace& at, Quantity q) const {
  return says("suspect",
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

std::string ModelWords::not_told(const std::string& effect, std::size_t parameters) const {
  return says("not-told", {{"parameters", static_cast<double>(parameters), Quantity::count}},
              {{"effect", effect}});
}

std::string ModelWords::stood_somewhere() const { return says("stood-somewhere", {}, {}); }

std::vector<std::string> ModelWords::noise(const model::Fit& fit, const PartModel& part) const {
  using Zero = model::Noise::Zero;
  constexpr double told_below = 0.01;
  const model::Noise& noise = fit.noise;
  const Quantity q = part.deviation();
  std::vector<std::string> out;
  if (noise.neighbours > 0.0 && noise.p < told_below)
    out.push_back(says("noise.neighbours",
                       {{"r", std::round(100.0 * noise.measured) / 100.0, Quantity::number},
                        {"p", noise.p, Quantity::probability}},
                       {}));
  if (noise.zero != Zero::steady)
    out.push_back(says(noise.zero == Zero::walks    ? "noise.walks"
                       : noise.zero == Zero::of_run ? "noise.of-run"
                                                    : "noise.of-pass",
                       {{"s", noise.zero_size * fit.s, q}}, {}));
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

std::string ModelWords::order_unknown() const { return says("order-unknown", {}, {}); }

std::string ModelWords::unmeasured(const std::string& effect) const {
  return says("unmeasured", {}, {{"effect", effect}});
}

std::string ModelWords::card(const std::string& effect, const std::string& what) const {
  return words(templates_, language_, "effect." + kind_of(effect) + "." + what);
}

}  // namespace nonio::host
