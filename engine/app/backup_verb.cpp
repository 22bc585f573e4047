// SPDX-License-Identifier: Apache-2.0
#include <iostream>
#include <memory>
#include <set>

#include "certificates/certificate_list.h"
#include "platform/storage/backup.h"
#include "platform/storage/files.h"
#include "platform/storage/json_values.h"
#include "verbs.h"

namespace nonio::app {
using storage::Json;
namespace fs = std::filesystem;

namespace {

struct BackupWish {
  std::string folder, file, out;
};

Json report_left_out(const fs::path& folder, const storage::BackupSummary& summary) {
  Json all = Json::array();
  for (const std::string& name : summary.left_out) {
    std::error_code error;
    const fs::path target = fs::read_symlink(folder / name, error);
    all.push_back(error ? Json{{"name", name}}
                        : Json{{"name", name}, {"link_to", target.string()}});
    complain(error ? name + " is not in the backup: it is neither a file, a folder nor a link"
                   : name + " is a link to " + target.string() +
                         ", which is outside of the folder: what it contains is not in the backup; "
                         "save it by another nonio backup");
  }
  return all;
}

int backup(const BackupWish& wish, const Common& common) {
  const auto written = storage::write_backup(wish.folder, wish.file);
  if (!written) return complain(text_of(written.error()));
  const Json left_out = report_left_out(wish.folder, *written);
  if (common.json)
    print_json(Json{{"schema", "nonio-backup/1"},
                    {"file", wish.file},
                    {"files", written->files},
                    {"bytes", written->bytes},
                    {"left_out", left_out}});
  else if (!common.quiet)
    std::cout << wish.file << ": " << written->files << " files, " << written->bytes
              << " bytes, read back and compared\n";
  return exit_done;
}

Expected<Json> issued_since(const fs::path& site, const fs::path& out) {
  NONIO_TRY(const auto numbering, certificates::numbering_of(site));
  NONIO_TRY(const auto entries, certificates::certificates_of(site, numbering));
  std::set<std::string> issued;
  for (const certificates::RegisterEntry& e : entries)
    if (e.state != "drawn") issued.insert(e.number);
  Json since = Json::array();
  std::set<fs::path> folders;
  const auto listed =
      storage::each_results_folder(out, [&](const fs::path& folder) { folders.insert(folder); });
  if (!listed) return fail(listed.error());
  for (const fs::path& folder : folders) {
    const auto text = storage::read_file(folder / "results.json");
    if (!text) continue;
    const Json results = storage::parse_or_discard(*text);
    if (!results.is_object() || !results.contains("certificate")) continue;
    const auto text_of = [&of = results["certificate"]](const char* name) {
      return of.is_object() && of.contains(name) && of[name].is_string()
                 ? of[name].get<std::string>()
                 : std::string();
    };
    const std::string number = text_of("number");
    if (number.empty() || issued.contains(number)) continue;
    since.push_back(
        {{"number", number}, {"date", text_of("date")}, {"campaign", folder.filename().string()}});
  }
  return since;
}

int restore(const BackupWish& wish, const Common& common) {
  const auto restored = storage::restore_backup(wish.file, wish.folder);
  if (!restored) return complain(text_of(restored.error()));
  Json json = {{"schema", "nonio-restore/1"},
               {"folder", wish.folder},
               {"files", restored->files},
               {"bytes", restored->bytes}};
  if (!common.json && !common.quiet)
    std::cout << wish.folder << ": " << restored->files << " files, each with its SHA-256\n";
  bool older = false;
  if (!wish.out.empty()) {
    auto since = issued_since(wish.folder, wish.out);
    if (!since) return complain(text_of(since.error()), exit_failed);
    older = !since->empty();
    for (const Json& one : *since)
      if (!common.json)
        std::cout << "issued since this backup: " << one["number"].get<std::string>() << "  "
                  << one["campaign"].get<std::string>() << "  " << one["date"].get<std::string>()
                  << "\n";
    json["issued_since"] = std::move(*since);
  }
  if (common.json) print_json(json);
  if (older)
    complain(
        "the register is older than the certificates in " + wish.out +
        ": the next run would refuse to draw a number. Restore a newer backup of the site; if "
        "there "
        "is none, use another [certificate] numbering, and keep this register outside the site");
  return older ? exit_failed : exit_done;
}

}  // namespace

Verb backup_verb(Common& common) {
  auto wish = std::make_shared<BackupWish>();
  using Takes = Argument::Takes;
  return {
      .name = "backup",
      .summary = "Writes a site or an output folder into one archive, also during a run",
      .arguments = joined(
          {required(existing(Takes::folder,
                             {"SITE|OUT", &wish->folder, "Folder of a site or output of a run"})),
           required(
               takes(Takes::file, {"FILE", &wish->file, "The new archive, in the format of tar"}))},
          common_arguments(common)),
      .footer =
          "Databases are copied as of one moment, and the files of each folder after that as of "
          "one "
          "moment. The archive has the SHA-256 of each file and is read back before it gets its "
          "name. Save the output folder first and the site after it: then the register has every "
          "number that the output has. A register or a history on a server is not in it; save it "
          "with "
          "pg_dump. A link that leads outside of the folder is kept as a link and named, because "
          "what "
          "it leads to is not in the archive.\n\nExit status: 0 done; 2 no archive was written.",
      .examples = {"nonio backup out out.tar", "nonio backup site site.tar"},
      .run = [wish, &common] { return backup(*wish, common); }};
}

Verb restore_verb(Common& common) {
  auto wish = std::make_shared<BackupWish>();
  using Takes = Argument::Takes;
  return {
      .name = "restore",
      .summary = "Unpacks an archive of `nonio backup` into a new folder",
      .arguments =
          joined({required(existing(Takes::file, {"FILE", &wish->file, "The archive"})),
                  required(takes(Takes::folder,
                                 {"FOLDER", &wish->folder, "A folder that is missing or empty"})),
                  existing(Takes::folder,
                           {"--out", &wish->out,
                            "Output folder of the last run: certificates in it that the restored "
                            "register of the site does not contain are named"})},
                 common_arguments(common)),
      .footer =
          "Every file is compared with its SHA-256 before anything is written.\n\nExit status: 0 "
          "restored; 1 restored, and --out has certificates that were issued since; 2 nothing was "
          "restored.",
      .examples = {"nonio restore site.tar restored --out out"},
      .run = [wish, &common] { return restore(*wish, common); }};
}

}  // namespace nonio::app
