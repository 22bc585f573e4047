// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <string>

#include "nonio/sdk/results.h"

namespace nonio::certificates {

/// Returns the differences between two versions of a file: keys of a TOML file, lines of a text;
/// for other files only that they differ. At most `most_changes` places are listed. If `before` or
/// `after` is null, the file is new or was removed.
FileChange change_of(const std::string& file, const std::string* before, const std::string* after);

inline constexpr std::size_t most_changes = 40;

/// Returns the keys of a TOML text with their values: "machine.axes.X.tolerance_um.B" -> "3".
/// Tables of a list are named by their `id`, for example "measurement.X.file", or without one by
/// their position, counted from 1. Empty if the text is not TOML.
std::map<std::string, std::string> flat_toml(std::string_view text);

/// Key for the reason why an earlier certificate is replaced. If only this key has changed, the
/// file is reported as unchanged.
inline constexpr const char* amendment_key = "certificate.amendment";

}  // namespace nonio::certificates
