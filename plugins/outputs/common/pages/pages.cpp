// SPDX-License-Identifier: Apache-2.0
#include "pages.h"

#include <algorithm>
#include <cmath>
#include <set>

#include "nonio/math/rotary.h"
#include "nonio/reports/number.h"
#include "nonio/reports/text.h"
#include "nonio/sdk/format.h"

namespace nonio::pages {

using namespace reports;

std::string symbol(std::string_view name) {
  std::string out(name);
  if (out.size() > 1 && (out.back() == '+' || out.back() == '-')) {
    const bool plus = out.back() == '+';
    out.pop_back();
    out += plus ? "↑" : "↓";
  }
  if (const std::size_t at = out.find("+-"); at != std::string::npos) out.replace(at, 2, "±");
  std::replace(out.begin(), out.end(), '_', ' ');
  // U of the standard VDI/DGQ 3441 is a range, not an uncertainty.
  if (out == "U max" || out == "U mean" || out == "U") out.insert(1, "(VDI)");
  return out;
}

std::string plain_number(const Source& source, double si, Quantity q) {
  std::string text = short_text(printed(si, q), 4);
  if (text.find('.') != std::string::npos && text.find('e') == std::string::npos) {
    text.erase(text.find_last_not_of('0') + 1);
    if (text.back() == '.') text.pop_back();
  }
  return localised(text, source.language());
}

std::string instrument_U(const Source& source) {
  const Instrument& i = source.in.campaign.instrument;
  std::string text;
  const auto add = [&](const std::optional<double>& value, Quantity q, const char* times) {
    if (!value) return;
    text +=
        (text.empty() ? "" : " + ") + plain_number(source, *value, q) + " " + unit_text(q) + times;
  };
  add(i.U_fixed, Quantity::deviation, "");
  add(i.U_per_length, Quantity::deviation_per_length, " · L");
  if (i.U_angle) {
    if (!text.empty()) text += "; ";
    text += plain_number(source, *i.U_angle, Quantity::angular_deviation) + " " +
            unit_text(Quantity::angular_deviation);
  }
  return text;
}

std::string without_gaps(std::string line) {
  constexpr std::string_view between = " · ";
  const std::string twice = std::string(between) + std::string(between);
  while (line.find(twice) != std::string::npos) line.erase(line.find(twice), between.size());
  if (line.starts_with(between)) line.erase(0, between.size());
  if (line.ends_with(between)) line.resize(line.size() - between.size());
  return line;
}

namespace {

/// Warnings first. The same id from two analyses is listed once; several findings of one analysis
/// with the same id are kept.
std::vector<const Finding*> findings_of(const std::vector<const Results::Analysed*>& analyses) {
  std::vector<const Finding*> out;
  for (const auto* analysed : analyses) {
    const auto others = static_cast<std::ptrdiff_t>(out.size());
    for (const Finding& f : analysed->evaluation.findings) {
      const auto same = std::find_if(out.begin(), out.begin() + others,
                                     [&](const Finding* known) { return known->id == f.id; });
      if (same == out.begin() + others)
        out.push_back(&f);
      else if (f.attention && !(*same)->attention)
        *same = &f;
    }
  }
  std::stable_partition(out.begin(), out.end(), [](const Finding* f) { return f->attention; });
  return out;
}

std::string temperatures(const Source& source, const char* key, const std::vector<double>& values) {
  double low = 1e9, high = -1e9;
  for (const double v : values)
    if (std::isfinite(v)) low = std::min(low, v), high = std::max(high, v);
  if (low > high) return {};
  const auto text = [&](double v) {
    return printed_number(v, Quantity::temperature, 1, source.language());
  };
  return " " + source.words.get(key, {{"from", text(low)}, {"to", text(high)}});
}

/// Speeds of the spindle from its angle, which applies until the next reading of a sensor.
std::string speeds(const Source& source, const Observations& o) {
  if (o.axes.empty() || o.axes.front().position.size() != o.size()) return {};
  double low = INFINITY, high = -INFINITY;
  for (std::size_t i = 1; i < o.size(); ++i) {
    const double turns =
        (o.axes.front().position[i] - o.axes.front().position[i - 1]) / (2.0 * std::numbers::pi);
    if (o.line_of(i) != o.line_of(i - 1) || !(o.time[i] > o.time[i - 1])) continue;
    const double rpm = 60.0 * turns / (o.time[i] - o.time[i - 1]);
    low = std::min(low, rpm), high = std::max(high, rpm);
  }
  if (low > high || (low == 0.0 && high == 0.0)) return {};
  const auto text = [&](double rpm) {
    return printed_number(rpm, Quantity::number, 0, source.language());
  };
  return " " + source.words.get("measurement.speed", {{"from", text(low)}, {"to", text(high)}});
}

std::string evaluated(const Source& source, const Measured& m) {
  double targets = 0, left_out = 0;
  for (const Results::Analysed* a : m.analyses) {
    double concerned = 0;
    for (const Finding& f : a->evaluation.findings)
      if (f.id == "targets.unpaired-left-out" || f.id == "readings.too-few-left-out")
        for (const Number& n : f.evidence) {
          if (n.name == "targets") targets = n.value;
          if (n.name == "concerned") concerned += n.value;
        }
    left_out = std::max(left_out, concerned);
  }
  if (left_out == 0) return {};
  return " " + source.words.get(
                   "measurement.evaluated",
                   {{"evaluated", printed_number(targets - left_out, Quantity::count, 0, "en")},
                    {"targets", printed_number(targets, Quantity::count, 0, "en")}});
}

}  // namespace

std::string plane_of(const Measurement& m) {
  std::string first, second;
  for (const auto& [axis, from] : m.from) {
    const auto to = m.to.find(axis);
    (to != m.to.end() && to->second != from ? first : second) += axis;
  }
  return first + second;
}

std::string circle_test(const Source& source, const Measured& m) {
  const Observations& o = m.observations;
  bool plus = false, minus = false;
  for (const auto& line : o.lines) {
    plus |= line.name.find(" +") != std::string::npos;
    minus |= line.name.find(" -") != std::string::npos;
  }
  double radius = 0.0;
  for (const auto& [axis, to] : m.measurement.to)
    if (const auto from = m.measurement.from.find(axis); from != m.measurement.from.end())
      radius = std::max(radius, std::fabs(to - from->second));
  const auto number = [&](double v) {
    std::string shortest;
    append_shortest(shortest, std::round(v * 1e6) / 1e6);
    return localised(shortest, source.language());
  };
  std::string directions = plus ? source.words.get("plot.ccw") : "";
  if (minus) directions += (plus ? ", " : "") + source.words.get("plot.cw");
  return source.words.get(
      "measurement.circle_test",
      {{"count", std::to_string(o.size())},
       {"radius", number(radius * 1e3)},
       {"feed", m.measurement.feed ? source.words.get("measurement.circle_feed",
                                                      {{"feed", number(*m.measurement.feed * 6e4)}})
                                   : ""},
       {"directions", directions}});
}

std::string heading_of(const Source& source, const Measured& m) {
  const Wording& words = source.words;
  const Measurement& measurement = m.measurement;
  const auto ids = [&](const std::string& heading) {
    return measurement.id == measurement.axis
               ? heading
               : words.get("measurement.of", {{"heading", heading}, {"id", measurement.id}});
  };
  if (measurement.kind == "axis")
    return ids(words.get(m.rotary ? "measurement.rotary" : "measurement.linear",
                         {{"axis", measurement.axis}}));
  if (measurement.kind == "straightness")
    return ids(words.get("measurement.straightness",
                         {{"axis", measurement.axis}, {"lateral", measurement.lateral}}));
  if (measurement.kind == "angle")
    return ids(words.get("measurement.angle",
                         {{"axis", measurement.axis}, {"about", measurement.lateral}}));
  if (measurement.kind == "diagonal")
    return words.get("measurement.diagonal", {{"id", measurement.id}});
  if (measurement.kind == "ball-centres") {
    const std::string other = math::other_turning_axis(m.observations);
    if (other.empty())
      return ids(words.get("measurement.ball_centres", {{"axis", measurement.axis}}));
    const auto [first, second] = std::minmax(measurement.axis, other);
    return ids(words.get("measurement.ball_centres_of_axes", {{"axes", first + ", " + second}}));
  }
  if (measurement.kind == "artefact" || measurement.kind == "artefact-certificate")
    return ids(words.get(measurement.kind == "artefact" ? "measurement.artefact"
                                                        : "measurement.artefact_certificate",
                         {{"artefact", measurement.lateral}}));
  if (measurement.kind == "circle")
    return words.get(
        "measurement.of",
        {{"heading", words.get("measurement.circle", {{"plane", plane_of(measurement)}})},
         {"id", measurement.id}});
  if (is_heat(measurement))
    return words.get(
        "measurement.of",
        {{"heading", measurement.axis.empty()
                         ? words.get("measurement." + measurement.kind)
                         : words.get("measurement.thermal_axis", {{"axis", measurement.axis}})},
         {"id", measurement.id}});
  if (measurement.kind == "rtcp")
    return ids(words.get("measurement.rtcp", {{"axis", measurement.axis}}));
  if (measurement.kind == "step-diagonal")
    return words.get("measurement.step_diagonal", {{"id", measurement.id}});
  return words.get("measurement.other", {{"id", measurement.id}, {"kind", measurement.kind}});
}

std::vector<double> along_line(const Measured& m) {
  const auto& axes = m.observations.axes;
  if (m.measurement.kind != "diagonal" || axes.size() < 2) return axes.front().position;
  std::vector<double> along(m.observations.size(), 0.0);
  for (std::size_t i = 0; i < along.size(); ++i) {
    for (const auto& axis : axes) {
      const auto from = m.measurement.from.find(axis.axis);
      const double way = axis.position[i] - (from == m.measurement.from.end() ? 0.0 : from->second);
      along[i] = std::hypot(along[i], way);
    }
    // Rounded to the resolution of files, from which the components along the axes were computed.
    along[i] = std::round(along[i] / grid_tolerance) * grid_tolerance;
  }
  return along;
}

std::string test_of(const Source& source, const Measured& m) {
  const Observations& o = m.observations;
  if (o.size() == 0 || (o.axes.empty() && !is_heat(m.measurement)))
    return source.words.get("measurement.unread");
  if (m.measurement.kind == "thermal" && o.time.size() == o.size()) {
    const auto [first, last] = std::minmax_element(o.time.begin(), o.time.end());
    return source.words.get("measurement.thermal_test",
                            {{"count", std::to_string(o.size())},
                             {"minutes", localised(short_text((*last - *first) / 60.0, 4),
                                                   source.language())}}) +
           (m.measurement.axis.empty() ? speeds(source, o) : "") +
           temperatures(source, "measurement.material", o.material) +
           temperatures(source, "measurement.air", o.air);
  }
  const bool centres = m.measurement.kind == "ball-centres" || m.measurement.kind == "artefact";
  if (m.measurement.kind == "circle")
    return circle_test(source, m) + temperatures(source, "measurement.material", o.material) +
           temperatures(source, "measurement.air", o.air);
  if (!over_one_position(m.measurement))
    return source.words.get(centres ? "measurement.centres" : "measurement.readings",
                            {{"count", std::to_string(centres ? o.size() / 3 : o.size())}}) +
           temperatures(source, "measurement.material", o.material) +
           temperatures(source, "measurement.air", o.air);
  const auto& axis = o.axes.front();
  std::vector<double> targets = along_line(m);
  std::sort(targets.begin(), targets.end());
  targets.erase(std::unique(targets.begin(), targets.end()), targets.end());
  std::vector<std::uint32_t> runs = o.run;
  std::sort(runs.begin(), runs.end());
  const auto run_count = std::unique(runs.begin(), runs.end()) - runs.begin();
  bool plus = false, minus = false;
  for (const std::int8_t a : axis.approach) plus |= a > 0, minus |= a < 0;
  const Quantity q = position_of(axis.rotary);
  const auto position = [&](double p) {
    return printed_number(p, q, decimals_for({p}, q, 4), source.language());
  };
  std::string text =
      source.words.get(run_count == 1 ? "measurement.test_one" : "measurement.test",
                       {{"targets", std::to_string(targets.size())},
                        {"from", position(targets.front())},
                        {"to", position(targets.back())},
                        {"unit", unit_text(q)},
                        {"runs", std::to_string(run_count)},
                        {"directions", source.words.get(plus && minus ? "measurement.both"
                                                        : minus       ? "measurement.minus"
                                                                      : "measurement.plus")}});
  text += evaluated(source, m);
  if (o.missing > 0)
    text += " " + source.words.get("measurement.missing", {{"count", std::to_string(o.missing)}});
  return text + temperatures(source, "measurement.material", o.material) +
         temperatures(source, "measurement.air", o.air);
}

std::vector<Measured> measured(const OutputInput& in) {
  static const Observations nothing;
  std::vector<Measured> out;
  const Campaign& campaign = in.campaign;
  for (std::size_t i = 0; i < campaign.measurements.size(); ++i) {
    const Measurement& measurement = campaign.measurements[i];
    const Observations& observations = i < in.observations.size() ? in.observations[i] : nothing;
    const Axis* axis = campaign.machine.axis(measurement.axis);
    Measured m{measurement, observations, axis != nullptr && axis->rotary, {}, {}};
    for (const Results::Analysed& a : in.results.analyses)
      if (a.measurement == measurement.id) m.analyses.push_back(&a);
    m.findings = findings_of(m.analyses);
    out.push_back(std::move(m));
  }
  return out;
}

Expected<void> check_texts(const Campaign& c, const Fonts& fonts) {
  const Machine& m = c.machine;
  const Instrument& i = c.instrument;
  const Laboratory& l = c.laboratory;
  const CertificateTexts& t = c.certificate;
  std::vector<std::pair<std::string, std::string>> texts = {
      {"campaign.customer", c.customer},
      {"campaign.customer_address", c.customer_address},
      {"campaign.site", c.site},
      {"campaign.operator", c.operator_name},
      {"machine.description", m.description},
      {"machine.condition", m.condition},
      {"machine.maker", m.maker},
      {"machine.model", m.model},
      {"machine.serial", m.serial},
      {"instrument.maker", i.maker},
      {"instrument.model", i.model},
      {"instrument.serial", i.serial},
      {"instrument.certificate", i.certificate},
      {"instrument.issuer", i.issuer},
      {"laboratory.name", l.name},
      {"laboratory.address", l.address},
      {"laboratory.country", l.country},
      {"laboratory.accreditation", l.accreditation},
      {"laboratory.authoriser", l.authoriser},
      {"laboratory.contact", l.contact},
      {"certificate.procedure", t.procedure},
      {"certificate.deviations", t.deviations},
      {"certificate.no_other_deviations_by", t.no_other_deviations_by},
      {"environment.warm_up", c.environment.warm_up},
      {"environment.sensors", c.environment.sensors},
      {"certificate.conditions", t.conditions},
      {"certificate.opinions", t.opinions},
      {"certificate.amendment", t.amendment}};
  for (const Sensor& s : c.sensors)
    for (const auto& [key, text] : {std::pair{".maker", &s.maker},
                                    {".model", &s.model},
                                    {".serial", &s.serial},
                                    {".certificate", &s.certificate},
                                    {".issuer", &s.issuer}})
      texts.emplace_back("sensor " + s.measures + key, *text);
  for (const auto& [language, title] : t.title) texts.emplace_back("certificate.title", title);
  for (const Axis& a : m.axes) {
    texts.emplace_back("machine.axes." + a.name, a.name);
    for (const auto& [name, limit] : a.tolerance)
      texts.emplace_back("machine.axes." + a.name, name);
  }
  for (const Measurement& one : c.measurements) {
    const std::string key = "measurement." + one.id + ".";
    texts.emplace_back(key + "id", one.id);
    texts.emplace_back(key + "axis", one.axis);
    texts.emplace_back(key + "lateral", one.lateral);
    texts.emplace_back(key + "file", one.file);
    texts.emplace_back(key + "exclude_reason", one.exclude_reason);
    for (const Tolerance& limit : one.tolerances)
      texts.emplace_back(key + tolerance_key(limit.quantity), limit.result);
  }
  for (const auto& [key, text] : texts)
    if (auto printable = check_text(text, fonts, key); !printable) {
      printable.error().key = key;
      return printable;
    }
  return {};
}

namespace {
std::set<std::string> places_of(const std::string& text) {
  std::set<std::string> out;
  for (std::size_t open = text.find('{'); open != std::string::npos;
       open = text.find('{', open + 1))
    if (const std::size_t close = text.find('}', open); close != std::string::npos)
      out.insert(text.substr(open, close - open + 1));
  return out;
}

void check_file(const Settings& words, const Settings& english, const Fonts& fonts,
                const std::string& file, std::vector<Error>& errors) {
  for (const auto& [key, value] : english.values)
    if (!words.has(key)) errors.push_back(Error{"the key \"" + key + "\" is missing", file});
  for (const auto& [key, value] : words.values) {
    const auto* text = std::get_if<std::string>(&value);
    const auto known = english.values.find(key);
    if (known == english.values.end() || text == nullptr)
      errors.push_back(Error{
          "the key \"" + key + "\" " + (text == nullptr ? "should be a text" : "is not known"),
          file});
    else if (const auto* wanted = std::get_if<std::string>(&known->second);
             wanted != nullptr && places_of(*wanted) != places_of(*text))
      errors.push_back(
          Error{"the places in braces of \"" + key + "\" are others than in English", file});
    else if (auto printable = check_text(*text, fonts, key); !printable)
      errors.push_back(Error{printable.error().message, file});
  }
}

void check_words(const Templates& templates, const std::string& name, const Fonts& fonts,
                 std::vector<Error>& errors) {
  for (const auto& [table, settings] : templates.tables) {
    if (!table.starts_with("words/") || !table.ends_with("/" + name)) continue;
    const std::string language = table.substr(6, table.size() - 7 - name.size());
    for (const std::string& file : {std::string("results"), name}) {
      const auto english = templates.tables.find("words/en/" + file);
      const auto words = templates.tables.find("words/" + language + "/" + file);
      const std::string path = "templates/words/" + language + "/" + file + ".toml";
      if (english == templates.tables.end() || words == templates.tables.end())
        errors.push_back(Error{"the words of this language are missing", path});
      else
        check_file(words->second, english->second, fonts, path, errors);
    }
  }
}

}  // namespace

std::vector<Error> check_templates(const Templates& templates, const std::string& name,
                                   Expected<Look> (*look_of)(const Templates&,
                                                             const std::string&)) {
  std::vector<Error> errors;
  for (const auto& [table, settings] : templates.tables) {
    if (table != name && !table.starts_with(name + "-")) continue;
    const auto look = look_of(templates, table);
    const auto fonts = look ? fonts_of(templates, *look) : fail(look.error());
    if (!fonts)
      errors.push_back(fonts.error());
    else if (table == name)
      check_words(templates, name, **fonts, errors);
  }
  return errors;
}

}  // namespace nonio::pages
