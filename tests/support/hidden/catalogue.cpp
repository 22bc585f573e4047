// SPDX-License-Identifier: Apache-2.0
#include "catalogue.h"

#include <algorithm>
#include <cmath>

namespace nonio::hidden {
namespace {

using Values = std::vector<double>;

double dot(const Values& a, const Values& b) {
  double sum = 0.0;
  for (std::size_t i = 0; i < a.size(); ++i) sum += a[i] * b[i];
  return sum;
}

template <class F>
Values made(const Cycle& c, F of_row) {
  Values v(c.size());
  for (std::size_t i = 0; i < v.size(); ++i) v[i] = of_row(i);
  return v;
}

Columns harmonic(const Cycle& c, const Values& at, double per_unit) {
  return {made(c, [&](std::size_t i) { return std::sin(2.0 * pi * at[i] * per_unit); }),
          made(c, [&](std::size_t i) { return std::cos(2.0 * pi * at[i] * per_unit); })};
}

double square_left(const Values& signal, Columns columns) {
  columns.insert(columns.begin(), Values(signal.size(), 1.0));
  const Values left = project(signal, columns).left;
  return dot(left, left);
}

/// The best of one-column candidates.
template <class Make>
Columns best_of(const Values& signal, const Values& shapes, Make make) {
  Columns best;
  double least = -1.0;
  for (const double shape : shapes) {
    Columns columns = make(shape);
    const double left = square_left(signal, columns);
    if (least < 0.0 || left < least) least = left, best = std::move(columns);
  }
  return best;
}

void append(Columns& to, const Columns& more) { to.insert(to.end(), more.begin(), more.end()); }

/// Growth from the middle; if the fixed point is elsewhere, with what moves all readings alike.
/// `of`(way from the fixed point, row).
template <class F>
Columns growing(const Scenario& s, F of, const Cycle& c) {
  Columns columns{made(c, [&](std::size_t i) { return of(c.p[i], i); })};
  if (s.fixed != 0.0) columns.push_back(made(c, [&](std::size_t i) { return of(c.length, i); }));
  return columns;
}

Columns best_warm_up(const Values& signal, const Cycle& c, const Values& t, const Scenario& s) {
  Values taus;
  for (int k = 0; k <= 120; ++k) taus.push_back(t.back() * 0.02 * std::pow(400.0, k / 120.0));
  return best_of(signal, taus, [&](double tau) {
    return growing(
        s, [&](double way, std::size_t i) { return way * -std::expm1(-t[i] / tau); }, c);
  });
}

Columns best_jump(const Values& signal, const Cycle& c) {
  Values firsts;
  for (std::size_t i = 1; i < c.size(); ++i) firsts.push_back(static_cast<double>(i));
  return best_of(signal, firsts, [&](double first) {
    return Columns{
        made(c, [&](std::size_t i) { return static_cast<double>(i) < first ? 0.0 : 1.0; })};
  });
}

Columns powers(const Cycle& c, int from, int to) {
  Columns columns;
  for (int k = from; k <= to; ++k)
    columns.push_back(made(c, [&](std::size_t i) { return std::pow(2.0 * c.p[i] / c.length, k); }));
  return columns;
}

double mean_material(const Cycle& c) {
  double mean = 0.0;
  for (const double m : c.material) mean += m / static_cast<double>(c.size());
  return mean;
}

}  // namespace

Projection project(std::vector<double> signal, const Columns& columns) {
  // q: orthonormal columns; r: what of each was in the earlier ones.
  Columns q;
  std::vector<std::size_t> kept;
  std::vector<Values> r;
  for (std::size_t k = 0; k < columns.size(); ++k) {
    Values v = columns[k], row(columns.size() + 1, 0.0);
    const double before = std::sqrt(dot(v, v));
    for (int pass = 0; pass < 2; ++pass)
      for (std::size_t j = 0; j < q.size(); ++j) {
        const double s = dot(q[j], v);
        row[j] += s;
        for (std::size_t i = 0; i < v.size(); ++i) v[i] -= s * q[j][i];
      }
    const double norm = std::sqrt(dot(v, v));
    if (!(norm > 1e-9 * before)) continue;
    for (double& x : v) x /= norm;
    row[q.size()] = norm;
    q.push_back(std::move(v));
    kept.push_back(k);
    r.push_back(std::move(row));
  }
  Values on_q(q.size(), 0.0);
  for (int pass = 0; pass < 2; ++pass)
    for (std::size_t j = 0; j < q.size(); ++j) {
      const double s = dot(q[j], signal);
      on_q[j] += s;
      for (std::size_t i = 0; i < signal.size(); ++i) signal[i] -= s * q[j][i];
    }
  Projection result{Values(columns.size(), 0.0), std::move(signal)};
  for (std::size_t j = q.size(); j-- > 0;) {
    double x = on_q[j];
    for (std::size_t k = j + 1; k < q.size(); ++k) x -= r[k][j] * result.coefficient[kept[k]];
    result.coefficient[kept[j]] = x / r[j][j];
  }
  return result;
}

std::vector<double> file_times(const Cycle& c, const Scenario& s) {
  if (s.timed) return c.t;
  return made(c, [](std::size_t i) { return static_cast<double>(i); });
}

Columns best_columns(const std::string& kind, const Values& signal, const Cycle& c,
                     const Scenario& s) {
  const Values t = file_times(c, s);
  if (kind == "scale") return {c.p};
  if (kind == "pitch-curve") return powers(c, 2, 8);
  if (kind == "periodic") return harmonic(c, c.p, 1.0 / s.pitch);
  if (kind == "backlash") return {made(c, [&](std::size_t i) { return c.d[i] / 2.0; })};
  if (kind == "backlash-slope")
    return {made(c, [&](std::size_t i) { return c.d[i] * c.p[i] / 2.0; })};
  if (kind == "zero-drift") return {t};
  if (kind == "growth-drift")
    return growing(
        s, [&](double way, std::size_t i) { return way * t[i]; }, c);
  if (kind == "warm-up") return best_warm_up(signal, c, t, s);
  if (kind == "temperature") {
    const double mean = mean_material(c);
    return growing(
        s, [&](double way, std::size_t i) { return way * (c.material[i] - mean); }, c);
  }
  if (kind == "day-wave") {
    const double w = 2.0 * pi / 86400.0;
    Columns columns = growing(
        s, [&](double way, std::size_t i) { return way * std::sin(w * t[i]); }, c);
    append(columns,
           growing(
               s, [&](double way, std::size_t i) { return way * (1.0 - std::cos(w * t[i])); }, c));
    return columns;
  }
  if (kind == "run-jump") return best_jump(signal, c);
  if (kind == "eccentricity") return harmonic(c, c.position, 1.0 / (2.0 * pi));
  if (kind == "harmonic2") return harmonic(c, c.position, 2.0 / (2.0 * pi));
  if (kind == "gear-mesh") return harmonic(c, c.position, s.teeth / (2.0 * pi));
  if (kind == "elastic-reversal") {
    Columns columns = harmonic(c, c.position, 1.0 / (2.0 * pi));
    for (Values& column : columns)
      for (std::size_t i = 0; i < c.size(); ++i) column[i] *= c.d[i] / 2.0;
    return columns;
  }
  return {};
}

std::vector<std::string> parameters_of(const std::string& kind) {
  if (kind == "scale") return {"a"};
  if (kind == "backlash") return {"b"};
  if (kind == "backlash-slope") return {"c"};
  if (kind == "zero-drift") return {"z"};
  if (kind == "growth-drift") return {"g"};
  if (kind == "temperature") return {"k"};
  if (kind == "run-jump") return {"j"};
  if (kind == "periodic" || kind == "eccentricity" || kind == "harmonic2" || kind == "gear-mesh" ||
      kind == "elastic-reversal")
    return {"a", "b"};
  return {};
}

namespace {

struct Made {
  std::string kind;
  Values deviation;
  Columns columns;
};

double in_noise(const Values& left, const Scenario& s) {
  return std::sqrt(dot(left, left)) / s.noise;
}

/// What could be taken for this effect, as sets of columns.
std::vector<Columns> look_alikes(const Made& m, const Cycle& c, const Scenario& s) {
  const auto columns_of = [&](const char* kind) { return best_columns(kind, m.deviation, c, s); };
  std::vector<Columns> rivals;
  if (m.kind == "day-wave") {
    for (const char* kind : {"growth-drift", "warm-up"}) {
      rivals.push_back(columns_of(kind));
      append(rivals.back(), {c.p});
    }
  }
  if (m.kind == "warm-up" || m.kind == "temperature") {
    rivals.push_back(columns_of("growth-drift"));
    append(rivals.back(), {c.p});
  }
  if (m.kind == "temperature") {
    rivals.push_back(columns_of("warm-up"));
    append(rivals.back(), {c.p});
  }
  if (s.temperatures && (m.kind == "warm-up" || m.kind == "growth-drift")) {
    rivals.push_back(columns_of("temperature"));
    append(rivals.back(), {c.p});
  }
  if (m.kind == "zero-drift") rivals.push_back(columns_of("run-jump"));
  if (m.kind == "run-jump") rivals.push_back(columns_of("zero-drift"));
  if (m.kind == "pitch-curve") {
    Values periods;
    for (int k = 0; k <= 100; ++k) periods.push_back(c.length / 6.0 * std::pow(9.0, k / 100.0));
    rivals.push_back(best_of(m.deviation, periods,
                             [&](double period) { return harmonic(c, c.p, 1.0 / period); }));
  }
  return rivals;
}

/// The targets meet the period at phases that are neither few nor slowly moving.
bool well_sampled(const Made& m, const Cycle& c, const Scenario& s) {
  Columns smooth = powers(c, 0, static_cast<int>(std::min<std::size_t>(8, s.targets / 3)));
  return in_noise(project(m.deviation, smooth).left, s) > 0.6 * in_noise(m.deviation, s);
}

/// The effect that the cause is named after describes it.
bool well_named(const Made& m, const Cycle& c, const Scenario& s) {
  Columns own = m.columns;
  own.insert(own.begin(), Values(c.size(), 1.0));
  return in_noise(project(m.deviation, own).left, s) < 0.03 * in_noise(m.deviation, s);
}

bool shown_beside(const Made& m, Columns others, const Cycle& c, const Scenario& s) {
  if (m.kind != "pitch-curve" && !well_named(m, c, s)) return false;
  if ((m.kind == "periodic" || m.kind == "gear-mesh") && !well_sampled(m, c, s)) return false;
  if (in_noise(project(m.deviation, others).left, s) < seen_from) return false;
  for (const Columns& rival : look_alikes(m, c, s)) {
    Columns with = others;
    append(with, rival);
    if (in_noise(project(m.deviation, with).left, s) < told_from) return false;
  }
  return true;
}

/// Whether the part of an effect outside the catalogue that the catalogue cannot describe exceeds
/// the noise.
bool outside_shown(const Values& deviation, const Columns& model, const Cycle& c,
                   const Scenario& s) {
  Columns columns = model;
  append(columns, powers(c, 1, 6));
  for (const char* kind : {"backlash", "backlash-slope", "zero-drift", "growth-drift", "run-jump"})
    append(columns, best_columns(kind, deviation, c, s));
  if (s.rotary)
    for (const char* kind : {"eccentricity", "harmonic2", "elastic-reversal"})
      append(columns, best_columns(kind, deviation, c, s));
  const double left = in_noise(project(deviation, columns).left, s);
  return left >= 2.0 * seen_from && left >= 0.8 * std::sqrt(static_cast<double>(c.size()));
}

/// Temperature must not run along with time.
bool temperature_of_its_own(const Cycle& c, const Scenario& s) {
  const Values t = file_times(c, s), ones(c.size(), 1.0);
  const Values K = project(c.material, {ones}).left;
  Values taus;
  for (int k = 0; k <= 40; ++k) taus.push_back(t.back() * 0.05 * std::pow(100.0, k / 40.0));
  Columns course = best_of(K, taus, [&](double tau) {
    return Columns{made(c, [&](std::size_t i) { return std::exp(-t[i] / tau); })};
  });
  append(course, {ones});
  const Values left = project(K, course).left;
  return dot(left, left) > 0.5 * dot(K, K);
}

}  // namespace

bool shown(const Scenario& s) {
  const Cycle c = cycle_of(s);
  if (s.temperatures && !temperature_of_its_own(c, s)) return false;
  std::vector<Made> made_of;
  std::uint64_t stream = 10;
  std::vector<Piece> pieces = s.model;
  pieces.insert(pieces.end(), s.hidden.begin(), s.hidden.end());
  for (const Piece& piece : pieces) {
    // From one side no motion is lost: such a cause is the same at every reading but the first.
    if (s.one_way && piece.source == Source::lost_motion) return false;
    Made m{kind_of(piece.source), {}, {}};
    m.deviation = simulate_sized(piece.source, c, s, Random(s.seed, stream++), piece.size * s.noise)
                      .deviation;
    m.columns = best_columns(m.kind, m.deviation, c, s);
    made_of.push_back(std::move(m));
  }
  const Columns constant{Values(c.size(), 1.0)};
  for (std::size_t i = 0; i < made_of.size(); ++i) {
    Columns others = constant;
    for (std::size_t j = 0; j < made_of.size(); ++j)
      if (j != i) append(others, made_of[j].columns);
    const bool seen = made_of[i].kind.empty() ? outside_shown(made_of[i].deviation, others, c, s)
                                              : shown_beside(made_of[i], others, c, s);
    if (!seen) return false;
  }
  return true;
}

}  // namespace nonio::hidden
