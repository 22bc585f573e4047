// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <charconv>
#include <cmath>
#include <iostream>
#include <memory>

#include "axis_argument.h"
#include "campaign/planning/plan.h"
#include "campaign/tables/control_state.h"
#include "campaign/tables/table_check.h"
#include "campaign_verb.h"
#include "nonio/sdk/format.h"
#include "platform/storage/files.h"
#include "platform/storage/json_values.h"
#include "site_words.h"
#include "table_common.h"
#include "tables.h"
#include "verbs.h"

namespace nonio::app {

namespace {

using Json = TableJson;

struct TableWish {
  std::string table, other, folder, control, out;
  std::vector<std::string> settings, axes, backlash_was;
  bool active = false;
};

Campaign machine_of(const std::vector<std::string>& axes) {
  Campaign campaign;
  for (const std::string& name : axes) campaign.machine.axes.push_back(axis_named(name));
  return campaign;
}

/// Numbers the axes in the order of --axis, unless the options state a number. Does nothing if the
/// control has no option `axes`.
void number_axes(const std::vector<std::string>& names, Settings& options) {
  if (!options.has("axes")) return;
  NumberTables axes = options.tables("axes");
  for (std::size_t i = 0; i < names.size(); ++i)
    axes[names[i]].emplace("number", static_cast<double>(i + 1));
  options.values["axes"] = std::move(axes);
}

int tell_differences(const std::string& control, const std::vector<tables::TableDifference>& all,
                     const config::TerminalWords& say, const Common& common, bool compared = true) {
  if (common.json) {
    Json json = {{"schema", "nonio-diff/1"}, {"control", control}, {"tables", Json::array()}};
    for (const auto& d : all) json["tables"].push_back(difference_json(d));
    print_json(json);
  } else {
    for (const auto& d : all) print_difference(d, say, compared);
  }
  return exit_done;
}

int diff_with_campaign(const std::string& backup, const std::string& folder, const TableWish& w,
                       const Texts& settings, const Common& common) {
  auto opened = open_campaign(folder, common);
  if (!opened) return opened.error();
  OpenCampaign& open = *opened;
  const auto options = [&](const Info& info) { return campaign_options(open, info, settings); };
  const std::string control = w.control.empty() ? open.campaign().machine.control : w.control;
  const auto present =
      load(open.place->plugins, backup, control, open.campaign(), settings, options);
  if (!present) return complain(text_of(present.error()));
  Settings settled = *options(present->control->info);
  std::vector<Finding> findings;
  if (auto stated =
          tables::state_by_backup(open.read, *present->control, present->files, settled, findings);
      !stated)
    return complain(text_of(stated.error()), exit_failed);
  tell_findings(open, findings);
  auto next = tables::tables_of_campaign(open.read, *present->control, settled);
  if (!next) return complain(text_of(next.error()), exit_failed);
  tell_findings(open, next->findings);
  if (next->tables.empty()) return complain("the campaign has no table", exit_failed);
  auto all = tables::differences(present->tables, next->tables);
  std::erase_if(all, [](const tables::TableDifference& d) { return !d.next; });
  return tell_differences(present->control->info.name, all, open.words(), common);
}

/// A file without the name of an axis names its table after the file. If each side has one such
/// table, both get the same name.
void join_unnamed(const Loaded& was, Loaded& will) {
  const auto only_unnamed = [](const Loaded& l) {
    return l.tables.size() == 1 &&
           std::any_of(l.files.begin(), l.files.end(),
                       [&](const Artifact& f) { return f.name == l.tables.front().output; });
  };
  if (!only_unnamed(was) || !only_unnamed(will)) return;
  will.tables.front().output = was.tables.front().output;
  will.tables.front().input = was.tables.front().input;
}

/// Pairs "X=Y" of --axis: axis X of the present table is compared with axis Y of the new table.
struct AxisPairs {
  std::vector<std::string> axes;
  std::vector<std::pair<std::string, std::string>> pairs;

  explicit AxisPairs(const std::vector<std::string>& texts) {
    for (const std::string& text : texts) {
      const std::size_t equals = text.find('=');
      axes.push_back(text.substr(0, equals));
      if (equals == std::string::npos) continue;
      axes.push_back(text.substr(equals + 1));
      pairs.emplace_back(axes[axes.size() - 2], axes.back());
    }
  }

  /// Keeps only tables of the pairs whose input is the axis itself and names them by the pair.
  /// Without pairs, all tables are kept. An error if a table of a pair is missing.
  Expected<void> join(std::vector<LoadedTable>& was, std::vector<LoadedTable>& will) const {
    if (pairs.empty()) return {};
    std::vector<LoadedTable> of[2];
    for (const auto& [present, next] : pairs)
      for (const auto& [axis, from, to] :
           {std::tuple{present, &was, &of[0]}, std::tuple{next, &will, &of[1]}}) {
        const auto it = std::find_if(from->begin(), from->end(), [&, &name = axis](const auto& t) {
          return t.output == name && t.input == std::vector{name};
        });
        if (it == from->end())
          return fail("--axis " + present + "=" + next + ": the " +
                      (from == &was ? "present" : "new") + " table has none of axis " + axis);
        to->push_back(*it);
        to->back().output = present + "=" + next;
        to->back().input = {to->back().output};
      }
    was = std::move(of[0]);
    will = std::move(of[1]);
    return {};
  }
};

int diff(const TableWish& w, const Common& common) {
  const auto settings = settings_of(w.settings);
  if (!settings) return complain(settings.error().message);
  const AxisPairs axes(w.axes);
  const auto is_folder = [](const std::string& path) {
    std::error_code error;
    return std::filesystem::is_directory(path, error);
  };
  if (is_folder(w.other)) return diff_with_campaign(w.table, w.other, w, *settings, common);
  if (is_folder(w.table)) return diff_with_campaign(w.other, w.table, w, *settings, common);
  loader::Plugins plugins;
  plugins.load(common.plugin_folders());
  for (const std::string& conflict : plugins.conflicts()) return complain(conflict);
  const Campaign campaign = machine_of(axes.axes);
  const auto options = [&](const Info& info) {
    auto settled = config::options_from(info, *settings);
    if (settled) number_axes(axes.axes, *settled);
    return settled;
  };
  auto was = load(plugins, w.table, w.control, campaign, *settings, options);
  if (!was) return complain(text_of(was.error()));
  const SiteWords words(common, language_at(w.table.substr(0, w.table.find(','))));
  if (w.other.empty())
    return tell_differences(was->control->info.name, tables::differences(was->tables, {}),
                            words.get(), common, false);
  auto will = load(plugins, w.other, was->control->info.name, campaign, *settings, options);
  if (!will) return complain(text_of(will.error()));
  join_unnamed(*was, *will);
  if (auto ok = axes.join(was->tables, will->tables); !ok) return complain(ok.error().message);
  return tell_differences(was->control->info.name, tables::differences(was->tables, will->tables),
                          words.get(), common);
}

struct Applied {
  std::vector<tables::TableDifference> differences;
  std::vector<tables::TableForecast> forecast;
  std::vector<Finding> findings;
  std::vector<std::string> files;
};

int tell(const Applied& a, const std::string& control, const OpenCampaign& open,
         const Common& common) {
  if (common.json) {
    Json json = {{"schema", "nonio-apply/1"},
                 {"campaign", open.campaign().id},
                 {"control", control},
                 {"predictions", Json::array()}};
    for (const auto& f : a.forecast) json["predictions"].push_back(forecast_json(f));
    if (!a.differences.empty()) json["tables"] = Json::array();
    for (const auto& d : a.differences) json["tables"].push_back(difference_json(d));
    if (!a.files.empty()) json["files"] = a.files;
    print_json(json);
  } else {
    const config::TerminalWords say = open.words();
    for (const auto& d : a.differences) print_difference(d, say);
    for (const auto& f : a.forecast) print_forecast(f, say);
    for (const std::string& file : a.files) std::cout << file << "\n";
  }
  tell_findings(open, a.findings);
  if (a.forecast.empty())
    return complain("no measurement of an axis that these tables correct", exit_failed);
  const auto grows = [](const tables::TableForecast& f) { return f.grows; };
  return std::any_of(a.forecast.begin(), a.forecast.end(), grows) ? exit_failed : exit_done;
}

/// Value of --active-backlash, such as "0.012", "none" or "X=0.012", in mm or deg.
struct BacklashWas {
  std::string axis;  ///< empty for the only axis
  double value = 0.0;
};

Expected<std::vector<BacklashWas>> backlash_was(const std::vector<std::string>& texts) {
  std::vector<BacklashWas> all;
  for (const std::string& text : texts) {
    const std::size_t equals = text.find('=');
    BacklashWas one;
    if (equals != std::string::npos) one.axis = text.substr(0, equals);
    const std::string value = equals == std::string::npos ? text : text.substr(equals + 1);
    const auto end = std::from_chars(value.data(), value.data() + value.size(), one.value);
    const bool number = end.ec == std::errc() && end.ptr == value.data() + value.size();
    if (value != "none" && !(number && std::isfinite(one.value) && std::fabs(one.value) <= 10.0))
      return fail(
          "--active-backlash: expected a number of mm or deg, none, or AXIS= and one of these; "
          "found "
          "\"" +
          text + "\"");
    if (value == "none") one.value = 0.0;
    all.push_back(std::move(one));
  }
  return all;
}

/// Sets the active backlash value of tables whose files lack it. An error if no value is stated,
/// because 0 would be a guess.
Expected<void> settle_backlash(const TableWish& w, const Loaded& present, Settings& options) {
  const auto said = backlash_was(w.backlash_was);
  if (!said) return fail(said.error().message);
  std::vector<bool> used(said->size());
  for (const LoadedTable& t : present.tables) {
    if (t.input != std::vector{t.output}) continue;
    const double per = t.rotary ? deg_per_rad : 1e3;
    for (std::size_t i = 0; i < said->size(); ++i) {
      const BacklashWas& b = (*said)[i];
      if (b.axis.empty() ? present.tables.size() > 1 : b.axis != t.output) continue;
      used[i] = true;
      const auto known =
          t.backlash ? t.backlash : tables::stated_backlash(options, t.output, t.rotary);
      if (known && std::fabs(*known * per - b.value) > 5e-7)
        return fail("--active-backlash states " + short_text(b.value, 6) + " for axis " + t.output +
                    ", its files or the campaign state " + short_text(*known * per, 6));
      if (!known) tables::state_backlash(options, t.output, t.rotary, b.value / per);
    }
    const bool has_parameter = !present.control->table.backlash.empty();
    if (has_parameter && !t.backlash && !tables::stated_backlash(options, t.output, t.rotary))
      return fail(w.table + " does not state what was in " + present.control->table.backlash +
                  " of axis " + t.output +
                  " while it was measured: give its file too, or --active-backlash VALUE|none, or "
                  "active_backlash_" +
                  (t.rotary ? "deg" : "mm") + " in [machine.axes." + t.output +
                  "] of campaign.toml, or the record of the machine");
  }
  for (std::size_t i = 0; i < used.size(); ++i)
    if (!used[i])
      return fail("--active-backlash " + w.backlash_was[i] + ": " +
                  ((*said)[i].axis.empty() ? "these files hold several tables; expected AXIS=VALUE"
                                           : "these files hold no table of that axis"));
  return {};
}

/// Whether the campaign states these files as the active table of the axis.
bool states_them(const reading::ReadCampaign& read, const std::string& axis,
                 const std::vector<Artifact>& files) {
  const auto stated = read.active_tables.find(axis);
  return stated != read.active_tables.end() &&
         std::all_of(stated->second.begin(), stated->second.end(), [&](const Artifact& one) {
           return std::any_of(files.begin(), files.end(),
                              [&](const Artifact& f) { return f.bytes == one.bytes; });
         });
}

Expected<void> active_unless_stated(const TableWish& w, const Loaded& present,
                                    const OpenCampaign& open) {
  for (const LoadedTable& t : present.tables) {
    const Axis* axis = open.campaign().machine.axis(t.output);
    if (axis == nullptr || !axis->active_table || t.input != std::vector{t.output} ||
        states_them(open.read, t.output, present.files))
      continue;
    return fail("--active-table states that " + w.table +
                " was active, but the campaign states active_table = \"" +
                (axis->active_table->empty() ? "none" : *axis->active_table) + "\" of axis " +
                t.output + ": correct one of them");
  }
  return {};
}

int apply(const TableWish& w, const Common& common) {
  const auto settings = settings_of(w.settings);
  if (!settings) return complain(settings.error().message);
  if (!w.out.empty() && !w.active)
    return complain("--out writes the renewed table: it needs --active-table");
  if (!w.backlash_was.empty() && !w.active)
    return complain("--active-backlash describes an active table: it requires --active-table");
  const auto opened = open_campaign(w.folder, common);
  if (!opened) return opened.error();
  const OpenCampaign& open = *opened;
  const auto options = [&](const Info& info) { return campaign_options(open, info, *settings); };
  const std::string control = w.control.empty() ? open.campaign().machine.control : w.control;
  const auto table =
      load(open.place->plugins, w.table, control, open.campaign(), *settings, options);
  if (!table) return complain(text_of(table.error()));
  Settings settled = *options(table->control->info);
  Applied a;
  if (!w.active) {
    for (const Measurement& m : open.campaign().measurements)
      if (std::any_of(table->tables.begin(), table->tables.end(), [&](const LoadedTable& t) {
            return t.output == control_axis(open.campaign().machine, m);
          }))
        if (auto known = knows_active(open.campaign(), m); !known)
          return complain(known.error().message + "; or pass --active-table if " + w.table +
                          " was active");
    const auto on = tables::active_compensation(open.read, *table->control, settled);
    if (!on) return complain(text_of(on.error()));
    a.forecast = tables::forecast(open.read, table->tables, settled, *on);
    return tell(a, table->control->info.name, open, common);
  }
  if (auto agreed = active_unless_stated(w, *table, open); !agreed)
    return complain(agreed.error().message);
  if (auto stated = settle_backlash(w, *table, settled); !stated)
    return complain(stated.error().message);
  auto renewed = tables::renew(open.read, *table->control, settled, table->tables);
  if (!renewed) return complain(text_of(renewed.error()), exit_failed);
  a = {tables::differences(table->tables, renewed->tables),
       std::move(renewed->forecast),
       std::move(renewed->findings),
       {}};
  if (!w.out.empty()) {
    if (auto done = storage::publish(std::filesystem::absolute(w.out), renewed->files); !done)
      return complain(text_of(done.error()), exit_failed);
    for (const Artifact& f : renewed->files)
      a.files.push_back((std::filesystem::path(w.out) / f.name).string());
  }
  return tell(a, table->control->info.name, open, common);
}

std::vector<Argument> table_arguments(TableWish& w) {
  return {
      takes(Argument::Takes::control,
            {"--control", &w.control,
             "The control of the files (`nonio table controls`); else as the files are called, or "
             "the only one that can read them"}),
      settings_argument(w.settings,
                        "NAME=VALUE: an option of that control, such as type=1 or \"axes=X "
                        "number=1,Y number=2\"; may be given several times")};
}

}  // namespace

Verb diff_verb(Common& common) {
  auto w = std::make_shared<TableWish>();
  using Takes = Argument::Takes;
  return {
      .name = "diff",
      .summary = "Compares two tables of one control, or describes one",
      .arguments = joined(
          {required(takes(
               Takes::file,
               {"PRESENT", &w->table, "The present table of the control: FILE, or FILE,FILE,..."})),
           takes(Takes::file, {"NEW", &w->other,
                               "The new table; or a campaign, whose tables of the measured axes "
                               "are compared; without it PRESENT alone is described"})},
          table_arguments(*w),
          {{"--axis", &w->axes,
            "Name of an axis, in the order of the axis numbers; A, B and C are in deg; X=Y "
            "compares "
            "X of PRESENT with Y of NEW; may be given several times"}},
          common_arguments(common)),
      .footer =
          "Both tables are read as the control reads them, whatever sign or increments the files "
          "have. For each axis it prints the largest difference and where it is, and for each "
          "table the largest entry, the largest step between neighbouring points and the largest "
          "slope. If a step or slope is much larger than in the present table, find out why before "
          "you load it.\n\nExit status: 0 compared; 2 a file cannot be read.",
      .examples = {"nonio table diff backup/linuxcnc-X.comp out/c/linuxcnc-X.comp --axis X",
                   "nonio table diff printer.cfg"},
      .run = [w, &common] { return diff(*w, common); }};
}

Verb predict_verb(Common& common) {
  auto w = std::make_shared<TableWish>();
  using Takes = Argument::Takes;
  return {
      .name = "predict",
      .summary = "Predicts the error of a campaign after compensation with a table",
      .arguments = joined(
          {required(
              takes(Takes::file,
                    {"TABLE", &w->table,
                     "The table: FILE, or FILE,FILE,... with the file of its backlash value"}))},
          campaign_arguments(w->folder, common), table_arguments(*w),
          {{.name = "--active-table",
            .target = &w->active,
            .help = "TABLE was active during the measurement: it is removed from the readings, so "
                    "that the "
                    "new table is complete",
            .old = "--was-on"},
           {.name = "--active-backlash",
            .target = &w->backlash_was,
            .help = "With --active-table: active backlash value in mm or deg, if TABLE does not "
                    "contain it: "
                    "VALUE, none, or AXIS=VALUE; may be given several times",
            .old = "--backlash-was"},
           takes(Takes::folder, {"--out", &w->out,
                                 "With --active-table: folder for the files of the new table"})}),
      .footer =
          "Without --active-table it prints E, B and M as measured, and after this table is loaded "
          "into "
          "a control without a table (backlash parameter of the axis: option axes, backlash_mm). "
          "With --active-table it prints the difference between this table and the new one, and E, "
          "B and "
          "M after the new one replaces it. Cross tables are not removed from the "
          "readings.\n\nExit status: 0 no axis gets worse; 1 an axis gets worse, or no prediction "
          "was possible; 2 usage or configuration.",
      .examples =
          {"nonio table predict backup/siemens-840d-X-EEC.ini,backup/siemens-840d-X-backlash.ini "
           "site/2026-11-rossi --active-table --out new"},
      .run = [w, &common] { return apply(*w, common); }};
}

}  // namespace nonio::app
