// SPDX-License-Identifier: Apache-2.0
#include "spool.h"

#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstring>

namespace nonio::host {
namespace fs = std::filesystem;

Spool::Spool(std::FILE* file) : file_(file, &std::fclose) { check(file != nullptr); }

void Spool::check(bool well) {
  if (!well && error_ == 0) error_ = errno;
}

Spool Spool::at(const fs::path& path) { return Spool(std::fopen(path.c_str(), "w+e")); }

Spool Spool::in(const fs::path& folder) {
  const fs::path path = folder / "list.nonio-tmp";
  Spool spool = at(path);
  ::unlink(path.c_str());
  return spool;
}

void Spool::add(std::string_view text) {
  empty_ = empty_ && text.empty();
  if (error_ == 0) check(std::fwrite(text.data(), 1, text.size(), file_.get()) == text.size());
}

void Spool::add(Spool& other) {
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

}  // namespace nonio::host
