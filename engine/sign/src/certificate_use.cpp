// SPDX-License-Identifier: Apache-2.0
#include "certificate_use.h"

#include <openssl/x509v3.h>

namespace nonio::sign {

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
