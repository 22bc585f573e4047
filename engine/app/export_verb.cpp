// SPDX-License-Identifier: Apache-2.0
// `nonio export`: the results of campaigns out of packs, or from wherever they lie, into folders.
#include <algorithm>
#include <iostream>
#include <memory>
#include <nlohmann/json.hpp>

#include "batch/state/output_lock.h"
#include "campaign/config/manifest.h"
#include "campaign/evaluation/results_files.h"
#include "platform/storage/digest.h"
#include "platform/storage/files.h"
#include "platform/storage/pack.h"
#include "verbs.h"

namespace nonio::app {
using Json = nlohmann::ordered_json;
namespace fs = std::filesystem;
namespace storage = storage;
namespace evaluation = evaluation;

namespace {

struct GetWish {
  std::vector<std::string> ids;
  std::string out, to;
  bool all = false, list = false;
};

/// Where the results of a campaign lie, as a person calls it.
std::string place_of(const fs::path& folder) {
  const auto packed = storage::in_pack(folder);
  return packed ? "pack " + packed->pack.filename().string() : "folder " + folder.string();
}

Expected<std::vector<std::string>> ids_of(const GetWish& wish) {
  std::vector<std::string> ids = wish.ids;
  for (const std::string& id : ids)
    if (!config::is_campaign_id(id)) return fail("\"" + id + "\" is no id of a campaign");
  const auto take = [&](const fs::path& folder) {
    const bool wanted = wish.list || !wish.to.empty() || storage::in_pack(folder);
    const std::string id = folder.filename().string();
    if (wanted && config::is_campaign_id(id) &&
        storage::is_there(folder / evaluation::record_name).value_or(true))
      ids.push_back(id);
  };
  if (wish.all || (wish.list && ids.empty()))
    if (const auto listed = storage::each_results_folder(wish.out, take); !listed)
      return fail(listed.error());
  std::sort(ids.begin(), ids.end());
  ids.erase(std::unique(ids.begin(), ids.end()), ids.end());
  return ids;
}

Expected<std::vector<evaluation::RecordedFile>> files_of(const GetWish& wish, const std::string& id,
                                                         fs::path& folder) {
  folder = storage::results_folder(wish.out, id);
  auto files = evaluation::results_files(folder);
  if (files && files->empty()) return fail("there are no results of " + id + " in " + wish.out);
  return files;
}

void print_list(const std::string& id, const fs::path& folder,
                const std::vector<evaluation::RecordedFile>& files, bool each_file, bool json) {
  std::uint64_t bytes = 0;
  for (const auto& f : files) bytes += f.size;
  if (json) {
    Json line = {{"schema", "nonio-get/1"},  {"id", id},
                 {"place", folder.string()}, {"packed", storage::in_pack(folder).has_value()},
                 {"bytes", bytes},           {"files", Json::array()}};
    for (const auto& f : files)
      line["files"].push_back({{"name", f.name}, {"bytes", f.size}, {"sha256", f.sha256}});
    print_json(line, -1);
    return;
  }
  std::cout << id << ": " << files.size() << " files, " << bytes << " bytes, " << place_of(folder)
            << "\n";
  if (!each_file) return;
  for (const auto& f : files)
    std::cout << "  " << f.sha256 << "  " << f.size << "  " << f.name << "\n";
}

/// Every file in a folder as it was written, or nothing: what exists already has these bytes or
/// stays.
Expected<std::size_t> write_out(const fs::path& from, const fs::path& to,
                                const std::vector<evaluation::RecordedFile>& files) {
  const std::string below = std::string(evaluation::last_good_name) + "/";
  std::vector<Artifact> good, own;
  for (const auto& f : files) {
    NONIO_TRY(auto bytes, evaluation::read_result(from, f));
    const fs::path path = to / f.name;
    NONIO_TRY(const auto there, storage::is_there(path));
    if (there) {
      const auto now = storage::sha256_of_file(path);
      if (!now || *now != f.sha256)
        return fail(path.string() +
                    " exists with different content; nothing was written. Expected "
                    "--to with a folder without it");
      continue;
    }
    const bool is_good = f.name.starts_with(below);
    (is_good ? good : own)
        .push_back({is_good ? f.name.substr(below.size()) : f.name, std::move(bytes)});
  }
  if (auto put = storage::publish(to / evaluation::last_good_name, good); !put)
    return fail(put.error());
  if (auto put = storage::publish(to, own); !put) return fail(put.error());
  return good.size() + own.size();
}

/// False if something is damaged or in the way; the message names it.
bool get_one(const GetWish& wish, const std::string& id, const Common& common) {
  fs::path folder;
  const auto files = files_of(wish, id, folder);
  if (!files) return complain(files.error().message), false;
  if (wish.list) return print_list(id, folder, *files, !wish.ids.empty(), common.json), true;
  const fs::path to = wish.to.empty() ? storage::own_folder(wish.out, id) : fs::path(wish.to) / id;
  std::error_code error;
  const bool in_place = to == folder || fs::equivalent(to, folder, error);
  const auto written = in_place ? Expected<std::size_t>(0) : write_out(folder, to, *files);
  if (!written) return complain(written.error().message), false;
  if (common.json)
    print_json(Json{{"schema", "nonio-get/1"},
                    {"id", id},
                    {"place", folder.string()},
                    {"folder", to.string()},
                    {"written", *written}},
               -1);
  else if (!common.quiet)
    std::cout << to.string() << ": " << *written << " of " << files->size() << " files written"
              << (in_place ? ": the results lie there" : "") << "\n";
  return true;
}

int get(const GetWish& wish, const Common& common) {
  if (wish.ids.empty() && !wish.all && !wish.list)
    return complain("expected the ids of campaigns, --all, or --list");
  if (!wish.ids.empty() && wish.all)
    return complain("--all is every campaign; expected no ids with it");
  if (!wish.to.empty() && wish.list)
    return complain("--list writes nothing; expected no --to with it");
  const auto ids = ids_of(wish);
  if (!ids) return complain(ids.error().message);
  std::optional<batch::OutputLock> lock;
  if (!wish.list && wish.to.empty()) {  // the folders count from then on
    auto taken = batch::OutputLock::take(wish.out);
    if (!taken) return complain(taken.error().message);
    lock.emplace(std::move(*taken));
  }
  bool well = true;
  for (const std::string& id : *ids) well = get_one(wish, id, common) && well;
  return well ? exit_done : exit_failed;
}

}  // namespace

Verb export_verb(Common& common) {
  auto wish = std::make_shared<GetWish>();
  using Takes = Argument::Takes;
  return {
      .name = "export",
      .summary = "Writes the results of campaigns out of packs into folders, or lists them",
      .arguments =
          {{"ID", &wish->ids, "Ids of campaigns"},
           required(existing(Takes::folder, {"--out", &wish->out, "Output folder of `nonio run`"})),
           takes(Takes::folder,
                 {"--to", &wish->to,
                  "Write into FOLDER/ID and leave the output folder unchanged. Without it: OUT/ID, "
                  "which replaces the pack and is the target of the links of the pages"}),
           {"--all", &wish->all, "All packed campaigns (with --to: all campaigns)"},
           {"--list", &wish->list,
            "Write nothing: list where the results are stored; with ids also each file with size "
            "and SHA-256"},
           {"--json", &common.json, "Machine-readable output on stdout"},
           {"--quiet", &common.quiet, "No output unless something is wrong"}},
      .footer =
          "A shard with --pack stores the results of its campaigns as one file. All commands and "
          "the next run read them there. Programs that read files, and the links of the pages, "
          "need them in folders.\n\nEach file is compared with its SHA-256 in run.json; a damaged "
          "file is reported with its pack and campaign, and the campaign is not written. Existing "
          "files with different content are not overwritten. Without Nonio: sqlite3 -A -xf "
          "OUT/.nonio/packs/NAME.sqlar (compare "
          "the digests yourself).\n\nExit status: 0 done; 1 some campaign was not written; 2 usage "
          "or configuration.",
      .examples = {"nonio export 09-tolerances --out out --to /tmp/to-look-at",
                   "nonio export --list --out out", "nonio export --all --out out"},
      .run = [wish, &common] { return get(*wish, common); }};
}

}  // namespace nonio::app
