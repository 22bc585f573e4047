// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>
#include <string_view>

#include "nonio/sdk/error.h"

/// Archives in tar format (POSIX.1-2001: ustar, with pax headers for long names and large files).
namespace nonio::storage {

struct TarEntry {
  enum class Kind : char { file = '0', link = '2', folder = '5' };
  std::string name;  ///< relative path without a slash at its end
  Kind kind = Kind::file;
  unsigned mode = 0;         ///< permission bits
  std::uint64_t size = 0;    ///< size of a file in bytes
  std::int64_t changed = 0;  ///< time of the last change, seconds since 1970
  std::string target{};      ///< path to which a link leads
};

class TarWriter {
 public:
  static Expected<TarWriter> create(const std::filesystem::path& path);
  TarWriter(TarWriter&& other) noexcept;
  TarWriter& operator=(TarWriter&&) = delete;
  ~TarWriter();

  /// Adds an entry. `bytes` calls its argument with the parts of a file; an error if their total is
  /// not `entry.size`.
  using Parts = std::function<Expected<void>(const std::function<void(std::string_view)>& take)>;
  Expected<void> add(const TarEntry& entry, const Parts& bytes = {});
  std::int64_t position() const;
  /// Removes what was added after `position`.
  Expected<void> back_to(std::int64_t position);
  /// Completes the archive and writes it to disk.
  Expected<void> end();

 private:
  TarWriter(int fd, std::string name) : fd_(fd), name_(std::move(name)) {}
  Expected<void> write(std::string_view bytes) const;
  Expected<void> header(const TarEntry& entry, char type, const std::string& name) const;
  int fd_;
  std::string name_;
};

/// Functions that `read_tar` calls: `begin` for each entry, then `take` with the parts of its
/// bytes. `read_tar` returns an error if the file is not a tar archive, is incomplete, or contains
/// anything other than files, folders and links.
struct TarReads {
  std::function<Expected<void>(const TarEntry& entry)> begin;
  std::function<Expected<void>(std::string_view part)> take;
};
Expected<void> read_tar(const std::filesystem::path& path, const TarReads& reads);

}  // namespace nonio::storage
