// SPDX-License-Identifier: Apache-2.0
#include "nonio/host/record.h"

#include "json_values.h"
#include "nonio/host/files.h"

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

std::vector<KnownFinding> findings_of(const Json& json) {
  std::vector<KnownFinding> out;
  for (const Json& f : json)
    out.push_back({f.at("measurement").get<std::string>(), f.at("id").get<std::string>(),
                   f.at("title").get<std::string>(), f.at("severity") == "attention"});
  return out;
}

Record record_of(const Json& json) {
  Record r;
  r.folder = json.at("folder").get<std::string>();
  r.night = json.at("night").get<std::uint64_t>();
  r.reason = json.at("reason").get<std::string>();
  r.status = json.at("status").get<std::string>();
  r.retry = json.at("retry").get<bool>();
  for (const auto& [name, digest] : json.at("inputs").items())
    r.inputs.emplace_back(name, digest.get<std::string>());
  for (const auto& [name, size_and_digest] : json.at("files").items())
    r.files.push_back({name, size_and_digest.at(0).get<std::uint64_t>(),
                       size_and_digest.at(1).get<std::string>()});
  for (const Json& e : json.at("errors"))
    r.errors.push_back({e.at("message").get<std::string>(), e.value("file", std::string()),
                        e.value("line", std::uint64_t{0}), e.value("column", std::string())});
  r.findings = findings_of(json.at("findings"));
  r.previous = findings_of(json.at("previous_findings"));
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
  const auto file = MappedFile::open(campaign_output / record_name);
  if (!file) return fail(file.error());
  try {
    const Json json = Json::parse(file->bytes());
    if (json.at("schema") != "nonio-run/2") return fail("is of another version");
    return record_of(json);
  } catch (const Json::exception& e) {
    return fail(std::string("is not a record: ") + e.what());
  }
}

}  // namespace nonio::host
