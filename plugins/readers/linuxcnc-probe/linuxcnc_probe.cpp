// SPDX-License-Identifier: Apache-2.0
#include "linuxcnc_probe.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <optional>

#include "lines.h"
#include "nonio/math/distributions.h"
#include "nonio/math/sphere.h"
#include "nonio/sdk/format.h"
#include "runs.h"

namespace nonio::linuxcnc_probe {
using namespace readers;

namespace {

constexpr std::size_t columns = 9;
constexpr double per_deg = 1.0 / deg_per_rad;
constexpr std::string_view rotary_letters = "ABC";

using Angles = std::array<double, 3>;  // of A, B and C, deg

struct Touch {
  std::array<double, 3> at{};
  Angles angle{};
  std::uint64_t line = 0;
};

struct Wish {
  double unit = 0.0;               ///< SI value of one unit of the log, m
  std::size_t axis = 0;            ///< index of the measured axis in A, B, C
  std::size_t touches = 0;         ///< touches per center; if 0, a center ends when the angle
                                   ///< changes
  double same_angle = 0.0;         ///< deg
  std::optional<double> radius{};  ///< stated radius of the ball, m; fitted if absent
  double limit = 0.0;              ///< largest accepted residual of a touch, m
};

Expected<Wish> wish_of(const ReadInput& input, const Axis& axis) {
  Wish wish;
  const std::string unit = input.options.text("unit");
  if (unit != "mm" && unit != "inch")
    return fail(of_option("unit",
                          "expected mm or inch, the unit of the program that probed; found "
                          "none. A log does not state it"));
  wish.unit = unit == "mm" ? 1e-3 : 0.0254;
  const std::size_t letter = rotary_letters.find(axis.name.front());
  if (letter == std::string_view::npos)
    return fail("expected a rotary axis named A, B or C as in the log's columns, found \"" +
                axis.name + "\"");
  wish.axis = letter;
  wish.touches = static_cast<std::size_t>(input.options.integer("touches"));
  wish.same_angle = input.options.number("same_angle_deg");
  if (const double r = input.options.number("radius_mm"); r > 0.0) wish.radius = 1e-3 * r;
  wish.limit = 1e-6 * input.options.number("limit_um");
  return wish;
}

Expected<std::vector<Touch>> touches_of(std::string_view bytes, const Wish& wish) {
  std::vector<Touch> touches;
  Numbers numbers(false);
  Lines lines(bytes);
  std::string_view line;
  while (lines.next(line)) {
    if (auto error = not_text(line)) return fail(at_line(lines.number(), error->message));
    const auto fields = by_blanks(line);
    if (fields.empty()) continue;
    if (fields.size() != columns)
      return fail(at_line(lines.number(), "expected nine numbers, X Y Z A B C U V W, found " +
                                              std::to_string(fields.size()) +
                                              " fields: " + shown(line)));
    std::array<double, columns> values{};
    for (std::size_t k = 0; k < columns; ++k) {
      NONIO_TRY(const auto value, numbers.number(fields[k], lines.number(), "a number"));
      values[k] = value;
    }
    touches.push_back({{values[0] * wish.unit, values[1] * wish.unit, values[2] * wish.unit},
                       {values[3], values[4], values[5]},
                       lines.number()});
  }
  if (touches.empty()) return fail("expected touches, found none");
  return touches;
}

using Group = std::vector<Touch>;

bool same_angles(const Angles& a, const Angles& b, double within) {
  for (std::size_t k = 0; k < a.size(); ++k)
    if (!(std::fabs(a[k] - b[k]) <= within)) return false;
  return true;
}

std::string words_of(const Angles& angles, const Wish& wish, const std::vector<std::size_t>& also) {
  std::string text;
  for (const std::size_t k : also)
    text += std::string(1, rotary_letters[k]) + " " + short_text(angles[k], 7) + ", ";
  if (!text.empty()) text += std::string(1, rotary_letters[wish.axis]) + " ";
  return text + short_text(angles[wish.axis], 7) + " deg";
}

Expected<std::vector<std::size_t>> also_turned(const std::vector<Touch>& touches, const Wish& wish,
                                               const Campaign& campaign) {
  std::vector<std::size_t> also;
  for (std::size_t k = 0; k < rotary_letters.size(); ++k) {
    if (k == wish.axis) continue;
    const auto turned = std::find_if(touches.begin(), touches.end(), [&](const Touch& t) {
      return !(std::fabs(t.angle[k] - touches.front().angle[k]) <= wish.same_angle);
    });
    if (turned == touches.end()) continue;
    const std::string name(1, rotary_letters[k]);
    const Axis* axis = campaign.machine.axis(name);
    if (axis == nullptr || !axis->rotary)
      return fail(at_line(turned->line, "axis " + name + " turned from " +
                                            short_text(touches.front().angle[k], 7) + " to " +
                                            short_text(turned->angle[k], 7) +
                                            " deg; expected a rotary axis [machine.axes." + name +
                                            "] in campaign.toml, found none"));
    also.push_back(k);
  }
  return also;
}

Expected<std::vector<Group>> groups_of(const std::vector<Touch>& touches, const Wish& wish,
                                       const std::vector<std::size_t>& also) {
  std::vector<Group> groups;
  for (const Touch& t : touches) {
    const bool stands =
        !groups.empty() && same_angles(t.angle, groups.back().front().angle, wish.same_angle);
    const bool full = !groups.empty() && wish.touches > 0 && groups.back().size() == wish.touches;
    if (!groups.empty() && wish.touches > 0 && !full && !stands)
      return fail(at_line(t.line, "expected " + std::to_string(wish.touches) +
                                      " touches at each angle (option touches), found " +
                                      std::to_string(groups.back().size()) + " at " +
                                      words_of(groups.back().front().angle, wish, also)));
    if (groups.empty() || full || !stands) groups.emplace_back();
    groups.back().push_back(t);
  }
  if (wish.touches > 0 && groups.back().size() != wish.touches)
    return fail(at_line(groups.back().back().line,
                        "expected " + std::to_string(wish.touches) +
                            " touches for the last centre (option touches), found " +
                            std::to_string(groups.back().size())));
  return groups;
}

struct Centre {
  const Group* group;
  math::SphereFit fit;
};

Expected<Centre> centre_of(const Group& group, const Wish& wish) {
  std::vector<std::array<double, 3>> points;
  for (const Touch& t : group) points.push_back(t.at);
  auto fit = math::fit_sphere(points, wish.radius);
  if (!fit) {
    Error error = fit.error();
    error.line = group.front().line;
    return fail(std::move(error));
  }
  for (std::size_t i = 0; i < group.size(); ++i)
    if (!(std::fabs(fit->residual[i]) <= wish.limit))
      return fail(at_line(group[i].line, "a touch is " + fixed_text(1e6 * fit->residual[i], 1) +
                                             " um off its sphere; expected at most " +
                                             fixed_text(1e6 * wish.limit, 1) +
                                             " (option limit_um). Is one centre made of touches of "
                                             "two (option touches)?"));
  return Centre{&group, std::move(*fit)};
}

Observations begin(const Measurement& m, const std::vector<std::size_t>& also) {
  Observations obs;
  obs.measurement = m.id;
  obs.axes = {
      {m.axis, true, {}, {}}, {"X", false, {}, {}}, {"Y", false, {}, {}}, {"Z", false, {}, {}}};
  for (const std::size_t k : also)
    obs.axes.push_back({std::string(1, rotary_letters[k]), true, {}, {}});
  for (std::size_t k = 0; k < 3; ++k) {
    Observations::Line line{m.id + " " + "xyz" [k], {}};
    line.sense[k] = 1.0;
    obs.lines.push_back(line);
  }
  return obs;
}

void note_spheres(const std::vector<Centre>& centres, double s, int dof, Observations& obs) {
  std::uint64_t touches = 0;
  double largest = 0.0, radius = 0.0;
  for (const Centre& c : centres) {
    touches += c.group->size();
    radius += c.fit.radius / static_cast<double>(centres.size());
    for (const double q : c.fit.cofactor) largest = std::max(largest, q);
  }
  const double k = math::coverage_factor(dof);
  obs.notes.push_back({"probe.spheres",
                       {counted("centres", centres.size()),
                        counted("touches", touches),
                        {"s", s, Quantity::deviation},
                        {"k", k, Quantity::ratio},
                        {"U", k * s * std::sqrt(largest), Quantity::deviation},
                        {"radius", radius, Quantity::length}}});
}

void put(const std::vector<Centre>& centres, const Wish& wish, const std::vector<std::size_t>& also,
         double s, Observations& obs) {
  std::map<std::array<std::int64_t, 3>, std::uint32_t> visits;
  for (const Centre& c : centres) {
    const Angles& angle = c.group->front().angle;
    std::array<std::int64_t, 3> place{};
    for (std::size_t k = 0; k < 3; ++k)
      place[k] = static_cast<std::int64_t>(
          std::clamp(std::round(angle[k] / std::max(10.0 * wish.same_angle, 1e-9)), -9e18, 9e18));
    const std::uint32_t run = ++visits[place];
    for (std::size_t k = 0; k < 3; ++k) {
      obs.axes[0].position.push_back(angle[wish.axis] * per_deg);
      for (std::size_t x = 0; x < 3; ++x) obs.axes[1 + x].position.push_back(c.fit.centre[x]);
      for (std::size_t a = 0; a < also.size(); ++a)
        obs.axes[4 + a].position.push_back(angle[also[a]] * per_deg);
      obs.deviation.push_back(c.fit.centre[k]);
      obs.u.push_back(s * std::sqrt(c.fit.cofactor[k]));
      obs.run.push_back(run);
      obs.line.push_back(static_cast<std::uint32_t>(k));
      obs.source_line.push_back(static_cast<std::uint32_t>(c.group->front().line));
    }
  }
}

Expected<Observations> read_file(const ReadInput& input, const Axis& axis) {
  NONIO_TRY(const auto wish, wish_of(input, axis));
  NONIO_TRY(const auto touches, touches_of(input.bytes, wish));
  NONIO_TRY(const auto also, also_turned(touches, wish, input.campaign));
  NONIO_TRY(const auto groups, groups_of(touches, wish, also));
  std::vector<Centre> centres;
  double rss = 0.0;
  int dof = 0;
  for (const Group& group : groups) {
    NONIO_TRY(auto centre, centre_of(group, wish));
    rss += centre.fit.rss;
    dof += centre.fit.dof;
    centres.push_back(std::move(centre));
  }
  const double s = std::sqrt(rss / dof);
  Observations obs = begin(input.measurement, also);
  put(centres, wish, also, s, obs);
  if (!(s > 0.0)) obs.u.clear();  // without scatter, u is unknown
  note_spheres(centres, s, dof, obs);
  return obs;
}

Expected<Observations> read(const ReadInput& input) {
  NONIO_TRY(const auto axis, axis_of(input));
  if (!axis->rotary)
    return fail("expected a rotary axis, found the linear axis \"" + axis->name + "\"");
  auto obs = read_file(input, *axis);
  if (!obs && obs.error().key.empty()) obs.error().file = input.measurement.file;
  return obs;
}

bool recognises(std::string_view head) {
  Lines lines(head);
  std::string_view line;
  int seen = 0;
  while (seen < 3 && lines.next(line)) {
    if (lines.offset() == head.size() && seen > 0) break;
    const auto fields = by_blanks(line);
    if (fields.empty()) continue;
    if (fields.size() != columns) return false;
    for (const std::string_view field : fields)
      if (parse_number(field, false).kind != Field::Kind::taken) return false;
    ++seen;
  }
  return seen > 0;
}

}  // namespace

Reader reader() {
  Reader r;
  r.info = {
      "linuxcnc-probe",
      "1.0",
      "Probe logs of LinuxCNC (PROBEOPEN): centres of a ball from touches.",
      {one_of({"", "mm", "inch"}, {"unit", std::string(), "", "Unit of the program that probed."}),
       within(0.0, 1e6,
              {"touches", std::int64_t{0}, "",
               "Touches of one centre; 0: all while the rotary axes are stationary."}),
       within(0.0, 1.0,
              {"same_angle_deg", 0.001, "deg",
               "Largest difference of a rotary axis from its position."}),
       within(0.0, 1000.0,
              {"radius_mm", 0.0, "mm",
               "Radius of ball and stylus together, if it is known; 0: fitted."}),
       within(0.001, 1e6,
              {"limit_um", 100.0, "um", "A touch farther off its sphere is refused."})}};
  r.recognises = recognises;
  r.reads = [](std::string_view kind) { return kind == "ball-centres"; };
  r.read = read;
  return r;
}

}  // namespace nonio::linuxcnc_probe
