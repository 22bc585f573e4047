// SPDX-License-Identifier: Apache-2.0
#include "ecmc_iso230.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>

#include "lines.h"
#include "runs.h"

namespace nonio::ecmc_iso230 {
using namespace readers;

namespace {

constexpr std::uint32_t most_positions = 100000, most_cycles = 10000;

struct Value {
  double value = 0.0;
  std::uint64_t line = 0;
};
struct Contents {
  std::string unit = "mm";
  std::map<std::uint32_t, Value> targets;
  /// By direction (forward +1, backward -1), cycle and position.
  std::map<std::tuple<int, std::uint32_t, std::uint32_t>, Value> readings;
  std::optional<std::uint32_t> cycles, positions;
};

struct Assignment {
  std::string_view name, index, value;
};
std::optional<Assignment> assignment_of(std::string_view line) {
  const std::size_t equals = line.find('=');
  if (equals == line.npos) return std::nullopt;
  Assignment a{trimmed(line.substr(0, equals)), {}, trimmed(line.substr(equals + 1))};
  if (const std::size_t open = a.name.find('['); open != a.name.npos) {
    if (a.name.back() != ']') return std::nullopt;
    a.index = a.name.substr(open + 1, a.name.size() - open - 2);
    a.name = a.name.substr(0, open);
  }
  return a;
}

class Parser {
 public:
  Expected<Contents> parse(std::string_view bytes) {
    Lines lines(bytes);
    std::string_view line;
    while (lines.next(line)) {
      if (auto error = not_text(line)) return fail(at_line(lines.number(), error->message));
      line = trimmed(line);
      // Some files begin with "TEST_DATA=# Input data ...".
      if (line.empty() || line.front() == '#' || line.starts_with("TEST_DATA=")) continue;
      const auto a = assignment_of(line);
      if (!a)
        return fail(
            at_line(lines.number(), "expected NAME=VALUE or a comment, found " + shown(line)));
      if (auto ok = take(*a, lines.number()); !ok) return fail(ok.error());
    }
    // The tools end every line; a truncated number would not be detected otherwise.
    if (!bytes.ends_with('\n'))
      return fail(at_line(lines.number(),
                          "expected an end of the last line, found none; was the file cut?"));
    return std::move(out_);
  }

 private:
  Expected<void> take(const Assignment& a, std::uint64_t line) {
    if (a.name == "TGT_DATA") return target(a, line);
    if (a.name == "REF_DATA_FWD") return reading(a, 1, line);
    if (a.name == "REF_DATA_BWD") return reading(a, -1, line);
    if (a.name == "UNIT") {
      out_.unit = a.value;
    } else if (a.name == "CYCLES" || a.name == "POSITIONS") {
      const std::uint32_t most = a.name == "CYCLES" ? most_cycles : most_positions;
      const std::uint32_t n = whole_number(a.value, most);
      if (n == 0)
        return fail(at_line(line, std::string(a.name) + ": expected a whole number from 1 to " +
                                      std::to_string(most) + ", found " + shown(a.value)));
      (a.name == "CYCLES" ? out_.cycles : out_.positions) = n;
    } else if (a.name.find("DATA") != a.name.npos) {
      return fail(
          at_line(line, "expected TGT_DATA, REF_DATA_FWD or REF_DATA_BWD, found " + shown(a.name)));
    }
    return {};
  }

  Expected<void> target(const Assignment& a, std::uint64_t line) {
    const std::uint32_t position = whole_number(a.index, most_positions);
    if (position == 0) return fail(at_line(line, "expected TGT_DATA[position], found " + index(a)));
    NONIO_TRY(const auto value, numbers_.number(a.value, line, "a target"));
    return once(out_.targets, position, value, line);
  }

  Expected<void> reading(const Assignment& a, int direction, std::uint64_t line) {
    const std::size_t comma = std::min(a.index.find(','), a.index.size());
    const std::uint32_t position = whole_number(trimmed(a.index.substr(0, comma)), most_positions);
    const std::uint32_t cycle =
        whole_number(trimmed(a.index.substr(std::min(comma + 1, a.index.size()))), most_cycles);
    if (position == 0 || cycle == 0)
      return fail(
          at_line(line, "expected " + std::string(a.name) + "[position,cycle], found " + index(a)));
    NONIO_TRY(const auto value, numbers_.reading(a.value, line, "a position"));
    return once(out_.readings, std::tuple(direction, cycle, position), value, line);
  }

  template <class Map, class Key>
  Expected<void> once(Map& map, const Key& key, double value, std::uint64_t line) {
    const auto [place, fresh] = map.try_emplace(key, Value{value, line});
    if (fresh) return {};
    return fail(at_line(line, "the same was there in line " + std::to_string(place->second.line)));
  }

  static std::string index(const Assignment& a) {
    return shown(std::string(a.name) + "[" + std::string(a.index) + "]");
  }

  Numbers numbers_{false};
  Contents out_;
};

Expected<void> whole(const Contents& c) {
  const auto n = static_cast<std::uint32_t>(c.targets.size());
  if (n < 2) return fail("expected two targets or more (TGT_DATA), found " + std::to_string(n));
  if (c.targets.rbegin()->first != n)
    return fail("expected TGT_DATA[1] to TGT_DATA[" + std::to_string(c.targets.rbegin()->first) +
                "], found " + std::to_string(n) + " of them");
  if (c.positions && *c.positions != n)
    return fail("expected " + std::to_string(*c.positions) + " targets (POSITIONS), found " +
                std::to_string(n));
  std::map<std::pair<int, std::uint32_t>, std::uint32_t> passes;
  std::uint32_t cycles = 0;
  for (const auto& [key, value] : c.readings) {
    const auto [direction, cycle, position] = key;
    if (position > n)
      return fail(at_line(value.line, "expected a position from 1 to " + std::to_string(n) +
                                          ", found " + std::to_string(position)));
    ++passes[{direction, cycle}];
    cycles = std::max(cycles, cycle);
  }
  if (c.cycles && cycles != 0 && *c.cycles != cycles)
    return fail("expected " + std::to_string(*c.cycles) + " cycles (CYCLES), found " +
                std::to_string(cycles));
  for (const int direction : {1, -1})
    for (std::uint32_t cycle = 1; cycle <= cycles; ++cycle) {
      const auto found = passes.find({direction, cycle});
      const bool none = c.readings.lower_bound({direction, 0, 0}) == c.readings.end() ||
                        std::get<0>(c.readings.lower_bound({direction, 0, 0})->first) != direction;
      const std::uint32_t have = found == passes.end() ? 0 : found->second;
      if (have != n && !none)
        return fail(std::string("expected ") + std::to_string(n) + " readings " +
                    (direction > 0 ? "forward" : "backward") + " in cycle " +
                    std::to_string(cycle) + ", found " + std::to_string(have));
    }
  return {};
}

Expected<double> unit_of_file(const Contents& c, bool rotary) {
  static const std::map<std::string, double, std::less<>> linear{
      {"mm", 1e-3}, {"um", 1e-6}, {"m", 1.0}},
      angular{{"deg", 1.0 / deg_per_rad}, {"rad", 1.0}, {"mrad", 1e-3}};
  const auto& units = rotary ? angular : linear;
  const auto found = units.find(c.unit);
  if (found != units.end()) return found->second;
  return fail(std::string("expected UNIT ") + (rotary ? "deg, rad or mrad" : "mm, um or m") +
              " for this axis, found " + shown(c.unit));
}

/// Adds a note about the fitted line. If the tools subtracted it, slope and offset of the
/// deviations over the reference are 0 within the rounding of nine decimals.
void add_line_note(Observations& obs, const Axis& axis) {
  const auto& target = obs.axes[0].position;
  std::vector<double> reference = target;
  for (std::size_t i = 0; i < reference.size(); ++i) reference[i] += obs.deviation[i];
  const Straight fitted = straight_through(reference, obs.deviation);
  const auto [low, high] = std::minmax_element(target.begin(), target.end());
  const double step = axis.rotary ? 1e-7 / deg_per_rad : 1e-10;
  if (std::fabs(fitted.slope * (*high - *low)) < step && std::fabs(fitted.offset) < step) {
    obs.notes.push_back({"ecmc.line-removed"});
    return;
  }
  const Straight line = straight_through(target, obs.deviation);
  obs.notes.push_back({"ecmc.line-left",
                       {{"slope", line.slope, slope_of(axis.rotary)},
                        {"offset", line.offset, deviation_of(axis.rotary)}}});
}

Expected<Observations> read_file(const ReadInput& input, const Axis& axis) {
  NONIO_TRY(const auto contents, Parser().parse(input.bytes));
  if (auto ok = whole(contents); !ok) return fail(ok.error());
  NONIO_TRY(const auto unit, unit_of_file(contents, axis.rotary));
  std::vector<double> targets;
  for (const auto& [position, target] : contents.targets) targets.push_back(target.value);
  const int listed = sense_of(targets);
  if (listed == 0) return fail("expected targets that only rise or only fall (TGT_DATA)");
  Runs runs(input, axis, axis.rotary);
  for (const auto& [key, value] : contents.readings) {
    const auto [direction, cycle, position] = key;
    const double target = targets[position - 1];
    // The difference is exact before the conversion.
    if (auto ok = runs.add({cycle, static_cast<std::int8_t>(direction * listed), target * unit,
                            (value.value - target) * unit, value.line});
        !ok)
      return fail(ok.error());
  }
  auto obs = runs.finish();
  if (obs) add_line_note(*obs, axis);
  return obs;
}

bool recognises(std::string_view head) {
  Lines lines(head);
  std::string_view line;
  while (lines.next(line)) {
    line = trimmed(line);
    if (line.starts_with("TGT_DATA[") || line.starts_with("REF_DATA_FWD[") ||
        line.starts_with("REF_DATA_BWD["))
      return true;
    if (!line.empty() && line.front() != '#' && line.find('=') == line.npos) return false;
  }
  return false;
}

}  // namespace

Reader reader() {
  Reader r;
  r.info = {"ecmc-iso230", "1.0", "Reference positions extracted by ecmc's tools (_ISO230.dat)."};
  r.recognises = recognises;
  r.reads = [](std::string_view kind) { return kind == "axis"; };
  r.read = [](const ReadInput& input) { return read_of_axis(input, read_file); };
  return r;
}

}  // namespace nonio::ecmc_iso230
