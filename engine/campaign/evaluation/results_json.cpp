// SPDX-License-Identifier: Apache-2.0
#include "campaign/evaluation/results_json.h"

#include <algorithm>
#include <cmath>
#include <initializer_list>
#include <utility>

#include "campaign/evaluation/control_tables.h"
#include "campaign/evaluation/followed.h"
#include "nonio/sdk/format.h"
#include "platform/storage/digest.h"

namespace nonio::evaluation {

namespace {

void put_text(JsonWriter& json, const char* key, const std::string& text) {
  if (!text.empty()) json.member(key, text);
}

void put_texts(JsonWriter& json, const char* key,
               std::initializer_list<std::pair<const char*, const std::string&>> texts) {
  if (std::all_of(texts.begin(), texts.end(), [](const auto& t) { return t.second.empty(); }))
    return;
  json.key(key);
  json.begin_object();
  for (const auto& [name, text] : texts) put_text(json, name, text);
  json.end_object();
}

void put_notes(JsonWriter& json, const std::vector<Remark>& notes, const Templates& templates) {
  if (notes.empty()) return;
  json.list("notes", notes, [&](const Remark& note) {
    json.value((note.measurement.empty() ? "" : "measurement " + note.measurement + ": ") +
               remark_text(templates, "en", note));
  });
}

void put_campaign(JsonWriter& json, const Campaign& c, const std::string& purpose) {
  json.key("campaign");
  json.begin_object();
  json.member("id", c.id);
  put_text(json, "customer", c.customer);
  put_text(json, "site", c.site);
  put_text(json, "operator", c.operator_name);
  put_text(json, "date", c.date);
  put_text(json, "purpose", purpose);
  put_texts(json, "machine",
            {{"maker", c.machine.maker},
             {"model", c.machine.model},
             {"serial", c.machine.serial},
             {"asset", c.machine.asset},
             {"structure", c.machine.structure},
             {"control", c.machine.control}});
  put_texts(json, "instrument",
            {{"maker", c.instrument.maker},
             {"model", c.instrument.model},
             {"serial", c.instrument.serial},
             {"calibrated", c.instrument.calibrated},
             {"certificate", c.instrument.certificate},
             {"issuer", c.instrument.issuer},
             {"valid_until", c.instrument.valid_until}});
  json.end_object();
}

void put_value(JsonWriter& json, const Value& v, const Results::Analysed& a,
               const std::vector<Conformity>& conformity) {
  json.key(v.name);
  json.begin_object();
  json.member("value", printed(v.value, v.quantity));
  json.member("unit", unit_of(v.quantity).symbol);
  if (v.U) json.member("U", printed(*v.U, v.quantity));
  if (v.repeatability) json.member("repeatability", printed(*v.repeatability, v.quantity));
  if (v.U || v.repeatability) json.member("k", printed(v.k, Quantity::number));
  for (const Conformity& c : conformity)
    if (c.measurement == a.measurement && c.plugin == a.plugin && c.name == v.name) {
      json.member("tolerance", printed(c.tolerance, c.quantity));
      json.member("decision", evaluation::to_text(c.decision));
    }
  json.end_object();
}

void put_number(JsonWriter& json, double value, Quantity quantity) {
  if (quantity == Quantity::count)
    json.value(static_cast<std::int64_t>(std::llround(value)));
  else
    json.value(printed(value, quantity));
}

void put_table(JsonWriter& json, const PointTable& table, const char* name, const char* units) {
  if (table.columns.empty()) return;
  json.key(units);
  json.begin_object();
  for (const PointTable::Column& c : table.columns) json.member(c.name, unit_of(c.quantity).symbol);
  json.end_object();
  json.key(name);
  json.begin_array();
  for (std::size_t i = 0; i < table.columns.front().values.size(); ++i) {
    json.begin_object();
    for (const PointTable::Column& c : table.columns)
      if (std::isfinite(c.values[i])) {
        json.key(c.name);
        put_number(json, c.values[i], c.quantity);
      }
    json.end_object();
  }
  json.end_array();
}

void put_point_U(JsonWriter& json, const PointTable& points) {
  const auto has_U = [](const PointTable::Column& c) { return c.U.has_value(); };
  if (std::none_of(points.columns.begin(), points.columns.end(), has_U)) return;
  json.key("point_U");
  json.begin_object();
  for (const PointTable::Column& c : points.columns)
    if (c.U) json.member(c.name, printed(*c.U, c.quantity));
  json.end_object();
}

void put_series(JsonWriter& json, const std::vector<Series>& all) {
  if (all.empty()) return;
  const auto list = [&](const char* key, const std::vector<double>& values, Quantity q) {
    json.list(key, values,
              [&](const double v) { std::isfinite(v) ? json.value(printed(v, q)) : json.null(); });
  };
  json.key("series");
  json.begin_object();
  for (const Series& s : all) {
    json.key(s.name);
    json.begin_object();
    json.member("over", s.over);
    json.member("position_unit", unit_of(s.position_quantity).symbol);
    json.member("unit", unit_of(s.quantity).symbol);
    list("position", s.position, s.position_quantity);
    list("value", s.value, s.quantity);
    if (!s.U.empty()) list("U", s.U, s.quantity);
    if (!s.repeatability.empty()) list("repeatability", s.repeatability, s.quantity);
    if (!s.U.empty() || !s.repeatability.empty()) json.member("k", printed(s.k, Quantity::number));
    json.end_object();
  }
  json.end_object();
}

void put_contribution(JsonWriter& json, const Contribution& c) {
  json.begin_object();
  json.member("id", c.id);
  json.member("u", printed(c.u, c.quantity));
  json.member("unit", unit_of(c.quantity).symbol);
  json.member("with_length", c.with_length);
  json.member("distribution", to_text(c.distribution));
  json.member("correlation", to_text(c.correlation));
  if (c.dof) json.member("dof", printed(*c.dof, Quantity::number));
  json.member("source", c.source);
  json.end_object();
}

void put_budget(JsonWriter& json, const std::optional<UncertaintyBudget>& budget) {
  if (!budget) return;
  json.key("budget");
  json.begin_object();
  json.member("length_mm", printed(budget->length, Quantity::length));
  json.list("contributions", budget->contributions,
            [&](const Contribution& c) { put_contribution(json, c); });
  json.key("results");
  json.begin_object();
  for (const auto& r : budget->results) {
    json.key(r.name);
    json.begin_object();
    json.member("unit", unit_of(r.quantity).symbol);
    json.member("k", printed(r.k, Quantity::number));
    if (std::isfinite(r.dof)) json.member("dof", printed(r.dof, Quantity::number));
    json.key("u");
    json.begin_object();
    for (std::size_t i = 0; i < r.u.size(); ++i)
      json.member(budget->contributions[i].id, printed(r.u[i], r.quantity));
    json.end_object();
    json.end_object();
  }
  json.end_object();
  json.end_object();
}

void put_findings(JsonWriter& json, const std::vector<Finding>& findings, bool with_measurement,
                  const Templates& templates) {
  json.objects("findings", findings, [&](const Finding& f) {
    json.member("id", f.id);
    json.member("severity", f.attention ? "attention" : "info");
    if (with_measurement) put_text(json, "measurement", f.measurement);
    json.key("evidence");
    json.begin_object();
    for (const Number& n : f.evidence) {
      json.key(n.name + std::string(unit_of(n.quantity).suffix));
      put_number(json, n.value, n.quantity);
    }
    for (const auto& [key, words_of] : f.texts) json.member(key, words_of);
    json.end_object();
    json.member("advice", finding_text(templates, "en", f, "advice"));
  });
}

void put_analysis(JsonWriter& json, const Results::Analysed& a, const Evaluated& e,
                  const Templates& templates) {
  json.begin_object();
  json.member("plugin", a.plugin);
  json.member("version", a.version);
  put_text(json, "measurement", a.measurement);
  for (const Measurement& m : e.campaign.measurements)
    if (m.id == a.measurement && m.adjustment == "after") json.member("state", "as-left");
  put_text(json, "part", a.part);
  for (const Remark& note : a.evaluation.notes)
    for (const Number& n : note.evidence)
      if (n.name == "edition" && n.value >= 0.0 && n.value < 1e6)
        json.member("edition", static_cast<std::uint64_t>(n.value));
  if (!a.evaluation.uses.empty()) json.member("uses", a.evaluation.uses);
  json.key("values");
  json.begin_object();
  for (const Value& v : a.evaluation.values) put_value(json, v, a, e.results.conformity);
  json.end_object();
  put_table(json, a.evaluation.points, "points", "point_units");
  put_point_U(json, a.evaluation.points);
  put_table(json, a.evaluation.rows, "rows", "row_units");
  put_series(json, a.evaluation.series);
  put_budget(json, a.evaluation.budget);
  put_findings(json, a.evaluation.findings, false, templates);
  put_notes(json, a.evaluation.notes, templates);
  json.end_object();
}

void put_conformity(JsonWriter& json, const std::vector<Conformity>& all) {
  if (all.empty()) return;
  json.objects("conformity", all, [&](const Conformity& c) {
    put_text(json, "measurement", c.measurement);
    put_text(json, "axis", c.axis);
    put_text(json, "plugin", c.plugin);
    json.member("name", c.name);
    json.member("tolerance", printed(c.tolerance, c.quantity));
    json.member("unit", unit_of(c.quantity).symbol);
    json.member("decision", evaluation::to_text(c.decision));
    put_text(json, "reason", c.reason);
  });
}

void put_files(JsonWriter& json, const std::vector<Results::Written>& outputs,
               const std::vector<RecordedFile>& files) {
  json.key("outputs");
  json.begin_array();
  auto file = files.begin();
  for (const Results::Written& w : outputs)
    for (std::size_t i = 0; i < w.result.artifacts.size(); ++i, ++file) {
      json.begin_object();
      json.member("plugin", w.plugin);
      json.member("file", file->name);
      json.member("sha256", file->sha256);
      json.end_object();
    }
  json.end_array();
}

void put_predictions(JsonWriter& json, const std::vector<Prediction>& predictions) {
  if (predictions.empty()) return;
  json.objects("predictions", predictions, [&](const Prediction& p) {
    json.member("measurement", p.measurement);
    json.member("name", p.name);
    json.member("before", printed(p.before, p.quantity));
    json.member("predicted", printed(p.after, p.quantity));
    json.member("unit", unit_of(p.quantity).symbol);
  });
}

void put_tables(JsonWriter& json, const std::vector<Results::Written>& outputs,
                const Templates& templates) {
  const auto silent = [](const Results::Written& w) {
    return w.result.predictions.empty() && w.result.findings.empty() && w.result.notes.empty();
  };
  if (std::all_of(outputs.begin(), outputs.end(), silent)) return;
  json.key("tables");
  json.begin_array();
  for (const Results::Written& w : outputs) {
    if (silent(w)) continue;
    json.begin_object();
    json.member("plugin", w.plugin);
    json.member("version", w.version);
    put_predictions(json, w.result.predictions);
    put_findings(json, w.result.findings, true, templates);
    put_notes(json, w.result.notes, templates);
    json.end_object();
  }
  json.end_array();
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

std::string results_json(const Evaluated& e, const reading::Context& context,
                         const std::vector<RecordedFile>& files) {
  JsonWriter json;
  json.begin_object();
  json.member("schema", "nonio-results/1");
  json.member("nonio", context.version);
  put_campaign(json, e.campaign, e.purpose);
  json.member("status", to_text(e.status));
  json.list("errors", e.results.errors, [&](const Error& error) { put_error(json, error); });
  json.list("analyses", e.results.analyses,
            [&](const Results::Analysed& a) { put_analysis(json, a, e, context.templates); });
  put_conformity(json, e.results.conformity);
  put_followed(json, e.followed);
  put_control_tables(json, e.control_tables);
  if (e.certificate) put_certificate(json, *e.certificate);
  put_files(json, e.results.outputs, files);
  put_tables(json, e.results.outputs, context.templates);
  put_notes(json, e.results.notes, context.templates);
  json.end_object();
  return json.take();
}

std::string results_json(const Evaluated& evaluated, const reading::Context& context) {
  std::vector<RecordedFile> files;
  for (const Results::Written& w : evaluated.results.outputs)
    for (const Artifact& a : w.result.artifacts)
      files.push_back({a.name, a.bytes.size(), storage::sha256(a.bytes)});
  return results_json(evaluated, context, files);
}

namespace {

void put_if_there(JsonWriter& json, const char* key, const std::string& text) {
  if (!text.empty()) json.member(key, text);
}

void put_change(JsonWriter& json, const Change& change) {
  json.begin_object();
  put_if_there(json, "key", change.key);
  if (change.line != 0) json.member("line", change.line);
  if (change.before) json.member("before", *change.before);
  if (change.after) json.member("after", *change.after);
  json.end_object();
}

void put_changes(JsonWriter& json, const std::vector<FileChange>& changes) {
  json.objects("changes", changes, [&](const FileChange& file) {
    json.member("file", file.file);
    if (!file.changes.empty()) {
      json.key("places");
      json.begin_array();
      for (const Change& change : file.changes) put_change(json, change);
      json.end_array();
    }
    if (file.more != 0) json.member("more", file.more);
  });
}

void put_reasons(JsonWriter& json, const Issue& issue) {
  if (issue.reasons.empty()) return;
  json.objects("reasons", issue.reasons, [&](const Issue::Reason& r) {
    json.member("finding", r.finding);
    json.member("reason", r.text);
    json.member("by", r.by);
  });
}

void put_register(JsonWriter& json, const Issue& issue) {
  if (issue.register_id.empty()) return;
  json.key("register");
  json.begin_object();
  json.member("id", issue.register_id);
  json.member("entry", issue.register_entry);
  json.member("sha256", issue.register_sha256);
  json.end_object();
}

std::string text_in(const storage::Json& object, const char* key) {
  return object.is_object() && object.contains(key) && object[key].is_string()
             ? object[key].get<std::string>()
             : "";
}

std::uint64_t count_in(const storage::Json& object, const char* key) {
  return object.contains(key) && object[key].is_number_unsigned() ? object[key].get<std::uint64_t>()
                                                                  : 0;
}

const storage::Json& list_in(const storage::Json& object, const char* key) {
  static const storage::Json none = storage::Json::array();
  return object.is_object() && object.contains(key) && object[key].is_array() ? object[key] : none;
}

FileChange change_in(const storage::Json& json) {
  // Before version 2 of the register, a change was written as a text.
  if (json.is_string()) return {json.get<std::string>()};
  FileChange file{text_in(json, "file")};
  for (const storage::Json& place : list_in(json, "places")) {
    if (!place.is_object()) continue;
    Change change{text_in(place, "key"), count_in(place, "line")};
    if (place.contains("before")) change.before = text_in(place, "before");
    if (place.contains("after")) change.after = text_in(place, "after");
    file.changes.push_back(std::move(change));
  }
  if (json.is_object()) file.more = count_in(json, "more");
  return file;
}

}  // namespace

void put_certificate(JsonWriter& json, const Certificate& certificate) {
  const Issue& issue = certificate.issue;
  json.key("certificate");
  json.begin_object();
  json.member("plugin", certificate.output);
  if (issue.is_draft()) {
    json.member("draft", true);
  } else {
    json.member("number", issue.number);
    json.member("date", issue.date);
  }
  put_if_there(json, "replaces", issue.replaces);
  put_if_there(json, "replaces_date", issue.replaces_date);
  put_if_there(json, "replaces_readings", issue.replaces_readings);
  put_if_there(json, "replaces_file", issue.replaces_file);
  put_if_there(json, "replaces_sha256", issue.replaces_sha256);
  if (!issue.replaces.empty()) {
    put_changes(json, issue.changes);
    put_if_there(json, "why", issue.why);
  }
  put_if_there(json, "released_by", issue.released_by);
  put_if_there(json, "author", issue.author);
  put_reasons(json, issue);
  json.member("readings_sha256", issue.readings_sha256);
  json.member("templates_sha256", certificate.templates_sha256);
  put_register(json, issue);
  json.end_object();
}

Certificate certificate_of(const storage::Json& json) {
  Certificate certificate;
  certificate.output = text_in(json, "plugin");
  certificate.templates_sha256 = text_in(json, "templates_sha256");
  Issue& issue = certificate.issue;
  issue.number = text_in(json, "number");
  issue.date = text_in(json, "date");
  issue.replaces = text_in(json, "replaces");
  issue.replaces_date = text_in(json, "replaces_date");
  issue.replaces_readings = text_in(json, "replaces_readings");
  issue.replaces_file = text_in(json, "replaces_file");
  issue.replaces_sha256 = text_in(json, "replaces_sha256");
  for (const storage::Json& change : list_in(json, "changes"))
    issue.changes.push_back(change_in(change));
  issue.readings_sha256 = text_in(json, "readings_sha256");
  issue.why = text_in(json, "why");
  issue.released_by = text_in(json, "released_by");
  issue.author = text_in(json, "author");
  for (const storage::Json& r : list_in(json, "reasons"))
    issue.reasons.push_back({text_in(r, "finding"), text_in(r, "reason"), text_in(r, "by")});
  if (json.is_object() && json.contains("register")) {
    issue.register_id = text_in(json["register"], "id");
    issue.register_entry = text_in(json["register"], "entry");
    issue.register_sha256 = text_in(json["register"], "sha256");
  }
  return certificate;
}

}  // namespace nonio::evaluation
