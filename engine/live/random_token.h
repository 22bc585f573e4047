// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <sys/random.h>

#include <array>
#include <cerrno>
#include <cstring>
#include <string>

#include "nonio/sdk/error.h"

namespace nonio::live {

inline constexpr std::size_t token_digits = 32;

inline Expected<std::string> random_token() {
  std::array<unsigned char, token_digits / 2> bits{};
  if (::getrandom(bits.data(), bits.size(), 0) != static_cast<ssize_t>(bits.size()))
    return fail(std::string("no random numbers: ") + std::strerror(errno));
  std::string token;
  for (const unsigned char byte : bits) {
    constexpr const char* hex = "0123456789abcdef";
    token += hex[byte >> 4];
    token += hex[byte & 15];
  }
  return token;
}

}  // namespace nonio::live
