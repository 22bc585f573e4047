// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <openssl/evp.h>

#include <string>
#include <vector>

namespace nonio::fixtures {

/// "sha256-..." as Content-Security-Policy has it (CSP level 3, 2.3.1).
inline std::string policy_digest(const std::string& text) {
  unsigned char digest[EVP_MAX_MD_SIZE], letters[2 * EVP_MAX_MD_SIZE];
  unsigned size = 0;
  if (EVP_Digest(text.data(), text.size(), digest, &size, EVP_sha256(), nullptr) != 1) return "";
  const int written = EVP_EncodeBlock(letters, digest, static_cast<int>(size));
  return "sha256-" + std::string(letters, letters + written);
}

/// The styles and scripts of a page that a browser does not use, since its policy names others.
inline std::vector<std::string> refused_by_policy(const std::string& page) {
  std::vector<std::string> out;
  for (const std::string name : {"style", "script"}) {
    const std::string begin = "<" + name + ">", end = "</" + name + ">";
    for (std::size_t at = page.find(begin); at != std::string::npos;
         at = page.find(begin, at + 1)) {
      const std::size_t first = at + begin.size();
      const std::string inside = page.substr(first, page.find(end, first) - first);
      const std::size_t source = page.find(name + "-src ");
      const std::string allowed =
          source == std::string::npos ? "" : page.substr(source, page.find(';', source) - source);
      if (allowed.find("'" + policy_digest(inside) + "'") == std::string::npos)
        out.push_back(name + ": " + inside.substr(0, 40));
    }
  }
  return out;
}

}  // namespace nonio::fixtures
