// SPDX-License-Identifier: Apache-2.0
#include "shop.h"

#include <cmath>

namespace nonio::coverage {
namespace {

constexpr double mm = 1e-3, alpha = 11.5e-6;

}  // namespace

const std::vector<Scenario>& scenarios() {
  using W = Warmth;
  using S = Sensors;
  using C = Course;
  // name, m; laser; misalignment; sensor, from 20 degC, coefficient; drift; approach; ball, probe
  static const std::vector<Scenario> all{
      {"small machine, good laser", 0.5, 0.2, 0.5, 0.3, 0.1, 0.5, 1.0, 0.3, 0.3},
      {"large machine, poor temperature", 10, 0.2, 0.6, 2.0, 0.6, 4.0, 2.0, 5.0, 2.0, 1.0, 1.0,
       W::day_and_night, S::anew, C::linear},
      {"short artefact, ball probe", 0.3, 1.0, 1.0, 0.2, 0.3, 2.0, 2.0, 0.8, 0.5, 1.5, 1.5,
       W::steady, S::stay, C::settling},
      {"repeatability dominates", 1.0, 0.2, 0.2, 0.1, 0.02, 0.1, 1.0, 0.2, 5.0, 0.2, 0.2},
      {"instrument dominates", 1.0, 2.0, 5.0, 0.1, 0.02, 0.1, 1.0, 0.2, 0.2, 0.2, 0.2},
      {"misalignment dominates", 1.0, 0.1, 0.1, 5.0, 0.02, 0.1, 1.0, 0.2, 0.2, 0.2, 0.2},
      {"temperature dominates, steady, sensors stay", 1.0, 0.1, 0.1, 0.1, 1.0, 4.0, 2.0, 0.2, 0.2,
       0.2, 0.2},
      {"temperature dominates, line by line", 1.0, 0.1, 0.1, 0.1, 1.0, 4.0, 2.0, 0.2, 0.2, 0.2, 0.2,
       W::day_and_night, S::anew},
      {"temperature anywhere within its limits", 1.0, 0.1, 0.1, 0.1, 0.1, 8.0, 4.0, 0.2, 0.2, 0.2,
       0.2, W::anywhere, S::stay},
      {"drift dominates, random walk", 1.0, 0.1, 0.1, 0.1, 0.02, 0.1, 1.0, 5.0, 0.2, 0.2, 0.2},
      {"drift dominates, linear", 1.0, 0.1, 0.1, 0.1, 0.02, 0.1, 1.0, 5.0, 0.2, 0.2, 0.2, W::steady,
       S::stay, C::linear},
      {"drift dominates, settling", 1.0, 0.1, 0.1, 0.1, 0.02, 0.1, 1.0, 5.0, 0.2, 0.2, 0.2,
       W::steady, S::stay, C::settling},
      {"ball and probe dominate", 1.0, 0.1, 0.1, 0.1, 0.02, 0.1, 1.0, 0.2, 0.2, 5.0, 5.0},
  };
  return all;
}

Campaign stated(const Scenario& s) {
  Campaign c;
  c.machine.structure = "gantry";
  for (const char* name : {"X", "Y", "Z"}) {
    c.machine.axes.push_back(Axis{.name = name});
    c.machine.axes.back().expansion = alpha;
  }
  c.instrument.U_fixed = s.U_fixed * um;
  c.instrument.U_per_length = s.U_per_length * um;
  c.instrument.sphere = s.sphere * um;
  c.instrument.probe = s.probe * um;
  c.environment.misalignment = s.misalignment * mm;
  c.environment.temperature_range = s.sensor;
  c.environment.temperature_difference = s.from_20;
  c.environment.expansion_range = s.expansion * um;
  c.environment.drift = s.drift * um;
  return c;
}

std::vector<Visit> there_and_back(std::size_t n, int runs) {
  std::vector<Visit> out;
  for (int run = 1; run <= runs; ++run)
    for (const int direction : {1, -1})
      for (std::size_t i = 0; i < n; ++i)
        out.push_back({direction > 0 ? i : n - 1 - i, direction, static_cast<std::uint32_t>(run)});
  return out;
}

std::vector<Visit> once(std::size_t n) {
  std::vector<Visit> out;
  for (std::size_t i = 0; i < n; ++i) out.push_back({i, 1, 1});
  return out;
}

Day::Day(const Scenario& s, unsigned seed, double size) : s_(s), rng_(seed), size_(size) {
  laser_ = normal(s.U_per_length * um / 2.0);   // its wavelength, or its scale
  material_ = uniform(s.expansion * um / 2.0);  // one material
  sensor_ = uniform(s.sensor / 2.0);
}

double Day::normal(double sigma) { return size_ * sigma * normal_(rng_); }

double Day::uniform(double half) {
  return size_ * std::uniform_real_distribution<double>(-half, half)(rng_);
}

double Day::strain() {
  const auto one_of = [&] { return rng_() % 2 == 0 ? 1.0 : -1.0; };
  const double there = s_.warmth == Warmth::steady          ? s_.from_20
                       : s_.warmth == Warmth::day_and_night ? one_of() * s_.from_20
                                                            : uniform(s_.from_20);
  const double error = s_.sensors == Sensors::stay ? sensor_ : uniform(s_.sensor / 2.0);
  return material_ * there - alpha * error;
}

double Day::shortening(double length) {
  if (length <= 0.0) return 0.0;
  // A place on a disc: the square of its radius is uniform.
  const double end = s_.misalignment * mm,
               square = end * end * std::uniform_real_distribution<double>(0.0, 1.0)(rng_);
  return -size_ * square / (2.0 * length * length);
}

std::vector<double> Day::drift(std::size_t n) {
  const double range = s_.drift * um;
  std::vector<double> out(n, 0.0);
  if (s_.course == Course::walk) {
    const double step = range / std::sqrt(3.0 * static_cast<double>(n - 1));
    for (std::size_t i = 1; i < n; ++i) out[i] = out[i - 1] + normal(step);
    return out;
  }
  const double whole = uniform(range);
  constexpr double constant = 0.3;  // of the time of a line, in which a third is left
  for (std::size_t i = 0; i < n; ++i) {
    const double t = static_cast<double>(i) / static_cast<double>(n - 1);
    out[i] = whole * (s_.course == Course::linear
                          ? t
                          : (1.0 - std::exp(-t / constant)) / (1.0 - std::exp(-1.0 / constant)));
  }
  return out;
}

std::vector<Reading> Day::measured(const Line& line, const std::vector<Visit>& visits) {
  // Cyclic and fixed errors of the instrument belong to the place; a further run has them again.
  std::vector<double> cyclic;
  for (std::size_t i = 0; i < line.mean.size(); ++i)
    cyclic.push_back(normal(s_.U_fixed * um / 2.0));
  const double growth = laser_ + strain() + shortening(line.distance.back());
  const std::vector<double> moved = drift(visits.size() + 1);
  const double real_0 = line.mean[0] + line.reversal / 2.0 + normal(s_.repeatability * um),
               seen_0 = real_0 + cyclic[0];
  std::vector<Reading> out;
  for (std::size_t v = 0; v < visits.size(); ++v) {
    const std::size_t i = visits[v].stop;
    const double real =
        line.mean[i] + visits[v].direction * line.reversal / 2.0 + normal(s_.repeatability * um);
    const double seen = real + cyclic[i] + growth * line.distance[i] + moved[v + 1];
    out.push_back({seen - seen_0, real - real_0});
  }
  return out;
}

Day::Coordinate Day::coordinate(std::size_t n) {
  Coordinate c;
  // Radius of ball and tip where only one side is touched, and the probe's own asymmetry.
  c.offset = normal(s_.U_fixed * um / 2.0) + uniform(s_.probe * um / 2.0);
  c.stretch = normal(s_.U_per_length * um / 2.0) + strain();  // the scale of this axis
  c.drift = drift(n);
  return c;
}

double Day::touch() { return uniform(s_.sphere * um / 2.0) + normal(s_.repeatability * um); }

}  // namespace nonio::coverage
