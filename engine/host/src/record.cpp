// SPDX-License-Identifier: Apache-2.0
#include "nonio/host/record.h"

#include <simdjson.h>

#include "json_writer.h"

namespace nonio::host {

namespace {

void put_findings(JsonWriter& json, const char* key, const std::vector<KnownFinding>& findings) {
  json.key(key);
  json.begin_array();
  for (const KnownFinding& f : findings) {
    json.begin_object();
    json.member("measurement", f.measurement);
    json.member("id", f.id);
    json.member("title", f.title);
    json.member("severity", f.attention ? "attention" : "info");
    json.end_object();
  }
  json.end_array();
}

void put_files(JsonWriter& json, const std::vector<RecordedFile>& files) {
  json.key("files");
  json.begin_object();
  for (const RecordedFile& f : files) {
    json.key(f.name);
    json.begin_array();
    json.value(f.size);
    json.value(f.sha256);
    json.end_array();
  }
  json.end_object();
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
  if (dom::element e; json["certificate"].get(e) == simdjson::SUCCESS) r.certificate = text(e);
  if (bool draft = false; json["draft"].get(draft) == simdjson::SUCCESS) r.draft = draft;
  for (const auto [name, size_and_digest] : dom::object(json["files"]))
    r.files.push_back({std::string(name), size_and_digest.at(0), text(size_and_digest.at(1))});
  for (const dom::object e : dom::array(json["errors"])) r.errors.push_back(error_of(e));
  r.findings = findings_of(json["findings"]);
  r.previous = findings_of(json["previous_findings"]);
  return r;
}

}  // namespace

std::string to_json(const Record& r) {
  JsonWriter json;
  json.begin_object();
  json.member("schema", "nonio-run/2");
  json.member("folder", r.folder);
  json.member("night", r.night);
  json.member("reason", r.reason);
  json.member("status", r.status);
  json.member("retry", r.retry);
  json.key("inputs");
  json.begin_object();
  for (const auto& [name, digest] : r.inputs) json.member(name, digest);
  json.end_object();
  if (!r.certificate.empty()) json.member("certificate", r.certificate);
  if (r.draft) json.member("draft", true);
  put_files(json, r.files);
  json.key("errors");
  json.begin_array();
  for (const Error& e : r.errors) put_error(json, e);
  json.end_array();
  put_findings(json, "findings", r.findings);
  put_findings(json, "previous_findings", r.previous);
  json.end_object();
  return json.take();
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
