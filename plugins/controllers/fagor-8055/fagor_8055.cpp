// SPDX-License-Identifier: Apache-2.0
#include <algorithm>

#include "nonio/controllers/list.h"

namespace nonio::fagor_8055 {
namespace {

using Confidence = ControlTable::Confidence;

// Position and error in each direction, relative to machine zero (NPOINTS P16, LSCRWCOM P15).
ControlTable declared() {
  ControlTable t;
  t.name = "LSCRWCOM";
  t.grid = ControlTable::Grid::listed;
  t.zero = ControlTable::Zero::reference;
  t.position_step = t.value_step = {1e-7, 1e-4 / deg_per_rad};
  t.points = 1000;
  t.largest = 99999.9999;
  t.bidirectional = true;
  t.facts = {{"sign", Confidence::unsure, "Unsure: the sign; the manual calls an entry the error."},
             {"zero", Confidence::unsure, "Unsure: zero at the machine reference point."}};
  return t;
}

Expected<std::vector<LoadedTable>> parse(const TableInput& in) {
  const auto t = controllers::chosen(declared(), in.options);
  return t ? controllers::parse_list(in, *t, "fagor-8055", controllers::Columns::both)
           : tl::unexpected<Error>(t.error());
}

// An all-zero second column means equal errors in both directions, so an error of 0 towards minus
// cannot be expressed.
Expected<std::vector<Artifact>> files(const controllers::Sheet& s) {
  if (s.directions && std::all_of(s.minus_steps.begin(), s.minus_steps.end(),
                                  [](std::int64_t v) { return v == 0; }))
    return fail("axis " + s.job.axis +
                ": the error towards minus is zero everywhere, which this "
                "table cannot state: set another reference_mm or directions = false");
  return controllers::list_file(s, "fagor-8055", controllers::Columns::both);
}

Expected<OutputResult> write(const ControllerInput& in) {
  NONIO_TRY(const auto t, controllers::chosen(declared(), in.options));
  return controllers::write_tables(
      in, {"fagor-8055", t, {"step", "first", "reference", "backlash"}, files, parse});
}

}  // namespace

NONIO_PLUGIN(registry) {
  registry.add(controllers::controller(
      {"fagor-8055", "1.0.0", "Leadscrew error tables of Fagor 8055, as a list to be typed in.",
       controllers::table_options(declared(), "step, first, reference, backlash")},
      declared(), write, parse));
}

}  // namespace nonio::fagor_8055
