// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>
#include <string_view>

#include "nonio/sdk/error.h"

/// Tar archives (POSIX.1-2001: ustar, with pax headers for long names and large files).
namespace nonio::storage {

struct TarEntry {
  enum class Kind : char { file = '0', link = '2', folder = '5' };
  std::string name;  ///< relative path without a trailing slash
  Kind kind = Kind::file;
  unsigned mode = 0;
  std::uint64_t size = 0;    ///< size of a file in bytes
  std::int64_t changed = 0;  ///< modification time, seconds since 1970
  std::string target{};      ///< target of a link
};

class TarWriter {
 public:
  static Expected<TarWriter> create(const std::filesystem::path& path);
  TarWriter(TarWriter&& other) noexcept;
  TarWriter& operator=(TarWriter&&) = delete;
  ~TarWriter();

  /// `bytes` calls its argument with consecutive parts of a file; an error if their total is not
  /// `entry.size`.
  using Parts = std::function<Expected<void>(const std::function<void(std::string_view)>& take)>;
  Expected<void> add(const TarEntry& entry, const Parts& bytes = {});
  std::int64_t position() const;
  /// Truncates the archive to `position`.
  Expected<void> back_to(std::int64_t position);
  /// Completes the archive and flushes it to disk.
  Expected<void> end();

 private:
  TarWriter(int fd, std::string name) : fd_(fd), name_(std::move(name)) {}
  Expected<void> write(std::string_view bytes) const;
  Expected<void> header(const TarEntry& entry, char type, const std::string& name) const;
  int fd_;
  std::string name_;
};

/// Callbacks of `read_tar`: `begin` for each entry, then `take` with the parts of its content. An
/// error if the file is not a tar archive, is incomplete, or contains entries other than files,
/// folders and links.
struct TarReads {
  std::function<Expected<void>(const TarEntry& entry)> begin;
  std::function<Expected<void>(std::string_view part)> take;
};
Expected<void> read_tar(const std::filesystem::path& path, const TarReads& reads);

}  // namespace nonio::storage
