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

struct SheetWish {
  std::string file, language = "en";
  std::int64_t stops = 1;
};
std::vector<Argument> sheet_arguments(SheetWish&, Common&);

/// Returns a machine with axes X and Y and travels from 0 to x and y (m).
Machine rectangle(double x, double y);

/// Writes the rows as a PDF by the output plugin for sheets of stops. Returns the exit status.
int write_sheet(const SheetWish&, const Machine&, const PointTable& rows,
                std::map<std::string, std::string> options, const Common&);

}  // namespace nonio::app
