// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "batch/state/night_plan.h"
#include "platform/storage/json_values.h"

namespace nonio::batch {

/// Bytes that are not UTF-8 (the name of a folder) are kept as they are, in hexadecimal digits.
storage::Json exact(const std::string& bytes);
std::string exact(const storage::Json& json);
storage::Json errors_json(const std::vector<Error>& errors);
std::vector<Error> errors_in(const storage::Json& json);
/// Any other word: it is not evaluated yet.
evaluation::Status status_in(const storage::Json& json);

/// A file of a plan that is not as it was written.
Error damaged(const std::filesystem::path& path, const std::string& why);

/// A list of a plan under its temporary name, line by line, since it may be longer than what memory is for: the
/// campaigns `of` of `campaigns`. Sets the digest.
Expected<void> write_list(const std::filesystem::path& folder, const std::string& name,
                          std::span<const std::uint32_t> of,
                          const std::vector<CampaignState>& campaigns, NightPlan::List& list);
Expected<std::vector<Listed>> read_list(const std::filesystem::path& path,
                                        const NightPlan::List& list);

}  // namespace nonio::batch
