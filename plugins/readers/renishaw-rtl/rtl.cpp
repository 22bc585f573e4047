// SPDX-License-Identifier: Apache-2.0
#include "rtl.h"

#include <cmath>
#include <limits>

#include "nonio/sdk/fields.h"
#include "runs_of.h"

namespace nonio::renishaw {
using namespace readers;

namespace {

struct Air {
  double temperature = 0.0;  ///< degC
  double pressure = 0.0;     ///< Pa
  double humidity = 0.0;     ///< %
};

/// Half the wavelength of the laser in air, m.
///
///   lambda_vac / 2n,  lambda_vac = 632.990577 nm (the value that explains two files to 0.1 ppm)
///   (n-1)_s 1e8 = 8342.54 + 2406147/(130 - s^2) + 15998/(38.9 - s^2), s = 1/lambda_vac, 1/um
///   (n-1)_tp    = p (n-1)_s / 96095.43 (1 + 1e-8 (0.601 - 0.00972 t) p) / (1 + 0.0036610 t)
///   n           = 1 + (n-1)_tp - f (3.7345 - 0.0401 s^2) 1e-10, f: pressure of water vapor, Pa
///
/// Birch and Downs, Metrologia 30 (1993) 155 and 31 (1994) 315; f from the relative humidity by
/// Magnus' formula, 611.2 Pa exp(17.62 t / (243.12 + t)).
double half_wavelength(const Air& air) {
  constexpr double lambda = 0.632990577;  // um, vacuum
  constexpr double s2 = 1.0 / (lambda * lambda);
  const double t = air.temperature, p = air.pressure;
  const double standard = 1e-8 * (8342.54 + 2406147.0 / (130.0 - s2) + 15998.0 / (38.9 - s2));
  const double dry =
      p * standard / 96095.43 * (1.0 + 1e-8 * (0.601 - 0.00972 * t) * p) / (1.0 + 0.0036610 * t);
  const double vapour = air.humidity / 100.0 * 611.2 * std::exp(17.62 * t / (243.12 + t));
  const double n = 1.0 + dry - vapour * (3.7345 - 0.0401 * s2) * 1e-10;
  return 1e-6 * lambda / (2.0 * n);
}

constexpr double sure = 1e-6;  ///< relative; two real files agree within 0.1e-6

double mean_material(const Environment& e, bool at_end) {
  double sum = 0.0;
  for (const Environment::Pair& p : e.material) sum += at_end ? p.end : p.start;
  return sum / static_cast<double>(e.material.size());
}

/// Whether the deviations are corrected to 20 degC: 1 yes, -1 no, 0 not determinable (also for
/// NaN). If they are, env factor = (half wavelength in air)(1 - alpha (T - 20)).
int normalised(const Environment& e, bool at_end) {
  const auto at = [&](const Environment::Pair& p) { return at_end ? p.end : p.start; };
  const Air air{at(e.air), 1e3 * at(e.pressure), at(e.humidity)};
  if (!(air.pressure > 3e4 && air.pressure < 1.3e5 && air.temperature > -40.0 &&
        air.temperature < 80.0 && air.humidity >= 0.0 && air.humidity <= 100.0))
    return 0;
  const double plain = half_wavelength(air);
  const double growth = 1e-6 * at(e.expansion) * (mean_material(e, at_end) - 20.0);
  const double factor = 1e-6 * at(e.factor);
  const bool with = std::fabs(factor / (plain * (1.0 - growth)) - 1.0) <= sure;
  const bool without = std::fabs(factor / plain - 1.0) <= sure;
  return with && !without ? 1 : without && !with ? -1 : 0;
}

/// The file contains no values between both ends.
void put_ends(std::vector<double>& column, std::size_t n, double start, double end) {
  if (!std::isfinite(start) || !std::isfinite(end) || n < 2) return;
  column.assign(n, std::numeric_limits<double>::quiet_NaN());
  column.front() = start;
  column.back() = end;
}

void add_environment(const Environment& e, const Axis& axis, Observations& obs) {
  const std::size_t n = obs.size();
  put_ends(obs.air, n, e.air.start, e.air.end);
  put_ends(obs.pressure, n, 10.0 * e.pressure.start, 10.0 * e.pressure.end);
  put_ends(obs.humidity, n, e.humidity.start, e.humidity.end);
  const bool sensor = !e.material.empty();
  if (sensor) put_ends(obs.material, n, mean_material(e, false), mean_material(e, true));
  if (e.unconnected > 0)
    obs.notes.push_back(
        {"renishaw.sensors",
         {counted("connected", e.material.size()), counted("unconnected", e.unconnected)}});
  const Number alpha{"expansion", 1e-6 * e.expansion.start, Quantity::expansion};
  const int at_start = sensor ? normalised(e, false) : 0, at_end = sensor ? normalised(e, true) : 0;
  if (at_start != at_end || at_start == 0)
    obs.notes.push_back({"renishaw.normalised-unclear"});
  else
    obs.notes.push_back(
        {at_start > 0 ? "renishaw.normalised" : "renishaw.not-normalised", {alpha}});
  if (!axis.expansion) return;
  // 1/K. Published coefficients of one material differ by less than `other_material`. A coefficient
  // of 0, or one that was not applied, does not affect the deviations.
  constexpr double other_material = 1e-6, same = 0.05e-6;
  const double apart = std::fabs(*axis.expansion - alpha.value);
  const Number stated{"manifest", *axis.expansion, Quantity::expansion};
  if (apart > other_material && alpha.value != 0.0 && (at_start != at_end || at_start >= 0))
    obs.doubts.push_back(
        {.id = "plausibility.other-expansion", .attention = true, .evidence = {alpha, stated}});
  else if (apart > same)
    obs.notes.push_back({"renishaw.other-expansion", {alpha, stated}});
}

Expected<Observations> in_file(Expected<Observations> result, const ReadInput& input) {
  if (!result && result.error().file.empty() && result.error().key.empty())
    result.error().file = input.measurement.file;
  return result;
}

Expected<Observations> read_rtl(const ReadInput& input) {
  NONIO_TRY(const auto axis, axis_of(input));
  if (axis->rotary)
    return fail("expected a linear axis for linear measurements, found the rotary axis \"" +
                axis->name + "\"");
  const auto file = parse_run_file(input.bytes, "rtl", "Linear");
  if (!file) return in_file(fail(file.error()), input);
  Runs runs(input, *axis, false);
  if (auto ok = add_runs(*file, Units{}, runs); !ok) return in_file(fail(ok.error()), input);
  auto obs = runs.finish();
  if (!obs) return in_file(std::move(obs), input);
  if (auto ok = add_user_text(*file, input, *obs); !ok) return in_file(fail(ok.error()), input);
  if (file->environment) add_environment(*file->environment, *axis, *obs);
  return obs;
}

/// Recognizes all types of this family except rta, so that the error can name the type.
bool recognises(std::string_view head) {
  head = without_mark(head);
  return trimmed(head.substr(0, head.find_first_of("\r\n"))) == "HEADER::" && !is_type(head, "rta");
}

}  // namespace

Reader rtl_reader() {
  Reader reader;
  reader.info = {
      "renishaw-rtl",
      "1.0",
      "Linear measurements of Renishaw laser interferometers (.rtl).",
      {code_page_option(),
       {"ignore_axis", false, "",
        "The axis that the operator typed into the file is wrong; the manifest's holds."}}};
  reader.recognises = recognises;
  reader.reads = [](std::string_view kind) { return kind == "axis"; };
  reader.read = read_rtl;
  return reader;
}

}  // namespace nonio::renishaw
