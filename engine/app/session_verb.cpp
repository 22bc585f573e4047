// SPDX-License-Identifier: Apache-2.0
// The session stores no state: each call determines the present step from the files, the record of
// the machine and the campaigns of the site.
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <iostream>
#include <memory>

#include "campaign/config/site_files.h"
#include "campaign/planning/plan.h"
#include "campaign/tables/control_state.h"
#include "check_campaign.h"
#include "insert_set.h"
#include "laboratory/assessment/loading_verdict.h"
#include "laboratory/assessment/table_changes.h"
#include "nonio/sdk/format.h"
#include "platform/storage/files.h"
#include "probe.h"
#include "tables.h"
#include "text_layout.h"
#include "verbs.h"

namespace nonio::app {
namespace fs = std::filesystem;

namespace {

struct SessionWish {
  std::string folder, backup, axis, control, out, loaded, check, checked;
  std::vector<std::string> settings;
};

struct Step {
  std::string name, state;
  std::string text;
};

using Parts = config::TerminalWords::Parts;
using Answer = assessment::LoadingVerdict::Answer;

std::string names_of(const std::vector<Artifact>& files) {
  std::string out;
  for (const Artifact& f : files) out += (out.empty() ? "" : ", ") + f.name;
  return out;
}

std::string shell_word(const std::string& text) {
  const auto is_plain = [](char c) {
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') ||
           std::string_view("/._-,=:+").find(c) != std::string_view::npos;
  };
  if (!text.empty() && std::all_of(text.begin(), text.end(), is_plain)) return text;
  std::string out = "'";
  for (const char c : text) out += c == '\'' ? std::string("'\\''") : std::string(1, c);
  return out + "'";
}

class Session {
 public:
  Session(const SessionWish& wish, const Texts& settings, const Common& common)
      : w_(wish), settings_(settings), common_(common) {}

  int run() {
    auto opened = open_campaign(w_.folder, common_);
    if (!opened) return opened.error();
    open_ = std::make_unique<OpenCampaign>(std::move(*opened));
    words_ = std::make_unique<config::TerminalWords>(
        open_->place->context.templates, common_.json ? "en" : open_->place->context.site.language);
    const auto axis = merged_axis(w_.axis, open_->campaign());
    if (!axis) return complain(axis.error().message);
    axis_ = *axis;
    set_ = tables::set_of_axes(axis_, campaign().machine);
    if (auto day = check_day(w_.loaded, open_->campaign().date); !day)
      return complain(text_of(day.error()));
    const bool is_done = set_.empty()
                             ? backup() && table() && probe() && loading() && check() && verdict()
                             : backup() && tables_of_set() && probes_of_set() && loading() &&
                                   check() && verdict_of_set();
    print();
    if (!is_done) return is_refused_ ? exit_failed : exit_done;
    return answer_ == Answer::worked ? exit_done : exit_failed;
  }

 private:
  std::string say(std::string_view name, const Parts& parts = {}) const {
    return (*words_)(name, parts);
  }
  const Campaign& campaign() const { return open_->campaign(); }

  void done(const char* step, std::string text) {
    steps_.push_back({step, "done", std::move(text)});
  }
  /// Adds the step at which the session ends. Returns false.
  bool missing(const char* step, std::string text, std::string todo, const std::string& argument) {
    steps_.push_back({step, "missing", std::move(text)});
    todo_ = std::move(todo);
    command_ = command() + argument;
    return false;
  }
  bool refused(const char* step, const Error& error) {
    steps_.push_back({step, "refused", text_of(error)});
    todo_ = say("session.todo.refused");
    command_ = command();
    is_refused_ = true;
    return false;
  }

  /// Omits --loaded and --check, because the machine record and the site already contain their
  /// values.
  std::string command() const {
    std::string out = "nonio table session " + shell_word(w_.folder);
    if (!w_.backup.empty()) out += " --backup " + shell_word(w_.backup);
    for (const auto& [option, text] :
         {std::pair{" --axis ", &w_.axis}, {" --control ", &w_.control}, {" --out ", &w_.out}})
      if (!text->empty()) out += option + shell_word(*text);
    for (const std::string& s : w_.settings) out += " --set " + shell_word(s);
    return out;
  }

  const std::string& first_axis() const { return set_.empty() ? axis_ : set_.front(); }

  const config::ControlState* recorded_state() const {
    if (!open_->read.machine) return nullptr;
    const auto of = open_->read.machine->axes.find(first_axis());
    return of == open_->read.machine->axes.end() ? nullptr : of->second.state_on(campaign().date);
  }

  bool backup() {
    std::vector<Artifact> files;
    if (!w_.backup.empty()) {
      auto read = config::read_table_files(w_.backup);
      if (!read) return refused("backup", read.error());
      files = std::move(*read);
    } else if (const auto* state = recorded_state()) {
      if (const auto found = open_->read.state_files.find(state->files);
          found != open_->read.state_files.end())
        files = found->second;
    }
    if (files.empty())
      return missing("backup", say("session.backup.missing", {{"date", campaign().date}}),
                     say("session.todo.backup"), " --backup FILE,...");
    const std::string control = w_.control.empty() ? campaign().machine.control : w_.control;
    auto present =
        understood(open_->place->plugins, files, control, campaign(), settings_,
                   [&](const Info& info) { return campaign_options(*open_, info, settings_); });
    if (!present) return refused("backup", present.error());
    present_ = std::move(*present);
    done("backup", say(w_.backup.empty() ? "session.backup.record" : "session.backup.given",
                       {{"files", names_of(present_.files)}}));
    return true;
  }

  Settings options() const { return *campaign_options(*open_, present_.control->info, settings_); }

  /// Adds the steps of the state and of the new tables of several axes.
  bool tables_of_set() {
    auto merged = merge_set_now(*open_, present_, options(), set_);
    if (!merged) return refused("state", merged.error());
    merged_set_ = std::move(*merged);
    std::string state;
    for (const auto& [axis, with] : merged_set_.with)
      state += (state.empty() ? "" : "; ") + axis + ": " +
               (with.tables.empty() ? say("session.state.none")
                : with.from_backup  ? say("session.state.backup")
                                    : say("session.state.stated", {{"files", with.files}}));
    done("state", std::move(state));
    tell_findings(*open_, merged_set_.findings);
    if (merged_set_.files.empty()) return refused("table", Error{say("session.set.none")});
    out_ = w_.out.empty() ? fs::path(w_.folder) / "load" : fs::path(w_.out);
    day_of_loading();
    if (loaded_.empty()) {
      for (const std::string& axis : set_) tell_findings(*open_, older_measurement(*open_, axis));
      if (auto stored = storage::publish(fs::absolute(out_), merged_set_.files); !stored)
        return refused("table", stored.error());
    }
    std::string lines;
    for (const tables::LineForecast& line : merged_set_.lines)
      lines +=
          (lines.empty() ? "" : "; ") +
          say("session.set.line", {{"line", line.measurement},
                                   {"before", with_unit(line.before, Quantity::deviation, *words_)},
                                   {"after", with_unit(line.after, Quantity::deviation, *words_)}});
    done("table", say("session.set", {{"files", names_of(merged_set_.files)},
                                      {"folder", out_.string()},
                                      {"lines", lines}}));
    return true;
  }

  /// The sign probe and the verdict need the compensation that was active during the measurement.
  bool state_active() {
    Settings settled = options();
    std::vector<Finding> repeated;
    const auto stated =
        tables::state_by_backup(open_->read, *present_.control, present_.files, settled, repeated);
    return stated || refused("state", stated.error());
  }

  bool table() {
    auto merged = merge_axis_now(*open_, present_, options(), axis_);
    if (!merged) return refused("state", merged.error());
    merged_ = std::move(*merged);
    done("state",
         merged_.with.tables.empty()
             ? say("session.state.none")
             : say(merged_.with.from_backup ? "session.state.backup" : "session.state.stated",
                   {{"files", merged_.with.files}}));
    tell_findings(*open_, merged_.findings);
    if (merged_.files.empty()) return refused("table", Error{say("session.table.refused")});
    if (!state_active()) return false;
    out_ = w_.out.empty() ? fs::path(w_.folder) / "load" : fs::path(w_.out);
    day_of_loading();
    if (loaded_.empty()) {
      tell_findings(*open_, older_measurement(*open_, axis_));
      if (auto stored = storage::publish(fs::absolute(out_), merged_.files); !stored)
        return refused("table", stored.error());
    }
    const tables::TableForecast& f = merged_.forecast.front();
    const Quantity q = deviation_of(f.rotary);
    if (std::isnan(f.E[0]))
      done("table", say("session.table.unpredicted",
                        {{"files", names_of(merged_.files)}, {"folder", out_.string()}}));
    else
      done("table", say("session.table", {{"files", names_of(merged_.files)},
                                          {"folder", out_.string()},
                                          {"before", with_unit(f.E[0], q, *words_)},
                                          {"after", with_unit(f.E[1], q, *words_)},
                                          {"most", with_unit(f.E[1] + f.scatter, q, *words_)}}));
    return true;
  }

  /// The date of loading is that of --loaded, otherwise the first date, not before the measurement,
  /// on which the machine record contains the new table. Without such a date, `loaded_` is empty.
  void day_of_loading() {
    loaded_ = w_.loaded;
    if (!loaded_.empty() || !open_->read.machine) return;
    const auto of = open_->read.machine->axes.find(first_axis());
    if (of == open_->read.machine->axes.end()) return;
    for (const config::ControlState& s : of->second.states) {
      const auto files = open_->read.state_files.find(s.files);
      if (s.since < campaign().date || files == open_->read.state_files.end()) continue;
      const auto in = tables::tables_in(*present_.control, files->second, campaign(), options());
      if (in && loaded_.empty() &&
          (set_.empty() ? tables::same_correction(*in, merged_.next, axis_)
                        : tables::are_loaded(*in, merged_set_, set_)))
        loaded_ = s.since;
    }
  }

  std::optional<std::size_t> measured(const std::string& axis) const {
    for (std::size_t i = 0; i < campaign().measurements.size(); ++i) {
      const Measurement& m = campaign().measurements[i];
      if (m.kind == "axis" && control_axis(campaign().machine, m) == axis &&
          open_->read.observations[i].size() > 0)
        return i;
    }
    return std::nullopt;
  }

  /// Recommends a sign probe, two moves at which an instrument shows a wrong sign of the table, and
  /// writes its part program before the table is loaded. Without a suitable probe the session
  /// continues. Returns false if the session ends at this step.
  bool probe() {
    const auto text = probe_text(axis_);
    if (!text) return refused("probe", text.error());
    done("probe", *text);
    return true;
  }

  /// A sign probe for the pitch table of each axis.
  bool probes_of_set() {
    if (!state_active()) return false;
    std::string all;
    for (const std::string& axis : set_) {
      if (!measured(axis)) continue;
      const auto text = probe_text(axis);
      all += axis + ": " + (text ? *text : text_of(text.error())) + "; ";
    }
    done("probe", all + say("session.set.probe"));
    return true;
  }

  Expected<std::string> probe_text(const std::string& axis) {
    NONIO_TRY(const auto raw, raw_readings(*open_, axis));
    const auto p = probe_of(*open_, *measured(axis), raw);
    if (!p || !p->shows())
      return say("session.probe.none",
                 {{"why", p ? say("session.probe.small") : text_of(p.error())}});
    ProbeWish wish;
    const auto program = program_of(*p, campaign().machine, wish, {}, open_->place->plugins);
    std::string where = program ? (out_ / program->name).string() : text_of(program.error());
    if (program && loaded_.empty())
      if (auto stored = storage::publish(fs::absolute(out_), {*program}); !stored)
        return fail(stored.error());
    const Quantity q = deviation_of(p->rotary), at = position_of(p->rotary);
    return say("session.probe", {{"file", std::move(where)},
                                 {"from", with_unit(p->from, at, *words_)},
                                 {"to", with_unit(p->to, at, *words_)},
                                 {"right", with_unit(0.0, q, *words_)},
                                 {"wrong", with_unit(2.0 * p->difference, q, *words_)},
                                 {"none", with_unit(p->difference, q, *words_)},
                                 {"old", with_unit(p->as_measured, q, *words_)}});
  }

  bool loading() {
    if (loaded_.empty())
      return missing("loading", say("session.loading.missing"),
                     say(set_.empty() ? "session.todo.load" : "session.set.load"),
                     " --loaded " + std::string("YYYY-MM-DD"));
    std::string record = open_->read.machine ? open_->read.machine->file : std::string();
    if (!w_.loaded.empty()) {
      const auto recorded =
          set_.empty() ? record_loading(merged_, present_, options(), axis_, w_.loaded, *open_)
                       : record_set(merged_set_, present_, options(), set_, w_.loaded, *open_);
      if (!recorded) return refused("loading", recorded.error());
      record = *recorded;
    }
    done("loading", say("session.loading", {{"date", loaded_}, {"file", record}}));
    return true;
  }

  /// The check campaign is made from the file of --check, otherwise it is the last campaign since
  /// the loading with purpose "check", otherwise the first campaign since the loading. Returns
  /// false if the session ends at this step.
  bool check() {
    if (!w_.check.empty()) {
      auto folder = check_campaign();
      if (!folder) return refused("check", folder.error());
      check_ = {*folder, {}, w_.checked.empty() ? today() : w_.checked, "check"};
    } else {
      for (const LaterCampaign& c : later_campaigns(*open_, first_axis()))
        if (c.date >= loaded_ && (check_.folder.empty() || c.purpose == "check")) check_ = c;
    }
    if (check_.folder.empty())
      return missing("check", say("session.check.missing", {{"date", loaded_}}),
                     say(set_.empty() ? "session.todo.check" : "session.set.check"),
                     " --check " + files_to_check());
    done("check",
         say("session.check", {{"folder", check_.folder.string()}, {"date", check_.date}}));
    return true;
  }

  /// "FILE", or "D1=FILE,D2=FILE" for several axes.
  std::string files_to_check() const {
    if (set_.empty()) return "FILE";
    std::string out;
    for (const tables::LineForecast& line : merged_set_.lines)
      out += (out.empty() ? "" : ",") + shell_word(line.measurement) + "=FILE";
    return out;
  }

  Expected<fs::path> check_campaign() const {
    CheckCampaign check{w_.checked.empty() ? today() : w_.checked, {}, {}, {}};
    for (std::size_t at = 0; at < w_.check.size();) {
      const std::size_t end = set_.empty() ? w_.check.size() : w_.check.find(',', at);
      std::string file = w_.check.substr(at, end - at);
      at += file.size() + 1;
      const std::size_t equal = file.find('=');
      std::string id =
          set_.empty() ? campaign().measurements[*measured(axis_)].id : file.substr(0, equal);
      if (!set_.empty()) {
        if (equal == std::string::npos)
          return fail("--check: expected " + files_to_check() + ", found \"" + file + "\"");
        file = file.substr(equal + 1);
      }
      NONIO_TRY(auto bytes, storage::read_file(file));
      check.readings[id] = {fs::path(file).filename().string(), std::move(bytes)};
    }
    check.loaded = set_.empty() ? merged_.whole : merged_set_.whole;
    if (set_.empty()) check.axes[axis_] = backlash_of(merged_.with, merged_.next);
    for (const auto& [axis, with] : merged_set_.with)
      check.axes[axis] = backlash_of(with, tables::own_tables(merged_set_.next, axis));
    return write_check_campaign(*open_, check);
  }

  static std::optional<double> backlash_of(const tables::MeasuredWith& with,
                                           const std::vector<LoadedTable>& next) {
    std::optional<double> out = with.backlash;
    for (const LoadedTable& t : next)
      if (t.backlash) out = t.backlash;
    return out;
  }

  bool verdict() {
    auto after = open_campaign(check_.folder.string(), common_);
    if (!after)
      return refused("verdict",
                     Error{say("session.verdict.unread", {{"folder", check_.folder.string()}})});
    const auto judged =
        assessment::judge_loading(open_->read, after->read, axis_, merged_.next,
                                  {present_.control, options()}, open_->place->plugins);
    if (!judged) return refused("verdict", judged.error());
    answer_ = judged->answer;
    const tables::TableForecast& f = merged_.forecast.front();
    const Quantity q = deviation_of(f.rotary);
    const auto shown = [&](double v) {  // without all targets, there is no value
      return std::isfinite(v) ? with_unit(v, q, *words_) : std::string("-");
    };
    steps_.push_back({"verdict",
                      answer_ == Answer::worked   ? "done"
                      : answer_ == Answer::failed ? "failed"
                                                  : "open",
                      say("session.verdict", {{"before", shown(f.E[0])},
                                              {"predicted", shown(f.E[1])},
                                              {"after", shown(judged->E)}})});
    if (judged->change && judged->change->loading != statistics::Loading::loaded)
      verdict_.push_back(named_change(*judged->change, q));
    verdict_.insert(verdict_.end(), judged->findings.begin(), judged->findings.end());
    todo_ = say(answer_ == Answer::worked   ? "session.todo.nothing"
                : answer_ == Answer::failed ? "session.todo.failed"
                                            : "session.todo.open");
    if (answer_ != Answer::worked) command_ = command();
    return true;
  }

  /// Adds the verdict of several axes: each diagonal as predicted, within its U.
  bool verdict_of_set() {
    const auto after = open_campaign(check_.folder.string(), common_);
    if (!after)
      return refused("verdict",
                     Error{say("session.verdict.unread", {{"folder", check_.folder.string()}})});
    const auto lines = tables::judge_lines(merged_set_, open_->read, after->read, set_);
    if (lines.empty()) return refused("verdict", Error{say("session.set.check")});
    std::string text;
    bool worked = lines.size() == merged_set_.lines.size(), failed = false;
    for (const tables::LineVerdict& line : lines) {
      worked = worked && line.worked();
      failed = failed || line.failed();
      text += (text.empty() ? "" : "; ") + line.measurement + ": " +
              say("session.set.verdict",
                  {{"before", with_unit(line.before, Quantity::deviation, *words_)},
                   {"predicted", with_unit(line.predicted, Quantity::deviation, *words_)},
                   {"after", with_unit(line.after, Quantity::deviation, *words_)}});
    }
    answer_ = worked ? Answer::worked : failed ? Answer::failed : Answer::not_decided;
    steps_.push_back({"verdict", worked ? "done" : failed ? "failed" : "open", std::move(text)});
    todo_ = say(worked   ? "session.todo.nothing"
                : failed ? "session.todo.failed"
                         : "session.todo.open");
    if (!worked) command_ = command();
    return true;
  }

  Finding named_change(const statistics::TableChange& change, Quantity q) const {
    const double per = unit_of(q).per_si;
    return {std::string("worklist.table-") + assessment::loading_name(change.loading),
            true,
            {{"rms", change.rms / per, q}, {"left", change.left / per, q}},
            {{"axis", axis_},
             {"table", campaign().date},
             {"after", campaign().date},
             {"before", check_.date},
             {"points", std::to_string(change.points)}},
            {},
            {}};
  }

  void print() const {
    const Templates& templates = open_->place->context.templates;
    const std::string language = words_->language();
    if (common_.json) {
      TableJson json = {{"schema", "nonio-session/1"},
                        {"campaign", campaign().id},
                        {"axis", axis_},
                        {"steps", TableJson::array()}};
      if (present_.control != nullptr) json["control"] = present_.control->info.name;
      for (const Step& s : steps_)
        json["steps"].push_back({{"step", s.name}, {"state", s.state}, {"says", s.text}});
      if (!verdict_.empty()) {
        json["verdict"] = {{"answer", answer_ == Answer::worked   ? "worked"
                                      : answer_ == Answer::failed ? "failed"
                                                                  : "not decided"},
                           {"findings", TableJson::array()}};
        for (const Finding& f : verdict_)
          json["verdict"]["findings"].push_back(
              {{"id", f.id}, {"says", finding_text(templates, language, f, "says")}});
      }
      json["todo"] = todo_;
      if (!command_.empty()) json["command"] = command_;
      print_json(json);
      return;
    }
    const std::size_t width = line_width(STDOUT_FILENO);
    std::cout << wrapped(
        say("session.head",
            {{"axis", axis_}, {"campaign", campaign().id}, {"date", campaign().date}}),
        0, width);
    for (const Step& s : steps_) {
      const std::string label = "  " + padded(say("session.state-of." + s.state), 9) +
                                padded(say("session.step." + s.name), 16);
      std::cout << label << wrapped(s.text, label.size(), width).substr(label.size());
    }
    for (const Finding& f : verdict_)
      for (const char* what : {"says", "advice"}) {
        if (*what == 'a' && !f.attention) continue;
        const std::string text = finding_text(templates, language, f, what);
        if (!text.empty()) std::cout << wrapped(text, 2, width);
      }
    std::cout << wrapped(todo_, 0, width);
    if (!command_.empty()) std::cout << "  " << command_ << "\n";
  }

  const SessionWish& w_;
  const Texts& settings_;
  const Common& common_;
  std::unique_ptr<OpenCampaign> open_;
  std::unique_ptr<config::TerminalWords> words_;
  std::string axis_, loaded_, todo_, command_;
  fs::path out_;
  Loaded present_;
  tables::MergedTables merged_;
  std::vector<std::string> set_;  ///< axes of --axis XY; empty: one axis
  tables::MergedSet merged_set_;
  LaterCampaign check_;
  std::vector<Step> steps_;
  std::vector<Finding> verdict_;
  bool is_refused_ = false;
  Answer answer_ = Answer::not_decided;
};

int session(const SessionWish& w, const Common& common) {
  const auto settings = settings_of(w.settings);
  if (!settings) return complain(settings.error().message);
  if (!w.checked.empty() && w.check.empty())
    return complain("--checked is the day of --check, which is missing");
  return Session(w, *settings, common).run();
}

}  // namespace

Verb session_verb(Common& common) {
  auto w = std::make_shared<SessionWish>();
  using Takes = Argument::Takes;
  return {
      .name = "session",
      .summary = "From backup and readings to a verified table, step by step",
      .arguments = joined(
          campaign_arguments(w->folder, common),
          {takes(Takes::file,
                 {"--backup", &w->backup,
                  "Files saved from the control: FILE, or FILE,FILE,... (default: what the record "
                  "of the machine has of the day of the measurement)"}),
           {"--axis", &w->axis,
            "The axis (default: the measured axis, if there is only one); XY: the tables of both, "
            "and of one by the other"},
           day({"--loaded", &w->loaded,
                "YYYY-MM-DD: the new table was loaded on this day; records it in "
                "machines/<asset>.toml"}),
           takes(Takes::file, {"--check", &w->check,
                               "Readings of the axis with the new table: makes the check campaign, "
                               "<CAMPAIGN>-check; of several axes ID=FILE,ID=FILE, one per "
                               "diagonal"}),
           day({"--checked", &w->checked, "YYYY-MM-DD: the day of --check (default: today)"}),
           takes(Takes::folder,
                 {"--out", &w->out, "Folder for the files to load (default: CAMPAIGN/load)"}),
           takes(Argument::Takes::control,
                 {"--control", &w->control, "The control of the files (`nonio table controls`)"}),
           settings_argument(w->settings,
                             "NAME=VALUE: an option of that control; may be given several times")}),
      .footer =
          "Each call prints the steps that are done, the one that is missing, and the next "
          "command. "
          "The steps: backup, state during the measurement, new table, sign probe, loading, check "
          "campaign, verdict on pitch and reversal. The session stores no state: each call "
          "determines the next step from the files, the record of the machine and the campaigns of "
          "the site. It does what `table insert`, `table probe` and the analysis before-after "
          "do.\n\nExit "
          "status: 0 the next step is known, or the table worked; 1 a step was refused, or the "
          "table did not work; 2 usage or configuration.",
      .examples = {"nonio table session site/2026-11-rossi --backup backup/CNCPARAM.TXT --axis Z",
                   "nonio table session site/2026-11-rossi --axis Z --loaded 2026-11-04",
                   "nonio table session site/2026-11-rossi --axis Z --check z-after.csv"},
      .run = [w, &common] { return session(*w, common); }};
}

}  // namespace nonio::app
