// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "nonio/sdk/error.h"

/// Archives of a folder (tar.h) with the SHA-256 of each file.
namespace nonio::storage {

struct BackupSummary {
  std::uint64_t files = 0, bytes = 0;
  /// Names of entries whose content is not in the archive: entries that are neither file, folder
  /// nor link, and links that lead outside the folder.
  std::vector<std::string> left_out;
};

/// Last file in an archive: the digests of all other files in the format of `sha256sum -c`.
inline constexpr const char* backup_digests = ".nonio-backup.sha256";

/// Writes a folder into the archive `file`, which is verified before it gets its name. Other
/// processes may write into the folder meanwhile: each database, and then the files of each folder,
/// are copied as of one moment. Files that name the last entry of a register are copied before the
/// register, so that they never name a missing entry. Locks and temporary files are excluded.
/// Errors: `file` exists or is in the folder; a folder changes all the time; a database is damaged.
Expected<BackupSummary> write_backup(const std::filesystem::path& folder,
                                     const std::filesystem::path& file);

/// Restores an archive of `write_backup` in `folder`, which must be missing or empty and appears
/// only after all digests have been verified. Errors: a file is damaged, missing or not listed; the
/// folder is not empty.
Expected<BackupSummary> restore_backup(const std::filesystem::path& file,
                                       const std::filesystem::path& folder);

}  // namespace nonio::storage
