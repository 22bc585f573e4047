// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdio>
#include <filesystem>
#include <memory>
#include <string_view>

#include "nonio/sdk/error.h"

namespace nonio::storage {

/// A text that may be too long for memory, in a file. An error while it is filled is returned by
/// `flush`, also of texts that were added to it.
class Spool {
 public:
  /// Of a path that is to stay.
  static Spool at(const std::filesystem::path& path);
  /// A file without a name, in a folder that no other process writes to.
  static Spool in(const std::filesystem::path& folder);

  void add(std::string_view text);
  void add(Spool& other);
  bool empty() const { return empty_; }
  /// Everything is on disk.
  Expected<void> flush();

 private:
  explicit Spool(int file);
  void check(bool well);

  std::unique_ptr<std::FILE, int (*)(std::FILE*)> file_;
  bool empty_ = true;
  int error_ = 0;  ///< errno of the first trouble
};

}  // namespace nonio::storage
