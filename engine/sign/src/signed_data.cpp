// SPDX-License-Identifier: Apache-2.0
#include "signed_data.h"

#include <openssl/err.h>
#include <openssl/ess.h>

#include <algorithm>
#include <array>

#include "der.h"

namespace nonio::sign {

using namespace std::string_view_literals;

namespace {

constexpr std::string_view oid_signed_data = "\x2a\x86\x48\x86\xf7\x0d\x01\x07\x02"sv;
constexpr std::string_view oid_data = "\x2a\x86\x48\x86\xf7\x0d\x01\x07\x01"sv;
constexpr std::string_view oid_tst_info = "\x2a\x86\x48\x86\xf7\x0d\x01\x09\x10\x01\x04"sv;
constexpr std::string_view oid_token = "\x2a\x86\x48\x86\xf7\x0d\x01\x09\x10\x02\x0e"sv;

tl::unexpected<Error> malformed(const char* where) {
  return fail(std::string("is not as a signature must be: ") + where);
}

std::string digest(const EVP_MD* kind, std::string_view one, std::string_view other) {
  std::array<char, EVP_MAX_MD_SIZE> out{};
  unsigned size = 0;
  const std::unique_ptr<EVP_MD_CTX, Freed<EVP_MD_CTX_free>> context(EVP_MD_CTX_new());
  EVP_DigestInit_ex(context.get(), kind, nullptr);
  EVP_DigestUpdate(context.get(), one.data(), one.size());
  EVP_DigestUpdate(context.get(), other.data(), other.size());
  EVP_DigestFinal_ex(context.get(), reinterpret_cast<unsigned char*>(out.data()), &size);
  return {out.data(), size};
}

}  // namespace

Expected<SignedData> SignedData::parse(std::string_view der, Content content) {
  ERR_clear_error();
  SignedData out;
  out.der_ = der;
  const unsigned char* at = data_of(out.der_);
  out.cms_.reset(d2i_CMS_ContentInfo(nullptr, &at, static_cast<long>(out.der_.size())));
  if (!out.cms_ || at != data_of(out.der_) + out.der_.size() ||
      OBJ_obj2nid(CMS_get0_type(out.cms_.get())) != NID_pkcs7_signed) {
    ERR_clear_error();
    return malformed("no CMS object");
  }
  STACK_OF(CMS_SignerInfo)* signers = CMS_get0_SignerInfos(out.cms_.get());
  if (signers == nullptr || sk_CMS_SignerInfo_num(signers) != 1)
    return malformed("expected one signer");
  out.signer_ = sk_CMS_SignerInfo_value(signers, 0);
  if (auto read = out.read_outside(content); !read) return fail(read.error());
  if (auto key = algorithm_of(X509_get0_pubkey(out.signer_certificate_), true); !key)
    return fail("was made with " + key.error().message);
  return out;
}

/// Also checks the unsigned parts (RFC 5652, 5.1), about which OpenSSL is lenient.
Expected<void> SignedData::read_outside(Content content) {
  const auto info = Der::only(der_, Der::sequence);
  if (!info || !Der::sound(der_)) return malformed("no DER");
  std::string_view rest = info->content;
  const auto type = Der::take(rest, Der::object);
  const auto wrapped = Der::only(rest, Der::context(0));
  const auto data = wrapped ? Der::only(wrapped->content, Der::sequence) : std::nullopt;
  if (!type || type->content != oid_signed_data || !data) return malformed("no SignedData");
  rest = data->content;
  const auto version = Der::take(rest, Der::integer);
  const auto digests = Der::take(rest, Der::set);
  const auto inner = Der::take(rest, Der::sequence);
  const auto certificates = Der::take(rest, Der::context(0));
  const auto signers = Der::only(rest, Der::set);
  if (!version || version->content != (content == Content::detached ? "\x01"sv : "\x03"sv))
    return malformed("the version");
  const auto algorithm = digests ? Der::only(digests->content, Der::sequence) : std::nullopt;
  digest_ = algorithm ? digest_of_algorithm(algorithm->content) : nullptr;
  if (digest_ == nullptr) return malformed("expected a digest by SHA-256, SHA-384 or SHA-512");
  if (!inner || !certificates || !signers)
    return malformed("expected content, certificates and signers, and no more");
  if (auto read = read_content(inner->content, content); !read) return read;
  if (auto read = read_certificates(certificates->content); !read) return read;
  const auto signer = Der::only(signers->content, Der::sequence);
  if (!signer) return malformed("expected one signer");
  return read_signer(signer->content, content);
}

Expected<void> SignedData::read_content(std::string_view text, Content content) {
  const auto type = Der::take(text, Der::object);
  if (content == Content::detached) {
    if (!type || type->content != oid_data || !text.empty())
      return malformed("expected a signature with its content");
    return {};
  }
  const auto wrapped = Der::only(text, Der::context(0));
  const auto octets = wrapped ? Der::only(wrapped->content, Der::octets) : std::nullopt;
  if (!type || type->content != oid_tst_info || !octets) return malformed("expected a time stamp");
  content_ = octets->content;
  return {};
}

Expected<void> SignedData::read_certificates(std::string_view text) {
  while (!text.empty()) {
    const auto one = Der::take(text, Der::sequence);
    if (!one || certificates_.size() >= 20) return malformed("expected plain certificates");
    const unsigned char* at = data_of(one->whole);
    CertificatePtr certificate(d2i_X509(nullptr, &at, static_cast<long>(one->whole.size())));
    if (!certificate || der_of(certificate.get()) != one->whole) {
      ERR_clear_error();
      return malformed("a certificate that cannot be read");
    }
    certificates_.push_back(std::move(certificate));
    certificate_ders_.push_back(one->whole);
  }
  return {};
}

/// Reads the SignerInfo (RFC 5652, 5.3) and checks its algorithms.
Expected<void> SignedData::read_signer(std::string_view text, Content content) {
  const auto version = Der::take(text, Der::integer);
  const auto identifier = Der::take(text, Der::sequence);
  const auto algorithm = Der::take(text, Der::sequence);
  const auto attributes = Der::take(text, Der::context(0));
  const auto signature_algorithm = Der::take(text, Der::sequence);
  const auto signature = Der::take(text, Der::octets);
  if (!version || version->content != "\x01"sv || !identifier)
    return malformed("expected a signer named by issuer and serial number");
  if (!algorithm || digest_of_algorithm(algorithm->content) != digest_)
    return malformed("two digests that differ");
  if (!attributes || !signature_algorithm || !signature)
    return malformed("expected signed attributes and a signature");
  if (!is_signature_algorithm(signature_algorithm->content, digest_))
    return malformed("expected a signature by RSA or ECDSA with that digest");
  signature_ = signature->content;
  if (auto read = read_unsigned(text, content); !read) return read;
  return find_certificate(identifier->content);
}

Expected<void> SignedData::read_unsigned(std::string_view text, Content content) {
  if (text.empty()) return {};
  const auto attributes = Der::only(text, Der::context(1));
  const auto attribute = attributes ? Der::only(attributes->content, Der::sequence) : std::nullopt;
  std::string_view rest = attribute ? attribute->content : std::string_view{};
  const auto type = Der::take(rest, Der::object);
  const auto values = Der::only(rest, Der::set);
  const auto token = values ? Der::only(values->content, Der::sequence) : std::nullopt;
  if (content != Content::detached || !type || type->content != oid_token || !token)
    return malformed("expected no unsigned attribute but one time stamp");
  token_ = token->whole;
  return {};
}

/// Issuer and serial number are compared byte by byte, because OpenSSL ignores case and spaces.
Expected<void> SignedData::find_certificate(std::string_view identifier) {
  for (std::size_t i = 0; i < certificates_.size(); ++i) {
    X509* c = certificates_[i].get();
    if (der_of(X509_get_issuer_name(c), &i2d_X509_NAME) +
            der_of(X509_get0_serialNumber(c), &i2d_ASN1_INTEGER) !=
        identifier)
      continue;
    signer_certificate_ = c;
    signer_der_ = certificate_ders_[i];
    CMS_SignerInfo_set1_signer_cert(signer_, c);
    return {};
  }
  return malformed("the signer's certificate is missing");
}

Expected<void> SignedData::check_attributes() const {
  std::array<int, 3> wanted{NID_pkcs9_contentType, NID_pkcs9_messageDigest,
                            NID_id_smime_aa_signingCertificateV2};
  for (int i = 0; i < CMS_signed_get_attr_count(signer_); ++i) {
    X509_ATTRIBUTE* one = CMS_signed_get_attr(signer_, i);
    const int kind = OBJ_obj2nid(X509_ATTRIBUTE_get0_object(one));
    const auto found = std::find(wanted.begin(), wanted.end(), kind);
    if (kind == NID_undef || found == wanted.end() || X509_ATTRIBUTE_count(one) != 1)
      return malformed(
          "expected the signed attributes content type, digest and certificate, once each and no "
          "others");
    *found = NID_undef;
  }
  return {};
}

Expected<void> SignedData::check_signature(std::string_view before, std::string_view after) const {
  ERR_clear_error();
  const auto* type = static_cast<const ASN1_OBJECT*>(
      CMS_signed_get0_data_by_OBJ(signer_, OBJ_nid2obj(NID_pkcs9_contentType), -3, V_ASN1_OBJECT));
  if (type == nullptr || OBJ_cmp(type, CMS_get0_eContentType(cms_.get())) != 0)
    return malformed("the signed content type");
  const auto* said = static_cast<const ASN1_STRING*>(CMS_signed_get0_data_by_OBJ(
      signer_, OBJ_nid2obj(NID_pkcs9_messageDigest), -3, V_ASN1_OCTET_STRING));
  if (said == nullptr) return malformed("the signed digest");
  if (bytes_of(said) != digest(digest_, before, after))
    return fail("does not fit the content: it was changed after it was signed");
  if (CMS_SignerInfo_verify(signer_) != 1) {
    ERR_clear_error();
    return fail("was not made with the key of its certificate, or is damaged");
  }
  return {};
}

Expected<void> SignedData::check_certificate_named() const {
  const auto attribute = [&](int nid) {
    return bytes_of(static_cast<const ASN1_STRING*>(
        CMS_signed_get0_data_by_OBJ(signer_, OBJ_nid2obj(nid), -3, V_ASN1_SEQUENCE)));
  };
  // RFC 5035: SEQUENCE { SEQUENCE OF ESSCertIDv2 { algorithm (default SHA-256), hash, ... } }
  std::string_view text = attribute(NID_id_smime_aa_signingCertificateV2);
  const EVP_MD* kind = EVP_sha256();
  // Time stamps may use the first version of the attribute, with SHA-1.
  if (text.empty() && !content_.empty()) {
    text = attribute(NID_id_smime_aa_signingCertificate);
    kind = EVP_sha1();
  }
  const auto outer = Der::only(text, Der::sequence);
  std::string_view rest = outer ? outer->content : std::string_view{};
  const auto list = Der::take(rest, Der::sequence);
  rest = list ? list->content : std::string_view{};
  const auto first = Der::take(rest, Der::sequence);
  rest = first ? first->content : std::string_view{};
  if (const auto algorithm = Der::take(rest, Der::sequence))
    kind = digest_of_algorithm(algorithm->content);
  const auto hash = Der::take(rest, Der::octets);
  if (!hash || kind == nullptr) return fail("does not name its certificate in what is signed");
  if (hash->content != digest(kind, signer_der_, {}))
    return fail("names another certificate than the one it contains");
  return {};
}

}  // namespace nonio::sign
