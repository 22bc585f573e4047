// SPDX-License-Identifier: Apache-2.0
#include "nonio/host/results_json.h"

#include <cmath>

#include "json_values.h"
#include "nonio/host/digest.h"

namespace nonio::host {

namespace {

void put(Json& json, const char* key, const std::string& value) {
  if (!value.empty()) json[key] = value;
}

Json campaign_json(const Campaign& c) {
  Json json = {{"id", c.id}};
  put(json, "customer", c.customer);
  put(json, "site", c.site);
  put(json, "operator", c.operator_name);
  put(json, "date", c.date);
  Json machine = Json::object();
  put(machine, "maker", c.machine.maker);
  put(machine, "model", c.machine.model);
  put(machine, "serial", c.machine.serial);
  put(machine, "structure", c.machine.structure);
  put(machine, "control", c.machine.control);
  if (!machine.empty()) json["machine"] = std::move(machine);
  Json instrument = Json::object();
  put(instrument, "maker", c.instrument.maker);
  put(instrument, "model", c.instrument.model);
  put(instrument, "serial", c.instrument.serial);
  put(instrument, "calibrated", c.instrument.calibrated);
  put(instrument, "certificate", c.instrument.certificate);
  if (!instrument.empty()) json["instrument"] = std::move(instrument);
  return json;
}

Json notes_json(const std::vector<Remark>& notes) {
  Json json = Json::array();
  for (const Remark& note : notes)
    json.push_back((note.measurement.empty() ? "" : "measurement " + note.measurement + ": ") +
                   note.english);
  return json;
}

Json value_json(const Value& v, const std::string& measurement, const std::string& plugin,
                const std::vector<Conformity>& conformity) {
  Json json = {{"value", printed(v.value, v.quantity)}, {"unit", unit_of(v.quantity).symbol}};
  if (v.U) json["U"] = printed(*v.U, v.quantity);
  for (const Conformity& c : conformity)
    if (c.measurement == measurement && c.plugin == plugin && c.name == v.name) {
      json["tolerance"] = printed(c.tolerance, c.quantity);
      json["decision"] = to_text(c.decision);
    }
  return json;
}

Json number_json(double value, Quantity quantity) {
  if (quantity == Quantity::count) return static_cast<std::int64_t>(std::llround(value));
  return printed(value, quantity);
}

Json points_json(const PointTable& table) {
  Json rows = Json::array();
  const std::size_t n = table.columns.empty() ? 0 : table.columns.front().values.size();
  for (std::size_t i = 0; i < n; ++i) {
    Json row = Json::object();
    for (const PointTable::Column& c : table.columns)
      if (std::isfinite(c.values[i])) row[c.name] = number_json(c.values[i], c.quantity);
    rows.push_back(std::move(row));
  }
  return rows;
}

Json point_units_json(const PointTable& table) {
  Json units = Json::object();
  for (const PointTable::Column& c : table.columns) units[c.name] = unit_of(c.quantity).symbol;
  return units;
}

Json series_json(const std::vector<Series>& all) {
  Json json = Json::object();
  for (const Series& s : all) {
    Json one = {{"over", s.over},
                {"position_unit", unit_of(s.position_quantity).symbol},
                {"unit", unit_of(s.quantity).symbol}};
    const auto list = [](const std::vector<double>& values, Quantity q) {
      Json out = Json::array();
      for (const double v : values) out.push_back(std::isfinite(v) ? Json(printed(v, q)) : Json());
      return out;
    };
    one["position"] = list(s.position, s.position_quantity);
    one["value"] = list(s.value, s.quantity);
    if (!s.U.empty()) one["U"] = list(s.U, s.quantity);
    json[s.name] = std::move(one);
  }
  return json;
}

Json finding_json(const Finding& f, bool with_measurement) {
  Json json = {{"id", f.id}, {"severity", f.attention ? "attention" : "info"}};
  if (with_measurement && !f.measurement.empty()) json["measurement"] = f.measurement;
  Json evidence = Json::object();
  for (const Number& n : f.evidence)
    evidence[n.name + std::string(unit_of(n.quantity).suffix)] = number_json(n.value, n.quantity);
  for (const auto& [key, words_of] : f.texts) evidence[key] = words_of;
  json["evidence"] = std::move(evidence);
  json["advice"] = f.advice;
  return json;
}

Json findings_json(const std::vector<Finding>& findings, bool with_measurement) {
  Json json = Json::array();
  for (const Finding& f : findings) json.push_back(finding_json(f, with_measurement));
  return json;
}

Json analysis_json(const Results::Analysed& a, const std::vector<Conformity>& conformity) {
  Json json = {{"plugin", a.plugin}, {"version", a.version}, {"measurement", a.measurement}};
  Json values = Json::object();
  for (const Value& v : a.evaluation.values)
    values[v.name] = value_json(v, a.measurement, a.plugin, conformity);
  json["values"] = std::move(values);
  if (!a.evaluation.points.columns.empty()) {
    json["point_units"] = point_units_json(a.evaluation.points);
    json["points"] = points_json(a.evaluation.points);
  }
  if (!a.evaluation.series.empty()) json["series"] = series_json(a.evaluation.series);
  json["findings"] = findings_json(a.evaluation.findings, false);
  if (!a.evaluation.notes.empty()) json["notes"] = notes_json(a.evaluation.notes);
  return json;
}

Json conformity_json(const Conformity& c) {
  Json json = Json::object();
  put(json, "measurement", c.measurement);
  json["axis"] = c.axis;
  put(json, "plugin", c.plugin);
  json["name"] = c.name;
  json["tolerance"] = printed(c.tolerance, c.quantity);
  json["unit"] = unit_of(c.quantity).symbol;
  json["decision"] = to_text(c.decision);
  put(json, "reason", c.reason);
  return json;
}

/// One entry for each file; what the plugin predicts, finds and notes stands once, in `tables`.
void put_outputs(Json& json, const std::vector<Results::Written>& outputs) {
  Json files = Json::array(), tables = Json::array();
  for (const Results::Written& w : outputs) {
    for (const Artifact& a : w.result.artifacts)
      files.push_back({{"plugin", w.plugin}, {"file", a.name}, {"sha256", sha256(a.bytes)}});
    if (w.result.predictions.empty() && w.result.findings.empty() && w.result.notes.empty())
      continue;
    Json one = {{"plugin", w.plugin}, {"version", w.version}};
    Json predictions = Json::array();
    for (const Prediction& p : w.result.predictions)
      predictions.push_back({{"measurement", p.measurement},
                             {"name", p.name},
                             {"before", printed(p.before, p.quantity)},
                             {"predicted", printed(p.after, p.quantity)},
                             {"unit", unit_of(p.quantity).symbol}});
    if (!predictions.empty()) one["predictions"] = std::move(predictions);
    one["findings"] = findings_json(w.result.findings, true);
    if (!w.result.notes.empty()) one["notes"] = notes_json(w.result.notes);
    tables.push_back(std::move(one));
  }
  json["outputs"] = std::move(files);
  if (!tables.empty()) json["tables"] = std::move(tables);
}

}  // namespace

const char* to_text(Decision decision) {
  switch (decision) {
    case Decision::conforms:
      return "conforms";
    case Decision::does_not_conform:
      return "does not conform";
    case Decision::cannot_be_decided:
      break;
  }
  return "cannot be decided";
}

std::string results_json(const Evaluated& e, const Context& context) {
  Json json = {{"schema", "nonio-results/1"},
               {"nonio", context.version},
               {"campaign", campaign_json(e.campaign)},
               {"status", e.status}};
  Json errors = Json::array();
  for (const Error& error : e.results.errors) errors.push_back(to_json(error));
  json["errors"] = std::move(errors);
  Json analyses = Json::array();
  for (const Results::Analysed& a : e.results.analyses)
    analyses.push_back(analysis_json(a, e.results.conformity));
  json["analyses"] = std::move(analyses);
  if (!e.results.conformity.empty()) {
    Json conformity = Json::array();
    for (const Conformity& c : e.results.conformity) conformity.push_back(conformity_json(c));
    json["conformity"] = std::move(conformity);
  }
  put_outputs(json, e.results.outputs);
  if (!e.results.notes.empty()) json["notes"] = notes_json(e.results.notes);
  return dump(json);
}

std::string failed_results_json(const std::string& id, const std::vector<Error>& errors) {
  Json list = Json::array();
  for (const Error& error : errors) list.push_back(to_json(error));
  return dump(Json{{"schema", "nonio-results/1"},
                   {"campaign", Json{{"id", id}}},
                   {"status", "failed"},
                   {"errors", std::move(list)},
                   {"analyses", Json::array()},
                   {"outputs", Json::array()}});
}

}  // namespace nonio::host
