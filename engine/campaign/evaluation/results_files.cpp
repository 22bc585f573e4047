// SPDX-License-Identifier: Apache-2.0
#include "campaign/evaluation/results_files.h"

#include <set>

#include "platform/storage/digest.h"
#include "platform/storage/files.h"
#include "platform/storage/packed_results.h"

namespace nonio::evaluation {
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
