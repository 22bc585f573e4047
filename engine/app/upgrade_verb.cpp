// SPDX-License-Identifier: Apache-2.0
#include <filesystem>
#include <iostream>
#include <memory>

#include "batch/survey/site_walk.h"
#include "campaign/config/manifest.h"
#include "campaign/config/upgrade.h"
#include "platform/storage/files.h"
#include "platform/storage/json_values.h"
#include "shown_results.h"
#include "verbs.h"

namespace nonio::app {
using storage::Json;
namespace fs = std::filesystem;

namespace {

class Upgrade {
 public:
  explicit Upgrade(const Common& common) : common_(common) {}

  int run(const fs::path& folder) {
    if (what_holds(folder) == Holds::campaign) {
      file(folder / config::manifest_name, config::campaign_file());
      return end();
    }
    const auto walk = batch::walk_site(folder, {}, 60.0, [] { return false; });
    if (!walk) return complain(text_of(walk.error()));
    const bool is_site = fs::exists(folder / config::site_name);
    if (!is_site && walk->campaigns.empty())
      return complain(folder.string() + " contains neither site.toml nor a campaign");
    if (is_site) file(folder / config::site_name, config::site_file());
    std::error_code none;
    for (const auto& entry : fs::directory_iterator(folder / config::causes_folder, none))
      if (entry.path().extension() == ".toml") file(entry.path(), config::causes_file());
    for (const auto& [name, why] : walk->unlisted) failed({why, name});
    for (const std::string& one : walk->campaigns)
      file((folder / one / config::manifest_name).lexically_normal(), config::campaign_file());
    return end();
  }

 private:
  /// If `path` is a symbolic link, its target is written.
  static Expected<void> write(const fs::path& path, const std::string& text) {
    std::error_code error;
    const fs::path real = fs::canonical(path, error);
    if (error) return fail(Error{error.message(), path.string()});
    const fs::perms mode = fs::status(real, error).permissions();
    if (auto done = storage::publish(real.parent_path(), {{real.filename().string(), text}}); !done)
      return done;
    fs::permissions(real, mode, error);
    return error ? fail(Error{"cannot restore the permissions: " + error.message(), path.string()})
                 : Expected<void>();
  }

  void file(const fs::path& path, const config::Key& declaration) {
    const auto text = storage::read_small_file(path);
    if (!text) return failed(text.error());
    const auto now = config::upgraded(*text, declaration, path.string());
    if (!now) return failed(now.error());
    if (now->lines.empty()) return;
    if (const auto done = write(path, now->text); !done) return failed(done.error());
    ++files_;
    for (const config::UpgradedLine& one : now->lines)
      if (common_.json)
        changes_.push_back({{"file", path.string()},
                            {"line", one.line},
                            {"before", one.before},
                            {"after", one.after}});
      else if (!common_.quiet)
        std::cout << path.string() << ":" << one.line << "\n- " << one.before << "\n+ " << one.after
                  << "\n";
  }

  void failed(const Error& error) {
    complain(text_of(error));
    ++failed_;
  }

  int end() const {
    if (common_.json)
      print_json(Json{{"schema", "nonio-upgrade/1"}, {"files", files_}, {"changes", changes_}});
    else if (!common_.quiet)
      std::cout << (files_ == 0 ? std::string("no file")
                                : std::to_string(files_) + (files_ == 1 ? " file" : " files"))
                << " changed\n";
    return failed_ == 0 ? exit_done : exit_failed;
  }

  const Common& common_;
  Json changes_ = Json::array();
  std::size_t files_ = 0, failed_ = 0;
};

}  // namespace

Verb upgrade_verb(Common& common) {
  auto folder = std::make_shared<std::string>();
  return {
      .name = "upgrade",
      .summary =
          "Gives keys with former names in site.toml, causes/ and campaign.toml their present "
          "names",
      .arguments = joined(
          {required(existing(Argument::Takes::folder, {"SITE|CAMPAIGN", folder.get(),
                                                       "Folder of a site or of one campaign"}))},
          common_arguments(common)),
      .footer =
          "Prints each changed line. Comments, order, spaces and line ends are kept. A "
          "file that cannot be changed safely is reported and stays as it is."
          "\n\nExit status: 0 done; 1 some file was not changed; 2 usage.",
      .examples = {"nonio upgrade samples/site"},
      .run = [folder, &common] { return Upgrade(common).run(*folder); }};
}

}  // namespace nonio::app
