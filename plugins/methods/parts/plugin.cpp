// SPDX-License-Identifier: Apache-2.0
// A machined part whose features were measured on a coordinate measuring machine.
//     d = R (S m - p (1 + alpha (T2 - T1)) + v x p)
// v: vector of the rotation of the measured features against the nominal ones, S: the inverse of
// this rotation, so that d contains it in its first order, as body-turn does; p, m: nominal and
// measured position of a feature in the part, m; R: rotation of the part on the table about Z; d:
// error of the machine at the position origin + R p of the feature; T1, T2: temperature of the part
// during machining, and reference temperature of the measurement. Position and rotation of the part
// are unknown, and so is its size without temperatures (effects body-turn and body-size). Sign: a
// hole is at the actual position of the machine.
#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numbers>
#include <utility>
#include <vector>

#include "nonio/sdk/method.h"

namespace nonio::parts_method {

namespace {

using Vector = std::array<double, 3>;
constexpr const char* coordinates[] = {"X", "Y", "Z"};
constexpr const char* nominal[] = {"nominal_x", "nominal_y", "nominal_z"};
constexpr const char* measured[] = {"measured_x", "measured_y", "measured_z"};
constexpr double largest = 0.01;  // m, largest plausible deviation

/// Coordinates remain exact for multiples of 90 deg.
bool is_quarter(double angle) {
  return std::fabs(std::remainder(angle, std::numbers::pi / 2)) < 1e-9;
}

Vector turned(const Vector& v, double angle) {
  double c = std::cos(angle), s = std::sin(angle);
  if (is_quarter(angle)) c = std::round(c), s = std::round(s);
  return {v[0] * c - v[1] * s, v[0] * s + v[1] * c, v[2]};
}

Vector cross(const Vector& a, const Vector& b) {
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}

/// Rodrigues' formula: p turned by the vector v, rad.
Vector turned(const Vector& p, const Vector& v) {
  const double angle = std::hypot(v[0], v[1], v[2]);
  if (!(angle > 0.0)) return p;
  const double s = std::sin(angle) / angle, c = 2.0 * std::pow(std::sin(0.5 * angle) / angle, 2.0);
  const Vector once = cross(v, p), twice = cross(v, once);
  Vector out{};
  for (std::size_t k = 0; k < 3; ++k) out[k] = p[k] + s * once[k] + c * twice[k];
  return out;
}

/// Where the measured features are against the nominal ones, by least squares: vector of the
/// rotation, rad, and shift, m.
struct Placed {
  Vector turn{}, shift{};
};

using Places = std::vector<std::pair<Vector, Vector>>;  // nominal and measured

/// Whether the nominal places determine a rotation about each axis: they are not on one line.
bool has_volume(const Places& places) {
  for (std::size_t i = 1; i < places.size(); ++i)
    for (std::size_t k = i + 1; k < places.size(); ++k) {
      const auto& [zero, ignored] = places[0];
      Vector a{}, b{};
      for (std::size_t c = 0; c < 3; ++c)
        a[c] = places[i].first[c] - zero[c], b[c] = places[k].first[c] - zero[c];
      const Vector normal = cross(a, b);
      const double area = std::hypot(normal[0], normal[1], normal[2]);
      if (area > 1e-3 * std::hypot(a[0], a[1], a[2]) * std::hypot(b[0], b[1], b[2])) return true;
    }
  return false;
}

/// The rotation is one about Z, and also about X and Y if features have all three coordinates. A
/// linear model would take half the square of some mrad for a scale of 10 um/m.
Placed placed(const Readings& r) {
  Places places;
  const auto take = [&](std::size_t count) {
    for (std::size_t i = 0; i < r.size(); ++i) {
      std::pair<Vector, Vector> one{};
      bool whole = true;
      for (std::size_t k = 0; k < count; ++k) {
        const auto *to = r.column(nominal[k]), *from = r.column(measured[k]);
        whole = whole && to != nullptr && from != nullptr && std::isfinite((*from)[i]);
        if (whole) one.first[k] = (*to)[i], one.second[k] = (*from)[i];
      }
      if (whole) places.push_back(one);
    }
  };
  take(3);
  bool flat = !has_volume(places);
  if (flat) places.clear(), take(2);
  Vector p0{}, m0{};
  for (const auto& [p, m] : places)
    for (std::size_t k = 0; k < 3; ++k) {
      p0[k] += p[k] / static_cast<double>(places.size());
      m0[k] += m[k] / static_cast<double>(places.size());
    }
  for (auto& [p, m] : places)
    for (std::size_t k = 0; k < 3; ++k) p[k] -= p0[k], m[k] -= m0[k];
  Vector v{};
  for (int round = 0; round < 5; ++round) {
    std::array<Vector, 3> a{};  // of a w = b
    Vector b{};
    for (const auto& [p, m] : places) {
      const Vector now = turned(m, {-v[0], -v[1], -v[2]}), torque = cross(p, now);
      const double square = p[0] * p[0] + p[1] * p[1] + p[2] * p[2];
      for (std::size_t k = 0; k < 3; ++k) {
        b[k] += torque[k];
        for (std::size_t l = 0; l < 3; ++l) a[k][l] += (k == l ? square : 0.0) - p[k] * p[l];
      }
    }
    Vector w{0.0, 0.0, a[2][2] > 0.0 ? b[2] / a[2][2] : 0.0};
    if (!flat) {
      const Vector x = cross(a[1], a[2]), y = cross(a[2], a[0]), z = cross(a[0], a[1]);
      const double volume = a[0][0] * x[0] + a[0][1] * x[1] + a[0][2] * x[2];
      for (std::size_t k = 0; k < 3; ++k) w[k] = (x[k] * b[0] + y[k] * b[1] + z[k] * b[2]) / volume;
    }
    for (std::size_t k = 0; k < 3; ++k) v[k] += w[k];
  }
  const Vector centre = turned(p0, v);
  return {v, {m0[0] - centre[0], m0[1] - centre[1], m0[2] - centre[2]}};
}

/// Relative growth of the part between machining and measurement, and whether it is known.
Expected<std::pair<double, bool>> growth_of(const Measurement& m) {
  const auto temperatures = m.settings.numbers("temperatures_c");
  const double expansion = m.settings.number("expansion_um_per_m_K") * 1e-6;
  if (temperatures.empty()) return std::pair{0.0, false};
  if (temperatures.size() != 2 || !(expansion > 0.0))
    return fail("measurement." + m.id +
                ".temperatures_c: expected two temperatures (while the part was made, and to which "
                "its measurement refers) together with expansion_um_per_m_K");
  return std::pair{expansion * (temperatures[1] - temperatures[0]), true};
}

class Rows {
 public:
  Rows(const Measurement& m, std::array<bool, 3> places, bool size_known, const Vector& origin,
       double turned) {
    o_.measurement = m.id;
    for (std::size_t k = 0; k < 3; ++k) {
      axis_[k] = o_.axes.size();
      if (places[k]) o_.axes.push_back({coordinates[k], false, {}, {}});
      o_.lines.push_back({m.id + " " + coordinates[k], {}});
      o_.lines[k].sense[k] = 1.0;
      o_.lines[k].body = m.id;
      o_.lines[k].body_size_known = size_known;
      o_.lines[k].body_origin = origin;
      o_.lines[k].body_turned = turned;
    }
    places_ = places;
  }

  void add(const Vector& at, std::size_t line, double deviation, std::uint32_t source) {
    for (std::size_t k = 0; k < 3; ++k)
      if (places_[k]) {
        o_.axes[axis_[k]].position.push_back(at[k]);
        o_.axes[axis_[k]].approach.push_back(1);  // unknown, therefore equal for all readings
      }
    o_.line.push_back(static_cast<std::uint32_t>(line));
    o_.deviation.push_back(deviation);
    o_.source_line.push_back(source);
  }

  Observations made() {
    std::array<std::uint32_t, 3> number{};
    std::vector<Observations::Line> lines;
    for (std::uint32_t k = 0; k < 3; ++k) {
      number[k] = static_cast<std::uint32_t>(lines.size());
      if (std::find(o_.line.begin(), o_.line.end(), k) != o_.line.end())
        lines.push_back(o_.lines[k]);
    }
    for (std::uint32_t& line : o_.line) line = number[line];
    o_.lines = std::move(lines);
    return std::move(o_);
  }

 private:
  Observations o_;
  std::array<bool, 3> places_{};
  std::array<std::size_t, 3> axis_{};
};

bool is_multiple(double x, double step) {
  return std::fabs(x - step * std::round(x / step)) < 1e-10;  // m
}

/// Rows that look like a mistake: columns exchanged, rows copied, a coordinate without readings.
std::vector<Finding> doubts_of(const Readings& r) {
  constexpr std::size_t least = 4;     // features
  constexpr double drawn = 1e-4;       // m; the places of a drawing are its multiples
  constexpr double resolution = 1e-5;  // m; measured places are no multiples of it
  constexpr double blank = 1e9;        // m; NaN has no order
  std::vector<Finding> out;
  std::vector<std::vector<double>> rows(r.size());
  for (std::size_t k = 0; k < 3; ++k) {
    const auto *to = r.column(nominal[k]), *from = r.column(measured[k]);
    if (to == nullptr || from == nullptr) continue;
    std::size_t features = 0, drawn_measured = 0, odd_nominal = 0, equal = 0;
    for (std::size_t i = 0; i < r.size(); ++i) {
      const double p = (*to)[i], m = (*from)[i];
      rows[i].insert(rows[i].end(), {p, std::isfinite(m) ? m : blank});
      if (!std::isfinite(p) || !std::isfinite(m)) continue;
      ++features;
      drawn_measured += is_multiple(m, drawn);
      odd_nominal += !is_multiple(p, resolution);
      equal += p == m;
    }
    if (features < least) continue;
    const auto add = [&](const char* id) {
      out.push_back({.id = id,
                     .attention = true,
                     .evidence = {{"features", static_cast<double>(features), Quantity::count}},
                     .texts = {{"along", coordinates[k]}}});
    };
    if (equal == features)
      add("plausibility.part-as-nominal");
    else if (drawn_measured == features && 2 * odd_nominal > features)
      add("plausibility.part-columns-exchanged");
  }
  // A feature that is measured twice differs in the last digits, if not in all coordinates.
  std::map<std::vector<double>, std::size_t> times;
  std::size_t copies = 0;
  for (const auto& row : rows) copies += ++times[row] > 1;
  if (copies >= least && 4 * copies >= r.size())
    out.push_back({.id = "plausibility.part-rows-twice",
                   .attention = true,
                   .evidence = {{"copies", static_cast<double>(copies), Quantity::count},
                                {"rows", static_cast<double>(r.size()), Quantity::count}}});
  return out;
}

Expected<Observations> observations_of(const MethodInput& in) {
  const Measurement& m = in.measurement;
  const Readings& r = in.readings;
  NONIO_TRY(const auto growth, growth_of(m));
  const double angle = m.settings.number("turned_deg") * std::numbers::pi / 180.0;
  const NumberTable origin = m.settings.table("origin");
  Vector from{};
  for (std::size_t k = 0; k < 3; ++k)
    if (const auto at = origin.find(coordinates[k]); at != origin.end())
      from[k] = at->second * 1e-3;
  const std::vector<double>* z = r.column(nominal[2]);
  Rows rows(m, {true, true, z != nullptr}, growth.second, from, angle);
  const auto [turn, shift] = placed(r);
  const Vector back{-turn[0], -turn[1], -turn[2]};
  std::uint64_t missing = 0;
  for (std::size_t i = 0; i < r.size(); ++i) {
    const Vector p{(*r.column(nominal[0]))[i], (*r.column(nominal[1]))[i],
                   z == nullptr ? 0.0 : (*z)[i]};
    if (std::isnan(p[2]))
      return fail("nominal_z: expected a number in each row, or no such column");
    Vector place = turned(p, turn);
    for (std::size_t k = 0; k < 3; ++k) place[k] += shift[k];  // kept where it was not measured
    std::array<bool, 3> has{};
    for (std::size_t k = 0; k < 3; ++k) {
      const auto* found = r.column(measured[k]);
      if (found == nullptr) continue;
      has[k] = !std::isnan((*found)[i]) && (k < 2 || z != nullptr);
      if (!has[k]) {
        ++missing;
        continue;
      }
      place[k] = (*found)[i];
      if (std::fabs(place[k] - p[k] * (1.0 + growth.first)) > largest)
        return fail(Error{
            std::string(measured[k]) +
                ": expected a place within 10 mm of the nominal one; is the frame of the "
                "measurement turned or mirrored, are columns exchanged, or is it another unit?",
            m.file, r.source_line[i]});
    }
    if (has[0] != has[1] && !is_quarter(angle))
      return fail(
          Error{"expected both coordinates of a feature of a part that was not turned by a "
                "multiple of 90 deg",
                m.file, r.source_line[i]});
    Vector d = turned(place, back);
    const Vector of_turn = cross(turn, p);
    for (std::size_t k = 0; k < 3; ++k) d[k] += of_turn[k] - p[k] * (1.0 + growth.first);
    const Vector at = turned(p, angle), error = turned(d, angle);
    const Vector which = turned({has[0] ? 1.0 : 0.0, has[1] ? 1.0 : 0.0, 0.0}, angle);
    for (std::size_t k = 0; k < 3; ++k) {
      const bool sensed = k == 2 ? has[2] : (has[0] && has[1]) || std::fabs(which[k]) > 0.5;
      if (sensed)
        rows.add({from[0] + at[0], from[1] + at[1], from[2] + at[2]}, k, error[k],
                 r.source_line[i]);
    }
  }
  Observations o = rows.made();
  o.missing = missing;
  o.doubts = doubts_of(r);
  o.order_known = false;  // the order of measurement is not the order of machining
  return o;
}

Expected<Readings> readings_of_part(const SimulationInput& in) {
  const Measurement& m = in.measurement;
  NONIO_TRY(const auto growth, growth_of(m));
  const double angle = m.settings.number("turned_deg") * std::numbers::pi / 180.0;
  const NumberTable origin = m.settings.table("origin");
  const Observations& o = in.observations;
  struct Feature {
    Vector at{}, error{};
    std::array<bool, 3> has{};
  };
  std::map<std::uint32_t, Feature> features;
  for (std::size_t i = 0; i < o.size(); ++i) {
    Feature& f = features[o.source_line_of(i)];
    const auto& sense = o.sense_of(i);
    for (std::size_t k = 0; k < 3; ++k) {
      const auto from = origin.find(coordinates[k]);
      if (const auto* axis = o.axis(coordinates[k]))
        f.at[k] = axis->position[i] - (from == origin.end() ? 0.0 : from->second * 1e-3);
      if (sense[k] > 0.5) f.error[k] = o.deviation[i], f.has[k] = true;
    }
  }
  Readings out;
  const double nothing = std::nan("");
  for (const auto& [line, f] : features) {
    const Vector p = turned(f.at, -angle), d = turned(f.error, -angle);
    const Vector which = turned({f.has[0] ? 1.0 : 0.0, f.has[1] ? 1.0 : 0.0, 0.0}, -angle);
    for (std::size_t k = 0; k < 3; ++k) {
      const bool sensed = k == 2 ? f.has[2] : (f.has[0] && f.has[1]) || std::fabs(which[k]) > 0.5;
      if (k < 2 || o.axis("Z") != nullptr) out.columns[nominal[k]].push_back(p[k]);
      if (k < 2 || o.axis("Z") != nullptr)
        out.columns[measured[k]].push_back(sensed ? p[k] * (1.0 + growth.first) + d[k] : nothing);
    }
    out.source_line.push_back(line);
  }
  return out;
}

Method part() {
  Method m;
  m.info = {
      "part",
      "1.0",
      "Features of a part that the machine made: nominal and measured places",
      {{.name = "origin",
        .default_value = NumberTable{},
        .unit = "mm",
        .help = "Where the zero of the part was in the machine. Default: in its zero."},
       {.name = "turned_deg",
        .default_value = 0.0,
        .unit = "deg",
        .help = "By how much the part was turned about Z on the machine, from X to Y: errors of "
                "the machine turn against the part, those of a fixture and of the measuring "
                "machine with it.",
        .min = -360.0,
        .max = 360.0},
       {.name = "temperatures_c",
        .default_value = std::vector<double>{},
        .unit = "degC",
        .help = "Temperature of the part while it was made, and the one to which its "
                "measurement refers. Without them its size is unknown."},
       {.name = "expansion_um_per_m_K",
        .default_value = 0.0,
        .unit = "um/(m K)",
        .help = "Coefficient of expansion of the part; needed with temperatures_c.",
        .min = 0.0,
        .max = 100.0},
       {.name = "order",
        .default_value = std::string(),
        .unit = "",
        .help = "Order of the rows: that in which the machine made the features (as-listed), over "
                "which residuals are shown, or unknown; pendulum is unknown too.",
        .choices = {"pendulum", "as-listed", "unknown"}}}};
  using Role = Method::Column::Role;
  m.columns = {{nominal[0], Quantity::length, Role::none, "Nominal place of the feature, X."},
               {nominal[1], Quantity::length, Role::none, "The same, Y."},
               {nominal[2], Quantity::length, Role::none, "The same, Z.", false},
               {measured[0], Quantity::length, Role::none,
                "Measured place, X; blank where it was not measured.", false},
               {measured[1], Quantity::length, Role::none, "The same, Y.", false},
               {measured[2], Quantity::length, Role::none, "The same, Z.", false}};
  m.observe = observations_of;
  m.simulate = readings_of_part;
  return m;
}

}  // namespace

NONIO_PLUGIN(registry) { registry.add(part()); }

}  // namespace nonio::parts_method
