// SPDX-License-Identifier: Apache-2.0
// Generates the samples of `nonio plugin check`: one machine with smooth errors and all kinds of
// measurement.
#include <array>
#include <cmath>
#include <numbers>

#include "nonio/sdk/format.h"
#include "plugin_check/plugin_checks.h"

namespace nonio::plugin_check::kit {

namespace {

using Vector = std::array<double, 3>;
constexpr double um = 1e-6;
constexpr double turn = 2.0 * std::numbers::pi;

/// The sum of three sine waves with the base period `over` (m, or rad for a revolution).
struct Waves {
  std::array<double, 3> size{}, phase{};
  double over = 1.0;

  double operator()(double x) const {
    double sum = 0.0;
    for (std::size_t k = 0; k < size.size(); ++k)
      sum += size[k] * std::sin(turn * static_cast<double>(k + 1) * x / over + phase[k]);
    return sum;
  }
};

Waves waves(storage::Random& random, double size, double over) {
  Waves w;
  w.over = over;
  for (std::size_t k = 0; k < w.size.size(); ++k) {
    w.size[k] = size * random.uniform(0.3, 1.0) / static_cast<double>(k + 1);
    w.phase[k] = random.uniform(0.0, turn);
  }
  return w;
}

/// Number of intervals and runs, directions, reversal and noise of a line; m, or rad on a rotary
/// axis.
struct Pass {
  int intervals = 20, runs = 3;
  bool plus = true, minus = true, timed = false, uneven = false;
  double reversal = -3.0 * um, noise = 0.5 * um;
};

class MadeMachine {
 public:
  explicit MadeMachine(std::uint64_t seed) : random_(seed, 1) {
    for (std::size_t of = 0; of < 3; ++of)
      for (std::size_t by = 0; by < 3; ++by)
        error_[of][by] = waves(random_, (of == by ? 6.0 : 8.0) * um, 1.0);
    for (double& angle : square_) angle = random_.uniform(-20e-6, 20e-6);
    turning_ = waves(random_, 20e-6, turn);
  }

  template <class Target>
  std::string line(const Vector& from, const Vector& to, const Vector& sense, const Pass& pass,
                   const Target& target) {
    const Vector zero = error(from);
    return rows(pass, target, 1.0 / um, [&](double share) {
      Vector p{};
      for (std::size_t k = 0; k < 3; ++k) p[k] = from[k] + share * (to[k] - from[k]);
      const Vector e = error(p);
      double sensed = 0.0;
      for (std::size_t k = 0; k < 3; ++k) sensed += sense[k] * (e[k] - zero[k]);
      return sensed;
    });
  }

  std::string turning(const Pass& pass) {
    return rows(
        pass, [](double share) { return 360.0 * share; }, arcsec_per_rad,
        [&](double share) { return turning_(turn * share); });
  }

  std::string step_diagonals(const Vector& size, int steps) {
    std::string out = "diagonal,step,moved,deviation_um\n";
    const double length = std::sqrt(size[0] * size[0] + size[1] * size[1] + size[2] * size[2]);
    for (const auto& [name, sign] : std::array<std::pair<const char*, Vector>, 4>{
             {{"PPP", {1, 1, 1}}, {"NPP", {-1, 1, 1}}, {"PNP", {1, -1, 1}}, {"PPN", {1, 1, -1}}}}) {
      Vector p{}, sense{};
      for (std::size_t k = 0; k < 3; ++k) {
        p[k] = sign[k] > 0 ? 0.0 : size[k];
        sense[k] = sign[k] * size[k] / length;
      }
      const Vector zero = error(p);
      for (int step = 0; step < 3 * steps; ++step) {
        const auto axis = static_cast<std::size_t>(step % 3);
        p[axis] += sign[axis] * size[axis] / steps;
        const Vector e = error(p);
        double sensed = 0.3 * um * random_.normal();
        for (std::size_t k = 0; k < 3; ++k) sensed += sense[k] * (e[k] - zero[k]);
        out += std::string(name) + "," + std::to_string(step + 1) + "," + "XYZ"[axis] + "," +
               fixed_text(sensed / um, 3) + "\n";
      }
    }
    return out;
  }

  std::string ball(double first_deg, double step_deg, int n, bool about_y) {
    std::string out = "angle_deg,x_mm,y_mm,z_mm\n";
    for (int i = 0; i < n; ++i) {
      const double a = first_deg + step_deg * i, c = std::cos(a / deg_per_rad) * 261.0,
                   s = std::sin(a / deg_per_rad) * 261.0;
      const Vector p =
          about_y ? Vector{400.0 + c, 118.0, -230.0 - s} : Vector{412.0 + c, 305.0 + s, -130.0};
      out += fixed_text(a, 3);
      for (const double x : p) out += "," + fixed_text(x + 0.001 * random_.normal(), 4);
      out += "\n";
    }
    return out;
  }

  std::string balls_of_two_axes() {
    std::string out = "angle_deg,B_deg,x_mm,y_mm,z_mm\n";
    for (const double b : {-40.0, 0.0, 40.0})
      for (const double c : {0.0, 72.0, 144.0, 216.0, 288.0}) {
        const double x = 12.0 + 140.0 * std::cos(c / deg_per_rad), z = 180.0,
                     cosine = std::cos(b / deg_per_rad), sine = std::sin(b / deg_per_rad);
        out += fixed_text(c, 3) + "," + fixed_text(b, 3);
        for (const double p :
             {400.0 + x * cosine + z * sine, 305.0 + 140.0 * std::sin(c / deg_per_rad),
              -310.0 - x * sine + z * cosine})
          out += "," + fixed_text(p + 0.001 * random_.normal(), 4);
        out += "\n";
      }
    return out;
  }

  /// Readings of a gauge on a table along its radius and along its axis: 20 um and 40 um times 1 -
  /// cos(angle), with noise.
  std::string tool_centre(int n) {
    std::string out = "angle_deg,x_mm,y_mm,z_mm,tx,ty,tz,deviation_um,line\n";
    for (const bool along : {false, true})
      for (int i = 0; i < n; ++i) {
        const double a = 360.0 * i / n, c = std::cos(a / deg_per_rad),
                     s = std::sin(a / deg_per_rad),
                     off = along ? 40.0 * (1.0 - c) : 20.0 * (1.0 - c);
        out += fixed_text(a, 3);
        for (const double x : {400.0 + 150.0 * c, 300.0 + 150.0 * s, -80.0})
          out += "," + fixed_text(x, 4);
        out += std::string(along ? ",0,0,1," : ",1,0,0,") +
               fixed_text(off + 0.5 * random_.normal(), 3) + (along ? ",axial\n" : ",radial\n");
      }
    return out;
  }

 private:
  Vector error(const Vector& p) const {
    Vector e{};
    for (std::size_t of = 0; of < 3; ++of)
      for (std::size_t by = 0; by < 3; ++by) e[of] += error_[of][by](p[by]);
    e[0] += -square_[0] * p[1] + square_[1] * p[2];
    e[1] += -square_[2] * p[2];
    return e;
  }

  template <class Target, class Value>
  std::string rows(const Pass& pass, const Target& target, double per_si, const Value& value) {
    std::string out;
    double time = 0.0;
    std::vector<double> share;
    for (int i = 0; i <= pass.intervals; ++i)
      share.push_back((i + (pass.uneven ? random_.uniform(-0.2, 0.2) : 0.0)) / pass.intervals);
    for (int run = 1; run <= pass.runs; ++run)
      for (const int direction : {1, -1}) {
        if (direction > 0 ? !pass.plus : !pass.minus) continue;
        for (int k = 0; k <= pass.intervals; ++k) {
          const double x = share[static_cast<std::size_t>(direction > 0 ? k : pass.intervals - k)];
          time += 10.0;
          const double scatter = pass.noise * random_.normal();
          const double deviation = value(x) + direction * pass.reversal / 2.0 + scatter;
          out += std::to_string(run) + (direction > 0 ? ",+," : ",-,") + fixed_text(target(x), 4) +
                 "," + fixed_text(deviation * per_si, 3);
          if (pass.timed) {
            const double warm = 0.8 * (1.0 - std::exp(-time / 1200.0));
            out += "," + fixed_text(time, 1) + "," +
                   fixed_text(20.0 + warm + 0.2 * std::sin(time / 300.0), 3);
          }
          out += "\n";
        }
      }
    return out;
  }

  storage::Random random_;
  std::array<std::array<Waves, 3>, 3> error_;
  std::array<double, 3> square_{};
  Waves turning_;
};

std::string head(const std::string& id) {
  return "format = 1\n[campaign]\nid = \"" + id +
         "\"\ncustomer = \"Sample\"\ndate = 2026-03-02\n"
         "[machine]\nmaker = \"Sample\"\nmodel = \"M 1\"\nserial = \"1\"\nstructure = \"bridge\"\n"
         "[instrument]\nU_fixed_um = 0.1\nU_per_m_um = 0.5\n"
         "[environment]\nmisalignment_mm = 0.5\ntemperature_range_K = 0.2\n"
         "temperature_difference_K = 0.8\nexpansion_range_um_per_m_K = 1.0\ndrift_um = 0.6\n";
}

std::string linear_axis(char name, const std::string& more = "") {
  return std::string("[machine.axes.") + name +
         "]\nkind = \"linear\"\ntravel = [0.0, 1200.0]\nexpansion_um_per_m_K = 11.5\n" + more;
}

std::string measured(const std::string& id, const std::string& kind, const std::string& more) {
  return "[[measurement]]\nid = \"" + id + "\"\nkind = \"" + kind + "\"\nfile = \"" + id +
         ".csv\"\n" + more;
}

std::string columns_of(const Pass& pass, const char* target, const char* deviation) {
  return std::string("run,direction,") + target + "," + deviation +
         (pass.timed ? ",time_s,material_c\n" : "\n");
}

Vector along(std::size_t axis, double length) {
  Vector v{};
  v[axis] = length;
  return v;
}

void add_run(Source& s, MadeMachine& machine, const std::string& id, std::size_t axis,
             std::size_t sensed, double length, const Pass& pass) {
  const char letter = "XYZ"[axis];
  s.manifest += measured(
      id, axis == sensed ? "axis" : "straightness",
      std::string("axis = \"") + letter + "\"\n" +
          (axis == sensed ? std::string() : std::string("lateral = \"") + "XYZ"[sensed] + "\"\n"));
  s.files.push_back(
      {id + ".csv", columns_of(pass, "target_mm", "deviation_um") +
                        machine.line({}, along(axis, length), along(sensed, 1.0), pass,
                                     [&](double x) { return x * length * 1e3; })});
}

Source one_axis(MadeMachine& machine, const std::string& name, std::size_t axis, const Pass& pass,
                const std::string& more = "") {
  Source s{name, head(name) + linear_axis("XYZ"[axis], more), {}};
  add_run(s, machine, std::string(1, "XYZ"[axis]), axis, axis, 1.0, pass);
  return s;
}

Source rotary(MadeMachine& machine) {
  const Pass pass{.intervals = 36, .timed = true, .reversal = -8e-6, .noise = 1e-6};
  Source s{"rotary",
           head("rotary") +
               "[machine.axes.C]\nkind = \"rotary\"\ntravel = [0.0, 360.0]\nteeth = 8\n" +
               measured("C", "axis", "axis = \"C\"\n"),
           {}};
  s.files.push_back(
      {"C.csv", columns_of(pass, "target_deg", "deviation_arcsec") + machine.turning(pass)});
  return s;
}

Source straightness(MadeMachine& machine) {
  Source s{"straightness",
           head("straightness") + linear_axis('X') + linear_axis('Y') + linear_axis('Z'),
           {}};
  const Pass pass{.intervals = 20, .runs = 2, .reversal = -1e-6};
  for (std::size_t axis = 0; axis < 3; ++axis)
    for (std::size_t sensed = 0; sensed < 3; ++sensed)
      add_run(s, machine,
              axis == sensed ? std::string(1, "XYZ"[axis])
                             : std::string("E") + "XYZ"[sensed] + "XYZ"[axis],
              axis, sensed, 0.8, pass);
  return s;
}

Source angles(MadeMachine& machine) {
  Source s{"angles", head("angles") + linear_axis('X') + linear_axis('Y') + linear_axis('Z'), {}};
  const Pass pass{.intervals = 16, .runs = 2, .reversal = -0.5e-6};
  for (const char about : {'X', 'Y', 'Z'}) {
    const std::string id = std::string("turns-about-") + about;
    s.manifest += measured(id, "angle", std::string("axis = \"X\"\nabout = \"") + about + "\"\n");
    s.files.push_back({id + ".csv", columns_of(pass, "target_mm", "deviation_arcsec") +
                                        machine.line({}, along(0, 0.8), along(1, 1.0), pass,
                                                     [](double x) { return x * 800.0; })});
  }
  return s;
}

Source diagonals(MadeMachine& machine) {
  Source s{"diagonals", head("diagonals") + linear_axis('X') + linear_axis('Y'), {}};
  const Pass pass{.intervals = 20, .runs = 2, .reversal = -1e-6};
  add_run(s, machine, "X", 0, 0, 0.8, pass);
  add_run(s, machine, "Y", 1, 1, 0.6, pass);
  const struct {
    const char *id, *ends;
    Vector from, to;
  } lines[] = {
      {"D1", "from = { X = 0, Y = 0 }\nto = { X = 800, Y = 600 }\n", {0, 0, 0}, {0.8, 0.6, 0}},
      {"D2", "from = { X = 0, Y = 600 }\nto = { X = 800, Y = 0 }\n", {0, 0.6, 0}, {0.8, 0, 0}}};
  for (const auto& l : lines) {
    s.manifest += measured(l.id, "diagonal", l.ends);
    s.files.push_back({std::string(l.id) + ".csv",
                       columns_of(pass, "target_mm", "deviation_um") +
                           machine.line(l.from, l.to, {l.to[0] - l.from[0], l.to[1] - l.from[1], 0},
                                        pass, [](double x) { return x * 1000.0; })});
  }
  return s;
}

Source step_diagonals(MadeMachine& machine) {
  Source s{"step-diagonal",
           head("step-diagonal") + linear_axis('X') + linear_axis('Y') + linear_axis('Z'),
           {}};
  for (std::size_t axis = 0; axis < 3; ++axis)
    add_run(s, machine, std::string(1, "XYZ"[axis]), axis, axis, axis == 0 ? 0.8 : 0.6,
            {.intervals = 16, .runs = 2, .reversal = -1e-6});
  s.manifest += measured("SD", "step-diagonal",
                         "from = { X = 0, Y = 0, Z = 0 }\nto = { X = 800, Y = 600, Z = 600 }\n");
  s.files.push_back({"SD.csv", machine.step_diagonals({0.8, 0.6, 0.6}, 16)});
  return s;
}

/// A circle in both directions, with squareness error and lost motion.
Source circle() {
  Source s{"circle",
           head("circle") + linear_axis('X') + linear_axis('Y') +
               measured("C", "circle",
                        "plane = \"XY\"\nradius_mm = 150\ncentre = { X = 400, Y = 300 }\n"
                        "feed_mm_per_min = 1000\n"),
           {}};
  std::string rows = "run,direction,angle_deg,deviation_um\n";
  for (const int d : {1, -1})
    for (int i = 0; i < 180; ++i) {
      const double degrees = d > 0 ? 2.0 * i + 1.0 : 359.0 - 2.0 * i, t = degrees / deg_per_rad;
      const double deviation = 3.0 - 2.5 * std::sin(2.0 * t) + 0.2 * std::sin(37.0 * t) +
                               d * (std::sin(t) > 0.0 ? 3.0 : -3.0) * std::cos(t);
      rows += std::string("1,") + (d > 0 ? "+," : "-,") + fixed_text(degrees, 1) + "," +
              fixed_text(deviation, 3) + "\n";
    }
  s.files.push_back({"C.csv", rows});
  return s;
}

Source thermal() {
  Source s{"thermal", head("thermal") + linear_axis('Z') + measured("T", "thermal", ""), {}};
  std::string rows = "time_s,speed_rpm,y_um,z_um,air_c\n";
  for (int i = 0; i < 121; ++i) {
    const double minute = i, z = 18.0 * (1.0 - std::exp(-minute / 22.0)),
                 y = 6.0 * (1.0 - std::exp(-minute / 31.0));
    rows += std::to_string(60 * i) + ",6000," + fixed_text(y + 0.05 * std::sin(1.7 * i), 3) + "," +
            fixed_text(z + 0.05 * std::cos(2.3 * i), 3) + "," + fixed_text(20.0 + 0.004 * i, 3) +
            "\n";
  }
  s.files.push_back({"T.csv", rows});
  return s;
}

/// Eight revolutions of a ball between two sensors, with errors of an oval journal and of a bearing
/// cage.
Source spindle() {
  Source s{"spindle", head("spindle") + linear_axis('Z') + measured("S", "spindle", ""), {}};
  std::string rows = "angle_deg,x_um,y_um\n";
  for (int i = 0; i < 8 * 72; ++i) {
    const double degrees = 5.0 * i, t = degrees / deg_per_rad;
    rows += fixed_text(degrees, 1) + "," +
            fixed_text(4.0 * std::cos(t) + 0.5 * std::cos(2.0 * t) + 0.1 * std::cos(0.41 * t), 3) +
            "," +
            fixed_text(4.0 * std::sin(t) + 0.5 * std::sin(2.0 * t) + 0.1 * std::sin(0.41 * t), 3) +
            "\n";
  }
  s.files.push_back({"S.csv", rows});
  return s;
}

Source lengths() {
  Source s{"lengths",
           head("lengths") + linear_axis('X') + "[options.lengths]\nmpe_E0_um = 3.0\n" +
               measured("L", "lengths", ""),
           {}};
  std::string rows = "test,position,length_mm,repeat,deviation_um\n";
  for (int p = 1; p <= 7; ++p)
    for (int l = 1; l <= 5; ++l)
      for (int k = 1; k <= 3; ++k)
        rows +=
            "E0," + std::to_string(p) + "," + std::to_string(100 * l) + ".0," + std::to_string(k) +
            "," +
            fixed_text(0.3 * (p - 4) * l / 5.0 + 0.2 * std::sin(3.1 * p + 5.3 * l + 7.7 * k), 3) +
            "\n";
  s.files.push_back({"L.csv", rows});
  return s;
}

Source balls(MadeMachine& machine) {
  Source s{"ball-centres",
           head("ball-centres") +
               "[machine.axes.C]\nkind = \"rotary\"\ntravel = [0.0, 360.0]\n"
               "[machine.axes.B]\nkind = \"rotary\"\ntravel = [-60.0, 90.0]\n" +
               measured("C", "ball-centres", "axis = \"C\"\n") +
               measured("B", "ball-centres", "axis = \"B\"\n"),
           {}};
  s.files.push_back({"C.csv", machine.ball(0.0, 15.0, 24, false)});
  s.files.push_back({"B.csv", machine.ball(-60.0, 10.0, 16, true)});
  return s;
}

Source two_rotary_axes(MadeMachine& machine) {
  Source s{"two-rotary-axes",
           head("two-rotary-axes") +
               "[machine.axes.C]\nkind = \"rotary\"\ntravel = [0.0, 360.0]\n"
               "[machine.axes.B]\nkind = \"rotary\"\ntravel = [-60.0, 90.0]\n"
               "[options.rotary-chain]\ntables = [\"B\", \"C\"]\n" +
               measured("BC", "ball-centres", "axis = \"C\"\n"),
           {}};
  s.files.push_back({"BC.csv", machine.balls_of_two_axes()});
  return s;
}

Source tool_centre(MadeMachine& machine) {
  Source s{"rtcp",
           head("rtcp") + "[machine.axes.C]\nkind = \"rotary\"\ntravel = [0.0, 360.0]\n" +
               "[options.rtcp]\ntables = [\"C\"]\n" + measured("C", "rtcp", "axis = \"C\"\n"),
           {}};
  s.files.push_back({"C.csv", machine.tool_centre(12)});
  return s;
}

}  // namespace

std::vector<Source> made_sources(std::uint64_t seed) {
  MadeMachine m(seed);
  return {one_axis(m, "linear", 0, {.intervals = 20, .runs = 5, .timed = true, .uneven = true},
                   "screw_pitch_mm = 10.0\n"),
          one_axis(m, "even", 1, {.intervals = 40, .timed = true}),
          rotary(m),
          one_axis(m, "one-run", 0, {.runs = 1}),
          one_axis(m, "one-direction", 0, {.minus = false}),
          straightness(m),
          angles(m),
          diagonals(m),
          step_diagonals(m),
          circle(),
          thermal(),
          spindle(),
          lengths(),
          balls(m),
          tool_centre(m),
          two_rotary_axes(m)};
}

}  // namespace nonio::plugin_check::kit
