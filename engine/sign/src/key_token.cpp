// SPDX-License-Identifier: Apache-2.0
// Opens a key in a PKCS#11 token. The OpenSSL engine is used because Debian 12 does not contain the
// provider that replaces it.
#define OPENSSL_SUPPRESS_DEPRECATED
#include <openssl/engine.h>
#include <openssl/err.h>
#include <openssl/ui.h>

#include "key.h"

namespace nonio::sign {

namespace {

void finish(ENGINE* engine) { ENGINE_finish(engine); }
using EnginePtr = std::unique_ptr<ENGINE, Freed<ENGINE_free>>;
using RunningPtr = std::unique_ptr<ENGINE, Freed<finish>>;

CertificatePtr load_certificate(ENGINE* engine, const std::string& uri) {
  struct {
    const char* uri;
    X509* certificate;
  } request{uri.c_str(), nullptr};
  ENGINE_ctrl_cmd(engine, "LOAD_CERT_CTRL", 0, &request, nullptr, 1);
  return CertificatePtr(request.certificate);
}

}  // namespace

Expected<Key::Impl> open_token(const KeyPlace& place, const std::string& password) {
  // Without a PIN the engine would prompt for one on the terminal.
  if (password.empty()) return fail("the token " + place.pkcs11 + " needs a PIN");
  OPENSSL_init_crypto(OPENSSL_INIT_ENGINE_DYNAMIC, nullptr);
  ERR_clear_error();
  const EnginePtr engine(ENGINE_by_id("pkcs11"));
  if (!engine)
    return fail(
        "OpenSSL has no engine for PKCS#11 tokens; expected the package libengine-pkcs11-openssl");
  if (ENGINE_ctrl_cmd_string(engine.get(), "MODULE_PATH", place.module.c_str(), 0) != 1 ||
      ENGINE_ctrl_cmd_string(engine.get(), "PIN", password.c_str(), 0) != 1 ||
      ENGINE_init(engine.get()) != 1)
    return fail("the token library " + place.module + " does not start: " + reason());
  const RunningPtr running(engine.get());
  Key::Impl impl;
  impl.key.reset(ENGINE_load_private_key(engine.get(), place.pkcs11.c_str(),
                                         const_cast<UI_METHOD*>(UI_null()), nullptr));
  if (!impl.key)
    return fail("the token gives no private key for " + place.pkcs11 +
                ": wrong PIN, or no such object");
  impl.certificate = load_certificate(engine.get(), place.pkcs11);
  if (!impl.certificate) return fail("the token gives no certificate for " + place.pkcs11);
  return impl;
}

}  // namespace nonio::sign
