// SPDX-License-Identifier: Apache-2.0
#include "programs.h"

#include <array>
#include <charconv>
#include <utility>

#include "nonio/sdk/format.h"
#include "requests.h"

namespace nonio::programs {

namespace {

std::string trimmed(std::string text) {
  text.erase(text.find_last_not_of('0') + 1);
  if (text.back() == '.') text.pop_back();
  return text;
}

std::string file_part(std::string_view name) {
  std::string out;
  for (const char c : name)
    out += (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') ? c : '_';
  return out;
}

/// That the control takes the name for an axis: with a digit behind its letter, a number that
/// follows would be another one.
Expected<void> check_name(const std::string& axis, const Dialect& dialect) {
  const auto letter = [](char c) { return (c >= 'A' && c <= 'Z') || (c >= 'a' && c <= 'z'); };
  if (letter(axis.front()) && file_part(axis) == axis && (axis.size() == 1 || dialect.long_names))
    return {};
  Error error{"axis " + axis + ": expected " +
              (dialect.long_names ? "letters and digits" : "a single letter") +
              " for a name in a program; option axes leaves it out"};
  error.key = "machine.axes." + axis;
  return fail(std::move(error));
}

}  // namespace

std::string position(const math::MeasuringPath& path, std::size_t axis, double si) {
  std::string text = trimmed(fixed_text(printed(si, position_of(path.rotary[axis])), 6));
  // A number without a point is a count of increments to some controls.
  return text.find('.') == std::string::npos ? text + ".0" : text;
}

std::string number(double value) { return trimmed(fixed_text(value, 6)); }

std::vector<Option> options(std::vector<Option> own) {
  std::vector<Option> all = {
      {"programs", std::vector<std::string>{}, "",
       "Which: axes, diagonals, half-diagonal, step-diagonals; empty: axes, and the diagonals "
       "where the campaign has a plan (sign-probe is for `nonio table probe`)."},
      {"axes", std::vector<std::string>{}, "", "Of the axis runs; empty: all that have a travel."},
      {"plan", std::int64_t{1}, "", "Row of the plan that the diagonals follow.", {}, 1.0, 1000.0},
      {"x", std::string("X"), "", "First axis of the diagonals."},
      {"y", std::string("Y"), "", "Second axis of the diagonals."},
      {"z", std::string("Z"), "", "Third axis of the step diagonals."},
      {"steps", std::int64_t{30}, "", "Steps of each axis of a step diagonal.", {}, 1.0, 1000.0},
      {"runs", std::int64_t{5}, "", "Runs of each program.", {}, 1.0, 100.0},
      {"both_directions", true, "", "Readings on the way back too (not in step diagonals)."},
      {"dwell_s", 5.0, "s", "Rest at each target.", {}, 0.1, 3600.0},
      {"feed_mm_per_min", 2000.0, "mm/min", "Feed between the targets.", {}, 1.0, 1e5},
      {"feed_deg_per_min", 720.0, "deg/min", "The same of a rotary axis.", {}, 1.0, 1e6},
      {"over_travel_mm", 1.0, "mm", "Kept free beyond the targets at both ends.", {}, 0.0, 1e4},
      {"over_travel_deg", 1.0, "deg", "The same of a rotary axis.", {}, 0.0, 360.0},
      {"targets",
       std::string("auto"),
       "",
       "Of the axis runs: auto takes the plan's grid, else random offsets as ISO 230-2 requires.",
       {"auto", "random", "even"}},
      {"interval_mm", 0.0, "mm", "Between targets; 0: as ISO 230-2 requires.", {}, 0.0, 1e5},
      {"interval_deg", 30.0, "deg", "Between targets of a rotary axis.", {}, 0.1, 360.0},
      {"resolution_mm", 0.001, "mm", "Targets are whole multiples of it.", {}, 1e-6, 10.0},
      {"seed",
       std::int64_t{1},
       "",
       "Of the random offsets; the same seed, the same targets.",
       {},
       0.0,
       1e9}};
  for (Option& option : own) all.push_back(std::move(option));
  return all;
}

Expected<OutputResult> written(const OutputInput& in, const Dialect& dialect) {
  const auto programs = requested(in);
  if (!programs) return fail(programs.error());
  OutputResult result;
  for (const Program& p : *programs)
    for (const std::string& axis : p.path.axes)
      if (auto named = check_name(axis, dialect); !named) return fail(named.error());
  for (const Program& p : *programs)
    result.artifacts.push_back(
        {std::string(dialect.output) + "-" + file_part(p.path.name) + std::string(dialect.ending),
         dialect.format(p, in.options)});
  result.notes.push_back({.id = "program.dry-run"});
  if (!dialect.tried)
    result.notes.push_back(
        {.id = "program.no-control", .texts = {{"output", std::string(dialect.output)}}});
  return result;
}

}  // namespace nonio::programs
