// SPDX-License-Identifier: Apache-2.0
#include "nonio/controllers/skew.h"

namespace nonio::marlin {
namespace {

// Lines of Configuration.h such as XY_DIAG_AC, in mm.
std::string text(const std::vector<controllers::Face>& faces) {
  std::string out = "#define SKEW_CORRECTION\n";
  if (faces.size() > 1 || faces.front().plane != "XY") out += "#define SKEW_CORRECTION_FOR_Z\n";
  for (const controllers::Face& f : faces)
    for (const auto& [what, length] :
         {std::pair{"_DIAG_AC ", f.AC}, {"_DIAG_BD ", f.BD}, {"_SIDE_AD ", f.AD}})
      out += "#define " + f.plane + what + controllers::decimal(length * 1e3, 6) + "\n";
  return out;
}

Expected<std::vector<LoadedTable>> parse(const TableInput& in) {
  std::map<std::string, double> lengths, factors;
  for (const Artifact& f : in.files)
    for (const auto line : controllers::lines_of(f.bytes)) {
      const auto w = controllers::words_of(line);
      if (w.size() != 3 || w[0] != "#define") continue;
      if (const auto length = controllers::real(w[2])) lengths[std::string(w[1])] = *length;
    }
  for (const std::string plane : {"XY", "XZ", "YZ"}) {
    const auto AC = lengths.find(plane + "_DIAG_AC"), BD = lengths.find(plane + "_DIAG_BD"),
               AD = lengths.find(plane + "_SIDE_AD");
    const std::size_t found = static_cast<std::size_t>(AC != lengths.end()) +
                              static_cast<std::size_t>(BD != lengths.end()) +
                              static_cast<std::size_t>(AD != lengths.end());
    if (found != 0 && found != 3)
      return fail("plane " + plane + " has " + std::to_string(found) +
                  " of its lengths DIAG_AC, DIAG_BD and SIDE_AD: the control needs all three");
    if (found == 3) factors[plane] = controllers::skew_factor(AC->second, BD->second, AD->second);
  }
  if (factors.empty()) return fail("no plane with DIAG_AC, DIAG_BD and SIDE_AD");
  return controllers::skew_tables(factors);
}

Expected<OutputResult> write(const ControllerInput& in) {
  const controllers::Writer writer{"marlin", controllers::skew_declared("skew"), {}, {}, parse};
  return controllers::write_skew(in, writer, text);
}

}  // namespace

NONIO_PLUGIN(registry) {
  Controller controller = controllers::controller(
      {"marlin", "1.0.0",
       "Skew correction (Configuration.h) for Marlin, from the squareness of the planes."},
      controllers::skew_declared("skew"), write, parse);
  controller.applies = controllers::has_squareness;
  registry.add(std::move(controller));
}

}  // namespace nonio::marlin
