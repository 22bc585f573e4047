// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <map>

#include "nonio/controllers/kit.h"
#include "nonio/controllers/replay.h"
#include "nonio/controllers/size.h"

namespace nonio::twincat_volumetric {
namespace {

using Confidence = ControlTable::Confidence;
using controllers::AxisJob;
using controllers::CrossCurve;
using controllers::CrossJob;

// ISG CSV: a line of names, rows of numbers, comments, # before the next block. X, Y, Z and the
// errors (named as in ISO 230-1) are in mm. Columns of angular errors (rad) are omitted, because
// lengths and diagonals do not determine them.
ControlTable declared() {
  ControlTable t;
  t.name = "ISG CSV (vol_comp)";
  t.grid = ControlTable::Grid::listed;
  t.rotary = false;
  t.straightness = t.squareness = t.volumetric = true;
  t.facts = {
      {"sign", Confidence::unsure,
       "Unsure: the sign; the names are those of ISO 230, and the control has a switch negate."},
      {"separator", Confidence::inferred, "Inferred: blanks between names and numbers."},
      {"angles", Confidence::documented, "Angular errors are in rad; none is written."}};
  return t;
}

/// All errors over one axis; keys of `curves` are the axes along which they act.
struct Block {
  std::string axis;
  std::vector<double> position;
  std::map<std::string, CrossCurve> curves;
  double zero = 0.0;
};

std::vector<Block> blocks_of(const std::vector<AxisJob>& jobs, const std::vector<CrossJob>& sets) {
  std::map<std::string, Block> all;
  const auto add = [&](const CrossCurve& c) {
    Block& b = all[c.input];
    b.axis = c.input;
    b.curves[c.output] = c;
    b.position.insert(b.position.end(), c.position.begin(), c.position.end());
  };
  for (const AxisJob& j : jobs) add({j.axis, j.axis, j.curve.position, j.curve.mean});
  for (const CrossJob& s : sets)
    for (const CrossCurve& c : s.curves) add(c);
  std::vector<Block> out;
  for (auto& [axis, b] : all) {
    const std::string_view name = axis;
    std::sort(b.position.begin(), b.position.end());
    const auto same = [](double x, double y) { return y - x < 1e-7; };
    b.position.erase(std::unique(b.position.begin(), b.position.end(), same), b.position.end());
    b.zero = std::clamp(0.0, b.position.front(), b.position.back());
    for (const auto& [along, c] : b.curves)
      if (c.told) b.zero = c.reference;
    for (const AxisJob& j : jobs)
      if (j.axis == name)
        b.zero = controllers::reference_position(j, b.position.front(), b.position.back());
    out.push_back(std::move(b));
  }
  return out;
}

std::string text_of(const std::vector<Block>& blocks, double sign,
                    const std::vector<std::string>& words) {
  std::string out = controllers::comments(words, "// ");
  for (const Block& b : blocks) {
    out += (&b == &blocks.front() ? "" : "#\n") + b.axis;
    for (const auto& [along, c] : b.curves) out += " E" + along + b.axis;
    out += "\n";
    for (const double x : b.position) {
      out += controllers::decimal(x * 1e3, 4);
      for (const auto& [along, c] : b.curves)
        out += " " + controllers::decimal(sign * 1e3 *
                                              (math::ErrorCurve::at(c.position, c.value, x) -
                                               math::ErrorCurve::at(c.position, c.value, b.zero)),
                                          6);
      out += "\n";
    }
  }
  return out;
}

/// Entries have 6 decimals of mm.
constexpr double entry_step = 1e-9;

std::string zero_words(const Block& b, const std::vector<AxisJob>& jobs) {
  std::string out =
      "errors over " + b.axis + ": zero at " + controllers::decimal(b.zero * 1e3, 4) + " mm";
  for (const AxisJob& j : jobs)
    if (const auto c = b.curves.find(j.axis); j.axis == b.axis && c != b.curves.end()) {
      const auto at = [&](double x) {
        return math::ErrorCurve::at(c->second.position, c->second.value, x);
      };
      std::vector<double> e;
      for (const double x : b.position) e.push_back(at(x) - at(b.zero));
      controllers::TableSize size;
      size.take(b.position, math::rounded(e, entry_step));
      out += "; " + controllers::size_words(j, size);
    }
  return out;
}

Expected<std::vector<LoadedTable>> parse(const TableInput& in) {
  NONIO_TRY(const auto t, controllers::chosen(declared(), in.options));
  const double sign = t.sign == ControlTable::Sign::error ? -1.0 : 1.0;
  std::vector<LoadedTable> tables;
  std::size_t first = 0;
  bool names = true;
  for (const Artifact& f : in.files)
    if (auto ended = controllers::ends_whole(f.name, f.bytes); !ended)
      return tl::unexpected<Error>(ended.error());
  for (const Artifact& f : in.files)
    for (std::string_view line : controllers::lines_of(f.bytes)) {
      line = line.substr(0, line.find("//"));
      const auto w = controllers::words_of(line, " ,;\t");
      if (w.empty()) continue;
      if (w[0].front() == '#') {
        names = true;
      } else if (names) {
        names = false;
        first = tables.size();
        for (std::size_t k = 1; k < w.size(); ++k) {
          if (w[k].size() != 3 || w[k][0] != 'E' || w[k].substr(2) != w[0])
            return fail("a column that is not understood: " + std::string(w[k]));
          tables.push_back({.output = std::string(w[k].substr(1, 1)),
                            .input = {std::string(w[0])},
                            .position = {{}},
                            .plus = {},
                            .minus = {}});
        }
      } else {
        if (w.size() != tables.size() - first + 1) return fail("a row of another length");
        const auto x = controllers::real(w[0]);
        for (std::size_t k = 1; k < w.size(); ++k) {
          const auto v = controllers::real(w[k]);
          if (!x || !v) return fail("not a number in: " + std::string(line));
          tables[first + k - 1].position[0].push_back(*x / 1e3);
          tables[first + k - 1].plus.push_back(sign * *v / 1e3);
        }
      }
    }
  for (const LoadedTable& one : tables)
    if (auto ok = math::validate_table(one); !ok) return tl::unexpected<Error>(ok.error());
  return tables.empty() ? Expected<std::vector<LoadedTable>>(fail("no block of errors")) : tables;
}

/// Refuses axes with a slave, because the file has no data for a second side.
bool second_side(const ControllerInput& in, OutputResult& result) {
  for (const Axis& axis : in.campaign.machine.axes) {
    if (axis.slave.empty()) continue;
    controllers::refuse_second_side(axis, {}, result);
    return true;
  }
  return false;
}

Expected<OutputResult> write(const ControllerInput& in) {
  OutputResult result;
  NONIO_TRY(const auto table, controllers::chosen(declared(), in.options));
  if (second_side(in, result)) return result;
  const controllers::Writer writer{
      "twincat-volumetric", table, {"reference", "backlash"}, {}, parse};
  NONIO_TRY(auto jobs, controllers::axis_jobs(in, writer.keys, result));
  std::map<std::string, int> runs;
  for (const AxisJob& j : jobs) ++runs[j.axis];
  std::erase_if(jobs, [&](const AxisJob& j) {
    const bool in_format = (j.axis == "X" || j.axis == "Y" || j.axis == "Z") && runs[j.axis] == 1;
    if (!in_format) result.notes.push_back(controllers::not_in_format(writer.name, j.measurement));
    return !in_format || controllers::refused(j, controllers::Columns::mean, result);
  });
  std::erase_if(result.findings, [](const Finding& f) {
    return f.id == "table.two-measurements";  // no table has the name of a measurement
  });
  auto sets = controllers::cross_jobs(in, controllers::SecondSide::not_known, result);
  if (sets.size() > 1)
    return fail(
        "one file holds one state of the machine: leave one set of diagonals in the campaign");
  std::erase_if(sets, [&](const CrossJob& s) { return controllers::oversized(s, in, result); });
  const auto blocks = blocks_of(jobs, sets);
  if (blocks.empty()) return result;
  std::string axes;
  std::vector<std::string> words{"campaign " + controllers::plain(in.campaign.id) +
                                 ": lengths in mm, errors by their ISO 230-1 names in mm"};
  for (const Block& b : blocks) axes += b.axis;
  for (const AxisJob& j : jobs)
    for (const std::string& warning : controllers::warnings(j, result)) words.push_back(warning);
  for (const Block& b : blocks) words.push_back(zero_words(b, jobs));
  for (const CrossJob& set : sets)
    for (std::string& line : controllers::set_words(set)) words.push_back(std::move(line));
  const double sign = table.sign == ControlTable::Sign::error ? 1.0 : -1.0;
  result.artifacts.push_back({"twincat-volumetric-" + axes + ".csv", text_of(blocks, sign, words)});
  NONIO_TRY(const auto read, parse({result.artifacts, in.campaign, in.options}));
  for (AxisJob& job : jobs) {
    const auto c = math::correction_of(read, job.axis, job.present_backlash());
    if (!c) continue;
    const auto size = controllers::size_of(read, job.axis, job.curve.position);
    if (controllers::oversized(job, size, table.value_step.linear, result)) {
      result.artifacts.clear();
      return result;
    }
    controllers::predict(job, *c, result);
    for (const Block& b : blocks)
      if (b.axis == job.axis) controllers::note_zero(job, b.zero, result);
    controllers::note_size(job, size, result);
  }
  for (const CrossJob& set : sets) {
    controllers::predict_lines(set, {.tables = read}, result);
    controllers::note_cross(set, read, result);
  }
  controllers::note_facts(writer, result);
  return result;
}

}  // namespace

NONIO_PLUGIN(registry) {
  registry.add(controllers::controller(
      {"twincat-volumetric", "1.0.0",
       "Volumetric compensation (TF5280, ISG CSV) for TwinCAT CNC: ISO 230 errors over X, Y and Z.",
       controllers::table_options(declared(), "reference_mm, backlash_mm")},
      declared(), write, parse));
}

}  // namespace nonio::twincat_volumetric
