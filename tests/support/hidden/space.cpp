// SPDX-License-Identifier: Apache-2.0
#include "hidden/space.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "hidden/random.h"
#include "machine.h"

namespace nonio::hidden {

namespace {

using machine::Curve;
using machine::Errors;
using machine::Vector;

constexpr std::size_t most_waves = 3;

/// A smooth random curve over 0 .. length: a bow and waves down to two thirds of the length, at
/// most `size`.
Curve wavy(Random& random, double length, double size) {
  std::array<double, most_waves> amplitude{}, phase{};
  for (std::size_t k = 0; k < most_waves; ++k) {
    amplitude[k] = size * random.normal() / static_cast<double>((k + 1) * (k + 1));
    phase[k] = random.uniform(0.0, 2.0 * std::numbers::pi);
  }
  return [=](double x) {
    double sum = 0.0;
    for (std::size_t k = 0; k < most_waves; ++k) {
      const double turns = 0.5 + 0.5 * static_cast<double>(k);
      sum += amplitude[k] * std::sin(2.0 * std::numbers::pi * turns * x / length + phase[k]);
    }
    return sum;
  };
}

/// The same with both ends at 0, as straightness is stated.
Curve bowed(Random& random, double length, double size) {
  const Curve wave = wavy(random, length, size);
  const double first = wave(0.0), last = wave(length);
  return [=](double x) { return wave(x) - first - (last - first) * x / length; };
}

Curve scaled(const Curve& curve, double by) {
  return [=](double x) { return by * curve(x); };
}

Curve sum_of(const Curve& a, const Curve& b) {
  return [=](double x) { return a(x) + b(x); };
}

/// Integral from 0, by Simpson.
Curve integral(const Curve& curve) {
  return [=](double x) {
    constexpr int n = 200;
    const double h = x / n;
    double sum = curve(0.0) + curve(x);
    for (int i = 1; i < n; ++i) sum += (i % 2 == 1 ? 4.0 : 2.0) * curve(h * i);
    return sum * h / 3.0;
  };
}

struct Machine {
  Vector length;  // of the volume
  Errors errors;
  Vector lost_motion;  // reversal of each axis

  /// Errors when the axes came from these sides.
  Errors from(const Vector& side) const {
    Errors e = errors;
    const auto shifted = [](const Curve& curve, double by) {
      return [=](double x) { return curve(x) + by; };
    };
    e.EXX = shifted(errors.EXX, side.x() * lost_motion.x() / 2.0);
    e.EYY = shifted(errors.EYY, side.y() * lost_motion.y() / 2.0);
    e.EZZ = shifted(errors.EZZ, side.z() * lost_motion.z() / 2.0);
    return e;
  }
};

Vector signs(const Vector& v) {
  return v.unaryExpr([](double x) { return x > 0.0 ? 1.0 : x < 0.0 ? -1.0 : 0.0; });
}

constexpr const char* axis_names[] = {"X", "Y", "Z"};

/// What is read: each method of measuring on a machine.
class Bench {
 public:
  Bench(SpaceHidden& out, Random& random, std::size_t targets, std::uint32_t runs)
      : out_(out), random_(random), targets_(targets), runs_(runs) {}

  /// A retroreflector along a straight from both sides; `sensed`: along the way, or across it.
  void line(const Machine& m, const std::string& id, const Vector& from, const Vector& to,
            const Vector& sensed, double slope = 0.0) {
    Observations o = begin(id, from, to);
    o.lines = {{id, {sensed.x(), sensed.y(), sensed.z()}}};
    const Vector way = to - from;
    const double start = reading(m.from(signs(way)), from, from, sensed);
    for (std::uint32_t run = 1; run <= runs_; ++run)
      for (const double side : {1.0, -1.0}) {
        const Errors errors = m.from(side * signs(way));
        for (std::size_t i = 0; i < targets_; ++i) {
          const std::size_t at = side > 0.0 ? i : targets_ - 1 - i;
          const double share = static_cast<double>(at) / static_cast<double>(targets_ - 1);
          const Vector stop = from + share * way;
          put(o, stop, side * signs(way), run,
              reading(errors, from, stop, sensed) - start + slope * share * way.norm());
        }
      }
    Measurement measurement;
    measurement.id = id;
    const Vector share = way.normalized();
    const auto moved =
        std::max_element(share.data(), share.data() + 3,
                         [](double a, double b) { return std::fabs(a) < std::fabs(b); }) -
        share.data();
    const bool one = std::fabs(share[moved]) > 1.0 - 1e-12;
    measurement.kind = !one                                 ? "diagonal"
                       : std::fabs(sensed.dot(share)) > 0.5 ? "axis"
                                                            : "straightness";
    if (one) measurement.axis = axis_names[moved];
    for (int k = 0; k < 3; ++k) {
      if (measurement.kind == "straightness" && std::fabs(sensed[k]) > 0.5)
        measurement.lateral = axis_names[k];
      if (std::fabs(share[k]) > 1e-12) {
        if (!one) measurement.from[axis_names[k]] = from[k], measurement.to[axis_names[k]] = to[k];
      } else {
        measurement.at[axis_names[k]] = from[k];
      }
    }
    finish(std::move(measurement), std::move(o));
  }

  void steps(const Machine& m, const std::string& id, std::size_t n) {
    Observations o;
    o.measurement = id;
    for (const char* axis : axis_names) o.axes.push_back({axis, false, {}, {}});
    const std::array<std::pair<const char*, Vector>, 4> corners = {
        {{"PPP", {1, 1, 1}}, {"NPP", {-1, 1, 1}}, {"PNP", {1, -1, 1}}, {"PPN", {1, 1, -1}}}};
    for (const auto& [name, sign] : corners) {
      const Vector way = m.length.cwiseProduct(sign);
      const Vector start = m.length.cwiseProduct((Vector::Ones() - sign) / 2.0);
      const Vector beam = way.normalized();
      std::vector<Vector> stops{start};
      for (std::size_t i = 0; i < n; ++i)
        for (int k = 0; k < 3; ++k) {
          stops.push_back(stops.back());
          stops.back()[k] += way[k] / static_cast<double>(n);
        }
      const auto readings = machine::flat_mirror(
          m.from(sign), stops, beam, 1e-4 * Eigen::Vector2d(random_.normal(), random_.normal()));
      o.lines.push_back({id + " " + name, {beam.x(), beam.y(), beam.z()}});
      for (std::size_t i = 1; i < stops.size(); ++i) put(o, stops[i], sign, 1, readings[i]);
    }
    Measurement measurement;
    measurement.id = id;
    measurement.kind = "step-diagonal";
    for (int k = 0; k < 3; ++k)
      measurement.from[axis_names[k]] = 0.0, measurement.to[axis_names[k]] = m.length[k];
    finish(std::move(measurement), std::move(o));
  }

  /// A ball that turns about `direction` exactly, read by axes that are not exact.
  void balls(const Machine& m, const std::string& axis, const Vector& centre,
             const Vector& direction, double radius, const std::vector<double>& angles) {
    Observations o;
    o.measurement = axis;
    o.axes = {
        {axis, true, {}, {}}, {"X", false, {}, {}}, {"Y", false, {}, {}}, {"Z", false, {}, {}}};
    for (int k = 0; k < 3; ++k) {
      Observations::Line line{axis + " " + axis_names[k], {}};
      line.sense[static_cast<std::size_t>(k)] = 1.0;
      o.lines.push_back(line);
    }
    const Vector arm = radius * direction.unitOrthogonal();
    for (std::uint32_t run = 1; run <= runs_; ++run)
      for (const double angle : angles) {
        const Vector ball = centre + Eigen::AngleAxisd(angle, direction) * arm;
        Vector read = ball;  // where the axes believe to be when they are at the ball
        for (int round = 0; round < 5; ++round) read += ball - machine::point(m.errors, read);
        for (int k = 0; k < 3; ++k) read[k] += out_.noise * random_.normal();
        for (int k = 0; k < 3; ++k) {
          o.axes[0].position.push_back(angle);
          for (std::size_t c = 0; c < 3; ++c)
            o.axes[1 + c].position.push_back(read[static_cast<int>(c)]);
          o.deviation.push_back(read[k]);
          o.line.push_back(static_cast<std::uint32_t>(k));
          o.run.push_back(run);
        }
      }
    Measurement measurement;
    measurement.id = axis;
    measurement.kind = "ball-centres";
    measurement.axis = axis;
    finish(std::move(measurement), std::move(o));
  }

 private:
  static Observations begin(const std::string& id, const Vector& from, const Vector& to) {
    Observations o;
    o.measurement = id;
    for (int k = 0; k < 3; ++k)
      if (std::fabs(to[k] - from[k]) > 1e-12) o.axes.push_back({axis_names[k], false, {}, {}});
    return o;
  }

  /// Along the way by an interferometer half a metre before the start; across it by its component.
  static double reading(const Errors& errors, const Vector& from, const Vector& stop,
                        const Vector& sensed) {
    const Vector at = machine::point(errors, stop);
    const Vector way = stop - from;
    if (way.norm() > 0.0 && std::fabs(way.normalized().dot(sensed)) < 0.5)
      return (at - stop).dot(sensed);
    const Vector source = from - 0.5 * sensed;
    return (at - source).norm() - (stop - source).norm();
  }

  void put(Observations& o, const Vector& stop, const Vector& sides, std::uint32_t run,
           double deviation) {
    for (auto& axis : o.axes) {
      const auto k = static_cast<int>(coordinate_of(axis.axis));
      axis.position.push_back(stop[k]);
      axis.approach.push_back(static_cast<std::int8_t>(sides[k]));
    }
    o.deviation.push_back(deviation + out_.noise * random_.normal());
    o.line.push_back(static_cast<std::uint32_t>(o.lines.size() - 1));
    o.run.push_back(run);
  }

  void finish(Measurement measurement, Observations o) {
    measurement.file = measurement.id + ".csv";
    for (std::size_t i = 0; i < o.size(); ++i)
      o.source_line.push_back(static_cast<std::uint32_t>(i + 2));
    out_.campaign.measurements.push_back(std::move(measurement));
    out_.read.push_back(std::move(o));
  }

  SpaceHidden& out_;
  Random& random_;
  std::size_t targets_;
  std::uint32_t runs_;
};

const std::vector<std::string>& straightnesses() {
  static const std::vector<std::string> all = {"EYX", "EXY", "EZX", "EXZ", "EZY", "EYZ"};
  return all;
}

/// What a story can hide, so that its readings can show it.
std::vector<std::string> hidden_in(Story story) {
  switch (story) {
    case Story::gantry:
    case Story::third:
      return {"squareness:XY", "straightness:EYX", "straightness:EXY", "yaw:X"};
    case Story::single_column:
      return {"yaw:X", "squareness:XY"};
    case Story::straightedge:
      return {"squareness:XY", "straightness:EYX", "straightness:EXY"};
    case Story::volume: {
      std::vector<std::string> all = {"squareness:XY", "squareness:XZ", "squareness:YZ", "yaw:X",
                                      "pitch:X",       "roll:X",        "pitch:Y",       "roll:Y"};
      for (const std::string& name : straightnesses()) all.push_back("straightness:" + name);
      return all;
    }
    case Story::steps: {
      std::vector<std::string> all = {"squareness:XY", "squareness:XZ", "squareness:YZ"};
      for (const std::string& name : straightnesses()) all.push_back("straightness:" + name);
      return all;
    }
    case Story::table:
      return {"linear-squareness:XY", "linear-scale:X"};
    case Story::swivel:
      break;
  }
  return {"linear-squareness:XZ"};
}

struct Angular {
  const char* effect;
  Curve Errors::*curve;
  int axis;
};
constexpr Angular angulars[] = {{"yaw:X", &Errors::ECX, 0},
                                {"pitch:X", &Errors::EBX, 0},
                                {"roll:X", &Errors::EAX, 0},
                                {"pitch:Y", &Errors::EAY, 1},
                                {"roll:Y", &Errors::EBY, 1}};

struct Square {
  const char* of;
  double Errors::*value;
};
constexpr Square shears[] = {{"XY", &Errors::C0Y}, {"XZ", &Errors::B0Z}, {"YZ", &Errors::A0Z}};

/// The hidden error with size 1: um for curves, or what gives some um.
void add_hidden(Machine& m, const std::string& effect, Story story, Random& random, double size) {
  const std::string kind = effect.substr(0, effect.find(':'));
  const std::string of = effect.substr(effect.find(':') + 1);
  if (kind == "straightness") {
    Curve& curve = m.errors[of];
    const double length = m.length[static_cast<int>(coordinate_of(std::string(1, of[2])))];
    curve = sum_of(curve, scaled(bowed(random, length, 1e-6), size));
  } else if (kind == "squareness" || kind == "linear-squareness") {
    for (const Square& square : shears)
      if (of == square.of) m.errors.*(square.value) += size * 1e-5 * random.sign();
  } else if (kind == "linear-scale") {
    const double slope = size * 1e-5 * random.sign();
    m.errors.EXX = [slope](double x) { return slope * x; };
  } else {
    for (const Angular& angular : angulars) {
      if (effect != angular.effect) continue;
      const Curve turn = scaled(bowed(random, m.length[angular.axis], 1e-6), size);
      (m.errors.*(angular.curve)) = turn;
      if (story == Story::single_column) m.errors.EYX = sum_of(m.errors.EYX, integral(turn));
    }
  }
}

Vector volume_of(Story story, Random& random) {
  if (story == Story::steps || story == Story::volume)
    return {random.uniform(0.8, 1.6), random.uniform(0.6, 1.0), random.uniform(0.5, 0.8)};
  if (story == Story::table || story == Story::swivel) return {1.0, 1.0, 1.0};
  return {random.uniform(1.0, 6.0), random.uniform(0.8, 3.0), 1.0};
}

void measure(Bench& bench, const Machine& m, Story story, Random random) {
  const double x = m.length.x(), y = m.length.y(), z = m.length.z();
  const auto ux = Vector::UnitX(), uy = Vector::UnitY(), uz = Vector::UnitZ();
  if (story == Story::table || story == Story::swivel) {
    const std::size_t n = random.whole(12, 24);
    const double span = story == Story::table ? 2.0 * std::numbers::pi : 4.0;
    std::vector<double> angles;
    for (std::size_t i = 0; i < n; ++i)
      angles.push_back(span * static_cast<double>(i) /
                       static_cast<double>(story == Story::table ? n : n - 1));
    const Vector direction =
        (story == Story::table ? Vector(2e-5, -3e-5, 1.0) : Vector(1e-5, 1.0, 2e-5)).normalized();
    bench.balls(m, story == Story::table ? "C" : "B", {0.5, 0.45, 0.4}, direction,
                random.uniform(0.15, 0.35), angles);
    return;
  }
  const auto diagonals = [&](const std::string& name, const Vector& a, const Vector& b,
                             const Vector& base) {
    bench.line(m, "D1" + name, base, base + a + b, (a + b).normalized());
    bench.line(m, "D2" + name, base + b, base + a, (a - b).normalized());
  };
  const bool flat = story != Story::volume && story != Story::steps;
  bench.line(m, "X", {0, 0, 0}, {x, 0, 0}, ux);
  if (story != Story::straightedge && story != Story::steps)
    bench.line(m, "X2", {0, y, 0}, {x, y, 0}, ux);
  bench.line(m, "Y", {0, 0, 0}, {0, y, 0}, uy);
  if (flat) diagonals("", {x, 0, 0}, {0, y, 0}, Vector::Zero());
  if (story == Story::third)
    bench.line(m, "D3", {0, 0, 0}, {x, y / 2, 0}, Vector(x, y / 2, 0).normalized());
  if (story == Story::straightedge) {
    bench.line(m, "SX", {0, 0, 0}, {x, 0, 0}, uy, 1e-5 * random.normal());
    bench.line(m, "SY", {0, 0, 0}, {0, y, 0}, ux, 1e-5 * random.normal());
  }
  if (flat) return;
  bench.line(m, "Z", {0, 0, 0}, {0, 0, z}, uz);
  if (story == Story::steps) return bench.steps(m, "SD", 15);
  bench.line(m, "X3", {0, 0, z}, {x, 0, z}, ux);
  bench.line(m, "Y2", {0, 0, z}, {0, y, z}, uy);
  bench.line(m, "Y3", {x, 0, z}, {x, y, z}, uy);
  diagonals("xy", {x, 0, 0}, {0, y, 0}, Vector::Zero());
  diagonals("top", {x, 0, 0}, {0, y, 0}, {0, 0, z});
  diagonals("xz", {x, 0, 0}, {0, 0, z}, Vector::Zero());
  diagonals("yz", {0, y, 0}, {0, 0, z}, Vector::Zero());
}

/// RMS of the readings that the hidden error changes, about the means of their lines.
double visible(const SpaceHidden& with, const SpaceHidden& without) {
  double squares = 0.0, n = 0.0;
  for (std::size_t m = 0; m < with.read.size(); ++m) {
    const Observations &a = with.read[m], &b = without.read[m];
    for (std::uint32_t line = 0; line < a.lines.size(); ++line) {
      double mean = 0.0, of = 0.0, here = 0.0;
      for (int pass = 0; pass < 2; ++pass)
        for (std::size_t i = 0; i < a.size(); ++i) {
          if (a.line[i] != line) continue;
          const double difference = a.deviation[i] - b.deviation[i];
          if (pass == 0)
            mean += difference, of += 1.0;
          else
            here += (difference - mean / of) * (difference - mean / of);
        }
      if (here / of < 1e-18) continue;
      squares += here;
      n += of;
    }
  }
  return n > 0.0 ? std::sqrt(squares / n) : 0.0;
}

SpaceHidden made(Story story, std::uint64_t seed, double size, double noise) {
  Random random(seed);
  SpaceHidden out;
  out.story = story;
  out.noise = noise;
  const auto causes = hidden_in(story);
  out.effect = causes[seed % causes.size()];
  Machine m{volume_of(story, random), {}, Vector::Zero()};
  const bool balls = story == Story::table || story == Story::swivel;
  const std::size_t targets = random.whole(13, 25);
  const auto runs = static_cast<std::uint32_t>(random.whole(2, 4));
  const int axes = story == Story::volume || story == Story::steps ? 3 : 2;
  const std::array<const char*, 3> along = {"EXX", "EYY", "EZZ"};
  if (!balls) {
    for (int k = 0; k < axes; ++k) {
      const double slope = 5e-6 * random.normal();
      const Curve pitch = bowed(random, m.length[k], 3e-6);
      m.errors[along[static_cast<std::size_t>(k)]] = [=](double x) { return slope * x + pitch(x); };
      m.lost_motion[k] = -random.uniform(1e-6, 4e-6);
      for (const char* kind : {"scale:", "pitch-curve:", "backlash:"})
        out.model.push_back(kind + std::string(axis_names[k]));
    }
    for (const Square& square : shears) {
      if (axes == 2 && square.of != shears[0].of) continue;
      m.errors.*(square.value) = 2e-5 * random.normal();
      const std::string name = std::string("squareness:") + square.of;
      if (name == out.effect)
        m.errors.*(square.value) = 0.0;
      else
        out.model.push_back(name);
    }
  }
  add_hidden(m, out.effect, story, random, size);
  out.campaign.id = std::string("space-") + to_text(story) + "-" + std::to_string(seed);
  out.campaign.machine.structure = story == Story::single_column ? "single-column" : "gantry";
  for (const char* name : axis_names) {
    Axis axis;
    axis.name = name;
    out.campaign.machine.axes.push_back(axis);
  }
  Axis rotary;
  rotary.name = story == Story::table ? "C" : "B";
  rotary.rotary = true;
  out.campaign.machine.axes.push_back(rotary);
  out.campaign.model = out.model;
  Bench bench(out, random, targets, runs);
  measure(bench, m, story, Random(seed, 1));
  return out;
}

}  // namespace

const char* to_text(Story story) {
  switch (story) {
    case Story::gantry:
      return "gantry";
    case Story::third:
      return "third";
    case Story::single_column:
      return "single-column";
    case Story::straightedge:
      return "straightedge";
    case Story::volume:
      return "volume";
    case Story::steps:
      return "steps";
    case Story::table:
      return "table";
    case Story::swivel:
      break;
  }
  return "swivel";
}

SpaceHidden hide_in_space(Story story, std::uint64_t seed, double times) {
  const double noise = Random(seed, 2).uniform(0.3e-6, 1e-6);
  const double one = visible(made(story, seed, 1.0, 0.0), made(story, seed, 0.0, 0.0));
  return made(story, seed, times * noise / one, noise);
}

}  // namespace nonio::hidden
