// SPDX-License-Identifier: Apache-2.0
//
// The inputs are listed in docs/uncertainty.md. A limit that bounds a quantity of one sign (the
// short path of a misaligned beam), and that is not corrected, has the root mean square r/sqrt 3.
#include "nonio/math/budget.h"

#include <algorithm>
#include <numeric>
#include <tuple>

#include "common/constants.h"
#include "common/finding_builder.h"
#include "nonio/math/distributions.h"

namespace nonio::math {
namespace {

using LineKind = BudgetLine::Kind;

// Degrees of freedom above which k is 2.00: docs/dev/constants.md, A8.
constexpr double as_if_known = 500.0;

double k_of(double dof) { return dof < as_if_known ? coverage_factor(dof) : 2.0; }

/// `excess`: kurtosis of the whole distribution minus 3, at most 0.
double k_of(double dof, double excess) { return k_of(dof) * shape_factor(excess); }

constexpr double of_rectangle = -1.2;  // excess of a rectangular distribution

bool along(const BudgetLine& line) {
  return line.kind == LineKind::length || line.kind == LineKind::coordinate;
}

double extent(const BudgetLine& line) {
  double most = 0.0;
  for (const double d : line.length) most = std::max(most, std::fabs(d));
  return most;
}

class Builder {
 public:
  Builder(const Campaign& c, const Environment& e, ReadingModel& out) : c_(c), e_(e), out_(out) {
    for (const BudgetLine& line : out_.lines) {
      lengths_ |= line.kind == LineKind::length;
      laterals_ |= line.kind == LineKind::lateral;
      angles_ |= line.kind == LineKind::angle;
      coordinates_ |= line.kind == LineKind::coordinate;
    }
  }

  void run() {
    device();
    if (lengths_) misalignment();
    if (lengths_ || coordinates_) temperatures(), own_length();
    drift();
    if (coordinates_) probing();
    std::erase_if(out_.inputs, [](const auto& input) {
      return std::all_of(input.of_line.begin(), input.of_line.end(),
                         [](double u) { return u == 0.0; });
    });
  }

 private:
  double get(const std::optional<double>& given, const std::string& key) {
    if (given && std::isfinite(*given)) return *given;
    want(key);
    return 0.0;
  }
  void want(const std::string& key) {
    auto& all = out_.missing;
    if (std::find(all.begin(), all.end(), key) == all.end()) all.push_back(key);
  }

  /// `share`: fraction of the variance of the last input that lines have in common.
  void together(std::optional<double> share) { out_.inputs.back().together = share; }

  /// `of`: returns the standard uncertainty by line, per m if it grows with the length.
  template <class Of>
  void add(const char* id, Distribution d, Correlation c, bool with_length, std::string source,
           const Of& of, bool angles = false) {
    ReadingModel::Input input;
    input.is = {.id = id,
                .quantity = angles ? Quantity::small_angle : Quantity::deviation,
                .with_length = with_length,
                .distribution = d,
                .correlation = c,
                .source = std::move(source)};
    for (const BudgetLine& line : out_.lines) {
      const bool here = (line.kind == LineKind::angle) == angles;
      input.of_line.push_back(here ? of(line) : 0.0);
      input.is.u = std::max(input.is.u, input.of_line.back() * (with_length ? extent(line) : 1.0));
    }
    out_.inputs.push_back(std::move(input));
  }

  void device() {
    const Instrument& i = c_.instrument;
    if (lengths_ || laterals_ || coordinates_) {
      const double fixed = get(i.U_fixed, "instrument.U_fixed_um"),
                   each = get(i.U_per_length, "instrument.U_per_m_um");
      if (const auto exact = exact_instrument(i, false)) want(*exact);
      add("device-fixed", Distribution::normal,
          coordinates_ ? Correlation::lines : Correlation::readings, false, "instrument.U_fixed_um",
          [&](const BudgetLine&) { return fixed / 2.0; });
      add("device-length", Distribution::normal,
          coordinates_ ? Correlation::lines : Correlation::device, true, "instrument.U_per_m_um",
          [&](const BudgetLine&) { return each / 2.0; });
    }
    if (!angles_) return;
    const double U = get(i.U_angle, "instrument.U_arcsec");
    if (const auto exact = exact_instrument(i, true)) want(*exact);
    add(
        "device-angle", Distribution::normal, Correlation::readings, false, "instrument.U_arcsec",
        [&](const BudgetLine&) { return U / 2.0; }, true);
  }

  void misalignment() {
    const double R = get(e_.misalignment, "environment.misalignment_mm");
    add("misalignment", Distribution::rectangular, Correlation::lines, true,
        "environment.misalignment_mm", [&](const BudgetLine& line) {
          const double L = extent(line);
          return line.kind == LineKind::length && L > 0.0 ? of_limit * R * R / (2.0 * L * L) : 0.0;
        });
    together(0.75);
  }

  void temperatures() {
    const double reading = get(e_.temperature_range, "environment.temperature_range_K"),
                 distance = get(e_.temperature_difference, "environment.temperature_difference_K"),
                 range = get(e_.expansion_range, "environment.expansion_range_um_per_m_K");
    std::string keys;
    for (const BudgetLine& line : out_.lines)
      if (along(line) && !line.expansion) want(line.expansion_keys);
    add("temperature", Distribution::rectangular, Correlation::lines, true,
        "environment.temperature_range_K, machine.axes.*.expansion_um_per_m_K",
        [&](const BudgetLine& line) {
          return along(line) ? of_full_range * reading * std::fabs(line.expansion.value_or(0.0))
                             : 0.0;
        });
    together(std::nullopt);
    add("expansion", Distribution::rectangular, Correlation::lines, true,
        "environment.temperature_difference_K, environment.expansion_range_um_per_m_K",
        [&](const BudgetLine& line) {
          return along(line) ? of_full_range * std::fabs(distance) * range : 0.0;
        });
    together(std::nullopt);
  }

  void own_length() {
    const Instrument& i = c_.instrument;
    if (!i.expansion) return;
    const double reading = get(i.temperature_range, "instrument.temperature_range_K"),
                 range = get(i.expansion_range, "instrument.expansion_range_um_per_m_K");
    const double distance = e_.temperature_difference.value_or(0.0);
    add("device-temperature", Distribution::rectangular, Correlation::device, true,
        "instrument.temperature_range_K, instrument.expansion_um_per_m_K",
        [&](const BudgetLine& line) {
          return along(line) ? of_full_range * reading * std::fabs(*i.expansion) : 0.0;
        });
    add("device-expansion", Distribution::rectangular, Correlation::device, true,
        "environment.temperature_difference_K, instrument.expansion_range_um_per_m_K",
        [&](const BudgetLine& line) {
          return along(line) ? of_full_range * std::fabs(distance) * range : 0.0;
        });
  }

  void drift() {
    if (lengths_ || laterals_ || coordinates_) {
      const double range = get(e_.drift, "environment.drift_um");
      add("drift", Distribution::normal, Correlation::walk, false, "environment.drift_um",
          [&](const BudgetLine&) { return of_limit * range; });
    }
    if (!angles_) return;
    const double range = get(e_.drift_angle, "environment.drift_arcsec");
    add(
        "drift-angle", Distribution::normal, Correlation::walk, false, "environment.drift_arcsec",
        [&](const BudgetLine&) { return of_limit * range; }, true);
  }

  void probing() {
    const double sphere = get(c_.instrument.sphere, "instrument.sphere_um"),
                 probe = get(c_.instrument.probe, "instrument.probe_um");
    add("sphere", Distribution::rectangular, Correlation::readings, false, "instrument.sphere_um",
        [&](const BudgetLine&) { return of_full_range * sphere; });
    add("probe", Distribution::rectangular, Correlation::lines, false, "instrument.probe_um",
        [&](const BudgetLine&) { return of_full_range * probe; });
  }

  const Campaign& c_;
  const Environment& e_;
  ReadingModel& out_;
  bool lengths_ = false, laterals_ = false, angles_ = false, coordinates_ = false;
};

}  // namespace

std::vector<double> reading_times(const Observations& o) {
  const bool timed =
      o.time.size() == o.size() &&
      std::all_of(o.time.begin(), o.time.end(), [](double t) { return std::isfinite(t); });
  const auto when = [&](std::size_t i) {
    if (timed) return std::tuple(o.time[i], 0, 0.0);
    const bool down =
        !o.axes.empty() && !o.axes.front().approach.empty() && o.axes.front().approach[i] < 0;
    const double at = o.axes.empty() ? 0.0 : o.axes.front().position[i];
    return std::tuple(static_cast<double>(o.run_of(i)), down ? 1 : 0, down ? -at : at);
  };
  std::vector<std::size_t> order(o.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::stable_sort(order.begin(), order.end(),
                   [&](std::size_t a, std::size_t b) { return when(a) < when(b); });
  std::vector<double> out(o.size(), 0.0);
  if (out.size() < 2) return out;
  const double first = timed ? o.time[order.front()] : 0.0,
               whole = timed ? o.time[order.back()] - first : static_cast<double>(out.size() - 1);
  for (std::size_t k = 0; k < order.size(); ++k)
    out[order[k]] =
        whole > 0.0 ? ((timed ? o.time[order[k]] : static_cast<double>(k)) - first) / whole : 0.0;
  return out;
}

ReadingModel reading_model(const Campaign& c, const Environment& e, std::vector<BudgetLine> lines) {
  ReadingModel out;
  out.lines = std::move(lines);
  Builder(c, e, out).run();
  return out;
}

void put_expansion(BudgetLine& line, const Campaign& c, std::span<const std::string> axes,
                   std::span<const double> direction) {
  double sum = 0.0;
  bool known = true;
  for (std::size_t k = 0; k < axes.size(); ++k) {
    const Axis* axis = c.machine.axis(axes[k]);
    if (axis != nullptr && axis->expansion) {
      sum += direction[k] * direction[k] * *axis->expansion;
      continue;
    }
    known = false;
    if (line.expansion_keys.empty())
      line.expansion_keys = "machine.axes." + axes[k] + ".expansion_um_per_m_K";
  }
  if (known) line.expansion = sum;
}

namespace {

double variance_of_each(const ReadingModel& model) {
  double squares = 0.0;
  for (const auto& input : model.inputs)
    if (input.of_each_reading()) squares += input.is.u * input.is.u;
  return squares;
}

}  // namespace

BudgetOf::BudgetOf(const ReadingModel& model, double repetition, double dof, Quantity quantity,
                   std::string source) {
  const bool repeated = std::any_of(model.lines.begin(), model.lines.end(),
                                    [](const BudgetLine& line) { return line.u > 0.0; });
  const bool scatter = std::isfinite(dof) && source == "readings", residuals = scatter && !repeated;
  const double each = variance_of_each(model), all = repetition * repetition;
  double rest = 1.0;
  if (residuals) rest = each > 0.0 ? std::sqrt(std::max(0.0, 1.0 - all / each)) : 0.0;
  if (scatter) unexplained_ = residuals && all > 0.0 ? std::max(0.0, 1.0 - each / all) : 1.0;
  budget_.contributions.push_back(
      {.id = "repetition",
       .u = repetition,
       .quantity = quantity,
       .distribution = std::isfinite(dof) ? Distribution::student : Distribution::normal,
       .correlation = Correlation::readings,
       .source = std::move(source)});
  if (std::isfinite(dof)) budget_.contributions.front().dof = dof;
  const bool others = std::any_of(model.lines.begin(), model.lines.end(),
                                  [](const BudgetLine& line) { return !line.in_residuals; });
  for (const auto& input : model.inputs) {
    each_.push_back(input.of_each_reading());
    factor_.push_back(each_.back() ? rest : 1.0);
    counts_.push_back(factor_.back() > 0.0 || others);
    if (!counts_.back()) {
      budget_.contributions.front().source += ", " + input.is.source;
      continue;
    }
    budget_.contributions.push_back(input.is);
    if (!others) budget_.contributions.back().u *= factor_.back();
  }
  for (const BudgetLine& line : model.lines)
    if (along(line)) budget_.length = std::max(budget_.length, extent(line));
  budget_.missing = model.missing;
}

std::vector<double> BudgetOf::counted(double u_repetition, const Shares& shares) const {
  const auto in = [&](std::size_t i) {
    return i < shares.in_residuals.size() ? shares.in_residuals[i] * shares.in_residuals[i] : 0.0;
  };
  // No contribution to the scatter can exceed the scatter that was found.
  const double found = unexplained_ * u_repetition * u_repetition;
  double expected = 0.0;
  for (std::size_t i = 0; i < shares.u.size(); ++i)
    if (!each_[i]) expected += in(i);
  const double part = expected > found ? found / expected : unexplained_ > 0.0 ? 1.0 : 0.0;
  std::vector<double> out;
  for (std::size_t i = 0; i < shares.u.size(); ++i)
    if (counts_[i]) {
      const double once = each_[i] ? 1.0 - factor_[i] * factor_[i] : part;
      out.push_back(std::sqrt(std::max(0.0, shares.u[i] * shares.u[i] - once * in(i))));
    }
  return out;
}

Expanded BudgetOf::expand(double u_repetition, const Shares& shares) const {
  Expanded out;
  double variance = u_repetition * u_repetition;
  for (const double u : counted(u_repetition, shares)) variance += u * u;
  out.u = std::sqrt(variance);
  const double dof =
      shares.dof > 0.0 ? shares.dof : budget_.contributions.front().dof.value_or(INFINITY);
  const double k_repetition = k_of(dof);
  out.repeatability = k_repetition * u_repetition;
  out.dof = u_repetition > 0.0 ? dof * std::pow(out.u / u_repetition, 4) : INFINITY;
  double fourth = 0.0;
  for (std::size_t i = 0; i < shares.rectangular.size(); ++i)
    if (counts_[i]) fourth += std::pow(factor_[i] * shares.rectangular[i], 4);
  out.k = !budget_.missing.empty() ? k_repetition
          : fourth > 0.0           ? k_of(out.dof, of_rectangle * fourth / (variance * variance))
                                   : k_of(out.dof);
  if (budget_.missing.empty() && out.u > 0.0) out.U = out.k * out.u;
  return out;
}

Value BudgetOf::value(std::string name, double v, Quantity quantity, double u_repetition,
                      const Shares& shares) {
  const Expanded e = expand(u_repetition, shares);
  Value out{name, v, quantity, e.U, e.k, {}};
  if (!e.U) {
    if (e.repeatability > 0.0) out.repeatability = e.repeatability;
    return out;
  }
  UncertaintyBudget::Result line{std::move(name), quantity, {u_repetition}, e.k, e.dof};
  const auto others = counted(u_repetition, shares);
  line.u.insert(line.u.end(), others.begin(), others.end());
  budget_.results.push_back(std::move(line));
  return out;
}

void BudgetOf::put(Series& s, std::span<const double> u_repetition,
                   std::span<const Shares> shares) const {
  const bool whole = budget_.missing.empty();
  std::vector<double> u;
  double k = 0.0;
  for (std::size_t i = 0; i < u_repetition.size(); ++i) {
    const Expanded e = expand(u_repetition[i], shares[i]);
    u.push_back(whole ? e.u : u_repetition[i]);
    if (u.back() > 0.0) k = std::max(k, e.k);  // a point that is 0 by definition has no effect on k
  }
  s.k = k > 0.0 ? k : 2.0;
  for (const double one : u) (whole ? s.U : s.repeatability).push_back(s.k * one);
}

Finding missing_finding(const std::vector<std::string>& missing) {
  std::string keys;
  for (const std::string& key : missing) keys += (keys.empty() ? "" : ", ") + key;
  return FindingBuilder("uncertainty.no-data", false, false).text("missing", keys).done();
}

std::optional<std::string> exact_instrument(const Instrument& i, bool angular) {
  if (angular && i.U_angle && *i.U_angle == 0.0)
    return "instrument.U_arcsec (0: no instrument is exact)";
  if (!angular && i.U_fixed && i.U_per_length && *i.U_fixed == 0.0 && *i.U_per_length == 0.0)
    return "instrument.U_fixed_um (0: no instrument is exact)";
  return {};
}

}  // namespace nonio::math
