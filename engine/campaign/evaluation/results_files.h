// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "campaign/evaluation/record.h"

/// The files of a campaign's results, wherever they lie (platform/storage/packed_results.h).
namespace nonio::evaluation {

/// All that its record names and the record itself, the last one; before them those of `last-good`,
/// as "last-good/report.pdf". Empty if there is no record. An error if a name would lead out of the
/// folder, or if a pack has files of the campaign that its record does not name.
Expected<std::vector<RecordedFile>> results_files(const std::filesystem::path& folder);
/// Reads a file with the digest of its record. An error names the file.
Expected<std::string> read_result(const std::filesystem::path& folder, const RecordedFile& file);

/// Where the results of a campaign lie in a pack: writes them into its own folder, the record last, after which that
/// counts. A file that is damaged is left out, unless it is the only copy of something.
Expected<void> take_in(const std::filesystem::path& out, const std::string& id);
/// The same, from one output folder to another that knows nothing of the campaign: what is there of its results, and
/// of those on their way into their place. Nothing where there are none.
Expected<void> copy_results(const std::filesystem::path& folder, const std::filesystem::path& to);

}  // namespace nonio::evaluation
