// SPDX-License-Identifier: Apache-2.0
#include "runs_of.h"

#include <algorithm>
#include <charconv>
#include <chrono>
#include <cmath>
#include <optional>

#include "code_pages.h"

namespace nonio::renishaw {
using namespace readers;

namespace {

struct Pass {
  std::vector<const RunFile::Row*> rows;
  std::int8_t direction = 0;
  bool taken = false;
  bool zero = true;
};

Expected<std::vector<Pass>> passes_of(const RunFile& file) {
  std::vector<Pass> passes(file.run_count);
  for (const RunFile::Row& row : file.rows) passes[row.run - 1].rows.push_back(&row);
  for (std::size_t i = 0; i < passes.size(); ++i) {
    Pass& pass = passes[i];
    std::vector<double> targets;
    for (const RunFile::Row* row : pass.rows) {
      targets.push_back(file.targets[row->target - 1]);
      pass.taken = pass.taken || !std::isnan(row->value);
      pass.zero = pass.zero && row->value == 0.0;
    }
    pass.direction = static_cast<std::int8_t>(sense_of(targets));
    if (pass.direction == 0)
      return fail(at_line(pass.rows.front()->line,
                          "run " + std::to_string(i + 1) +
                              ": expected target numbers that only rise or only fall"));
  }
  return passes;
}

/// False if all runs have one direction. Error: they neither alternate nor have one direction.
Expected<bool> bidirectional(const std::vector<Pass>& passes) {
  bool same = true, alternate = true;
  for (std::size_t i = 1; i < passes.size(); ++i) {
    same = same && passes[i].direction == passes[0].direction;
    alternate = alternate && passes[i].direction == -passes[i - 1].direction;
  }
  if (same) return false;
  if (alternate) return true;
  return fail("expected runs to and fro, or all in one direction, found another order");
}

Remark run_note(const char* id, std::size_t run) { return {id, {counted("run", run)}}; }

/// Parses "2014-10-08 10:53:29"; nullopt for other formats, because 10/02 is ambiguous.
std::optional<std::chrono::sys_days> day_of(std::string_view text) {
  int part[3] = {};
  constexpr std::size_t at[] = {0, 5, 8}, digits[] = {4, 2, 2};
  if (text.size() < 10 || text[4] != '-' || text[7] != '-') return std::nullopt;
  for (std::size_t i = 0; i < 3; ++i) {
    const char* first = text.data() + at[i];
    if (std::from_chars(first, first + digits[i], part[i]).ptr != first + digits[i])
      return std::nullopt;
  }
  const std::chrono::year_month_day day{std::chrono::year(part[0]),
                                        std::chrono::month(static_cast<unsigned>(part[1])),
                                        std::chrono::day(static_cast<unsigned>(part[2]))};
  return day.ok() ? std::optional(std::chrono::sys_days(day)) : std::nullopt;
}

/// Letters and digits in upper case without leading zeros, because users type serial numbers
/// differently.
std::string bare(std::string_view text) {
  std::string out;
  for (const char c : text) {
    const char big = c >= 'a' && c <= 'z' ? static_cast<char>(c - 32) : c;
    if ((big >= 'A' && big <= 'Z') || (big > '0' && big <= '9') || (big == '0' && !out.empty()))
      out += big;
  }
  return out;
}

/// Compares texts that the operator typed into the file with the manifest.
struct Typed {
  const ReadInput& input;
  std::vector<Finding>& doubts;

  void add(const char* id, std::uint64_t line, std::string_view found, std::string expected) const {
    doubts.push_back({.id = id,
                      .attention = true,
                      .texts = {{"where", input.measurement.file + ":" + std::to_string(line)},
                                {"found", std::string(found)},
                                {"expected", std::move(expected)}}});
  }

  /// Second line: serial number. Operators may enter that of the instrument, or additional text.
  void serial(std::uint64_t line, std::string_view text) const {
    const Machine& machine = input.campaign.machine;
    const std::string found = bare(text);
    if (machine.serial.empty() || found.empty()) return;
    for (const std::string& known :
         {machine.serial, machine.asset, input.campaign.instrument.serial}) {
      const std::string own = bare(known);
      if (!own.empty() && (found.find(own) != found.npos || own.find(found) != own.npos)) return;
    }
    add("plausibility.other-serial", line, text, machine.serial);
  }

  /// Third line: date. A month of tolerance is allowed, because a campaign may take weeks.
  void day(std::uint64_t line, std::string_view text) const {
    constexpr std::chrono::days spare{31};
    const Campaign& c = input.campaign;
    const auto found = day_of(text), from = day_of(c.date);
    const auto to = c.end_date.empty() ? from : day_of(c.end_date);
    if (!found || !from || !to || (*found >= *from - spare && *found <= *to + spare)) return;
    add("plausibility.other-day", line, text.substr(0, 10), c.date);
  }
};

}  // namespace

Expected<void> add_runs(const RunFile& file, const Units& units, Runs& runs) {
  NONIO_TRY(const auto passes, passes_of(file));
  NONIO_TRY(const auto both, bidirectional(passes));
  std::vector<Remark>& notes = runs.observations().notes;
  const bool all_zero =
      std::all_of(passes.begin(), passes.end(), [](const Pass& p) { return p.zero || !p.taken; });
  if (all_zero)
    return fail("expected readings, found runs that were not taken or are 0 everywhere");
  for (std::size_t i = 0; i < passes.size(); ++i) {
    const Pass& pass = passes[i];
    if (!pass.taken) notes.push_back(run_note("renishaw.run-not-taken", i + 1));
    if (pass.zero) notes.push_back(run_note("renishaw.run-zero", i + 1));
    for (const RunFile::Row* row : pass.rows) {
      Reading reading;
      reading.run = static_cast<std::uint32_t>(both ? i / 2 + 1 : i + 1);
      reading.approach = pass.direction;
      reading.target = file.targets[row->target - 1] * units.target;
      reading.deviation = pass.zero ? std::nan("") : row->value * units.value;
      reading.line = row->line;
      if (auto ok = runs.add(reading); !ok) return ok;
    }
  }
  // The flag is 0 for alternating directions, 1 for one direction. A contradiction is only a
  // warning, because few files with this flag are known.
  if (file.flags.size() > 1 && passes.size() > 1 && (file.flags[1] == 0) != both)
    notes.push_back({"renishaw.flag-disagrees"});
  return {};
}

Expected<void> add_user_text(const RunFile& file, const ReadInput& input, Observations& obs) {
  if (file.user.empty()) return {};
  constexpr std::size_t serial_line = 1, date_line = 2, axis_line = 4;
  const Typed typed{input, obs.doubts};
  const std::string code_page = input.options.text("code_page", "utf-8");
  std::string all;
  bool unreadable = false;
  for (std::size_t i = 0; i < file.user.size(); ++i) {
    const std::string_view line = file.user[i].text;
    const std::size_t colon = line.find(':');
    if (colon == line.npos)
      return fail(at_line(file.user[i].number,
                          "expected \"name: value\" in USER-TEXT, found " + shown(line)));
    if (trimmed(line.substr(colon + 1)).empty()) continue;
    const auto text = decoded(line, code_page);
    unreadable = unreadable || !text;
    if (text) all += (all.empty() ? "" : "; ") + *text;
    const std::string value(trimmed(line.substr(colon + 1)));
    if (i == serial_line && is_utf8(value)) typed.serial(file.user[i].number, value);
    if (i == date_line) typed.day(file.user[i].number, value);
    if (i != axis_line || input.options.flag("ignore_axis")) continue;
    const std::string own = control_axis(input.campaign.machine, input.measurement);
    if (is_other_axis(input.campaign.machine, input.measurement, value))
      return fail(at_line(file.user[i].number,
                          "the file states axis " + value + ", the manifest " + own +
                              "; if the file is wrong: ignore_axis = true among the options"));
    // An axis that is not in the manifest is recognized by its letter.
    if (is_other_letter(own, value))
      typed.add("plausibility.name-of-another", file.user[i].number, value, own);
  }
  if (!all.empty()) obs.notes.push_back({"renishaw.user-text", {}, {{"text", all}}});
  if (unreadable) obs.notes.push_back({"renishaw.code-page"});
  return {};
}

Option code_page_option() {
  return {"code_page", std::string("utf-8"), "",
          "Code page of the computer that wrote the file, for the operator's words; numbers do not "
          "depend on it.",
          code_pages()};
}

}  // namespace nonio::renishaw
