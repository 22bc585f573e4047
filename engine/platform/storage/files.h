// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "nonio/sdk/error.h"
#include "nonio/sdk/results.h"
#include "platform/storage/packed_results.h"

namespace nonio::storage {

/// Sets a function that opens files for reading, for a process that may not open any itself. It
/// returns a descriptor, or -1 and errno.
void open_files_with(std::function<int(const std::filesystem::path&)> opener);

/// A file that is mapped into memory, to be read from front to back. Movable, not copyable.
class MappedFile {
 public:
  static Expected<MappedFile> open(const std::filesystem::path& path);
  MappedFile(MappedFile&&) noexcept;
  MappedFile& operator=(MappedFile&&) = delete;
  ~MappedFile();

  std::string_view bytes() const { return {data_, size_}; }
  /// Returns the pages before `offset` to the system; reading them again loads them from disk.
  void release(std::size_t offset) const;

 private:
  MappedFile(const char* data, std::size_t size) : data_(data), size_(size) {}
  const char* data_;
  std::size_t size_;
};

/// A file as it was at one moment, copied into memory, so that the bytes that are hashed are the
/// bytes that are evaluated even if another process writes to the file. Movable, not copyable.
class ReadFile {
 public:
  /// Reads the file; an error if it changes during each of several attempts.
  static Expected<ReadFile> open(const std::filesystem::path& path);
  ReadFile(ReadFile&& other) noexcept;
  ReadFile& operator=(ReadFile&&) = delete;
  ~ReadFile();

  std::string_view bytes() const { return {data_, size_}; }
  /// Returns the pages before `offset` to the system; they must not be read after that.
  void release(std::size_t offset);

 private:
  ReadFile(char* data, std::size_t size, std::size_t mapped)
      : data_(data), size_(size), mapped_(mapped) {}
  char* data_;
  std::size_t size_;
  std::size_t mapped_;        ///< size of the mapping in bytes; 0: no mapping
  std::size_t released_ = 0;  ///< bytes at the front whose pages were released
};

/// Calls `take` with the parts of a file, each of up to one megabyte; a file in a pack is one part.
/// Unlike a mapping this is safe if another process truncates the file, so the main process reads
/// in this way only.
Expected<void> read_parts(const std::filesystem::path& path,
                          const std::function<void(std::string_view)>& take);
/// Reads a whole file, also one in a pack (pack.h).
Expected<std::string> read_file(const std::filesystem::path& path);
/// Reads a file that people write (campaign.toml, site.toml); refuses a file above 1 MB unread.
Expected<std::string> read_small_file(const std::filesystem::path& path);

/// Whether the path exists, also as a broken link or in a pack; an error if this cannot be found
/// out.
Expected<bool> is_there(const std::filesystem::path& path);

/// Returns a path as UTF-8 text; other bytes, such as those of a name in Latin-1, are written as
/// \\xe9.
std::string path_text(std::string_view path);

/// Resolves `relative` and all its links below `base`; an error if it leads outside `base`.
Expected<std::filesystem::path> path_inside(const std::filesystem::path& base,
                                            const std::string& relative);

/// Returns whether an output file may have this name: a plain, visible file name that Nonio does
/// not use for its own files.
bool is_artifact_name(std::string_view name);

/// Writes files that appear completely or not at all, by temporary name, fsync, rename and fsync of
/// the folder. All files are on disk before the first is renamed, and all names but the last are on
/// disk before the last: a process that sees the last file may rely on the others. Missing folders
/// are created. On an error the temporary files are removed.
Expected<void> publish(const std::filesystem::path& folder, const std::vector<Artifact>& files);

/// Makes the temporary names of this process and its children unique by `token`. Several processes
/// may then write the same files at once, and none sees or removes temporary files of another.
void take_own_names(const std::string& token);
bool has_own_names();

/// Writes files under their temporary names without flushing. On an error the files are removed.
/// Missing folders are created.
Expected<void> write_temporaries(const std::filesystem::path& folder,
                                 const std::vector<Artifact>& files);
/// Returns the final names of the files that have temporary names of this process in a folder,
/// sorted; an empty list if the folder does not exist.
Expected<std::vector<std::string>> temporaries(const std::filesystem::path& folder);
/// Drops the cached pages of a file, so that it is next read from the disk.
void drop_cached(const std::filesystem::path& path);
/// Reads a flushed file from the disk and returns whether it has this size and SHA-256. An error if
/// it cannot be read. Needs half the system calls of `drop_cached` and `read_file`.
Expected<bool> disk_gives_back(const std::filesystem::path& path, std::uint64_t size,
                               std::string_view sha256);

/// Renames a file. On a network file system the reply may be lost, and the repeated request then
/// finds no file `from`; in this case `is_ours` states whether `to` has the expected bytes. Without
/// `is_ours` the inodes are compared.
Expected<void> rename_file(const std::filesystem::path& from, const std::filesystem::path& to,
                           const std::function<bool()>& is_ours = {});

/// The two steps of `publish`, for files that are written elsewhere: the name under which to write
/// and flush a file, and renaming such files.
std::filesystem::path temporary_path(const std::filesystem::path& folder, const std::string& name);
Expected<void> rename_temporaries(const std::filesystem::path& folder,
                                  const std::vector<std::string>& names,
                                  const std::function<bool(const std::string& name)>& is_ours = {});

/// Whether a name is a temporary one of any process: the file is being written, or its writer was
/// killed.
bool is_temporary_name(std::string_view name);

/// Removes the temporary files of these names without listing the folder.
void remove_temporaries(const std::filesystem::path& folder, const std::vector<std::string>& names);

/// Removes the files that `temporaries` finds in a folder: incomplete files that a killed process
/// has left.
void remove_leftovers(const std::filesystem::path& folder);

}  // namespace nonio::storage
