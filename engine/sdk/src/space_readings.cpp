// SPDX-License-Identifier: Apache-2.0
#include "nonio/sdk/space_readings.h"

namespace nonio {

SpaceReadings space_of(const Observations& o) {
  SpaceReadings out;
  for (const auto& axis : o.axes) {
    const std::size_t k = coordinate_of(axis.axis);
    if (axis.rotary || k > 2) continue;
    auto& r = out.r[k];
    r.resize(o.size(), std::numeric_limits<double>::quiet_NaN());
    for (std::size_t i = 0; i < o.size(); ++i)
      if (std::isfinite(axis.position[i])) r[i] = axis.position[i];
  }
  for (std::size_t k = 0; k < 3; ++k) {
    double low = std::numeric_limits<double>::infinity(), high = -low;
    for (const double x : out.r[k])
      if (std::isfinite(x)) low = std::min(low, x), high = std::max(high, x);
    if (!(low <= high)) continue;
    out.length[k] = high - low;
    for (double& x : out.r[k]) x -= low;
  }
  return out;
}

std::optional<Observations> in_bodies(const Observations& o) {
  constexpr double same = 1e-6;  // rad
  constexpr double nowhere = std::numeric_limits<double>::quiet_NaN();
  const Observations::Line* first = nullptr;
  bool differ = false;
  for (const Observations::Line& line : o.lines) {
    if (line.body.empty()) continue;
    if (first == nullptr) first = &line;
    const double angle = line.body_turned - first->body_turned;
    differ = differ || std::fabs(std::sin(angle / 2.0)) > same;
  }
  if (!differ || o.axis("X") == nullptr || o.axis("Y") == nullptr) return std::nullopt;
  Observations out = o;
  std::array<std::vector<double>*, 2> at{};
  for (auto& axis : out.axes)
    if (const std::size_t k = coordinate_of(axis.axis); k < 2) at[k] = &axis.position;
  out.sense.resize(o.size());
  for (std::size_t i = 0; i < o.size(); ++i) {
    const Observations::Line& line = o.lines[o.line_of(i)];
    const double c = std::cos(line.body_turned), s = std::sin(line.body_turned);
    const double x = (*at[0])[i] - line.body_origin[0], y = (*at[1])[i] - line.body_origin[1];
    const bool is_of_body = !line.body.empty();
    (*at[0])[i] = is_of_body ? c * x + s * y : nowhere;
    (*at[1])[i] = is_of_body ? c * y - s * x : nowhere;
    const auto& n = o.sense_of(i);
    out.sense[i] = {c * n[0] + s * n[1], c * n[1] - s * n[0], n[2]};
  }
  return out;
}

namespace {

/// `in_bodies`; for an effect of one axis, std::nullopt if some readings are of no body.
std::optional<Observations> for_effect(const Effect& of, const Observations& o) {
  const auto free = [](const Observations::Line& l) { return l.body.empty(); };
  if (!of.instances && std::any_of(o.lines.begin(), o.lines.end(), free)) return std::nullopt;
  return in_bodies(o);
}

}  // namespace

Effect in_frame_of_parts(const Effect& of, Info info) {
  Effect out = of;
  out.info = std::move(info);
  out.compensable = false, out.of_part.clear(), out.why_not = {};
  out.instances = [of](const Observations& o) -> std::vector<std::string> {
    const auto in = for_effect(of, o);
    if (!in) return {};
    return of.instances ? of.instances(*in) : std::vector<std::string>{"X", "Y"};
  };
  for (Effect::Shape& shape : out.shapes)
    shape.grid = [of, grid = shape.grid](const Observations& o, const Axis& axis) {
      const auto in = for_effect(of, o);
      return in ? grid(*in, axis) : std::vector<double>();
    };
  out.applies = [of](const Observations& o, const Axis& axis) {
    const auto in = for_effect(of, o);
    return in && of.applies(*in, axis);
  };
  out.columns = [of, name = out.info.name](const Observations& o, const Axis& axis,
                                           const std::vector<double>& shape) {
    const auto in = for_effect(of, o);
    const std::size_t k = coordinate_of(axis.name);
    if (!in || (!of.instances && k > 1))
      return Expected<Effect::Columns>(
          fail(name + ": expected parts that were turned by different angles"));
    auto columns = of.columns(*in, axis, shape);
    // Of an axis, the component along the direction of sensing.
    for (std::size_t c = 0; columns && !of.instances && c < columns->size(); ++c)
      for (std::size_t i = 0; i < o.size(); ++i) (*columns)[c][i] *= in->sense[i][k];
    return columns;
  };
  return out;
}

bool of_ball_centres(const Observations& o) {
  return !o.angular && !o.axes.empty() && o.axes.front().rotary;
}

bool varies_where_sensed(const Observations& o, const SpaceReadings& s, std::size_t k,
                         std::size_t error, std::optional<std::size_t> away) {
  constexpr double never = std::numeric_limits<double>::quiet_NaN();
  std::vector<double> first(std::max<std::size_t>(o.lines.size(), 1), never);
  for (std::size_t i = 0; i < s.r[k].size(); ++i) {
    if (!std::isfinite(s.r[k][i]) || !(std::fabs(o.sense_of(i)[error]) > 1e-9)) continue;
    if (away && !(s.lever(*away, i) > 1e-9 * s.length[*away])) continue;
    double& x = first[o.line.empty() ? 0 : o.line[i]];
    if (!std::isfinite(x)) x = s.r[k][i];
    if (std::fabs(s.r[k][i] - x) > 1e-9 * s.length[k]) return true;
  }
  return false;
}

std::vector<double> places_of(const SpaceReadings& s, std::size_t k) {
  std::vector<double> places;
  for (const double x : s.r[k])
    if (std::isfinite(x)) places.push_back(x);
  std::sort(places.begin(), places.end());
  const double near = 1e-9 * s.length[k];
  places.erase(std::unique(places.begin(), places.end(),
                           [near](double a, double b) { return b - a <= near; }),
               places.end());
  return places;
}

bool of_parts(const Observations& o) {
  return !o.lines.empty() && std::all_of(o.lines.begin(), o.lines.end(),
                                         [](const auto& line) { return !line.body.empty(); });
}

std::vector<double> knots_over(const std::vector<double>& places) {
  const std::size_t n = places.size();
  if (n < 6) return n < 4 ? std::vector<double>{} : std::vector<double>{2.0};
  std::vector<double> knots;
  for (std::size_t k = 3; k < std::clamp<std::size_t>(n / 2, 4, 11); ++k)
    knots.push_back(static_cast<double>(k));
  return knots;
}

SpaceLine space_line(const Observations& o, const SpaceReadings& s, std::size_t line) {
  SpaceLine out;
  const auto same_are_known = [&s](std::size_t one, std::size_t other) {
    return std::all_of(s.r.begin(), s.r.end(), [=](const std::vector<double>& r) {
      return r.empty() || std::isfinite(r[one]) == std::isfinite(r[other]);
    });
  };
  for (std::size_t i = 0; i < o.size(); ++i) {
    if ((o.line.empty() ? 0 : o.line[i]) != line) continue;
    if (!out.rows.empty() && !same_are_known(i, out.rows.front())) continue;
    out.way.push_back({s.lever(0, i), s.lever(1, i), s.lever(2, i)});
    out.rows.push_back(i);
  }
  if (out.rows.empty()) return out;
  out.sense = o.sense_of(out.rows.front());
  const auto first = out.way.front();
  for (auto& way : out.way) {
    for (std::size_t k = 0; k < 3; ++k) way[k] -= first[k];
    if (const double length = std::sqrt(SpaceLine::dot(way, way)); length > out.length)
      out.length = length, out.farthest = way;
  }
  for (const auto& way : out.way) {
    // perpendicular distance times the length of `farthest`
    const auto off = SpaceLine::cross(way, out.farthest);
    if (std::sqrt(SpaceLine::dot(off, off)) > 1e-4 * out.length * out.length) out.straight = false;
  }
  return out;
}

std::vector<double> finite_or_zero(std::vector<double> x) {
  for (double& v : x)
    if (!std::isfinite(v)) v = 0.0;
  return x;
}

}  // namespace nonio
