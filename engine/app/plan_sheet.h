// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <string>
#include <vector>

#include "command_line.h"
#include "common.h"
#include "nonio/sdk/campaign.h"
#include "nonio/sdk/results.h"

namespace nonio::app {

/// --pdf FILE --language LANGUAGE: a plan on paper.
struct SheetWish {
  std::string file, language = "en";
  std::int64_t stops = 1;
};
std::vector<Argument> sheet_arguments(SheetWish&, Common&);

/// Axes X and Y with travels from 0 on, in m.
Machine rectangle(double x, double y);

/// Writes the sheet of these rows, by the output plan-sheet with its options. Exit status.
int write_sheet(const SheetWish&, const Machine&, const PointTable& rows,
                std::map<std::string, std::string> options, const Common&);

}  // namespace nonio::app
