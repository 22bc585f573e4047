// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>
#include <string_view>
#include <system_error>
#include <vector>

#include "nonio/sdk/error.h"
#include "nonio/sdk/results.h"
#include "platform/storage/packed_results.h"

namespace nonio::storage {

/// Sets a function that opens files for reading, for a process that may not open files. It returns
/// a descriptor, or -1 and errno.
void open_files_with(std::function<int(const std::filesystem::path&)> opener);

/// A memory-mapped file, to be read from front to back.
class MappedFile {
 public:
  static Expected<MappedFile> open(const std::filesystem::path& path);
  MappedFile(MappedFile&&) noexcept;
  MappedFile& operator=(MappedFile&&) = delete;
  ~MappedFile();

  std::string_view bytes() const { return {data_, size_}; }

 private:
  MappedFile(const char* data, std::size_t size) : data_(data), size_(size) {}
  const char* data_;
  std::size_t size_;
};

/// A copy of a file in memory as of one moment, so that the hashed bytes are the evaluated bytes
/// even if another process writes to the file.
class ReadFile {
 public:
  /// An error if the file changes during each of several attempts.
  static Expected<ReadFile> open(const std::filesystem::path& path);
  ReadFile(ReadFile&& other) noexcept;
  ReadFile& operator=(ReadFile&&) = delete;
  ~ReadFile();

  std::string_view bytes() const { return {data_, size_}; }
  /// Returns the pages before `offset` to the system; they must not be read afterwards.
  void release(std::size_t offset);

 private:
  ReadFile(char* data, std::size_t size, std::size_t mapped)
      : data_(data), size_(size), mapped_(mapped) {}
  char* data_;
  std::size_t size_;
  std::size_t mapped_;        ///< size of the mapping in bytes; 0 without a mapping
  std::size_t released_ = 0;  ///< number of leading bytes whose pages were released
};

/// Calls `take` with consecutive parts of up to one megabyte; a file in a pack is one part. Unlike
/// a mapping, this is safe if another process truncates the file.
Expected<void> read_parts(const std::filesystem::path& path,
                          const std::function<void(std::string_view)>& take);
/// Also reads a file in a pack (pack.h).
Expected<std::string> read_file(const std::filesystem::path& path);
/// For files that people write (campaign.toml, site.toml); an error if the file is larger than 1
/// MB.
Expected<std::string> read_small_file(const std::filesystem::path& path);

/// True also for a broken link and for a file in a pack; an error if the state cannot be
/// determined.
Expected<bool> is_there(const std::filesystem::path& path);

/// Returns a path as UTF-8 text; invalid bytes, such as those of a name in Latin-1, become \\xe9.
std::string path_text(std::string_view path);

/// Resolves `relative` and all its links below `base`; an error if the result is outside `base`.
Expected<std::filesystem::path> path_inside(const std::filesystem::path& base,
                                            const std::string& relative);

/// An output file must have a plain, visible file name that Nonio does not use for its own files.
bool is_artifact_name(std::string_view name);

/// Writes files that appear completely or not at all (temporary name, fsync, rename, fsync of the
/// folder). All files are on disk before the first is renamed, and all other names before the last
/// is renamed, so that a process that finds the last file may rely on the others. Missing folders
/// are created. On an error the temporary files are removed.
Expected<void> publish(const std::filesystem::path& folder, const std::vector<Artifact>& files);

/// `token` makes the temporary names of this process and its children unique, so that several
/// processes may write the same files at once.
void take_own_names(const std::string& token);
bool has_own_names();

/// Writes files under their temporary names without flushing, and creates missing folders. On an
/// error the files are removed.
Expected<void> write_temporaries(const std::filesystem::path& folder,
                                 const std::vector<Artifact>& files);
/// Returns the sorted final names of all files of this process that have temporary names in a
/// folder; empty if the folder does not exist.
Expected<std::vector<std::string>> temporaries(const std::filesystem::path& folder);
/// Drops the cached pages of a file, so that the next read is from the disk.
void drop_cached(const std::filesystem::path& path);
/// Reads a flushed file from the disk and returns whether it has this size and SHA-256. An error if
/// it cannot be read.
Expected<bool> disk_gives_back(const std::filesystem::path& path, std::uint64_t size,
                               std::string_view sha256);

/// On a network file system the reply may be lost, and the repeated request then fails because
/// `from` no longer exists; `is_ours` returns whether `to` has the expected content. Without
/// `is_ours` the inodes are compared.
Expected<void> rename_file(const std::filesystem::path& from, const std::filesystem::path& to,
                           const std::function<bool()>& is_ours = {});

/// The two steps of `publish`, for files that are written elsewhere: the path to write and flush,
/// and the renaming.
std::filesystem::path temporary_path(const std::filesystem::path& folder, const std::string& name);
Expected<void> rename_temporaries(const std::filesystem::path& folder,
                                  const std::vector<std::string>& names,
                                  const std::function<bool(const std::string& name)>& is_ours = {});

/// Whether a name is a temporary name of any process, including one that was killed.
bool is_temporary_name(std::string_view name);

/// Removes the temporary files of these names without listing the folder.
void remove_temporaries(const std::filesystem::path& folder, const std::vector<std::string>& names);

/// Removes the files that `temporaries` returns for a folder.
void remove_leftovers(const std::filesystem::path& folder);

/// Resolves links like `fs::canonical`, but reuses the result of the parent folder for its other
/// subfolders while both paths still lead to the same folder.
std::filesystem::path real_folder(const std::filesystem::path& folder, std::error_code& error);

/// A temporary folder that only this user can read; it is removed at the end of the lifetime.
class ScratchFolder {
 public:
  /// Creates "nonio-<purpose>-..." in `below`; if this is empty, in the system's temporary folder
  /// (TMPDIR).
  explicit ScratchFolder(const std::string& purpose, const std::filesystem::path& below = {});
  ScratchFolder(const ScratchFolder&) = delete;
  ScratchFolder& operator=(const ScratchFolder&) = delete;
  ~ScratchFolder();

  /// Empty if the folder could not be created.
  const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_;
};

}  // namespace nonio::storage
