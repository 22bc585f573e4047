// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <sstream>

#include "coverage.h"

namespace nonio::coverage {
namespace {

std::vector<std::string> parts(const std::string& text) {
  std::vector<std::string> out;
  std::istringstream in(text);
  for (std::string part; std::getline(in, part, ';');) out.push_back(part);
  return out;
}

bool one_in(const char* list, const std::string& text) {
  const auto all = parts(list);
  return std::any_of(all.begin(), all.end(), [&](const std::string& part) {
    return part == "*" || text.find(part) != std::string::npos;
  });
}

}  // namespace

bool Exception::holds(const Method& m, const Scenario& s, const std::string& result) const {
  const auto all = parts(results);
  return one_in(methods, m.name) && one_in(scenarios, s.name) &&
         std::any_of(all.begin(), all.end(),
                     [&](const std::string& name) { return name == "*" || name == result; });
}

const std::vector<Exception>& exceptions() {
  static const char* const contrasts =
      "C0Y;C0Y_LSQ;slave_shift;ECX;EYX;EXY;EYX_LSQ;EXY_LSQ;EYX_even;EXY_even;q_odd;squareness;"
      "straightness;direction;angle;distance";
  static const char* const sums = "positioning;radius;centre;distance;EXY_even;q_odd";
  static const char* const rotary = "direction;centre;radius;angle;distance";
  static const std::vector<Exception> all{
      {'a',
       "form attributed to the standards: the device and the temperatures count for the whole "
       "length, U_fixed and\n"
       "   U_per_length are added, a rectangle has k = 2, and drift counts in two means as if it\n"
       "   did not cancel between neighbouring runs",
       "ISO 230-2;VDI/DGQ;rules of", "*", "*"},
      {'b',
       "covers less, form attributed to the standards: U_EVE takes drift for scatter of single "
       "readings within the\n"
       "   range of the drift test; a walk, or settling, moves whole runs",
       "ISO 230-2;VDI/DGQ;rules of", "drift dominates", "*", true},
      {'c',
       "lines share sensor and temperature, and nobody states it: the larger counts, which is one\n"
       "   for each line in what differs between lines",
       "diagonals;two rotary;rotary axis",
       "small machine;short artefact;sensors stay;ball and probe", contrasts},
      {'d',
       "lines have a sensor and a temperature each, and nobody states it: the larger counts, "
       "which\n"
       "   is one for all in what is a mean of lines",
       "diagonals;two rotary;rotary axis", "line by line;large machine", sums},
      {'e', "the temperatures stay within their limits; they are counted as if they reached them",
       "diagonals;rotary", "anywhere within", "*"},
      {'f',
       "E_VE is counted as a walk; a slope or settling of that range is mostly in zeros, slopes "
       "and\n"
       "   means over both directions, which drop out",
       "diagonals;rotary", "drift dominates, linear;drift dominates, settling", "*"},
      {'g', "the scatter of a walk counts as that of single readings, though neighbours share it",
       "diagonals;rotary", "drift dominates, random walk", "*"},
      {'h', "cosine errors are one-sided: their mean, which nobody corrects, counts as uncertainty",
       "diagonals", "misalignment dominates", "positioning;straightness"},
      {'i', "of what each reading has for itself the larger of stated and found counts",
       "step diagonals;rotary", "instrument dominates;ball and probe dominate;short artefact",
       "positioning;squareness;straightness;direction;radius;centre"},
      {'j',
       "the table has no run-out, and its residuals are compared with the scatter that they\n"
       "   determine (Thompson's tau is less than Student's t); one k for the curve",
       "rotary axis", "*", "axial;radial"},
      {'k',
       "the bound of the linear axes, and their scales, show in the residuals too; no more than\n"
       "   the scatter that was found is taken off",
       "rotary",
       "misalignment dominates;instrument dominates;small machine;large machine;line by line;"
       "sensors stay",
       rotary},
      {'l',
       "the readings at the ends of a diagonal are in the squareness and in the check sums that\n"
       "   give its scatter",
       "step diagonals, averaging", "repeatability dominates", "squareness"},
      {'m', "yaw and pitch show in the residuals too, and count there as scatter", "yaw and pitch",
       "*", "positioning;squareness;straightness"},
  };
  return all;
}

}  // namespace nonio::coverage
