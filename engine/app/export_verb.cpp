// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <iostream>
#include <memory>

#include "batch/state/output_lock.h"
#include "campaign/config/fleet.h"
#include "campaign/config/manifest.h"
#include "campaign/evaluation/record.h"
#include "campaign_workbook.h"
#include "laboratory/assessment/fleet_count.h"
#include "platform/storage/digest.h"
#include "platform/storage/files.h"
#include "platform/storage/json_values.h"
#include "platform/storage/packed_results.h"
#include "shown_results.h"
#include "site_words.h"
#include "verbs.h"

namespace nonio::app {
using storage::Json;
namespace fs = std::filesystem;
namespace storage = storage;
namespace evaluation = evaluation;

namespace {

struct GetWish {
  std::vector<std::string> ids;
  std::string out, to, format;
  bool all = false, list = false;
};

/// Results in a pack are not visible to programs that read files.
bool is_packed(const fs::path& folder) { return storage::stored_in(folder) != folder; }

Expected<std::vector<std::string>> ids_of(const GetWish& wish) {
  std::vector<std::string> ids = wish.ids;
  for (const std::string& id : ids)
    if (!config::is_campaign_id(id)) return fail("\"" + id + "\" is no id of a campaign");
  const auto take = [&](const fs::path& folder) {
    const bool wanted = wish.list || !wish.to.empty() || is_packed(folder);
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
                const std::vector<evaluation::RecordedFile>& files, bool each_file, bool json,
                const config::TerminalWords& say) {
  std::uint64_t bytes = 0;
  for (const auto& f : files) bytes += f.size;
  if (json) {
    Json line = {{"schema", "nonio-get/1"},     {"id", id},       {"place", folder.string()},
                 {"packed", is_packed(folder)}, {"bytes", bytes}, {"files", Json::array()}};
    for (const auto& f : files)
      line["files"].push_back({{"name", f.name}, {"bytes", f.size}, {"sha256", f.sha256}});
    print_json(line, -1);
    return;
  }
  const fs::path stored = storage::stored_in(folder);
  const std::string place = is_packed(folder)
                                ? say("export.pack", {{"name", stored.filename().string()}})
                                : say("export.folder", {{"name", folder.string()}});
  std::cout << say("export.listed", {{"id", id},
                                     {"count", std::to_string(files.size())},
                                     {"bytes", std::to_string(bytes)},
                                     {"place", place}})
            << "\n";
  if (!each_file) return;
  for (const auto& f : files)
    std::cout << "  " << f.sha256 << "  " << f.size << "  " << f.name << "\n";
}

/// Returns the number of files written. An existing file with the same bytes is skipped; if an
/// existing file has other bytes, nothing is written.
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

/// Returns false, after printing an error, if a file is damaged or would replace a different file.
bool get_one(const GetWish& wish, const std::string& id, const config::TerminalWords& say,
             const Common& common) {
  fs::path folder;
  const auto files = files_of(wish, id, folder);
  if (!files) return complain(files.error().message), false;
  if (wish.list) return print_list(id, folder, *files, !wish.ids.empty(), common.json, say), true;
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
    std::cout << say("export.written", {{"folder", to.string()},
                                        {"count", std::to_string(*written)},
                                        {"all", std::to_string(files->size())}})
              << (in_place ? ": " + say("export.in-place") : "") << "\n";
  return true;
}

fs::path named(const GetWish& wish, const std::string& id) {
  return wish.out.empty() || what_holds(results_at(id)) != Holds::nothing
             ? results_at(id)
             : storage::results_folder(wish.out, id);
}

Expected<std::vector<fs::path>> sources_of(const GetWish& wish) {
  std::vector<fs::path> out;
  const auto take_run = [&](const std::string& run) {
    return storage::each_results_folder(run, [&](const fs::path& folder) {
      if (storage::is_there(folder / evaluation::results_name).value_or(false))
        out.push_back(folder);
    });
  };
  if (wish.all)
    if (const auto listed = take_run(wish.out); !listed) return fail(listed.error());
  for (const std::string& id : wish.ids) {
    const fs::path folder = named(wish, id);
    const Holds holds = what_holds(folder);
    if (holds == Holds::nothing) return fail(holds_nothing(folder));
    if (holds != Holds::run)
      out.push_back(folder);
    else if (const auto listed = take_run(folder.string()); !listed)
      return fail(listed.error());
  }
  std::sort(out.begin(), out.end());
  out.erase(std::unique(out.begin(), out.end()), out.end());
  return out;
}

Expected<std::string> export_one(const fs::path& folder, const GetWish& wish,
                                 const Common& common) {
  NONIO_TRY(const auto shown, what_holds(folder) == Holds::campaign
                                  ? evaluated_now(folder, common, Documents::left_out)
                                  : of_run(folder, common));
  NONIO_TRY(const auto book, workbook_of(shown));
  NONIO_TRY(auto bytes, storage::xlsx_bytes(book));
  const std::string name = book.title + "." + wish.format;
  const fs::path path = fs::path(wish.to) / name;
  NONIO_TRY(const auto there, storage::is_there(path));
  if (there && storage::sha256_of_file(path).value_or("") != storage::sha256(bytes))
    return fail(path.string() +
                " exists with different content; nothing was written. Remove it, or give --to "
                "another folder");
  if (!there)
    if (auto put = storage::publish(wish.to, {{name, std::move(bytes)}}); !put)
      return fail(put.error());
  return name;
}

int export_spreadsheets(GetWish wish, const Common& common) {
  if (wish.list) return complain("--list writes nothing; expected no --format with it");
  if (wish.all && wish.out.empty()) return complain("--all needs --out OUT, the folder of a run");
  if (wish.ids.empty() && !wish.all)
    return complain("expected a campaign, its results (OUT/ID), or --out OUT --all");
  if (wish.to.empty()) wish.to = ".";
  const auto sources = sources_of(wish);
  if (!sources) return complain(sources.error().message);
  bool well = true;
  for (const fs::path& folder : *sources) {
    const auto name = export_one(folder, wish, common);
    if (!name) {
      complain(folder.string() + ": " + text_of(name.error()));
      well = false;
    } else if (common.json) {
      print_json(Json{{"schema", "nonio-get/1"},
                      {"id", fs::path(*name).stem().string()},
                      {"place", folder.string()},
                      {"folder", wish.to},
                      {"file", *name}},
                 -1);
    } else if (!common.quiet) {
      std::cout << (fs::path(wish.to) / *name).string() << "\n";
    }
  }
  return well ? exit_done : exit_failed;
}

/// Writes the counts of effects over the results as fleet.toml, for `nonio model explain`.
int export_fleet(const GetWish& wish) {
  if (wish.list || wish.all || !wish.ids.empty() || wish.out.empty() || wish.to.empty())
    return complain("expected --out OUT, the folder of a run, and --to SITE, its site");
  assessment::FleetCount count;
  bool well = true;
  const auto take = [&](const fs::path& folder) {
    if (!storage::is_there(folder / evaluation::results_name).value_or(false)) return;
    const auto text = storage::read_file(folder / evaluation::results_name);
    const auto taken = text ? count.add(*text) : tl::unexpected(text.error());
    if (taken) return;
    complain(folder.string() + ": " + text_of(taken.error()));
    well = false;
  };
  if (const auto listed = storage::each_results_folder(wish.out, take); !listed)
    return complain(listed.error().message);
  const config::Fleet fleet = count.fleet(today());
  if (fleet.machines.empty())
    return complain(wish.out +
                    ": no campaign has results of model-fit; list it in [run] analyses, or give "
                    "the campaigns a [model]");
  if (auto put = storage::publish(wish.to, {{config::fleet_name, config::text_of(fleet)}}); !put)
    return complain(put.error().message);
  std::cout << (fs::path(wish.to) / config::fleet_name).string() << "\n";
  return well ? exit_done : exit_failed;
}

int get(const GetWish& wish, const Common& common) {
  if (wish.format == "fleet") return export_fleet(wish);
  if (!wish.format.empty()) return export_spreadsheets(wish, common);
  if (wish.out.empty())
    return complain("expected --out OUT, the folder of `nonio run`, or --format xlsx");
  if (wish.ids.empty() && !wish.all && !wish.list)
    return complain("expected the ids of campaigns, --all, or --list");
  if (!wish.ids.empty() && wish.all)
    return complain("--all is every campaign; expected no ids with it");
  if (!wish.to.empty() && wish.list)
    return complain("--list writes nothing; expected no --to with it");
  const auto ids = ids_of(wish);
  if (!ids) return complain(ids.error().message);
  std::optional<batch::OutputLock> lock;
  // The lock is needed because exported results in OUT/ID replace those in the pack.
  if (!wish.list && wish.to.empty()) {
    auto taken = batch::OutputLock::take(wish.out);
    if (!taken) return complain(taken.error().message);
    lock.emplace(std::move(*taken));
  }
  const SiteWords words(common, language_at(wish.out));
  bool well = true;
  for (const std::string& id : *ids) well = get_one(wish, id, words.get(), common) && well;
  return well ? exit_done : exit_failed;
}

}  // namespace

Verb export_verb(Common& common) {
  auto wish = std::make_shared<GetWish>();
  using Takes = Argument::Takes;
  return {
      .name = "export",
      .summary = "Writes the results of campaigns as spreadsheets, or out of packs into folders",
      .arguments = joined(
          {{"CAMPAIGN|OUT/ID|ID", &wish->ids,
            "Campaigns, results of a run, or with --out ids of campaigns"},
           existing(Takes::folder, {"--out", &wish->out, "Output folder of `nonio run`"}),
           one_of({"xlsx", "fleet"},
                  {.name = "--format",
                   .target = &wish->format,
                   .help = "Write ID.xlsx for each campaign: summary, charts, points, curves, "
                           "budget; of a campaign (evaluated now) the readings too. fleet: write "
                           "fleet.toml, in how many campaigns of --out each effect was found and "
                           "how large, into the site --to (docs/model.md)"}),
           takes(Takes::folder,
                 {"--to", &wish->to,
                  "Write into FOLDER/ID and leave the output folder unchanged. Without it: OUT/ID, "
                  "which replaces the pack and is the target of the links of the pages. With "
                  "--format: FOLDER/ID.xlsx, without it in the current folder"}),
           {"--all", &wish->all,
            "All packed campaigns (with --to or --format: all campaigns of --out)"},
           {"--list", &wish->list,
            "Write nothing: list where the results are stored; with ids also each file with size "
            "and SHA-256"},
           templates_argument(common)},
          common_arguments(common)),
      .footer =
          "In a spreadsheet numbers are numbers with the digits of results.json and texts are "
          "never formulas. The same results give the same bytes; a spreadsheet that was changed "
          "is not overwritten. A sheet of readings of an axis can be read again.\n\n"
          "A shard with --pack stores the results of its campaigns as one file. All commands and "
          "the next run read them there. Programs that read files, and the links of the pages, "
          "need them in folders.\n\nEach file is compared with its SHA-256 in run.json; a damaged "
          "file is reported with its pack and campaign, and the campaign is not written. Existing "
          "files with different content are not overwritten. Without Nonio: sqlite3 -A -xf "
          "OUT/.nonio/packs/NAME.sqlar (compare "
          "the digests yourself).\n\nExit status: 0 done; 1 some campaign was not written; 2 usage "
          "or configuration.",
      .examples = {"nonio export samples/site/09-tolerances --format xlsx --to /tmp/to-look-at",
                   "nonio export 09-tolerances --out out --to /tmp/to-look-at",
                   "nonio export --format fleet --out out --to samples/site",
                   "nonio export --list --out out", "nonio export --all --out out"},
      .run = [wish, &common] { return get(*wish, common); }};
}

}  // namespace nonio::app
