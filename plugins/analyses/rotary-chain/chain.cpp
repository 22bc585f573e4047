// SPDX-License-Identifier: Apache-2.0
#include "chain.h"

#include <algorithm>
#include <limits>
#include <map>
#include <numbers>
#include <numeric>
#include <set>
#include <tuple>

#include "nonio/math/distributions.h"
#include "nonio/math/rotary.h"
#include "nonio/sdk/format.h"

namespace nonio::rotary_chain {

namespace {

using math::ChainRefusal;

constexpr double surely = 1e-3;  // significance level of residual tests
// Smallest relative effect of a pattern on the residuals; a common scale has only 1e-5.
constexpr double least_shown = 1e-3;
constexpr double no_chain_share = 1e-3;  // limit of s relative to the extent if no sigma is stated

Finding finding(const char* id, std::vector<Number> evidence,
                std::vector<std::pair<std::string, std::string>> texts = {}) {
  return {.id = id, .attention = true, .evidence = std::move(evidence), .texts = std::move(texts)};
}

Number count(const char* name, double n) { return {name, n, Quantity::count}; }
Number um(const char* name, double v) { return {name, v, Quantity::deviation}; }

double extent(const Places& places) {
  double size = 0.0;
  for (std::size_t k = 0; k < 3; ++k) {
    const auto [low, high] =
        std::minmax_element(places.readings.begin(), places.readings.end(),
                            [k](const auto& a, const auto& b) { return a.at[k] < b.at[k]; });
    size = std::max(size, high->at[k] - low->at[k]);
  }
  return size;
}

double dot(const std::vector<double>& a, const std::vector<double>& b) {
  return std::inner_product(a.begin(), a.end(), b.begin(), 0.0);
}
void add(std::vector<double>& to, double f, const std::vector<double>& v) {
  for (std::size_t i = 0; i < to.size(); ++i) to[i] += f * v[i];
}

class Solver {
 public:
  Solver(const AnalysisInput& in, const Chain& chain, const Places& places, const Wish& wish,
         const math::ReadingModel& model)
      : in_(in), chain_(chain), places_(places), wish_(wish), model_(model) {}

  Solved done() {
    if (fitted() && fits()) {
      set_scatter();
      with_sigma();
      out_.given = true;
      tell_angles();
      tell_suspect();
    }
    return std::move(out_);
  }

 private:
  bool refuse(Finding f) {
    out_.findings.push_back(std::move(f));
    return false;
  }
  std::string axes() const { return listed(chain_.axes); }
  double centres() const { return static_cast<double>(places_.readings.size()); }

  bool fitted() {
    auto fit = math::fit_chain(places_.readings, places_.order);
    if (fit) {
      out_.fit = std::move(*fit);
      return true;
    }
    switch (fit.error()) {
      case ChainRefusal::not_finite:
        return refuse(finding("rotary.not-finite", {}));
      case ChainRefusal::too_few:
        return refuse(finding("rotary-chain.too-few", {count("centres", centres())}));
      case ChainRefusal::ambiguous:
        return refuse(
            finding("rotary-chain.ambiguous", {count("centres", centres())}, {{"axes", axes()}}));
      case ChainRefusal::not_converging:
        break;
    }
    return refuse(finding("rotary-chain.refused-fit", {count("centres", centres())}));
  }

  /// Detects a wrong order of axes, an angle in the wrong column, or a table declared as head.
  bool fits() {
    const double size = extent(places_);
    double expected = wish_.sigma.value_or(0.0);
    if (const Instrument& i = in_.campaign.instrument; expected == 0.0 && i.U_fixed)
      expected = 0.5 * (*i.U_fixed + i.U_per_length.value_or(0.0) * size);
    const double limit = expected > 0.0 ? wish_.circle_limit * expected : no_chain_share * size;
    if (out_.fit.s <= limit) return true;
    return refuse(finding("rotary-chain.does-not-fit", {um("s", out_.fit.s), um("limit", limit)},
                          {{"axes", axes()}}));
  }

  /// Removes the effects of the linear axes from the residuals, unless these effects exceed the
  /// stated bound.
  void set_scatter() {
    const math::ChainFit& fit = out_.fit;
    scatter_ = fit.s, dof_ = fit.dof;
    const auto& readings = places_.readings;
    if (!std::all_of(readings.begin(), readings.end(),
                     [&](const auto& r) { return r.weight == readings.front().weight; }))
      return;
    out_.residual_by = fit.residual_by;
    const auto linear =
        std::find_if(model_.inputs.begin(), model_.inputs.end(),
                     [](const auto& input) { return input.is.id == "linear-axes"; });
    if (linear == model_.inputs.end() || fit.residual_by.empty()) return;
    std::vector<std::vector<double>> basis;
    double most = 0.0;
    for (const auto& pattern : linear->patterns) {
      std::vector<double> shown;
      for (const auto& row : fit.residual_by) shown.push_back(dot(row, pattern));
      most += std::numbers::sqrt3 * std::sqrt(dot(shown, shown));
      const double size = std::sqrt(dot(pattern, pattern));
      for (int twice = 0; twice < 2; ++twice)
        for (const auto& q : basis) add(shown, -dot(q, shown), q);
      const double left = std::sqrt(dot(shown, shown));
      if (!(left > least_shown * size)) continue;
      for (double& x : shown) x /= left;
      basis.push_back(std::move(shown));
    }
    std::vector<double> r;
    for (std::size_t k = 0; k < 3; ++k)
      for (const auto& residual : fit.residual) r.push_back(residual[k]);
    double part = 0.0;
    for (const auto& q : basis) part += std::pow(dot(q, r), 2);
    const double root = std::sqrt(readings.front().weight);
    const auto n = static_cast<double>(basis.size());
    if (!(fit.dof - n >= 1.0)) return;
    const double rest = std::max(0.0, dot(r, r) - part);
    const double s = root * std::sqrt(rest / (fit.dof - n));
    if (root * std::sqrt(part) > root * most + 3.0 * s * std::sqrt(n)) {
      out_.findings.push_back(finding(
          "rotary-chain.linear-axes",
          {um("found", std::sqrt(part / centres())), um("most", most / std::sqrt(centres()))}));
      return;
    }
    scatter_ = s, dof_ = fit.dof - n;
    for (auto& row : out_.residual_by) {
      const std::vector<double> whole = row;
      for (const auto& q : basis) add(row, -dot(q, whole), q);
    }
  }

  void with_sigma() {
    const double s = scatter_, dof = dof_;
    if (wish_.sigma) {
      const double ratio = s / *wish_.sigma;
      if (!math::significant(math::f_upper(ratio * ratio, dof, 1e9), surely)) {
        out_.sigma = *wish_.sigma;
      } else {
        out_.findings.push_back(finding("rotary.scatter", {um("s", s), um("sigma", *wish_.sigma)}));
      }
    }
    if (out_.sigma == 0.0) {
      out_.sigma = s;
      out_.dof = dof;
      out_.from_readings = true;
    }
    if (places_.stated_u == 0.0) return;
    out_.findings.push_back({.id = "rotary.stated-uncertainty",
                             .evidence = {um("u", places_.stated_u), um("sigma", out_.sigma)}});
    if (places_.stated_u <= out_.sigma) return;
    out_.sigma = places_.stated_u;
    out_.dof = INFINITY;
    out_.from_readings = true;
  }

  void tell_angles() {
    for (std::size_t j = 0; j < chain_.axes.size(); ++j) {
      const auto& f = out_.fit.followed[j];
      if (!(f.dof_along > 1.0) || !(f.dof_rest > 1.0) || !(f.rest > 0.0)) continue;
      const double ratio = f.along / f.rest,
                   p = math::f_upper(ratio * ratio, f.dof_along, f.dof_rest);
      if (math::significant(p, surely))
        out_.findings.push_back(
            finding("rotary-chain.angles-not-trusted",
                    {um("along", f.along), um("rest", f.rest), {"p", p, Quantity::probability}},
                    {{"axis", chain_.axes[j]}}));
    }
  }

  /// F of what a centre that is left out takes off the residuals, from their derivatives: r' Q^-1 r
  /// with its residual r and its block Q. Bonferroni over the centres.
  void tell_suspect() {
    const math::ChainFit& fit = out_.fit;
    const std::size_t n = places_.readings.size();
    if (fit.residual_by.empty() || fit.dof < 6) return;
    const double all = fit.dof * fit.s * fit.s;
    double best = 1.0, off = 0.0;
    std::size_t which = 0;
    for (std::size_t i = 0; i < n; ++i) {
      const auto left = left_out(fit, i, n);
      const double w = places_.readings[i].weight, less = w * left.less, rest = all - less;
      if (!left.known || !(rest > 0.0)) continue;
      const double p = math::f_upper(less / 3.0 / (rest / (fit.dof - 3.0)), 3.0, fit.dof - 3.0);
      if (p < best) best = p, off = left.away, which = i;
    }
    best = std::min(1.0, best * static_cast<double>(n));
    if (!math::significant(best, surely)) return;
    Finding f = finding("rotary-chain.suspect-centre",
                        {um("away", off), {"p", best, Quantity::probability}});
    std::string at;
    for (std::size_t j = 0; j < chain_.axes.size(); ++j)
      at += (at.empty() ? "" : ", ") + chain_.axes[j] + " = " +
            evidence_text({"", places_.readings[which].angle[j], Quantity::angle});
    f.texts = {{"at", at + " " + std::string(unit_of(Quantity::angle).symbol)}};
    out_.findings.push_back(std::move(f));
  }

  struct LeftOut {
    bool known = false;
    double less = 0.0, away = 0.0;  ///< m^2; m
  };

  static LeftOut left_out(const math::ChainFit& fit, std::size_t i, std::size_t n) {
    math::Vector3 row[3];
    for (std::size_t a = 0; a < 3; ++a)
      for (std::size_t b = 0; b < 3; ++b) row[a][b] = fit.residual_by[a * n + i][b * n + i];
    const math::Vector3& r = fit.residual[i];
    const auto cross = [](const math::Vector3& a, const math::Vector3& b) {
      return math::Vector3{a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2],
                           a[0] * b[1] - a[1] * b[0]};
    };
    const auto product = [](const math::Vector3& a, const math::Vector3& b) {
      return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
    };
    const math::Vector3 c[3] = {cross(row[1], row[2]), cross(row[2], row[0]),
                                cross(row[0], row[1])};
    const double det = product(row[0], c[0]);
    if (!(det > 1e-6)) return {};  // the other centres do not determine this one
    math::Vector3 d{};
    for (std::size_t k = 0; k < 3; ++k)
      for (std::size_t a = 0; a < 3; ++a) d[k] += c[a][k] * r[a] / det;
    return {true, product(r, d), std::sqrt(product(d, d))};
  }

  const AnalysisInput& in_;
  const Chain& chain_;
  const Places& places_;
  const Wish& wish_;
  const math::ReadingModel& model_;
  double scatter_ = 0.0, dof_ = 0.0;
  Solved out_;
};

}  // namespace

std::string listed(const std::vector<std::string>& names) {
  std::string out;
  for (const std::string& name : names) out += (out.empty() ? "" : ", ") + name;
  return out;
}

Solved solve(const AnalysisInput& in, const Chain& chain, const Places& places, const Wish& wish,
             const math::ReadingModel& model) {
  return Solver(in, chain, places, wish, model).done();
}

namespace {

bool has_all(const Observations& o, const Chain& chain) {
  if (o.size() == 0 || o.angular) return false;
  for (const char* linear : {"X", "Y", "Z"})
    if (o.axis(linear) == nullptr) return false;
  return std::all_of(chain.axes.begin(), chain.axes.end(),
                     [&](const auto& axis) { return o.axis(axis) != nullptr; });
}

struct Place {
  math::ChainReading mean;
  double when = std::numeric_limits<double>::infinity();
};

class Collector {
 public:
  Collector(const Observations& o, const Chain& chain) : o_(o) {
    for (const std::string& axis : chain.axes) angles_.push_back(o.axis(axis));
    for (const char* linear : {"X", "Y", "Z"}) at_.push_back(o.axis(linear));
    timed_ = o.time.size() == o.size() &&
             std::all_of(o.time.begin(), o.time.end(), [](double t) { return std::isfinite(t); });
  }

  /// Ordered by time or, without times, by run and position. Returns a finding if a position is
  /// repeated in one run and direction.
  tl::expected<std::vector<Place>, Finding> places(std::size_t ball, std::size_t tool) {
    for (std::size_t i = 0; i < o_.size(); ++i) {
      if (o_.line_of(i) != 0) continue;  // each of the three lines contains the whole position
      math::ChainReading r;
      for (const auto* column : angles_) r.angle.push_back(column->position[i]);
      for (std::size_t k = 0; k < 3; ++k) r.at[k] = at_[k]->position[i];
      r.ball = ball, r.tool = tool;
      if (auto bad = seen_before(i, r)) return tl::unexpected(std::move(*bad));
      add(i, r);
    }
    std::vector<Place> out;
    for (auto& [key, place] : places_) out.push_back(std::move(place));
    std::sort(out.begin(), out.end(), [](const Place& a, const Place& b) {
      return std::tie(a.when, a.mean.angle) < std::tie(b.when, b.mean.angle);
    });
    return out;
  }

 private:
  std::vector<long long> key_of(const math::ChainReading& r) const {
    std::vector<long long> key;
    for (const double a : r.angle) key.push_back(math::place_in_turn(a));
    return key;
  }
  std::optional<Finding> seen_before(std::size_t i, const math::ChainReading& r) {
    const bool finite =
        std::all_of(r.angle.begin(), r.angle.end(), [](double a) { return std::fabs(a) < 1e6; });
    const auto& approach = o_.axes.front().approach;
    if (finite && seen_.emplace(o_.run_of(i), approach.empty() ? 0 : approach[i], r.angle).second)
      return std::nullopt;
    Finding repeated{.id = "rotary.repeated-angles", .attention = true};
    repeated.evidence = {{"angle", finite ? r.angle.front() : 0.0, Quantity::angle},
                         {"run", static_cast<double>(o_.run_of(i)), Quantity::count},
                         {"line", static_cast<double>(o_.source_line_of(i)), Quantity::count}};
    return repeated;
  }
  void add(std::size_t i, const math::ChainReading& r) {
    Place& place = places_[key_of(r)];
    if (place.mean.angle.empty()) place.mean = r, place.mean.weight = 0.0;
    place.mean.angle = std::min(place.mean.angle, r.angle);
    place.mean.weight += 1.0;
    for (std::size_t k = 0; k < 3; ++k)
      place.mean.at[k] += (r.at[k] - place.mean.at[k]) / place.mean.weight;
    // Without times, run and position give the order, because the row order has no meaning.
    place.when = std::min(place.when, timed_ ? o_.time[i] : static_cast<double>(o_.run_of(i)));
  }

  const Observations& o_;
  std::vector<const Observations::AxisColumn*> angles_, at_;
  bool timed_ = false;
  std::set<std::tuple<std::uint32_t, int, std::vector<double>>> seen_;
  std::map<std::vector<long long>, Place> places_;
};

std::size_t tool_of(const Measurement& m, Places& out) {
  for (std::size_t t = 0; t < out.tools.size(); ++t)
    if (out.tools[t]->tool_offset == m.tool_offset) return t;
  out.tools.push_back(&m);
  return out.tools.size() - 1;
}

double mean_square(const Observations& o, double& n) {
  double sum = 0.0;
  for (const double u : o.u)
    if (std::isfinite(u) && u > 0.0) sum += u * u, n += 1.0;
  return sum;
}

}  // namespace

bool same_state(const Measurement& a, const Measurement& b) {
  return state_of(a) == state_of(b) && a.adjustment == b.adjustment;
}

Places places_of(const AnalysisInput& in, const Chain& chain) {
  Places out;
  const auto& all = in.campaign.measurements;
  const auto same = in.options.texts("same_reference");
  const auto named = [&](const std::string& id) {
    return std::find(same.begin(), same.end(), id) != same.end();
  };
  double square = 0.0, n = 0.0;
  for (std::size_t i = 0; in.all != nullptr && i < std::min(all.size(), in.all->size()); ++i) {
    const Measurement& m = all[i];
    const Observations& o = (*in.all)[i];
    if (m.kind != "ball-centres" || !same_state(m, in.measurement) || o.size() == 0) continue;
    if (!has_all(o, chain)) {
      out.left_out.push_back(m.id);
      continue;
    }
    if (!out.used.empty() && !(named(m.id) && named(out.used.front()))) {
      out.findings.push_back({.id = "rotary-chain.reference-unknown",
                              .attention = true,
                              .texts = {{"one", out.used.front()}, {"other", m.id}}});
      continue;
    }
    const std::size_t tool = chain.tables < chain.axes.size() ? tool_of(m, out) : 0;
    auto places = Collector(o, chain).places(out.used.size(), tool);
    if (!places) {
      places.error().measurement = m.id;
      out.findings.push_back(std::move(places.error()));
      out.sound = false;
      return out;
    }
    for (Place& place : *places) out.readings.push_back(std::move(place.mean));
    square += mean_square(o, n);
    out.used.push_back(m.id);
    out.tables.push_back(&o);
  }
  out.stated_u = n > 0.0 ? std::sqrt(square / n) : 0.0;
  out.order = {chain.tables, chain.axes.size() - chain.tables,
               std::max<std::size_t>(1, out.used.size()),
               std::max<std::size_t>(1, out.tools.size())};
  return out;
}

}  // namespace nonio::rotary_chain
