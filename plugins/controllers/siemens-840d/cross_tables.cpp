// SPDX-License-Identifier: Apache-2.0
#include "cross_tables.h"

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
  std::string out = "%_N_NC_CEC_INI\nCHANDATA(1)\n";
  for (const std::string& words :
       {"straightness and squareness from the diagonals of " + controllers::plain(job.measurement) +
            ", campaign " + controllers::plain(input.campaign.id),
        std::string("the same points as the pitch tables; pitch itself is not in these tables"),
        std::string(
            "the squareness is in them: do not shift the zero of a gantry's second side too"),
        std::string("entries are the error of the output axis with its own sign:"),
        std::string("a positive entry moves the output axis towards minus"),
        "MD18342[t] >= " + std::to_string(job.along_x.position.size()) +
            "; enable MD32710 of both output axes and SD41300[t]"})
    out += "; " + words + "\n";
  return out + table(job.along_x, choices.first_table, choices) +
         table(job.along_y, choices.first_table + 1, choices) + "M17\n";
}

}  // namespace

Expected<void> write_cross_tables(const OutputInput& input, const CrossChoices& choices,
                                  OutputResult& result) {
  const auto jobs = controllers::cross_jobs(input.results);
  for (const CrossJob& job : jobs) {
    if (job.along_x.position.size() > choices.max_points)
      return fail("diagonals of " + job.measurement + ": " +
                  std::to_string(job.along_x.position.size()) + " points, the control takes " +
                  std::to_string(choices.max_points) + " (max_points)");
    const std::string stem = "siemens-840d-" +
                             controllers::file_part(job.along_x.input + job.along_x.output) +
                             (jobs.size() > 1 ? "-" + controllers::file_part(job.measurement) : "");
    Artifact file{stem + "-CEC.ini", file_text(job, input, choices)};
    Machine control;
    control.cec_points = choices.max_points;
    const auto of_y = load_cross({file.bytes}, name_of(job.along_x.input, choices),
                                 name_of(job.along_x.output, choices), control);
    const auto of_x = load_cross({file.bytes}, name_of(job.along_y.input, choices),
                                 name_of(job.along_y.output, choices), control);
    for (const auto* read : {&of_y, &of_x})
      if (!*read)
        return fail("diagonals of " + job.measurement +
                    ": the table written cannot be read back: " + read->error().message);
    controllers::predict_diagonals(job, *of_y, *of_x, result);
    result.artifacts.push_back(std::move(file));
  }
  if (!jobs.empty()) result.notes.push_back({"siemens.cross"});
  return {};
}

}  // namespace nonio::siemens
