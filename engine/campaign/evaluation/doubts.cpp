// SPDX-License-Identifier: Apache-2.0
#include <algorithm>

#include "campaign/evaluation/evaluation.h"
#include "campaign/reading/names.h"
#include "campaign/reading/plausibility/plausibility.h"

namespace nonio::evaluation {

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
