// SPDX-License-Identifier: Apache-2.0
// Center and direction of rotary axes as text, JSON and CSV, and as parameters of controls.
#include "nonio/sdk/plugin.h"

#include <algorithm>
#include <set>

#include "nonio/sdk/fields.h"
#include "nonio/sdk/format.h"
#include "nonio/sdk/json_writer.h"
#include "vectors.h"

namespace nonio::rotary_vectors {

std::string millimetres(double si) { return fixed_text(printed(si, Quantity::length), 4); }
std::string component(double value) { return fixed_text(value, 7); }
std::string padded(std::string text, std::size_t width) {
  return std::string(width > text.size() ? width - text.size() : 0, ' ') + text;
}

namespace {

std::optional<Line> line_of(const Results::Analysed& a, const std::string& suffix) {
  const auto take = [&](const std::string& name, Value& into) {
    for (const Value& v : a.evaluation.values)
      if (v.name == name + suffix) {
        into = v;
        into.name = name;
        return true;
      }
    return false;
  };
  Line line;
  bool complete = take("radius", line.radius);
  for (std::size_t k = 0; k < 3; ++k)
    complete = complete && take(std::string("centre_") + "xyz"[k], line.centre[k]) &&
               take(std::string("direction_") + "ijk"[k], line.direction[k]);
  if (!complete) return std::nullopt;
  line.measurement = a.measurement;
  line.shares_reference = a.evaluation.uses;
  return line;
}

std::string noted(const Evaluation& e, std::string_view note) {
  for (const Remark& r : e.notes)
    for (const auto& [name, text] : r.texts)
      if (r.id == note && name == "axes") return text;
  return {};
}

void put_chain(const Campaign& campaign, const Results::Analysed& a, std::vector<Line>& lines) {
  const std::string heads = ", " + noted(a.evaluation, "rotary-chain.heads") + ",";
  for (const Axis& axis : campaign.machine.axes) {
    auto line = axis.rotary ? line_of(a, "_" + axis.name) : std::nullopt;
    if (!line) continue;
    std::erase_if(lines, [&](const Line& other) { return other.axis == axis.name; });
    line->axis = axis.name;
    line->of_chain = true;
    line->tables = noted(a.evaluation, "rotary-chain.tables");
    line->head = heads.find(", " + axis.name + ",") != std::string::npos;
    lines.push_back(std::move(*line));
  }
}

}  // namespace

std::vector<Line> lines_of(const Campaign& campaign, const Results& results) {
  std::vector<Line> lines;
  for (const Results::Analysed& a : results.analyses) {
    auto line = line_of(a, "");
    if (!line) continue;
    for (const Measurement& m : campaign.measurements)
      if (m.id == a.measurement) line->axis = m.axis;
    lines.push_back(std::move(*line));
  }
  for (const Results::Analysed& a : results.analyses)
    if (a.plugin == "rotary-chain") put_chain(campaign, a, lines);
  return lines;
}

namespace {

void put(JsonWriter& json, std::string_view name, const Value& v) {
  json.key(name);
  json.begin_object();
  json.member("value", printed(v.value, v.quantity));
  json.member("unit", unit_of(v.quantity).symbol);
  if (v.U) json.member("U", printed(*v.U, v.quantity));
  json.end_object();
}

std::string json_of(const Campaign& campaign, const std::vector<Line>& lines) {
  JsonWriter json;
  json.begin_object();
  json.member("schema", "nonio-rotary-vectors/1");
  json.member("campaign", campaign.id);
  json.objects("axes", lines, [&](const Line& line) {
    json.member("measurement", line.measurement);
    json.member("axis", line.axis);
    for (const auto* values : {&line.centre, &line.direction})
      for (const Value& v : *values) put(json, v.name, v);
    put(json, "radius", line.radius);
    if (line.head) json.member("seen_from", "tool tip");
    json.member("compared_with", line.shares_reference);
  });
  json.end_object();
  return json.take();
}

std::string csv(const std::vector<Line>& lines) {
  std::string out = "measurement,axis,name,value,unit,U\n";
  const auto digits = [](double si, Quantity q) {
    return q == Quantity::length ? millimetres(si) : component(si);
  };
  for (const Line& line : lines) {
    std::vector<const Value*> values;
    for (const auto* three : {&line.centre, &line.direction})
      for (const Value& v : *three) values.push_back(&v);
    values.push_back(&line.radius);
    for (const Value* v : values)
      out += csv_text(line.measurement) + "," + csv_text(line.axis) + "," + v->name + "," +
             digits(v->value, v->quantity) + "," + std::string(unit_of(v->quantity).symbol) + "," +
             (v->U ? digits(*v->U, v->quantity) : "") + "\n";
  }
  return out;
}

std::string text(const Campaign& campaign, const std::vector<Line>& lines) {
  std::string out = "Rotary axes of " + campaign.id + "\n";
  out += "mm, in the coordinates of the linear axes that read the ball; U: expanded, k = 2\n";
  out += "positive angles turn right-handed about the direction\n";
  for (const Line& line : lines) {
    out += "\naxis " + line.axis + " (measurement " + line.measurement + "), " +
           (line.head ? "as seen from the tip of the tool at radius " : "ball at radius ") +
           millimetres(line.radius.value) + " mm\n";
    for (std::size_t k = 0; k < 3; ++k) {
      const Value &c = line.centre[k], &d = line.direction[k];
      out += std::string("  ") + "xyz"[k] + padded(millimetres(c.value), 14) + " +- " +
             padded(c.U ? millimetres(*c.U) : "?", 8) + "    " + "ijk"[k] +
             padded(component(d.value), 12) + " +- " + padded(d.U ? component(*d.U) : "?", 10) +
             "\n";
    }
  }
  return out;
}

bool applies(const Campaign& campaign) {
  return std::any_of(campaign.measurements.begin(), campaign.measurements.end(),
                     [](const Measurement& m) { return m.kind == "ball-centres"; });
}

/// Ids of plausibility findings without a stated reason for acceptance (text `accepted`). They
/// prevent files for controls, as for tables.
std::string doubts_of(const Campaign& campaign, const Results& results) {
  std::set<std::string> ids;
  const auto is_used = [&](const std::string& id) {
    return std::none_of(
        campaign.measurements.begin(), campaign.measurements.end(),
        [&](const Measurement& m) { return m.id == id && m.kind != "ball-centres"; });
  };
  for (const Results::Analysed& a : results.analyses)
    for (const Finding& f : a.evaluation.findings)
      if (f.id.starts_with("plausibility.") && is_used(f.measurement) &&
          std::none_of(f.texts.begin(), f.texts.end(),
                       [](const auto& text) { return text.first == "accepted"; }))
        ids.insert(f.id);
  std::string list;
  for (const std::string& id : ids) list += (list.empty() ? "" : ", ") + id;
  return list;
}

std::string measurements_of(const std::vector<Line>& lines) {
  std::string list;
  for (const Line& line : lines) list += (list.empty() ? "" : ", ") + line.measurement;
  return list;
}

Expected<OutputResult> write(const OutputInput& in) {
  OutputResult result;
  const std::vector<Line> lines = lines_of(in.campaign, in.results);
  if (lines.empty()) {
    result.findings.push_back({.id = "vectors.none", .attention = true});
    return result;
  }
  result.artifacts = {{"rotary-vectors.txt", text(in.campaign, lines)},
                      {"rotary-vectors.json", json_of(in.campaign, lines)},
                      {"rotary-vectors.csv", csv(lines)}};
  const std::string doubts = doubts_of(in.campaign, in.results);
  const Wish wish{in.options.number("limit_mm") * 1e-3, in.options.texts("sign_shown"),
                  in.options.tables("before")};
  if (doubts.empty())
    write_controllers(lines, in.campaign.id, wish, result);
  else
    result.findings.push_back({.id = "table.withheld",
                               .attention = true,
                               .texts = {{"output", "rotary-vectors"},
                                         {"findings", doubts},
                                         {"measurements", measurements_of(lines)}}});
  result.notes.push_back({.id = "vectors.frame"});
  return result;
}

std::vector<Option> options() {
  return {
      within(
          1e-3, 1e3,
          {"limit_mm", 0.2, "mm",
           "Largest change of a parameter against what is stated in `before`; beyond it no file."}),
      {"sign_shown", std::vector<std::string>{}, "",
       "Controls on which a move has shown the signs: heidenhain, siemens."},
      {"before", NumberTables{}, "",
       "What each control has now, mm: [options.rotary-vectors.before.fanuc] 19700 = 412.3"}};
}

}  // namespace

NONIO_PLUGIN(registry) {
  Output output;
  output.info = {"rotary-vectors", "1.0.0",
                 "Centre and direction of rotary axes as text, JSON, CSV, and for controls.",
                 options()};
  output.applies = applies;
  output.write = write;
  registry.add(std::move(output));
}

}  // namespace nonio::rotary_vectors
