// SPDX-License-Identifier: Apache-2.0
#include "camonitor.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdint>
#include <limits>
#include <map>
#include <optional>
#include <set>
#include <string_view>
#include <vector>

#include "lines.h"
#include "nonio/sdk/error.h"
#include "nonio/sdk/format.h"
#include "runs.h"

namespace nonio::camonitor {
using namespace readers;

namespace {

struct Entry {
  std::string_view pv, value;
  std::int64_t time = 0;  ///< us since 1970-01-01 in the time zone of the log
  std::uint64_t line = 0;
};

int digits(std::string_view text, std::size_t at, std::size_t count) {
  int value = 0;
  if (at + count > text.size()) return -1;
  for (const char c : text.substr(at, count)) {
    if (c < '0' || c > '9') return -1;
    value = 10 * value + (c - '0');
  }
  return value;
}

std::optional<std::int64_t> time_of(std::string_view date, std::string_view time) {
  const int year = digits(date, 0, 4), month = digits(date, 5, 2), day = digits(date, 8, 2);
  const int h = digits(time, 0, 2), m = digits(time, 3, 2), s = digits(time, 6, 2);
  if (date.size() != 10 || date[4] != '-' || date[7] != '-' || time.size() < 8 || time[2] != ':' ||
      time[5] != ':' || h < 0 || h > 23 || m < 0 || m > 59 || s < 0 || s > 60)
    return std::nullopt;
  using namespace std::chrono;
  if (year < 1970 || month < 1 || day < 1) return std::nullopt;
  const year_month_day on{std::chrono::year{year}, std::chrono::month{static_cast<unsigned>(month)},
                          std::chrono::day{static_cast<unsigned>(day)}};
  if (!on.ok()) return std::nullopt;
  std::int64_t us = 0;
  if (time.size() > 8) {
    const std::size_t places = time.size() - 9;
    const int part = digits(time, 9, std::min<std::size_t>(places, 6));
    if (time[8] != '.' || places == 0 || places > 9 || part < 0) return std::nullopt;
    us = part;
    for (std::size_t i = places; i < 6; ++i) us *= 10;
  }
  const auto days = sys_days{on}.time_since_epoch().count();
  return ((days * 24LL + h) * 60 + m) * 60'000'000LL + s * 1'000'000LL + us;
}

std::optional<Entry> entry_of(std::string_view line) {
  const auto fields = by_blanks(line);
  if (fields.size() < 4) return std::nullopt;
  const auto time = time_of(fields[1], fields[2]);
  if (!time) return std::nullopt;
  return Entry{fields[0], fields[3], *time, 0};
}

/// In stable time order, because the initial values of a log are unordered.
Expected<std::vector<Entry>> entries_of(std::string_view bytes,
                                        const std::vector<std::string_view>& pvs) {
  std::vector<Entry> entries;
  Lines lines(bytes);
  std::string_view line;
  while (lines.next(line)) {
    const auto fields = by_blanks(line);
    if (fields.empty() || std::find(pvs.begin(), pvs.end(), fields[0]) == pvs.end()) {
      if (auto error = not_text(line)) return fail(at_line(lines.number(), error->message));
      continue;
    }
    auto entry = entry_of(line);
    if (!entry)
      return fail(at_line(lines.number(),
                          "expected PV, date, time and value, such as \"AXIS:Pos 2022-04-07 "
                          "08:23:29.748369 33.46\"; found " +
                              shown(line)));
    entry->line = lines.number();
    entries.push_back(*entry);
  }
  std::stable_sort(entries.begin(), entries.end(),
                   [](const Entry& a, const Entry& b) { return a.time < b.time; });
  return entries;
}

constexpr double nan = std::numeric_limits<double>::quiet_NaN();

struct Wiring {
  std::string target, reference, test;
  double target_unit = 0.0, reference_unit = 0.0;  ///< SI value of one unit of each PV
  double gain = 1.0;
};

Expected<double> unit_of_option(const ReadInput& input, const char* option, bool rotary) {
  static const std::map<std::string, double, std::less<>> linear{
      {"mm", 1e-3}, {"um", 1e-6}, {"m", 1.0}},
      angular{{"deg", 1.0 / deg_per_rad}, {"rad", 1.0}, {"mrad", 1e-3}};
  const auto& units = rotary ? angular : linear;
  const auto found = units.find(input.options.text(option));
  if (found != units.end()) return found->second;
  return fail(of_option(option, std::string("expected ") +
                                    (rotary ? "deg, rad or mrad" : "mm, um or m") +
                                    " for this axis, found \"" + input.options.text(option) +
                                    "\"; a log does not state its units"));
}

std::string pvs_of(std::string_view bytes) {
  std::set<std::string> known;
  Lines lines(bytes);
  std::string_view line;
  while (known.size() < 12 && lines.next(line))
    if (const auto entry = entry_of(line); entry && is_utf8(entry->pv)) known.emplace(entry->pv);
  std::string list;
  for (const std::string& pv : known) list += (list.empty() ? "" : ", ") + shown(pv);
  return list;
}

Expected<Wiring> wiring_of(const ReadInput& input, bool rotary) {
  Wiring w;
  for (const auto& [option, to] :
       {std::pair{"target_pv", &w.target}, {"reference_pv", &w.reference}, {"test_pv", &w.test}}) {
    *to = input.options.text(option);
    if (!to->empty()) continue;
    return fail(of_option(
        option, "expected the name of a PV, found none; in the log: " + pvs_of(input.bytes)));
  }
  if (w.target == w.reference || w.target == w.test || w.reference == w.test)
    return fail(
        of_option("target_pv", "expected three different PVs as target, reference and test"));
  const auto target = unit_of_option(input, "target_unit", rotary),
             reference = unit_of_option(input, "reference_unit", rotary);
  if (!target) return fail(target.error());
  if (!reference) return fail(reference.error());
  w.target_unit = *target;
  w.reference_unit = *reference;
  w.gain = input.options.number("reference_gain", 1.0);
  if (!(std::fabs(w.gain) > 0.0) || !std::isfinite(w.gain))
    return fail(of_option("reference_gain", "expected a number other than 0"));
  return w;
}

/// Step number: 1101 is forward, cycle 1, position 1; 2109 is backward, cycle 1, position 9.
/// Numbers from 3000 on belong to other tests (limit switches, standstill).
struct Step {
  int direction = 0;  ///< 1 forward, -1 backward, 0 if it is no step of the test
  std::uint32_t cycle = 0, position = 0;
};
Step step_of(std::int64_t number) {
  if (number < 1000 || number > 2999) return {};
  const auto rest = static_cast<std::uint32_t>(number % 1000);
  const Step step{number < 2000 ? 1 : -1, rest / 100, rest % 100};
  return step.cycle == 0 || step.position == 0 ? Step{} : step;
}

struct Sample {
  Step step;
  double target = 0.0, reference = 0.0;
  std::uint64_t line = 0;
  std::int64_t time = 0;
};

class Sampler {
 public:
  Sampler(const Wiring& wiring) : wiring_(wiring) {}

  Expected<std::vector<Sample>> samples(const std::vector<Entry>& entries) {
    for (const Entry& e : entries)
      if (auto ok = take(e); !ok) return fail(ok.error());
    return std::move(samples_);
  }

 private:
  Expected<void> take(const Entry& e) {
    const bool test = e.pv == wiring_.test;
    NONIO_TRY(const auto value,
              numbers_.reading(e.value, e.line, test ? "a test number" : "a position"));
    if (e.pv == wiring_.target) target_ = value;
    if (e.pv == wiring_.reference) {
      reference_ = value;
      reference_line_ = e.line;
      reference_time_ = e.time;
    }
    return test ? change(e, value) : Expected<void>{};
  }

  Expected<void> change(const Entry& e, double value) {
    if (!(std::fabs(value) < 1e9) || value != std::floor(value))
      return fail(at_line(e.line, "expected a whole test number, found " + shown(e.value)));
    const auto number = static_cast<std::int64_t>(value);
    if (number > 9999 || number <= -1000)
      return fail(at_line(e.line,
                          "expected a test number of direction, cycle (1 to 9) and position "
                          "(01 to 99), found " +
                              shown(e.value)));
    const Step step = step_of(number);
    if (step.direction == 0) return {};
    if (reference_line_ == 0 || std::isnan(target_))
      return fail(
          at_line(e.line, "expected a target and a reference before the first test number"));
    samples_.push_back({step, target_, reference_, reference_line_, reference_time_});
    return {};
  }

  const Wiring& wiring_;
  Numbers numbers_{false};
  double target_ = nan, reference_ = nan;
  std::uint64_t reference_line_ = 0;
  std::int64_t reference_time_ = 0;
  std::vector<Sample> samples_;
};

Expected<std::map<std::uint32_t, double>> targets_of(const std::vector<Sample>& samples) {
  std::map<std::uint32_t, double> targets;
  for (const Sample& s : samples) {
    const auto [known, fresh] = targets.try_emplace(s.step.position, s.target);
    if (!fresh && known->second != s.target)
      return fail(at_line(s.line, "position " + std::to_string(s.step.position) +
                                      ": expected the same target in every pass, found " +
                                      short_text(s.target, 9) + " after " +
                                      short_text(known->second, 9)));
  }
  return targets;
}

Expected<void> whole(const std::vector<Sample>& samples, std::size_t positions) {
  std::map<std::pair<int, std::uint32_t>, std::size_t> passes;
  for (const Sample& s : samples) ++passes[{s.step.direction, s.step.cycle}];
  for (const auto& [pass, count] : passes)
    if (count != positions)
      return fail("expected " + std::to_string(positions) + " positions " +
                  (pass.first > 0 ? "forward" : "backward") + " in cycle " +
                  std::to_string(pass.second) + ", found " + std::to_string(count) +
                  "; was the log cut?");
  return {};
}

/// Adds a note with the fitted line of reference over target. Error: its slope deviates from 1 by
/// more than 10 %.
Expected<void> check_line(const std::vector<Sample>& samples, const Wiring& w, Observations& obs,
                          bool rotary) {
  std::vector<double> x, y;
  for (const Sample& s : samples)
    if (!std::isnan(s.reference)) {
      x.push_back(s.target * w.target_unit);
      y.push_back(s.reference * w.reference_unit * w.gain);
    }
  const Straight line = straight_through(x, y);
  if (!(line.slope > 0.0))
    return fail(
        of_option("reference_gain",
                  "the reference runs against the targets (gain " + short_text(line.slope, 6) +
                      "); if the sensor was mounted the other way round, state a negative one"));
  if (std::fabs(line.slope - 1.0) > 0.1)
    return fail(
        of_option("reference_gain", "expected a reference that goes as far as the targets, found " +
                                        short_text(line.slope, 6) +
                                        " times as far; is reference_unit right?"));
  obs.notes.push_back({"camonitor.line",
                       {{"scale", line.slope - 1.0, slope_of(rotary)},
                        {"offset", line.offset, position_of(rotary)},
                        {"stated", w.gain, Quantity::ratio}}});
  return {};
}

Expected<Observations> read_file(const ReadInput& input, const Axis& axis) {
  NONIO_TRY(const auto wiring, wiring_of(input, axis.rotary));
  NONIO_TRY(const auto entries,
            entries_of(input.bytes, {wiring.target, wiring.reference, wiring.test}));
  NONIO_TRY(const auto samples, Sampler(wiring).samples(entries));
  if (samples.empty())
    return fail("expected test numbers (1101 ...) of PV " + wiring.test +
                ", found none, and without them the stops of the axis are not known; in the log: " +
                pvs_of(input.bytes) +
                ". State the PV with the numbers as test_pv, or write a table with a row for each "
                "stop (run, direction, target and deviation) for the reader csv or long-table");
  NONIO_TRY(const auto targets, targets_of(samples));
  if (auto ok = whole(samples, targets.size()); !ok) return fail(ok.error());
  std::vector<double> listed;
  for (const auto& [position, target] : targets) listed.push_back(target);
  const int sense = sense_of(listed);
  if (sense == 0) return fail("expected two targets or more that only rise or only fall");
  Runs runs(input, axis, axis.rotary);
  if (auto ok = check_line(samples, wiring, runs.observations(), axis.rotary); !ok)
    return fail(ok.error());
  for (const Sample& s : samples) {
    const double target = s.target * wiring.target_unit;
    const double deviation = wiring.gain * s.reference * wiring.reference_unit - target;
    const double seconds = 1e-6 * static_cast<double>(s.time - samples.front().time);
    if (auto ok = runs.add({s.step.cycle, static_cast<std::int8_t>(s.step.direction * sense),
                            target, deviation, s.line, seconds});
        !ok)
      return fail(ok.error());
  }
  return runs.finish();
}

bool recognises(std::string_view head) {
  Lines lines(head);
  std::string_view line;
  int seen = 0;
  while (seen < 3 && lines.next(line)) {
    if (trimmed(line).empty()) continue;
    if (!entry_of(line)) return false;
    ++seen;
  }
  return seen > 0;
}

Option text_option(const char* name, const char* help) { return {name, std::string(), "", help}; }

}  // namespace

Reader reader() {
  Reader r;
  r.info = {
      "camonitor",
      "1.0",
      "Logs of EPICS' camonitor, of tests numbered by ecmc's tools (1101, 2109).",
      {text_option("target_pv", "PV of the commanded position."),
       text_option("reference_pv", "PV of the reference."),
       text_option("test_pv", "PV of the test number; it changes when a position has settled."),
       text_option("target_unit", "Unit of the target: mm, um, m; deg, rad, mrad."),
       text_option("reference_unit", "Unit of the reference: mm, um, m; deg, rad, mrad."),
       {"reference_gain", 1.0, "",
        "Factor of the reference; negative where the sensor was mounted the other way round."}}};
  r.recognises = recognises;
  r.reads = [](std::string_view kind) { return kind == "axis"; };
  r.read = [](const ReadInput& input) { return read_of_axis(input, read_file); };
  return r;
}

}  // namespace nonio::camonitor
