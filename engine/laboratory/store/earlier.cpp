// SPDX-License-Identifier: Apache-2.0
#include "laboratory/store/earlier.h"

#include <algorithm>
#include <new>
#include <stdexcept>

#include "laboratory/store/entry_json.h"
#include "platform/storage/digest.h"
#include "platform/storage/files.h"
#include "platform/storage/json_values.h"

namespace nonio::store {
namespace fs = std::filesystem;
namespace dom = simdjson::dom;
using evaluation::IndexedSince;
using evaluation::Record;

namespace {

constexpr std::string_view head = "{\"schema\":\"nonio-earlier/1\",\n\"certificates\":";
constexpr std::string_view begin_of_list = ",\n\"evaluations\":[\n", end_of_list = "\n]}\n";

std::string input(const reading::Inputs& inputs, const char* name) {
  for (const auto& [of, digest] : inputs)
    if (of == name) return digest;
  return {};
}

IndexedSince since_of(const Record& record, const Entry& entry) {
  if (record.indexed) return *record.indexed;
  return {{record.run, record.date}, input(record.inputs, "version"), digest_of(entry)};
}

bool may_pass(const Record& record) {
  return record.status == evaluation::Status::failed && record.retry;
}

struct Kept {
  fs::path folder;
  Record record;
};

Expected<std::optional<Kept>> kept_in(const fs::path& folder) {
  NONIO_TRY(auto last, evaluation::last_record(folder));
  if (!last) return std::nullopt;
  if (!may_pass(last->record)) return Kept{folder, std::move(last->record)};
  const fs::path good = folder / evaluation::last_good_name;
  NONIO_TRY(auto record, evaluation::last_record(good));
  if (!record) return std::nullopt;
  return Kept{good, std::move(record->record)};
}

std::string if_restored(const fs::path& folder) {
  return "; restore it from a copy of the output folder, or remove it and " +
         (folder / evaluation::record_name).string() + " to go on without what was known before";
}

std::string recorded_digest(const fs::path& folder) {
  const auto last = evaluation::last_record(folder);
  if (!last || !*last || !(*last)->whole) return {};
  for (const auto& f : (*last)->record.files)
    if (f.name == earlier_name) return f.sha256;
  return {};
}

/// Returns an empty text if the file does not exist. It is the only copy, so a recorded file that
/// is missing or modified is an error.
Expected<std::string> earlier_bytes(const fs::path& campaign) {
  for (const fs::path& folder : {campaign, campaign / evaluation::last_good_name}) {
    const fs::path path = folder / earlier_name;
    NONIO_TRY(const auto there, storage::is_there(path));
    const std::string recorded = recorded_digest(folder);
    if (!there && recorded.empty()) continue;
    if (!there)
      return fail(path.string() + ", with the results that were replaced, is missing" +
                  if_restored(folder));
    auto bytes = storage::read_file(path);
    if (bytes && !recorded.empty() && storage::sha256(*bytes) != recorded)
      return fail(path.string() +
                  ", with the results that were replaced, was changed: expected SHA-256 " +
                  recorded + if_restored(folder));
    return bytes;
  }
  return std::string();
}

CertificateRow certificate_in(dom::object json) {
  const auto text = [&](const char* key) { return std::string(std::string_view(json[key])); };
  return {text("number"), text("date"), text("replaces"), text("campaign_sha256")};
}

Known known_in(dom::object json) {
  const auto text = [&](const char* key) { return std::string(std::string_view(json[key])); };
  reading::Inputs inputs;
  for (const auto [name, digest] : dom::object(json["inputs"]))
    inputs.emplace_back(name, std::string_view(digest));
  const std::uint64_t run = json["night"];
  return {{{run, text("date")}, text("version"), text("sha256")},
          read_entry(json["results"], inputs)};
}

Expected<FolderHistory> earlier_in(const std::string& bytes, const fs::path& folder) {
  FolderHistory history;
  if (bytes.empty()) return history;
  const auto damaged = [&](const std::string& why) {
    return fail((folder / earlier_name).string() +
                " is damaged, and with it what was known of the campaign before: " + why +
                if_restored(folder));
  };
  if (!bytes.starts_with(head) || !bytes.ends_with(end_of_list))
    return damaged("it does not begin or end as it was written");
  try {
    dom::parser parser;
    const dom::object json = parser.parse(bytes);
    for (const dom::object c : dom::array(json["certificates"]))
      history.certificates.push_back(certificate_in(c));
    for (const dom::object e : dom::array(json["evaluations"]))
      history.evaluations.push_back(known_in(e));
  } catch (const simdjson::simdjson_error& e) {
    if (e.error() == simdjson::MEMALLOC) throw std::bad_alloc();
    return damaged(e.what());
  } catch (const std::runtime_error& e) {
    return damaged(e.what());
  }
  return history;
}

std::string text_of(const std::vector<CertificateRow>& certificates) {
  storage::Json all = storage::Json::array();
  for (const CertificateRow& c : certificates)
    all.push_back({{"number", c.number},
                   {"date", c.day},
                   {"replaces", c.replaces},
                   {"campaign_sha256", c.campaign_sha256}});
  return all.dump(-1, ' ', false, storage::Json::error_handler_t::replace);
}

std::string text_of(const IndexedSince& since, const reading::Inputs& inputs,
                    std::string_view results) {
  storage::Json json = {{"night", since.run.number},
                        {"date", since.run.date},
                        {"version", since.version},
                        {"sha256", since.sha256},
                        {"inputs", storage::Json::object()}};
  for (const auto& [name, digest] : inputs) json["inputs"][name] = digest;
  std::string out = json.dump(-1, ' ', false, storage::Json::error_handler_t::replace);
  out.pop_back();
  out += ",\n\"results\":";
  out += results.substr(0, results.find_last_not_of('\n') + 1);
  return out + '}';
}

std::string extended(const std::string& before, const std::vector<CertificateRow>& certificates,
                     const std::string& more) {
  std::string list;
  if (!before.empty()) {
    const std::size_t begin = before.find(begin_of_list) + begin_of_list.size();
    list = before.substr(begin, before.size() - end_of_list.size() - begin);
  }
  if (!more.empty()) list += (list.empty() ? "" : ",\n") + more;
  return std::string(head) + text_of(certificates) + std::string(begin_of_list) + list +
         std::string(end_of_list);
}

void add_number(const std::optional<CertificateRow>& more, std::vector<CertificateRow>& numbers) {
  if (!more) return;
  const bool known = std::any_of(numbers.begin(), numbers.end(),
                                 [&](const CertificateRow& c) { return c.number == more->number; });
  if (!known) numbers.push_back(*more);
}

/// Results that were being replaced are already in earlier.json.
std::optional<std::string> still_there(const Kept& kept) {
  auto bytes = storage::read_file(kept.folder / evaluation::results_name);
  if (!bytes) return std::nullopt;
  const bool is_it =
      std::any_of(kept.record.files.begin(), kept.record.files.end(), [&](const auto& f) {
        return f.name == evaluation::results_name && f.sha256 == storage::sha256(*bytes);
      });
  if (!is_it) return std::nullopt;
  return std::move(*bytes);
}

/// Appends the results in `kept` to `carried.earlier`, unless `carried.indexed` or the last entry
/// is equal, and their certificate, unless its number is `number`.
Expected<void> put_aside(const Kept& kept, const fs::path& folder, const std::string& id,
                         const std::string& number, Carried& carried) {
  const auto before = still_there(kept);
  if (!before) return {};
  const auto was = entry_of(*before, kept.record.inputs, id);
  if (!was) return {};
  NONIO_TRY(auto history, earlier_in(carried.earlier, folder));
  const IndexedSince since = since_of(kept.record, *was);
  const bool same = carried.indexed && since.sha256 == carried.indexed->sha256;
  if (same) carried.indexed = since;
  const auto is_it = [&](const Known& known) {
    return known.since.sha256 == since.sha256 && known.since.run.number == since.run.number;
  };
  const bool superseded =
      !same && (history.evaluations.empty() || !is_it(history.evaluations.back()));
  const std::size_t numbers = history.certificates.size();
  if (was->certificate && was->certificate->number != number)
    add_number(was->certificate, history.certificates);
  if (superseded || history.certificates.size() != numbers)
    carried.earlier =
        extended(carried.earlier, history.certificates,
                 superseded ? text_of(since, kept.record.inputs, *before) : std::string());
  return {};
}

}  // namespace

Expected<FolderHistory> history_of(const fs::path& folder, const std::string& id) {
  NONIO_TRY(const auto bytes, earlier_bytes(folder));
  auto history = earlier_in(bytes, folder);
  if (!history) return history;
  NONIO_TRY(const auto kept, kept_in(folder));
  if (!kept) return history;
  const fs::path path = kept->folder / evaluation::results_name;
  NONIO_TRY(const auto results, storage::read_file(path));
  auto entry = entry_of(results, kept->record.inputs, id);
  if (!entry) return fail(kept->folder.string() + "/" + entry.error().message);
  add_number(entry->certificate, history->certificates);
  const IndexedSince since = since_of(kept->record, *entry);
  history->evaluations.push_back({since, std::move(*entry)});
  return history;
}

Expected<std::vector<std::uint64_t>> runs_of(const fs::path& folder) {
  NONIO_TRY(const auto bytes, earlier_bytes(folder));
  NONIO_TRY(const auto earlier, earlier_in(bytes, folder));
  NONIO_TRY(const auto kept, kept_in(folder));
  std::vector<std::uint64_t> runs;
  for (const Known& known : earlier.evaluations) runs.push_back(known.since.run.number);
  if (kept) {
    const Record& record = kept->record;
    runs.push_back(record.indexed ? record.indexed->run.number : record.run);
  }
  return runs;
}

Expected<Carried> carry_over(const fs::path& folder, const Record& fresh, std::string_view results,
                             const std::string& id) {
  NONIO_TRY(auto bytes, earlier_bytes(folder));
  Carried carried{{}, std::move(bytes)};
  NONIO_TRY(const auto kept, kept_in(folder));
  if (may_pass(fresh)) {
    // Good results are kept in last-good. Results of a permanent failure would be lost, so they are
    // appended to earlier.json.
    if (kept && kept->record.status == evaluation::Status::failed)
      if (auto put = put_aside(*kept, folder, id, {}, carried); !put) return fail(put.error());
    return carried;
  }
  NONIO_TRY(const auto entry, entry_of(results, fresh.inputs, id));
  carried.indexed =
      IndexedSince{{fresh.run, fresh.date}, input(fresh.inputs, "version"), digest_of(entry)};
  if (!kept) return carried;
  const Record& old = kept->record;
  const bool same = old.indexed && old.indexed->sha256 == carried.indexed->sha256;
  if (same) carried.indexed = old.indexed;
  if (same && (old.certificate.empty() || old.certificate == fresh.certificate)) return carried;
  const std::string number = entry.certificate ? entry.certificate->number : std::string();
  if (auto put = put_aside(*kept, folder, id, number, carried); !put) return fail(put.error());
  return carried;
}

}  // namespace nonio::store
