// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "common.h"

namespace nonio::app {

/// Which campaigns `model explain` takes together.
struct TogetherOptions {
  std::vector<std::string> folders;  ///< of campaigns, or with campaigns below them
  std::string machine;               ///< asset, serial number or model; empty: all
  std::string since, until;          ///< YYYY-MM-DD; empty: no limit
};

/// Whether it is one campaign and nothing else is asked for.
bool is_single(const TogetherOptions& options);

/// Fits the campaigns together and prints what they show.
int explain_together(const TogetherOptions& options, const Common& common, std::uint64_t seed);

}  // namespace nonio::app
