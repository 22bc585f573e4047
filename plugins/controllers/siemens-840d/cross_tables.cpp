// SPDX-License-Identifier: Apache-2.0
#include "cross_tables.h"

#include <algorithm>

#include "axis_job.h"
#include "consumer.h"
#include "cross_job.h"

namespace nonio::siemens {

namespace {

using controllers::CrossCurve;
using controllers::CrossJob;
using controllers::decimal;

constexpr int digits = 6;  // of mm
constexpr double per_si = 1e3;

std::string name_of(const std::string& axis, const CrossChoices& choices) {
  const auto it = choices.numbers.find(axis);
  return "AX" + std::to_string(it == choices.numbers.end() ? 0 : it->second);
}

std::string table(const CrossCurve& curve, std::int64_t number, const CrossChoices& choices) {
  const std::string t = std::to_string(number);
  const auto axis = [&](const std::string& name) {
    const std::string ax = name_of(name, choices);
    return choices.quoted_axes ? "\"" + ax + "\"" : "(" + ax + ")";
  };
  const auto line = [&](const char* what, const std::string& value) {
    return "$AN_CEC_" + std::string(what) + "[" + t + "]=" + value + "\n";
  };
  const auto& x = curve.position;
  std::string out = "; table " + t + ": axis " + controllers::plain(curve.output) +
                    " by the position of " + controllers::plain(curve.input) + "\n";
  for (std::size_t i = 0; i < x.size(); ++i)
    out += "$AN_CEC[" + t + "," + std::to_string(i) +
           "]=" + decimal((curve.value[i] - curve.value.front()) * per_si, digits) + "\n";
  const double step = (x.back() - x.front()) / static_cast<double>(x.size() - 1);
  return out + line("INPUT_AXIS", axis(curve.input)) + line("OUTPUT_AXIS", axis(curve.output)) +
         line("STEP", decimal(step * per_si, digits)) +
         line("MIN", decimal(x.front() * per_si, digits)) +
         line("MAX", decimal(x.back() * per_si, digits)) + line("IS_MODULO", "0") +
         line("DIRECTION", "0") + line("MULT_BY_TABLE", "0");
}

std::string file_text(const CrossJob& job, const OutputInput& input, const CrossChoices& choices) {
  std::size_t points = 0;
  for (const CrossCurve& curve : job.curves) points = std::max(points, curve.position.size());
  std::string out = "%_N_NC_CEC_INI\nCHANDATA(1)\n";
  for (const std::string& words :
       {std::string("straightness and squareness from the ") + (job.volume ? "step " : "") +
            "diagonals of " + controllers::plain(job.measurement) + ", campaign " +
            controllers::plain(input.campaign.id),
        std::string(
            job.volume
                ? "pitch itself is not in these tables"
                : "the same points as the pitch tables; pitch itself is not in these tables"),
        std::string("the squareness is in them: do not ") +
            (job.volume ? "enter it elsewhere too"
                        : "shift the zero of a gantry's second side too"),
        std::string("entries are the error of the output axis with its own sign:"),
        std::string("a positive entry moves the output axis towards minus"),
        "MD18342[t] >= " + std::to_string(points) + "; enable MD32710 of " +
            (job.volume ? "all" : "both") + " output axes and SD41300[t]"})
    out += "; " + words + "\n";
  std::int64_t number = choices.first_table;
  for (const CrossCurve& curve : job.curves) out += table(curve, number++, choices);
  return out + "M17\n";
}

Expected<void> fits(const CrossJob& job, const CrossChoices& choices) {
  for (const CrossCurve& curve : job.curves)
    if (curve.position.size() > choices.max_points)
      return fail("diagonals of " + job.measurement + ": " + std::to_string(curve.position.size()) +
                  " points, the control takes " + std::to_string(choices.max_points) +
                  " (max_points)");
  return {};
}

/// What the control makes of the file, and of the pitch tables beside it.
Expected<controllers::Corrections> read_back(const CrossJob& job, const Artifact& file,
                                             const CrossChoices& choices, const OutputInput& input,
                                             const std::vector<controllers::AxisJob>& pitch) {
  controllers::Corrections corrections;
  Machine control;
  control.cec_points = choices.max_points;
  for (const CrossCurve& curve : job.curves) {
    auto read = load_cross({file.bytes}, name_of(curve.input, choices),
                           name_of(curve.output, choices), control);
    if (!read)
      return fail("diagonals of " + job.measurement +
                  ": the table written cannot be read back: " + read.error().message);
    corrections[{curve.input, curve.output}] = std::move(*read);
  }
  if (job.volume)
    for (const controllers::AxisJob& of : pitch)
      if (of.loaded && controllers::together(job, of, input.campaign))
        corrections[{of.axis, of.axis}] = *of.loaded;
  return corrections;
}

}  // namespace

Expected<void> write_cross_tables(const OutputInput& input, const CrossChoices& choices,
                                  const std::vector<controllers::AxisJob>& pitch,
                                  OutputResult& result) {
  const auto jobs = controllers::cross_jobs(input);
  for (const CrossJob& job : jobs) {
    if (auto ok = fits(job, choices); !ok) return ok;
    const std::string stem = "siemens-840d-" + controllers::file_part(job.axes()) +
                             (jobs.size() > 1 ? "-" + controllers::file_part(job.measurement) : "");
    Artifact file{stem + "-CEC.ini", file_text(job, input, choices)};
    const auto corrections = read_back(job, file, choices, input, pitch);
    if (!corrections) return tl::unexpected<Error>(corrections.error());
    controllers::predict_lines(job, *corrections, result);
    result.artifacts.push_back(std::move(file));
  }
  const bool volume = std::any_of(jobs.begin(), jobs.end(), [](const auto& j) { return j.volume; });
  if (!jobs.empty()) result.notes.push_back({volume ? "siemens.cross-volume" : "siemens.cross"});
  return {};
}

}  // namespace nonio::siemens
