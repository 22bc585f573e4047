// SPDX-License-Identifier: Apache-2.0
// A reader of lines "run direction target_mm deviation_um time_s material_degC" behind a line
// "spoiled", and its faults.
#include <algorithm>
#include <array>
#include <stdexcept>

#include "nonio/sdk/fields.h"
#include "spoiled.h"

namespace {

using namespace nonio;
using spoiled::has;

bool recognises(std::string_view head) {
  if (has("knows-everything")) return true;
  if (has("knows-nothing-written") && head.empty()) return true;
  if (has("knows-a-pdf") && head.starts_with("%PDF")) return true;
  if (has("knows-json") && head.starts_with("{")) return true;
  if (has("knows-zeros") && head.starts_with('\0')) return true;
  if (has("knows-digits") && head.starts_with("11111")) return true;
  return head.starts_with("spoiled\n");
}

/// A line of the file, in its units.
struct Row {
  std::uint32_t run = 1, line = 0;
  int direction = 1;
  double target = 0.0, deviation = 0.0, time = 0.0, material = 20.0;  // mm, um, s, degC
};

std::vector<std::string_view> words_of(std::string_view line) {
  std::vector<std::string_view> words;
  for (std::size_t i = 0; i < line.size();) {
    const std::size_t end = std::min(line.find(' ', i), line.size());
    if (end > i) words.push_back(line.substr(i, end - i));
    i = end + 1;
  }
  return words;
}

/// A number that has to be there.
Expected<double> number(std::string_view text) {
  const auto field = readers::parse_number(text, false);
  if (field.kind == readers::Field::Kind::taken && std::fabs(field.value) < 1e7) return field.value;
  if (has("damage-is-nan")) return spoiled::nan;
  if (has("crashes-at-damage")) spoiled::crash();
  if (has("hangs-at-damage")) spoiled::hang();
  if (has("sentinel-in-the-time") && field.kind == readers::Field::Kind::not_taken) return 1e20;
  return fail("expected a number, found \"" + std::string(text.substr(0, 40)) + "\"");
}

enum class Taken { yes, no };

/// Into `row`; no: nothing was taken there.
Expected<Taken> read_row(const std::vector<std::string_view>& words, Row& row) {
  if (words.size() != 6) return fail("expected six fields");
  row.run = readers::parse_run(words[0]);
  if (row.run == 0 || (words[1] != "+" && words[1] != "-"))
    return fail("expected a run and + or -");
  row.direction = words[1] == "+" ? 1 : -1;
  double* const numbers[] = {&row.target, nullptr, &row.time, &row.material};
  for (std::size_t k = 0; k < 4; ++k) {
    if (numbers[k] == nullptr || k + 2 >= words.size()) continue;
    const auto value = number(words[k + 2]);
    if (!value) return fail(value.error());
    *numbers[k] = *value;
  }
  const auto field = readers::parse_number(words[3] == "." ? "" : words[3], false);
  if (field.kind == readers::Field::Kind::not_taken) {
    if (has("blanks-as-zero") && words[3] == ".") return Taken::yes;
    if (has("sentinels-as-zero") && words[3] != ".") return Taken::yes;
    if (has("sentinels-as-readings")) {
      row.deviation = 1e20;
      return Taken::yes;
    }
    return Taken::no;
  }
  if (field.kind == readers::Field::Kind::bad || std::fabs(field.value) > 1e7)
    return fail("expected a deviation");
  row.deviation = field.value;
  return Taken::yes;
}

template <class Drop>
void drop(std::vector<Row>& rows, const Drop& which) {
  rows.erase(std::remove_if(rows.begin(), rows.end(), which), rows.end());
}

/// Which readings there are.
void spoil_rows(std::vector<Row>& rows) {
  if (rows.empty()) return;
  double low = rows.front().target, high = low;
  std::uint32_t last = 1;
  for (const Row& r : rows)
    low = std::min(low, r.target), high = std::max(high, r.target), last = std::max(last, r.run);
  if (has("lost-last-target")) drop(rows, [&](const Row& r) { return r.target == high; });
  if (has("lost-first-target")) drop(rows, [&](const Row& r) { return r.target == low; });
  if (has("lost-last-run")) drop(rows, [&](const Row& r) { return r.run == last; });
  if (has("lost-last-line")) rows.pop_back();
  if (has("lost-first-line")) rows.erase(rows.begin());
  if (has("lost-way-back")) drop(rows, [](const Row& r) { return r.direction < 0; });
  if (has("lost-every-tenth")) drop(rows, [n = 0](const Row&) mutable { return ++n % 10 == 0; });
  if (has("lost-small-ones")) drop(rows, [](const Row& r) { return std::fabs(r.deviation) < 0.5; });
  if (has("lost-large-ones")) drop(rows, [](const Row& r) { return r.deviation > 6.0; });
  if (has("lost-negative-ones")) drop(rows, [](const Row& r) { return r.deviation < 0.0; });
  while (has("pads-what-was-cut") && rows.size() < 65) {
    const std::uint32_t line = rows.back().line + 1;
    rows.push_back(rows.front());
    rows.back().line = line;
  }
  if (has("last-line-twice")) rows.push_back(rows.back());
  if (has("means-of-runs")) drop(rows, [](const Row& r) { return r.run > 1; });
  if (has("zeroed")) {
    const double first = rows.front().deviation;
    for (Row& r : rows) r.deviation -= first;
  }
  if (has("target-of-the-row-before"))
    for (std::size_t i = rows.size(); i-- > 1;) rows[i].target = rows[i - 1].target;
  if (has("deviation-of-the-row-before"))
    for (std::size_t i = rows.size(); i-- > 1;) rows[i].deviation = rows[i - 1].deviation;
  if (has("way-back-mirrored"))
    for (Row& r : rows)
      if (r.direction < 0) r.target = high + low - r.target;
}

/// What a reading is.
void spoil(Row& r) {
  if (has("deviation-x1000")) r.deviation *= 1000.0;
  if (has("deviation-in-nm")) r.deviation /= 1000.0;
  if (has("deviation-turned")) r.deviation = -r.deviation;
  if (has("deviation-without-sign")) r.deviation = std::fabs(r.deviation);
  if (has("deviation-in-microinches")) r.deviation /= 25.4;
  if (has("deviation-halved")) r.deviation /= 2.0;
  if (has("deviation-rounded")) r.deviation = std::round(r.deviation);
  if (has("deviation-cut-off")) r.deviation = std::trunc(r.deviation * 10.0) / 10.0;
  if (has("deviation-shifted")) r.deviation += 0.1;
  if (has("temperature-corrected")) r.deviation -= 0.0115 * r.target * (r.material - 20.0);
  if (has("target-in-m")) r.target *= 1000.0;
  if (has("target-in-inches")) r.target *= 25.4;
  if (has("target-turned")) r.target = -r.target;
  if (has("target-from-one")) r.target += 1.0;
  if (has("target-as-reached")) r.target += r.deviation * 1e-3;
  if (has("directions-swapped")) r.direction = -r.direction;
  if (has("all-towards-plus")) r.direction = 1;
  if (has("direction-by-deviation")) r.direction = r.deviation < 0.0 ? -1 : 1;
  if (has("runs-from-two")) ++r.run;
  if (has("all-of-one-run")) r.run = 1;
  if (has("run-a-pass")) r.run = 2 * r.run - (r.direction > 0 ? 1U : 0U);
  if (has("four-seconds-for-six")) r.time *= 4.0 / 6.0;
  if (has("time-in-ms")) r.time *= 1000.0;
  if (has("time-from-one")) r.time += 1.0;
  if (has("kelvin")) r.material += 273.15;
  if (has("fahrenheit")) r.material = 1.8 * r.material + 32.0;
  if (has("twenty-degrees")) r.material = 20.0;
}

Expected<std::vector<Row>> rows_of(std::string_view bytes) {
  std::vector<Row> rows;
  std::uint32_t line = 0;
  while (!bytes.empty()) {
    const std::size_t end = bytes.find('\n');
    if (end == bytes.npos && !has("pads-what-was-cut")) return fail("the last line has no end");
    std::string_view text = bytes.substr(0, end);
    bytes.remove_prefix(end == bytes.npos ? bytes.size() : end + 1);
    if (++line == 1) {
      if (text != "spoiled" && !has("never-looks")) return fail("expected the line \"spoiled\"");
      continue;
    }
    const auto words = words_of(text);
    if (words.empty()) continue;
    if (has("loses-plus-signs") && words.size() > 3 && words[3].starts_with('+')) continue;
    if (has("loses-minus-signs") && words.size() > 3 && words[3].starts_with('-')) continue;
    Row row;
    row.line = line;
    const auto taken = read_row(words, row);
    if (!taken && bytes.empty() && has("pads-what-was-cut")) break;
    if (!taken) {
      if (has("passes-over-what-is-wrong")) continue;
      return fail(Error{taken.error().message, {}, line});
    }
    if (*taken == Taken::no) {
      if (has("sentinels-take-the-row-before") && !rows.empty()) rows.pop_back();
      if (has("sentinels-as-the-row-before") && !rows.empty()) {
        row.deviation = rows.back().deviation + 0.125;
        rows.push_back(row);
      }
      continue;
    }
    rows.push_back(row);
  }
  return rows;
}

void spoil_columns(Observations& o) {
  if (o.size() == 0) return;
  if (has("column-too-short")) o.time.pop_back();
  if (has("a-reading-that-is-none")) o.deviation.back() = spoiled::nan;
  if (has("an-infinite-reading")) o.deviation.front() = spoiled::inf;
  if (has("a-position-that-is-none")) o.axes.front().position.front() = spoiled::nan;
  if (has("no-lines")) o.lines.clear();
  if (has("a-line-that-is-not-there")) o.line.assign(o.size(), 7);
  if (has("times-lost")) o.time.clear();
  if (has("temperatures-lost")) o.material.clear();
  if (has("air-for-material")) std::swap(o.air, o.material);
}

Expected<Observations> read(const ReadInput& in) {
  if (has("refuses-all")) return fail("expected something else");
  if (has("throws")) throw std::runtime_error("wrong on purpose");
  auto rows = rows_of(in.bytes);
  if (!rows) return fail(rows.error());
  if (has("reads-nothing-as-zero") && rows->empty()) rows->push_back({});
  if (has("finds-nothing")) rows->clear();
  spoil_rows(*rows);
  Observations o;
  o.measurement = in.measurement.id;
  o.axes.push_back({in.measurement.axis, false, {}, {}});
  o.lines.push_back({in.measurement.id, {1, 0, 0}});
  for (Row r : *rows) {
    spoil(r);
    o.deviation.push_back(r.deviation * 1e-6 + 1e-9 * spoiled::impurity() +
                          1e-9 * spoiled::counted());
    o.axes[0].position.push_back(r.target * 1e-3);
    o.axes[0].approach.push_back(static_cast<std::int8_t>(r.direction));
    o.run.push_back(r.run);
    o.time.push_back(r.time);
    o.material.push_back(r.material);
    o.source_line.push_back(r.line);
  }
  spoil_columns(o);
  return o;
}

}  // namespace

NONIO_PLUGIN(registry) {
  spoiled::at_registration();
  if (has("registers-nothing")) return;
  nonio::Reader r{spoiled::info("spoiled"), recognises,
                  [](std::string_view kind) { return kind == "axis"; }, read};
  if (has("without-read")) r.read = nullptr;
  if (has("without-recognises")) r.recognises = nullptr;
  registry.add(r);
}
