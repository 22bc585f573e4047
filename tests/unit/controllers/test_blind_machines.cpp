// SPDX-License-Identifier: Apache-2.0
//
// A machine that nobody knows (any curve, reversal, zero of the instrument, backlash already on,
// one axis of several, from minus to plus, a turn) is measured; its control, as models.h has it,
// loads the table: what is left is what was predicted, and the table is zero where it says.
//   NONIO_MACHINES=1000 test_controllers --gtest_filter='BlindMachines.*'
#include <cstdlib>
#include <numbers>

#include "models.h"

using namespace workshop;

namespace {

struct Kind {
  const char* name;
  const char* path;
  Options options;
  double step, step_deg;  ///< of an entry: m, rad; 0: takes no rotary axis
  models::Control (*control)(const models::Files&, const models::Axis&);
  bool from_zero = false;  ///< counts from its own zero
  bool below = false;      ///< and lies below it
  std::string more{};      ///< of option axes
};

std::vector<Kind> kinds() {
  using models::Axis;
  using models::Files;
  const Options error{{"sign", std::string("error")}}, of{};
  const double deg_4 = 1e-4 * deg;
  return {{"siemens-840d", plugin_siemens_840d, of, 1e-9, 1e-6 * deg, models::siemens},
          {"heidenhain-tnc", plugin_heidenhain_tnc, of, 1e-7, deg_4, models::heidenhain},
          {"fanuc", plugin_fanuc, {{"extended", true}}, 1e-6, 1e-3 * deg, models::fanuc},
          {"linuxcnc 0", plugin_linuxcnc, of, 1e-11, 1e-8 * deg,
           [](const Files& f, const Axis& a) { return models::linuxcnc(f, a, false); }},
          {"linuxcnc 1",
           plugin_linuxcnc,
           {{"type", std::int64_t{1}}},
           1e-11,
           1e-8 * deg,
           [](const Files& f, const Axis& a) { return models::linuxcnc(f, a, true); }},
          {"twincat-cnc", plugin_twincat_cnc, of, 1e-7, deg_4, models::twincat_cnc},
          {"twincat-nc-ptp", plugin_twincat_nc_ptp, of, 1e-9, 1e-6 * deg, models::twincat_nc_ptp},
          {"twincat-volumetric", plugin_twincat_volumetric, error, 1e-9, 0.0, models::volumetric},
          {"fagor-8055", plugin_fagor_8055, error, 1e-7, deg_4,
           [](const Files& f, const Axis& a) { return models::list(f, a, -1.0, a.unit()); }},
          {"haas-classic",
           plugin_haas_classic,
           {{"sign", std::string("correction")}},
           2.54e-6,
           0.0,
           [](const Files& f, const Axis& a) { return models::list(f, a, 1.0, 25.4 * mm); },
           true,
           true},
          {"mitsubishi", plugin_mitsubishi, of, 0.5e-6, 0.0, models::mitsubishi},
          {"pmac", plugin_pmac, of, 1e-3 / 16 / 2000, deg / 16 / 2000,
           [](const Files& f, const Axis& a) { return models::pmac(f, a, 2000.0); }, true, false,
           " counts_per_mm=2000 counts_per_deg=2000"},
          {"aerotech", plugin_aerotech, of, 1e-9, 1e-6 * deg, models::aerotech, true},
          {"ecmc", plugin_ecmc, of, 1e-9, 1e-6 * deg, models::ecmc}};
}

/// A machine, and what was on while it was measured.
struct Blind {
  Measured measured;
  models::Axis axis;
  double backlash = 0.0;  ///< already in the control
  std::string settings;   ///< of option axes
};

Blind random_linear(std::mt19937& random, const Kind& k) {
  std::uniform_real_distribution<double> u(-1.0, 1.0);
  std::uniform_int_distribution<int> points(5, 25), wide(1, 6), third(0, 2);
  Blind b;
  const int n = points(random);
  const double step = k.below ? 12.7 * mm : wide(random) * 10 * mm;
  const int below = k.below ? n - 1 : static_cast<int>((n - 1) * (0.5 + 0.5 * u(random)));
  b.measured.targets = even(-step * below, step, n);
  b.measured.plus = random_curve(random, step * n, 8 * um);
  const int at = third(random) == 0 || k.from_zero
                     ? below
                     : static_cast<int>((n - 1) * (0.5 + 0.5 * u(random)));
  b.axis.reference = step * (at - below);
  return b;
}

Blind random_turn(std::mt19937& random, const Kind&) {
  std::uniform_real_distribution<double> u(-1.0, 1.0);
  std::uniform_int_distribution<int> end(0, 1), start(0, 1);
  Blind b;
  b.axis.rotary = true;
  b.measured.rotary = true;
  b.measured.targets = even(start(random) == 0 ? 0.0 : -180 * deg, 15 * deg, 24 + end(random));
  const double a = 8 * arcsec * u(random), p = 3 * u(random), c = 3 * arcsec * u(random);
  b.measured.plus = [=](double x) { return a * std::sin(x + p) + c * std::cos(3 * x); };
  return b;
}

Blind random_machine(std::mt19937& random, const Kind& k) {
  std::uniform_real_distribution<double> u(-1.0, 1.0);
  std::uniform_int_distribution<int> third(0, 2), which(0, 2);
  const bool turn = k.step_deg > 0.0 && third(random) == 0;
  Blind b = turn ? random_turn(random, k) : random_linear(random, k);
  // An instrument is zero anywhere: 50 mm and 50 deg are no errors.
  const double size = turn ? arcsec : um, zero = third(random) * 50.14 * b.axis.unit() * u(random);
  b.backlash = third(random) == 0 ? 5 * size * (1 + u(random)) : 0.0;
  const double reversal = size * (3 + 3 * u(random));  // that is left
  b.measured.minus = [e = b.measured.plus, zero, reversal](double x) {
    return e(x) + zero + reversal;
  };
  b.measured.plus = [e = b.measured.plus, zero](double x) { return e(x) + zero; };
  const int place = which(random);
  b.axis.name = turn ? "C" : std::string(1, static_cast<char>('X' + place));
  b.axis.number = place + 13;
  b.measured.axis = b.measured.id = b.axis.name;
  const std::string unit = turn ? "_deg=" : "_mm=";
  const auto text = [&](double v) { return std::to_string(v / b.axis.unit()); };
  b.backlash = std::stod(text(b.backlash)) * b.axis.unit();
  b.settings = b.axis.name + " number=" + std::to_string(b.axis.number) + " backlash" + unit +
               text(b.backlash) + k.more;
  if (!k.from_zero && !turn) b.settings += " reference" + unit + text(b.axis.reference);
  return b;
}

/// The range of what is left at the targets, of both directions, as the machine truly is: the
/// readings were made with the old backlash value, and the new one takes its place.
math::MeanDeviations left(const Blind& b, const math::ErrorCurve& curve,
                          const models::Control& control) {
  math::MeanDeviations out;
  for (const double x : curve.position)
    for (const bool up : {true, false}) {
      const double motor =
          x + control.added(x, up, b.backlash) + (up ? -b.backlash : b.backlash) / 2.0;
      const auto& e = up ? curve.plus : curve.minus;
      (up ? out.plus : out.minus)
          .push_back(motor - x + math::ErrorCurve::at(curve.position, e, motor));
    }
  return out;
}

int failures() {
  return testing::UnitTest::GetInstance()->current_test_info()->result()->total_part_count();
}

int machines() {
  const char* wish = std::getenv("NONIO_MACHINES");
  return wish == nullptr ? 60 : std::atoi(wish);
}

/// What it makes that a table is looked up with the reading, which is c further on than the target:
/// c times the slope, of the second order.
double of_reading(const models::Control& control, const math::ErrorCurve& curve) {
  double largest = 0.0, slope = 0.0;
  for (std::size_t i = 0; control.of_reading && i < curve.position.size(); ++i) {
    largest = std::max(largest, std::fabs(control.of_tables(curve.position[i], true)));
    if (i > 0)
      slope = std::max(slope, std::fabs(curve.mean[i] - curve.mean[i - 1]) /
                                  (curve.position[i] - curve.position[i - 1]));
  }
  return 2.0 * largest * slope;
}

void judge(const Kind& k, const Blind& b, const Bench& bench, const OutputResult& r,
           const std::string& who) {
  const auto curve = curve_of(bench, bench.observations.size() - 1);
  const models::Control control = k.control(r.artifacts, b.axis);
  const auto truth = left(b, curve, control);
  const double half =
      (b.axis.rotary ? k.step_deg : k.step) / 2 + 2e-10 + of_reading(control, curve);
  const double found[] = {truth.E(), truth.B(), truth.M()};
  for (int i = 0; i < 3; ++i) {
    const char* name[] = {"E", "B", "M"};
    EXPECT_NEAR(prediction(r, name[i]).after, found[i], half) << who << name[i];
  }
  // Zero where it says, of the mean of both columns; no constant of the instrument is left in it.
  const double at = b.axis.rotary ? 0.0 : b.axis.reference;
  const double zero = (control.of_tables(at, true) + control.of_tables(at, false)) / 2;
  EXPECT_NEAR(zero, 0.0, half) << who;
  for (const double x : curve.position)
    EXPECT_LE(std::fabs(control.of_tables(x, true)),
              prediction(r, "E").before + b.backlash + 2 * half)
        << who << x;
}

}  // namespace

TEST(BlindMachines, WhatIsLeftIsWhatWasPredicted) {
  const std::uint32_t seed = 20261122;
  print_seed(seed);
  for (const Kind& k : kinds()) {
    const Output output = plugin(k.path);
    std::mt19937 random(seed);
    int written = 0;
    const int so_far = failures();
    const int rounds = machines();
    for (int round = 0; round < rounds && failures() == so_far; ++round) {
      const Blind b = random_machine(random, k);
      Bench bench;
      for (const char* other : {"A", "X", "Y", "Z", "C"})
        bench.campaign.machine.axes.push_back(
            {.name = other, .rotary = *other == 'A' || *other == 'C'});
      bench.add(b.measured);
      Options options = k.options;
      options["axes"] = std::vector<std::string>{b.settings};
      const std::string who = std::string(k.name) + ", seed " + std::to_string(seed) + ", round " +
                              std::to_string(round) + ", " + b.settings + ": ";
      const auto r = bench.write(output, options);
      ASSERT_TRUE(r) << who << r.error().message;
      if (r->artifacts.empty()) continue;
      ++written;
      judge(k, b, bench, *r, who);
    }
    std::cout << k.name << ": " << written << " of " << rounds << " machines\n";
    EXPECT_TRUE(failures() > so_far || written >= rounds * 9 / 10) << k.name;
  }
}
