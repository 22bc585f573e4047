// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <string>

#include "nonio/sdk/results.h"

namespace nonio::certificates {

/// Lists the differences between two versions of a file, at most `most_changes`: keys of a TOML
/// file, lines of a text, nothing for other files. If `before` or `after` is null, the file is new
/// or was removed.
FileChange change_of(const std::string& file, const std::string* before, const std::string* after);

inline constexpr std::size_t most_changes = 40;

/// Returns keys with values, for example "machine.axes.X.tolerance_um.B" -> "3". Tables of a list
/// are named by their `id`, or without `id` by their position, counted from 1. Empty if the text is
/// not TOML.
std::map<std::string, std::string> flat_toml(std::string_view text);

/// If only this key has changed, the file is reported as unchanged.
inline constexpr const char* amendment_key = "certificate.amendment";

}  // namespace nonio::certificates
