// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <string>

#include "nonio/reports/site.h"

/// A laboratory made up for the pages' tests.
namespace nonio::fixtures {

using namespace reports;

inline std::string day(int year, int month, int of_month) {
  const auto two = [](int n) { return (n < 10 ? "0" : "") + std::to_string(n); };
  return std::to_string(year) + "-" + two(month) + "-" + two(of_month);
}

inline HistorySeries reversal_series() {
  HistorySeries s{.axis = "X",
                  .quantity = "B_mean",
                  .unit = Quantity::deviation,
                  .points = {},
                  .model = "step"};
  const double values[] = {-5.1, -5.0, -5.3, -5.2, -9.4, -9.3};
  for (int i = 0; i < 6; ++i)
    s.points.push_back({"2023-" + std::to_string(i), day(2023 + i / 2, 1 + 6 * (i % 2), 14),
                        "c" + std::to_string(i) + "/report.pdf", HistoryPoint::State::as_found,
                        values[i] * 1e-6, 0.2e-6});
  s.points[4].state = HistoryPoint::State::as_left;
  s.points[2].joined = false;
  s.points[2].why_not = "span";
  s.segments = {{"2023-01-14", "2024-07-14", -5.1e-6, -5.1e-6, 0.1e-6, 0.1e-6, 0, 0},
                {"2025-01-14", "2025-07-14", -9.35e-6, -9.35e-6, 0.15e-6, 0.15e-6, 0, 0}};
  s.changes = {{"2024-07-14", "2025-01-14", -4.2e-6, 0.2e-6, 1e-9, "undeclared"}};
  s.limit = 8e-6;
  s.forecast = {{"2026-01-14", -9.6e-6, 0.4e-6, 0.98, "2025-07-15", "act"}};
  return s;
}

inline HistorySeries plain_series(const std::string& quantity, double value, double slope) {
  HistorySeries s{
      .axis = "X", .quantity = quantity, .unit = Quantity::deviation, .points = {}, .model = ""};
  for (int i = 0; i < 6; ++i)
    s.points.push_back({"2023-" + std::to_string(i), day(2023 + i / 2, 1 + 6 * (i % 2), 14), "",
                        HistoryPoint::State::as_found, (value + slope * i) * 1e-6, 0.4e-6});
  s.limit = 18e-6;
  s.smallest_change = 1.3e-6;
  return s;
}

inline MachineHistory made_machine(const std::string& id) {
  MachineHistory m{id,       "Sample Machines", "VM 3", id, "Rossi & Figli <S.p.A.>",
                   "Padova", "siemens-840d",    {},     {}, {}};
  m.file = id + ".html";
  m.due = "2026-01-14", m.why_due = "12";
  m.proposal = {.months = 6,
                .method = "control-chart",
                .axis = "X",
                .quantity = "B_mean",
                .why = {"interval.meets-limit",
                        false,
                        {{"limit", 8e-6, Quantity::deviation}},
                        {{"what", "reversal"}, {"axis", "X"}}}};
  m.tables = {
      {"X", "E", "2023-4", "2025-01-14", Quantity::deviation, 13.7e-6, 0.8e-6, 1.4e-6, true},
      {"Y", "M", "2023-4", "2025-01-14", Quantity::deviation, 6e-6, 0.5e-6, 11.9e-6, false}};
  m.events = {{"2024-10-02", "X", "crash", "Collision with the vice"},
              {"2025-01-14", "", "compensation", "EEC table loaded"}};
  m.series = {reversal_series(), plain_series("A", 12, 0.9), plain_series("B", 5, 0.3),
              plain_series("R", 7, 0)};
  for (int k = 0; k < 6; ++k) {
    ErrorCurve c{"2023-" + std::to_string(k),
                 day(2023 + k / 2, 1 + 6 * (k % 2), 14),
                 "X",
                 false,
                 {},
                 {},
                 0.3e-6};
    for (int i = 0; i <= 20; ++i) {
      c.position.push_back(0.05 * i);
      c.mean.push_back((3 * std::sin(0.3 * i) + 0.4 * k * i / 20.0) * 1e-6);
    }
    m.curves.push_back(std::move(c));
  }
  return m;
}

inline SiteHistory made_site() {
  SiteHistory site{.run = 12,
                   .campaigns = 510,
                   .done = 3,
                   .unchanged = 507,
                   .date = "2026-02-22",
                   .certificates = 3,
                   .waiting = 1,
                   .lines = {},
                   .machines = {},
                   .months = {},
                   .instruments = {},
                   .comparisons = {}};
  for (const char* id : {"S-0017", "S-0031", "S-0042"}) site.machines.push_back(made_machine(id));
  using Kind = WorkItem::Kind;
  WorkItem out{.kind = Kind::out,
               .id = "out.S-0042.X.B",
               .machine = "S-0042",
               .axis = "X",
               .quantity = "B",
               .campaign = "2025-1",
               .customer = "Rossi",
               .value = 11.2e-6,
               .u = 0.2e-6,
               .limit = 8e-6,
               .unit = Quantity::deviation,
               .finding = {"worklist.out", true, {{"limit", 8e-6, Quantity::deviation}}},
               .since = "2025-01-14",
               .link = "c5/report.pdf"};
  WorkItem lost{.kind = Kind::lost,
                .id = "lost.m08",
                .machine = "",
                .axis = "",
                .quantity = "",
                .campaign = "site-b/2024-m08",
                .customer = "",
                .finding = {"worklist.lost",
                            true,
                            {{"night", 11, Quantity::count}},
                            {{"folder", "site-b/2024-m08"}}}};
  WorkItem changed = out;
  changed.kind = Kind::changed, changed.machine = "S-0017", changed.quantity = "B_mean",
  changed.value = -9.4e-6, changed.limit.reset();
  changed.finding = {"worklist.changed",
                     true,
                     {{"size", -4.2e-6, Quantity::deviation}, {"U", 0.4e-6, Quantity::deviation}},
                     {{"after", "2024-07-14"},
                      {"before", "2025-01-14"},
                      {"what", "reversal"},
                      {"look", "reversal"}}};
  WorkItem known = changed;
  known.state = WorkItem::State::known, known.by = "B. Sample", known.until = "2026-06-01",
  known.why = "repair ordered", known.customer = "Bianchi", known.machine = "S-0031";
  site.lines = {lost, out, changed, known};
  for (const char* machine : {"S-0017", "S-0031", "S-0042"})
    for (int k = 0; k < 24; ++k)
      site.months.push_back({machine, day(2024 + k / 12, 1 + k % 12, 1).substr(0, 7),
                             k % 7 == 3 ? std::optional(Kind::out) : std::nullopt, k % 3 == 0,
                             k == 9});
  site.instruments = {{"Sample Optics L-001",
                       "SO-2026-0001",
                       "2026-01-12",
                       {{"2025-1", "2025-07-14", "S-0042", "NC-26-0007", "c5/"}}}};
  site.comparisons = {{"VM 3",
                       "X",
                       "B_mean",
                       Quantity::deviation,
                       ModelComparison::Travel{0.78, 0.8},
                       64,
                       -5.4e-6,
                       0.6e-6,
                       {{"S-0017", -5e-6, 0.2e-6, 0.1},
                        {"S-0031", -5.4e-6, 0.2e-6, -0.3},
                        {"S-0042", -9.4e-6, 0.2e-6, -6.2}}}};
  return site;
}

}  // namespace nonio::fixtures
