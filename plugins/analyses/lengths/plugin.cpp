// SPDX-License-Identifier: Apache-2.0
// Length measuring errors (based on ISO 10360-2) of a machine that measures with its own probe.
#include "nonio/sdk/plugin.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "nonio/math/budget.h"
#include "nonio/math/decision.h"
#include "nonio/math/lengths.h"

namespace nonio::lengths {
namespace {

using math::BudgetLine;
using math::LengthError;
using math::LengthLimit;

bool applies(const Campaign&, const Measurement& m) { return m.kind == "lengths"; }

constexpr double per_um = 1e-6;

LengthLimit limit_of(const Settings& options, const std::string& test) {
  return {options.number("mpe_" + test + "_um") * per_um,
          options.number("mpe_" + test + "_divisor") * 1e-3 / per_um,
          options.number("mpe_" + test + "_most_um") * per_um};
}

/// Budget of the artefact: certificate, temperature if it expands, and alignment. Scatter, drift
/// and temperature of the machine are part of the length errors.
math::ReadingModel model_of(const Campaign& campaign, const std::vector<LengthError>& errors) {
  std::map<std::size_t, BudgetLine> by_line;
  for (const LengthError& e : errors) {
    BudgetLine& line = by_line[e.line];
    line.kind = BudgetLine::Kind::length;
    line.expansion = 0.0;
    line.length.push_back(e.L);
  }
  std::vector<BudgetLine> lines;
  for (auto& [number, line] : by_line) lines.push_back(std::move(line));
  Environment environment = campaign.environment;
  environment.drift = 0.0;
  environment.temperature_range = environment.expansion_range = 0.0;
  if (!campaign.instrument.expansion) environment.temperature_difference = 0.0;
  math::ReadingModel model = math::reading_model(campaign, environment, std::move(lines));
  std::erase_if(model.inputs, [](const auto& input) {
    return input.is.id == "drift" || input.is.id == "temperature" || input.is.id == "expansion";
  });
  return model;
}

struct Decided {
  std::string name;
  double value = 0.0, limit = 0.0, U = 0.0, L = 0.0;
  Decision decision = Decision::cannot_be_decided;
  std::size_t outside = 0, undecided = 0;
};

class Worker {
 public:
  explicit Worker(const AnalysisInput& in)
      : in_(in), by_2001_(in.options.text("edition") == "2001") {}

  Evaluation run() {
    const Observations& o = in_.observations;
    if (!o.axes.empty() && o.axes.front().axis == "point")
      sphere();
    else
      lengths();
    out_.notes.push_back({by_2001_ ? "method.lengths-2001" : "method.lengths-2009"});
    return std::move(out_);
  }

 private:
  std::vector<LengthError> errors_of(const std::string& test) const {
    const Observations& o = in_.observations;
    std::vector<LengthError> out;
    for (std::size_t i = 0; i < o.size(); ++i)
      if (o.lines[o.line_of(i)].name.starts_with(test + " "))
        out.push_back({o.axes.front().position[i], o.deviation[i], o.run_of(i), o.line_of(i)});
    // Sorted by line, which is the order of the budget.
    std::stable_sort(out.begin(), out.end(), [](const LengthError& a, const LengthError& b) {
      return std::tie(a.line, a.L, a.repeat) < std::tie(b.line, b.L, b.repeat);
    });
    return out;
  }

  void lengths() {
    std::vector<LengthError> all = errors_of("E0");
    for (const LengthError& e : errors_of("EL")) all.push_back(e);
    std::stable_sort(all.begin(), all.end(),
                     [](const LengthError& a, const LengthError& b) { return a.line < b.line; });
    if (all.empty()) return;
    const math::ReadingModel model = model_of(in_.campaign, all);
    math::BudgetOf budget(model, 0.0, INFINITY, Quantity::deviation);
    for (const char* test : {"E0", "EL"}) put_test(test, all, model, budget);
    put_repeats(all, model, budget);
    points(all);
    if (const auto& alpha = in_.campaign.instrument.expansion; alpha && *alpha < 2e-6)
      out_.notes.push_back({"lengths.low-expansion", {{"alpha", *alpha, Quantity::expansion}}});
    if (!model.missing.empty())
      out_.findings.push_back(math::missing_finding(model.missing));
    else
      out_.budget = budget.budget();
  }

  bool is_of(const LengthError& e, const char* test) const {
    return in_.observations.lines[e.line].name.starts_with(std::string(test) + " ");
  }

  /// Returns U and its coverage factor, at least those of the accreditation.
  std::pair<double, double> at_least(double U, double k, const math::BudgetOf& budget) const {
    const double least =
        math::least_U(in_.campaign.laboratory, Quantity::deviation, budget.budget().length);
    return U < least ? std::pair(least, 2.0) : std::pair(U, k);
  }

  void put_test(const char* test, const std::vector<LengthError>& all,
                const math::ReadingModel& model, math::BudgetOf& budget) {
    std::vector<LengthError> errors;
    std::vector<std::size_t> rows;
    for (std::size_t i = 0; i < all.size(); ++i)
      if (is_of(all[i], test)) errors.push_back(all[i]), rows.push_back(i);
    if (errors.empty()) return;
    std::vector<math::Shares> shares;
    std::vector<double> U, k;
    for (const std::size_t i : rows) {
      std::vector<double> row(all.size(), 0.0);
      row[i] = 1.0;
      shares.push_back(model.shares(row));
      const math::Expanded expanded = budget.expand(0.0, shares.back());
      const auto [least, factor] = at_least(expanded.U.value_or(NAN), expanded.k, budget);
      U.push_back(least), k.push_back(factor);
    }
    const LengthLimit limit = limit_of(in_.options, test);
    const math::LengthAnswer answer =
        math::judge_lengths(errors, limit, U, by_2001_, in_.campaign.certificate.decision_rule, k);
    std::size_t most = 0, least = 0;
    for (std::size_t i = 0; i < errors.size(); ++i) {
      if (errors[i].E > errors[most].E) most = i;
      if (errors[i].E < errors[least].E) least = i;
    }
    const auto value = [&](const std::string& name, std::size_t i) {
      out_.values.push_back(budget.value(name, errors[i].E, Quantity::deviation, 0.0, shares[i]));
    };
    if (limit.stated()) {
      value(test, answer.worst);
      constexpr double printed = 1e9;  // to 0.001 um, as limits are stated
      const double at_worst = std::round(limit.at(errors[answer.worst].L) * printed) / printed;
      out_.values.back().judged = {at_worst, answer.decision};
    }
    value(std::string(test) + "_max", most), value(std::string(test) + "_min", least);
    plan(test, errors);
    if (!limit.stated()) return no_limit(test);
    const auto& worst = errors[answer.worst];
    decide({test, worst.E, limit.at(worst.L), U[answer.worst], worst.L, answer.decision,
            answer.outside, answer.undecided});
    if (answer.to_repeat > 0)
      out_.findings.push_back(
          {.id = "lengths.measure-again",
           .attention = true,
           .evidence = {{"lengths", static_cast<double>(answer.to_repeat), Quantity::count}},
           .texts = {{"name", test}}});
  }

  void put_repeats(const std::vector<LengthError>& all, const math::ReadingModel& model,
                   math::BudgetOf& budget) {
    std::vector<LengthError> errors;
    std::vector<std::size_t> rows;
    for (std::size_t i = 0; i < all.size(); ++i)
      if (is_of(all[i], "E0")) errors.push_back(all[i]), rows.push_back(i);
    const auto r = math::repeat_range(errors);
    if (!r) {
      out_.findings.push_back({.id = "lengths.no-repeats", .attention = false});
      return;
    }
    std::vector<double> row(all.size(), 0.0);
    if (r->high != r->low) row[rows[r->high]] = 1.0, row[rows[r->low]] = -1.0;
    const Value v = budget.value("R0", r->range, Quantity::deviation, 0.0, model.shares(row));
    out_.values.push_back(v);
    const LengthLimit limit = limit_of(in_.options, "R0");
    if (!limit.stated()) return no_limit("R0");
    decide_value("R0", out_.values.back(), limit.at(0.0), budget);
  }

  void sphere() {
    const Observations& o = in_.observations;
    std::map<double, std::array<double, 3>> found;
    std::map<double, int> coordinates;
    for (std::size_t i = 0; i < o.size(); ++i)
      for (std::size_t k = 0; k < 3; ++k)
        if (o.sense_of(i)[k] > 0.5) {
          found[o.axes.front().position[i]][k] = o.deviation[i];
          ++coordinates[o.axes.front().position[i]];
        }
    std::vector<std::array<double, 3>> list;
    for (const auto& [number, p] : found)
      if (coordinates[number] >= 3) list.push_back(p);
    const auto f = math::form_of_sphere(list);
    const auto count = static_cast<double>(list.size());
    if (!f) {
      out_.findings.push_back({.id = "lengths.refused-sphere",
                               .attention = true,
                               .evidence = {{"points", count, Quantity::count}}});
      return;
    }
    constexpr double wanted = 25.0;
    if (count != wanted)
      out_.findings.push_back({.id = "lengths.points-of-plan",
                               .attention = false,
                               .evidence = {{"points", count, Quantity::count}}});
    put_form(*f);
  }

  void put_form(const math::FormOfSphere& f) {
    math::ReadingModel model;
    const auto& sphere = in_.campaign.instrument.sphere;
    BudgetLine line;
    line.length = {0.0};
    model.lines.push_back(std::move(line));
    if (sphere) {
      math::ReadingModel::Input input;
      const double u = *sphere / std::sqrt(3.0);
      input.is = {.id = "sphere",
                  .u = u,
                  .distribution = Distribution::rectangular,
                  .correlation = Correlation::device,
                  .source = "instrument.sphere_um"};
      input.of_line = {u};
      input.patterns = {{u}};
      model.inputs.push_back(std::move(input));
    } else {
      model.missing.emplace_back("instrument.sphere_um");
      out_.findings.push_back(math::missing_finding(model.missing));
    }
    math::BudgetOf budget(model, 0.0, INFINITY, Quantity::deviation);
    const std::array<double, 1> row{1.0};
    const Value v = budget.value("P_form", f.P, Quantity::deviation, 0.0, model.shares(row));
    out_.values.push_back(v);
    out_.values.push_back({"radius", f.radius, Quantity::length});
    if (model.missing.empty()) out_.budget = budget.budget();
    const LengthLimit limit = limit_of(in_.options, "P");
    if (!limit.stated()) return no_limit("P_form");
    decide_value("P_form", out_.values[out_.values.size() - 2], limit.at(0.0), budget);
  }

  void decide_value(const char* name, Value& v, double limit, const math::BudgetOf& budget) {
    const auto [U, k] = at_least(v.U.value_or(NAN), v.k, budget);
    Decided d{name, v.value, limit, U};
    if (v.U)
      d.decision = math::decide(v.value, U, limit, in_.campaign.certificate.decision_rule, k);
    v.judged = {limit, d.decision};
    d.outside = d.decision == Decision::does_not_conform,
    d.undecided = d.decision == Decision::cannot_be_decided;
    decide(d);
  }

  void decide(const Decided& d) {
    Finding f{.id = d.decision == Decision::conforms           ? "lengths.conforms"
                    : d.decision == Decision::does_not_conform ? "lengths.does-not-conform"
                    : std::isfinite(d.U)                       ? "lengths.cannot-be-decided"
                                                               : "lengths.no-uncertainty",
              .attention = d.decision != Decision::conforms,
              .evidence = {{"value", d.value, Quantity::deviation},
                           {"limit", d.limit, Quantity::deviation},
                           {"outside", static_cast<double>(d.outside), Quantity::count},
                           {"undecided", static_cast<double>(d.undecided), Quantity::count},
                           {"length", d.L, Quantity::length}},
              .texts = {{"name", d.name}}};
    if (std::isfinite(d.U)) f.evidence.push_back({"U", d.U, Quantity::deviation});
    out_.findings.push_back(std::move(f));
  }

  void no_limit(const char* name) {
    out_.findings.push_back(
        {.id = "lengths.no-limit", .attention = false, .texts = {{"name", name}}});
  }

  void plan(const char* test, const std::vector<LengthError>& errors) {
    const math::LengthPlan p = math::length_plan(errors);
    // In the 2009 edition, EL has two positions and E0 seven.
    if (p.whole() ||
        (std::string_view(test) == "EL" && p.positions >= 2 && p.lengths >= 5 && p.repeats >= 3))
      return;
    out_.findings.push_back(
        {.id = "lengths.plan",
         .attention = false,
         .evidence = {{"positions", static_cast<double>(p.positions), Quantity::count},
                      {"lengths", static_cast<double>(p.lengths), Quantity::count},
                      {"repeats", static_cast<double>(p.repeats), Quantity::count}},
         .texts = {{"name", test}}});
  }

  void points(const std::vector<LengthError>& all) {
    std::map<std::pair<std::size_t, double>, std::array<double, 2>> rows;
    for (const LengthError& e : all) {
      auto [row, fresh] = rows.try_emplace({e.line, e.L}, std::array{e.E, e.E});
      row->second = {std::min(row->second[0], e.E), std::max(row->second[1], e.E)};
    }
    PointTable::Column target{"target", Quantity::length, {}}, line{"line", Quantity::count, {}},
        low{"min", Quantity::deviation, {}}, high{"max", Quantity::deviation, {}},
        mpe{"MPE", Quantity::deviation, {}};
    for (const auto& [key, range] : rows) {
      const LengthLimit limit =
          limit_of(in_.options, in_.observations.lines[key.first].name.substr(0, 2));
      target.values.push_back(key.second);
      line.values.push_back(static_cast<double>(key.first) + 1.0);
      low.values.push_back(range[0]), high.values.push_back(range[1]);
      mpe.values.push_back(limit.stated() ? limit.at(key.second) : NAN);
    }
    out_.points.columns = {std::move(target), std::move(line), std::move(low), std::move(high),
                           std::move(mpe)};
  }

  const AnalysisInput& in_;
  bool by_2001_;
  Evaluation out_;
};

Expected<Evaluation> analyse(const AnalysisInput& in) { return Worker(in).run(); }

std::vector<Option> options() {
  std::vector<Option> out{
      one_of({"2001", "2009"}, {"edition", std::string("2009"), "",
                                "Edition of ISO 10360-2: 2001 allows five lengths with one repeat "
                                "outside, each measured ten times more."})};
  const auto number = [&](const char* name, const char* unit, const char* help, double most) {
    out.push_back({name, 0.0, unit, help, {}, 0.0, most});
  };
  number("mpe_E0_um", "um", "A of the limit A + L/K of E0; 0: not stated.", 1e6);
  number("mpe_E0_divisor", "",
         "K of the limit A + L/K of E0, L in mm, the limit in um; 0: no such part.", 1e9);
  number("mpe_E0_most_um", "um", "B: the limit of E0 is never above it; 0: no such bound.", 1e6);
  number("mpe_EL_um", "um", "A of the limit of EL; 0: not stated.", 1e6);
  number("mpe_EL_divisor", "", "K of the limit of EL; 0: no such part.", 1e9);
  number("mpe_EL_most_um", "um", "B: the limit of EL is never above it; 0: no such bound.", 1e6);
  number("mpe_R0_um", "um", "Limit of R0; 0: not stated.", 1e6);
  number("mpe_P_um", "um", "Limit of P; 0: not stated.", 1e6);
  return out;
}

}  // namespace

NONIO_PLUGIN(registry) {
  Analysis a;
  a.info = {"lengths", "1.0.0",
            "Length measuring errors of a machine with a probe (ISO 10360-2): E0, EL, R0, P.",
            options()};
  a.applies = applies;
  a.analyse = analyse;
  a.states_followed = true;
  registry.add(std::move(a));
}

}  // namespace nonio::lengths
