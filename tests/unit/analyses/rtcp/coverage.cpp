// SPDX-License-Identifier: Apache-2.0
//
// How often U covers the truth: campaigns of a machine that turns by quaternions, with linear axes
// out of square, drift, a gauge or probe with an error of its own, and a ball that is not where the
// control has it.
//
//     rtcp_coverage TRIALS SEED        status 1 outside 94 to 96 % by more than chance
#include <cstdio>
#include <cstdlib>
#include <map>
#include <random>

#include "machine.h"

namespace nonio::rtcp_test {
namespace {

constexpr double U_fixed = 1.0 * um, drift = 1.0 * um, bound = 4.0 * urad, scatter = 0.8 * um;

class Day {
 public:
  explicit Day(unsigned seed) : engine_(seed) {}
  double normal() { return normal_(engine_); }
  double uniform(double half) { return half * (2.0 * uniform_(engine_) - 1.0); }
  /// One reading after the other of `n`: scatter, the instrument, and a walk whose end has the
  /// standard deviation of the drift.
  double reading(std::size_t n) {
    walk_ += drift / std::numbers::sqrt3 / std::sqrt(static_cast<double>(n - 1)) * normal();
    return scatter * normal() + walk_;
  }
  void fresh() { walk_ = 0.0; }

 private:
  std::mt19937_64 engine_;
  std::normal_distribution<double> normal_;
  std::uniform_real_distribution<double> uniform_{0.0, 1.0};
  double walk_ = 0.0;
};

Machine machine_of(Day& day, bool head) {
  Machine m;
  m.head = head;
  m.true_centre += Vector(day.uniform(60 * um), day.uniform(60 * um), 0.0);
  m.true_direction = Vector(day.uniform(300 * urad), day.uniform(300 * urad), 1.0).normalized();
  for (const auto& [i, k] : {std::pair{0, 1}, {0, 2}, {1, 2}, {0, 0}, {1, 1}, {2, 2}})
    m.linear(i, k) = day.uniform(bound);
  return m;
}

using Share = std::map<std::string, std::pair<int, int>>;

void put(const Evaluation& e, const Machine& m, double height, Share& share) {
  const double per = 1.0 / m.true_direction[2];
  const std::map<std::string, double> truth{
      {"centre_error_x", m.true_centre[0] - m.centre[0] + height * m.true_direction[0] * per},
      {"centre_error_y", m.true_centre[1] - m.centre[1] + height * m.true_direction[1] * per},
      {"direction_error_i", m.true_direction[0]},
      {"direction_error_j", m.true_direction[1]}};
  for (const auto& [name, is] : truth) {
    const Value* v = value(e, name);
    if (v == nullptr || !v->U) continue;
    auto& [in, all] = share[name];
    in += std::fabs(v->value - is) <= *v->U;
    ++all;
  }
}

/// Gauges that turn with the table, on two heights along the radius and one along the axis.
Share turning(int trials, unsigned seed, int n, double arc, double U_gauge = U_fixed) {
  Share share;
  for (int t = 0; t < trials; ++t) {
    Day day(seed + 7919U * static_cast<unsigned>(t));
    const Machine m = machine_of(day, false);
    const Vector low = m.centre + Vector(0.15, 0.0, -0.1), high = low + Vector(0, 0, 0.2);
    const auto at = angles(n, arc);
    std::size_t count = 0;
    const auto noise = [&] {
      if (count++ % at.size() == 0) day.fresh();
      return day.reading(at.size());
    };
    const auto line = [&](const Vector& ball, const Vector& sense) {
      return Line{ball, sense, true, Vector(day.uniform(50 * um), day.uniform(50 * um), 0.0),
                  day.uniform(20 * um)};
    };
    Workshop shop;
    shop.stated(U_gauge, drift, bound / urad).with("tolerance_um", 1e5).with("tolerance_urad", 1e5);
    shop.measured(gauges(
        m, {line(low, Vector::UnitX()), line(high, Vector::UnitX()), line(low, Vector::UnitZ())},
        at, noise));
    if (const auto e = shop.last()) put(*e, m, 0.0, share);
  }
  return share;
}

/// One fixed gauge, on the ball of a head whose place is known within U.
Share standing(int trials, unsigned seed, int n) {
  Share share;
  for (int t = 0; t < trials; ++t) {
    Day day(seed + 7919U * static_cast<unsigned>(t));
    Machine m = machine_of(day, true);
    m.true_direction = Vector::UnitZ();
    const auto at = angles(n);
    std::size_t count = 0;
    const auto noise = [&] {
      if (count++ % at.size() == 0) day.fresh();
      return day.reading(at.size());
    };
    const Vector tip = m.centre + Vector(0.2, 0.0, 0.0),
                 offset = 2 * um * Vector(day.normal(), day.normal(), day.normal());
    Workshop shop(true);
    shop.stated(U_fixed, drift, bound / urad).with("ball_um", 4.0).with("tolerance_um", 1e5);
    shop.measured(
        gauges(m, {{tip, Vector::UnitX(), false, offset, day.uniform(20 * um)}}, at, noise));
    if (const auto e = shop.last()) put(*e, m, 0.0, share);
  }
  return share;
}

/// A probe that finds the whole centre of one ball.
Share probing(int trials, unsigned seed, int n) {
  Share share;
  for (int t = 0; t < trials; ++t) {
    Day day(seed + 7919U * static_cast<unsigned>(t));
    Machine m = machine_of(day, false);
    m.about += Vector(0, 0, 0.1);  // at the height of the ball
    std::vector<double> walk(3, 0.0);
    std::size_t count = 0;
    const double step = drift / std::numbers::sqrt3 / std::sqrt(static_cast<double>(n - 1));
    const auto noise = [&] {
      double& w = walk[count++ % 3];
      w += step * day.normal();
      return scatter * day.normal() + w + day.uniform(U_fixed / 2.0);
    };
    Vector zero;  // the probe's own, and the instrument's: the same for a coordinate
    for (int k = 0; k < 3; ++k) zero[k] = day.uniform(U_fixed / 2.0) + U_fixed / 2.0 * day.normal();
    const Line ball{m.centre + Vector(0.15, 0.0, 0.1), Vector::UnitX(), false,
                    Vector(day.uniform(50 * um), day.uniform(50 * um), day.uniform(50 * um))};
    Workshop shop;
    shop.stated(U_fixed, drift, bound / urad).with("tolerance_um", 1e5).with("tolerance_urad", 1e5);
    shop.measured(probe(m, {ball}, angles(n), zero, noise));
    if (const auto e = shop.last()) put(*e, m, 0.1, share);
  }
  return share;
}

int told(const char* name, const Share& shares, int trials, double most = 96.0) {
  int bad = 0;
  if (shares.empty()) bad = 1;
  const double chance = 196.0 * std::sqrt(0.05 * 0.95 / trials);
  for (const auto& [value, share] : shares) {
    const double percent = 100.0 * share.first / share.second;
    const bool out = percent < 94.0 - chance || percent > most + chance || share.second != trials;
    std::printf("%-40s %-18s %6.2f %% of %d%s\n", name, value.c_str(), percent, share.second,
                out ? "  OUT" : "");
    bad += out;
  }
  return bad;
}

}  // namespace
}  // namespace nonio::rtcp_test

int main(int argc, char** argv) {
  using namespace nonio::rtcp_test;
  const int trials = argc > 1 ? std::atoi(argv[1]) : 2000;
  const auto seed = static_cast<unsigned>(argc > 2 ? std::atoi(argv[2]) : 20261125);
  std::printf("%d campaigns, seed %u\n", trials, seed);
  int bad = 0;
  bad += told("three gauges that turn, 12 places", turning(trials, seed, 12, 6.29), trials);
  // Of what each reading has for itself the larger of stated and found counts.
  bad += told("the same, gauge as bad as its scatter", turning(trials, seed, 12, 6.29, 1.5 * um),
              trials, 98.0);
  bad += told("three gauges that turn, 13 on 180 deg",
              turning(trials, seed + 1, 13, std::numbers::pi), trials);
  bad += told("a gauge that stands, head, 24 places", standing(trials, seed + 2, 24), trials);
  bad += told("a probe on one ball, 12 places", probing(trials, seed + 3, 12), trials);
  return bad == 0 ? 0 : 1;
}
