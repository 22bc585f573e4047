// SPDX-License-Identifier: Apache-2.0
#include "platform/storage/spool.h"

#include <fcntl.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstring>
#include <string>

namespace nonio::storage {
namespace fs = std::filesystem;

Spool::Spool(int file) : file_(file < 0 ? nullptr : ::fdopen(file, "w+"), &std::fclose) {
  check(file_ != nullptr);
  if (file_ == nullptr && file >= 0) ::close(file);
}

void Spool::check(bool well) {
  if (!well && error_ == 0) error_ = errno == 0 ? EIO : errno;
}

Spool Spool::at(const fs::path& path) {
  return Spool(::open(path.c_str(), O_RDWR | O_CREAT | O_TRUNC | O_NOFOLLOW | O_CLOEXEC, 0644));
}

Spool Spool::in(const fs::path& folder) {
  const int unnamed = ::open(folder.c_str(), O_RDWR | O_TMPFILE | O_CLOEXEC, 0600);
  if (unnamed >= 0 || (errno != EOPNOTSUPP && errno != EISDIR && errno != ENOENT))
    return Spool(unnamed);
  // The file system does not support O_TMPFILE.
  std::string name = (folder / ".list-XXXXXX.nonio-tmp").string();
  const int file = ::mkostemps(name.data(), static_cast<int>(std::strlen(".nonio-tmp")), O_CLOEXEC);
  Spool spool(file);
  if (file >= 0) spool.check(::unlink(name.c_str()) == 0);
  return spool;
}

void Spool::add(std::string_view text) {
  empty_ = empty_ && text.empty();
  if (error_ == 0) check(std::fwrite(text.data(), 1, text.size(), file_.get()) == text.size());
}

void Spool::add(Spool& other) {
  if (other.error_ == 0) other.check(std::fflush(other.file_.get()) == 0);
  if (other.error_ == 0) other.check(std::fseek(other.file_.get(), 0, SEEK_SET) == 0);
  std::array<char, 1 << 16> part;
  for (std::size_t n = 1; other.error_ == 0 && n != 0;) {
    n = std::fread(part.data(), 1, part.size(), other.file_.get());
    other.check(n != 0 || std::ferror(other.file_.get()) == 0);
    add({part.data(), n});
  }
  if (error_ == 0) error_ = other.error_;
}

Expected<void> Spool::flush() {
  if (error_ == 0) check(std::fflush(file_.get()) == 0 && ::fsync(::fileno(file_.get())) == 0);
  if (error_ == 0) return {};
  return fail(std::strerror(error_));
}

}  // namespace nonio::storage
