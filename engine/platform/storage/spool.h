// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdio>
#include <filesystem>
#include <memory>
#include <string_view>

#include "nonio/sdk/error.h"

namespace nonio::storage {

/// Writes a text that may exceed the memory to a file. `flush` returns the first error of all
/// calls.
class Spool {
 public:
  /// Creates a permanent file.
  static Spool at(const std::filesystem::path& path);
  /// Creates an unnamed temporary file in a folder to which no other process writes.
  static Spool in(const std::filesystem::path& folder);

  void add(std::string_view text);
  void add(Spool& other);
  bool empty() const { return empty_; }
  Expected<void> flush();

 private:
  explicit Spool(int file);
  void check(bool well);

  std::unique_ptr<std::FILE, int (*)(std::FILE*)> file_;
  bool empty_ = true;
  int error_ = 0;  ///< errno of the first error, otherwise 0
};

}  // namespace nonio::storage
