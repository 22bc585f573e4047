// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "campaign/config/keys.h"
#include "nonio/sdk/error.h"

namespace nonio::config {

struct UpgradedLine {
  std::uint64_t line = 0;
  std::string before, after;
};

struct UpgradedFile {
  std::string text;
  std::vector<UpgradedLine> lines;
};

/// Replaces former names and leaves all other bytes unchanged. Returns an error with the line if a
/// name is not found in its line, or if the content of the result differs.
Expected<UpgradedFile> upgraded(std::string_view text, const Key& declaration,
                                const std::string& file);

}  // namespace nonio::config
