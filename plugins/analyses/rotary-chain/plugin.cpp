// SPDX-License-Identifier: Apache-2.0
// Two rotary axes of a machine as one kinematic chain: both axis lines from one fit of ball
// centers.
#include "nonio/sdk/plugin.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "chain.h"
#include "nonio/math/probed.h"

namespace nonio::rotary_chain {
namespace {

constexpr double per_um = 1e-6, per_urad = 1e-6, per_mm = 1e-3;
constexpr const char* linear_axes_key = "options.rotary-chain.linear_axes_urad";

bool applies(const Campaign& c, const Measurement& m) {
  for (const Measurement& other : c.measurements)
    if (other.kind == "ball-centres" && same_state(other, m)) return other.id == m.id;
  return false;
}

Wish wish_of(const Settings& options) {
  Wish wish;
  const auto above_0 = [&](const char* name, double per) -> std::optional<double> {
    const double v = options.number(name);
    return v > 0.0 ? std::optional(v * per) : std::nullopt;
  };
  wish.sigma = above_0("sigma_um", per_um);
  wish.linear_axes = above_0("linear_axes_urad", per_urad);
  wish.U_tool = above_0("tool_U_um", per_um);
  if (const double offset = options.number("offset_mm"); offset >= 0.0)
    wish.offset = offset * per_mm;
  wish.tolerance = options.number("tolerance_um") * per_um;
  wish.tolerance_direction = options.number("tolerance_urad") * per_urad;
  wish.circle_limit = options.number("circle_limit");
  return wish;
}

std::optional<Chain> chain_of(const AnalysisInput& in) {
  Chain chain;
  chain.axes = in.options.texts("tables");
  chain.tables = chain.axes.size();
  for (const std::string& head : in.options.texts("heads")) chain.axes.push_back(head);
  if (chain.axes.size() != 2 || chain.axes[0] == chain.axes[1]) return std::nullopt;
  for (const std::string& name : chain.axes) {
    const Axis* axis = in.campaign.machine.axis(name);
    if (axis == nullptr || !axis->rotary) return std::nullopt;
  }
  return chain;
}

struct Work {
  const AnalysisInput& in;
  Chain chain;
  Wish wish;
  Places places;
  Solved solved;
  math::ReadingModel model;
  Evaluation out;

  void say(const char* id, bool attention, std::vector<Number> evidence,
           std::vector<std::pair<std::string, std::string>> texts = {}) {
    out.findings.push_back({.id = id,
                            .attention = attention,
                            .evidence = std::move(evidence),
                            .texts = std::move(texts)});
  }
};

math::ReadingModel model_of(const Work& w, const Environment& environment) {
  math::ProbedPlaces places;
  for (const auto& r : w.places.readings) places.at.push_back(r.at);
  const auto n = static_cast<double>(places.at.size());
  for (const auto& at : places.at)
    for (std::size_t k = 0; k < 3; ++k) places.middle[k] += at[k] / n;
  for (const auto& at : places.at)
    places.radius = std::max(
        places.radius,
        std::hypot(at[0] - places.middle[0], at[1] - places.middle[1], at[2] - places.middle[2]));
  places.linear_axes = w.wish.linear_axes;
  places.linear_axes_key = linear_axes_key;
  math::ReadingModel model = math::probed_model(w.in.campaign, environment, places);
  if (w.chain.tables < w.chain.axes.size() && w.wish.U_tool) {
    math::ReadingModel::Input tool;
    tool.is = {.id = "tool-length",
               .u = *w.wish.U_tool / 2.0,
               .correlation = Correlation::device,
               .source = "options.rotary-chain.tool_U_um"};
    tool.of_line.assign(3, 0.0);
    tool.patterns.emplace_back(model.readings(), 0.0);
    model.inputs.push_back(std::move(tool));
  }
  return model;
}

double repetition_in(const Work& w, const std::vector<double>& by) {
  const std::size_t n = w.places.readings.size();
  double sum = 0.0;
  for (std::size_t i = 0; i < by.size(); ++i)
    sum += by[i] * by[i] / w.places.readings[i % n].weight;
  return w.solved.sigma * std::sqrt(sum);
}

math::Shares shares_of(const Work& w, const Candidate& c) {
  math::Shares shares = w.model.shares(c.value.by);
  if (!w.model.inputs.empty() && w.model.inputs.back().is.id == "tool-length")
    shares.u.back() = w.model.inputs.back().is.u * std::fabs(c.by_tool);
  return shares;
}

bool is_unseen(const math::ChainFit& fit, std::size_t axis) {
  return std::count_if(fit.open.begin(), fit.open.end(), [&](const auto& combination) {
           return combination.size() == 1 && combination[0] / 4 == axis;
         }) == 4;
}

void say_separation(Work& w, const std::vector<std::string>& withheld) {
  if (withheld.empty()) return;
  const math::ChainFit& fit = w.solved.fit;
  std::vector<std::string> names;
  for (std::size_t l = 0; l < w.chain.axes.size(); ++l) {
    for (const std::size_t k : fit.across[l])
      names.push_back(std::string(1, "xyz"[k]) + "_" + w.chain.axes[l]);
    for (const std::size_t k : fit.across[l])
      names.push_back(std::string(1, "ijk"[k]) + "_" + w.chain.axes[l]);
  }
  for (const std::string& id : w.places.used)
    for (const char k : {'x', 'y', 'z'}) names.push_back(std::string("ball ") + k + " of " + id);
  for (std::size_t t = 1; t < w.places.tools.size(); ++t)
    for (const char k : {'x', 'y', 'z'})
      names.push_back(std::string("tool ") + k + " of " + w.places.tools[t]->id);
  std::string which;
  const auto add = [&](const std::string& one) { which += (which.empty() ? "" : "; ") + one; };
  for (std::size_t l = 0; l < w.chain.axes.size(); ++l)
    if (is_unseen(fit, l)) add("line of " + w.chain.axes[l]);
  for (const auto& combination : fit.open) {
    if (combination.size() == 1 && combination[0] < 4 * w.chain.axes.size() &&
        is_unseen(fit, combination[0] / 4))
      continue;
    std::string one;
    for (const std::size_t k : combination)
      one += (one.empty() ? "" : " + ") + (k < names.size() ? names[k] : "?");
    add(one);
  }
  w.say("rotary-chain.not-identifiable", true,
        {{"unknowns", static_cast<double>(fit.unknowns), Quantity::count},
         {"rank", static_cast<double>(fit.rank), Quantity::count}},
        {{"names", listed(withheld)}, {"which", which}});
}

/// The pivot length needs the stated tool length and its U, because the fit determines only their
/// sum.
bool pivot_stated(const Work& w) {
  return !w.places.tools.empty() && tool_length(*w.places.tools.front()) > 0.0 &&
         w.wish.U_tool.has_value();
}

void say_tools(Work& w, const math::BudgetOf& budget) {
  if (w.chain.tables == w.chain.axes.size()) return;
  if (!pivot_stated(w))
    w.say("rotary-chain.tool-not-stated", false, {},
          {{"axis", listed({w.chain.axes.begin() + static_cast<std::ptrdiff_t>(w.chain.tables),
                            w.chain.axes.end()})}});
  const auto tools = tools_of(w.places);
  if (!tools.two || !w.wish.U_tool) return;
  const Candidate c{"tool", Quantity::length,
                    math::chain_value(w.solved.fit, [&](const math::ChainState& s) {
                      const auto &a = s.tool[tools.from], &b = s.tool[tools.to];
                      return std::hypot(b[0] - a[0], b[1] - a[1], b[2] - a[2]);
                    })};
  if (!c.value.identifiable) return;
  const double u = budget.expand(repetition_in(w, c.value.by), shares_of(w, c)).u;
  const double U = 2.0 * std::hypot(u, *w.wish.U_tool / std::numbers::sqrt2);
  if (std::fabs(c.value.value - tools.stated) > U)
    w.say("rotary-chain.tools-disagree", true,
          {{"measured", c.value.value, Quantity::length},
           {"stated", tools.stated, Quantity::length},
           {"U", U, Quantity::deviation}},
          {{"one", w.places.tools[tools.from]->id}, {"other", w.places.tools[tools.to]->id}});
}

void say_offset(Work& w, const Value& distance) {
  if (!w.wish.offset) return;
  const double U = distance.U.value_or(distance.repeatability.value_or(0.0));
  const bool differs = std::fabs(distance.value - *w.wish.offset) > U;
  w.say(differs ? "rotary-chain.offset-differs" : "rotary-chain.offset-as-stated", differs,
        {{"distance", distance.value, Quantity::length},
         {"nominal", *w.wish.offset, Quantity::length},
         {"U", U, Quantity::deviation}},
        {{"one", w.chain.axes[0]}, {"other", w.chain.axes[1]}});
}

/// Names in the history differ from those of a single axis, because both axes are at 0. A center
/// coordinate along its axis is omitted, because it depends on the ball position.
void follow(Evaluation& e) {
  const auto component = [&](const std::string& name) {
    for (const Value& v : e.values)
      if (v.name == name) return std::fabs(v.value);
    return 1.0;
  };
  std::string both;
  for (const Value& v : e.values)
    if (v.name.starts_with("direction_i_")) both += v.name.substr(12);
  for (Value& v : e.values) {
    if (v.name == "distance" || v.name == "angle")
      v.followed = {"chain_" + v.name + ':' + both, both};
    for (std::size_t k = 0; k < 3; ++k) {
      const std::string centre = std::string("centre_") + "xyz"[k] + '_',
                        direction = std::string("direction_") + "ijk"[k] + '_';
      if (v.name.starts_with(direction))
        v.followed = {std::string("chain_") + "ijk"[k], v.name.substr(direction.size())};
      if (!v.name.starts_with(centre)) continue;
      const std::string axis = v.name.substr(centre.size());
      if (component(direction + axis) <= 0.7) v.followed = {std::string("chain_") + "xyz"[k], axis};
    }
  }
}

void put_values(Work& w, math::BudgetOf& budget) {
  std::vector<std::string> withheld;
  for (const Candidate& c : candidates(w.chain, w.places, w.solved.fit)) {
    if (!c.value.identifiable) {
      withheld.push_back(c.name);
      continue;
    }
    if (c.name.starts_with("pivot_") && !pivot_stated(w)) continue;
    const double u = repetition_in(w, c.value.by);
    const math::Shares shares = shares_of(w, c);
    const math::Expanded e = budget.expand(u, shares);
    const double U = e.U.value_or(e.repeatability);
    const double tolerance = c.is_direction() ? w.wish.tolerance_direction : w.wish.tolerance;
    if (!(U <= tolerance)) {
      const Quantity q = c.is_direction() ? Quantity::small_angle : Quantity::deviation;
      w.say("rotary-chain.too-uncertain", true, {{"U", U, q}, {"tolerance", tolerance, q}},
            {{"name", c.name}});
      continue;
    }
    w.out.values.push_back(budget.value(c.name, c.value.value, c.quantity, u, shares));
    if (c.name == "distance") say_offset(w, Value(w.out.values.back()));
  }
  // s includes effects that the U of the values does not contain.
  w.out.values.push_back({"s", w.solved.fit.s, Quantity::deviation});
  say_separation(w, withheld);
}

void put_points(Work& w) {
  PointTable& points = w.out.points;
  const auto add = [&](const std::string& name, Quantity q, const auto& of) {
    std::vector<double> column;
    for (std::size_t i = 0; i < w.places.readings.size(); ++i) column.push_back(of(i));
    points.columns.push_back({name, q, std::move(column)});
  };
  for (std::size_t l = 0; l < w.chain.axes.size(); ++l)
    add(w.chain.axes[l], Quantity::angle,
        [&](std::size_t i) { return w.places.readings[i].angle[l]; });
  for (std::size_t k = 0; k < 3; ++k)
    add(std::string(1, "xyz"[k]), Quantity::length,
        [&](std::size_t i) { return w.places.readings[i].at[k]; });
  for (std::size_t k = 0; k < 3; ++k)
    add(std::string("residual_") + "xyz"[k], Quantity::deviation,
        [&](std::size_t i) { return w.solved.fit.residual[i][k]; });
  if (w.places.order.balls > 1)
    add("ball", Quantity::count,
        [&](std::size_t i) { return static_cast<double>(w.places.readings[i].ball + 1); });
  add("n", Quantity::count, [&](std::size_t i) { return w.places.readings[i].weight; });
}

void put_notes(Work& w) {
  const math::ChainFit& fit = w.solved.fit;
  const auto part = [&](bool head) {
    std::vector<std::string> names;
    for (std::size_t l = 0; l < w.chain.axes.size(); ++l)
      if (w.chain.is_head(l) == head) names.push_back(w.chain.axes[l]);
    return listed(names);
  };
  const auto count = [](const char* name, std::size_t n) {
    return Number{name, static_cast<double>(n), Quantity::count};
  };
  w.out.notes.push_back(
      {"method.rotary-chain",
       {{"sigma", w.solved.sigma, Quantity::deviation},
        {"dof", std::isfinite(w.solved.dof) ? w.solved.dof : static_cast<double>(fit.dof),
         Quantity::count},
        count("centres", w.places.readings.size()),
        count("rank", fit.rank),
        count("unknowns", fit.unknowns)},
       {{"axes", listed(w.chain.axes)}, {"measurements", listed(w.places.used)}}});
  if (w.chain.tables > 0)
    w.out.notes.push_back({"rotary-chain.tables", {}, {{"axes", part(false)}}});
  if (w.chain.tables < w.chain.axes.size())
    w.out.notes.push_back({"rotary-chain.heads", {}, {{"axes", part(true)}}});
  if (!w.places.left_out.empty())
    w.out.notes.push_back(
        {"rotary-chain.left-out", {}, {{"measurements", listed(w.places.left_out)}}});
}

Evaluation refused(Work& w) {
  for (Finding& f : w.out.findings)
    if (f.measurement.empty()) f.measurement = w.in.measurement.id;
  return std::move(w.out);
}

Expected<Evaluation> analyse(const AnalysisInput& in) {
  Work w{in, {}, wish_of(in.options), {}, {}, {}, {}};
  const auto chain = chain_of(in);
  if (!chain) {
    w.say("rotary-chain.axes-needed", true, {});
    return refused(w);
  }
  w.chain = *chain;
  w.places = places_of(in, w.chain);
  w.out.findings = std::move(w.places.findings);
  if (!w.places.sound) return refused(w);
  if (w.places.used.empty()) {
    w.say("rotary-chain.no-angles", true, {},
          {{"axes", listed(w.chain.axes)}, {"column", w.chain.axes.front() + "_deg"}});
    return refused(w);
  }
  w.out.uses = w.places.used;
  std::erase(w.out.uses, in.measurement.id);
  math::HeldLimits limits = math::limits_held(in.campaign, w.places.tables);
  w.model = model_of(w, limits.environment);
  w.solved = solve(in, w.chain, w.places, w.wish, w.model);
  for (Finding& f : w.solved.findings) w.out.findings.push_back(std::move(f));
  if (!w.solved.given) return refused(w);
  if (std::isfinite(w.solved.dof) && !w.solved.residual_by.empty())
    w.model.see_residuals(w.solved.residual_by, w.solved.dof);
  for (Finding& f : limits.findings) w.out.findings.push_back(std::move(f));
  if (!w.model.missing.empty()) w.out.findings.push_back(math::missing_finding(w.model.missing));
  math::BudgetOf budget(w.model, w.solved.sigma, w.solved.dof, Quantity::deviation,
                        w.solved.from_readings ? "readings" : "options.rotary-chain.sigma_um");
  put_values(w, budget);
  follow(w.out);
  say_tools(w, budget);
  put_points(w);
  if (w.model.missing.empty()) w.out.budget = budget.budget();
  put_notes(w);
  for (Remark& r : w.out.notes) r.measurement = in.measurement.id;
  return refused(w);
}

Option number(const char* name, double value, const char* unit, const char* help, double least,
              double most) {
  return {name, value, unit, help, {}, least, most};
}

std::vector<Option> options() {
  return {
      {"tables", std::vector<std::string>{}, "",
       "Rotary axes that carry the workpiece, from the bed outwards."},
      {"heads", std::vector<std::string>{}, "",
       "Rotary axes that carry the tool, from the bed outwards."},
      {"same_reference", std::vector<std::string>{}, "",
       "Measurements whose centres have one reference point, so that they may be fitted together."},
      number("offset_mm", -1.0, "mm", "Nominal distance of the two axes; -1: not stated.", -1.0,
             1e5),
      number("tool_U_um", 0.0, "um",
             "U (k = 2) of the length of a tool that tool_offset states; 0: not known.", 0.0, 1e5),
      number("sigma_um", 0.0, "um",
             "Standard uncertainty of one coordinate; 0: from the residuals.", 0.0, 1e4),
      number("linear_axes_urad", 0.0, "urad",
             "Bound of squareness and scale difference of the linear axes; 0: not known.", 0.0,
             1e4),
      number("tolerance_um", 50.0, "um",
             "Wanted U of a length; a value that misses it is not given.", 1e-3, 1e6),
      number("tolerance_urad", 100.0, "urad",
             "Wanted U of a direction or angle; a value that misses it is not given.", 1e-3, 1e6),
      number("circle_limit", 10.0, "", "Residuals beyond this many sigma are not this chain.", 1.0,
             1e6)};
}

}  // namespace

NONIO_PLUGIN(registry) {
  Analysis a;
  a.info = {"rotary-chain", "1.0.0",
            "Two rotary axes as one chain, from centres of a ball at positions of both.", options(),
            true};
  a.applies = applies;
  a.analyse = analyse;
  a.states_followed = true;
  registry.add(std::move(a));
}

}  // namespace nonio::rotary_chain
