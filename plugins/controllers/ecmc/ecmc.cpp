// SPDX-License-Identifier: Apache-2.0
#include "nonio/controllers/list.h"

namespace nonio::ecmc {
namespace {

using Confidence = ControlTable::Confidence;
using controllers::Sheet;

// The table contains encoder reading minus true position, which the control subtracts.
ControlTable declared() {
  ControlTable t;
  t.name = "encoder.lookuptable";
  t.sign = ControlTable::Sign::correction;
  t.grid = ControlTable::Grid::listed;
  t.position_step = t.value_step;
  t.facts = {
      {"sign", Confidence::documented,
       "The sign changed in release 10.0.0: before it the value was added."},
      {"index", Confidence::documented, "The index is the encoder's reading, not corrected."}};
  t.runs_gcode = false;
  return t;
}

ControlTable table_of(const Settings& o) {
  ControlTable t = declared();
  if (o.integer("release", 10) < 10) t.sign = ControlTable::Sign::error;
  return t;
}

Expected<std::vector<Artifact>> files(const Sheet& s) {
  if (s.position.size() < 3)
    return fail("axis " + s.job.axis + ": expected at least 3 rows, found " +
                std::to_string(s.position.size()));
  const std::string stem = "ecmc-" + s.job.stem;
  std::string table = controllers::comments(s.words(), "# ");
  for (std::size_t i = 0; i < s.position.size(); ++i)
    table += s.at(i) + " " + s.entry(s.plus[i]) + "\n";
  const std::string yaml = "encoder:\n  lookuptable:\n    enable: true\n    filename: " + stem +
                           ".corr\n    scale: 1\n" + (s.job.turn ? "    range: 360\n" : "");
  return std::vector<Artifact>{{stem + ".corr", table}, {stem + ".yaml", yaml}};
}

Expected<std::vector<LoadedTable>> parse(const TableInput& in) {
  const auto take = [](std::string_view line, controllers::RawTable& raw) -> Expected<bool> {
    const auto w = controllers::words_of(line, " ,\t\r");
    if (w.empty() || w[0].front() == '#' || w[0].rfind("PREC=", 0) == 0) return false;
    if (w[0] == "scale:" && (w.size() != 2 || controllers::real(w[1]) != 1.0))
      return fail("expected scale: 1, found \"" + std::string(line) + "\"");
    if (w[0].back() == ':') return false;
    const auto x = controllers::real(w[0]), v = controllers::real(w.size() == 2 ? w[1] : "");
    if (!x || !v) return controllers::no_point(line);
    raw.position.push_back(*x);
    raw.plus.push_back(*v);
    return true;
  };
  return controllers::parse_files(in, table_of(in.options), "ecmc", take);
}

Expected<OutputResult> write(const ControllerInput& in) {
  return controllers::write_tables(in, {.name = "ecmc",
                                        .table = table_of(in.options),
                                        .keys = {"step", "first", "reference", "backlash"},
                                        .files = files,
                                        .parse = parse,
                                        .holds_documented = true});
}

}  // namespace

NONIO_PLUGIN(registry) {
  registry.add(controllers::controller(
      {"ecmc", "1.0.0", "Encoder look-up tables for ecmc (EPICS).",
       controllers::table_options(
           declared(), "step_mm, first_mm, reference_mm, backlash_mm and the same with _deg",
           {within(1.0, 99.0,
                   {"release", std::int64_t{10}, "",
                    "Main number of the ecmc release: before 10 values are added."})})},
      declared(), write, parse));
}

}  // namespace nonio::ecmc
