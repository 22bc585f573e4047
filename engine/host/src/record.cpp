// SPDX-License-Identifier: Apache-2.0
#include "nonio/host/record.h"

#include <simdjson.h>

#include "json_values.h"

namespace nonio::host {

namespace {

Json findings_json(const std::vector<KnownFinding>& findings) {
  Json json = Json::array();
  for (const KnownFinding& f : findings)
    json.push_back({{"measurement", f.measurement},
                    {"id", f.id},
                    {"title", f.title},
                    {"severity", f.attention ? "attention" : "info"}});
  return json;
}

namespace dom = simdjson::dom;

std::string text(dom::element e) { return std::string(std::string_view(e)); }

std::vector<KnownFinding> findings_of(dom::array json) {
  std::vector<KnownFinding> out;
  for (const dom::object f : json)
    out.push_back({text(f["measurement"]), text(f["id"]), text(f["title"]),
                   std::string_view(f["severity"]) == "attention"});
  return out;
}

Error error_of(dom::object json) {
  Error error{text(json["message"])};
  if (dom::element e; json["file"].get(e) == simdjson::SUCCESS) error.file = text(e);
  if (dom::element e; json["line"].get(e) == simdjson::SUCCESS) error.line = std::uint64_t(e);
  if (dom::element e; json["column"].get(e) == simdjson::SUCCESS) error.column = text(e);
  return error;
}

Record record_of(dom::object json) {
  Record r;
  r.folder = text(json["folder"]);
  r.night = json["night"];
  r.reason = text(json["reason"]);
  r.status = text(json["status"]);
  r.retry = json["retry"];
  for (const auto [name, digest] : dom::object(json["inputs"]))
    r.inputs.emplace_back(name, text(digest));
  for (const auto [name, size_and_digest] : dom::object(json["files"]))
    r.files.push_back({std::string(name), size_and_digest.at(0), text(size_and_digest.at(1))});
  for (const dom::object e : dom::array(json["errors"])) r.errors.push_back(error_of(e));
  r.findings = findings_of(json["findings"]);
  r.previous = findings_of(json["previous_findings"]);
  return r;
}

}  // namespace

std::string to_json(const Record& r) {
  Json inputs = Json::object();
  for (const auto& [name, digest] : r.inputs) inputs[name] = digest;
  Json files = Json::object();
  for (const RecordedFile& f : r.files) files[f.name] = {f.size, f.sha256};
  Json errors = Json::array();
  for (const Error& e : r.errors) errors.push_back(to_json(e));
  return dump(Json{{"schema", "nonio-run/2"},
                   {"folder", r.folder},
                   {"night", r.night},
                   {"reason", r.reason},
                   {"status", r.status},
                   {"retry", r.retry},
                   {"inputs", std::move(inputs)},
                   {"files", std::move(files)},
                   {"errors", std::move(errors)},
                   {"findings", findings_json(r.findings)},
                   {"previous_findings", findings_json(r.previous)}});
}

Expected<Record> read_record(const std::filesystem::path& campaign_output) {
  try {
    dom::parser parser;
    const dom::object json = parser.load((campaign_output / record_name).string());
    if (std::string_view(json["schema"]) != "nonio-run/2") return fail("is of another version");
    return record_of(json);
  } catch (const simdjson::simdjson_error& e) {
    return fail(std::string("is not a record: ") + e.what());
  }
}

}  // namespace nonio::host
