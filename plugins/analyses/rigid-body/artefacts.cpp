// SPDX-License-Identifier: Apache-2.0
#include "artefacts.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <numeric>
#include <set>

namespace nonio::rigid_body {

using math::Artefact;
using math::BudgetLine;
using math::Corner;
using math::ReadingModel;

namespace {

constexpr double per_K = 1e-6, per_um_per_m = 1e-6;
const std::string of_options = "options.rigid-body.";

/// "B1" for the line "B1 x".
std::string ball_of(const std::string& line) { return line.substr(0, line.find(' ')); }

std::size_t number_of(Artefact& a, const std::string& name) {
  for (std::size_t b = 0; b < a.balls.size(); ++b)
    if (a.balls[b].name == name) return b;
  a.balls.push_back({.name = name});
  return a.balls.size() - 1;
}

void put_certificate(const Observations& o, Artefact& a) {
  for (std::size_t i = 0; i < o.size(); ++i) {
    const std::string &line = o.lines[o.line_of(i)].name, ball = ball_of(line);
    const Corner& sense = o.sense_of(i);
    const std::size_t number = number_of(a, ball);
    if (sense == Corner{}) {
      const std::size_t other = number_of(a, line.substr(ball.size() + 1));
      a.lengths.push_back({number, other, o.deviation[i], o.u[i]});
      continue;
    }
    auto& stated = a.balls[number].stated;
    if (!stated) stated = Corner{};
    for (std::size_t k = 0; k < 3; ++k)
      if (sense[k] != 0.0) (*stated)[k] = o.deviation[i];
    a.balls[number].u = o.u[i];
  }
}

/// Positions of stationary axes, from `at` of the manifest, m; NaN if not stated.
Corner stood_at(const Measurement& m) {
  Corner at;
  at.fill(std::numeric_limits<double>::quiet_NaN());
  for (const auto& [axis, position] : m.at)
    if (const std::size_t k = coordinate_of(axis); k < 3) at[k] = position;
  return at;
}

struct Probed {
  math::ArtefactPlacement placement;
  std::vector<BudgetLine::Visit> visits;  ///< in time order, equal for all coordinates
};

Probed probed(const Measurement& m, const Observations& o, Artefact& a) {
  const std::vector<double> times = math::reading_times(o);
  std::vector<std::size_t> order(o.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::stable_sort(order.begin(), order.end(),
                   [&](std::size_t x, std::size_t y) { return times[x] < times[y]; });
  Probed out;
  out.placement.name = m.id;
  auto& measured = out.placement.measured;
  for (std::size_t k = 0; k < 3; ++k)
    measured[k] = std::any_of(o.lines.begin(), o.lines.end(),
                              [k](const auto& line) { return line.sense[k] != 0.0; });
  const Corner stood = stood_at(m);
  const auto first = static_cast<std::size_t>(std::find(measured.begin(), measured.end(), true) -
                                              measured.begin());
  std::map<std::size_t, std::size_t> place;
  std::vector<std::array<std::size_t, 3>> count;
  for (const std::size_t i : order) {
    const std::size_t b = number_of(a, ball_of(o.lines[o.line_of(i)].name));
    const auto [at, fresh] = place.try_emplace(b, place.size());
    if (fresh) {
      out.placement.ball.push_back(b);
      Corner& at_ball = out.placement.at.emplace_back();
      for (std::size_t k = 0; k < 3; ++k)
        if (!measured[k]) at_ball[k] = stood[k];
      count.push_back({});
    }
    for (std::size_t k = 0; k < 3; ++k) {
      if (o.sense_of(i)[k] == 0.0) continue;
      auto& n = count[at->second][k];
      double& mean = out.placement.at[at->second][k];
      ++n;
      mean += (o.deviation[i] - mean) / static_cast<double>(n);
      if (k == first) out.visits.push_back({times[i], at->second, 1.0});
    }
  }
  for (auto& visit : out.visits)
    visit.weight = 1.0 / static_cast<double>(count[visit.reading][first]);
  return out;
}

bool of_state(const AnalysisInput& in, const Measurement& m) {
  return state_of(m).empty() || state_of(m) == state_of(in.measurement);
}

BudgetLine budget_of(const AnalysisInput& in, const math::RigidLine& line, std::size_t k,
                     const std::vector<BudgetLine::Visit>& visits, std::size_t group) {
  BudgetLine b;
  b.kind = BudgetLine::Kind::length;
  b.group = group;
  b.visits = visits;
  double zero = INFINITY;
  for (const auto& r : line.readings) zero = std::min(zero, r.at[k]);
  for (const auto& r : line.readings) b.length.push_back(r.at[k] - zero);
  const std::vector<std::string> axes{std::string(1, "XYZ"[k])};
  const std::vector<double> direction{1.0};
  math::put_expansion(b, in.campaign, axes, direction);
  return b;
}

struct ScaleInputs {
  double device, temperature, expansion;
  double all() const { return std::hypot(device, temperature, expansion); }
};

ScaleInputs scale_of(const AnalysisInput& in) {
  const double rectangle = 1.0 / (2.0 * std::sqrt(3.0));
  const auto get = [&](const char* name) { return in.options.number(name); };
  const double distance = std::fabs(in.campaign.environment.temperature_difference.value_or(0.0));
  return {get("artefact_U_per_m_um") * per_um_per_m / 2.0,
          rectangle * get("artefact_temperature_range_K") * get("artefact_expansion") * per_K,
          rectangle * distance * get("artefact_expansion_range") * per_K};
}

void refuse(const AnalysisInput& in, const std::string& name, const math::ArtefactRefusal& why,
            Lines& out) {
  const bool fits = why.why == math::ArtefactRefusal::Why::not_linked;
  Finding f{.id = fits ? "rigid-body.artefact-not-linked" : "rigid-body.artefact-does-not-fit",
            .attention = true,
            .texts = {{"artefact", name}, {"placement", why.placement}, {"ball", why.ball}}};
  if (!fits)
    f.evidence = {{"distance", why.distance, Quantity::deviation},
                  {"limit", math::artefact_limit, Quantity::deviation}};
  out.findings.push_back(std::move(f));
  for (const Measurement& m : in.campaign.measurements)
    if (m.kind == "artefact" && m.lateral == name && of_state(in, m)) out.left_out.push_back(m.id);
}

void take_artefact(const AnalysisInput& in, const std::string& name, std::size_t& unknowns,
                   Lines& out) {
  Artefact a;
  a.name = name;
  std::vector<Probed> placements;
  for (std::size_t i = 0; i < in.all->size(); ++i) {
    const Measurement& m = in.campaign.measurements[i];
    const Observations& o = (*in.all)[i];
    if (m.lateral != name || o.size() == 0) continue;
    if (m.kind == "artefact-certificate") {
      put_certificate(o, a);
      out.certificates.push_back(m.id);
    }
    if (m.kind == "artefact" && of_state(in, m)) placements.push_back(probed(m, o, a));
  }
  for (const Probed& p : placements) a.placements.push_back(p.placement);
  a.u_scale = scale_of(in).all();
  const std::size_t group = out.group_of("artefact", false);
  auto made = math::artefact_lines(a, unknowns, group);
  if (!made) return refuse(in, name, made.error(), out);
  unknowns += made->unknowns;
  std::size_t common = 0;
  for (std::size_t l = 0; l < made->lines.size(); ++l) {
    math::RigidLine& line = made->lines[l];
    if (l < made->of.size()) {
      const auto [placement, k] = made->of[l];
      // All coordinates of a placement have one common error.
      if (l == 0 || made->of[l - 1].placement != placement) {
        common = out.lines.size();
        out.used.push_back(a.placements[placement].name);
      }
      out.budget.push_back(budget_of(in, line, k, placements[placement].visits, common));
    } else {
      out.stated.push_back({out.lines.size(), name, {}});
      out.budget.push_back(stated_budget(line.readings.size(), out.lines.size()));
    }
    out.lines.push_back(std::move(line));
    out.measurement_of_line.push_back(out.used.size() - 1);
  }
  if (!made->states) out.uncalibrated.push_back(name);
}

ReadingModel::Input input(const ReadingModel& model, const char* id, Distribution d,
                          std::string source) {
  ReadingModel::Input out;
  out.is = {.id = id,
            .quantity = Quantity::deviation,
            .distribution = d,
            .correlation = Correlation::device,
            .source = std::move(source)};
  out.of_line.assign(model.lines.size(), 0.0);
  return out;
}

std::size_t first_of(const ReadingModel& model, std::size_t line) {
  std::size_t first = 0;
  for (std::size_t l = 0; l < line; ++l) first += model.lines[l].length.size();
  return first;
}

void put_one(ReadingModel& model, ReadingModel::Input in, std::size_t line, std::size_t reading,
             double u) {
  std::vector<double> pattern(model.readings(), 0.0);
  pattern[first_of(model, line) + reading] = u;
  in.of_line[line] = std::max(in.of_line[line], u);
  in.patterns.push_back(std::move(pattern));
  model.inputs.push_back(std::move(in));
}

void put_artefact(const AnalysisInput& in, const Lines& lines, const Stated& stated,
                  ReadingModel& model) {
  const math::RigidLine& line = lines.lines[stated.line];
  const std::size_t n = line.readings.size() - 1;
  auto fixed = input(model, "artefact-fixed", Distribution::normal,
                     "certificate of " + stated.name + ", U_um");
  fixed.is.correlation = Correlation::readings;
  for (std::size_t i = 0; i < n; ++i) {
    std::vector<double> pattern(model.readings(), 0.0);
    pattern[first_of(model, stated.line) + i] = line.readings[i].u;
    fixed.is.u = std::max(fixed.is.u, line.readings[i].u);
    fixed.patterns.push_back(std::move(pattern));
  }
  fixed.of_line[stated.line] = fixed.is.u;
  model.inputs.push_back(std::move(fixed));
  const ScaleInputs scale = scale_of(in);
  double longest = 0.0;  // The budget states the effect of the scale on the longest line.
  for (const BudgetLine& b : lines.budget)
    for (const double d : b.length) longest = std::max(longest, d);
  const auto put = [&](const char* id, double u, Distribution d, const char* key) {
    auto one = input(model, id, d, of_options + key);
    one.is.with_length = true;
    one.is.u = u * longest;
    if (u > 0.0) put_one(model, std::move(one), stated.line, n, u);
  };
  put("artefact-length", scale.device, Distribution::normal, "artefact_U_per_m_um");
  put("artefact-temperature", scale.temperature, Distribution::rectangular,
      "artefact_temperature_range_K");
  put("artefact-expansion", scale.expansion, Distribution::rectangular, "artefact_expansion_range");
  for (const char* key :
       {"artefact_expansion", "artefact_temperature_range_K", "artefact_expansion_range"})
    if (!(in.options.number(key) > 0.0)) {
      const std::string wanted = of_options + key;
      if (std::find(model.missing.begin(), model.missing.end(), wanted) == model.missing.end())
        model.missing.push_back(wanted);
    }
}

}  // namespace

BudgetLine stated_budget(std::size_t readings, std::size_t group) {
  BudgetLine b;
  b.kind = BudgetLine::Kind::lateral;
  b.length.assign(readings, 0.0);
  b.group = group;
  b.in_residuals = false;
  return b;
}

void take_artefacts(const AnalysisInput& in, std::size_t& unknowns, Lines& out) {
  std::vector<std::string> names;
  for (std::size_t i = 0; i < in.all->size(); ++i) {
    const Measurement& m = in.campaign.measurements[i];
    if (m.kind == "artefact" && of_state(in, m) && (*in.all)[i].size() > 0 &&
        std::find(names.begin(), names.end(), m.lateral) == names.end())
      names.push_back(m.lateral);
  }
  for (const std::string& name : names) take_artefact(in, name, unknowns, out);
}

/// The instrument did not read balls and certified values. For balls only inputs of the machine and
/// its environment remain, for certified values none.
void keep_own_inputs(const Lines& lines, ReadingModel& model) {
  static const std::set<std::string> of_machine{"temperature", "expansion", "drift"};
  bool instrument = false;
  for (std::size_t l = 0; l < lines.lines.size(); ++l) {
    const auto kind = lines.lines[l].kind;
    const bool point = kind == math::RigidLine::Kind::point;
    if (!point && kind != math::RigidLine::Kind::stated) {
      instrument |= kind != math::RigidLine::Kind::angle;
      continue;
    }
    for (auto& one : model.inputs)
      if (!point || !of_machine.contains(one.is.id)) one.of_line[l] = 0.0;
  }
  for (auto& one : model.inputs) {
    one.is.u = 0.0;
    for (std::size_t l = 0; l < model.lines.size(); ++l) {
      const auto& length = model.lines[l].length;
      const double far = length.empty() ? 0.0 : *std::max_element(length.begin(), length.end());
      one.is.u = std::max(one.is.u, one.of_line[l] * (one.is.with_length ? far : 1.0));
    }
  }
  std::erase_if(model.inputs, [](const auto& one) { return one.is.u == 0.0; });
  if (!instrument)
    std::erase_if(model.missing, [](const std::string& key) {
      return (key.starts_with("instrument.") && !key.starts_with("instrument.U_arcsec")) ||
             key == "environment.misalignment_mm";
    });
}

void put_stated_inputs(const AnalysisInput& in, const Lines& lines, ReadingModel& model) {
  keep_own_inputs(lines, model);
  for (const Stated& stated : lines.stated) {
    if (stated.square.empty()) {
      put_artefact(in, lines, stated, model);
      continue;
    }
    auto square = input(model, "square", Distribution::normal, "square.U_urad");
    square.is.quantity = Quantity::small_angle;
    square.is.u = lines.lines[stated.line].readings.front().u;
    put_one(model, std::move(square), stated.line, 0, lines.lines[stated.line].readings.front().u);
  }
}

}  // namespace nonio::rigid_body
