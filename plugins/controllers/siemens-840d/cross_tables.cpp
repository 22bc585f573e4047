// SPDX-License-Identifier: Apache-2.0
#include "cross_tables.h"

#include <algorithm>

#include "nonio/controllers/replay.h"
#include "parse.h"

namespace nonio::siemens_840d {
namespace {

using controllers::CrossCurve;
using controllers::CrossJob;
using controllers::decimal;

constexpr int digits = 6;
constexpr double per_si = 1e3;

/// Name of an axis in the control: (AX1), or "AX1" in newer editions.
struct Naming {
  std::vector<controllers::KnownAxis> axes;
  bool quoted;
  std::string operator()(const std::string& axis) const {
    const std::string ax = "AX" + std::to_string(controllers::axis_named(axes, axis).number);
    return quoted ? "\"" + ax + "\"" : "(" + ax + ")";
  }
};

std::string outputs(const CrossJob& job, const std::vector<controllers::KnownAxis>& axes) {
  std::string out;
  for (const std::string& axis : job.outputs())
    out += (out.empty() ? "" : ", ") + controllers::plain(axis) + " (AX" +
           std::to_string(controllers::axis_named(axes, axis).number) + ")";
  return out;
}

std::string table(const CrossCurve& curve, std::int64_t number, const Naming& name) {
  const std::string t = std::to_string(number);
  const auto line = [&](const char* what, const std::string& value) {
    return "$AN_CEC_" + std::string(what) + "[" + t + "]=" + value + "\n";
  };
  const auto& x = curve.position;
  const std::string side = curve.side_of.empty()
                               ? ""
                               : ", the second side of the gantry axis " +
                                     controllers::plain(curve.side_of) + ": the same entries";
  std::string out = "; table " + t + ": axis " + controllers::plain(curve.output) +
                    " by the position of " + controllers::plain(curve.input) + side + "\n; " +
                    controllers::cross_words(curve, 1e-9, x) + "\n";
  for (std::size_t i = 0; i < x.size(); ++i)
    out += "$AN_CEC[" + t + "," + std::to_string(i) +
           "]=" + decimal(curve.value[i] * per_si, digits) + "\n";
  const double step = (x.back() - x.front()) / static_cast<double>(x.size() - 1);
  return out + line("INPUT_AXIS", name(curve.input)) + line("OUTPUT_AXIS", name(curve.output)) +
         line("STEP", decimal(step * per_si, digits)) +
         line("MIN", decimal(x.front() * per_si, digits)) +
         line("MAX", decimal(x.back() * per_si, digits)) + line("IS_MODULO", "0") +
         line("DIRECTION", "0") + line("MULT_BY_TABLE", "0");
}

std::string file_text(const CrossJob& job, const ControllerInput& input, std::int64_t number,
                      const Naming& name) {
  std::size_t points = 0;
  for (const CrossCurve& curve : job.curves) points = std::max(points, curve.position.size());
  std::vector<std::string> words{
      std::string("straightness and squareness from the ") + (job.volume ? "step " : "") +
          "diagonals of " + controllers::plain(job.measurement) + ", campaign " +
          controllers::plain(input.campaign.id),
      job.volume ? "pitch itself is not in these tables"
                 : "the same points as the pitch tables; pitch itself is not in these tables",
      "entries are the error of the output axis with its own sign:",
      "a positive entry moves the output axis towards minus",
      "MD18342[t] >= " + std::to_string(points) + "; enable MD32710 of " + outputs(job, name.axes) +
          " and SD41300[t]",
      chosen_words(number, job.curves.size())};
  if (!job.slave_zero)
    words.insert(words.begin() + 2,
                 std::string("the squareness is in them: do not ") +
                     (job.volume ? "enter it elsewhere too"
                                 : "shift the zero of a gantry's second side too"));
  for (std::string& line : controllers::set_words(job)) words.push_back(std::move(line));
  std::string out = "%_N_NC_CEC_INI\nCHANDATA(1)\n" + controllers::comments(words, "; ");
  for (const CrossCurve& curve : job.curves) out += table(curve, number++, name);
  return out + "M17\n";
}

void note_enabling(const CrossJob& job, const std::vector<controllers::KnownAxis>& axes,
                   std::vector<Remark>& notes) {
  const Remark note{job.volume       ? "siemens.cross-volume"
                    : job.slave_zero ? "siemens.cross-straight"
                                     : "siemens.cross",
                    {},
                    {{"axes", outputs(job, axes)}}};
  if (notes.empty() || notes.back().id != note.id || notes.back().texts != note.texts)
    notes.push_back(note);
}

}  // namespace

Expected<void> free_tables(std::int64_t first, std::size_t count, const Settings& options) {
  const std::int64_t last = first + static_cast<std::int64_t>(count) - 1;
  for (const auto& [low, high] : controllers::ranges_of(options.texts("taken")))
    if (low <= last && first <= high)
      return fail("CEC tables " + std::to_string(first) + " to " + std::to_string(last) +
                  " would meet those in use (" + std::to_string(low) + " to " +
                  std::to_string(high) + "): set first_cec_table, or use nonio table insert");
  return {};
}

std::string chosen_words(std::int64_t first, std::size_t count) {
  return "CHOSEN, not read from a backup: CEC tables " + std::to_string(first) + " to " +
         std::to_string(first + static_cast<std::int64_t>(count) - 1) +
         "; where the control has others there, load a file of nonio table insert instead";
}

void note_chosen(const std::string& axis, std::int64_t first, std::size_t count,
                 OutputResult& result) {
  const std::int64_t last = first + static_cast<std::int64_t>(count) - 1;
  result.notes.push_back(
      {"table.numbers-chosen",
       {},
       {{"axis", axis}, {"numbers", std::to_string(first) + "-" + std::to_string(last)}}});
}

Expected<void> write_cross_tables(const ControllerInput& input,
                                  const std::vector<controllers::AxisJob>& pitch,
                                  OutputResult& result) {
  const Campaign campaign = controllers::with_axes_of(input, pitch);
  const auto axes = controllers::known_axes({{}, campaign, input.options});
  if (!axes) return tl::unexpected<Error>(axes.error());
  const Naming name{*axes, input.options.flag("quoted_axes")};
  std::int64_t first = input.options.integer("first_cec_table");
  if (input.options.flag("directions")) {
    std::size_t most = input.campaign.machine.axes.size();
    for (const controllers::KnownAxis& axis : *axes) most = std::max(most, axis.number);
    first += 2 * static_cast<std::int64_t>(most);
  }

  const auto jobs = controllers::cross_jobs(input, controllers::SecondSide::own_table, result);
  std::vector<Remark> enabling;
  for (const CrossJob& job : jobs) {
    if (auto ok = controllers::fits(job, input.options); !ok) return ok;
    if (controllers::lacks_number(job.moving(), input, *axes, job.measurement, result)) continue;
    if (controllers::oversized(job, input, result)) continue;
    if (auto free = free_tables(first, job.curves.size(), input.options); !free)
      return fail("diagonals of " + job.measurement + ": " + free.error().message);
    const std::string stem = "siemens-840d-" + controllers::file_part(job.axes()) +
                             (jobs.size() > 1 ? "-" + controllers::file_part(job.measurement) : "");
    Artifact file{stem + "-CEC.ini", file_text(job, input, first, name)};
    if (auto done = controllers::predict_cross(job, {file}, parse, pitch, input, result); !done)
      return done;
    result.artifacts.push_back(std::move(file));
    note_chosen(job.axes(), first, job.curves.size(), result);
    note_enabling(job, *axes, enabling);
  }
  result.notes.insert(result.notes.end(), enabling.begin(), enabling.end());
  return {};
}

}  // namespace nonio::siemens_840d
