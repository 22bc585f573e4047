// SPDX-License-Identifier: Apache-2.0
#include <filesystem>
#include <iostream>
#include <memory>

#include "batch/survey/site_walk.h"
#include "campaign/config/site_files.h"
#include "campaign/config/site_logs.h"
#include "campaign/evaluation/evaluate.h"
#include "campaign/reading/campaign_reader.h"
#include "check_file.h"
#include "platform/storage/json_values.h"
#include "results_folder.h"
#include "site_words.h"
#include "verbs.h"

namespace nonio::app {
using storage::Json;
namespace fs = std::filesystem;

namespace {

struct CheckWish {
  std::string folder;
  FileWish file{};
  bool only_templates = false;
};

class Check {
 public:
  explicit Check(const Common& common) : common_(common), words_(common) {}

  int run(const fs::path& folder) {
    if (what_holds(folder) == Holds::campaign) {
      campaign(folder);
      return end();
    }
    const auto walk = batch::walk_site(folder, {}, 60.0, [] { return false; });
    if (!walk) return complain(text_of(walk.error()));
    site(folder);
    for (const std::string& note : walk->notes) complain(note);
    for (const auto& [name, why] : walk->unlisted) found({why, name}, "");
    for (const std::string& one : walk->campaigns) campaign(folder / one);
    if (walk->campaigns.empty())
      return complain(folder.string() + " contains no campaign (no folder with a campaign.toml)");
    return end();
  }

 private:
  void found(const Error& e, const std::string& campaign) {
    if (common_.json) {
      Json json = {{"message", e.message}};
      if (!campaign.empty()) json["campaign"] = campaign;
      if (!e.file.empty()) json["file"] = e.file;
      if (e.line != 0) json["line"] = e.line;
      if (!e.column.empty()) json["column"] = e.column;
      errors_.push_back(std::move(json));
    } else {
      const bool below =
          !campaign.empty() && (e.file.empty() || fs::exists(campaign + "/" + e.file));
      std::cout << (below ? campaign + "/" : "") << text_of(e) << "\n";
    }
    ++count_;
  }

  void warn(const std::string& message) {
    if (common_.json)
      warnings_.push_back(message);
    else
      std::cout << message << "\n";
  }

  template <class Result>
  void expect(const Result& result) {
    if (!result)
      for (const Error& e : result.error()) found(e, "");
  }

  void site(const fs::path& folder) {
    std::string digest;
    expect(config::read_site(folder, digest));
    expect(config::read_site_logs(folder));
  }

  void campaign(const fs::path& folder) {
    ++campaigns_;
    const std::size_t before = count_;
    if (place_ == nullptr) {
      auto place = reading::open_workplace(folder, common_.plugin_folders(),
                                           common_.template_folders(), NONIO_VERSION);
      if (!place) return found(place.error(), "");
      place_ = std::move(*place);
      const reading::Context& context = place_->context;
      words_.take(config::TerminalWords(context.templates, context.site.language));
      for (const std::string& note : place_->notes) complain(note);
    }
    const std::string id = id_of_campaign(folder);
    if (const auto [other, is_new] = folders_.emplace(id, folder); !is_new)
      found({"the id \"" + id + "\" is also that of " + other->second.string(),
             config::manifest_name},
            folder.string());
    const evaluation::Evaluated evaluated =
        evaluation::evaluate(folder, id, place_->context, [](const std::string&) {});
    for (const Error& e : evaluated.results.errors) found(e, folder.string());
    for (const auto& analysis : evaluated.results.analyses)
      findings_ += static_cast<std::size_t>(
          std::count_if(analysis.evaluation.findings.begin(), analysis.evaluation.findings.end(),
                        [](const Finding& f) { return f.attention; }));
    for (const Remark& note : evaluated.results.notes)
      if (note.id == reading::former_key_note) warn(folder.string() + "/" + note.english);
    invalid_ += count_ > before ? 1 : 0;
  }

  int end() const {
    if (common_.json)
      print_json(Json{{"schema", "nonio-check/1"},
                      {"campaigns", campaigns_},
                      {"invalid", invalid_},
                      {"errors", errors_},
                      {"warnings", warnings_}});
    else if (!common_.quiet)
      std::cout << words_.get().counted("check.campaigns", campaigns_) << ": "
                << (count_ == 0 ? words_.get()("check.none")
                                : words_.get().counted("check.errors", count_))
                << (findings_ == 0 ? "" : ", " + words_.get().counted("check.warnings", findings_))
                << "\n";
    return count_ == 0 ? exit_done : exit_failed;
  }

  const Common& common_;
  SiteWords words_;
  std::unique_ptr<reading::Workplace> place_{};
  std::map<std::string, fs::path> folders_{};
  Json errors_ = Json::array(), warnings_ = Json::array();
  std::size_t campaigns_ = 0, invalid_ = 0, count_ = 0, findings_ = 0;
};

}  // namespace

Verb check_verb(Common& common) {
  auto wish = std::make_shared<CheckWish>();
  return {
      .name = "check",
      .summary =
          "Validates a campaign, a site with all its campaigns, or a file of readings; writes "
          "no output",
      .arguments = joined(
          {existing(Argument::Takes::path,
                    {"SITE|CAMPAIGN|FILE", &wish->folder,
                     "Folder of a site or of one campaign; or a file with readings of one axis"}),
           {"--column", &wish->file.columns,
            "For a FILE with other names of columns: \"NAME = KNOWN\" such as \"Soll mm = "
            "target_mm\", or \"#3 = target_mm\" for the third one; may be given several times"},
           {"--axis", &wish->file.axis, "For a FILE: probable axis of its readings, tried first"},
           {"--only-templates", &wish->only_templates,
            "Check the templates of reports and certificates instead: layouts, the texts of every "
            "language and their placeholders, missing characters. Without SITE: those that are "
            "installed"},
           templates_argument(common)},
          common_arguments(common)),
      .footer =
          "Evaluates every campaign like `nonio run` and prints each error with file, line and "
          "column. To change the look or the texts of documents for one site, copy a file from the "
          "installed templates to SITE/templates, edit it, and check it with --only-templates."
          "\n\nExit status: 0 no error; 1 errors; 2 usage.",
      .examples = {"nonio check samples/site/02-constant-reversal",
                   "nonio check --only-templates samples/site"},
      .run = [wish, &common] {
        if (wish->only_templates) return check_templates(wish->folder, common);
        if (wish->folder.empty()) return complain("expected the folder of a site or campaign");
        std::error_code error;
        if (fs::is_regular_file(wish->folder, error))
          return check_file(wish->folder, wish->file, common);
        if (!wish->file.columns.empty() || !wish->file.axis.empty())
          return complain("--column and --axis are for a file of readings");
        return Check(common).run(wish->folder);
      }};
}

}  // namespace nonio::app
