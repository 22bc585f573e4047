// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "nonio/sdk/error.h"

/// The content of a folder in one archive (tar.h), with the SHA-256 of each file.
namespace nonio::storage {

struct BackupSummary {
  std::uint64_t files = 0, bytes = 0;
  std::vector<std::string> left_out;  ///< neither file, folder nor link
};

/// The digests of the archive's files, its last member, as `sha256sum -c` reads them.
inline constexpr const char* backup_digests = ".nonio-backup.sha256";

/// Writes `file`, which appears whole or not at all and is read back before. Other processes may
/// write into the folder meanwhile: a database is copied as of one moment, and the files of each
/// folder are those of one moment after that. So a register, copied first, never lacks an entry that
/// its site has noted before. Not archived: locks, and what is being written. Errors: `file` exists
/// or is in the folder; a folder changes all the time; a database is damaged.
Expected<BackupSummary> write_backup(const std::filesystem::path& folder,
                                     const std::filesystem::path& file);

/// Unpacks an archive of `write_backup` into a folder that is missing or empty; it gets its content
/// at once. All digests are compared before. Errors: a file is damaged, missing or more than is
/// listed; the folder has content.
Expected<BackupSummary> restore_backup(const std::filesystem::path& file,
                                       const std::filesystem::path& folder);

}  // namespace nonio::storage
