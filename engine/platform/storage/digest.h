// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <string>
#include <string_view>

#include "nonio/sdk/error.h"

namespace nonio::storage {

class RunningDigest {
 public:
  RunningDigest();
  ~RunningDigest();
  RunningDigest(const RunningDigest&) = delete;
  RunningDigest& operator=(const RunningDigest&) = delete;
  void add(std::string_view bytes);
  std::string hex();  ///< lower-case hexadecimal SHA-256; call it once, at the end

 private:
  struct State;
  std::unique_ptr<State> state_;
};

/// Returns the SHA-256 in lower-case hexadecimal.
std::string sha256(std::string_view bytes);
/// RFC 2104, in lower-case hexadecimal.
std::string hmac_sha256(std::string_view key, std::string_view bytes);
/// `after_each_part` is called repeatedly while a long file is read, for callers that must show
/// signs of life.
Expected<std::string> sha256_of_file(const std::filesystem::path& path,
                                     const std::function<void()>& after_each_part = {});

/// Returns the first 64 bits of a hexadecimal SHA-256, to save memory in long lists.
std::uint64_t short_digest(std::string_view sha256);

}  // namespace nonio::storage
