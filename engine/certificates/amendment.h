// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <string>

#include "nonio/sdk/results.h"

namespace nonio::certificates {

/// Where one file is other than it was: keys of TOML, lines of text; of other files that they
/// differ. At most `most_changes` places are listed. Without `before` or `after`: the file is new,
/// or was removed.
FileChange change_of(const std::string& file, const std::string* before, const std::string* after);

inline constexpr std::size_t most_changes = 40;

/// A TOML text as keys with their values: "machine.axes.X.tolerance_um.B" -> "3". Of a list of
/// tables with an `id` each: "measurement.X.file". Empty if it is no TOML.
std::map<std::string, std::string> flat_toml(std::string_view text);

/// Why an earlier certificate is replaced; a part of the manifest that is no change by itself.
inline constexpr const char* amendment_key = "certificate.amendment";

}  // namespace nonio::certificates
