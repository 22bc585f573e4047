// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <iostream>
#include <memory>

#include "campaign/config/manifest.h"
#include "campaign/planning/plan.h"
#include "campaign/tables/table_check.h"
#include "campaign_verb.h"
#include "nonio/sdk/format.h"
#include "platform/storage/files.h"
#include "platform/storage/json_values.h"
#include "probe.h"
#include "table_common.h"
#include "tables.h"
#include "verbs.h"

namespace nonio::app {

namespace {

using storage::Json;

/// Returns the control family, such as "heidenhain" of heidenhain-tnc, if an output plugin writes
/// its part programs, otherwise "gcode".
std::string writer_for(const std::string& control, const loader::Plugins& plugins) {
  const std::string family = control.substr(0, control.find('-'));
  for (const Output& o : plugins.outputs())
    if (!family.empty() && o.info.name == "program-" + family) return family;
  return "gcode";
}

bool runs_gcode(const std::string& control, const loader::Plugins& plugins) {
  for (const Controller& c : plugins.controllers())
    if (c.info.name == control) return c.table.runs_gcode;
  return true;
}

Settings said_of_axes(const OpenCampaign& open) {
  for (const Controller& o : open.place->plugins.controllers())
    if (o.info.name == open.campaign().machine.control)
      if (auto settled = config::settle_table_options(
              o.info, open.place->context.site.options, *open.read.manifest,
              open.read.machine ? &*open.read.machine : nullptr))
        return std::move(*settled);
  return {};
}

/// An error unless the probe is within the travels of the manifest and of the option `axes`.
Expected<void> within_travel(const tables::SignProbe& p, const Axis* axis, const Settings& said) {
  const double unit = p.rotary ? deg_per_rad : 1e3;
  const char* const suffix = p.rotary ? "_deg" : "_mm";
  double low = -HUGE_VAL, high = HUGE_VAL;
  if (axis != nullptr && axis->travel) {
    low = std::min(axis->travel->first, axis->travel->second);
    high = std::max(axis->travel->first, axis->travel->second);
  }
  for (const auto& [name, table] : said.tables("axes"))
    for (const auto& [key, value] : table) {
      if (name != p.axis) continue;
      if (key == std::string("from") + suffix) low = std::max(low, value / unit);
      if (key == std::string("to") + suffix) high = std::min(high, value / unit);
    }
  constexpr double slack = 1e-9;
  const Quantity q = position_of(p.rotary);
  for (const double x : {p.start, p.from, p.to})
    if (x < low - slack || x > high + slack)
      return fail("axis " + p.axis + ": the probe would go to " + with_unit(x, q) +
                  ", the travel is " + with_unit(low, q) + " to " + with_unit(high, q));
  return {};
}

}  // namespace

Expected<std::vector<Observations>> raw_readings(const OpenCampaign& open,
                                                 const std::string& axis) {
  const Campaign& campaign = open.campaign();
  for (const Measurement& m : campaign.measurements)
    if (!axis.empty() && control_axis(campaign.machine, m) != axis)
      continue;
    else if (auto known = knows_active(campaign, m); !known)
      return fail(known.error());
  if (open.read.active_tables.empty()) return open.read.observations;
  for (const Controller& c : open.place->plugins.controllers()) {
    if (c.info.name != campaign.machine.control) continue;
    const auto options = campaign_options(open, c.info, {});
    if (!options) return fail(options.error().front());
    NONIO_TRY(const auto on, tables::active_compensation(open.read, c, *options));
    return on ? on->readings : open.read.observations;
  }
  return fail(
      "the campaign states an active table and not of which control it is: state control "
      "in [machine] of campaign.toml");
}

Expected<tables::SignProbe> probe_of(const OpenCampaign& open, std::size_t measurement,
                                     const std::vector<Observations>& raw) {
  const Measurement& m = open.campaign().measurements[measurement];
  auto p = tables::sign_probe(m, raw[measurement], open.read.observations[measurement]);
  if (!p) return p;
  if (auto inside = within_travel(*p, open.campaign().machine.axis(m.axis), said_of_axes(open));
      !inside)
    return fail(inside.error());
  return p;
}

Expected<Artifact> program_of(const tables::SignProbe& p, const Machine& machine,
                              const ProbeWish& w, const std::map<std::string, std::string>& given,
                              const loader::Plugins& plugins) {
  const Quantity at = position_of(p.rotary);
  PointTable stops;
  stops.columns = {{"start", at, {p.start}}, {"from", at, {p.from}}, {"to", at, {p.to}}};
  Machine with_axis = machine;
  if (with_axis.axis(p.axis) == nullptr)
    with_axis.axes.push_back({.name = p.axis, .rotary = p.rotary});
  auto settings = given;
  settings["programs"] = "sign-probe";
  settings["axes"] = p.axis;
  settings[p.rotary ? "feed_deg_per_min" : "feed_mm_per_min"] = std::to_string(w.feed);
  if (w.control.empty() && !runs_gcode(machine.control, plugins))
    return fail("control " + machine.control +
                " runs no part programs in G-code: enter the moves by hand (run without --out), or "
                "name a writer with --control");
  // G53 selects machine coordinates; an active zero offset would shift the moves.
  const std::string control = w.control.empty() ? writer_for(machine.control, plugins) : w.control;
  if (control == "gcode" && !machine.control.empty()) settings.emplace("work_offset", "G53");
  auto files = planning::write_programs(plugins, control, with_axis, stops, settings);
  if (!files) return fail(files.error().front());
  Artifact& program = files->front();
  std::string ending = std::filesystem::path(program.name).extension().string();
  if (ending == ".ngc") ending = ".nc";  // ending of earlier versions
  if (ending == ".h") ending = ".H";
  program.name = "sign-probe-" + p.axis + ending;
  return std::move(program);
}

namespace {

Json probe_json(const tables::SignProbe& p, const std::string& file) {
  const Quantity q = deviation_of(p.rotary);
  const auto name = [](const char* key, Quantity of) {
    return key + std::string(unit_of(of).suffix);
  };
  const Quantity at = position_of(p.rotary);
  Json json = {{"measurement", p.measurement},
               {"axis", p.axis},
               {name("start", at), printed(p.start, at)},
               {name("from", at), printed(p.from, at)},
               {name("to", at), printed(p.to, at)},
               {name("without_table", q), printed(p.difference, q)},
               {name("as_measured", q), printed(p.as_measured, q)},
               {name("right_sign", q), 0.0},
               {name("wrong_sign", q), printed(2.0 * p.difference, q)},
               {name("scatter", q), printed(p.scatter, q)},
               {"shows", p.shows()}};
  if (!file.empty()) json["file"] = file;
  return json;
}

void print_probe(const tables::SignProbe& p, const std::string& file,
                 const config::TerminalWords& say) {
  const Quantity q = deviation_of(p.rotary), at = position_of(p.rotary);
  std::cout << say("head.axis") << " " << p.axis << ", "
            << say("head.from.one", {{"ids", p.measurement}}) << "\n";
  sentence(std::cout, 2,
           say("probe.moves", {{"from", with_unit(p.from, at, say)},
                               {"start", with_unit(p.start, at, say)},
                               {"to", with_unit(p.to, at, say)}}));
  const auto shown = [&](double value, const char* means) {
    std::cout << "    " << with_unit(value, q, say) << "  " << say(means) << "\n";
  };
  shown(p.difference, "probe.none");
  shown(0.0, "probe.right");
  shown(2.0 * p.difference, "probe.wrong");
  if (std::fabs(p.as_measured - p.difference) > 1e-12) shown(p.as_measured, "probe.still");
  if (!p.shows())
    std::cout << "  " << say("probe.small", {{"scatter", with_unit(p.scatter, q, say)}}) << "\n";
  if (!file.empty()) std::cout << "  " << file << "\n";
}

int probe(const ProbeWish& w, const Common& common) {
  if (!(w.feed > 0.0)) return complain("--feed: expected more than 0");
  const auto opened = open_campaign(w.folder, common);
  if (!opened) return opened.error();
  const OpenCampaign& open = *opened;
  const auto& campaign = open.campaign();
  if (!w.axis.empty() && campaign.machine.axis(w.axis) == nullptr)
    return complain("--axis: the campaign has no axis " + w.axis);
  const auto settings = settings_of(w.settings);
  if (!settings) return complain(settings.error().message);
  const auto raw = raw_readings(open, w.axis);
  if (!raw) return complain(text_of(raw.error()));
  Json all = Json::array();
  std::vector<Artifact> files;
  bool good = true, measured = false;
  for (std::size_t i = 0; i < open.read.observations.size(); ++i) {
    const Measurement& m = campaign.measurements[i];
    if (m.kind != "axis" || open.read.observations[i].size() == 0 ||
        (!w.axis.empty() && m.axis != w.axis))
      continue;
    measured = true;
    const auto p = probe_of(open, i, *raw);
    if (!p) {
      good = false;
      complain(p.error().message);
      continue;
    }
    std::string file;
    if (!w.out.empty()) {
      auto program = program_of(*p, campaign.machine, w, *settings, open.place->plugins);
      if (!program) return complain(text_of(program.error()));
      for (const Artifact& f : files)
        if (f.name == program->name) program->name = m.id + "-" + program->name;
      file = (std::filesystem::path(w.out) / program->name).string();
      files.push_back(std::move(*program));
    }
    good = good && p->shows();
    all.push_back(probe_json(*p, file));
    if (!common.json) print_probe(*p, file, open.words());
  }
  if (!files.empty())
    if (auto done = storage::publish(std::filesystem::absolute(w.out), files); !done)
      return complain(text_of(done.error()), exit_failed);
  if (common.json)
    print_json(Json{{"schema", "nonio-sign-probe/1"}, {"campaign", campaign.id}, {"probes", all}});
  if (!measured) return complain("no measurement of an axis with readings", exit_failed);
  return good ? exit_done : exit_failed;
}

}  // namespace

Verb probe_verb(Common& common) {
  auto w = std::make_shared<ProbeWish>();
  return {
      .name = "probe",
      .summary = "Two moves that show on the machine whether a table has the right sign",
      .arguments = joined(
          campaign_arguments(w->folder, common),
          {{"--axis", &w->axis, "Only this axis"},
           takes(Argument::Takes::folder, {"--out", &w->out, "Folder for the part programs"}),
           {"--feed", &w->feed, "Feed of the programs, mm/min or deg/min (default 1000)"},
           offering({"gcode", "siemens", "heidenhain"},
                    {"--control", &w->control,
                     "Writer of part programs: gcode, siemens, heidenhain or a plugin's whole name "
                     "(default: that of the campaign's control)"}),
           settings_argument(w->settings,
                             "NAME=VALUE: an option of that writer, such as dwell_s=3; may be "
                             "given several times")}),
      .footer =
          "The two stops are the targets between which the error changed most, both reached "
          "towards plus. Load the table, reference the axis, run the program, set the instrument "
          "to zero at the first stop (M0) and read it at the second. Near zero: the sign is right. "
          "Twice the error: it is wrong. The error itself: no table is active. DRY RUN FIRST: the "
          "program moves the axis in coordinates of the machine.\n\nExit status: 0 the test works "
          "for every axis; 1 the error of an axis is too small for it; 2 usage.",
      .examples = {"nonio table probe site/2026-11-rossi --out p"},
      .run = [w, &common] { return probe(*w, common); }};
}

}  // namespace nonio::app
