// SPDX-License-Identifier: Apache-2.0
// The 21 geometric errors of three linear axes, as far as the readings of a campaign determine
// them, and the error of the tool point in the whole volume.
#include <algorithm>
#include <cmath>

#include "artefacts.h"
#include "nonio/sdk/format.h"

namespace nonio::rigid_body {

using namespace math;

namespace {

// Suffix of the results, because compensation tables use the results of the single methods.
const std::string of_all = "_all";
constexpr double enough = 5.0;         // required ratio of the largest error to its u
constexpr double enough_dof = 3.0;     // degrees of freedom required for a scatter
constexpr std::size_t most_shown = 6;  // maximum number of combinations in a message

std::string listed_names(const std::vector<std::string>& names) {
  std::string out;
  for (const std::string& name : names) out += (out.empty() ? "" : ", ") + name;
  return out;
}

/// "ECX.1 - 0.889 EYX.2"
std::string text_of(const Combination& c) {
  std::string out;
  for (const auto& [name, size] : c) {
    const std::string number = short_text(std::fabs(size));
    out += out.empty() ? (size < 0.0 ? "-" : "") : size < 0.0 ? " - " : " + ";
    out += (number == "1" ? "" : number + " ") + name;
  }
  return out;
}

Finding finding(const char* id, bool attention, std::vector<Number> evidence,
                std::vector<std::pair<std::string, std::string>> texts) {
  return {
      .id = id, .attention = attention, .evidence = std::move(evidence), .texts = std::move(texts)};
}

Number count(const char* name, std::size_t n) {
  return {name, static_cast<double>(n), Quantity::count};
}

struct Work {
  const AnalysisInput& in;
  Lines lines;
  ReadingModel model;
  RigidSolution s;
  Evaluation out;

  void say(Finding f) { out.findings.push_back(std::move(f)); }
};

std::size_t printed_group(const Work& w) {
  std::size_t best = 0;
  for (std::size_t g = 0; g < w.s.scatter.size(); ++g)
    if (!w.lines.angular[g] && (w.lines.angular[best] || w.s.scatter[g] > w.s.scatter[best]))
      best = g;
  return best;
}

void say_separation(Work& w) {
  const RigidSolution& s = w.s;
  if (!s.combinations.empty()) {
    std::string shown;
    for (std::size_t i = 0; i < std::min(s.combinations.size(), most_shown); ++i)
      shown += (shown.empty() ? "" : "; ") + text_of(s.combinations[i]);
    if (s.combinations.size() > most_shown) shown += "; ...";
    w.say(
        finding("rigid-body.not-separable", true,
                {count("combinations", s.combinations.size()),
                 count("unknowns", s.unknowns),
                 count("rank", s.rank),
                 {"open", s.rank < s.singular.size() ? s.singular[s.rank] : 0.0, Quantity::number},
                 {"told", s.rank > 0 ? s.singular[s.rank - 1] : 0.0, Quantity::number}},
                {{"which", shown}, {"withheld", listed_names(s.withheld)}}));
  }
  if (!s.unseen.empty())
    w.say(finding("rigid-body.unseen", false, {}, {{"errors", listed_names(s.unseen)}}));
  if (!s.map.known()) w.say(finding("rigid-body.no-map", true, {}, {}));
}

void note(Work& w, const char* id, const char* key, const std::vector<std::string>& names) {
  if (!names.empty()) w.out.notes.push_back({id, {}, {{key, listed_names(names)}}});
}

void put_notes(Work& w) {
  const RigidSolution& s = w.s;
  w.out.notes.push_back(
      {"rigid-body.fit",
       {count("readings", s.readings),
        count("unknowns", s.unknowns),
        count("rank", s.rank),
        count("degree", s.degree),
        {"told", s.rank > 0 ? s.singular[s.rank - 1] : 0.0, Quantity::number}},
       {{"weakest", text_of(s.weakest)}, {"measurements", listed_names(w.lines.used)}}});
  const auto asked = w.in.options.texts("errors");
  if (!asked.empty()) {
    std::vector<std::string> absent;
    for (const std::string& name : rigid_errors())
      if (std::find(asked.begin(), asked.end(), name) == asked.end()) absent.push_back(name);
    w.out.notes.push_back({"rigid-body.taken-as-absent", {}, {{"errors", listed_names(absent)}}});
  }
  note(w, "rigid-body.centred", "measurements", w.lines.centred);
  note(w, "rigid-body.left-out", "measurements", w.lines.left_out);
  note(w, "rigid-body.free-slope", "measurements", w.lines.free_slope);
  note(w, "rigid-body.uncalibrated", "artefacts", w.lines.uncalibrated);
}

bool angular(const std::string& error) {
  return error[0] == 'E' && error[1] >= 'A' && error[1] <= 'C';
}

void put_map(Work& w, BudgetOf& budget) {
  const VolumeMap& map = w.s.map;
  if (!map.known()) return;
  if (map.size > enough * budget.expand(map.u_size, map.shares_size).u)
    w.out.values.push_back(
        budget.value("V_max", map.size, Quantity::deviation, map.u_size, map.shares_size));
  else
    w.say(finding("rigid-body.no-largest", false, {{"size", map.size, Quantity::deviation}}, {}));
  static constexpr std::array<const char*, 3> places{"X", "Y", "Z"}, errors{"e_x", "e_y", "e_z"},
      uncertainties{"U_x", "U_y", "U_z"};
  PointTable& rows = w.out.rows;
  for (std::size_t k = 0; k < 3; ++k) {
    rows.columns.push_back({places[k], Quantity::length, {}});
    for (const VolumeNode& n : map.nodes) rows.columns.back().values.push_back(n.at[k]);
  }
  for (std::size_t k = 0; k < 3; ++k) {
    rows.columns.push_back({errors[k], Quantity::deviation, {}});
    for (const VolumeNode& n : map.nodes) rows.columns.back().values.push_back(n.error[k]);
  }
  for (std::size_t k = 0; k < 3 && w.model.missing.empty(); ++k) {
    rows.columns.push_back({uncertainties[k], Quantity::deviation, {}});
    for (const VolumeNode& n : map.nodes)
      rows.columns.back().values.push_back(budget.expand(n.u[k], n.shares[k]).U.value_or(0.0));
  }
}

void put_results(Work& w) {
  const std::size_t group = printed_group(w);
  const bool known = w.s.dof[group] >= enough_dof;
  if (!known)
    w.say(finding(
        "rigid-body.no-uncertainty", true,
        {{"dof", w.s.dof[group], Quantity::number}, {"wanted", enough_dof, Quantity::number}}, {}));
  BudgetOf budget(w.model, w.s.scatter[group], w.s.dof[group], Quantity::deviation);
  for (const auto& [name, v] : w.s.squareness)
    if (known)
      w.out.values.push_back(
          budget.value(name + of_all, v.value, Quantity::small_angle, v.u, v.shares));
    else
      w.out.values.push_back({name + of_all, v.value, Quantity::small_angle});
  for (const RigidCurve& c : w.s.curves) {
    Series series{c.name + of_all,
                  std::string(1, "XYZ"[c.axis]),
                  Quantity::length,
                  angular(c.name) ? Quantity::small_angle : Quantity::deviation,
                  c.position,
                  c.value,
                  {}};
    if (known) budget.put(series, c.u, c.shares);
    w.out.series.push_back(std::move(series));
  }
  if (!known) return;
  put_map(w, budget);
  if (w.model.missing.empty()) w.out.budget = budget.budget();
}

Expected<Evaluation> analyse(const AnalysisInput& in) {
  Work w{in, lines_of(in), {}, {}, {}};
  std::size_t moving = 0;
  for (std::size_t k = 0; k < 3; ++k) moving += w.lines.high[k] > w.lines.low[k] ? 1 : 0;
  w.out.findings = w.lines.findings;
  for (Finding& f : w.out.findings) f.measurement = in.measurement.id;
  if (w.lines.lines.empty() || moving == 0) return std::move(w.out);
  w.out.uses = w.lines.used;
  w.out.uses.insert(w.out.uses.end(), w.lines.certificates.begin(), w.lines.certificates.end());
  std::erase(w.out.uses, in.measurement.id);
  RigidWish wish{w.lines.low, w.lines.high, in.options.texts("errors"),
                 static_cast<std::size_t>(in.options.integer("degree")),
                 static_cast<std::size_t>(in.options.integer("parts"))};
  const HeldLimits limits = limits_held(in.campaign, w.lines.tables);
  w.model = reading_model(in.campaign, limits.environment, w.lines.budget);
  put_stated_inputs(in, w.lines, w.model);
  NONIO_TRY(auto solution, solve_rigid_body(w.lines.lines, wish, &w.model));
  w.s = std::move(solution);
  say_separation(w);
  w.out.findings.insert(w.out.findings.end(), limits.findings.begin(), limits.findings.end());
  if (!w.model.missing.empty()) w.say(missing_finding(w.model.missing));
  put_results(w);
  put_notes(w);
  for (Finding& f : w.out.findings) f.measurement = in.measurement.id;
  for (Remark& r : w.out.notes) r.measurement = in.measurement.id;
  return std::move(w.out);
}

/// The volume requires a measurement of the state that makes a squareness identifiable.
bool has_squareness(const Campaign& c, const std::string& state) {
  return std::any_of(c.measurements.begin(), c.measurements.end(), [&](const Measurement& m) {
    return shows_squareness(c, m) && is_taken(c, m) &&
           (state_of(m).empty() || state_of(m) == state);
  });
}

/// True for the first measurement of each state or, if no state is named, of the campaign.
bool applies(const Campaign& c, const Measurement& of) {
  if (!is_taken(c, of) || !has_squareness(c, state_of(of))) return false;
  const bool states = std::any_of(c.measurements.begin(), c.measurements.end(), [&](const auto& m) {
    return is_taken(c, m) && !state_of(m).empty();
  });
  if (states && state_of(of).empty()) return false;
  for (const Measurement& m : c.measurements)
    if (is_taken(c, m) && state_of(m) == state_of(of)) return m.id == of.id;
  return false;
}

std::vector<Option> options() {
  return {
      {"errors", std::vector<std::string>{}, "",
       "Which of the 21 errors (EXX, EYX, C0Y, EAX, ...); empty: all of the axes that move."},
      within(0.0, 12.0,
             {"degree", std::int64_t{0}, "",
              "Of the polynomials of each error; 0: by Schwarz's criterion, 2 to 8."}),
      at_least(0.0, {"artefact_U_per_m_um", 0.0, "um",
                     "Of artefacts: expanded uncertainty (k = 2) for each metre of length."}),
      at_least(0.0, {"artefact_expansion", 0.0, "um/(m K)",
                     "Of artefacts: coefficient of expansion; 0: not stated."}),
      at_least(0.0,
               {"artefact_temperature_range_K", 0.0, "K",
                "Of artefacts: range of the reading error of their temperature; 0: not stated."}),
      at_least(0.0, {"artefact_expansion_range", 0.0, "um/(m K)",
                     "Of artefacts: range of the coefficient of expansion; 0: not stated."}),
      within(1.0, 10.0,
             {"parts", std::int64_t{4}, "",
              "Of each axis, between the nodes of the map of the volume."})};
}

}  // namespace

NONIO_PLUGIN(registry) {
  Analysis a;
  a.info = {"rigid-body", "1.0.0",
            "The 21 errors of three axes from any mixture of readings, and the volume's map.",
            options(), true};
  a.applies = applies;
  a.analyse = analyse;
  a.states_followed = true;
  registry.add(std::move(a));
}

}  // namespace nonio::rigid_body
