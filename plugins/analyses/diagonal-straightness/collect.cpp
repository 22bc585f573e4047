// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>

#include "nonio/sdk/format.h"
#include "sets.h"

namespace nonio::diagonal_straightness {

namespace {

using Text = std::pair<std::string, std::string>;

tl::unexpected<Finding> refuse(std::string id, std::vector<Text> texts,
                               std::vector<Number> evidence = {}) {
  return tl::unexpected<Finding>(Finding{.id = "diagonals." + std::move(id),
                                         .attention = true,
                                         .evidence = std::move(evidence),
                                         .texts = std::move(texts)});
}

std::string mm_text(double m) {
  std::string text = fixed_text(1e3 * m, 3);
  text.erase(text.find_last_not_of('0') + 1);
  if (text.back() == '.') text.pop_back();
  return text;
}

std::string list(const std::vector<std::string>& ids) {
  std::string out;
  for (const std::string& id : ids) out += (out.empty() ? "" : ", ") + id;
  return out;
}

class Gatherer {
 public:
  Gatherer(const AnalysisInput& in, const std::vector<Set>& sets, const Set& set)
      : in_(in), sets_(sets), set_(set) {}

  OrRefusal<Collected> run() {
    for (const auto step :
         {&Gatherer::sort_lines, &Gatherer::lay_grid, &Gatherer::find_y, &Gatherer::find_x,
          &Gatherer::look_at_heights, &Gatherer::find_straightness})
      if (auto done = (this->*step)(); !done) return tl::unexpected<Finding>(done.error());
    add_third_lines();
    out_.one_direction = out_.readings.D1.x_direction != 0 || out_.readings.D2.x_direction != 0;
    if (out_.one_direction)
      tell_one_direction();
    else
      compare_reversals();
    return std::move(out_);
  }

 private:
  using Step = OrRefusal<void>;

  const Measurement& measurement(std::size_t i) const { return in_.campaign.measurements[i]; }
  const Observations& observations(std::size_t i) const { return (*in_.all)[i]; }
  void use(std::size_t i) {
    if (measurement(i).id != in_.measurement.id) out_.uses.push_back(measurement(i).id);
  }
  std::pair<double, double> ends(std::size_t i, const std::string& axis) const {
    const double a = measurement(i).from.at(axis), b = measurement(i).to.at(axis);
    return std::minmax(a, b);
  }
  bool in_plane(std::size_t i) const {
    return observations(i).size() > 0 && observations(i).axes.size() == 2;
  }
  bool rises(std::size_t i) const {
    const auto& sense = observations(i).lines.front().sense;
    return sense[0] * sense[1] > 0.0;
  }

  /// The two lines over the largest rectangle: D1, on which both axes rise together, and D2.
  Step sort_lines() {
    std::vector<std::size_t> lines;
    for (const std::size_t i : set_.lines)
      if (in_plane(i) && observations(i).axes[0].axis[0] == 'X' &&
          observations(i).axes[1].axis[0] == 'Y')
        lines.push_back(i);
    std::vector<std::string> all;
    for (const std::size_t i : set_.lines) all.push_back(measurement(i).id);
    if (lines.empty()) return refuse("refused-missing-diagonal", {{"found", list(all)}});
    const auto area = [&](std::size_t i) {
      const auto& axes = observations(i).axes;
      const auto x = ends(i, axes[0].axis), y = ends(i, axes[1].axis);
      return (x.second - x.first) * (y.second - y.first);
    };
    const std::size_t widest =
        *std::max_element(lines.begin(), lines.end(),
                          [&](std::size_t a, std::size_t b) { return area(a) < area(b); });
    if (auto carrier = find_carrier(widest); !carrier) return carrier;
    std::vector<std::size_t> up, down;
    for (const std::size_t i : lines) {
      const bool whole = same_ends(i, widest);
      if (!whole)
        third_.push_back(i);
      else
        (rises(i) ? up : down).push_back(i);
    }
    if (up.size() > 1 || down.size() > 1) {
      std::vector<std::string> ids;
      for (const std::size_t i : up.size() > 1 ? up : down) ids.push_back(measurement(i).id);
      return refuse("refused-sets", {{"which", list(ids)}});
    }
    if (up.empty() || down.empty())
      return refuse("refused-missing-diagonal", {{"found", list(all)}});
    out_.D1 = up.front();
    out_.D2 = down.front();
    use(out_.D1);
    use(out_.D2);
    return {};
  }

  /// X of the kernel is the axis that carries the other one. Its yaw acts over the travel of the
  /// other axis, so it is measured on two lines. On a gantry this axis is driven on both sides.
  Step find_carrier(std::size_t widest) {
    const std::string &x = observations(widest).axes[0].axis,
                      &y = observations(widest).axes[1].axis;
    const auto lines_x = candidates("axis", x), lines_y = candidates("axis", y);
    const bool sides_x = two_sides(x, lines_x), sides_y = two_sides(y, lines_y);
    bool carries_y = sides_y && !sides_x;
    if (sides_x == sides_y && lines_y.size() == 2 && lines_x.size() == 1 &&
        candidates("angle", x, "Z").empty()) {
      const std::string& structure = in_.campaign.machine.structure;
      carries_y = structure == "gantry" || structure == "bridge";
      if (!carries_y)
        return refuse("refused-carrier", {{"axis", y}, {"other", x}, {"which", ids(lines_y)}});
    }
    out_.x_axis = carries_y ? y : x;
    out_.y_axis = carries_y ? x : y;
    out_.mirrored = carries_y;
    first_ = carries_y ? 1 : 0;
    return {};
  }

  bool two_sides(const std::string& name, const std::vector<std::size_t>& lines) const {
    const Axis* axis = in_.campaign.machine.axis(name);
    return (axis != nullptr && !axis->slave.empty()) ||
           std::any_of(lines.begin(), lines.end(),
                       [&](std::size_t i) { return !measurement(i).side.empty(); });
  }

  math::MeasuredLine curve_of_line(std::size_t i) const {
    return math::measured_line(observations(i), first_);
  }
  double sense_of(std::size_t i) const { return observations(i).lines.front().sense[first_]; }

  bool same_ends(std::size_t a, std::size_t b) const {
    for (std::size_t k = 0; k < 2; ++k) {
      const std::string& one = observations(a).axes[k].axis;
      if (one != observations(b).axes[k].axis) return false;
      const auto x = ends(a, one), y = ends(b, one);
      if (std::fabs(x.first - y.first) > math::same_stop ||
          std::fabs(x.second - y.second) > math::same_stop)
        return false;
    }
    return true;
  }

  Step lay_grid() {
    const auto x = ends(out_.D1, out_.x_axis), y = ends(out_.D1, out_.y_axis);
    out_.x0 = x.first;
    out_.y0 = y.first;
    auto& r = out_.readings;
    r.Lx = x.second - x.first;
    r.Ly = y.second - y.first;
    d1_ = curve_of_line(out_.D1);
    d2_ = curve_of_line(out_.D2);
    if (d1_.stops.size() != d2_.stops.size())
      return refuse("refused-stops", {{"why", std::to_string(d1_.stops.size()) + " / " +
                                                  std::to_string(d2_.stops.size())},
                                      {"one", measurement(out_.D1).id},
                                      {"other", measurement(out_.D2).id}});
    r.n = d1_.stops.size() - 1;
    if (r.n < 3) return bad_stop(out_.D1, d1_.stops.front());
    for (const auto& [i, curve] : {std::pair{out_.D1, &d1_}, std::pair{out_.D2, &d2_}})
      for (std::size_t k = 0; k <= r.n; ++k) {
        const math::MeasuredLine::Stop& stop = curve->stops[k];
        const std::size_t across = i == out_.D1 ? k : r.n - k;
        if (std::fabs(stop.position - grid_x(k)) > math::same_stop ||
            std::fabs(stop.across - grid_y(across)) > math::same_stop)
          return bad_stop(i, stop);
      }
    if (!d1_.direction() || !d2_.direction())
      return one_direction({d1_.direction() ? out_.D2 : out_.D1});
    r.D1 = line_of(out_.D1, d1_);
    r.D2 = line_of(out_.D2, d2_);
    for (std::size_t k = 0; k <= r.n; ++k) {
      r.D1.ix.push_back(k);
      r.D1.iy.push_back(k);
      r.D2.ix.push_back(k);
      r.D2.iy.push_back(r.n - k);
    }
    return {};
  }

  double step_x() const { return out_.readings.Lx / static_cast<double>(out_.readings.n); }
  double step_y() const { return out_.readings.Ly / static_cast<double>(out_.readings.n); }
  double grid_x(std::size_t i) const { return out_.x0 + step_x() * static_cast<double>(i); }
  double grid_y(std::size_t i) const { return out_.y0 + step_y() * static_cast<double>(i); }

  tl::unexpected<Finding> bad_stop(std::size_t i, const math::MeasuredLine::Stop& stop) const {
    std::string why = out_.x_axis + " " + mm_text(stop.position) + ", " + out_.y_axis + " " +
                      mm_text(stop.across) + " mm";
    if (stop.source_line > 0)
      why += " (" + measurement(i).file + ":" + std::to_string(stop.source_line) + ")";
    return refuse("refused-stops", {{"why", std::move(why)},
                                    {"one", measurement(i).id},
                                    {"other", measurement(i == out_.D1 ? out_.D2 : out_.D1).id}});
  }

  tl::unexpected<Finding> one_direction(const std::vector<std::size_t>& which) const {
    return refuse("refused-one-direction", {{"which", ids(which)}});
  }

  math::GridLine line_of(std::size_t i, const math::MeasuredLine& curve) {
    const auto& sense = observations(i).lines.front().sense;
    const double sign = sense_of(i) < 0.0 ? -1.0 : 1.0;
    math::GridLine line;
    line.cx = sign * sense[first_];
    line.cy = sign * sense[1 - first_];
    line.x_direction = curve.direction().value_or(0);
    line.y_direction = rises(i) ? line.x_direction : -line.x_direction;
    for (const math::MeasuredLine::Stop& stop : curve.stops)
      line.mean.push_back(sign * stop.mean(line.x_direction));
    put_u(line, curve, line.x_direction);
    line.zeroed = curve.zeroed;
    line.visits = curve.visits(line.x_direction);
    return line;
  }

  void put_u(math::MeanCurve& to, const math::MeasuredLine& curve, int direction) const {
    const double stated = in_.options.number("reading_u_um") * 1e-6;
    to.u = stated > 0.0 ? stated : curve.u_mean(direction);
    if (stated > 0.0) return;
    to.dof = static_cast<double>(curve.dof);
    if (curve.s > 0.0) to.walk_seen = curve.walk_seen * std::pow(to.u / curve.s, 2);
  }

  /// Measurements of this kind along an axis of this letter: those of the same state if there are
  /// any, otherwise those that belong to no other set.
  std::vector<std::size_t> candidates(const char* kind, const std::string& axis,
                                      const std::string& lateral = {}) const {
    std::vector<std::size_t> own, common;
    for (std::size_t i = 0; i < in_.campaign.measurements.size(); ++i) {
      const Measurement& m = measurement(i);
      if (m.kind != kind || m.axis.empty() || m.axis[0] != axis[0]) continue;
      if (!lateral.empty() && (m.lateral.empty() || m.lateral[0] != lateral[0])) continue;
      if (!m.reversal_of.empty()) continue;  // evaluated with the line that it reverses
      if (!m.square.empty()) continue;       // only the slope of a square's face is evaluated
      if (observations(i).size() == 0 || observations(i).axes.front().rotary) continue;
      const std::string of = state_of(m);
      const bool another = std::any_of(sets_.begin(), sets_.end(), [&](const Set& s) {
        return !s.name.empty() && s.name == of && s.name != set_.name;
      });
      if (of == set_.name)
        own.push_back(i);
      else if (!another)
        common.push_back(i);
    }
    return own.empty() ? common : own;
  }

  std::string ids(const std::vector<std::size_t>& which) const {
    std::vector<std::string> names;
    for (const std::size_t i : which) names.push_back(measurement(i).id);
    return list(names);
  }

  OrRefusal<math::MeasuredLine> on_grid(std::size_t i, bool along_x) {
    math::MeasuredLine all = math::measured_line(observations(i), 0);
    math::MeasuredLine out = all;
    out.stops.clear();
    for (std::size_t k = 0; k <= out_.readings.n; ++k) {
      const double wanted = along_x ? grid_x(k) : grid_y(k);
      const std::size_t found = all.find(wanted);
      if (found == all.stops.size())
        return refuse("refused-pitch-points",
                      {{"id", measurement(i).id}, {"axis", measurement(i).axis}},
                      {{"wanted", wanted, Quantity::length}});
      out.stops.push_back(all.stops[found]);
      if (k == 0 && found != 0) out.zeroed = false;
    }
    use(i);
    used_.push_back(i);
    return out;
  }

  void put(math::MeanCurve& to, const math::MeasuredLine& curve, int direction) const {
    for (const math::MeasuredLine::Stop& stop : curve.stops)
      to.mean.push_back(stop.mean(direction));
    put_u(to, curve, direction);
    to.zeroed = curve.zeroed;
    to.visits = curve.visits(direction);
    to.direction = direction;
  }

  /// Directions of approach in which positioning of X or Y is needed. Those of the two diagonals,
  /// which are mandatory, come first.
  std::vector<int> directions(bool of_x) const {
    const auto& r = out_.readings;
    std::vector<int> out{of_x ? r.D1.x_direction : r.D1.y_direction};
    const auto add = [&](int d) {
      if (std::find(out.begin(), out.end(), d) == out.end()) out.push_back(d);
    };
    add(of_x ? r.D2.x_direction : r.D2.y_direction);
    for (const std::size_t i : third_)
      if (const auto d = curve_of_line(i).direction()) add(of_x || rises(i) ? *d : -*d);
    return out;
  }

  template <class T>
  bool put_all(std::vector<T>& to, const T& empty, const math::MeasuredLine& curve,
               bool of_x) const {
    const auto& r = out_.readings;
    for (const int d : directions(of_x)) {
      if (curve.has(d)) {
        put(to.emplace_back(empty), curve, d);
      } else if (d == (of_x ? r.D1.x_direction : r.D1.y_direction) ||
                 d == (of_x ? r.D2.x_direction : r.D2.y_direction)) {
        return false;
      }
    }
    return true;
  }

  Step find_y() {
    const auto found = candidates("axis", out_.y_axis);
    if (found.empty()) return refuse("refused-pitch", {{"axis", out_.y_axis}});
    if (found.size() > 1)
      return refuse("refused-ambiguous", {{"axis", out_.y_axis}, {"which", ids(found)}});
    auto curve = on_grid(found.front(), false);
    if (!curve) return tl::unexpected<Finding>(curve.error());
    if (!put_all(out_.readings.Y, {}, *curve, false)) return one_direction(found);
    y_ = *curve;
    reversal_y_ = curve->mean_reversal();
    return {};
  }

  std::string place_example() const { return "{ " + out_.y_axis + " = 500 }"; }

  const double* place(std::size_t i) const {
    const auto& at = measurement(i).at;
    const auto it = at.find(out_.y_axis);
    return it == at.end() ? nullptr : &it->second;
  }

  Step find_x() {
    auto found = candidates("axis", out_.x_axis);
    // The line of the slave is the second, in any manifest order, because `slave_shift` refers to
    // its zero.
    std::stable_partition(found.begin(), found.end(),
                          [&](std::size_t i) { return measurement(i).side != "slave"; });
    const auto yaw = candidates("angle", out_.x_axis, "Z");
    if (found.empty()) return refuse("refused-pitch", {{"axis", out_.x_axis}});
    if (yaw.size() > 1)
      return refuse("refused-ambiguous", {{"axis", out_.x_axis}, {"which", ids(yaw)}});
    if (found.size() == 1 && yaw.empty()) {
      const bool column = in_.campaign.machine.structure == "single-column";
      return refuse(column ? "refused-single-column" : "yaw-needed",
                    {{"axis", out_.x_axis},
                     {"at", place_example()},
                     {"curve", out_.mirrored ? "EXY" : "EYX"},
                     {"id", ids(found)}},
                    {{"bias", 1e-6 * out_.readings.Lx / 2.0, Quantity::deviation}});
    }
    const bool placed =
        std::all_of(found.begin(), found.end(), [&](std::size_t i) { return place(i) != nullptr; });
    if (found.size() <= 2 && !placed)
      return refuse("refused-place", {{"axis", out_.y_axis},
                                      {"of", out_.x_axis},
                                      {"at", place_example()},
                                      {"which", ids(found)}});
    if (found.size() > 2 ||
        (found.size() == 2 && !(std::fabs(*place(found[1]) - *place(found[0])) > math::same_stop)))
      return refuse("refused-ambiguous", {{"axis", out_.x_axis}, {"which", ids(found)}});
    for (const std::size_t i : found) {
      auto curve = on_grid(i, true);
      if (!curve) return tl::unexpected<Finding>(curve.error());
      math::PitchLine line;
      line.across = *place(i) - out_.y0;
      if (!put_all(out_.readings.X, line, *curve, true)) return one_direction({i});
      x_.push_back(*curve);
      reversal_x_ += curve->mean_reversal() / static_cast<double>(found.size());
    }
    out_.lines_of_x = ids(found);
    if (found.size() == 2) out_.sides_apart = std::fabs(*place(found[1]) - *place(found[0]));
    return yaw.empty() ? Step{} : find_yaw(yaw);
  }

  Step find_yaw(const std::vector<std::size_t>& found) {
    auto curve = on_grid(found.front(), true);
    if (!curve) return tl::unexpected<Finding>(curve.error());
    std::vector<math::MeanCurve> yaw;
    if (!put_all(yaw, {}, *curve, true)) return one_direction(found);
    const double stated = in_.options.number("yaw_u_urad") * 1e-6;
    for (math::MeanCurve& of : yaw) {
      if (out_.mirrored)  // A positive yaw rotates from X of the machine to Y.
        for (double& v : of.mean) v = -v;
      of.u = stated > 0.0 ? stated : curve->u_mean(of.direction);
      of.dof = stated > 0.0 ? INFINITY : static_cast<double>(curve->dof);
    }
    if (x_.size() == 1)
      out_.readings.ECX = std::move(yaw);
    else
      compare_yaw(yaw.front(), found);
    return {};
  }

  void compare_yaw(const math::MeanCurve& yaw, const std::vector<std::size_t>& found) {
    constexpr double limit = 4.0;
    const auto of = [&](std::size_t k) -> const math::PitchLine& {
      for (const math::PitchLine& line : out_.readings.X)
        if (line.direction == yaw.direction && k-- == 0) return line;
      return out_.readings.X.back();
    };
    const math::PitchLine &one = of(0), &other = of(1);
    const double W = other.across - one.across;
    const double u = std::sqrt(2.0) * std::hypot(one.u / W, other.u / W, yaw.u);
    double most = 0.0;
    for (std::size_t i = 0; i < yaw.mean.size(); ++i)
      most = std::max(most,
                      std::fabs(yaw.mean[i] - yaw.mean[0] -
                                (one.mean[i] - one.mean[0] - other.mean[i] + other.mean[0]) / W));
    if (one.u > 0.0 && yaw.u > 0.0 && most > limit * u)
      out_.findings.push_back({.id = "diagonals.yaw-disagrees",
                               .attention = true,
                               .evidence = {{"difference", most, Quantity::small_angle},
                                            {"limit", limit * u, Quantity::small_angle}},
                               .texts = {{"id", ids(found)}, {"lines", out_.lines_of_x}}});
  }

  /// Refuses positioning lines at another height (Z) than the diagonals, if both are stated.
  Step look_at_heights() {
    constexpr double other_height = 1e-3;
    const auto& from = measurement(out_.D1).from;
    const auto height = from.find("Z");
    if (height == from.end()) return {};
    for (const std::size_t i : used_) {
      const auto it = measurement(i).at.find("Z");
      if (it != measurement(i).at.end() && std::fabs(it->second - height->second) > other_height)
        return refuse("refused-height", {{"id", measurement(i).id}},
                      {{"height", it->second, Quantity::length},
                       {"height_of_diagonals", height->second, Quantity::length}});
    }
    return {};
  }

  std::optional<std::size_t> turned_over(std::size_t first) const {
    for (std::size_t i = 0; i < in_.campaign.measurements.size(); ++i)
      if (measurement(i).reversal_of == measurement(first).id) return i;
    return std::nullopt;
  }

  Step find_straightness() {
    const bool whole = in_.options.text("direct_straightness") == "whole";
    for (const bool along_x : {true, false}) {
      const std::string &axis = along_x ? out_.x_axis : out_.y_axis,
                        &other = along_x ? out_.y_axis : out_.x_axis;
      const auto found = candidates("straightness", axis, other);
      if (found.size() > 1)
        return refuse("refused-ambiguous", {{"axis", axis}, {"which", ids(found)}});
      if (found.empty()) continue;
      auto curve = on_grid(found.front(), along_x);
      if (!curve) return tl::unexpected<Finding>(curve.error());
      const auto& r = out_.readings;
      const int one = along_x ? r.D1.x_direction : r.D1.y_direction,
                two = along_x ? r.D2.x_direction : r.D2.y_direction, both = one == two ? one : 0;
      if (!curve->has(both)) return one_direction(found);
      math::DirectStraightness direct;
      put(direct, *curve, both);
      direct.whole = whole;
      direct.zeroed = false;
      if (const auto turned = turned_over(found.front())) {
        auto other_side = on_grid(*turned, along_x);
        if (!other_side) return tl::unexpected<Finding>(other_side.error());
        if (!other_side->has(both)) return one_direction({*turned});
        put(direct.reversed.emplace(), *other_side, both);
        direct.reversed->zeroed = false;
      }
      (along_x ? out_.readings.EYX : out_.readings.EXY) = std::move(direct);
    }
    return {};
  }

  void add_third_lines() {
    for (const std::size_t i : third_) {
      const math::MeasuredLine curve = curve_of_line(i);
      math::GridLine line = line_of(i, curve);
      const auto goes_with = [](const auto& curves, int direction) {
        return std::any_of(curves.begin(), curves.end(),
                           [&](const auto& c) { return c.direction == direction; });
      };
      const auto& r = out_.readings;
      bool fits = curve.stops.size() > 1 && curve.direction() && goes_with(r.X, line.x_direction) &&
                  goes_with(r.Y, line.y_direction) &&
                  (r.ECX.empty() || goes_with(r.ECX, line.x_direction));
      for (const math::MeasuredLine::Stop& stop : curve.stops) {
        const double a = (stop.position - out_.x0) / step_x(),
                     b = (stop.across - out_.y0) / step_y();
        fits = fits && std::fabs(a - std::round(a)) * step_x() <= math::same_stop &&
               std::fabs(b - std::round(b)) * step_y() <= math::same_stop && std::round(a) >= 0.0 &&
               std::round(b) >= 0.0 && std::round(a) <= static_cast<double>(out_.readings.n) &&
               std::round(b) <= static_cast<double>(out_.readings.n);
        if (!fits) break;
        line.ix.push_back(static_cast<std::size_t>(std::lround(a)));
        line.iy.push_back(static_cast<std::size_t>(std::lround(b)));
      }
      if (fits) {
        use(i);
        out_.readings.third.push_back(std::move(line));
      } else {
        out_.findings.push_back({.id = "diagonals.third-unused",
                                 .attention = true,
                                 .texts = {{"id", measurement(i).id}}});
      }
    }
  }

  /// Between D1 and D2 one axis changes direction, and so does its lateral reversal b. The even
  /// part of b biases the straightness of the other axis: c/(2s) b in EYX if Y changes, s/(2c) b in
  /// EXY if X does.
  void tell_one_direction() {
    const auto& r = out_.readings;
    const bool y_turns = r.D1.y_direction != r.D2.y_direction;
    const double ratio = y_turns ? r.Lx / r.Ly : r.Ly / r.Lx;
    out_.findings.push_back({.id = "diagonals.one-direction",
                             .attention = true,
                             .evidence = {{"bias", 1e-6 * ratio / 2.0, Quantity::deviation}},
                             .texts = {{"turns", y_turns ? out_.y_axis : out_.x_axis},
                                       {"curve", y_turns != out_.mirrored ? "EYX" : "EXY"},
                                       {"one", measurement(out_.D1).id},
                                       {"other", measurement(out_.D2).id}}});
  }

  /// B(D1) + B(D2) = 2 (c B(X) + s B(Y)) for the means over all targets. Lateral parts cancel.
  void compare_reversals() {
    const auto& r = out_.readings;
    const double c = std::fabs(r.D1.cx), s = std::fabs(r.D1.cy);
    const auto along = [&](std::size_t i, const math::MeasuredLine& curve) {
      return (sense_of(i) < 0.0 ? -1.0 : 1.0) * curve.mean_reversal();
    };
    out_.reversal_of_diagonals = along(out_.D1, d1_) + along(out_.D2, d2_);
    out_.reversal_of_axes = 2.0 * (c * reversal_x_ + s * reversal_y_);
    double squares = 0.0;
    const auto add = [&](const math::MeasuredLine& curve, double factor) {
      squares += factor * curve.u_mean() * curve.u_mean() / static_cast<double>(r.n + 1);
    };
    add(d1_, 4.0), add(d2_, 4.0), add(y_, 16.0);
    for (const math::MeasuredLine& curve : x_) add(curve, 16.0);
    out_.u_reversal = std::sqrt(squares);
  }

  const AnalysisInput& in_;
  const std::vector<Set>& sets_;
  const Set& set_;
  Collected out_;
  math::MeasuredLine d1_, d2_, y_;
  std::vector<math::MeasuredLine> x_;
  std::vector<std::size_t> third_, used_;
  std::size_t first_ = 0;  ///< column of the kernel's X in the observations of a line
  double reversal_x_ = 0.0, reversal_y_ = 0.0;
};

}  // namespace

OrRefusal<Collected> collect(const AnalysisInput& in, const std::vector<Set>& sets,
                             const Set& set) {
  return Gatherer(in, sets, set).run();
}

}  // namespace nonio::diagonal_straightness
