// SPDX-License-Identifier: Apache-2.0
#include "runs_of.h"

#include <algorithm>
#include <cmath>

#include "code_pages.h"

namespace nonio::renishaw {
using namespace reading;

namespace {

/// The rows of one run, in the order of the file.
struct Pass {
  std::vector<const RunFile::Row*> rows;
  std::int8_t direction = 0;
  bool taken = false;  ///< at least one value
  bool zero = true;    ///< every value is 0
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
      return fail(at_line(
          pass.rows.front()->line,
          "run " + std::to_string(i + 1) + ": wanted target numbers that only rise or only fall"));
  }
  return passes;
}

/// Runs go to and fro, or all one way; anything else is not a test that anybody would know.
Expected<bool> bidirectional(const std::vector<Pass>& passes) {
  bool same = true, alternate = true;
  for (std::size_t i = 1; i < passes.size(); ++i) {
    same = same && passes[i].direction == passes[0].direction;
    alternate = alternate && passes[i].direction == -passes[i - 1].direction;
  }
  if (same) return false;
  if (alternate) return true;
  return fail("wanted runs to and fro, or all in one direction, found another order");
}

Remark run_note(const char* id, std::size_t run) { return {id, {counted("run", run)}}; }

}  // namespace

Expected<void> add_runs(const RunFile& file, const Units& units, Runs& runs) {
  const auto passes = passes_of(file);
  if (!passes) return fail(passes.error());
  const auto both = bidirectional(*passes);
  if (!both) return fail(both.error());
  std::vector<Remark>& notes = runs.observations().notes;
  const bool all_zero =
      std::all_of(passes->begin(), passes->end(), [](const Pass& p) { return p.zero || !p.taken; });
  if (all_zero) return fail("wanted readings, found runs that were not taken or are 0 everywhere");
  for (std::size_t i = 0; i < passes->size(); ++i) {
    const Pass& pass = (*passes)[i];
    if (!pass.taken) notes.push_back(run_note("renishaw.run-not-taken", i + 1));
    if (pass.zero) notes.push_back(run_note("renishaw.run-zero", i + 1));
    for (const RunFile::Row* row : pass.rows) {
      Reading reading;
      reading.run = static_cast<std::uint32_t>(*both ? i / 2 + 1 : i + 1);
      reading.approach = pass.direction;
      reading.target = file.targets[row->target - 1] * units.target;
      reading.deviation = pass.zero ? std::nan("") : row->value * units.value;
      reading.line = row->line;
      if (auto ok = runs.add(reading); !ok) return ok;
    }
  }
  // 0: to and fro, 1: one way. Seen in one real file and one imitator's, so it is only a warning.
  if (file.flags.size() > 1 && passes->size() > 1 && (file.flags[1] == 0) != *both)
    notes.push_back({"renishaw.flag-disagrees"});
  return {};
}

Expected<void> add_user_text(const RunFile& file, const ReadInput& input, Observations& obs) {
  if (file.user.empty()) return {};
  constexpr std::size_t axis_line = 4;
  const std::string code_page = input.options.text("code_page", "utf-8");
  std::string all;
  bool unreadable = false;
  for (std::size_t i = 0; i < file.user.size(); ++i) {
    const std::string_view line = file.user[i].text;
    const std::size_t colon = line.find(':');
    if (colon == line.npos)
      return fail(at_line(file.user[i].number,
                          "wanted \"name: value\" in USER-TEXT, found " + shown(line)));
    if (trimmed(line.substr(colon + 1)).empty()) continue;
    const auto text = decoded(line, code_page);
    unreadable = unreadable || !text;
    if (text) all += (all.empty() ? "" : "; ") + *text;
    const std::string axis(trimmed(line.substr(colon + 1)));
    if (i == axis_line && axis != input.measurement.axis &&
        input.campaign.machine.axis(axis) != nullptr && !input.options.flag("ignore_axis"))
      return fail(at_line(file.user[i].number,
                          "the file says axis " + axis + ", the manifest " +
                              input.measurement.axis +
                              "; if the file is wrong: ignore_axis = true among the options"));
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
