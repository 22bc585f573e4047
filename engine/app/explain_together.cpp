// SPDX-License-Identifier: Apache-2.0
#include "explain_together.h"

#include <algorithm>
#include <filesystem>
#include <iostream>
#include <map>
#include <set>

#include "campaign/config/manifest.h"
#include "campaign/config/site_files.h"
#include "campaign/modelling/joint_model.h"
#include "campaign/modelling/model_json.h"
#include "campaign_verb.h"
#include "laboratory/assessment/residuals.h"
#include "nonio/sdk/format.h"
#include "platform/storage/files.h"
#include "platform/storage/json_values.h"
#include "platform/storage/nearest.h"
#include "tables.h"

namespace nonio::app {

namespace {

namespace fs = std::filesystem;

/// Links to folders and hidden folders are not searched.
std::vector<fs::path> campaigns_in(const fs::path& folder) {
  std::error_code error;
  if (fs::exists(folder / config::manifest_name, error)) return {folder};
  std::vector<fs::path> out;
  fs::recursive_directory_iterator it(folder, fs::directory_options::skip_permission_denied, error);
  for (; !error && it != fs::recursive_directory_iterator(); it.increment(error)) {
    const std::string name = it->path().filename().string();
    if (name.starts_with('.') && it->is_directory(error)) it.disable_recursion_pending();
    if (name == config::manifest_name && it->is_regular_file(error))
      out.push_back(it->path().parent_path());
  }
  std::sort(out.begin(), out.end());
  return out;
}

class ExplainTogether {
 public:
  ExplainTogether(const TogetherOptions& options, const Common& common, std::uint64_t seed)
      : options_(options), common_(common), seed_(seed) {}

  int run() {
    for (const std::string& folder : options_.folders) {
      const auto found = campaigns_in(folder);
      if (found.empty()) return complain(folder + ": there is no campaign.toml in it or below it");
      for (const fs::path& campaign : found)
        if (const int status = open(campaign); status != exit_done) return status;
    }
    if (read_.size() < 2)
      return complain("expected two campaigns or more; found " + std::to_string(read_.size()) +
                      (passed_over_ > 0 ? " (" + std::to_string(passed_over_) +
                                              " are not of this machine or period)"
                                        : ""));
    std::vector<const reading::ReadCampaign*> all;
    for (const auto& one : read_) all.push_back(one.get());
    progress("explaining " + std::to_string(all.size()) + " campaigns together");
    const auto fleet =
        config::read_fleet(config::site_of(options_.folders.front()), place_->context.site);
    if (!fleet) return complain(text_of(fleet.error().front()));
    const auto found = modelling::explain_together(all, *fleet, seed_);
    if (!found) {
      complain(text_of(found.error()));
      return exit_failed;
    }
    const reading::Context& context = place_->context;
    const modelling::ModelWords words(context.templates,
                                      common_.json ? "en" : context.site.language);
    const auto document = modelling::together_json(*found, words, seed_, errors_);
    if (!options_.page.empty())
      if (const auto put = write_page(found->together, words); !put)
        return complain(text_of(put.error()));
    if (common_.json)
      std::cout << storage::dump(document);
    else
      print_together(std::cout, document, words.terminal());
    if (!common_.json && !found->left_out.empty() && !common_.quiet)
      complain("not explained together: " + storage::listed(found->left_out));
    return errors_.empty() ? exit_done : exit_failed;
  }

 private:
  Expected<void> write_page(const std::vector<modelling::Together>& found,
                            const modelling::ModelWords& words) const {
    NONIO_TRY(auto text, assessment::residuals_page(found, place_->context.templates,
                                                    words.terminal().language()));
    const fs::path path = fs::absolute(options_.page);
    return storage::publish(path.parent_path(), {{path.filename().string(), std::move(text)}});
  }

  void progress(const std::string& text) const {
    if (!common_.quiet) complain(text);
  }

  /// Campaigns of the same parent folder share plugins and templates. Returns an exit status other
  /// than 0 if the command cannot continue.
  int open(const fs::path& folder) {
    const fs::path whole = fs::weakly_canonical(folder);
    if (!seen_.insert(whole.string()).second) return exit_done;
    const fs::path parent = whole.parent_path();
    if (!place_ || parent != parent_) {
      auto place =
          reading::open_workplace(folder, common_.plugin_folders(), common_.template_folders(),
                                  NONIO_VERSION, reading::TemplatesFor::terminal);
      if (!place) return complain(text_of(place.error()));
      if (place_) earlier_.push_back(std::move(place_));
      place_ = std::move(*place);
      parent_ = parent;
    }
    auto read = std::make_unique<reading::ReadCampaign>(
        reading::read_campaign(folder, place_->context, [](const std::string&) {}));
    for (Error error : read->errors) {
      error.message = folder.string() + ": " + error.message;
      complain(text_of(errors_.emplace_back(std::move(error))));
    }
    if (!read->manifest) return exit_done;  // a campaign with an error does not stop the others
    const std::string& id = read->manifest->campaign.id;
    const auto [known, is_new] = folder_of_.emplace(id, folder.string());
    if (!is_new)
      return complain("campaign " + id + " is in " + known->second + " and in " + folder.string() +
                      ": its readings would count twice");
    if (!wanted(read->manifest->campaign))
      ++passed_over_;
    else
      read_.push_back(std::move(read));
    return exit_done;
  }

  bool wanted(const Campaign& c) const {
    const Machine& m = c.machine;
    const std::string& name = options_.machine;
    return (name.empty() || name == m.asset || name == m.serial || name == m.model) &&
           (options_.since.empty() || c.date >= options_.since) &&
           (options_.until.empty() || (!c.date.empty() && c.date <= options_.until));
  }

  const TogetherOptions& options_;
  const Common& common_;
  std::uint64_t seed_;
  std::unique_ptr<reading::Workplace> place_;
  std::vector<std::unique_ptr<reading::Workplace>> earlier_;
  fs::path parent_;
  std::set<std::string> seen_;
  std::map<std::string, std::string> folder_of_;
  std::vector<std::unique_ptr<reading::ReadCampaign>> read_;
  std::vector<Error> errors_;
  std::size_t passed_over_ = 0;
};

}  // namespace

bool is_single(const TogetherOptions& options) {
  std::error_code error;
  return options.folders.size() == 1 && options.machine.empty() && options.since.empty() &&
         options.until.empty() &&
         (fs::exists(fs::path(options.folders.front()) / config::manifest_name, error) ||
          campaigns_in(options.folders.front()).empty());
}

int explain_together(const TogetherOptions& options, const Common& common, std::uint64_t seed) {
  return ExplainTogether(options, common, seed).run();
}

}  // namespace nonio::app
