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

/// SHA-256 of what is added, part by part, in lower-case hexadecimal.
class RunningDigest {
 public:
  RunningDigest();
  ~RunningDigest();
  RunningDigest(const RunningDigest&) = delete;
  RunningDigest& operator=(const RunningDigest&) = delete;
  void add(std::string_view bytes);
  std::string hex();  ///< once, in the end

 private:
  struct State;
  std::unique_ptr<State> state_;
};

/// SHA-256 in lower-case hexadecimal.
std::string sha256(std::string_view bytes);
/// HMAC of SHA-256 (RFC 2104), the same way.
std::string hmac_sha256(std::string_view key, std::string_view bytes);
/// `after_each_part`: called while a long file is read, for who waits for signs of life.
Expected<std::string> sha256_of_file(const std::filesystem::path& path,
                                     const std::function<void()>& after_each_part = {});

/// The first 64 bits of a SHA-256 in hexadecimal digits: there may be very many.
std::uint64_t short_digest(std::string_view sha256);

}  // namespace nonio::storage
