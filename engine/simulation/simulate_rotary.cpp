// SPDX-License-Identifier: Apache-2.0
#include <cmath>

#include "simulation/simulate_rows.h"

namespace nonio::simulation {
namespace {

using Vector = std::array<double, 3>;

Vector sum(const Vector& a, double f, const Vector& b) {
  return {a[0] + f * b[0], a[1] + f * b[1], a[2] + f * b[2]};
}
double dot(const Vector& a, const Vector& b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }
Vector cross(const Vector& a, const Vector& b) {
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}

/// Rotates v about n (Rodrigues).
Vector rotated(const Vector& v, const Vector& n, double angle) {
  const double c = std::cos(angle), s = std::sin(angle);
  const Vector across = cross(n, v);
  Vector out{};
  for (std::size_t k = 0; k < 3; ++k)
    out[k] = c * v[k] + s * across[k] + (1.0 - c) * dot(n, v) * n[k];
  return out;
}

class Rows {
 public:
  explicit Rows(const CycleSpec& c) : c_(c), clock_(c) {
    o_.measurement = c.measurement.id;
    o_.axes.push_back({c.axis.name, true, {}, {}});
    for (const char* axis : {"X", "Y", "Z"}) o_.axes.push_back({axis, false, {}, {}});
    if (!c.carrier.empty()) o_.axes.push_back({c.carrier, true, {}, {}});
  }
  void line(std::string name, const Vector& sense) { o_.lines.push_back({std::move(name), sense}); }

  /// For each angle, `put(angle)` adds the readings of one position with `add`. With a carrier,
  /// each run is repeated at each position of the carrier.
  template <class Put>
  void sweep(Put put) {
    last_ = c_.targets.front();
    const std::vector<double> carrier = c_.carrier.empty() ? std::vector{0.0} : c_.carrier_at;
    for (std::uint32_t run = 1; run <= c_.runs; ++run) {
      if (run > 1) clock_.pause();
      run_ = run;
      for (const double at : carrier) {
        turned_ = std::fabs(at - carrier_);
        carrier_ = at;
        passes(put);
      }
    }
  }
  double carrier() const { return carrier_; }
  void add(std::size_t line, const Vector& at, const Vector& sense, double deviation, bool first) {
    o_.axes[0].position.push_back(angle_);
    o_.axes[0].approach.push_back(direction_);
    for (std::size_t k = 0; k < 3; ++k) o_.axes[1 + k].position.push_back(at[k]);
    if (!c_.carrier.empty()) o_.axes[4].position.push_back(carrier_);
    o_.deviation.push_back(deviation);
    o_.sense.push_back(sense);
    o_.line.push_back(static_cast<std::uint32_t>(line));
    o_.run.push_back(run_);
    if (first) {
      clock_.reading(o_, way_);
    } else {
      o_.time.push_back(o_.time.back());
      o_.material.push_back(o_.material.back());
    }
  }
  Observations done() { return std::move(o_); }

 private:
  template <class Put>
  void passes(Put put) {
    for (int pass = 0; pass < (c_.pendulum ? 2 : 1); ++pass) {
      direction_ = static_cast<std::int8_t>(pass == 0 ? c_.direction : -c_.direction);
      for (std::size_t i = 0; i < c_.targets.size(); ++i) {
        angle_ = c_.targets[direction_ > 0 ? i : c_.targets.size() - 1 - i];
        way_ = std::max(std::fabs(angle_ - last_), turned_);
        last_ = angle_;
        turned_ = 0.0;
        put(angle_);
      }
    }
  }

  const CycleSpec& c_;
  Clock clock_;
  Observations o_;
  double angle_ = 0.0, way_ = 0.0, last_ = 0.0;
  double carrier_ = 0.0, turned_ = 0.0;
  std::int8_t direction_ = 1;
  std::uint32_t run_ = 1;
};

constexpr std::array<Vector, 3> units{{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}};

/// The deviations are the positions of the linear axes when the probe is at the ball. A table moves
/// the ball, and its carrier moves table and ball. A head moves the stylus, which is at the ball if
/// the heads are at 0, and its carrier moves head and stylus; the linear axes compensate this
/// movement.
Observations centres(const RotarySpec& r, const RotarySpec* carrier, const CycleSpec& c) {
  Rows rows(c);
  for (std::size_t k = 0; k < 3; ++k) rows.line(c.measurement.id + " " + "xyz"[k], units[k]);
  const Vector& start = c.balls.front();
  rows.sweep([&](double angle) {
    Vector ball = start, tip = start;
    (r.carries == "head" ? tip : ball) = turned(start, r.centre, r.direction, angle);
    if (carrier != nullptr) {
      Vector& moved = carrier->carries == "head" ? tip : ball;
      moved = turned(moved, carrier->centre, carrier->direction, rows.carrier());
    }
    const Vector at = sum(sum(ball, 1.0, start), -1.0, tip);
    for (std::size_t k = 0; k < 3; ++k) rows.add(k, at, units[k], at[k], k == 0);
  });
  return rows.done();
}

/// Readings of kind rtcp: position of the tool relative to the workpiece along each direction of
/// sensing, minus the position computed by the control, while the axis rotates. Table: the axis
/// moves the ball, and the tool follows the computed position. Head: the axis moves the tool, and
/// the linear axes compensate the computed movement.
Observations with_tool_centre(const RotarySpec& r, const CycleSpec& c) {
  const Vector centre = r.control_centre.value_or(r.centre),
               direction = r.control_direction.value_or(r.direction);
  const bool head = r.carries == "head", probe = c.sensor == "probe";
  const std::size_t senses = probe ? 3 : c.senses.size();
  Rows rows(c);
  for (std::size_t b = 0; b < c.balls.size(); ++b)
    for (std::size_t k = 0; k < senses; ++k) {
      const std::string ball = c.balls.size() > 1 ? "ball " + std::to_string(b + 1) : "ball";
      rows.line(probe ? ball + " " + "xyz"[k] : ball + " gauge " + std::to_string(k + 1),
                probe ? units[k] : c.senses[k]);
    }
  for (std::size_t b = 0; b < c.balls.size(); ++b)
    rows.sweep([&](double angle) {
      const Vector meant = turned(c.balls[b], centre, direction, angle),
                   is = turned(sum(c.balls[b], 1.0, c.ball_offset), r.centre, r.direction, angle);
      const Vector moved = sum(is, -1.0, meant);
      // Position of the linear axes. Table: the computed position of the ball. Head: the ball minus
      // the computed vector from the head's center to the tool.
      const Vector at = head ? sum(sum(c.balls[b], 1.0, centre), -1.0, meant) : meant;
      for (std::size_t k = 0; k < senses; ++k) {
        const Vector sense = probe                 ? units[k]
                             : c.sensor == "turns" ? rotated(c.senses[k], direction, angle)
                                                   : c.senses[k];
        rows.add(b * senses + k, at, sense, (head ? 1.0 : -1.0) * dot(sense, moved), k == 0);
      }
    });
  return rows.done();
}

}  // namespace

std::array<double, 3> turned(const std::array<double, 3>& ball, const std::array<double, 3>& centre,
                             const std::array<double, 3>& direction, double angle) {
  return sum(centre, 1.0, rotated(sum(ball, -1.0, centre), direction, angle));
}

Expected<Observations> rotary_rows(const Specification& s, const CycleSpec& c) {
  const RotarySpec* r = s.rotary(c.axis.name);
  if (r == nullptr)
    return fail("measurement \"" + c.measurement.id + "\": expected a [[simulation.rotary]] of " +
                "axis " + c.axis.name + ", which states where it is");
  const RotarySpec* carrier = c.carrier.empty() ? nullptr : s.rotary(c.carrier);
  if (carrier == nullptr && !c.carrier.empty())
    return fail("measurement \"" + c.measurement.id + "\": expected a [[simulation.rotary]] of " +
                "axis " + c.carrier + ", which turned too");
  if (c.is("ball-centres")) return centres(*r, carrier, c);
  if (r->carries.empty())
    return fail("[[simulation.rotary]] of axis " + c.axis.name +
                ": carries is missing: table or head");
  return with_tool_centre(*r, c);
}

}  // namespace nonio::simulation
