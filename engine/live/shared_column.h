// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <sys/mman.h>

#include <algorithm>
#include <deque>
#include <memory>
#include <new>
#include <span>
#include <string>
#include <utility>

namespace nonio::live {

/// Numbers that a child writes and others read: one a reading of a part.
class SharedColumn {
 public:
  explicit SharedColumn(std::size_t size) : size_(size) {
    void* const at =
        ::mmap(nullptr, bytes(), PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0);
    if (at == MAP_FAILED) throw std::bad_alloc();
    data_ = static_cast<double*>(at);
  }
  SharedColumn(const SharedColumn&) = delete;
  SharedColumn& operator=(const SharedColumn&) = delete;
  ~SharedColumn() { ::munmap(data_, bytes()); }
  std::span<double> values() { return {data_, size_}; }

 private:
  std::size_t bytes() const { return std::max<std::size_t>(size_, 1) * sizeof(double); }
  std::size_t size_;
  double* data_ = nullptr;
};

/// What was fitted last of a part: the newest, by their trials.
class FittedBefore {
 public:
  std::shared_ptr<SharedColumn> find(const std::string& key) const {
    for (const auto& [known, residual] : all_)
      if (known == key) return residual;
    return nullptr;
  }
  void put(const std::string& key, std::shared_ptr<SharedColumn> residual) {
    std::erase_if(all_, [&](const auto& one) { return one.first == key; });
    all_.emplace_back(key, std::move(residual));
    if (all_.size() > most) all_.pop_front();
  }

 private:
  static constexpr std::size_t most = 8;  // steps to and fro; 8 MB each of 1,000,000 readings
  std::deque<std::pair<std::string, std::shared_ptr<SharedColumn>>> all_;
};

}  // namespace nonio::live
