// SPDX-License-Identifier: Apache-2.0
#include "nonio/controllers/list.h"

namespace nonio::haas_classic {
namespace {

using Confidence = ControlTable::Confidence;
constexpr double inch = 25.4e-3;

// One value every 0.5 inch from machine zero towards minus, in units of 0.0001 inch.
ControlTable declared() {
  ControlTable t;
  t.name = "lead screw compensation of X, Y, Z";
  t.zero = ControlTable::Zero::first;
  t.position_unit = t.value_unit = {inch, 1.0};
  t.position_step = {inch / 2.0, 1.0};
  t.value_step = {1e-4 * inch, 1.0};
  t.rotary = false;
  t.facts = {{"sign", Confidence::unsure, "Unsure: the sign; the manual does not state it."},
             {"absolute", Confidence::inferred,
              "Inferred: entries are absolute, because the control interpolates between them."},
             {"range", Confidence::unsure,
              "Not checked: +-127 encoder steps of the 256 internal entries (Parameter 58)."}};
  return t;
}

Expected<std::vector<LoadedTable>> parse(const TableInput& in) {
  const auto t = controllers::chosen(declared(), in.options);
  return t ? controllers::parse_list(in, *t, "haas-classic") : tl::unexpected<Error>(t.error());
}

Expected<std::vector<Artifact>> files(const controllers::Sheet& s) {
  if (s.grid.last() > inch / 4.0)
    return fail("axis " + s.job.axis +
                ": the table is at and below machine zero, the targets do "
                "not: measure in machine coordinates");
  // The first entry of the control is at machine zero.
  return controllers::list_file(s, "haas-classic", controllers::Columns::mean,
                                controllers::Numbered::downwards);
}

Expected<OutputResult> write(const ControllerInput& in) {
  NONIO_TRY(const auto t, controllers::chosen(declared(), in.options));
  return controllers::write_tables(in, {.name = "haas-classic",
                                        .table = t,
                                        .keys = {"backlash"},
                                        .files = files,
                                        .parse = parse,
                                        .fixed_step = inch / 2.0});
}

}  // namespace

NONIO_PLUGIN(registry) {
  registry.add(controllers::controller(
      {"haas-classic", "1.0.0",
       "Lead screw tables of classic Haas controls, as a list to be typed in.",
       controllers::table_options(declared(), "backlash_mm")},
      declared(), write, parse));
}

}  // namespace nonio::haas_classic
