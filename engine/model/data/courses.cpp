// SPDX-License-Identifier: Apache-2.0
#include "courses.h"

#include <algorithm>
#include <cmath>

#include "restarts.h"

namespace nonio::model {

namespace {

/// Sorted by time; rows without a time are omitted.
std::vector<std::size_t> rows_of(const Observations& o, std::uint32_t line) {
  std::vector<std::size_t> rows;
  for (std::size_t i = 0; i < o.size(); ++i)
    if (o.line_of(i) == line && std::isfinite(o.time[i])) rows.push_back(i);
  std::stable_sort(rows.begin(), rows.end(),
                   [&](std::size_t a, std::size_t b) { return o.time[a] < o.time[b]; });
  return rows;
}

/// The sensors X, X1, ... Z of a nest are written in lower case.
std::string column_of(std::string line) {
  const bool nest = !line.empty() && line.size() <= 2 && line[0] >= 'X' && line[0] <= 'Z' &&
                    (line.size() == 1 || line[1] == '1' || line[1] == '2');
  if (nest) line[0] = static_cast<char>(line[0] - 'X' + 'x');
  return line;
}

Part part_of(const Measurement& m, const Observations& o, std::uint32_t line,
             const std::vector<std::size_t>& rows) {
  Part part;
  part.kind = Part::Kind::course;
  part.displacement = column_of(o.lines[line].name);
  part.name = m.id + "/" + part.displacement;
  part.measurements = {m.id};
  part.axes = {Axis{.name = part.displacement, .rotary = o.angular}};
  Observations& t = part.table;
  t.measurement = o.measurement;
  t.angular = o.angular;
  t.lines = {o.lines[line]};
  t.channels = o.channels;
  for (const std::size_t i : rows) {
    t.deviation.push_back(o.deviation[i]);
    t.time.push_back(o.time[i]);
    if (!o.source_line.empty()) t.source_line.push_back(o.source_line[i]);
    part.row.push_back(static_cast<std::uint32_t>(i));
    part.along.push_back(o.time[i]);
  }
  part.measurement.assign(rows.size(), 0);
  part.way.assign(rows.size(), 0);
  return part;
}

/// Correlation, without subtraction of means, of changes over a hundredth of the test in which
/// neither restarts; otherwise 0.
double move_together(const std::vector<double>& a, const std::vector<double>& b,
                     const std::vector<double>& time, const std::vector<Restart>& restarts) {
  const std::size_t step = std::max<std::size_t>(1, a.size() / 100);
  double aa = 0.0, ab = 0.0, bb = 0.0;
  for (std::size_t i = 0; i + step < a.size(); ++i) {
    if (std::any_of(restarts.begin(), restarts.end(),
                    [&](const Restart& r) { return time[i] < r.to && r.to <= time[i + step]; }))
      continue;
    const double da = a[i + step] - a[i], db = b[i + step] - b[i];
    aa += da * da, ab += da * db, bb += db * db;
  }
  return aa > 0.0 && bb > 0.0 ? ab / std::sqrt(aa * bb) : 0.0;
}

}  // namespace

void append_courses(const Measurement& m, const Observations& o, std::vector<Part>& parts) {
  // docs/dev/constants.md, M40.
  constexpr double together = 0.9;
  constexpr std::size_t least = 60;
  if (o.time.size() != o.size()) return;
  const std::size_t first = parts.size();
  for (std::uint32_t line = 0; line < o.lines.size(); ++line) {
    const auto rows = rows_of(o, line);
    if (rows.size() >= least) parts.push_back(part_of(m, o, line, rows));
  }
  std::vector<std::vector<Restart>> restarts;
  for (std::size_t a = first; a < parts.size(); ++a) restarts.push_back(restarts_of(parts[a]));
  for (std::size_t a = first; a < parts.size(); ++a) {
    parts[a].displacements = parts.size() - first;
    std::vector<Restart> own = restarts[a - first];
    for (std::size_t b = first; b < parts.size(); ++b) {
      if (a == b || parts[a].table.time != parts[b].table.time) continue;
      std::vector<Restart> both = restarts[a - first];
      both.insert(both.end(), restarts[b - first].begin(), restarts[b - first].end());
      if (!(std::fabs(move_together(parts[a].table.deviation, parts[b].table.deviation,
                                    parts[a].table.time, both)) > together))
        continue;
      parts[a].companions.push_back(parts[b].table.deviation);
      parts[a].companion_names.push_back(parts[b].displacement);
      own.insert(own.end(), restarts[b - first].begin(), restarts[b - first].end());
    }
    put_restarts(parts[a], std::move(own));
  }
}

}  // namespace nonio::model
