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

/// For a process that may open no file: who opens them for reading in its place. Gives a
/// descriptor, or -1 and errno.
void open_files_with(std::function<int(const std::filesystem::path&)> opener);

/// A file mapped into memory for reading from front to back. Not copyable; unmapped at the end.
class MappedFile {
 public:
  static Expected<MappedFile> open(const std::filesystem::path& path);
  MappedFile(MappedFile&&) noexcept;
  MappedFile& operator=(MappedFile&&) = delete;
  ~MappedFile();

  std::string_view bytes() const { return {data_, size_}; }
  /// Gives the pages before `offset` back to the system; they can still be read, from disk.
  void release(std::size_t offset) const;

 private:
  MappedFile(const char* data, std::size_t size) : data_(data), size_(size) {}
  const char* data_;
  std::size_t size_;
};

/// A file as it was at one moment, read once into memory of its own: what is hashed is what is
/// evaluated, whatever another process writes into the file meanwhile. Not copyable.
class ReadFile {
 public:
  /// An error if the file changes while it is read, several times in a row.
  static Expected<ReadFile> open(const std::filesystem::path& path);
  ReadFile(ReadFile&& other) noexcept;
  ReadFile& operator=(ReadFile&&) = delete;
  ~ReadFile();

  std::string_view bytes() const { return {data_, size_}; }
  /// Gives the pages before `offset` back to the system; they must not be read after that.
  void release(std::size_t offset);

 private:
  ReadFile(char* data, std::size_t size, std::size_t mapped)
      : data_(data), size_(size), mapped_(mapped) {}
  char* data_;
  std::size_t size_;
  std::size_t mapped_;        ///< 0: nothing is
  std::size_t released_ = 0;  ///< whole pages at the front
};

/// A file in parts of up to a megabyte. Unlike a mapping it is safe if another process truncates
/// the file meanwhile, so the main process reads in this way only.
Expected<void> read_parts(const std::filesystem::path& path,
                          const std::function<void(std::string_view)>& take);
/// Like `read_parts` and `is_there`, of a path that leads into a pack (pack.h) too.
Expected<std::string> read_file(const std::filesystem::path& path);
/// A file that people write (campaign.toml, site.toml): refused above 1 MB, by its size and unread.
Expected<std::string> read_small_file(const std::filesystem::path& path);

/// Whether anything exists there, also a broken link; an error if that is not known.
Expected<bool> is_there(const std::filesystem::path& path);

/// A path as text: bytes that are not UTF-8 (a name in Latin-1) become \\xe9.
std::string path_text(std::string_view path);

/// `relative` below `base`, with every link resolved; an error if it would lead outside.
Expected<std::filesystem::path> path_inside(const std::filesystem::path& base,
                                            const std::string& relative);

/// Whether an artifact may have this name: a plain visible file name that the host does not use.
bool is_artifact_name(std::string_view name);

/// Writes files that appear whole or not at all: under a temporary name, fsync, rename, fsync of
/// the folder. All are complete on disk before the first one is renamed, and all others have their
/// names on disk before the last one gets its own: whoever sees the last file may rely on the
/// others. On an error the temporary files are removed. Folders that are missing are made.
Expected<void> publish(const std::filesystem::path& folder, const std::vector<Artifact>& files);

/// From now on the temporary names of this process, and of those that it makes, are its own: several
/// processes may write the same files at once, and none sees or removes what another is writing.
void take_own_names(const std::string& token);
bool has_own_names();

/// Writes files under their temporary names, not flushed. On an error they are removed. Folders
/// that are missing are made.
Expected<void> write_temporaries(const std::filesystem::path& folder,
                                 const std::vector<Artifact>& files);
/// The names that files under temporary names in a folder are to get, in order; none if there is no
/// such folder.
Expected<std::vector<std::string>> temporaries(const std::filesystem::path& folder);
/// Drops the cached pages of this file, so that it is read from the disk.
void drop_cached(const std::filesystem::path& path);
/// Both in one: reads a flushed file from the disk, and returns whether it has exactly these bytes,
/// by size and SHA-256. An error if it cannot be read. Takes half of the system calls.
Expected<bool> disk_gives_back(const std::filesystem::path& path, std::uint64_t size,
                               std::string_view sha256);

/// Renames a file. On a network file system the answer to a request may be lost, and the repeated
/// request finds no such file: then the file with the new name is checked. `is_ours`: whether it
/// has the right bytes; without it, whether it is the same one (inode).
Expected<void> rename_file(const std::filesystem::path& from, const std::filesystem::path& to,
                           const std::function<bool()>& is_ours = {});

/// `publish` in two steps, for what is written elsewhere: the name to write and flush it under, and
/// the renaming of such files.
std::filesystem::path temporary_path(const std::filesystem::path& folder, const std::string& name);
Expected<void> rename_temporaries(const std::filesystem::path& folder,
                                  const std::vector<std::string>& names,
                                  const std::function<bool(const std::string& name)>& is_ours = {});

/// Whether a file of this name is being written, or was left half-written, by any process.
bool is_temporary_name(std::string_view name);

/// Removes files under temporary names whose names are known: the folder need not be listed.
void remove_temporaries(const std::filesystem::path& folder, const std::vector<std::string>& names);

/// Removes what a killed process left half-written in a folder.
void remove_leftovers(const std::filesystem::path& folder);

}  // namespace nonio::storage
