// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <filesystem>
#include <iostream>
#include <memory>
#include <string>
#include <vector>

#include "batch/survey/site_walk.h"
#include "campaign/config/manifest.h"
#include "campaign/config/site_files.h"
#include "campaign/config/site_logs.h"
#include "campaign/evaluation/evaluate.h"
#include "campaign/loader/plugins.h"
#include "campaign/reading/campaign_reader.h"
#include "campaign/reading/checked_read.h"
#include "campaign/reading/unknown_format.h"
#include "common.h"
#include "nonio/sdk/format.h"
#include "nonio/sdk/text.h"
#include "platform/storage/files.h"
#include "platform/storage/json_values.h"
#include "plugin_check/template_check.h"
#include "shown_results.h"
#include "site_words.h"
#include "text_layout.h"
#include "verbs.h"

namespace nonio::app {

namespace fs = std::filesystem;

namespace {

struct FileWish {
  std::vector<std::string> columns{};  ///< entries of the reader option `columns`
  std::string axis{};                  ///< probable axis of the readings; empty if unknown
};
using storage::Json;
namespace fs = std::filesystem;

constexpr std::size_t most_rows = 6, most_points = 20'000;

struct Read {
  const Reader* reader = nullptr;
  std::string axis{};
  Observations readings{};
};

class FileCheck {
 public:
  FileCheck(const fs::path& file, const FileWish& wish, const Common& common)
      : name_(file.filename().string()), columns_(wish.columns), common_(common) {
    if (!wish.axis.empty()) axes_.insert(axes_.begin(), wish.axis);
  }

  int run(const fs::path& file) {
    plugins_.load(common_.plugin_folders());
    const auto bytes = storage::read_file(file);
    if (!bytes) return complain(text_of(bytes.error()));
    const auto converted = utf8_of_utf16(*bytes);
    if (!converted) return report(fail(converted.error()), {});
    const std::string& text = *converted ? **converted : *bytes;
    std::optional<reading::StatedTable> table;
    if (!columns_.empty()) table = reading::stated_table(plugins_, text, most_rows);
    const auto got = read(text, table);
    if (!got && !table) table = reading::stated_table(plugins_, text, most_rows);
    return report(got, table);
  }

 private:
  const Reader* reader_of(std::string_view bytes,
                          const std::optional<reading::StatedTable>& table) const {
    if (!columns_.empty()) return table ? table->reader : nullptr;
    for (const Reader& r : plugins_.readers())
      if (r.reads("axis") && r.recognises(reading::head_of(bytes))) return &r;
    return nullptr;
  }

  Expected<Read> read(const std::string& bytes,
                      const std::optional<reading::StatedTable>& table) const {
    const Reader* const reader = reader_of(bytes, table);
    if (reader == nullptr)
      return fail("no reader recognizes the format of this file: " +
                  reading::what_is_wrong(bytes, name_));
    config::RawOptions stated;
    if (!columns_.empty())
      stated[reader->info.name][reading::columns_option] = {Setting(columns_), name_, 0};
    const auto options = config::settle_options(reader->info, {}, stated);
    if (!options) return fail(options.error().front());
    Error first;
    bool was_linear = false, was_rotary = false;
    for (const std::string& axis : axes_) {
      Campaign campaign;
      campaign.machine.axes.push_back({.name = axis, .rotary = axis[0] < 'D'});
      Measurement m;
      m.id = m.axis = axis;
      m.kind = "axis";
      m.file = name_;
      auto got = reading::checked_read(*reader, {bytes, campaign, m, *options, {}, nullptr});
      if (got) return Read{reader, axis, std::move(*got)};
      const Error& error = got.error();
      if (first.message.empty()) first = error;
      (campaign.machine.axes.front().rotary ? was_rotary : was_linear) = true;
      if (was_linear && was_rotary && error.line != 0 && error.line == first.line &&
          error.message == first.message)
        break;
    }
    return fail(std::move(first));
  }

  static Json points(const Read& read) {
    const Observations& o = read.readings;
    const Quantity at = position_of(o.axes.front().rotary), deviation = deviation_of(o.angular);
    const std::size_t step = (o.size() + most_points - 1) / most_points;
    Json position = Json::array(), value = Json::array(), run = Json::array(), way = Json::array();
    for (std::size_t i = 0; i < o.size(); i += std::max<std::size_t>(step, 1)) {
      position.push_back(printed(o.axes.front().position[i], at));
      value.push_back(printed(o.deviation[i], deviation));
      run.push_back(o.run[i]);
      way.push_back(o.axes.front().approach.empty() ? 0 : int{o.axes.front().approach[i]});
    }
    return {{"position_unit", std::string(unit_of(at).symbol)},
            {"deviation_unit", std::string(unit_of(deviation).symbol)},
            {"position", std::move(position)},
            {"deviation", std::move(value)},
            {"run", std::move(run)},
            {"direction", std::move(way)}};
  }

  int report(const Expected<Read>& read, const std::optional<reading::StatedTable>& table) const {
    if (!common_.json) {
      if (!read) return complain(printable(name_) + ": " + text_of(read.error()), exit_failed);
      if (!common_.quiet)
        std::cout << printable(name_) << ": reader " << read->reader->info.name << ", "
                  << read->readings.size() << " readings, " << read->readings.missing
                  << " not taken\n";
      return exit_done;
    }
    Json json = {{"schema", "nonio-check-file/1"}, {"file", name_}};
    if (read) {
      const Observations& o = read->readings;
      json["reader"] = read->reader->info.name;
      // X and A are only assumed axes; any other axis was stated by the file or by the caller.
      if (read->axis != "X" && read->axis != "A") json["axis"] = read->axis;
      json["rotary"] = o.axes.front().rotary;
      json["readings"] = o.size();
      json["missing"] = o.missing;
      json["points"] = points(*read);
      for (const Remark& note : o.notes)
        for (const auto& [name, words] : note.texts)
          if (name == "text") json["text"] = words;
    } else {
      json["error"] = {{"message", read.error().message}};
      if (read.error().line != 0) json["error"]["line"] = read.error().line;
      if (!read.error().column.empty()) json["error"]["column"] = read.error().column;
    }
    if (table) json["rows"] = table->rows;
    print_json(json);
    return read ? exit_done : exit_failed;
  }

  std::string name_;
  std::vector<std::string> axes_{"X", "A", "Y", "Z", "B", "C"};
  const std::vector<std::string>& columns_;
  const Common& common_;
  loader::Plugins plugins_{};
};

/// Implements `nonio check FILE`: prints the reader that accepts the file and the number of
/// readings, or the reason why no reader accepts it. Returns exit status 1 if the file cannot be
/// read.
int check_file(const fs::path& file, const FileWish& wish, const Common& common) {
  return FileCheck(file, wish, common).run(file);
}

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

namespace fs = std::filesystem;

int check_templates(const std::string& site, const Common& common) {
  std::vector<fs::path> folders = common.template_folders();
  if (!site.empty() && fs::is_directory(fs::path(site) / "templates"))
    folders.push_back(fs::path(site) / "templates");
  const auto found = plugin_check::check_templates(folders, common.plugin_folders());
  if (!found) return complain(text_of(found.error()));
  if (common.json) {
    Json errors = Json::array();
    for (const Error& e : found->errors)
      errors.push_back({{"file", e.file}, {"message", e.message}});
    print_json(Json{{"schema", "nonio-template-check/1"},
                    {"outputs", found->outputs},
                    {"errors", std::move(errors)}});
  } else {
    for (const Error& e : found->errors)
      std::cout << e.file << (e.file.empty() ? "" : ": ") << e.message << "\n";
    std::string outputs;
    for (const std::string& name : found->outputs) outputs += (outputs.empty() ? "" : ", ") + name;
    if (!common.quiet)
      std::cout << found->errors.size() << (found->errors.size() == 1 ? " error" : " errors")
                << " in the templates of " << outputs << "\n";
  }
  return found->errors.empty() ? exit_done : exit_failed;
}

}  // namespace nonio::app
