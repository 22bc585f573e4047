// SPDX-License-Identifier: Apache-2.0
#include "nonio/sdk/check.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <set>
#include <vector>

namespace nonio {
namespace {

bool finite(double x) { return std::isfinite(x); }

bool all_finite(const std::vector<double>& column) {
  return std::all_of(column.begin(), column.end(), finite);
}

bool is_direction(const std::array<double, 3>& s) {
  return std::all_of(s.begin(), s.end(), finite);
}

/// A wrong index of a line would cause an access beyond the end of a vector.
Expected<void> check_lines(const Observations& o) {
  if (o.size() == 0) return {};
  if (o.lines.empty()) return fail("readings of no line; expected one line at least");
  for (std::size_t i = 0; i < o.line.size(); ++i)
    if (o.line[i] >= o.lines.size())
      return fail("reading " + std::to_string(i + 1) + " of line " + std::to_string(o.line[i]) +
                  "; expected 0 to " + std::to_string(o.lines.size() - 1));
  if (!std::all_of(o.sense.begin(), o.sense.end(), is_direction) ||
      !std::all_of(o.lines.begin(), o.lines.end(),
                   [](const Observations::Line& l) { return is_direction(l.sense); }))
    return fail("a direction of sensing that is not a number");
  return {};
}

Expected<void> check_evidence(const std::vector<Finding>& findings) {
  for (const Finding& f : findings)
    for (const Number& n : f.evidence)
      if (!finite(n.value))
        return fail("evidence " + n.name + " of finding " + f.id + " that is not a number");
  return {};
}

Expected<void> check_value(const Value& v) {
  if (!finite(v.value) || (v.U && !finite(*v.U)) || !finite(v.k) ||
      (v.repeatability && !finite(*v.repeatability)))
    return fail("a value " + v.name + " that is not a number");
  return {};
}

}  // namespace

Expected<void> check(const Observations& o) {
  const std::size_t n = o.size();
  bool same = true;
  for_each_column(
      o, [&](const auto& column) { same = same && (column.empty() || column.size() == n); });
  for (const auto& axis : o.axes) same = same && axis.position.size() == n;
  if (!same) return fail("columns of different lengths");
  if (!all_finite(o.deviation)) return fail("a deviation that is not a number");
  for (const auto& axis : o.axes) {
    if (!all_finite(axis.position))
      return fail("a position of " + axis.axis + " that is not a number");
    if (!std::all_of(axis.approach.begin(), axis.approach.end(),
                     [](std::int8_t a) { return a >= -1 && a <= 1; }))
      return fail("an approach that is none of +1, -1 and 0");
  }
  if (!std::all_of(o.u.begin(), o.u.end(), [](double u) { return finite(u) && u > 0.0; }))
    return fail("an uncertainty of a reading that is not a number above 0");
  for (const auto& c : o.channels) {
    if (std::any_of(c.lines.begin(), c.lines.end(),
                    [&](std::uint32_t line) { return line >= o.lines.size(); }))
      return fail("a channel " + c.name + " of a line that does not exist");
    if (c.time.size() != c.value.size() || !all_finite(c.value) || !all_finite(c.time) ||
        !std::is_sorted(c.time.begin(), c.time.end()))
      return fail("a channel " + c.name + " without a value at each of its times, ascending");
  }
  for (const Finding& doubt : o.doubts)
    if (!doubt.attention || !doubt.id.starts_with("plausibility."))
      return fail("the doubt " + doubt.id + "; expected findings plausibility.* of attention");
  return check_lines(o);
}

namespace {

/// Names become keys of JSON and columns of CSV.
template <class List>
Expected<void> check_names(const char* what, const List& list) {
  std::set<std::string_view> known;
  for (const auto& one : list)
    if (!known.insert(one.name).second)
      return fail(std::string("two ") + what + " with the name " + one.name);
  return {};
}

}  // namespace

Expected<void> check(const Evaluation& e) {
  if (auto distinct = check_names("values", e.values); !distinct) return distinct;
  if (auto distinct = check_names("series", e.series); !distinct) return distinct;
  for (const Value& v : e.values)
    if (auto sound = check_value(v); !sound) return sound;
  if (auto sound = check_evidence(e.findings); !sound) return sound;
  for (const PointTable* table : {&e.points, &e.rows}) {
    if (auto distinct = check_names("columns", table->columns); !distinct) return distinct;
    for (const PointTable::Column& c : table->columns)
      if (c.values.size() != table->columns.front().values.size())
        return fail("a table with columns of different lengths");
  }
  for (const Series& s : e.series)
    if (s.value.size() != s.position.size() || (!s.U.empty() && s.U.size() != s.value.size()) ||
        (!s.repeatability.empty() && s.repeatability.size() != s.value.size()))
      return fail("a series " + s.name + " with columns of different lengths");
  if (e.budget)
    for (const auto& r : e.budget->results)
      if (r.u.size() != e.budget->contributions.size())
        return fail("a budget of " + r.name + " with other contributions than it lists");
  return {};
}

Expected<void> check(const OutputResult& r) {
  for (const Prediction& p : r.predictions)
    if (!finite(p.before) || !finite(p.after))
      return fail("a prediction of " + p.name + " that is not a number");
  return check_evidence(r.findings);
}

}  // namespace nonio
