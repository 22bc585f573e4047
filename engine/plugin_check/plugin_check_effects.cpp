// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <numeric>

#include "nonio/model/explain.h"
#include "nonio/sdk/format.h"
#include "platform/storage/digest.h"
#include "plugin_check/plugin_check_truth.h"
#include "plugin_check/plugin_checks.h"

namespace nonio::plugin_check::kit {

namespace {

using Columns = Effect::Columns;

constexpr double planted_size = 10e-6, planted_noise = 0.5e-6;

struct Shown {
  std::string sample;
  model::Part part;
  model::Term term;

  std::string where() const { return "sample " + sample + ", " + term.name(); }
  const Observations& table() const { return part.table; }
};

std::vector<Shown> shown(const Effect& effect, const Bench& bench) {
  std::vector<Shown> all;
  const std::vector<Effect> one{effect};
  for (const Sample& s : bench.samples)
    for (const model::Part& part : model::parts_of(s.campaign, s.observations)) {
      auto terms = model::catalogue(part, one);
      if (effect.is_nuisance)
        if (auto always = model::terms_of(part, s.campaign.machine, {}, one)) terms = *always;
      for (model::Term& term : terms) {
        term.effect = &effect;
        all.push_back({s.name, part, std::move(term)});
      }
    }
  return all;
}

constexpr const char* unseen =
    "no sample shows this effect; put a campaign that does into cases/<name>/campaign.toml";

std::optional<std::vector<double>> shape_at(const Effect& e, const Shown& s, double share) {
  std::vector<double> shape;
  for (const auto& one : e.shapes) {
    const auto grid = one.grid(s.table(), s.term.axis);
    if (grid.empty()) return std::nullopt;
    shape.push_back(grid[static_cast<std::size_t>(share * static_cast<double>(grid.size() - 1))]);
  }
  return shape;
}

/// In space, the columns of an effect of one axis are multiplied by the component of the direction
/// of sensing along that axis.
Expected<Columns> sensed_columns(const Effect& e, const Shown& s,
                                 const std::vector<double>& shape) {
  auto columns = e.columns(s.table(), s.term.axis, shape);
  const std::size_t k = coordinate_of(s.term.axis.name);
  if (!columns || e.instances || s.part.kind != model::Part::Kind::space || k > 2) return columns;
  for (auto& c : *columns)
    for (std::size_t i = 0; i < c.size(); ++i) c[i] *= s.table().sense_of(i)[k];
  return columns;
}

double norm(const std::vector<double>& v) {
  return std::sqrt(std::inner_product(v.begin(), v.end(), v.begin(), 0.0));
}

/// Subtracts the mean of each line, because the zero of each line is unknown.
std::vector<double> without_zeros(const Observations& o, std::vector<double> v) {
  std::vector<double> sum(std::max<std::size_t>(o.lines.size(), 1)), count(sum.size());
  const auto line = [&](std::size_t i) { return o.line.empty() ? 0U : o.line[i]; };
  for (std::size_t i = 0; i < v.size(); ++i) sum[line(i)] += v[i], count[line(i)] += 1.0;
  for (std::size_t i = 0; i < v.size(); ++i) v[i] -= sum[line(i)] / count[line(i)];
  return v;
}

/// Subtracts the projection onto an orthonormal basis, twice because of rounding errors.
void take_away(const Columns& basis, std::vector<double>& v) {
  for (int twice = 0; twice < 2; ++twice)
    for (const auto& b : basis) {
      const double part = std::inner_product(b.begin(), b.end(), v.begin(), 0.0);
      for (std::size_t i = 0; i < v.size(); ++i) v[i] -= part * b[i];
    }
}

/// `least` receives the smallest share of a column's norm that is linearly independent of the
/// preceding columns.
Columns basis_of(const Observations& o, const Columns& columns, double& least) {
  Columns basis;
  least = 1.0;
  for (const auto& c : columns) {
    auto v = without_zeros(o, c);
    const double whole = norm(c);
    take_away(basis, v);
    const double left = norm(v);
    least = std::min(least, whole > 0.0 ? left / whole : 0.0);
    if (!(left > 1e-9 * whole)) continue;
    for (double& x : v) x /= left;
    basis.push_back(std::move(v));
  }
  return basis;
}

std::string wrong_columns(const Effect& e, const Columns& columns, const Shown& s) {
  if (!e.curve && columns.size() != e.linear.size())
    return "it has " + std::to_string(columns.size()) + " columns for " +
           std::to_string(e.linear.size()) + " parameters";
  if (columns.empty()) return "it has no columns";
  for (const auto& c : columns) {
    if (c.size() != s.table().size())
      return "a column has " + std::to_string(c.size()) + " entries for " +
             std::to_string(s.table().size()) + " readings";
    if (!std::all_of(c.begin(), c.end(), [](double x) { return std::isfinite(x); }))
      return "a column has an entry that is not a number";
  }
  return {};
}

/// Calls `law` for each term, with shape parameters in the middle of their grids. Fails with the
/// first non-empty text that `law` returns.
Verdict everywhere(
    const Effect& e, const Bench& bench,
    const std::function<std::string(const Shown&, const std::vector<double>&)>& law) {
  const auto all = shown(e, bench);
  if (all.empty()) return skipped(unseen);
  for (const Shown& s : all) {
    bench.stage(s.where());
    const auto shape = shape_at(e, s, 0.5);
    if (!shape) return failed(s.where() + ": it applies, and a shape has nowhere to look");
    if (const std::string why = law(s, *shape); !why.empty()) return failed(s.where() + ": " + why);
  }
  return passed();
}

Verdict effect_columns(const Effect& e, const Bench& bench) {
  if (!e.columns || !e.applies) return failed("applies or columns is missing");
  if (e.linear.empty()) return failed("it has no linear parameter");
  return everywhere(e, bench, [&](const Shown& s, const std::vector<double>& shape) {
    const auto columns = e.columns(s.table(), s.term.axis, shape);
    if (!columns) return "it applies, and gives no columns: " + columns.error().message;
    return wrong_columns(e, *columns, s);
  });
}

Verdict effect_again(const Effect& e, const Bench& bench) {
  return everywhere(e, bench, [&](const Shown& s, const std::vector<double>& shape) {
    const auto one = e.columns(s.table(), s.term.axis, shape);
    const auto two = e.columns(s.table(), s.term.axis, shape);
    const bool same = one && two && *one == *two;
    return same ? std::string() : "the same readings give other columns the second time";
  });
}

Verdict effect_still(const Effect& e, const Bench& bench) {
  if (e.instances) return skipped("an effect in space: a stationary axis is included");
  return everywhere(e, bench, [&](const Shown& s, const std::vector<double>& shape) -> std::string {
    std::vector<std::uint32_t> order(s.table().size());
    std::iota(order.begin(), order.end(), 0U);
    order.push_back(static_cast<std::uint32_t>(order.size() / 2));
    Observations o = rearranged(s.table(), order);
    for (auto& axis : o.axes) {
      if (axis.approach.empty() || axis.axis != s.term.axis.name) continue;
      axis.approach.back() = 0;
      axis.position.back() += 0.37;
    }
    const auto columns = e.columns(o, s.term.axis, shape);
    if (!columns) return "it gives no columns: " + columns.error().message;
    for (const auto& c : *columns)
      if (c.empty() || c.back() != 0.0) return "it is not 0 where the axis was stationary";
    return {};
  });
}

/// Effects of one axis need samples with times, because without times the order of the rows is the
/// order of time.
Verdict effect_rows(const Effect& e, const Bench& bench) {
  storage::Random random = bench.random(2);
  std::size_t seen = 0;
  const Verdict v =
      everywhere(e, bench, [&](const Shown& s, const std::vector<double>& shape) -> std::string {
        if (s.table().time.empty() && !e.instances) return {};
        ++seen;
        const auto order = shuffled(s.table().size(), random);
        const auto one = e.columns(s.table(), s.term.axis, shape);
        const auto two = e.columns(rearranged(s.table(), order), s.term.axis, shape);
        if (!one || !two || one->size() != two->size()) return "it gives other columns";
        const Observations other = rearranged(s.table(), order);
        for (std::size_t k = 0; k < one->size(); ++k) {
          // A column may be relative to the first row of a line; this difference is part of the
          // zero of the line.
          const auto a = without_zeros(s.table(), (*one)[k]), b = without_zeros(other, (*two)[k]);
          const double size = norm((*one)[k]) + 1e-300;
          for (std::size_t i = 0; i < order.size(); ++i)
            if (!(std::fabs(b[i] - a[order[i]]) <= 1e-9 * size))
              return "rows in another order give other columns";
        }
        return {};
      });
  if (v.state == Verdict::State::passed && seen == 0)
    return skipped("no sample with times shows it");
  return v;
}

Verdict effect_grid(const Effect& e, const Bench& bench) {
  if (e.shapes.empty()) return skipped("it has no shape");
  return everywhere(e, bench, [&](const Shown& s, const std::vector<double>&) -> std::string {
    for (const auto& shape : e.shapes) {
      const auto grid = shape.grid(s.table(), s.term.axis);
      const std::string name = "the grid of " + shape.parameter.name;
      for (std::size_t i = 0; i < grid.size(); ++i)
        if (!std::isfinite(grid[i]) || (i > 0 && !(grid[i] > grid[i - 1])))
          return name + " does not rise at its value " + std::to_string(i + 1);
    }
    return {};
  });
}

double alike(const Observations& o, const Columns& columns, const Columns& others) {
  double least = 0.0, whole = 0.0, left = 0.0;
  const Columns basis = basis_of(o, others, least);
  for (const auto& c : columns) {
    auto v = without_zeros(o, c);
    whole += norm(v) * norm(v);
    take_away(basis, v);
    left += norm(v) * norm(v);
  }
  return whole > 0.0 ? 1.0 - left / whole : 1.0;
}

/// If the columns of neighboring grid values differ too much, the search misses an effect between
/// both values.
Verdict effect_neighbours(const Effect& e, const Bench& bench) {
  const bool any = std::any_of(e.shapes.begin(), e.shapes.end(),
                               [](const Effect::Shape& s) { return s.continuous; });
  if (!any || e.shapes.size() != 1) return skipped("it has no single continuous shape");
  constexpr double wanted = 0.5;
  return everywhere(e, bench, [&](const Shown& s, const std::vector<double>&) -> std::string {
    const auto grid = e.shapes[0].grid(s.table(), s.term.axis);
    std::vector<Columns> at;
    for (const double value : grid) {
      auto columns = e.columns(s.table(), s.term.axis, {value});
      if (!columns) return "no columns at a value of its own grid: " + columns.error().message;
      at.push_back(std::move(*columns));
    }
    for (std::size_t i = 0; at.size() > 1 && i < at.size(); ++i) {
      double best = 0.0;
      if (i > 0) best = alike(s.table(), at[i], at[i - 1]);
      if (i + 1 < at.size()) best = std::max(best, alike(s.table(), at[i], at[i + 1]));
      if (!(best >= wanted))
        return "at " + short_text(grid[i], 4) + " (SI) of the grid the neighbours share " +
               fixed_text(100.0 * best, 0) + " % of its columns: expected 50 % at least";
    }
    return {};
  });
}

/// One sample is sufficient, because the engine detects in other samples that readings do not
/// separate effects.
Verdict effect_independent(const Effect& e, const Bench& bench) {
  const auto all = shown(e, bench);
  if (all.empty()) return skipped(unseen);
  // On a circle the direction of sensing changes with each reading, so that a constant is visible.
  const auto turns = [](const Shown& s) { return !s.table().sense.empty(); };
  const bool everywhere_turned = std::all_of(all.begin(), all.end(), turns);
  double best = -1.0;
  std::string where;
  for (const Shown& s : all) {
    if (turns(s) && !everywhere_turned) continue;
    bench.stage(s.where());
    for (const double share : {0.5, 0.0, 1.0}) {
      const auto shape = shape_at(e, s, share);
      const auto columns = shape ? sensed_columns(e, s, *shape) : fail("");
      if (!columns) continue;
      double least = 0.0;
      basis_of(s.table(), *columns, least);
      if (least > best) best = least, where = s.where();
    }
  }
  if (best > 1e-6) return passed();
  return failed("in no sample its columns are independent of each other and of a constant (" +
                where + " comes nearest)");
}

struct Planted {
  model::Part part;
  std::vector<double> parameters, shape, truth;
};

std::optional<Planted> plant(const Effect& e, const Shown& s, storage::Random& random) {
  Planted p{s.part, {}, {}, std::vector<double>(s.table().size())};
  const auto shape = shape_at(e, s, random.uniform());
  if (!shape) return std::nullopt;
  p.shape = *shape;
  const auto columns = sensed_columns(e, s, p.shape);
  if (!columns) return std::nullopt;
  double least = 0.0;
  basis_of(s.table(), *columns, least);
  if (!(least > 1e-3)) return std::nullopt;
  for (const auto& c : *columns) {
    const double size = norm(without_zeros(s.table(), c));
    const double factor = random.uniform(0.5, 1.0) * (random.uniform() < 0.5 ? -1.0 : 1.0) *
                          planted_size * std::sqrt(static_cast<double>(c.size())) / size;
    p.parameters.push_back(factor);
    for (std::size_t i = 0; i < c.size(); ++i) p.truth[i] += factor * c[i];
  }
  for (std::size_t i = 0; i < p.truth.size(); ++i)
    p.part.table.deviation[i] = p.truth[i] + planted_noise * random.normal();
  return p;
}

std::string missed(const Effect& e, const Planted& p, const model::Fit& fit) {
  const auto n = static_cast<double>(p.truth.size());
  const auto planted = without_zeros(p.part.table, p.truth);
  const auto found = without_zeros(p.part.table, fit.part.front());
  double sum = 0.0;
  for (std::size_t i = 0; i < planted.size(); ++i)
    sum += (found[i] - planted[i]) * (found[i] - planted[i]);
  const auto unknowns = static_cast<double>(p.parameters.size() + p.shape.size());
  const double allowed = 4.0 * planted_noise * std::sqrt((unknowns + 4.0) / n);
  if (const double rms = std::sqrt(sum / n); !(rms <= allowed))
    return "least squares miss it by " + short_text(rms * 1e6, 3) + " um or urad (rms): expected " +
           short_text(allowed * 1e6, 3) + " at most";
  if (e.curve || !e.shapes.empty()) return {};
  for (std::size_t k = 0; k < p.parameters.size(); ++k) {
    const model::Parameter& q = fit.parameters[k];
    if (!(std::fabs(q.value - p.parameters[k]) <= 4.0 * q.u))
      return "planted " + q.name + " = " + short_text(p.parameters[k], 6) + ", found " +
             short_text(q.value, 6) + " with u = " + short_text(q.u, 2) + " (SI): expected 4 u";
  }
  return {};
}

Verdict effect_planted(const Effect& e, const Bench& bench) {
  const auto all = shown(e, bench);
  if (all.empty()) return skipped(unseen);
  storage::Random random = bench.random(3);
  std::size_t tried = 0;
  for (const Shown& s : all) {
    bench.stage(s.where());
    const auto p = plant(e, s, random);
    if (!p) continue;
    const auto fit = model::fit(p->part.table, {s.term});
    if (!fit) return failed(s.where() + ": " + fit.error().message);
    ++tried;
    if (const std::string why = missed(e, *p, *fit); !why.empty())
      return failed(s.where() + ": " + why);
  }
  return tried == 0 ? skipped("no sample determines its parameters") : passed();
}

bool named(const model::Explanation& x, const std::string& name) {
  const auto has = [&](const std::vector<std::string>& names) {
    return std::find(names.begin(), names.end(), name) != names.end();
  };
  if (x.verdict.effect == name || has(x.together)) return true;
  return std::any_of(x.candidates.begin(), x.candidates.end(), [&](const model::Candidate& c) {
    const bool said =
        c.term.name() == x.verdict.effect ||
        std::find(x.together.begin(), x.together.end(), c.term.name()) != x.together.end();
    return said && has(c.aliases);
  });
}

bool unseen_in(const model::Explanation& x, const std::string& name) {
  return std::any_of(x.candidates.begin(), x.candidates.end(), [&](const model::Candidate& c) {
    return c.term.name() == name && !c.visible;
  });
}

bool describes(const model::Explanation& x, const std::string& name) {
  return std::any_of(x.descriptions.begin(), x.descriptions.end(),
                     [&](const model::Description& d) { return d.term.name() == name; });
}

/// Passes if `explain` names the effect, or describes the deviations by it, in the first sample
/// that determines its parameters.
Verdict effect_explained(const Effect& e, const Bench& bench) {
  if (e.is_nuisance) return skipped("it is in every model and never a candidate");
  if (e.of_channels)
    return skipped("how often it is named depends on how often its channel changed");
  const auto all = shown(e, bench);
  if (all.empty()) return skipped(unseen);
  storage::Random random = bench.random(4);
  for (const Shown& s : all) {
    bench.stage(s.where() + ", explained");
    const auto p = plant(e, s, random);
    if (!p) continue;
    const auto catalogue = model::catalogue(p->part, bench.effects);
    const auto always = model::terms_of(p->part, Machine{}, {}, bench.effects);
    const auto x = model::explain(p->part, always ? *always : std::vector<model::Term>{}, catalogue,
                                  bench.seed);
    if (!x) return failed(s.where() + ": " + x.error().message);
    if (named(*x, s.term.name()) || describes(*x, s.term.name())) return passed();
    if (unseen_in(*x, s.term.name())) continue;
    // A similar cause has priority over a description, and a free curve of time may resemble poor
    // repeatability.
    if (e.description && x->verdict.kind != model::Verdict::Kind::nothing) continue;
    return failed(s.where() + ": planted alone, explain states " +
                  (x->verdict.effect.empty() ? "nothing" : x->verdict.effect) + " instead");
  }
  return skipped("no sample determines its parameters");
}

std::string survives(const Effect& e, const Observations& o, const Axis& axis) {
  std::vector<std::string> names{axis.name};
  if (e.instances) names = e.instances(o);
  for (const std::string& name : names) {
    Axis one = axis;
    if (e.instances) one = Axis{.name = name};
    const bool applies = e.applies(o, one);
    std::vector<double> shape;
    for (const auto& s : e.shapes)
      if (const auto grid = s.grid(o, one); !grid.empty()) shape.push_back(grid.front());
    const auto columns = e.columns(o, one, shape);
    e.columns(o, one, {});
    e.columns(o, one, {0.0});
    if (!applies || !columns || shape.size() != e.shapes.size()) continue;
    for (const auto& c : *columns) {
      if (c.size() != o.size()) return "columns of another length";
      if (!std::all_of(c.begin(), c.end(), [](double x) { return std::isfinite(x); }))
        return "a column with an entry that is not a number";
    }
  }
  return {};
}

Verdict effect_hostile(const Effect& e, const Bench& bench) {
  for (const Sample& s : bench.samples)
    for (const model::Part& part : model::parts_of(s.campaign, s.observations))
      for (const auto& [name, o] : odd_tables(part.table))
        for (const Axis& axis : part.axes) {
          bench.stage("sample " + s.name + ", " + axis.name + ", " + name);
          if (const std::string why = survives(e, o, axis); !why.empty())
            return failed("sample " + s.name + ", " + name + ": it applies, and gives " + why);
        }
  return passed();
}

}  // namespace

Verdict fingerprint(const Effect& e, const Bench& bench) {
  if (!e.columns || !e.applies) return skipped("applies or columns is missing");
  const auto all = shown(e, bench);
  if (all.empty()) return skipped(unseen);
  if (bench.only_plugin) bench.only_plugin();
  std::string text;
  for (const Shown& s : all) {
    bench.stage(s.where());
    const auto shape = shape_at(e, s, 0.5);
    if (!shape) continue;
    const auto columns = e.columns(s.table(), s.term.axis, *shape);
    text += s.where() + (columns ? std::string("\n") : ": " + columns.error().message + "\n");
    if (!columns) continue;
    for (const auto& c : *columns)
      for (const double x : c) text += exact_text(x) + " ";
  }
  return {Verdict::State::passed, storage::sha256(text)};
}

const std::vector<Check<Effect>>& effect_checks() {
  static const std::vector<Check<Effect>> checks = {
      {"columns", "One column per parameter, one entry per reading, only numbers.", effect_columns},
      {"true-values", "Its columns are those of its formula file.",
       [](const Effect& x, const Bench& bench) { return truth(x, bench); }},
      {"again", "The same input gives the same bytes.", effect_again},
      {"at-rest", "Columns are 0 for readings with the axis at rest.", effect_still},
      {"rows", "The order of rows does not change the result.", effect_rows},
      {"grid", "The grid values of a shape increase.", effect_grid},
      {"neighbours", "Neighbouring grid values give similar columns.", effect_neighbours},
      {"independent", "Columns are independent of each other and of a constant.",
       effect_independent},
      {"planted", "Least squares recover a planted effect.", effect_planted},
      {"explained", "explain names a planted effect, or an alias of it.", effect_explained},
      {"malformed", "Unusual readings cause no crash, no hang and no invalid number.",
       effect_hostile}};
  return checks;
}

}  // namespace nonio::plugin_check::kit
