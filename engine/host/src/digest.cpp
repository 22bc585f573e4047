// SPDX-License-Identifier: Apache-2.0
#include "nonio/host/digest.h"

#include <Poco/Crypto/DigestEngine.h>
#include <Poco/Crypto/OpenSSLInitializer.h>

namespace nonio::host {

std::string sha256(std::string_view bytes) {
  // Kept, because the last engine to go would shut OpenSSL down and the next one seed it anew.
  static const Poco::Crypto::OpenSSLInitializer open_ssl;
  Poco::Crypto::DigestEngine engine("SHA256");
  // In parts: the engine takes an unsigned length.
  constexpr std::size_t part = std::size_t{1} << 30;
  for (std::size_t i = 0; i < bytes.size(); i += part) {
    const std::string_view piece = bytes.substr(i, part);
    engine.update(piece.data(), static_cast<unsigned>(piece.size()));
  }
  return Poco::DigestEngine::digestToHex(engine.digest());
}

}  // namespace nonio::host
