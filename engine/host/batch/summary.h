// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>

#include "host/batch/run.h"

namespace nonio::host::batch {

/// summary.txt and summary.json (schema nonio-summary/1) of a complete night, written into `out`.
/// The findings come from the campaigns' records there, one at a time; the lists grow in files.
Expected<void> write_summary(const Night& night, const std::filesystem::path& out,
                             const std::string& version);

}  // namespace nonio::host::batch
