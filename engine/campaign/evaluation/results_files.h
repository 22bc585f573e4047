// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "campaign/evaluation/record.h"

/// Results of a campaign, in a folder or in a pack (platform/storage/packed_results.h).
namespace nonio::evaluation {

/// Returns the files of `last-good`, then those that the record names, then the record. An error if
/// a name leads out of the folder or a pack has a file that the record does not name.
Expected<std::vector<RecordedFile>> results_files(const std::filesystem::path& folder);
/// Returns an error if size or digest differ from those of the record.
Expected<std::string> read_result(const std::filesystem::path& folder, const RecordedFile& file);

/// Copies results from a pack to the campaign's own folder, which then replaces the pack. A damaged
/// file is left out; a damaged file without another copy of its data is an error.
Expected<void> take_in(const std::filesystem::path& out, const std::string& id);
/// `to` must not contain results of the campaign. Results that are being stored are included.
Expected<void> copy_results(const std::filesystem::path& folder, const std::filesystem::path& to);

}  // namespace nonio::evaluation
