// SPDX-License-Identifier: Apache-2.0
#include "axis_job.h"
#include "consumer.h"
#include "cross_tables.h"
#include "nonio/sdk/plugin.h"

namespace nonio {
namespace {

using controllers::AxisJob;
using controllers::decimal;
using math::Grid;

constexpr int digits = 6;  // of mm or deg: 1 nm, 0.004 arcsec

struct Choices {
  bool directions;
  std::int64_t measuring_system, first_cec_table;
  std::size_t max_points;
  bool quoted_axes;
};

std::string axis_name(const AxisJob& job) { return "AX" + std::to_string(job.number); }

std::string comments(const std::vector<std::string>& lines) {
  std::string out;
  for (const std::string& line : lines) out += "; " + line + "\n";
  return out;
}

Expected<Grid> grid_of(const AxisJob& job, const OutputInput& input, const Choices& choices) {
  math::GridRule rule;
  rule.unit = (job.rotary ? 1e-3 : 1e-4) / job.per_si();
  rule.most = choices.max_points;
  rule.step = controllers::wished_step(job, input.options);
  rule.rotary = job.rotary;
  rule.axis = job.axis;
  rule.turn = job.turn.has_value();
  if (!rule.turn) rule.first = job.position_setting("first");
  return math::choose_grid(job.table_curve().position, rule);
}

std::vector<std::string> sign_rule() {
  return {"entries are the measured deviation (actual - nominal) with its own sign:",
          "the control adds them to the actual position, a positive entry drives towards minus"};
}

// What stays the same in both kinds of table; `index` is "0,AX1" or the number of a table.
std::string range_lines(const std::string& variable, const std::string& index, const AxisJob& job,
                        const Grid& grid) {
  const auto line = [&](const char* name, const std::string& value) {
    return "$" + variable + "_" + name + "[" + index + "]=" + value + "\n";
  };
  return line("STEP", decimal(grid.step * job.per_si(), digits)) +
         line("MIN", decimal(grid.first * job.per_si(), digits)) +
         line("MAX", decimal(grid.last() * job.per_si(), digits)) +
         line("IS_MODULO", job.turn ? "1" : "0");
}

std::string encoder_table(const AxisJob& job, const Grid& grid, const Choices& choices,
                          double reference, const std::vector<std::string>& warning) {
  const auto& curve = job.table_curve();
  const double zero = math::ErrorCurve::at(curve.position, curve.mean, reference);
  const std::string system = std::to_string(choices.measuring_system), axis = axis_name(job);
  std::string out = "%_N_" + axis + "_EEC_INI\nCHANDATA(1)\n";
  out += comments(warning) + comments(job.about) + comments(sign_rule());
  out += comments({"zero at the reference position " + controllers::with_unit(job, reference, 4),
                   controllers::reversal_words(job, false),
                   "MD38000[" + system + "] >= " + std::to_string(grid.points) +
                       "; load with MD32700[" + system + "] = 0, then 1, power on, reference"});
  const auto values = math::sampled(curve.position, curve.mean, grid, zero);
  for (std::size_t i = 0; i < values.size(); ++i)
    out += "$AA_ENC_COMP[" + system + "," + std::to_string(i) + "," + axis +
           "]=" + decimal(values[i] * job.per_si(), digits) + "\n";
  return out + range_lines("AA_ENC_COMP", system + "," + axis, job, grid) + "M17\n";
}

std::string backlash_file(const AxisJob& job, const Choices& choices,
                          const std::vector<std::string>& warning) {
  const std::string axis = axis_name(job);
  return "%_N_" + axis + "_TEA_INI\nCHANDATA(1)\n" + comments(warning) + comments(job.about) +
         comments({controllers::reversal_words(job, false),
                   "MD32450: positive where the encoder leads the machine part (lost motion)"}) +
         "$MA_BACKLASH[" + std::to_string(choices.measuring_system) + "," + axis +
         "]=" + decimal(job.backlash() * job.per_si(), digits) + "\nM17\n";
}

// Direction-dependent pitch: input axis = output axis, one table for each direction of travel.
std::string direction_tables(const AxisJob& job, const Grid& grid, const Choices& choices,
                             double reference, const std::vector<std::string>& warning) {
  const auto& curve = job.table_curve();
  const double zero = math::ErrorCurve::at(curve.position, curve.mean, reference);
  const std::string axis =
      choices.quoted_axes ? "\"" + axis_name(job) + "\"" : "(" + axis_name(job) + ")";
  std::string out = "%_N_NC_CEC_INI\nCHANDATA(1)\n";
  out += comments(warning) + comments(job.about) + comments(sign_rule());
  out += comments({"mean of both directions zero at " + controllers::with_unit(job, reference, 4),
                   controllers::reversal_words(job, true),
                   "MD18342[t] >= " + std::to_string(grid.points) +
                       "; enable MD32710 of the axis and SD41300[t]"});
  std::int64_t number = choices.first_cec_table + 2 * (static_cast<std::int64_t>(job.number) - 1);
  for (const int direction : {1, -1}) {
    const std::string t = std::to_string(number++);
    const auto values =
        math::sampled(curve.position, direction > 0 ? curve.plus : curve.minus, grid, zero);
    for (std::size_t i = 0; i < values.size(); ++i)
      out += "$AN_CEC[" + t + "," + std::to_string(i) +
             "]=" + decimal(values[i] * job.per_si(), digits) + "\n";
    out += "$AN_CEC_INPUT_AXIS[" + t + "]=" + axis + "\n$AN_CEC_OUTPUT_AXIS[" + t + "]=" + axis +
           "\n" + range_lines("AN_CEC", t, job, grid) + "$AN_CEC_DIRECTION[" + t +
           "]=" + std::to_string(direction) + "\n$AN_CEC_MULT_BY_TABLE[" + t + "]=0\n";
  }
  return out + "M17\n";
}

Expected<void> write_axis(AxisJob& job, const OutputInput& input, const Choices& choices,
                          OutputResult& result) {
  const bool directions = choices.directions && job.curve.bidirectional();
  if (controllers::refused(job, directions, result)) return {};
  const auto grid = grid_of(job, input, choices);
  if (!grid) return tl::unexpected<Error>(grid.error());
  const double reference = controllers::reference_position(job, grid->first, grid->last());
  const auto warning = controllers::warnings(job, result);
  const std::string stem = "siemens-840d-" + job.stem;
  std::vector<Artifact> files;
  if (directions) {
    files.push_back({stem + "-CEC.ini", direction_tables(job, *grid, choices, reference, warning)});
  } else {
    files.push_back({stem + "-EEC.ini", encoder_table(job, *grid, choices, reference, warning)});
    if (job.curve.bidirectional()) {
      files.push_back({stem + "-backlash.ini", backlash_file(job, choices, warning)});
      controllers::doubt_backlash(job, result);
    }
  }
  siemens::Machine control{axis_name(job),     static_cast<int>(choices.measuring_system),
                           job.rotary,         choices.max_points,
                           choices.max_points, job.present_backlash() * job.per_si()};
  std::vector<std::string_view> bytes;
  for (const Artifact& f : files) bytes.push_back(f.bytes);
  const auto correction = siemens::load(bytes, control);
  if (!correction)
    return fail("axis " + job.axis +
                ": the table written cannot be read back: " + correction.error().message);
  controllers::predict(job, *correction, result);
  job.loaded = *correction;
  Remark zero = controllers::remark(
      job, job.position_setting("reference") ? "siemens.zero-at" : "siemens.zero-taken");
  zero.evidence = {{"reference", reference, position_of(job.rotary)}};
  result.notes.push_back(std::move(zero));
  for (Artifact& f : files) result.artifacts.push_back(std::move(f));
  return {};
}

void notes(const Choices& choices, OutputResult& result) {
  result.notes.push_back({"siemens.form-inferred"});
  if (choices.directions) result.notes.push_back({"siemens.cec-inferred"});
}

Expected<OutputResult> write(const OutputInput& input) {
  OutputResult result;
  const Settings& o = input.options;
  const Choices choices{
      o.flag("directions"), o.integer("measuring_system"), o.integer("first_cec_table"),
      static_cast<std::size_t>(o.integer("max_points", 200)), o.flag("quoted_axes")};
  auto jobs =
      controllers::axis_jobs(input, {"number:", "step", "first", "reference", "backlash"}, result);
  if (!jobs) return tl::unexpected<Error>(jobs.error());
  for (AxisJob& job : *jobs)
    if (auto done = write_axis(job, input, choices, result); !done)
      return tl::unexpected<Error>(done.error());
  siemens::CrossChoices cross{choices.first_cec_table, choices.max_points, choices.quoted_axes};
  const auto& axes = input.campaign.machine.axes;
  for (std::size_t i = 0; i < axes.size(); ++i) cross.numbers[axes[i].name] = i + 1;
  for (const AxisJob& job : *jobs) cross.numbers[job.axis] = job.number;
  if (choices.directions) cross.first_table += 2 * static_cast<std::int64_t>(axes.size());
  if (auto done = siemens::write_cross_tables(input, cross, *jobs, result); !done)
    return tl::unexpected<Error>(done.error());
  if (!result.artifacts.empty()) notes(choices, result);
  return result;
}

std::vector<Option> options() {
  std::vector<Option> list = controllers::step_options();
  list.push_back({"directions", false, "",
                  "A table for each direction of travel (CEC) in place of mean and backlash."});
  list.push_back(
      {"measuring_system", std::int64_t{0}, "", "Encoder: 0 first, 1 second.", {}, 0.0, 1.0});
  list.push_back({"max_points",
                  std::int64_t{200},
                  "",
                  "Points that MD38000 and MD18342 make room for (808D, 828D: 200).",
                  {},
                  2.0,
                  5000.0});
  list.push_back({"first_cec_table",
                  std::int64_t{0},
                  "",
                  "Number of the first CEC table; axis n takes this + 2 (n - 1) and the next.",
                  {},
                  0.0,
                  120.0});
  list.push_back({"quoted_axes", false, "", "CEC axes as \"AX1\" (newer) and not as (AX1)."});
  list.push_back(
      controllers::axes_option("number (n of AXn), step_mm, first_mm, reference_mm, backlash_mm "
                               "(MD32450 while measured), and "
                               "the same with _deg"));
  return list;
}

}  // namespace
}  // namespace nonio

NONIO_PLUGIN(registry) {
  nonio::Output output;
  output.info = {"siemens-840d", "1.0.0",
                 "Leadscrew error tables (EEC), direction tables (CEC) and backlash for SINUMERIK.",
                 nonio::options()};
  output.stage = nonio::Output::Stage::table;
  output.applies = nonio::controllers::has_tables;
  output.write = nonio::write;
  registry.add(std::move(output));
}
