// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "laboratory/assessment/describe.h"
#include "laboratory/assessment/lines.h"
#include "laboratory/assessment/lines_of_machine.h"
#include "laboratory/assessment/tables_kept.h"
#include "made.h"

/// A laboratory of made machines, and the lines of its worklist.
namespace nonio::test::lines_test {

using reports::WorkItem;
using Kind = WorkItem::Kind;
using State = WorkItem::State;

struct Laboratory {
  assessment::LastRun last_run{.run = 5, .date = "2024-06-01"};
  store::StoredLogs logs{};
  std::vector<MadeMachine> machines{};
  std::map<std::string, std::string> machine_of_campaign{};
  std::vector<store::Spelling> spellings{};
  std::vector<std::string> unknown{};
  std::string due{};
  std::map<std::uint64_t, std::uint64_t> asked{};

  std::vector<WorkItem> lines() const {
    std::vector<assessment::AssessedMachine> assessed;
    for (const MadeMachine& m : machines) assessed.push_back(m.assessed());
    assessment::Fits fits;
    const auto learned = assessment::learn(assessed, fits);
    assessment::find_changes(assessed, asked, fits, not_asked);
    std::vector<assessment::Standing> standings;
    for (const auto& m : assessed)
      standings.push_back(assessment::standing_of(
          m, assessment::describe(m, "out", due, "12 months", last_run.date), logs, last_run,
          "out"));
    std::vector<const assessment::Standing*> all;
    for (const auto& s : standings) all.push_back(&s);
    return assessment::lines_of({last_run, all, machine_of_campaign, spellings, learned, unknown});
  }
};

inline std::vector<double> flat(double level, double last) {
  std::vector<double> out{level,       level + 0.1, level - 0.1, level,
                          level + 0.1, level - 0.1, level,       level};
  for (std::size_t i = 5; i < 8; ++i) out[i] += last - level;
  return out;
}

/// Hit between 2022-01 and 2022-07: reversal, curve, B and R.
inline MadeMachine hit(double B = 10.0, double mean = -9.0) {
  MadeMachine m("S-42");
  m.follow("X", "B_mean", flat(-4.0, mean), 0.1);
  m.follow("X", "curve_2", flat(0.0, 1.0), 0.1);
  m.judge("X", "B", flat(6.0, B));
  m.judge("X", "R", flat(6.5, B - 0.5));
  return m;
}

inline std::string text_of(const WorkItem& l, const std::string& name) {
  for (const auto& [key, text] : l.finding.texts)
    if (key == name) return text;
  return "";
}

inline config::Acknowledgement acknowledged(const std::string& finding, const std::string& date) {
  return {date, finding, "S-42", "X", "", "2024-12-31", {}, {}, "B. Sample", "nut is ordered", 1};
}

}  // namespace nonio::test::lines_test
