// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <numbers>

#include "axis_job.h"
#include "consumer.h"
#include "nonio/sdk/format.h"
#include "nonio/sdk/plugin.h"

namespace nonio {
namespace {

using controllers::AxisJob;

constexpr int digits = 8;  // of mm, inch or deg
constexpr std::size_t most_lines = 256;

struct Choices {
  int type;
  bool inch;
  double per_si(const AxisJob& job) const {
    return inch && !job.rotary ? 1e3 / 25.4 : job.per_si();
  }
  std::string unit(const AxisJob& job) const {
    return inch && !job.rotary ? "inch" : std::string(job.unit());
  }
};

// Where the file has lines: the targets themselves, or an even grid on request.
Expected<std::vector<double>> positions(const AxisJob& job, const OutputInput& input) {
  const double step = controllers::wished_step(job, input.options);
  std::vector<double> at = job.curve.position;
  const double full = 2.0 * std::numbers::pi;
  if (step == 0.0 && at.size() < most_lines) {
    // There is no wrap at 360 degrees: a turn measured short of its end is closed by hand.
    if (job.turn && at.back() < at.front() + full - 1e-9) at.push_back(at.front() + full);
    return at;
  }
  if (step == 0.0 && at.size() == most_lines) return at;
  math::GridRule rule;
  rule.unit = (job.rotary ? 1e-3 : 1e-4) / job.per_si();
  rule.most = most_lines;
  rule.step = step;
  rule.first = job.position_setting("first");
  rule.rotary = job.rotary;
  rule.axis = job.axis;
  const auto grid = math::choose_grid(at, rule);
  if (!grid) return tl::unexpected<Error>(grid.error());
  at.clear();
  for (std::size_t i = 0; i < grid->points; ++i) at.push_back(grid->position(i));
  return at;
}

double deviation(const AxisJob& job, const std::vector<double>& values, double x) {
  const double full = 2.0 * std::numbers::pi;
  const auto& position = job.curve.position;
  const bool next_turn = job.turn && x > position.back() && x > position.front() + full - 1e-9;
  return math::ErrorCurve::at(position, values, next_turn ? x - full : x);
}

// Three numbers a line and nothing else: the reader stops at anything that is not. A BACKLASH that
// was in force while the axis was measured falls away beside a table: its half comes back here.
std::string comp_file(const AxisJob& job, const std::vector<double>& at, const Choices& choices) {
  const double scale = choices.per_si(job);
  const auto& up = job.curve.plus.empty() ? job.curve.minus : job.curve.plus;
  const auto& down = job.curve.minus.empty() ? job.curve.plus : job.curve.minus;
  std::string out;
  for (const double x : at) {
    out += fixed_text(x * scale, digits);
    for (const int direction : {1, -1}) {
      const double half = direction * job.present_backlash() / 2.0;
      const double d = deviation(job, direction > 0 ? up : down, x) - half;
      out += " " + fixed_text((choices.type == 0 ? x + d : 0.0 - d) * scale, digits);
    }
    out += "\n";
  }
  return out;
}

std::string joint_of(const AxisJob& job) {
  const auto joint = job.setting("joint");
  return joint ? fixed_text(*joint, 0) : std::to_string(job.number - 1);
}

std::string ini_snippet(const AxisJob& job, const std::string& comp, const Choices& choices,
                        const std::vector<std::string>& warning) {
  std::string out;
  for (const auto* lines : {&warning, &job.about})
    for (const std::string& line : *lines) out += "# " + line + "\n";
  out += "# BACKLASH has no effect beside this table: the reversal is in its two columns\n";
  return out + "[JOINT_" + joint_of(job) + "]\nCOMP_FILE = " + comp +
         "\nCOMP_FILE_TYPE = " + std::to_string(choices.type) + "\n";
}

std::string words(const AxisJob& job, const std::string& comp, const Choices& choices,
                  const std::vector<std::string>& warning) {
  std::string out;
  const auto line = [&](const std::string& text) { out += text + "\n"; };
  for (const std::string& w : warning) line(w);
  for (const std::string& w : job.about) line(w);
  line("file " + comp + ", joint " + joint_of(job) + ", in " + choices.unit(job) +
       ": nominal, moving towards plus, moving towards minus");
  line(choices.type == 0
           ? "COMP_FILE_TYPE = 0: columns 2 and 3 are the actual positions, nominal + deviation"
           : "COMP_FILE_TYPE = 1: columns 2 and 3 are added to the motor's position, the opposite "
             "of the deviation (actual - nominal)");
  line(job.curve.bidirectional()
           ? "mean reversal B = " + controllers::deviation_words(job, job.curve.mean_reversal()) +
                 ": contained in the two columns; BACKLASH is ignored beside a table"
           : "measured from one direction only: both columns have its deviation; BACKLASH is "
             "ignored "
             "beside a table");
  line(
      "do not put comments or blank lines into the file: the controller stops reading there "
      "without a message");
  line(
      "the correction is fed in with half of the joint's velocity and acceleration: the drive "
      "needs headroom");
  if (job.rotary) line("no wrap at 360 deg: outside of the table the end values hold");
  return out;
}

Expected<void> write_axis(const AxisJob& job, const OutputInput& input, const Choices& choices,
                          OutputResult& result) {
  if (const double joint = job.setting("joint").value_or(0.0);
      joint < 0.0 || joint > 15.0 || joint != std::floor(joint))
    return fail("option axes, axis " + job.axis + ": joint must be a whole number from 0 to 15");
  const auto at = positions(job, input);
  if (!at) return tl::unexpected<Error>(at.error());
  const std::string stem = "linuxcnc-" + job.stem;
  const auto warning = controllers::warnings(job, result);
  Artifact comp{stem + ".comp", comp_file(job, *at, choices)};
  const linuxcnc::Machine control{choices.type, choices.per_si(job), most_lines};
  const auto correction = linuxcnc::load(comp.bytes, control);
  if (!correction || linuxcnc::lines_taken(comp.bytes, control) != at->size())
    return fail("axis " + job.axis + ": LinuxCNC would not take all of the table's " +
                std::to_string(at->size()) + " lines");
  controllers::predict(job, *correction, result);
  Artifact ini{stem + ".ini", ini_snippet(job, comp.name, choices, warning)};
  Artifact text{stem + ".txt", words(job, comp.name, choices, warning)};
  for (Artifact* a : {&comp, &ini, &text}) result.artifacts.push_back(std::move(*a));
  return {};
}

Expected<OutputResult> write(const OutputInput& input) {
  OutputResult result;
  const Choices choices{static_cast<int>(input.options.integer("type")),
                        input.options.text("units", "mm") == "inch"};
  const auto jobs = controllers::axis_jobs(input, {"joint:", "step", "first", "backlash"}, result);
  if (!jobs) return tl::unexpected<Error>(jobs.error());
  for (const AxisJob& job : *jobs)
    if (auto done = write_axis(job, input, choices, result); !done)
      return tl::unexpected<Error>(done.error());
  return result;
}

std::vector<Option> options() {
  std::vector<Option> list = controllers::step_options();
  list.push_back({"type",
                  std::int64_t{0},
                  "",
                  "COMP_FILE_TYPE: 0 actual positions, 1 corrections.",
                  {},
                  0.0,
                  1.0});
  list.push_back({"units", std::string("mm"), "", "LINEAR_UNITS of the machine.", {"mm", "inch"}});
  list.push_back(controllers::axes_option(
      "joint (else the axis' place in the manifest, from 0), step_mm, first_mm, backlash_mm "
      "(BACKLASH while measured), and the same with _deg"));
  return list;
}

}  // namespace
}  // namespace nonio

NONIO_PLUGIN(registry) {
  nonio::Output output;
  output.info = {"linuxcnc", "1.0.0",
                 "Screw compensation files (COMP_FILE, types 0 and 1) for LinuxCNC.",
                 nonio::options()};
  output.stage = nonio::Output::Stage::table;
  output.applies = nonio::controllers::has_tables;
  output.write = nonio::write;
  registry.add(std::move(output));
}
