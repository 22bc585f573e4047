// SPDX-License-Identifier: Apache-2.0
#include "rta.h"

#include <map>

#include "runs_of.h"

namespace nonio::renishaw {
using namespace readers;

namespace {

/// Angle in rad per unit of the file.
const std::map<std::string, double, std::less<>>& value_units() {
  static const std::map<std::string, double, std::less<>> units{
      {"mrad", 1e-3}, {"urad", 1e-6}, {"arcsec", 1.0 / arcsec_per_rad}, {"deg", 1.0 / deg_per_rad}};
  return units;
}

/// The user must state the units, because no specification of the format is known.
Expected<Units> confirmed(const Settings& options, bool rotary) {
  const auto unit = value_units().find(options.text("unit"));
  if (unit == value_units().end())
    return fail(
        of_option("unit",
                  "expected the unit of the angles in this file, mrad, urad, arcsec or deg; "
                  "found none. One program takes them as mrad; compare one value with what "
                  "the instrument's program shows"));
  const std::string sign = options.text("sign");
  if (sign != "+" && sign != "-")
    return fail(
        of_option("sign",
                  "expected + (positive values are right-handed turns about the axis, or too "
                  "far towards plus on a rotary axis) or -; found none"));
  return Units{rotary ? 1.0 / deg_per_rad : 1e-3, sign == "+" ? unit->second : -unit->second};
}

Expected<Observations> read(const ReadInput& input) {
  NONIO_TRY(const auto axis, axis_of(input));
  if (axis->rotary == (input.measurement.kind == "angle"))
    return fail(
        "expected a rotary axis for kind axis, or a linear one for kind angle, found axis \"" +
        axis->name + "\" with kind " + input.measurement.kind);
  const auto in_file = [&](Error error) {
    error.file = input.measurement.file;
    return fail(std::move(error));
  };
  NONIO_TRY(const auto units, confirmed(input.options, axis->rotary));
  const auto file = parse_run_file(input.bytes, "rta", "");
  if (!file) return in_file(file.error());
  Runs runs(input, *axis, true);
  if (auto ok = add_runs(*file, units, runs); !ok) return in_file(ok.error());
  auto obs = runs.finish();
  if (!obs) return in_file(obs.error());
  if (auto ok = add_user_text(*file, input, *obs); !ok) return in_file(ok.error());
  return obs;
}

}  // namespace

Reader rta_reader() {
  Reader reader;
  reader.info = {
      "renishaw-rta",
      "1.0",
      "Angular measurements of Renishaw laser interferometers (.rta), with a unit that the user "
      "confirms.",
      {one_of({"", "mrad", "urad", "arcsec", "deg"},
              {"unit", std::string(), "", "Unit of the values in the file."}),
       one_of({"", "+", "-"}, {"sign", std::string(), "",
                               "+: a positive value is a right-handed turn (kind angle), or too "
                               "far towards plus (rotary)."}),
       code_page_option(),
       {"ignore_axis", false, "",
        "The axis that the operator typed into the file is wrong; the manifest's holds."}}};
  reader.recognises = [](std::string_view head) { return is_type(head, "rta"); };
  reader.reads = [](std::string_view kind) { return kind == "axis" || kind == "angle"; };
  reader.read = read;
  return reader;
}

}  // namespace nonio::renishaw
