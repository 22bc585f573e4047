// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <string>

namespace nonio::process {

/// Text in shared memory that describes the present work of a child process. The parent can read it
/// after the child has ended.
class SharedStatus {
 public:
  SharedStatus();
  explicit SharedStatus(int descriptor);
  SharedStatus(const SharedStatus&) = delete;
  SharedStatus(SharedStatus&& other) noexcept;
  SharedStatus& operator=(SharedStatus&& other) noexcept;
  ~SharedStatus();
  bool valid() const { return data_ != nullptr; }
  void set(const std::string& words_now);
  std::string get() const;
  int descriptor() const { return descriptor_; }

 private:
  static constexpr std::size_t size = 4096;
  int descriptor_;
  char* data_ = nullptr;
};

}  // namespace nonio::process
