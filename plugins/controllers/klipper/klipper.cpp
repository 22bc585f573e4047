// SPDX-License-Identifier: Apache-2.0
#include "nonio/controllers/skew.h"

namespace nonio::klipper {
namespace {

// SET_SKEW XY=AC,BD,AD and so on, in mm.
std::string text(const std::vector<controllers::Face>& faces) {
  std::string out = "SET_SKEW";
  for (const controllers::Face& f : faces)
    out += " " + f.plane + "=" + controllers::decimal(f.AC * 1e3, 6) + "," +
           controllers::decimal(f.BD * 1e3, 6) + "," + controllers::decimal(f.AD * 1e3, 6);
  return out + "\nSKEW_PROFILE SAVE=nonio\n";
}

Expected<std::vector<LoadedTable>> parse(const TableInput& in) {
  std::map<std::string, double> factors;
  for (const Artifact& f : in.files)
    for (const auto word : controllers::words_of(f.bytes, " \r\n")) {
      const auto v = controllers::words_of(word, "=,");
      if (v.size() != 4) continue;
      const auto AC = controllers::real(v[1]), BD = controllers::real(v[2]),
                 AD = controllers::real(v[3]);
      if (!AC || !BD || !AD) return fail("not three lengths: " + std::string(word));
      factors[std::string(v[0])] = controllers::skew_factor(*AC, *BD, *AD);
    }
  if (factors.empty()) return fail("no SET_SKEW with three lengths");
  return controllers::skew_tables(factors);
}

Expected<OutputResult> write(const ControllerInput& in) {
  const controllers::Writer writer{"klipper", controllers::skew_declared("skew"), {}, {}, parse};
  return controllers::write_skew(in, writer, text);
}

}  // namespace

NONIO_PLUGIN(registry) {
  Controller controller = controllers::controller(
      {"klipper", "1.0.0",
       "Skew correction (SET_SKEW) for Klipper, from the squareness of the planes."},
      controllers::skew_declared("skew"), write, parse);
  controller.applies = controllers::has_squareness;
  registry.add(std::move(controller));
}

}  // namespace nonio::klipper
