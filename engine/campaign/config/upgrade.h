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
  std::uint64_t line = 0;  ///< 1-based
  std::string before, after;
};

struct UpgradedFile {
  std::string text;
  std::vector<UpgradedLine> lines;  ///< that differ; empty: the text is as it was
};

/// The text of a file with the present names of keys in place of former ones. Everything else,
/// comments, order, line ends and the mark of UTF-8 included, keeps its bytes. The result is read
/// again: if it does not have the same content, nothing is returned but an error with the line that
/// has to be changed by hand.
Expected<UpgradedFile> upgraded(std::string_view text, const Key& declaration,
                                const std::string& file);

}  // namespace nonio::config
