// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <string>

#include "nonio/sdk/error.h"

namespace nonio::sign {

/// A request over plain HTTP. The answer is signed, so TLS is not needed.
struct Question {
  const char* query = nullptr;  ///< media type of the body; null for a request without body (GET)
  const char* reply = nullptr;  ///< required media type of the answer; null if any type is accepted
  std::string body{};
  std::size_t longest = 0;  ///< largest size of the answer in bytes
  int seconds = 10;
};

/// Sends the request and returns the body of the answer, which must be one ASN.1 element. `url` has
/// the form http://host[:port]/path.
Expected<std::string> ask_server(const std::string& url, const Question& question);

}  // namespace nonio::sign
