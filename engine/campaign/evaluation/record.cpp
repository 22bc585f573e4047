// SPDX-License-Identifier: Apache-2.0
#include "campaign/evaluation/record.h"

#include <simdjson.h>

#include <algorithm>
#include <new>
#include <set>

#include "campaign/config/terminal_words.h"
#include "campaign/evaluation/results_json.h"
#include "nonio/sdk/format.h"
#include "nonio/sdk/json_writer.h"
#include "platform/storage/digest.h"
#include "platform/storage/files.h"
#include "platform/storage/packed_results.h"

namespace nonio::evaluation {

namespace fs = std::filesystem;

namespace {

void put_findings(JsonWriter& json, const char* key, const std::vector<KnownFinding>& findings) {
  json.objects(key, findings, [&](const KnownFinding& f) {
    json.member("measurement", f.measurement);
    json.member("id", f.id);
    json.member("title", f.title);
    if (!f.said.empty()) json.member("said", f.said);
    json.member("severity", f.attention ? "attention" : "info");
  });
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
  for (const dom::object f : json) {
    out.push_back({text(f["measurement"]), text(f["id"]), text(f["title"]),
                   std::string_view(f["severity"]) == "attention"});
    if (dom::element e; f["said"].get(e) == simdjson::SUCCESS) out.back().said = text(e);
  }
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
  r.run = json["night"];
  if (dom::element e; json["date"].get(e) == simdjson::SUCCESS) r.date = text(e);
  r.reason = text(json["reason"]);
  const auto status = status_named(std::string_view(json["status"]));
  if (!status) throw simdjson::simdjson_error(simdjson::INCORRECT_TYPE);
  r.status = *status;
  r.retry = json["retry"];
  if (dom::object since; json["failed_since"].get(since) == simdjson::SUCCESS)
    r.failed_since = RunLabel{since["night"], text(since["date"])};
  if (dom::object since; json["indexed"].get(since) == simdjson::SUCCESS)
    r.indexed = IndexedSince{
        {since["night"], text(since["date"])}, text(since["version"]), text(since["sha256"])};
  for (const auto [name, digest] : dom::object(json["inputs"]))
    r.inputs.emplace_back(name, text(digest));
  if (dom::element e; json["certificate"].get(e) == simdjson::SUCCESS) r.certificate = text(e);
  if (dom::element e; json["language"].get(e) == simdjson::SUCCESS) r.language = text(e);
  if (dom::array notes; json["notes"].get(notes) == simdjson::SUCCESS)
    for (const dom::element note : notes) r.notes.push_back(text(note));
  if (bool draft = false; json["draft"].get(draft) == simdjson::SUCCESS) r.draft = draft;
  for (const auto [name, size_and_digest] : dom::object(json["files"]))
    r.files.push_back({std::string(name), size_and_digest.at(0), text(size_and_digest.at(1))});
  if (dom::object shown; json["history"].get(shown) == simdjson::SUCCESS) {
    r.history = ShownHistory{text(shown["sha256"])};
    for (const auto [campaign, digest] : dom::object(shown["campaigns"]))
      r.history->campaigns.emplace_back(campaign, text(digest));
  }
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
  json.member("night", r.run);
  if (!r.date.empty()) json.member("date", r.date);
  json.member("reason", r.reason);
  json.member("status", to_text(r.status));
  json.member("retry", r.retry);
  if (r.failed_since) {
    json.key("failed_since");
    json.begin_object();
    json.member("night", r.failed_since->number);
    json.member("date", r.failed_since->date);
    json.end_object();
  }
  if (r.indexed) {
    json.key("indexed");
    json.begin_object();
    json.member("night", r.indexed->run.number);
    json.member("date", r.indexed->run.date);
    json.member("version", r.indexed->version);
    json.member("sha256", r.indexed->sha256);
    json.end_object();
  }
  json.key("inputs");
  json.begin_object();
  for (const auto& [name, digest] : r.inputs) json.member(name, digest);
  json.end_object();
  if (!r.certificate.empty()) json.member("certificate", r.certificate);
  if (r.draft) json.member("draft", true);
  if (!r.language.empty()) json.member("language", r.language);
  if (!r.notes.empty()) json.member("notes", r.notes);
  put_files(json, r.files);
  if (r.history) {
    json.key("history");
    json.begin_object();
    json.member("sha256", r.history->sha256);
    json.key("campaigns");
    json.begin_object();
    for (const auto& [campaign, digest] : r.history->campaigns) json.member(campaign, digest);
    json.end_object();
    json.end_object();
  }
  json.list("errors", r.errors, [&](const Error& e) { put_error(json, e); });
  put_findings(json, "findings", r.findings);
  put_findings(json, "previous_findings", r.previous);
  json.end_object();
  return json.take();
}

namespace {

std::optional<Record> record_in(const std::string& bytes) {
  try {
    dom::parser parser;
    const dom::object json = parser.parse(bytes);
    if (std::string_view(json["schema"]) != "nonio-run/2") return std::nullopt;
    return record_of(json);
  } catch (const simdjson::simdjson_error& e) {
    if (e.error() == simdjson::MEMALLOC) throw std::bad_alloc();
    return std::nullopt;
  }
}

Expected<std::optional<Record>> record_at(const fs::path& path) {
  NONIO_TRY(const auto there, storage::is_there(path));
  if (!there) return std::nullopt;
  NONIO_TRY(const auto bytes, storage::read_file(path));
  return record_in(bytes);
}

}  // namespace

Expected<Record> read_record(const fs::path& campaign_output) {
  NONIO_TRY(auto record, record_at(campaign_output / record_name));
  if (!record) return fail((campaign_output / record_name).string() + " is not a record");
  return std::move(*record);
}

Expected<std::optional<LastRecord>> last_record(const fs::path& campaign_output) {
  for (const char* name : {record_name, record_before_name}) {
    NONIO_TRY(auto record, record_at(campaign_output / name));
    if (record) return LastRecord{std::move(*record), name == record_name};
  }
  return std::nullopt;
}

Expected<std::optional<Record>> staged_record(const fs::path& campaign_output) {
  return record_at(storage::temporary_path(campaign_output, record_name));
}

std::vector<KnownFinding> known_findings(const Results& results, const Templates& templates,
                                         const std::string& language) {
  const config::TerminalWords words(templates, language), in_english(templates, "en");
  const bool english = language == "en";
  std::vector<KnownFinding> out;
  const auto take = [&](const std::vector<Finding>& findings) {
    for (const Finding& f : findings) {
      KnownFinding known{f.measurement, f.id, finding_text(templates, "en", f, "title"),
                         f.attention, english ? "" : finding_text(templates, language, f, "title")};
      const auto same = std::find_if(out.begin(), out.end(),
                                     [&](const KnownFinding& k) { return k.same(known); });
      if (same == out.end())
        out.push_back(std::move(known));
      else
        same->attention |= known.attention;
    }
  };
  for (const auto& a : results.analyses) take(a.evaluation.findings);
  for (const auto& o : results.outputs) take(o.result.findings);
  for (const Conformity& c : results.conformity)
    if (c.decision != Decision::conforms) {
      const std::string decision = words.of("decision", to_text(c.decision));
      out.push_back(
          {c.measurement,
           "tolerance." + (c.axis.empty() ? "" : c.axis + ".") + c.name + "." + c.plugin,
           c.name + (c.axis.empty() ? "" : " of axis " + c.axis) + ": " +
               in_english.of("decision", to_text(c.decision)),
           true,
           english ? ""
           : c.axis.empty()
               ? c.name + ": " + decision
               : words("tolerance", {{"name", c.name}, {"axis", c.axis}, {"decision", decision}})});
    }
  return out;
}

std::vector<std::string> notes_in(const std::string& language, const Results& results,
                                  const Templates& templates) {
  const config::TerminalWords words(templates, language);
  std::vector<std::string> out;
  const auto take = [&](const std::vector<Remark>& notes) {
    for (const Remark& note : notes)
      out.push_back((note.measurement.empty()
                         ? ""
                         : words("head.from.one", {{"ids", note.measurement}}) + ": ") +
                    remark_text(templates, language, note));
  };
  for (const auto& a : results.analyses) take(a.evaluation.notes);
  for (const auto& o : results.outputs) take(o.result.notes);
  take(results.notes);
  return out;
}

namespace fs = std::filesystem;

namespace {

constexpr const char* earlier_name = "earlier.json";

Expected<void> add_files(const fs::path& folder, const std::string& before,
                         std::vector<RecordedFile>& all) {
  const fs::path path = folder / record_name;
  NONIO_TRY(const auto there, storage::is_there(path));
  if (!there) return {};
  NONIO_TRY(const auto record, read_record(folder));
  for (const RecordedFile& f : record.files) {
    if (!storage::is_artifact_name(f.name) && f.name != results_name && f.name != earlier_name)
      return fail(path.string() + " names a file \"" + storage::path_text(f.name) +
                  "\"; expected a plain name");
    all.push_back({before + f.name, f.size, f.sha256});
  }
  NONIO_TRY(const auto bytes, storage::read_file(path));
  all.push_back({before + record_name, bytes.size(), storage::sha256(bytes)});
  return {};
}

}  // namespace

Expected<std::vector<RecordedFile>> results_files(const fs::path& folder) {
  std::vector<RecordedFile> all;
  const std::string good = std::string(last_good_name) + "/";
  if (auto added = add_files(folder / last_good_name, good, all); !added)
    return fail(added.error());
  if (auto added = add_files(folder, "", all); !added) return fail(added.error());
  NONIO_TRY(const auto names, storage::names_in_store(folder));
  std::set<std::string> known;
  for (const RecordedFile& f : all) known.insert(f.name);
  for (const std::string& name : names)
    if (!known.contains(name))
      return fail("the pack " + storage::stored_in(folder).string() + " has a file \"" +
                  storage::path_text((folder.filename() / name).string()) +
                  "\" that the record of the campaign does not name");
  return all;
}

Expected<std::string> read_result(const fs::path& folder, const RecordedFile& file) {
  auto bytes = storage::read_file(folder / file.name);
  if (!bytes) return bytes;
  if (bytes->size() != file.size || storage::sha256(*bytes) != file.sha256)
    return fail((folder / file.name).string() +
                " is not as it was written: expected the size and SHA-256 of its record (" +
                record_name + ")");
  return bytes;
}

namespace {

/// Leaves out damaged files. A damaged earlier.json is an error, because no other copy exists.
Expected<std::vector<Artifact>> files_to_copy(const fs::path& folder) {
  std::vector<Artifact> files;
  NONIO_TRY(const auto last, last_record(folder));
  bool has_earlier = false;
  if (last)
    for (const RecordedFile& f : last->record.files) {
      auto bytes = last->whole ? read_result(folder, f) : storage::read_file(folder / f.name);
      if (!bytes && f.name == earlier_name && last->whole) return fail(bytes.error());
      if (!bytes) continue;
      has_earlier = has_earlier || f.name == earlier_name;
      files.push_back({f.name, std::move(*bytes)});
    }
  std::vector<std::string> more;
  if (const auto there = storage::is_there(folder / earlier_name); !has_earlier && there && *there)
    more.emplace_back(earlier_name);
  if (last) more.emplace_back(last->whole ? record_name : record_before_name);
  for (const std::string& name : more) {
    NONIO_TRY(auto bytes, storage::read_file(folder / name));
    files.push_back({name, std::move(bytes)});
  }
  return files;
}

}  // namespace

Expected<void> copy_results(const fs::path& folder, const fs::path& to) {
  const auto good = files_to_copy(folder / last_good_name), own = files_to_copy(folder);
  if (!good) return fail(good.error());
  if (!own) return fail(own.error());
  if (auto put = storage::publish(to / last_good_name, *good); !put) return put;
  return storage::publish(to, *own);
}

Expected<void> take_in(const fs::path& out, const std::string& id) {
  const fs::path from = storage::results_folder(out, id), to = storage::own_folder(out, id);
  return from == to ? Expected<void>() : copy_results(from, to);
}

}  // namespace nonio::evaluation
