// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>

#include "campaign/evaluation/evaluation.h"
#include "campaign/reading/names.h"
#include "campaign/reading/plausibility/plausibility.h"
#include "nonio/math/decision.h"

namespace nonio::evaluation {

namespace {

struct Held {
  std::string measurement, axis;
  Tolerance tolerance;
};

Conformity decided(const Campaign& campaign, const Held& held, const std::string& plugin,
                   const Value& v) {
  Conformity c{.measurement = held.measurement,
               .axis = held.axis,
               .plugin = plugin,
               .name = v.name,
               .tolerance = held.tolerance.limit,
               .quantity = v.quantity,
               .decision = Decision::cannot_be_decided,
               .reason = "no-uncertainty"};
  if (!v.U || !(*v.U > 0.0)) return c;
  c.decision = math::decide(std::fabs(v.value), *v.U, held.tolerance.limit,
                            campaign.certificate.decision_rule, v.k);
  c.reason = c.decision == Decision::cannot_be_decided ? "near-limit" : "";
  return c;
}

Conformity judged_by_analysis(const Results::Analysed& a, const Value& v) {
  const bool open = v.judged->decision == Decision::cannot_be_decided;
  return {.measurement = a.measurement,
          .axis = "",
          .plugin = a.plugin,
          .name = v.name,
          .tolerance = v.judged->limit,
          .quantity = v.quantity,
          .decision = v.judged->decision,
          .reason = !open ? ""
                    : v.U ? "near-limit"
                          : "no-uncertainty"};
}

bool is_in_unit_of(const Tolerance& tolerance, const Value& v) {
  return unit_of(v.quantity).symbol == unit_of(tolerance.quantity).symbol;
}

/// Returns false if no value has the name and unit of the tolerance.
bool add_decisions(const Campaign& campaign, const std::vector<Results::Analysed>& analyses,
                   const Held& held, std::vector<Conformity>& out) {
  const std::size_t before = out.size();
  for (const Results::Analysed& a : analyses)
    for (const Value& v : a.evaluation.values)
      if (a.measurement == held.measurement && v.name == held.tolerance.result &&
          is_in_unit_of(held.tolerance, v))
        out.push_back(decided(campaign, held, a.plugin, v));
  return out.size() > before;
}

Conformity without_value(const Held& held) {
  return {held.measurement,
          held.axis,
          "",
          held.tolerance.result,
          held.tolerance.limit,
          held.tolerance.quantity,
          Decision::cannot_be_decided,
          "no-value"};
}

bool has_own(const Measurement& m, const std::string& result) {
  return std::any_of(m.tolerances.begin(), m.tolerances.end(),
                     [&](const Tolerance& t) { return t.result == result; });
}

}  // namespace

std::vector<Conformity> held_against_tolerances(const Campaign& campaign,
                                                const std::vector<Results::Analysed>& analyses) {
  std::vector<Conformity> out;
  for (const Axis& axis : campaign.machine.axes)
    for (const auto& [name, limit] : axis.tolerance) {
      const Tolerance tolerance{name, limit, deviation_of(axis.rotary)};
      bool any = false;
      for (const Measurement& m : campaign.measurements)
        if (m.axis == axis.name && m.kind == "axis")
          any |= has_own(m, name) ||
                 add_decisions(campaign, analyses, {m.id, axis.name, tolerance}, out);
      if (!any) out.push_back(without_value({"", axis.name, tolerance}));
    }
  for (const Measurement& m : campaign.measurements)
    for (const Tolerance& tolerance : m.tolerances) {
      const Held held{m.id, m.kind == "axis" ? m.axis : "", tolerance};
      if (!add_decisions(campaign, analyses, held, out)) out.push_back(without_value(held));
    }
  for (const Results::Analysed& a : analyses)
    for (const Value& v : a.evaluation.values)
      if (v.judged) out.push_back(judged_by_analysis(a, v));
  return out;
}

void report_other_units(const Work& work, const std::vector<Results::Analysed>& analyses) {
  for (const Measurement& m : work.campaign().measurements)
    for (const Tolerance& t : m.tolerances)
      for (const Results::Analysed& a : analyses)
        for (const Value& v : a.evaluation.values) {
          if (a.measurement != m.id || v.name != t.result || is_in_unit_of(t, v)) continue;
          const std::string unit(unit_of(v.quantity).symbol);
          work.report(work.error_at(
              "measurement." + m.id + "." + tolerance_key(t.quantity) + "." + t.result,
              "expected a limit in the unit of the result, which " + a.plugin + " gives in " +
                  (unit.empty() ? "no unit" : unit) + ", found one in " +
                  std::string(unit_of(t.quantity).symbol)));
        }
}

namespace {

/// The measurement of the finding, and the one that has the same readings: either can be wrong.
bool concerns(const Finding& f, const Measurement& m) {
  return m.id == f.measurement ||
         std::any_of(f.texts.begin(), f.texts.end(), [&](const auto& text) {
           return (text.first == "with" && text.second == m.id) ||
                  (text.first == "other" && text.second == m.file);
         });
}

bool moves_doubted(const Measurement& m, const Measurement& doubted) {
  return doubted.kind == "axis" &&
         (m.kind == "axis" ? m.axis == doubted.axis : m.from.contains(doubted.axis));
}

/// Tables of a doubted axis, and lines along which it moves, are doubted too.
Doubts spread(const Campaign& campaign, const std::vector<Finding>& open) {
  Doubts out;
  for (const Finding& f : open)
    for (const Measurement& doubted : campaign.measurements) {
      if (!f.measurement.empty() && !concerns(f, doubted)) continue;
      for (const Measurement& m : campaign.measurements)
        if (m.id == doubted.id || moves_doubted(m, doubted)) out[m.id].insert(f.id);
    }
  return out;
}

}  // namespace

Doubts open_doubts(const Work& work, std::vector<Results::Analysed>& analyses) {
  const auto& accepted = work.read.manifest->accepted;
  std::set<std::string> known;
  std::vector<Finding> open;
  for (Results::Analysed& a : analyses) {
    if (a.plugin != reading::plausibility_name) continue;
    for (Finding& f : a.evaluation.findings) {
      known.insert(f.id);
      const auto entry =
          std::find_if(accepted.begin(), accepted.end(),
                       [&](const config::AcceptedFinding& one) { return one.finding == f.id; });
      if (entry != accepted.end()) {
        f.texts.emplace_back(reading::accepted_because, entry->reason);
        f.texts.emplace_back(reading::formerly_accepted_because, entry->reason);
      } else if (f.attention) {
        open.push_back(f);
      }
    }
  }
  for (const config::AcceptedFinding& entry : accepted)
    // Only a run of the site knows whether campaigns share a file.
    if (!known.contains(entry.finding) && entry.finding != reading::file_of_another_campaign)
      work.report(Error{"tables.accept: the readings have no finding " + entry.finding +
                            "; they have " + (known.empty() ? "none" : comma_list(known)),
                        config::manifest_name, entry.line});
  return spread(work.campaign(), open);
}

std::set<std::string> leave_out(const Doubts& doubts, reading::ReadCampaign& read,
                                Results& results) {
  std::set<std::string> out;
  const auto& measurements = read.manifest->campaign.measurements;
  for (std::size_t i = 0; i < std::min(measurements.size(), read.observations.size()); ++i)
    if (doubts.contains(measurements[i].id)) {
      out.insert(measurements[i].id);
      read.observations[i] = {};
    }
  const auto is_doubted = [&](const std::string& id) { return doubts.contains(id); };
  std::erase_if(results.analyses, [&](const Results::Analysed& a) {
    const auto& uses = a.evaluation.uses;
    if (!is_doubted(a.measurement) && std::none_of(uses.begin(), uses.end(), is_doubted))
      return false;
    if (!a.measurement.empty()) out.insert(a.measurement);
    return true;
  });
  return out;
}

}  // namespace nonio::evaluation
