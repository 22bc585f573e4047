// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <functional>
#include <iostream>
#include <map>
#include <memory>
#include <nlohmann/json.hpp>

#include "axis_argument.h"
#include "campaign_verb.h"
#include "nonio/host/files.h"
#include "nonio/host/plan.h"
#include "nonio/host/table_check.h"
#include "nonio/sdk/format.h"
#include "tables.h"
#include "verbs.h"

namespace nonio::app {

namespace {

using Json = nlohmann::ordered_json;
using Texts = std::map<std::string, std::string>;

struct TableWish {
  std::string table, other, folder, control, out;
  std::vector<std::string> settings, axes;
  bool was_on = false;
};

/// Numbers with the unit in their name: "largest_um".
void put(Json& json, const std::string& name, double si, Quantity q) {
  if (std::isfinite(si)) json[name + std::string(unit_of(q).suffix)] = printed(si, q);
}

Json shape_json(const host::TableShape& s, bool rotary) {
  Json json = Json::object();
  put(json, "largest", s.largest, deviation_of(rotary));
  put(json, "largest_step", s.step, deviation_of(rotary));
  put(json, "largest_step_from", s.step_at, position_of(rotary));
  put(json, "largest_slope", s.slope, slope_of(rotary));
  if (s.backlash) put(json, "backlash", *s.backlash, deviation_of(rotary));
  return json;
}

Json difference_json(const host::TableDifference& d) {
  Json json = {{"output", d.output}, {"by", d.input}};
  put(json, "largest", d.largest, deviation_of(d.rotary));
  put(json, "at", d.at, position_of(d.rotary));
  put(json, "range", d.range, deviation_of(d.rotary));
  if (d.present) json["present"] = shape_json(*d.present, d.rotary);
  if (d.next) json["new"] = shape_json(*d.next, d.rotary);
  return json;
}

void print_shape(const char* name, const std::optional<host::TableShape>& s, bool rotary) {
  std::cout << "  " << name << ": ";
  if (!s) {
    std::cout << "no table\n";
    return;
  }
  std::cout << "adds up to " << with_unit(s->largest, deviation_of(rotary)) << ", largest step "
            << with_unit(s->step, deviation_of(rotary)) << " from "
            << with_unit(s->step_at, position_of(rotary)) << " on, largest slope "
            << with_unit(s->slope, slope_of(rotary));
  if (s->backlash) std::cout << ", backlash " << with_unit(*s->backlash, deviation_of(rotary));
  std::cout << "\n";
}

void print_difference(const host::TableDifference& d) {
  std::cout << "axis " << d.output;
  if (d.input.size() != 1 || d.input.front() != d.output) {
    std::cout << " by the position of";
    for (const std::string& in : d.input) std::cout << " " << in;
  }
  std::cout << ": they differ by up to " << with_unit(d.largest, deviation_of(d.rotary)) << " (at "
            << with_unit(d.at, position_of(d.rotary)) << "), range "
            << with_unit(d.range, deviation_of(d.rotary)) << "\n";
  print_shape("present", d.present, d.rotary);
  print_shape("new    ", d.next, d.rotary);
}

Json forecast_json(const host::TableForecast& f) {
  Json json = {{"measurement", f.measurement}, {"axis", f.axis}};
  const Quantity q = deviation_of(f.rotary);
  for (const auto& [when, k] : {std::pair{"before", 0}, {"after", 1}}) {
    json[when] = Json::object();
    put(json[when], "E", f.E[k], q);
    put(json[when], "B", f.B[k], q);
    put(json[when], "M", f.M[k], q);
  }
  return json;
}

void print_forecast(const host::TableForecast& f) {
  const Quantity q = deviation_of(f.rotary);
  std::cout << "axis " << f.axis << ", measurement " << f.measurement << ":";
  for (const auto& [name, v] : {std::pair{"E", f.E}, {"B", f.B}, {"M", f.M}})
    if (std::isfinite(v[0]) && std::isfinite(v[1]))
      std::cout << "  " << name << " " << with_unit(v[0], q) << " -> " << with_unit(v[1], q);
  std::cout << (f.worse() ? "  WORSE\n" : "\n");
}

/// Files, the control that they are of, and what it makes of them.
struct Loaded {
  const Output* control = nullptr;
  std::vector<LoadedTable> tables;
};

Expected<Loaded> load(const host::Plugins& plugins, const std::string& files,
                      const std::string& control, const Campaign& campaign, const Texts& settings,
                      const std::function<host::Checked<Settings>(const Info&)>& options_of) {
  auto read = host::read_table_files(files);
  if (!read) return tl::unexpected<Error>(read.error());
  const auto found = host::control_of(plugins, control, *read, campaign, settings);
  if (!found) return tl::unexpected<Error>(found.error());
  const auto options = options_of((*found)->info);
  if (!options) return tl::unexpected<Error>(options.error().front());
  auto tables = host::tables_in(**found, *read, campaign, *options);
  if (!tables) return fail(files + ": " + tables.error().message);
  return Loaded{*found, std::move(*tables)};
}

/// The axes of the machine in the order of their numbers.
Campaign machine_of(const std::vector<std::string>& axes) {
  Campaign campaign;
  for (const std::string& name : axes) campaign.machine.axes.push_back(axis_named(name));
  return campaign;
}

int diff(const TableWish& w, const Common& common) {
  const char* const verb = "nonio diff";
  const auto settings = settings_of(w.settings);
  if (!settings) return complain(verb, settings.error().message);
  host::Plugins plugins;
  plugins.load(common.plugin_folders());
  for (const std::string& conflict : plugins.conflicts()) return complain(verb, conflict);
  const Campaign campaign = machine_of(w.axes);
  const auto options = [&](const Info& info) { return host::options_from(info, *settings); };
  const auto was = load(plugins, w.table, w.control, campaign, *settings, options);
  if (!was) return complain(verb, text_of(was.error()));
  const auto will = load(plugins, w.other, was->control->info.name, campaign, *settings, options);
  if (!will) return complain(verb, text_of(will.error()));
  const auto all = host::differences(was->tables, will->tables);
  if (common.json) {
    Json json = {{"schema", "nonio-diff/1"},
                 {"control", was->control->info.name},
                 {"tables", Json::array()}};
    for (const auto& d : all) json["tables"].push_back(difference_json(d));
    std::cout << json.dump(1) << "\n";
  } else {
    for (const auto& d : all) print_difference(d);
  }
  return exit_done;
}

struct Applied {
  std::vector<host::TableDifference> differences;
  std::vector<host::TableForecast> forecast;
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
    std::cout << json.dump(1) << "\n";
  } else {
    for (const auto& d : a.differences) print_difference(d);
    for (const auto& f : a.forecast) print_forecast(f);
    for (const std::string& file : a.files) std::cout << file << "\n";
  }
  for (const Finding& f : a.findings)
    if (f.attention)
      std::cerr << "nonio apply: " << finding_text(open.place->context.templates, "en", f, "title")
                << ": " << finding_text(open.place->context.templates, "en", f, "says") << "\n";
  if (a.forecast.empty())
    return complain("nonio apply", "no measurement of an axis that these tables correct",
                    exit_failed);
  const auto worse = [](const host::TableForecast& f) { return f.worse(); };
  return std::any_of(a.forecast.begin(), a.forecast.end(), worse) ? exit_failed : exit_done;
}

int apply(const TableWish& w, const Common& common) {
  const char* const verb = "nonio apply";
  const auto settings = settings_of(w.settings);
  if (!settings) return complain(verb, settings.error().message);
  if (!w.out.empty() && !w.was_on)
    return complain(verb, "--out writes the renewed table: it needs --was-on");
  const auto opened = open_campaign(verb, w.folder, common);
  if (!opened) return opened.error();
  const OpenCampaign& open = *opened;
  const host::Manifest& manifest = *open.read.manifest;
  const auto options = [&](const Info& info) {
    auto settled = host::settle_options(info, open.place->context.site.options, manifest.options);
    if (!settled) return settled;
    const auto told = host::options_from(info, *settings);
    if (!told) return told;
    for (const auto& [name, text] : *settings) settled->values[name] = told->values.at(name);
    return settled;
  };
  const std::string control = w.control.empty() ? open.campaign().machine.control : w.control;
  const auto table =
      load(open.place->plugins, w.table, control, open.campaign(), *settings, options);
  if (!table) return complain(verb, text_of(table.error()));
  const Settings settled = *options(table->control->info);
  Applied a;
  if (!w.was_on) {
    a.forecast = host::forecast(open.read, table->tables, settled);
    return tell(a, table->control->info.name, open, common);
  }
  auto renewed = host::renew(open.read, *table->control, settled, open.place->context.templates,
                             table->tables);
  if (!renewed) return complain(verb, text_of(renewed.error()), exit_failed);
  a = {host::differences(table->tables, renewed->tables),
       std::move(renewed->forecast),
       std::move(renewed->findings),
       {}};
  if (!w.out.empty()) {
    if (auto done = host::publish(std::filesystem::absolute(w.out), renewed->files); !done)
      return complain(verb, text_of(done.error()), exit_failed);
    for (const Artifact& f : renewed->files)
      a.files.push_back((std::filesystem::path(w.out) / f.name).string());
  }
  return tell(a, table->control->info.name, open, common);
}

std::vector<Argument> table_arguments(TableWish& w) {
  return {{"--control", &w.control,
           "The control that the files are of (`nonio controllers`); else as the files are\n"
           "called, or the only one that can read them"},
          settings_argument(w.settings,
                            "NAME=VALUE: an option of that control, such as type=1 or\n"
                            "\"axes=X number=1,Y number=2\"; may be given several times")};
}

}  // namespace

Verb diff_verb(Common& common) {
  auto w = std::make_shared<TableWish>();
  using Takes = Argument::Takes;
  return {
      .name = "diff",
      .summary = "Two tables of one control against each other",
      .arguments = joined(
          {required(takes(
               Takes::file,
               {"PRESENT", &w->table, "The table that is in the control: FILE, or FILE,FILE,..."})),
           required(takes(Takes::file, {"NEW", &w->other, "The table that is to come into it"}))},
          table_arguments(*w),
          {{"--axis", &w->axes,
            "Name of an axis, in the order of their numbers; A, B, C are in deg;\n"
            "may be given several times"}},
          common_arguments(common)),
      .footer =
          "Both are read as the control reads them: what they add to the position, whatever sign "
          "or\n"
          "increments their files have. For each axis: where they differ most, and of each table "
          "the\n"
          "largest entry, the largest step from one point to the next and the largest slope. A "
          "step\n"
          "or slope that is much larger than in the present table deserves a look before "
          "loading.\n\n"
          "Exit status: 0 compared; 2 a file cannot be read.\n\n"
          "Example: nonio diff backup/linuxcnc-X.comp out/c/linuxcnc-X.comp --axis X",
      .run = [w, &common] { return diff(*w, common); }};
}

Verb apply_verb(Common& common) {
  auto w = std::make_shared<TableWish>();
  using Takes = Argument::Takes;
  return {
      .name = "apply",
      .summary = "What a table does to the error that a campaign has measured",
      .arguments = joined(
          {required(takes(Takes::file, {"TABLE", &w->table,
                                        "The table: FILE, or FILE,FILE,... with its backlash"}))},
          campaign_arguments(w->folder, common), table_arguments(*w),
          {{"--was-on", &w->was_on,
            "TABLE was in force while the campaign was measured: it is taken off the "
            "readings,\n"
            "and the new table is the whole of what is needed"},
           takes(Takes::folder,
                 {"--out", &w->out, "With --was-on: the folder for the files of the new table"})}),
      .footer =
          "Without --was-on: E, B and M as measured, and after this table is loaded into a "
          "control\n"
          "that had none (the backlash parameter of the axis: option axes, backlash_mm).\n"
          "With --was-on: the difference from this table to the new one, and E, B and M after the "
          "new\n"
          "one is loaded in its place. Tables of one axis by another are not taken off.\n\n"
          "Exit status: 0 no axis becomes worse; 1 one does, or nothing could be predicted; 2 "
          "usage\n"
          "or configuration.\n\n"
          "Example: nonio apply backup/siemens-840d-X-EEC.ini,backup/siemens-840d-X-backlash.ini "
          "\\\n"
          "           site/2026-11-rossi --was-on --out new",
      .run = [w, &common] { return apply(*w, common); }};
}

}  // namespace nonio::app
