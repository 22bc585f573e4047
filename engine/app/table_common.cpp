// SPDX-License-Identifier: Apache-2.0
#include "table_common.h"

#include <algorithm>
#include <cmath>
#include <iostream>

#include "campaign/config/site_files.h"
#include "campaign/planning/plan.h"
#include "nonio/sdk/format.h"
#include "platform/storage/nearest.h"
#include "tables.h"
#include "text_layout.h"

namespace nonio::app {

void put(TableJson& json, const std::string& name, double si, Quantity q) {
  if (std::isfinite(si)) json[name + std::string(unit_of(q).suffix)] = printed(si, q);
}

static TableJson shape_json(const tables::TableShape& s, bool rotary) {
  TableJson json = TableJson::object();
  put(json, "largest", s.largest, deviation_of(rotary));
  put(json, "largest_step", s.step, deviation_of(rotary));
  put(json, "largest_step_from", s.step_at, position_of(rotary));
  put(json, "largest_slope", s.slope, slope_of(rotary));
  if (s.backlash) put(json, "backlash", *s.backlash, deviation_of(rotary));
  return json;
}

TableJson difference_json(const tables::TableDifference& d) {
  TableJson json = {{"output", d.output}, {"by", d.input}};
  put(json, "largest", d.largest, deviation_of(d.rotary));
  put(json, "at", d.at, position_of(d.rotary));
  put(json, "range", d.range, deviation_of(d.rotary));
  if (d.present) json["present"] = shape_json(*d.present, d.rotary);
  if (d.next) json["new"] = shape_json(*d.next, d.rotary);
  return json;
}

static void print_shape(const char* name, const std::optional<tables::TableShape>& s, bool rotary,
                        const config::TerminalWords& say) {
  const std::size_t width =
      std::max(columns_of(say("compared.present")), columns_of(say("compared.new")));
  std::string text = padded(say(name), width) + ": ";
  if (!s) return sentence(std::cout, 2, text + say("compared.none"));
  const Quantity q = deviation_of(rotary);
  text += say("compared.shape", {{"largest", with_unit(s->largest, q, say)},
                                 {"step", with_unit(s->step, q, say)},
                                 {"from", with_unit(s->step_at, position_of(rotary), say)},
                                 {"slope", with_unit(s->slope, slope_of(rotary), say)}});
  if (s->backlash)
    text += ", " + say("compared.backlash", {{"value", with_unit(*s->backlash, q, say)}});
  sentence(std::cout, 2, text);
}

void print_difference(const tables::TableDifference& d, const config::TerminalWords& say,
                      bool compared) {
  std::string text = say("head.axis") + " " + d.output;
  if (d.input.size() != 1 || d.input.front() != d.output)
    text += " " + say("compared.by", {{"axes", storage::listed(d.input)}});
  const Quantity q = deviation_of(d.rotary);
  if (compared)
    text += ": " + say("compared.differ", {{"largest", with_unit(d.largest, q, say)},
                                           {"at", with_unit(d.at, position_of(d.rotary), say)},
                                           {"range", with_unit(d.range, q, say)}});
  sentence(std::cout, 0, text);
  print_shape("compared.present", d.present, d.rotary, say);
  if (compared) print_shape("compared.new", d.next, d.rotary, say);
}

TableJson forecast_json(const tables::TableForecast& f) {
  TableJson json = {{"measurement", f.measurement}, {"axis", f.axis}};
  const Quantity q = deviation_of(f.rotary);
  for (const auto& [when, k] : {std::pair{"before", 0}, {"after", 1}}) {
    json[when] = TableJson::object();
    put(json[when], "E", f.E[k], q);
    put(json[when], "B", f.B[k], q);
    put(json[when], "M", f.M[k], q);
  }
  if (f.scatter > 0.0) put(json["after"], "scatter", f.scatter, q);
  if (!f.U_known) json["after"]["U_known"] = false;
  return json;
}

void print_forecast(const tables::TableForecast& f, const config::TerminalWords& say) {
  const Quantity q = deviation_of(f.rotary);
  std::string text =
      say("head.axis") + " " + f.axis + ", " + say("head.from.one", {{"ids", f.measurement}}) + ":";
  for (const auto& [name, v] : {std::pair{"E", f.E}, {"B", f.B}, {"M", f.M}}) {
    if (!std::isfinite(v[0]) || !std::isfinite(v[1])) continue;
    const std::string after = with_unit(v[1], q, say);
    text += std::string("  ") + name + " " + with_unit(v[0], q, say) + " -> " +
            (f.U_known ? after : say("compared.at-least", {{"value", after}}));
  }
  if (!f.U_known) text += "; " + say("compared.no-U");
  if (std::isnan(f.E[0])) text += " " + say("compared.unpredicted");
  if (f.scatter > 0.0)
    text += "; " + say("compared.scatter", {{"value", with_unit(f.E[1] + f.scatter, q, say)}});
  sentence(std::cout, 0, text);
  if (f.grows) sentence(std::cout, 2, say("error") + ": " + say("compared.worse"));
  if (f.unproven()) sentence(std::cout, 2, say("compared.unproven"));
}

Expected<Loaded> load(const loader::Plugins& plugins, const std::string& files,
                      const std::string& control, const Campaign& campaign, const Texts& settings,
                      const std::function<config::Checked<Settings>(const Info&)>& options_of) {
  NONIO_TRY(auto read, config::read_table_files(files));
  return understood(plugins, std::move(read), control, campaign, settings, options_of);
}

Expected<Loaded> understood(
    const loader::Plugins& plugins, std::vector<Artifact> files, const std::string& control,
    const Campaign& campaign, const Texts& settings,
    const std::function<config::Checked<Settings>(const Info&)>& options_of) {
  NONIO_TRY(const Controller* const found,
            tables::control_of(plugins, control, files, campaign, settings));
  const auto options = options_of(found->info);
  if (!options) return tl::unexpected<Error>(options.error().front());
  auto tables = tables::tables_in(*found, files, campaign, *options);
  if (tables) return Loaded{found, std::move(*tables), std::move(files)};
  // The message contains the file name.
  if (tables.error().line != 0) return fail(tables.error().message);
  std::string names;
  for (const Artifact& f : files) names += (names.empty() ? "" : ",") + f.name;
  return fail(names + ": " + tables.error().message);
}

config::Checked<Settings> campaign_options(const OpenCampaign& open, const Info& info,
                                           const Texts& settings) {
  auto settled =
      config::settle_table_options(info, open.place->context.site.options, *open.read.manifest,
                                   open.read.machine ? &*open.read.machine : nullptr);
  if (!settled) return settled;
  const auto told = config::options_from(info, settings);
  if (!told) return told;
  for (const auto& [name, text] : settings) {
    NumberTables axes = settled->tables("axes");
    settled->values[name] = told->values.at(name);
    if (name != "axes") continue;
    for (const auto& [axis, table] : told->tables("axes"))  // the last statement takes precedence
      for (const auto& [key, value] : table) axes[axis][key] = value;
    settled->values[name] = std::move(axes);
  }
  return settled;
}

Expected<void> knows_active(const Campaign& campaign, const Measurement& m) {
  const Axis* const axis = campaign.machine.axis(control_axis(campaign.machine, m));
  if (m.kind != "axis" || m.compensation == "off" || (axis != nullptr && axis->active_table))
    return {};
  return fail("axis " + m.axis +
              ": which table was active during the measurement is not known; state active_table in "
              "[machine.axes." +
              m.axis + "] of campaign.toml, its file or \"none\"");
}

void tell_findings(const OpenCampaign& open, const std::vector<Finding>& findings) {
  const Templates& words = open.place->context.templates;
  const std::string& language = open.place->context.site.language;
  for (const Finding& f : findings)
    if (f.attention)
      complain(finding_text(words, language, f, "title") + ": " +
               finding_text(words, language, f, "says"));
}

}  // namespace nonio::app
