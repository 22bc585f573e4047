// SPDX-License-Identifier: Apache-2.0
#include "nonio/controllers/skew.h"

namespace nonio::klipper {
namespace {

std::string text(const std::vector<controllers::Face>& faces) {
  std::string out = "SET_SKEW";
  for (const controllers::Face& f : faces)
    out += " " + f.plane + "=" + controllers::decimal(f.AC * 1e3, 6) + "," +
           controllers::decimal(f.BD * 1e3, 6) + "," + controllers::decimal(f.AD * 1e3, 6);
  return out + "\nSKEW_PROFILE SAVE=nonio\n";
}

// Parses printer.cfg after SKEW_PROFILE SAVE: [skew_correction NAME] with xy_skew = -0.00354, the
// tangent that SET_SKEW computes, below the mark of SAVE_CONFIG.
Expected<std::map<std::string, double>> saved(std::string_view file) {
  std::map<std::string, double> factors;
  std::vector<std::string> profiles;
  bool is_in = false;
  for (std::string_view line : controllers::lines_of(file)) {
    if (line.starts_with("#*#")) line.remove_prefix(3);
    const auto words = controllers::words_of(line, " =\t\r");
    if (words.empty()) continue;
    if (words[0].starts_with('[')) {
      is_in = words[0] == "[skew_correction" && words.size() == 2;
      if (is_in) profiles.emplace_back(words[1].substr(0, words[1].size() - 1));
    }
    for (const auto& [key, plane] :
         {std::pair{"xy_skew", "XY"}, {"xz_skew", "XZ"}, {"yz_skew", "YZ"}}) {
      if (!is_in || words[0] != key) continue;
      const auto factor = words.size() == 2 ? controllers::real(words[1]) : std::nullopt;
      if (!factor) return fail("no number: " + std::string(line));
      factors[plane] = *factor;
    }
  }
  if (profiles.size() > 1)
    return fail("two saved profiles, " + profiles[0] + " and " + profiles[1] +
                ": keep the one that is loaded");
  return factors;
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
  for (std::size_t k = 0; k < in.files.size() && factors.empty(); ++k) {
    NONIO_TRY(factors, saved(in.files[k].bytes));
  }
  if (factors.empty())
    return fail("no SET_SKEW with three lengths and no [skew_correction NAME] with xy_skew");
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
