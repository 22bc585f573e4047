// SPDX-License-Identifier: Apache-2.0
#include "judge.h"

#include <algorithm>
#include <limits>
#include <map>
#include <numbers>
#include <set>
#include <tuple>

#include "nonio/math/distributions.h"
#include "nonio/sdk/observations.h"
#include "nonio/sdk/results.h"

namespace nonio::rotary_kinematics {
namespace {

const Observations::AxisColumn* column(const Observations& o, std::string_view axis) {
  for (const auto& c : o.axes)
    if (c.axis == axis) return &c;
  return nullptr;
}

/// Sorted by axis position. Readings of several runs, directions or revolutions at one position
/// become one center, weighted by their number. A position repeated in one run and direction is a
/// finding.
tl::expected<std::vector<math::BallCentre>, Finding> centres_of(const Observations& o) {
  const auto *x = column(o, "X"), *y = column(o, "Y"), *z = column(o, "Z");
  std::vector<math::BallCentre> out;
  if (x == nullptr || y == nullptr || z == nullptr || o.axes.empty()) return out;
  const auto& rotary = o.axes.front();
  std::map<long long, math::BallCentre> places;
  std::set<std::tuple<std::uint32_t, int, double>> seen;
  for (std::size_t i = 0; i < o.size(); ++i) {
    if (o.line_of(i) != 0) continue;  // each of the three lines contains the whole position
    const double angle = rotary.position[i];
    const int approach = rotary.approach.empty() ? 0 : rotary.approach[i];
    if (!std::isfinite(angle) || !seen.emplace(o.run_of(i), approach, angle).second) {
      Finding repeated{.id = "rotary.repeated-angles", .attention = true};
      repeated.evidence = {{"angle", std::isfinite(angle) ? angle : 0.0, Quantity::angle},
                           {"run", static_cast<double>(o.run_of(i)), Quantity::count},
                           {"line", static_cast<double>(o.source_line_of(i)), Quantity::count}};
      return tl::unexpected(std::move(repeated));
    }
    math::BallCentre& c =
        places.try_emplace(math::place_in_turn(angle), math::BallCentre{{}, angle, 0.0})
            .first->second;
    c.weight += 1.0;
    const math::Vector3 at{x->position[i], y->position[i], z->position[i]};
    for (std::size_t k = 0; k < 3; ++k) c.at[k] += (at[k] - c.at[k]) / c.weight;
  }
  for (const auto& [place, centre] : places) out.push_back(centre);
  std::sort(out.begin(), out.end(), [](const auto& a, const auto& b) { return a.angle < b.angle; });
  return out;
}

using math::DoubleWave;
using math::RotaryFit;
using math::RotaryRefusal;

constexpr double significant = 0.01;      // significance level of a wave
constexpr double surely = 1e-3;           // significance level of residuals above the stated sigma
constexpr double no_circle_share = 1e-3;  // limit relative to the radius if no sigma is stated
constexpr double half_turn = std::numbers::pi, full_turn = 2.0 * std::numbers::pi;
constexpr double opposite = 1e-3;     // rad, tolerance of half a revolution between two positions
constexpr double least_sine = 0.5;    // of half the angle between two positions: 60 deg
constexpr double few = 7;             // degrees of freedom below which Student's factor is large
constexpr double shear_unit = 10e-6;  // rad, example for the sensitivity of an arc

Finding finding(const char* id, bool attention, std::vector<Number> evidence) {
  return {.id = id, .attention = attention, .evidence = std::move(evidence)};
}

Number count(const char* name, double n) { return {name, n, Quantity::count}; }
Number um(const char* name, double v) { return {name, v, Quantity::deviation}; }
Number mm(const char* name, double v) { return {name, v, Quantity::length}; }
Number urad(const char* name, double v) { return {name, v, Quantity::small_angle}; }
Number deg(const char* name, double v) { return {name, v, Quantity::angle}; }

const char* name_of(RotaryRefusal refusal) {
  switch (refusal) {
    case RotaryRefusal::not_finite:
      return "rotary.not-finite";
    case RotaryRefusal::weight:
      return "rotary.weight";
    case RotaryRefusal::repeated_angles:
      return "rotary.repeated-angles";
    case RotaryRefusal::too_few:
      return "rotary.too-few";
    case RotaryRefusal::collinear:
      return "rotary.collinear";
    case RotaryRefusal::not_converging:
      return "rotary.not-converging";
    case RotaryRefusal::angles_disagree:
      break;
  }
  return "rotary.angles-disagree";
}

/// Largest standard uncertainty in any direction for sigma = 1: root of the largest eigenvalue of a
/// block of the cofactors, by power iteration from each axis.
double largest(const RotaryFit& fit, std::size_t first) {
  double best = 0.0;
  for (std::size_t start = 0; start < 3; ++start) {
    math::Vector3 v{};
    v[start] = 1.0;
    double size = 0.0;
    for (int step = 0; step < 60; ++step) {
      math::Vector3 next{};
      for (std::size_t i = 0; i < 3; ++i)
        for (std::size_t k = 0; k < 3; ++k) next[i] += fit.cofactor[first + i][first + k] * v[k];
      size = std::hypot(next[0], next[1], next[2]);
      if (!(size > 0.0)) break;
      for (std::size_t i = 0; i < 3; ++i) v[i] = next[i] / size;
    }
    best = std::max(best, size);
  }
  return std::sqrt(best);
}

class Judge {
 public:
  Judge(const Observations& o, const Wish& wish) : o_(o), wish_(wish) {}

  Judged done() {
    if (!fitted() || !with_sigma() || !at_least_as_stated() || !a_circle() || !squareness_known() ||
        !long_enough())
      return std::move(out_);
    out_.given = true;
    if (!out_.U_known) return std::move(out_);
    tell_points();
    tell_waves();
    tell_suspect();
    tell_two_points();
    tell_tolerances();
    return std::move(out_);
  }

 private:
  bool refuse(Finding f) {
    out_.findings.push_back(std::move(f));
    return false;
  }
  /// A circle through three points has no residuals. It is reported without U unless the arc is
  /// shorter than half a revolution.
  bool without_U(Finding f) {
    out_.U_known = false;
    out_.findings.push_back(std::move(f));
    return out_.fit.gap <= half_turn;
  }
  double points() const { return static_cast<double>(out_.centres.size()); }
  double arc() const { return full_turn - out_.fit.gap; }

  bool fitted() {
    auto centres = centres_of(o_);
    if (!centres) return refuse(std::move(centres.error()));
    out_.centres = std::move(*centres);
    auto fit = math::fit_rotary(out_.centres, wish_.use_angles);
    if (!fit) return refuse(finding(name_of(fit.error()), true, {count("points", points())}));
    out_.fit = std::move(*fit);
    radial_ = math::double_wave(out_.fit, out_.centres, out_.fit.radial);
    axial_ = math::double_wave(out_.fit, out_.centres, out_.fit.axial);
    return true;
  }

  bool with_sigma() {
    const RotaryFit& fit = out_.fit;
    if (wish_.sigma) {
      const double ratio = fit.s / *wish_.sigma;
      exceeds_ =
          fit.dof > 0 && math::significant(math::f_upper(ratio * ratio, fit.dof, 1e9), surely);
      if (!exceeds_) {
        out_.sigma = *wish_.sigma;
        return true;
      }
    }
    if (fit.dof > 0) {
      out_.sigma = fit.s;
      out_.dof = fit.dof;
      out_.k = math::expansion_factor(fit.dof);
      return true;
    }
    if (!wish_.U_instrument)
      return without_U(finding("rotary.sigma-needed", true, {count("points", points())}));
    out_.sigma = 0.5 * *wish_.U_instrument;
    return true;
  }

  /// The u stated with the centers (by a probing that fitted each of them) is the lower limit of
  /// sigma, even if the residuals are smaller. One mean is used for all centers.
  bool at_least_as_stated() {
    double sum = 0.0, n = 0.0;
    for (const double u : o_.u)
      if (std::isfinite(u) && u > 0.0) sum += u * u, n += 1.0;
    if (n == 0.0) return true;
    const double stated = std::sqrt(sum / n);
    out_.findings.push_back(
        finding("rotary.stated-uncertainty", false, {um("u", stated), um("sigma", out_.sigma)}));
    if (stated <= out_.sigma) return true;
    out_.sigma = stated;
    out_.dof = std::numeric_limits<double>::infinity();
    out_.k = 2.0;
    out_.sigma_of_centres = true;
    return true;
  }

  bool a_circle() {
    const RotaryFit& fit = out_.fit;
    const double left = math::significant(radial_.p, significant) ? radial_.left : fit.s;
    const double expected = wish_.sigma ? *wish_.sigma : 0.5 * wish_.U_instrument.value_or(0.0);
    const double limit =
        expected > 0.0 ? wish_.circle_limit * expected : no_circle_share * fit.radius;
    if (fit.dof == 0 || left <= limit) return true;
    return refuse(finding("rotary.not-a-circle", true,
                          {um("s", left), um("limit", limit), mm("radius", fit.radius)}));
  }

  /// With three points of a full revolution, a squareness error of the linear axes shifts the
  /// center but leaves no residuals.
  bool squareness_known() {
    const RotaryFit& fit = out_.fit;
    out_.U_shear = 2.0 / std::numbers::sqrt3 * fit.shear_shift * wish_.linear_axes.value_or(0.0);
    if (fit.dof > 0 || wish_.linear_axes) return true;
    return without_U(
        finding("rotary.three-points-squareness", true,
                {um("shift", fit.shear_shift * shear_unit), urad("shear", shear_unit)}));
  }

  double U_centre() const {
    return std::hypot(out_.k * out_.sigma * largest(out_.fit, 0), out_.U_shear);
  }
  double U_direction() const { return out_.k * out_.sigma * largest(out_.fit, 3); }

  bool long_enough() {
    if (!out_.U_known || out_.fit.gap <= half_turn || U_centre() <= wish_.tolerance) return true;
    return refuse(finding("rotary.short-arc", true,
                          {deg("arc", arc()), um("U", U_centre()), um("tolerance", wish_.tolerance),
                           count("points", points())}));
  }

  void tell_points() {
    const RotaryFit& fit = out_.fit;
    if (out_.centres.size() == 3)
      out_.findings.push_back(
          finding("rotary.three-points", true,
                  {um("sigma", out_.sigma), um("shift", fit.shear_shift * shear_unit),
                   urad("shear", shear_unit)}));
    else if (fit.dof < few && out_.k > 2.0)
      out_.findings.push_back(
          finding("rotary.few-points", false,
                  {count("points", points()), {"k", out_.k, Quantity::ratio}, um("s", fit.s)}));
    if (exceeds_)
      out_.findings.push_back(
          finding("rotary.scatter", true, {um("s", fit.s), um("sigma", *wish_.sigma)}));
    if (fit.gap > half_turn && !wish_.linear_axes)
      out_.findings.push_back(finding("rotary.arc-squareness", false,
                                      {deg("arc", arc()), um("shift", fit.shear_shift * shear_unit),
                                       urad("shear", shear_unit)}));
  }

  void tell_waves() {
    const RotaryFit& fit = out_.fit;
    if (math::significant(radial_.p, significant))
      out_.findings.push_back(finding("rotary.ellipse", true,
                                      {um("amplitude", radial_.amplitude),
                                       urad("shear", 2.0 * radial_.amplitude / fit.radius),
                                       deg("at", radial_.phase),
                                       {"p", radial_.p, Quantity::probability}}));
    if (math::significant(axial_.p, significant))
      out_.findings.push_back(finding("rotary.axial-run-out", true,
                                      {um("amplitude", axial_.amplitude),
                                       deg("at", axial_.phase),
                                       {"p", axial_.p, Quantity::probability}}));
    if (wish_.use_angles) tell_angles();
  }

  /// Leaves out each centre in turn: F of what that takes off the residuals, Bonferroni over the
  /// centres. A wave over the turn would make its largest deviation suspect.
  void tell_suspect() {
    constexpr int fewest_left = 3;
    if (math::significant(radial_.p, significant) || math::significant(axial_.p, significant))
      return;
    const double all = out_.fit.dof * out_.fit.s * out_.fit.s;
    double best = 1.0, off = 0.0, angle = 0.0;
    for (std::size_t i = 0; i < out_.centres.size(); ++i) {
      std::vector<math::BallCentre> others = out_.centres;
      others.erase(others.begin() + static_cast<std::ptrdiff_t>(i));
      const auto fit = math::fit_rotary(others, wish_.use_angles);
      if (!fit || fit->dof < fewest_left || !(fit->s > 0.0)) continue;
      const double less = std::max(0.0, all - fit->dof * fit->s * fit->s),
                   dof = out_.fit.dof - fit->dof,
                   p = math::f_upper(less / dof / (fit->s * fit->s), dof, fit->dof);
      if (p < best) best = p, off = std::sqrt(less), angle = out_.centres[i].angle;
    }
    best = std::min(1.0, best * points());
    if (math::significant(best, significant))
      out_.findings.push_back(
          finding("rotary.suspect-centre", true,
                  {deg("angle", angle), um("away", off), {"p", best, Quantity::probability}}));
  }

  /// Result and U of the classic method for the same readings: two positions p and q, the angle
  /// between them, and an axis direction parallel to the machine axis m.
  ///
  ///     c = (p + q)/2 + cot(t/2)/2 m x (q - p)      u = s/2 sqrt(1/w_p + 1/w_q)/|sin(t/2)|
  ///
  /// t: angle from p to q by the encoder. At half a revolution, c is the middle. An error dt of the
  /// angle moves c by radius dt/(2 sin(t/2)).
  void tell_two_points() {
    const RotaryFit& fit = out_.fit;
    const auto& all = out_.centres;
    std::size_t a = 0, b = 0;
    double sine = least_sine;
    for (std::size_t i = 0; i < all.size(); ++i)
      for (std::size_t k = i + 1; k < all.size(); ++k)
        if (const double s = std::fabs(std::sin((all[k].angle - all[i].angle) / 2.0));
            s > sine + 1e-6)
          a = i, b = k, sine = s;
    if (all.size() < 3 || b == 0) return;
    const double apart = std::remainder(all[b].angle - all[a].angle, full_turn);
    const bool half = std::fabs(std::fabs(apart) - half_turn) <= opposite;
    std::size_t along = 0;
    for (std::size_t k = 1; k < 3; ++k)
      if (std::fabs(fit.direction[k]) > std::fabs(fit.direction[along])) along = k;
    math::Vector3 off{};
    const std::size_t i = (along + 1) % 3, k = (along + 2) % 3;
    const double turned =
        half ? 0.0 : 0.5 * std::copysign(1.0 / std::tan(apart / 2.0), fit.direction[along] * apart);
    for (std::size_t c = 0; c < 3; ++c)
      off[c] = (all[a].at[c] + all[b].at[c]) / 2.0 - fit.centre[c];
    off[i] -= turned * (all[b].at[k] - all[a].at[k]);
    off[k] += turned * (all[b].at[i] - all[a].at[i]);
    double height = 0.0, size = 0.0;
    for (std::size_t c = 0; c < 3; ++c) height += off[c] * fit.direction[c];
    for (std::size_t c = 0; c < 3; ++c) size += std::pow(off[c] - height * fit.direction[c], 2);
    const double u = out_.sigma / 2.0 * std::sqrt(1.0 / all[a].weight + 1.0 / all[b].weight) / sine;
    const double steepest = std::fabs(fit.direction[along]);
    std::vector<Number> evidence{deg("from", all[a].angle),
                                 deg("to", all[b].angle),
                                 um("difference", std::sqrt(size)),
                                 um("U_two", out_.k * u),
                                 um("U", U_centre()),
                                 urad("tilt", std::acos(std::min(1.0, steepest))),
                                 urad("U_tilt", U_direction())};
    if (!half) {
      evidence.push_back(urad("angle", shear_unit));
      evidence.push_back(um("shift", fit.radius * shear_unit / (2.0 * sine)));
    }
    out_.findings.push_back(finding(half ? "rotary.two-points" : "rotary.two-points-angle", false,
                                    std::move(evidence)));
  }

  void tell_angles() {
    const RotaryFit& fit = out_.fit;
    double along = 0.0, rest = 0.0;
    for (std::size_t i = 0; i < out_.centres.size(); ++i) {
      const double w = out_.centres[i].weight;
      along += w * fit.tangential[i] * fit.tangential[i];
      rest += w * (fit.radial[i] * fit.radial[i] + fit.axial[i] * fit.axial[i]);
    }
    // The constant angle uses one of the N degrees of freedom along the circle, of 3N - 7 in total.
    const double dof = points() - 1.0, others = fit.dof - dof;
    if (!(others > 0.0) || !(rest > 0.0)) return;
    const double p = math::f_upper(along / dof / (rest / others), dof, others);
    if (math::significant(p, surely))
      out_.findings.push_back(finding("rotary.angles-not-trusted", true,
                                      {um("along", std::sqrt(along / dof)),
                                       um("rest", std::sqrt(rest / others)),
                                       {"p", p, Quantity::probability}}));
  }

  void tell_tolerances() {
    const RotaryFit& fit = out_.fit;
    if (const double U = U_centre(); U > wish_.tolerance)
      out_.findings.push_back(
          finding("rotary.more-points", true,
                  {um("U", U), um("tolerance", wish_.tolerance), count("points", points()),
                   count("wanted", std::ceil(points() * std::pow(U / wish_.tolerance, 2)))}));
    if (const double U = U_direction(); U > wish_.tolerance_direction) {
      const double ratio = U / wish_.tolerance_direction;
      out_.findings.push_back(finding(
          "rotary.larger-radius", true,
          {urad("U", U), urad("tolerance", wish_.tolerance_direction), mm("radius", fit.radius),
           mm("radius_wanted", fit.radius * ratio), count("points", points()),
           count("wanted", std::ceil(points() * ratio * ratio))}));
    }
  }

  const Observations& o_;
  const Wish& wish_;
  Judged out_;
  DoubleWave radial_, axial_;
  bool exceeds_ = false;
};

}  // namespace

double Judged::u_centre(std::size_t i) const {
  return sigma * std::sqrt(std::max(0.0, fit.cofactor[i][i]));
}

double Judged::u_direction(std::size_t i) const {
  return sigma * std::sqrt(std::max(0.0, fit.cofactor[3 + i][3 + i]));
}

double Judged::u_radius() const { return sigma * std::sqrt(fit.cofactor_radius); }

Judged judge(const Observations& o, const Wish& wish) { return Judge(o, wish).done(); }

}  // namespace nonio::rotary_kinematics
