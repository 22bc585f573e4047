// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "common.h"

namespace nonio::app {

struct TogetherOptions {
  std::vector<std::string> folders;  ///< campaigns, or folders that contain campaigns
  std::string machine;               ///< asset, serial number or model; empty for every machine
  std::string page;                  ///< file for a page with the residuals; empty: none
  std::string since, until;          ///< closed interval of dates, YYYY-MM-DD; empty if unlimited
};

/// Whether the options denote one campaign: a single folder without campaigns below it, and no
/// machine or dates.
bool is_single(const TogetherOptions& options);

/// Fits the model to all campaigns together and prints the result. Returns the exit status.
int explain_together(const TogetherOptions& options, const Common& common, std::uint64_t seed);

}  // namespace nonio::app
