// SPDX-License-Identifier: Apache-2.0
//
// A random machine (any curve, reversal, zero of the instrument, backlash already active, one axis
// of several, from minus to plus, a turn) is measured, and its control, simulated by models.h, loads
// the table: the remaining error is the predicted one, and the table is zero where it states so.
//   NONIO_MACHINES=1000 test_controllers --gtest_filter='BlindMachines.*'
//
// The same with an active table of another curve during the measurement: the engine removes its
// effect from the readings (active_compensation), and the new table replaces it.
#include <cstdlib>
#include <numbers>

#include "campaign/tables/table_check.h"
#include "models.h"

namespace blind_machines_test {

using namespace workshop;

namespace {

struct Kind {
  const char* name;
  const char* plugin;
  Options options;
  double step, step_deg;  ///< of an entry: m, rad; 0: takes no rotary axis
  models::Control (*control)(const models::Files&, const models::Axis&);
  bool from_zero = false;  ///< counts from its own zero
  bool below = false;      ///< and is below it
  std::string more{};      ///< of option axes
};

std::vector<Kind> kinds() {
  using models::Axis;
  using models::Files;
  const Options error{{"sign", std::string("error")}}, of{};
  const double deg_4 = 1e-4 * deg;
  return {{"siemens-840d", "siemens-840d", of, 1e-9, 1e-6 * deg, models::siemens},
          {"heidenhain-tnc", "heidenhain-tnc", of, 1e-7, deg_4, models::heidenhain},
          {"fanuc", "fanuc", {{"extended", true}}, 1e-6, 1e-3 * deg, models::fanuc},
          {"linuxcnc 0", "linuxcnc", of, 1e-11, 1e-8 * deg,
           [](const Files& f, const Axis& a) { return models::linuxcnc(f, a, false); }},
          {"linuxcnc 1",
           "linuxcnc",
           {{"type", std::int64_t{1}}},
           1e-11,
           1e-8 * deg,
           [](const Files& f, const Axis& a) { return models::linuxcnc(f, a, true); }},
          {"twincat-cnc", "twincat-cnc", of, 1e-7, deg_4, models::twincat_cnc},
          {"twincat-nc-ptp", "twincat-nc-ptp", of, 1e-9, 1e-6 * deg, models::twincat_nc_ptp},
          {"twincat-volumetric", "twincat-volumetric", error, 1e-9, 0.0, models::volumetric},
          {"fagor-8055", "fagor-8055", error, 1e-7, deg_4,
           [](const Files& f, const Axis& a) { return models::list(f, a, -1.0, a.unit()); }},
          {"haas-classic",
           "haas-classic",
           {{"sign", std::string("correction")}},
           2.54e-6,
           0.0,
           models::haas,
           true,
           true},
          {"mitsubishi", "mitsubishi", of, 0.5e-6, 0.0, models::mitsubishi},
          {"pmac", "pmac", of, 1e-3 / 16 / 2000, deg / 16 / 2000,
           [](const Files& f, const Axis& a) { return models::pmac(f, a, 2000.0); }, true, false,
           " counts_per_mm=2000 counts_per_deg=2000"},
          {"aerotech", "aerotech", of, 1e-9, 1e-6 * deg, models::aerotech, true},
          {"ecmc", "ecmc", of, 1e-9, 1e-6 * deg, models::ecmc}};
}

/// A machine, and what was on while it was measured.
struct Blind {
  Measured measured;  ///< the machine as it is, without tables and with a backlash value of 0
  models::Axis axis;
  double backlash = 0.0;  ///< already in the control
  std::string settings;   ///< of option axes, without `backlash`
  std::string stated() const {
    const std::string value = std::to_string(backlash / axis.unit());
    return settings + (axis.rotary ? " backlash_deg=" : " backlash_mm=") + value;
  }
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
  b.settings = b.axis.name + " number=" + std::to_string(b.axis.number) + k.more;
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

/// One axis of several, that of `m`.
Bench bench_of(const Measured& m) {
  Bench bench;
  for (const char* other : {"A", "X", "Y", "Z", "C"})
    bench.campaign.machine.axes.push_back({.name = other,
                                           .rotary = *other == 'A' || *other == 'C',
                                           .active_table = "",
                                           .active_backlash = 0.0});
  bench.add(m);
  return bench;
}

Options with(const Kind& k, const std::string& axes) {
  Options options = k.options;
  options["axes"] = std::vector<std::string>{axes};
  return options;
}

/// Deviations of the axis with this in the control. A reversal of the machine is in `m`; half of the
/// parameter is added in each direction, because homing takes the other half.
Measured under(const Measured& m, const models::Control& control, double present) {
  Measured out = m;
  const auto of = [&](const Curve& e, bool up) {
    return [e, up, control, present](double x) {
      const double added = control.added(x, up, present);
      return added + e(x + added);
    };
  };
  out.plus = of(m.plus, true);
  out.minus = of(m.minus, false);
  return out;
}

/// Another machine's table, or that of this one years ago: targets of its own, another curve.
Measured years_ago(std::mt19937& random, const Blind& b) {
  std::uniform_real_distribution<double> u(-1.0, 1.0);
  Measured old = b.measured;
  const double size = b.axis.rotary ? arcsec : um;
  const double a = 5 * size * u(random), p = 3 * u(random), lost = 2 * size * (1.5 + u(random));
  const double length = b.axis.rotary ? 360 * deg : old.targets.back() - old.targets.front();
  const auto more = [=](double x) { return a * std::sin(2 * std::numbers::pi * x / length + p); };
  old.plus = [e = b.measured.plus, more](double x) { return e(x) + more(x); };
  old.minus = [e = b.measured.plus, more, lost](double x) { return e(x) + more(x) + lost; };
  return old;
}

struct Renewed {
  OutputResult result{};
  models::Control control{}, old{};
  double was = 0.0;  ///< the parameter's value while measured
  Bench bench{};
};

/// The old table is loaded, the axis measured with it, and the engine writes the new one.
std::optional<Renewed> renewed(const Kind& k, const Controller& output, const Blind& b,
                               std::mt19937& random, const std::string& who) {
  const auto first = bench_of(years_ago(random, b)).write(output, with(k, b.settings));
  EXPECT_TRUE(first) << who << (first ? "" : first.error().message);
  if (!first || first->artifacts.empty()) return std::nullopt;
  Renewed r;
  r.old = k.control(first->artifacts, b.axis);
  r.was = r.old.backlash.value_or(b.backlash);
  r.bench = bench_of(under(b.measured, r.old, r.was));
  reading::ReadCampaign read;
  read.manifest.emplace();
  read.manifest->campaign = r.bench.campaign;
  read.observations = r.bench.observations;
  read.active_tables[b.axis.name] = first->artifacts;
  Blind told = b;
  told.backlash = r.was;
  const auto& told_or_read = r.old.backlash ? b.settings : told.stated();
  const auto on =
      tables::active_compensation(read, output, settings(output, with(k, told_or_read)));
  EXPECT_TRUE(on && *on) << who << (on ? "nothing was on" : on.error().message);
  if (!on || !*on) return std::nullopt;
  const Results none;
  auto second = output.write({r.bench.campaign, (*on)->readings, none, (*on)->options});
  EXPECT_TRUE(second) << who << (second ? "" : second.error().message);
  if (!second || second->artifacts.empty()) return std::nullopt;
  r.control = k.control(second->artifacts, b.axis);
  r.result = std::move(*second);
  return r;
}

/// The error of second order, what was added times the slope: tables are removed at the target, but
/// the axis has the error of its actual position.
double second_order(const Renewed& r, const math::ErrorCurve& curve) {
  double slope = 0.0, added = std::fabs(r.was);
  for (std::size_t i = 0; i < curve.position.size(); ++i)
    for (const bool up : {true, false}) {
      const double x = curve.position[i];
      added = std::max(
          {added, std::fabs(r.old.added(x, up, r.was)), std::fabs(r.control.added(x, up, r.was))});
      if (i == 0) continue;
      const double way = x - curve.position[i - 1];
      slope = std::max(
          {slope, std::fabs(curve.mean[i] - curve.mean[i - 1]) / way,
           std::fabs(r.old.of_tables(x, up) - r.old.of_tables(curve.position[i - 1], up)) / way});
    }
  return 6.0 * added * slope;
}

/// E, B and M at the targets with this in the control, as the machine truly is.
math::MeanDeviations truly(const Blind& b, const models::Control& control, double present) {
  const Measured m = under(b.measured, control, present);
  math::MeanDeviations out;
  for (const double x : m.targets) {
    out.plus.push_back(m.plus(x));
    out.minus.push_back(m.minus(x));
  }
  return out;
}

}  // namespace

TEST(BlindMachines, WhatIsLeftIsWhatWasPredicted) {
  const std::uint32_t seed = 20261122;
  print_seed(seed);
  for (const Kind& k : kinds()) {
    const Controller output = plugin(k.plugin);
    std::mt19937 random(seed);
    int written = 0;
    const int so_far = failures();
    const int rounds = machines();
    for (int round = 0; round < rounds && failures() == so_far; ++round) {
      const Blind b = random_machine(random, k);
      const Bench bench = bench_of(b.measured);
      const std::string who = std::string(k.name) + ", seed " + std::to_string(seed) + ", round " +
                              std::to_string(round) + ", " + b.stated() + ": ";
      const auto r = bench.write(output, with(k, b.stated()));
      ASSERT_TRUE(r) << who << r.error().message;
      if (r->artifacts.empty()) continue;
      ++written;
      judge(k, b, bench, *r, who);
    }
    std::cout << k.name << ": " << written << " of " << rounds << " machines\n";
    EXPECT_TRUE(failures() > so_far || written >= rounds * 9 / 10) << k.name;
  }
}

TEST(BlindMachines, WithATableAlreadyOn) {
  const std::uint32_t seed = 20261123;
  print_seed(seed);
  for (const Kind& k : kinds()) {
    const Controller output = plugin(k.plugin);
    std::mt19937 random(seed);
    int written = 0;
    const int so_far = failures();
    const int rounds = machines();
    for (int round = 0; round < rounds && failures() == so_far; ++round) {
      const Blind b = random_machine(random, k);
      const std::string who = std::string(k.name) + ", seed " + std::to_string(seed) + ", round " +
                              std::to_string(round) + ", " + b.stated() + ": ";
      const auto r = renewed(k, output, b, random, who);
      if (!r) continue;
      ++written;
      const auto truth = truly(b, r->control, r->was);
      const auto curve = curve_of(r->bench);
      const double step = b.axis.rotary ? k.step_deg : k.step;
      // The value of Ix86 that was on is read from the words, in mm or deg: it was typed in
      // rounded.
      const double typed = std::string(k.name) == "pmac" ? step / 2 : 0.0;
      const double half = step / 2 + typed + 2e-10 + second_order(*r, curve);
      const double found[] = {truth.E(), truth.B(), truth.M()};
      for (int i = 0; i < 3; ++i) {
        const char* name[] = {"E", "B", "M"};
        EXPECT_NEAR(prediction(r->result, name[i]).after, found[i], half) << who << name[i];
      }
      const double at = b.axis.rotary ? 0.0 : b.axis.reference;
      EXPECT_NEAR((r->control.of_tables(at, true) + r->control.of_tables(at, false)) / 2, 0.0, half)
          << who;
    }
    std::cout << k.name << ": " << written << " of " << rounds << " machines with a table on\n";
    EXPECT_TRUE(failures() > so_far || written >= rounds * 8 / 10) << k.name;
  }
}

}  // namespace blind_machines_test
