// SPDX-License-Identifier: Apache-2.0
#include "batch/shards/packed_shard.h"

#include <algorithm>
#include <array>
#include <cstdio>

#include "campaign/evaluation/record.h"
#include "laboratory/store/earlier.h"
#include "platform/storage/files.h"
#include "platform/storage/pack.h"

namespace nonio::batch {
namespace fs = std::filesystem;

std::optional<ShardRecord> reported_pack(const fs::path& out, const RunPlan& plan,
                                         std::uint64_t shard) {
  auto record = read_shard_record(out, plan, shard);
  if (!record || !*record || !(*record)->pack) return std::nullopt;
  if (!storage::check_handed_over(out, *(*record)->pack)) return std::nullopt;
  return std::move(*record);
}

Expected<PackedShard> PackedShard::begin(const RunOptions& options,
                                         const std::vector<CampaignState>& campaigns) {
  auto folder = std::make_unique<storage::ScratchFolder>("shard", options.scratch);
  if (folder->path().empty()) {
    std::error_code error;
    const fs::path place =
        options.scratch.empty() ? fs::temp_directory_path(error) : options.scratch;
    return fail("cannot make a folder in " + (place.empty() ? "TMPDIR" : place.string()) +
                "; expected --scratch FOLDER on a disk of this host, or TMPDIR");
  }
  for (const CampaignState& c : campaigns) {
    if (c.action != CampaignState::Action::todo) continue;
    const auto copied =
        evaluation::copy_results(storage::results_folder(options.out, c.id), folder->path() / c.id);
    if (!copied) return fail(c.id + ": its last results cannot be read: " + copied.error().message);
  }
  // Open packs must not be inherited by processes that are started later.
  storage::close_packs();
  return PackedShard(std::move(folder));
}

namespace {

Expected<void> pack_campaign(const fs::path& folder, const std::string& id,
                             storage::PackWriter& pack) {
  NONIO_TRY(auto files, evaluation::results_files(folder));
  std::sort(files.begin(), files.end(),
            [](const auto& a, const auto& b) { return a.name < b.name; });
  for (const evaluation::RecordedFile& f : files) {
    NONIO_TRY(const auto bytes, evaluation::read_result(folder, f));
    if (auto added = pack.add(id + "/" + f.name, bytes); !added) return added;
  }
  return {};
}

std::string begin_of_name(const RunPlan& plan, std::uint64_t shard) {
  std::array<char, 64> text{};
  std::snprintf(text.data(), text.size(), "night-%llu-shard-%04llu",
                static_cast<unsigned long long>(plan.run.number),
                static_cast<unsigned long long>(shard));
  return text.data();
}

}  // namespace

Expected<void> PackedShard::hand_over(const RunOptions& options, const RunPlan& plan,
                                      ShardRecord& record) const {
  std::vector<ShardResult*> all;
  for (ShardResult& r : record.results)
    if (r.status != evaluation::Status::none) all.push_back(&r);
  if (all.empty()) return {};
  std::sort(all.begin(), all.end(),
            [](const auto* a, const auto* b) { return a->campaign < b->campaign; });
  const fs::path path = out() / ".nonio" / "results";
  std::error_code error;
  fs::create_directories(path.parent_path(), error);
  NONIO_TRY(auto pack, storage::PackWriter::create(path));
  for (ShardResult* r : all) {
    const auto stored = evaluation::read_record(out() / r->campaign);
    if (!stored || stored->run != plan.run.number)
      return fail(r->campaign + " could not be stored in " + out().string() +
                  (r->errors.empty() ? "" : ": " + r->errors.back().message));
    if (auto packed = pack_campaign(out() / r->campaign, r->campaign, pack); !packed) return packed;
    r->packed = true;
  }
  if (auto ended = pack.end(); !ended) return ended;
  NONIO_TRY(auto file, storage::hand_over(path, options.out, begin_of_name(plan, options.shard)));
  record.pack = std::move(file);
  return {};
}

namespace {

/// Keeps results of this run and other files. The record is removed after the files that only it
/// names, so that an interrupted removal can be continued.
Expected<void> clear_folder(const fs::path& folder, std::uint64_t run) {
  NONIO_TRY(const auto there, storage::is_there(folder));
  if (!there) return {};
  if (const auto record = evaluation::read_record(folder); record && record->run == run) return {};
  std::error_code error;
  const auto remove = [&](const fs::path& path) {
    if (!error) fs::remove(path, error);
  };
  const auto remove_files = [&](const fs::path& from) {
    const auto last = evaluation::last_record(from);
    if (!last || !*last) return;
    for (const evaluation::RecordedFile& f : (*last)->record.files)
      if (storage::is_artifact_name(f.name)) remove(from / f.name);
  };
  const auto remove_rest = [&](const fs::path& from) {
    for (const char* name : {evaluation::record_name, evaluation::record_before_name,
                             evaluation::results_name, store::earlier_name})
      remove(from / name);
  };
  const fs::path good = folder / evaluation::last_good_name;
  remove_files(folder);
  remove_files(good);
  for (const char* name : {evaluation::record_name, evaluation::record_before_name})
    remove(folder / name);
  remove_rest(good);
  remove_rest(folder);
  storage::remove_leftovers(folder);
  if (error)
    return fail("cannot remove the old results in " + folder.string() + ": " + error.message());
  std::error_code has_more;
  fs::remove(good, has_more);
  fs::remove(folder, has_more);
  return {};
}

}  // namespace

Expected<void> accept_packs(const fs::path& out, const RunPlan& plan,
                            const std::vector<const ShardRecord*>& shards) {
  std::vector<storage::Catalogue::Entry> entries;
  for (const ShardRecord* shard : shards)
    if (shard->pack)
      for (const ShardResult& r : shard->results)
        if (r.packed) entries.push_back({r.campaign, &*shard->pack});
  if (entries.empty()) return {};
  std::sort(entries.begin(), entries.end(),
            [](const auto& a, const auto& b) { return a.id < b.id; });
  NONIO_TRY(const auto before, storage::Catalogue::read(out));
  if (auto put = before.publish_with(out, entries); !put) return put;
  for (const storage::Catalogue::Entry& e : entries)
    if (auto cleared = clear_folder(storage::own_folder(out, e.id), plan.run.number); !cleared)
      return cleared;
  return {};
}

Expected<void> keep_packs(const fs::path& out) {
  const auto found = find_plan(out);
  // A plan that cannot be read is canceled without accepting further packs.
  if (!found || !*found) return {};
  const RunPlan& plan = **found;
  std::vector<ShardRecord> sound;
  for (std::uint64_t shard = 0; shard < plan.shards.size(); ++shard)
    if (auto record = reported_pack(out, plan, shard)) sound.push_back(std::move(*record));
  std::vector<const ShardRecord*> all;
  for (const ShardRecord& record : sound) all.push_back(&record);
  return accept_packs(out, plan, all);
}

}  // namespace nonio::batch
