// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "campaign/evaluation/record.h"

/// The files of a campaign's results, in a folder or in a pack (platform/storage/packed_results.h).
namespace nonio::evaluation {

/// Returns the files that the record names, with the record last, preceded by the files of
/// `last-good`, such as "last-good/report.pdf". Empty if there is no record. An error if a name
/// leads out of the folder, or if a pack has files of the campaign that its record does not name.
Expected<std::vector<RecordedFile>> results_files(const std::filesystem::path& folder);
/// Reads a file and compares it with the size and digest in its record. An error, which names the
/// file, if they differ or the file cannot be read.
Expected<std::string> read_result(const std::filesystem::path& folder, const RecordedFile& file);

/// Copies the results of a campaign from a pack to the campaign's own folder, with the record last.
/// The folder is then used instead of the pack. A damaged file is left out; a damaged file that is
/// the only copy of its data is an error.
Expected<void> take_in(const std::filesystem::path& out, const std::string& id);
/// Copies the results of a campaign, including those that are being stored, to the folder `to` of
/// another output folder that has no results of the campaign. Does nothing if there are none.
Expected<void> copy_results(const std::filesystem::path& folder, const std::filesystem::path& to);

}  // namespace nonio::evaluation
