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
  std::uint64_t line = 0;  ///< number of the line, from 1
  std::string before, after;
};

struct UpgradedFile {
  std::string text;
  std::vector<UpgradedLine> lines;  ///< lines that differ; empty: nothing was changed
};

/// Returns the text of a file with former names of keys and of findings replaced by the present
/// ones. All other bytes, including comments, order, line ends and the byte order mark, stay the
/// same. The result is parsed again. Returns an error with the line to be changed by hand if a name
/// is not found in its line, or if the result does not have the same content.
Expected<UpgradedFile> upgraded(std::string_view text, const Key& declaration,
                                const std::string& file);

}  // namespace nonio::config
