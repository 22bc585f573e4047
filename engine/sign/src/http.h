// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <string>

#include "nonio/sdk/error.h"

namespace nonio::sign {

/// A question over plain HTTP. The answer is signed, so that it needs no TLS.
struct Question {
  const char* query = nullptr;  ///< media type of the body; null: there is no body (GET)
  const char* reply = nullptr;  ///< media type that is required; null: any
  std::string body{};
  std::size_t longest = 0;  ///< bytes that the answer may have
  int seconds = 10;
};

/// The answer's bytes, one element of ASN.1. `url`: http://host[:port]/path
Expected<std::string> ask_server(const std::string& url, const Question& question);

}  // namespace nonio::sign
