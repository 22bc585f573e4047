// SPDX-License-Identifier: Apache-2.0
#include <openssl/err.h>

#include <algorithm>

#include "key.h"
#include "time_stamp.h"

namespace nonio::sign {

namespace {

/// Returns the DER of a SET OF; DER requires sorted elements.
std::string set_of(std::vector<std::string> members) {
  std::sort(members.begin(), members.end());
  std::string content;
  for (const std::string& m : members) content += m;
  std::string head = "\x31";
  if (content.size() < 0x80) {
    head += static_cast<char>(content.size());
  } else {
    std::string length;
    for (std::size_t n = content.size(); n != 0; n >>= 8) length.insert(0, 1, static_cast<char>(n));
    head += static_cast<char>(0x80 | length.size());
    head += length;
  }
  return head + content;
}

std::string attributes_of(CMS_SignerInfo* signer) {
  std::vector<std::string> members;
  for (int i = 0; i < CMS_signed_get_attr_count(signer); ++i)
    members.push_back(der_of(CMS_signed_get_attr(signer, i), &i2d_X509_ATTRIBUTE));
  return set_of(std::move(members));
}

/// CMS_final is not used because it would add a signing time, which PAdES forbids (EN 319 142-1).
Expected<void> sign_attributes(const Key::Impl& key, CMS_SignerInfo* signer,
                               const std::string& digest) {
  if (CMS_signed_add1_attr_by_NID(signer, NID_pkcs9_contentType, V_ASN1_OBJECT,
                                  OBJ_nid2obj(NID_pkcs7_data), -1) != 1 ||
      CMS_signed_add1_attr_by_NID(signer, NID_pkcs9_messageDigest, V_ASN1_OCTET_STRING,
                                  digest.data(), static_cast<int>(digest.size())) != 1)
    return fail("no signature: " + reason());
  X509_ALGOR* algorithm = nullptr;
  CMS_SignerInfo_get0_algs(signer, nullptr, nullptr, nullptr, &algorithm);
  const bool rsa = EVP_PKEY_get_base_id(key.key.get()) == EVP_PKEY_RSA;
  X509_ALGOR_set0(algorithm, OBJ_nid2obj(rsa ? NID_rsaEncryption : NID_ecdsa_with_SHA256),
                  rsa ? V_ASN1_NULL : V_ASN1_UNDEF, nullptr);
  NONIO_TRY(const auto signature, key.sign_bytes(attributes_of(signer)));
  if (ASN1_STRING_set(CMS_SignerInfo_get0_signature(signer), signature.data(),
                      static_cast<int>(signature.size())) != 1)
    return fail("no signature: " + reason());
  return {};
}

Expected<void> add_time_stamp(CMS_SignerInfo* signer, const TimeStamping& stamping, Time now) {
  const auto token =
      ask_for_time_stamp(stamping, sha256(bytes_of(CMS_SignerInfo_get0_signature(signer))), now);
  if (!token) return fail(token.error());
  if (CMS_unsigned_add1_attr_by_NID(signer, NID_id_smime_aa_timeStampToken, V_ASN1_SEQUENCE,
                                    token->data(), static_cast<int>(token->size())) != 1)
    return fail(reason());
  return {};
}

}  // namespace

Expected<std::string> make_cms(const Key::Impl& key, std::string_view before,
                               std::string_view after, Time now, const TimeStamping& stamping,
                               std::string& no_time_stamp) {
  ERR_clear_error();
  const Borrowed chain(sk_X509_new_null());
  for (const CertificatePtr& c : key.chain) sk_X509_push(chain.get(), c.get());
  constexpr unsigned flags = CMS_DETACHED | CMS_BINARY | CMS_NOSMIMECAP | CMS_PARTIAL | CMS_CADES;
  const CmsPtr cms(CMS_sign(nullptr, nullptr, chain.get(), nullptr, flags));
  CMS_SignerInfo* signer =
      cms ? CMS_add1_signer(cms.get(), key.certificate.get(), key.key.get(), EVP_sha256(), flags)
          : nullptr;
  if (signer == nullptr) return fail("no signature: " + reason());
  if (auto done = sign_attributes(key, signer, sha256(before, after)); !done)
    return fail(done.error());
  if (!stamping.url.empty())
    if (auto stamped = add_time_stamp(signer, stamping, now); !stamped) {
      if (stamping.required) return fail("no time stamp: " + stamped.error().message);
      no_time_stamp = stamped.error().message;
    }
  std::string der = der_of(cms.get(), &i2d_CMS_ContentInfo);
  if (der.empty()) return fail("no signature: " + reason());
  return der;
}

}  // namespace nonio::sign
