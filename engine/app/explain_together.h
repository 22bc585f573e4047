// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "common.h"

namespace nonio::app {

/// Campaigns that `model explain` fits together.
struct TogetherOptions {
  std::vector<std::string> folders;  ///< folders of campaigns, or folders that contain campaigns
  std::string machine;               ///< asset, serial number or model of the machine; empty: all
  std::string since, until;          ///< first and last day of the campaigns, YYYY-MM-DD; empty: no
                                     ///< limit
};

/// Whether only one folder is given, without a machine or days, and it is a campaign or contains no
/// campaigns.
bool is_single(const TogetherOptions& options);

/// Fits the campaigns together and prints the result. Returns the exit status.
int explain_together(const TogetherOptions& options, const Common& common, std::uint64_t seed);

}  // namespace nonio::app
