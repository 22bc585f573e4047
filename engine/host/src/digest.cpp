// SPDX-License-Identifier: Apache-2.0
#include "nonio/host/digest.h"

#include <Poco/Crypto/DigestEngine.h>
#include <Poco/Crypto/OpenSSLInitializer.h>

#include "nonio/host/files.h"

namespace nonio::host {

namespace {

class Sha256 {
 public:
  void add(std::string_view bytes) {
    // In parts: the engine takes an unsigned length.
    constexpr std::size_t part = std::size_t{1} << 30;
    for (std::size_t i = 0; i < bytes.size(); i += part) {
      const std::string_view piece = bytes.substr(i, part);
      engine_.update(piece.data(), static_cast<unsigned>(piece.size()));
    }
  }
  std::string hex() { return Poco::DigestEngine::digestToHex(engine_.digest()); }

 private:
  static Poco::Crypto::DigestEngine make() {
    // Kept, because the last engine to go would shut OpenSSL down and the next one seed it anew.
    static const Poco::Crypto::OpenSSLInitializer open_ssl;
    return Poco::Crypto::DigestEngine("SHA256");
  }
  Poco::Crypto::DigestEngine engine_ = make();
};

}  // namespace

std::string sha256(std::string_view bytes) {
  Sha256 digest;
  digest.add(bytes);
  return digest.hex();
}

Expected<std::string> sha256_of_file(const std::filesystem::path& path,
                                     const std::function<void()>& after_each_part) {
  Sha256 digest;
  const auto read = read_parts(path, [&](std::string_view part) {
    digest.add(part);
    if (after_each_part) after_each_part();
  });
  if (!read) return fail(read.error());
  return digest.hex();
}

}  // namespace nonio::host
