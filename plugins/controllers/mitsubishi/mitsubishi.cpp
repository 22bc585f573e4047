// SPDX-License-Identifier: Apache-2.0
#include <cmath>

#include "nonio/controllers/list.h"

namespace nonio::mitsubishi {
namespace {

using Confidence = ControlTable::Confidence;
using controllers::Sheet;

// Incremental system: (nominal - actual length of the interval) x 2, equal in both directions from
// the reference position. This is the negative change of the error in units of 0.5 um.
ControlTable declared() {
  ControlTable t;
  t.name = "machine error data";
  t.sign = ControlTable::Sign::correction;
  t.entry = ControlTable::Entry::increment;
  t.zero = ControlTable::Zero::reference;
  t.position_step = {1e-6, 1e-3 / deg_per_rad};
  t.value_unit = t.value_step = {0.5e-6, 1.0};
  t.points = 1024;
  t.increment = {-128, 127};
  t.rotary = false;
  t.facts = {{"unit", Confidence::inferred, "Inferred: a unit of output is half a micrometre."},
             {"models", Confidence::unsure,
              "Unsure: documented for C64 and E68; M700 and M800 are taken to be like them, and "
              "which parameters hold the numbers must be read in the machine's manual."}};
  return t;
}

ControlTable scaled(const Settings& o) {  // entries are pulses times the scale factor
  ControlTable t = *controllers::chosen(declared(), o);
  t.value_unit.linear = t.value_step.linear = 0.5e-6 * static_cast<double>(o.integer("scale", 1));
  return t;
}

// Point k > 0 applies to the interval that ends at it, point k < 0 to the one that begins at it.
Expected<std::vector<Artifact>> files(const Sheet& s) {
  std::string out = controllers::comments(s.words(), "# ") + "# point interval_mm number\n";
  const std::int64_t zero = std::llround((s.reference - s.grid.first) / s.grid.step);
  for (std::int64_t i = 0; i < static_cast<std::int64_t>(s.plus_steps.size()); ++i)
    out += std::to_string(i < zero ? i - zero : i - zero + 1) + " " +
           controllers::decimal(s.grid.step * 1e3, 4) + " " +
           std::to_string(s.plus_steps[static_cast<std::size_t>(i)]) + "\n";
  return std::vector<Artifact>{{"mitsubishi-" + s.job.stem + ".txt", out}};
}

Expected<std::vector<LoadedTable>> parse(const TableInput& in) {
  const auto take = [](std::string_view line, controllers::RawTable& raw) -> Expected<bool> {
    if (line.empty() || line.front() == '#') return false;
    const auto w = controllers::words_of(line);
    const auto k = controllers::whole(w.front());
    const auto step = controllers::real(w.size() == 3 ? w[1] : "");
    const auto number = controllers::whole(w.size() == 3 ? w[2] : "");
    if (!k || *k == 0 || !step || !(*step > 0.0) || !number || *number < -128 || *number > 127)
      return controllers::no_point(line);
    const double zero = raw.axis.position_setting("reference").value_or(0.0) * 1e3;
    const double from = static_cast<double>(*k > 0 ? *k - 1 : *k);
    if (raw.position.empty()) raw.position = {zero + from * *step}, raw.plus = {0.0};
    if (*k == -1) raw.reference = raw.plus.size();
    raw.position.push_back(zero + (from + 1.0) * *step);
    raw.plus.push_back(static_cast<double>(*number));
    return true;
  };
  return controllers::parse_files(in, scaled(in.options), "mitsubishi", take);
}

Expected<OutputResult> write(const ControllerInput& in) {
  return controllers::write_tables(in,
                                   {.name = "mitsubishi",
                                    .table = scaled(in.options),
                                    .keys = {"step", "reference", "backlash"},
                                    .files = files,
                                    .parse = parse,
                                    .coarser = {"scale", in.options.integer("scale", 1), 99, ""}});
}

}  // namespace

NONIO_PLUGIN(registry) {
  registry.add(controllers::controller(
      {"mitsubishi", "1.0.0",
       "Incremental machine error compensation of Mitsubishi C64 and E68, as a list.",
       controllers::table_options(
           declared(), "step_mm, reference_mm, backlash_mm",
           {within(1.0, 99.0, {"scale", std::int64_t{1}, "", "Compensation scale factor."})})},
      declared(), write, parse));
}

}  // namespace nonio::mitsubishi
