// SPDX-License-Identifier: Apache-2.0
#include "platform/storage/disk.h"

#include <fcntl.h>
#include <sys/mman.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <new>

namespace nonio::storage {

Disk::Disk(const std::filesystem::path& folder) : folder_(folder) {
  void* shared =
      ::mmap(nullptr, sizeof *losses_, PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0);
  if (shared == MAP_FAILED) {
    trouble_ = errno;
    return;
  }
  losses_ = new (shared) std::atomic<std::uint32_t>(0);
  fd_ = ::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  if (fd_ < 0) trouble_ = errno;
}

Disk::~Disk() {
  if (fd_ >= 0) ::close(fd_);
  if (losses_ != nullptr) ::munmap(losses_, sizeof *losses_);
}

Expected<void> Disk::flush() const {
  int code = trouble_;
  while (code == 0 && ::syncfs(fd_) != 0)
    if (errno != EINTR) code = errno;
  if (code == 0) return {};
  if (losses_ != nullptr) ++*losses_;
  return fail("cannot flush the disk of " + folder_.string() + ": " + std::strerror(code));
}

}  // namespace nonio::storage
