// SPDX-License-Identifier: Apache-2.0
// XML-DSig, enveloped, over the whole document, with exclusive canonicalisation.
#include <libxml/c14n.h>
#include <libxml/parser.h>
#include <libxml/tree.h>
#include <openssl/bn.h>
#include <openssl/ecdsa.h>
#include <xmlsec/crypto.h>
#include <xmlsec/errors.h>
#include <xmlsec/openssl/evp.h>
#include <xmlsec/templates.h>
#include <xmlsec/xmldsig.h>
#include <xmlsec/xmlsec.h>
#include <xmlsec/xmltree.h>

#include "key.h"
#include "pdf_signature.h"
#include "verify_parts.h"
#include "xml_document.h"

namespace nonio::sign {

namespace {

using ContextPtr = std::unique_ptr<xmlSecDSigCtx, Freed<xmlSecDSigCtxDestroy>>;
using XmlKeyPtr = std::unique_ptr<xmlSecKey, Freed<xmlSecKeyDestroy>>;

const xmlChar* xml(const char* text) { return reinterpret_cast<const xmlChar*>(text); }

/// Once in a process: that is how xmlsec wants it.
bool started() {
  static const bool well = [] {
    xmlInitParser();
    const bool all_well =
        xmlSecInit() == 0 && xmlSecCryptoAppInit(nullptr) == 0 && xmlSecCryptoInit() == 0;
    // What goes wrong is told by what is returned, not on the terminal.
    xmlSecErrorsSetCallback(nullptr);
    return all_well;
  }();
  return well;
}

/// xmlsec's own, of a public key.
Expected<XmlKeyPtr> key_of(EVP_PKEY* pkey) {
  EVP_PKEY_up_ref(pkey);
  xmlSecKeyDataPtr value = xmlSecOpenSSLEvpKeyAdopt(pkey);
  XmlKeyPtr key(xmlSecKeyCreate());
  if (value == nullptr || !key || xmlSecKeySetValue(key.get(), value) != 0)
    return fail("the key cannot be used for XML");
  return key;
}

xmlNode* add_template(xmlDoc* document, bool with_rsa) {
  xmlNode* signature = xmlSecTmplSignatureCreate(
      document, xmlSecTransformExclC14NId,
      with_rsa ? xmlSecTransformRsaSha256Id : xmlSecTransformEcdsaSha256Id, nullptr);
  if (signature == nullptr) return nullptr;
  xmlAddChild(xmlDocGetRootElement(document), signature);
  xmlNode* reference = xmlSecTmplSignatureAddReference(signature, xmlSecTransformSha256Id, nullptr,
                                                       xml(""), nullptr);
  xmlNode* key_info = xmlSecTmplSignatureEnsureKeyInfo(signature, nullptr);
  xmlNode* data = key_info == nullptr ? nullptr : xmlSecTmplKeyInfoAddX509Data(key_info);
  const bool well = reference != nullptr && data != nullptr &&
                    xmlSecTmplReferenceAddTransform(reference, xmlSecTransformEnvelopedId) &&
                    xmlSecTmplReferenceAddTransform(reference, xmlSecTransformExclC14NId);
  return well ? signature : nullptr;
}

}  // namespace

Expected<DocumentPtr> parse_xml(std::string_view bytes) {
  if (!started()) return fail("xmlsec does not start");
  if (bytes.size() > max_file) return fail("is larger than 500 MB");
  DocumentPtr document(xmlReadMemory(bytes.data(), static_cast<int>(bytes.size()), "document.xml",
                                     nullptr,
                                     XML_PARSE_NONET | XML_PARSE_NOERROR | XML_PARSE_NOWARNING));
  if (!document || xmlDocGetRootElement(document.get()) == nullptr)
    return fail("is not well-formed XML");
  if (document->intSubset != nullptr || document->extSubset != nullptr)
    return fail("has a document type: wanted none");
  return document;
}

namespace {

/// Of the whole document, or of one element and what is in it.
std::string canonical(xmlDoc* document, const xmlNode* only) {
  const auto visible = [](void* top, xmlNode* node, xmlNode* parent) {
    const bool has_parent = node != nullptr && node->type != XML_NAMESPACE_DECL;
    for (const xmlNode* n = has_parent ? node : parent; n != nullptr; n = n->parent)
      if (n == top) return 1;
    return top == nullptr ? 1 : 0;
  };
  xmlOutputBuffer* buffer = xmlAllocOutputBuffer(nullptr);
  std::string out;
  if (buffer != nullptr && xmlC14NExecute(document, visible, const_cast<xmlNode*>(only),
                                          XML_C14N_EXCLUSIVE_1_0, nullptr, 0, buffer) >= 0)
    out.assign(reinterpret_cast<const char*>(xmlOutputBufferGetContent(buffer)),
               xmlOutputBufferGetSize(buffer));
  if (buffer != nullptr) xmlOutputBufferClose(buffer);
  return out;
}

std::string base64(std::string_view bytes) {
  std::string out((bytes.size() + 2) / 3 * 4 + 1, '\0');
  out.resize(
      static_cast<std::size_t>(EVP_EncodeBlock(reinterpret_cast<unsigned char*>(out.data()),
                                               data_of(bytes), static_cast<int>(bytes.size()))));
  return out;
}

/// XML wants r and s side by side where ECDSA gives a sequence of two numbers (RFC 4050).
Expected<std::string> side_by_side(const std::string& der, std::size_t size) {
  const unsigned char* at = data_of(der);
  const std::unique_ptr<ECDSA_SIG, Freed<ECDSA_SIG_free>> pair(
      d2i_ECDSA_SIG(nullptr, &at, static_cast<long>(der.size())));
  std::string out(2 * size, '\0');
  auto* to = reinterpret_cast<unsigned char*>(out.data());
  if (!pair || BN_bn2binpad(ECDSA_SIG_get0_r(pair.get()), to, static_cast<int>(size)) < 0 ||
      BN_bn2binpad(ECDSA_SIG_get0_s(pair.get()), to + size, static_cast<int>(size)) < 0)
    return fail("the key gave no ECDSA signature");
  return out;
}

void set(xmlNode* node, const std::string& text) { xmlNodeSetContent(node, xml(text.c_str())); }

}  // namespace

/// Put together here and not by xmlsec, which cannot sign with a key that is in a token.
Expected<std::string> sign_xml(const Key::Impl& key, std::string_view bytes) {
  auto document = parse_xml(bytes);
  if (!document) return fail(document.error());
  xmlNode* root = xmlDocGetRootElement(document->get());
  if (xmlSecFindNode(root, xmlSecNodeSignature, xmlSecDSigNs) != nullptr)
    return fail("is signed already");
  const std::string content = canonical(document->get(), nullptr);
  const bool rsa = EVP_PKEY_get_base_id(key.key.get()) == EVP_PKEY_RSA;
  xmlNode* signature = content.empty() ? nullptr : add_template(document->get(), rsa);
  if (signature == nullptr) return fail("no place for a signature in the XML document");
  set(xmlSecFindNode(signature, xmlSecNodeDigestValue, xmlSecDSigNs), base64(sha256(content)));
  const xmlNode* info = xmlSecFindNode(signature, xmlSecNodeSignedInfo, xmlSecDSigNs);
  auto value = key.sign_bytes(canonical(document->get(), info));
  if (value && !rsa)
    value =
        side_by_side(*value, static_cast<std::size_t>(EVP_PKEY_get_bits(key.key.get()) + 7) / 8);
  if (!value) return fail(value.error());
  set(xmlSecFindNode(signature, xmlSecNodeSignatureValue, xmlSecDSigNs), base64(*value));
  xmlNode* data = xmlSecFindNode(signature, xmlSecNodeX509Data, xmlSecDSigNs);
  const auto add = [&](const CertificatePtr& c) {
    set(xmlSecAddChild(data, xmlSecNodeX509Certificate, xmlSecDSigNs), base64(der_of(c.get())));
  };
  add(key.certificate);
  for (const CertificatePtr& c : key.chain) add(c);
  xmlChar* text = nullptr;
  int size = 0;
  xmlDocDumpMemoryEnc(document->get(), &text, &size, "UTF-8");
  std::string out(reinterpret_cast<const char*>(text), static_cast<std::size_t>(size));
  xmlFree(text);
  return out;
}

namespace {

bool is(const xmlNode* node, const xmlChar* name) {
  return node != nullptr &&
         xmlSecCheckNodeName(const_cast<xmlNode*>(node), name, xmlSecDSigNs) == 1;
}

xmlNode* next(xmlNode* node) {
  return node == nullptr ? nullptr : xmlSecGetNextElementNode(node->next);
}
xmlNode* first(xmlNode* node) {
  return node == nullptr ? nullptr : xmlSecGetNextElementNode(node->children);
}

bool has(xmlNode* node, const xmlChar* attribute, std::string_view wanted) {
  if (node == nullptr) return false;
  const std::unique_ptr<xmlChar, void (*)(xmlChar*)> value(xmlGetNoNsProp(node, attribute),
                                                           [](xmlChar* p) { xmlFree(p); });
  return value != nullptr && reinterpret_cast<const char*>(value.get()) == wanted;
}

constexpr std::string_view exclusive = "http://www.w3.org/2001/10/xml-exc-c14n#";
constexpr std::string_view enveloped = "http://www.w3.org/2000/09/xmldsig#enveloped-signature";
constexpr std::string_view sha256_method = "http://www.w3.org/2001/04/xmlenc#sha256";
constexpr std::string_view by_rsa = "http://www.w3.org/2001/04/xmldsig-more#rsa-sha256";
constexpr std::string_view by_ecdsa = "http://www.w3.org/2001/04/xmldsig-more#ecdsa-sha256";

std::size_t count(xmlNode* node) {
  std::size_t n = 0;
  for (; node != nullptr; node = xmlSecGetNextElementNode(node->next)) {
    if (is(node, xmlSecNodeSignature)) ++n;
    n += count(xmlSecGetNextElementNode(node->children));
  }
  return n;
}

/// One signature, the last child of the root, over the whole document and nothing else.
Expected<xmlNode*> find_xml_signature(xmlDoc* document) {
  xmlNode* root = xmlDocGetRootElement(document);
  xmlNode* signature = first(root);
  while (next(signature) != nullptr) signature = next(signature);
  if (!is(signature, xmlSecNodeSignature)) return fail("is not signed");
  if (count(first(root)) != 1) return fail("has more than one signature");
  xmlNode* info = first(signature);
  xmlNode* canonical = first(info);
  xmlNode* method = next(canonical);
  xmlNode* reference = next(method);
  if (!is(info, xmlSecNodeSignedInfo) || !is(reference, xmlSecNodeReference) ||
      next(reference) != nullptr || !has(canonical, xmlSecAttrAlgorithm, exclusive) ||
      !(has(method, xmlSecAttrAlgorithm, by_rsa) || has(method, xmlSecAttrAlgorithm, by_ecdsa)))
    return fail("is signed in another way than Nonio does");
  xmlNode* transforms = first(reference);
  xmlNode* one = first(transforms);
  xmlNode* two = next(one);
  if (!has(reference, xmlSecAttrURI, "") || !has(one, xmlSecAttrAlgorithm, enveloped) ||
      !has(two, xmlSecAttrAlgorithm, exclusive) || next(two) != nullptr ||
      !has(next(transforms), xmlSecAttrAlgorithm, sha256_method))
    return fail("has a signature that does not cover the whole document");
  return signature;
}

std::string from_base64(std::string_view text) {
  std::string packed;
  for (const char c : text)
    if (std::string_view(" \t\r\n").find(c) == std::string_view::npos) packed += c;
  std::string out(packed.size() / 4 * 3 + 3, '\0');
  const int size = EVP_DecodeBlock(reinterpret_cast<unsigned char*>(out.data()), data_of(packed),
                                   static_cast<int>(packed.size()));
  if (size < 0) return {};
  std::size_t real = static_cast<std::size_t>(size);
  for (std::size_t i = packed.size(); i > 0 && packed[i - 1] == '=' && real > 0; --i) --real;
  out.resize(real);
  return out;
}

Expected<std::vector<CertificatePtr>> certificates_in(xmlNode* signature) {
  std::vector<CertificatePtr> out;
  xmlNode* info = next(next(first(signature)));
  for (xmlNode* c = first(first(info)); c != nullptr; c = next(c)) {
    if (!is(c, xmlSecNodeX509Certificate)) continue;
    const std::unique_ptr<xmlChar, void (*)(xmlChar*)> text(xmlNodeGetContent(c),
                                                            [](xmlChar* p) { xmlFree(p); });
    const std::string der = from_base64(reinterpret_cast<const char*>(text.get()));
    const unsigned char* at = data_of(der);
    CertificatePtr certificate(d2i_X509(nullptr, &at, static_cast<long>(der.size())));
    if (!certificate || at != data_of(der) + der.size() || out.size() >= 20)
      return fail("has a certificate that cannot be read");
    out.push_back(std::move(certificate));
  }
  if (out.empty()) return fail("has no certificate");
  return out;
}

Expected<void> check_value(xmlNode* signature, X509* certificate) {
  auto key = key_of(X509_get0_pubkey(certificate));
  if (!key) return fail(key.error());
  const ContextPtr context(xmlSecDSigCtxCreate(nullptr));
  context->enabledReferenceUris = xmlSecTransformUriTypeEmpty;
  context->signKey = key->release();
  if (xmlSecDSigCtxVerify(context.get(), signature) != 0 ||
      context->status != xmlSecDSigStatusSucceeded)
    return fail("the document was changed after it was signed");
  return {};
}

template <class T>
Expected<void> to_void(const Expected<T>& result) {
  if (result) return {};
  return fail(result.error());
}

}  // namespace

Verified verify_xml(std::string_view bytes, const Verifier& verifier, std::string_view wanted) {
  Verified out;
  out.at = verifier.now;
  Report report(out);
  auto document = parse_xml(bytes);
  report.add("xml.structure", to_void(document), "XML without a document type");
  if (!document) return out;
  const auto signature = find_xml_signature(document->get());
  report.add("xml.one", to_void(signature), "one signature over the whole document");
  if (!signature) return out;
  const auto certificates = certificates_in(*signature);
  if (!certificates) {
    report.add("xml.content", fail(certificates.error()), {});
    return out;
  }
  X509* certificate = certificates->front().get();
  out.certificate = der_of(certificate);
  auto holds = to_void(algorithm_of(X509_get0_pubkey(certificate), true));
  if (holds) holds = check_value(*signature, certificate);
  report.add("xml.content", holds, "the document is as it was signed");
  if (!wanted.empty()) {
    report.add("xml.signer",
               wanted == out.certificate
                   ? Expected<void>{}
                   : fail("signed by " + subject_of(certificate) + ", who did not sign the PDF"),
               "signed by the signer of the PDF");
    return out;
  }
  const auto known = trusted(verifier.trust, verifier.revocation);
  if (!known) {
    report.add("certificate.chain", fail(known.error()), {});
    return out;
  }
  report.check_signer(certificate, verifier);
  report.check_chain(certificate, *certificates, *known, !verifier.revocation.empty());
  return out;
}

}  // namespace nonio::sign
