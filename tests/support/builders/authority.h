// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <openssl/evp.h>
#include <openssl/x509.h>

#include <filesystem>
#include <functional>
#include <memory>
#include <string>

#include "nonio/sign/sign.h"

namespace nonio::sign_tests {

/// 2026-11-21: nothing here looks at a clock.
inline constexpr sign::Time now = 1795219200;
inline constexpr sign::Time day = 86400;

struct Holder {
  std::shared_ptr<EVP_PKEY> key;
  std::shared_ptr<X509> certificate;
};

struct Wish {
  std::string name = "Ada Bianchi";
  std::string key = "P-256";  ///< or "RSA-3072", "RSA-1024", "Ed25519"
  std::string usage = "critical,digitalSignature,nonRepudiation";
  std::string extended = "1.3.6.1.5.5.7.3.36,emailProtection";
  std::string constraints = "critical,CA:FALSE";
  sign::Time from = now - 100 * day, to = now + 300 * day;
};

/// By itself if there is no issuer.
Holder issue(const Wish& wish, const Holder* issuer = nullptr);
Holder authority(const std::string& name = "Test Root");
Wish time_server_wish();
/// The same key under a certificate made for another name.
Holder renamed(const Holder& holder, const Wish& wish, const Holder& issuer);

std::string pem(const Holder& holder);
/// A revocation list of the issuer that names this certificate, or is empty.
struct ListWish {
  sign::Time when = 0;  ///< revoked
  int reason = -1;      ///< of RFC 5280, 5.3.1; negative: none is stated
  sign::Time invalid = 0;
  sign::Time made = now, next = now + 30 * day;  ///< next 0: not stated
  bool is_delta = false;
};
std::string revocation_list(const Holder& issuer, const Holder* revoked, const ListWish& wish);
inline std::string revocation_list(const Holder& issuer, const Holder* revoked, sign::Time when) {
  ListWish wish;
  wish.when = when;
  return revocation_list(issuer, revoked, wish);
}

/// An answer by OCSP (DER) of the issuer about one of his certificates; `when` 0: it is good.
std::string ocsp_answer(const Holder& issuer, const Holder& about, const ListWish& wish);

/// A folder that goes away with the object.
class Folder {
 public:
  Folder();
  ~Folder();
  Folder(const Folder&) = delete;
  Folder& operator=(const Folder&) = delete;
  std::string file(const std::string& name) const { return (path_ / name).string(); }
  std::string write(const std::string& name, const std::string& bytes) const;

 private:
  std::filesystem::path path_;
};

inline constexpr const char* password = "correct horse";
/// A PKCS#12 file with the holder's key and certificate, and that of the issuer.
std::string pkcs12(const Folder& folder, const Holder& holder, const Holder& issuer);
sign::Key open(const Holder& holder, const Holder& issuer);

/// A PDF of one page as libharu would write it; `of_page`: more lines of its dictionary.
std::string small_pdf(const std::string& text = "E = 4.5 um", const std::string& of_page = "");

}  // namespace nonio::sign_tests
