// SPDX-License-Identifier: Apache-2.0
#include "key.h"

#include <openssl/err.h>
#include <openssl/pkcs12.h>
#include <openssl/x509v3.h>

#include <fstream>
#include <iterator>
#include <utility>

#include "nonio/pdf/signature_field.h"
#include "signed_data.h"

namespace nonio::sign {

namespace {

Expected<std::string> read(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  std::string bytes((std::istreambuf_iterator<char>(file)), std::istreambuf_iterator<char>());
  if (!file.is_open() || file.bad()) return fail("cannot read " + path);
  return bytes;
}

Expected<Key::Impl> open_pkcs12(const std::string& path, const std::string& password) {
  NONIO_TRY(const auto bytes, read(path));
  ERR_clear_error();
  const unsigned char* at = data_of(bytes);
  const std::unique_ptr<PKCS12, Freed<PKCS12_free>> file(
      d2i_PKCS12(nullptr, &at, static_cast<long>(bytes.size())));
  if (!file) return fail(path + " is no PKCS#12 file: " + reason());
  EVP_PKEY* key = nullptr;
  X509* certificate = nullptr;
  STACK_OF(X509)* others = nullptr;
  if (PKCS12_parse(file.get(), password.c_str(), &key, &certificate, &others) != 1) {
    const bool old = ERR_GET_REASON(ERR_peek_last_error()) == ERR_R_UNSUPPORTED;
    ERR_clear_error();
    if (old)
      return fail(path +
                  " is protected in a way that is too old (RC2 or 3DES); make it anew with openssl "
                  "pkcs12 -export");
    return fail(path + " cannot be opened: wrong password, or a damaged file");
  }
  Key::Impl impl{PrivateKeyPtr(key), CertificatePtr(certificate), {}};
  const Owned owned(others);
  for (int i = 0; others != nullptr && i < sk_X509_num(others); ++i) {
    X509_up_ref(sk_X509_value(others, i));
    impl.chain.emplace_back(sk_X509_value(others, i));
  }
  if (!impl.key || !impl.certificate)
    return fail(path + " holds no private key with its certificate");
  return impl;
}

/// Verifiers have their own copies of the roots, so that the signed files need not contain them.
void leave_roots_out(std::vector<CertificatePtr>& chain) {
  std::erase_if(chain, [](const CertificatePtr& c) {
    return (X509_get_extension_flags(c.get()) & EXFLAG_SS) != 0;
  });
}

Expected<void> check(Key::Impl& impl, Time now) {
  X509* certificate = impl.certificate.get();
  auto algorithm = algorithm_of(impl.key.get(), false);
  if (!algorithm) return fail("the signing key is " + algorithm.error().message);
  if (X509_check_private_key(certificate, impl.key.get()) != 1) {
    ERR_clear_error();
    return fail("the signing key does not belong to the certificate");
  }
  impl.identity = {subject_of(certificate), hex(sha256(der_of(certificate))), std::move(*algorithm),
                   time_of(X509_get0_notBefore(certificate)),
                   time_of(X509_get0_notAfter(certificate))};
  if (now < impl.identity.not_before)
    return fail("the signing certificate is not valid before " + text_of(impl.identity.not_before));
  if (now > impl.identity.not_after)
    return fail("the signing certificate ran out on " + text_of(impl.identity.not_after));
  if (auto fit = check_signer_use(certificate); !fit)
    return fail("the signing certificate " + fit.error().message);
  return {};
}

}  // namespace

Key::Key(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
Key::Key(Key&&) noexcept = default;
Key::~Key() = default;
const Identity& Key::identity() const { return impl_->identity; }

Expected<Key> Key::open(const KeyPlace& place, const std::string& password, Time now) {
  auto impl =
      place.pkcs12.empty() ? open_token(place, password) : open_pkcs12(place.pkcs12, password);
  if (!impl) return fail(impl.error());
  if (!place.certificates.empty()) {
    NONIO_TRY(const auto pem, read(place.certificates));
    auto more = certificates_of(pem);
    if (!more) return fail(place.certificates + " " + more.error().message);
    std::move(more->begin(), more->end(), std::back_inserter(impl->chain));
  }
  leave_roots_out(impl->chain);
  impl->chain = way_up(impl->certificate.get(), std::move(impl->chain));
  if (auto sound = check(*impl, now); !sound) return fail(sound.error());
  return Key(std::make_unique<Impl>(std::move(*impl)));
}

Expected<std::string> Key::Impl::sign_bytes(std::string_view bytes) const {
  ERR_clear_error();
  const std::unique_ptr<EVP_MD_CTX, Freed<EVP_MD_CTX_free>> context(EVP_MD_CTX_new());
  std::size_t size = 0;
  if (EVP_DigestSignInit(context.get(), nullptr, EVP_sha256(), nullptr, key.get()) != 1 ||
      EVP_DigestSign(context.get(), nullptr, &size, data_of(bytes), bytes.size()) != 1)
    return fail("the key did not sign: " + reason());
  std::string signature(size, '\0');
  if (EVP_DigestSign(context.get(), reinterpret_cast<unsigned char*>(signature.data()), &size,
                     data_of(bytes), bytes.size()) != 1)
    return fail("the key did not sign: " + reason());
  signature.resize(size);
  return signature;
}

namespace {

Expected<Signed> sign_pdf(const Key::Impl& key, std::string bytes, Time now,
                          const TimeStamping& stamping) {
  // The signature is found by its position at the end, because this process, which holds the key,
  // must not parse the PDF; `pdf::reserve` has parsed it already.
  const auto place = pdf::signature_at_end(bytes);
  if (!place) return fail("is not prepared for a signature: " + place.error().message);
  if (place->contents.find_first_not_of('0') != std::string_view::npos)
    return fail("is signed already");
  Signed out;
  NONIO_TRY(const auto cms,
            make_cms(key, place->before, place->after, now, stamping, out.no_time_stamp));
  if (cms.size() > place->room())
    return fail("the signature has " + std::to_string(cms.size()) +
                " bytes and does not fit into " + std::to_string(place->room()));
  if (bytes.size() > pdf::max_file) return fail(too_large);
  bytes.replace(place->gap + 1, 2 * cms.size(), hex(cms));
  out.bytes = std::move(bytes);
  return out;
}

}  // namespace

Expected<Signed> Key::sign(std::string bytes, Time now, const TimeStamping& stamping) const {
  if (bytes.starts_with("%PDF-")) return sign_pdf(*impl_, std::move(bytes), now, stamping);
  if (!bytes.starts_with("<?xml")) return fail("is neither a PDF nor an XML document");
  return sign_xml(*impl_, bytes, now, stamping);
}

Expected<void> check_signer_use(X509* certificate) {
  // OpenSSL returns all bits if the certificate has no key usage.
  if ((X509_get_key_usage(certificate) & (KU_DIGITAL_SIGNATURE | KU_NON_REPUDIATION)) == 0)
    return fail("is not for signatures: key usage has neither digitalSignature nor nonRepudiation");
  const std::unique_ptr<EXTENDED_KEY_USAGE, Freed<EXTENDED_KEY_USAGE_free>> uses(
      static_cast<EXTENDED_KEY_USAGE*>(
          X509_get_ext_d2i(certificate, NID_ext_key_usage, nullptr, nullptr)));
  if (!uses) return {};
  // id-kp-documentSigning (RFC 9336), for which OpenSSL 3.0 has no NID.
  const std::unique_ptr<ASN1_OBJECT, Freed<ASN1_OBJECT_free>> document_signing(
      OBJ_txt2obj("1.3.6.1.5.5.7.3.36", 1));
  for (int i = 0; i < sk_ASN1_OBJECT_num(uses.get()); ++i) {
    const ASN1_OBJECT* use = sk_ASN1_OBJECT_value(uses.get(), i);
    const int nid = OBJ_obj2nid(use);
    if (nid == NID_email_protect || nid == NID_anyExtendedKeyUsage ||
        OBJ_cmp(use, document_signing.get()) == 0)
      return {};
  }
  return fail(
      "is not for documents: its extended key usage has neither documentSigning nor "
      "emailProtection");
}

}  // namespace nonio::sign
