// SPDX-License-Identifier: Apache-2.0
#include "platform/process/shared_status.h"

#include <sys/mman.h>
#include <unistd.h>

#include <algorithm>
#include <cstring>
#include <utility>

namespace nonio::process {

SharedStatus::SharedStatus() : SharedStatus(::memfd_create("words", MFD_CLOEXEC)) {}
SharedStatus::SharedStatus(int descriptor) : descriptor_(descriptor) {
  if (descriptor_ < 0 || ::ftruncate(descriptor_, size) != 0) return;
  void* data = ::mmap(nullptr, size, PROT_READ | PROT_WRITE, MAP_SHARED, descriptor_, 0);
  data_ = data == MAP_FAILED ? nullptr : static_cast<char*>(data);
}
SharedStatus::SharedStatus(SharedStatus&& other) noexcept
    : descriptor_(std::exchange(other.descriptor_, -1)),
      data_(std::exchange(other.data_, nullptr)) {}
SharedStatus& SharedStatus::operator=(SharedStatus&& other) noexcept {
  std::swap(descriptor_, other.descriptor_);
  std::swap(data_, other.data_);
  return *this;
}
SharedStatus::~SharedStatus() {
  if (data_ != nullptr) ::munmap(data_, size);
  if (descriptor_ >= 0) ::close(descriptor_);
}
void SharedStatus::set(const std::string& words_now) {
  const std::size_t n = std::min(words_now.size(), size - 1);
  std::memcpy(data_, words_now.data(), n);
  data_[n] = '\0';
}
std::string SharedStatus::get() const { return {data_, ::strnlen(data_, size)}; }

}  // namespace nonio::process
