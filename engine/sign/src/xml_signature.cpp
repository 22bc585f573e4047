// SPDX-License-Identifier: Apache-2.0
// Makes and verifies enveloped XML signatures (XML-DSig and XAdES) over a whole document.
#include <libxml/c14n.h>
#include <libxml/parser.h>
#include <libxml/tree.h>
#include <openssl/bn.h>
#include <openssl/ecdsa.h>
#include <openssl/err.h>
#include <xmlsec/crypto.h>
#include <xmlsec/errors.h>
#include <xmlsec/openssl/evp.h>
#include <xmlsec/xmldsig.h>
#include <xmlsec/xmlsec.h>
#include <xmlsec/xmltree.h>

#include <algorithm>

#include "key.h"
#include "nonio/pdf/signature_field.h"
#include "time_stamp.h"
#include "verify_parts.h"
#include "xml_document.h"
#include "xml_text.h"

namespace nonio::sign {

namespace {

using ContextPtr = std::unique_ptr<xmlSecDSigCtx, Freed<xmlSecDSigCtxDestroy>>;
using XmlKeyPtr = std::unique_ptr<xmlSecKey, Freed<xmlSecKeyDestroy>>;

bool started() {
  static const bool well = [] {
    xmlInitParser();
    const bool all_well =
        xmlSecInit() == 0 && xmlSecCryptoAppInit(nullptr) == 0 && xmlSecCryptoInit() == 0;
    // Errors are returned, not printed on the terminal.
    xmlSecErrorsSetCallback(nullptr);
    return all_well;
  }();
  return well;
}

}  // namespace

Expected<DocumentPtr> parse_xml(std::string_view bytes) {
  if (!started()) return fail("xmlsec does not start");
  if (bytes.size() > pdf::max_file) return fail(too_large);
  DocumentPtr document(xmlReadMemory(bytes.data(), static_cast<int>(bytes.size()), "document.xml",
                                     nullptr,
                                     XML_PARSE_NONET | XML_PARSE_NOERROR | XML_PARSE_NOWARNING));
  if (!document || xmlDocGetRootElement(document.get()) == nullptr)
    return fail("is not well-formed XML");
  if (document->intSubset != nullptr || document->extSubset != nullptr)
    return fail("has a document type: expected none");
  return document;
}

namespace {

/// Returns an error for nodes other than elements and text. Programs may ignore comments,
/// processing instructions and CDATA sections, so a certificate must not contain them.
Expected<void> check_nodes(const xmlNode* node) {
  for (; node != nullptr; node = node->next) {
    if (node->type == XML_COMMENT_NODE) return fail("has a comment: expected none");
    if (node->type == XML_PI_NODE) return fail("has an instruction for programs: expected none");
    if (node->type == XML_CDATA_SECTION_NODE) return fail("has a CDATA section: expected none");
    if (node->type != XML_ELEMENT_NODE && node->type != XML_TEXT_NODE)
      return fail("has something else than elements and text");
    if (node->type == XML_ELEMENT_NODE)
      if (auto sound = check_nodes(node->children); !sound) return sound;
  }
  return {};
}

/// Returns Canonical XML 1.0 without comments; an empty text on failure.
std::string canonical(xmlDoc* document) {
  xmlOutputBuffer* buffer = xmlAllocOutputBuffer(nullptr);
  std::string out;
  if (buffer != nullptr &&
      xmlC14NDocSaveTo(document, nullptr, XML_C14N_1_0, nullptr, 0, buffer) >= 0)
    out.assign(reinterpret_cast<const char*>(xmlOutputBufferGetContent(buffer)),
               xmlOutputBufferGetSize(buffer));
  if (buffer != nullptr) xmlOutputBufferClose(buffer);
  return out;
}

/// Returns an error for a document with nodes that its canonical form would omit.
Expected<std::string> canonical_form(std::string_view bytes) {
  NONIO_TRY(const auto document, parse_xml(bytes));
  if (auto sound = check_nodes(document.get()->children); !sound) return fail(sound.error());
  auto text = canonical(document.get());
  if (text.empty()) return fail("has no canonical form");
  return text;
}

/// XML requires r and s as two numbers of fixed size (RFC 4050) instead of DER.
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

std::string as_sequence(std::string_view pair) {
  const int half = static_cast<int>(pair.size() / 2);
  const std::unique_ptr<ECDSA_SIG, Freed<ECDSA_SIG_free>> signature(ECDSA_SIG_new());
  BIGNUM* r = BN_bin2bn(data_of(pair), half, nullptr);
  BIGNUM* s = BN_bin2bn(data_of(pair) + half, half, nullptr);
  if (r == nullptr || s == nullptr || ECDSA_SIG_set0(signature.get(), r, s) != 1) return {};
  return der_of(signature.get(), &i2d_ECDSA_SIG);
}

std::size_t size_of(EVP_PKEY* key) {
  return static_cast<std::size_t>(EVP_PKEY_get_bits(key) + 7) / 8;
}

std::string xml_time(Time time) {
  std::string text = text_of(time).substr(0, 19);
  text[10] = 'T';
  return text + "Z";
}

Expected<void> add_time_stamp(XmlSignature& signature, Time now, const TimeStamping& stamping,
                              std::string& no_time_stamp) {
  if (stamping.url.empty()) return {};
  auto token = ask_for_time_stamp(stamping, sha256(signature.value_element()), now);
  if (token) {
    signature.token = std::move(*token);
    return {};
  }
  if (stamping.required) return fail("no time stamp: " + token.error().message);
  no_time_stamp = token.error().message;
  return {};
}

}  // namespace

/// Signs an XML document without xmlsec, because xmlsec cannot sign with a key in a token.
Expected<Signed> sign_xml(const Key::Impl& key, std::string_view bytes, Time now,
                          const TimeStamping& stamping) {
  NONIO_TRY(auto content, canonical_form(bytes));
  if (content.find(signature_namespace) != std::string::npos) return fail("is signed already");
  XmlSignature signature;
  signature.rsa = EVP_PKEY_get_base_id(key.key.get()) == EVP_PKEY_RSA;
  signature.content = sha256(content);
  signature.time = xml_time(now);
  signature.certificates = {der_of(key.certificate.get())};
  for (const CertificatePtr& c : key.chain) signature.certificates.push_back(der_of(c.get()));
  signature.certificate = sha256(signature.certificates.front());
  signature.properties = sha256(signature.signed_properties());
  auto value = key.sign_bytes(signature.signed_info());
  if (value && !signature.rsa) value = side_by_side(*value, size_of(key.key.get()));
  if (!value) return fail(value.error());
  signature.value = std::move(*value);
  Signed out;
  if (auto stamped = add_time_stamp(signature, now, stamping, out.no_time_stamp); !stamped)
    return fail(stamped.error());
  content.insert(content.rfind("</"), signature.text());
  out.bytes = std::string(xml_head) + content + "\n";
  if (out.bytes.size() > pdf::max_file) return fail(too_large);
  return out;
}

namespace {

/// The canonical form makes it possible to find the signature without parsing XML.
struct Parts {
  std::string_view before, after;
  XmlSignature signature;

  static Expected<Parts> of(std::string_view bytes) {
    if (bytes.size() > pdf::max_file) return fail(too_large);
    if (!bytes.starts_with(xml_head) || !bytes.ends_with(">\n"))
      return fail(
          "expected it to begin with <?xml version=\"1.0\" encoding=\"UTF-8\"?> and to end "
          "with its root and a new line");
    bytes.remove_prefix(xml_head.size());
    bytes.remove_suffix(1);
    // Only the end is searched, because the content is not authenticated yet.
    const std::size_t root_end = bytes.rfind('<');
    const std::size_t from = bytes.size() - std::min(bytes.size(), longest_xml_signature);
    const std::size_t begin = bytes.find(signature_begin, from);
    if (begin == std::string_view::npos || root_end == std::string_view::npos || begin > root_end ||
        !bytes.substr(begin, root_end - begin).ends_with(signature_end))
      return fail("is not signed, or has data after its signature");
    Parts parts;
    parts.before = bytes.substr(0, begin);
    parts.after = bytes.substr(root_end);
    if (!parts.after.starts_with("</")) return fail("has data after its signature");
    NONIO_TRY(auto signature, read_xml_signature(bytes.substr(begin, root_end - begin)));
    parts.signature = std::move(signature);
    return parts;
  }
};

Expected<std::vector<CertificatePtr>> certificates_in(const XmlSignature& signature) {
  std::vector<CertificatePtr> out;
  for (const std::string& der : signature.certificates) {
    const unsigned char* at = data_of(der);
    CertificatePtr certificate(d2i_X509(nullptr, &at, static_cast<long>(der.size())));
    if (!certificate || at != data_of(der) + der.size() || der_of(certificate.get()) != der) {
      ERR_clear_error();
      return fail("has a certificate that cannot be read");
    }
    out.push_back(std::move(certificate));
  }
  return out;
}

Expected<void> check_value(const XmlSignature& s, X509* certificate) {
  EVP_PKEY* key = X509_get0_pubkey(certificate);
  if (auto known = algorithm_of(key, true); !known) return fail(known.error());
  const bool rsa = EVP_PKEY_get_base_id(key) == EVP_PKEY_RSA;
  if (rsa != s.rsa || (!rsa && s.value.size() != 2 * size_of(key)))
    return fail("was made with another kind of key than its certificate has");
  ERR_clear_error();
  const std::string value = rsa ? s.value : as_sequence(s.value), text = s.signed_info();
  const std::unique_ptr<EVP_MD_CTX, Freed<EVP_MD_CTX_free>> context(EVP_MD_CTX_new());
  const bool well = EVP_DigestVerifyInit(context.get(), nullptr, EVP_sha256(), nullptr, key) == 1 &&
                    EVP_DigestVerify(context.get(), data_of(value), value.size(), data_of(text),
                                     text.size()) == 1;
  ERR_clear_error();
  if (!well) return fail("was not made with the key of its certificate, or is damaged");
  return {};
}

Expected<void> check_digests(const Parts& parts) {
  const XmlSignature& s = parts.signature;
  if (s.content != sha256(parts.before, parts.after))
    return fail("the document was changed after it was signed");
  if (s.properties != sha256(s.signed_properties()))
    return fail("the properties of the signature were changed after it was signed");
  if (s.certificate != sha256(s.certificates.front()))
    return fail("it was signed with another certificate than the one it contains");
  return {};
}

Expected<XmlKeyPtr> key_of(EVP_PKEY* pkey) {
  EVP_PKEY_up_ref(pkey);
  xmlSecKeyDataPtr value = xmlSecOpenSSLEvpKeyAdopt(pkey);
  XmlKeyPtr key(xmlSecKeyCreate());
  if (value == nullptr || !key || xmlSecKeySetValue(key.get(), value) != 0)
    return fail("the key cannot be used for XML");
  return key;
}

/// Verifies the signature a second time with xmlsec, as an independent implementation.
Expected<void> ask_xmlsec(xmlDoc* document, X509* certificate) {
  NONIO_TRY(auto key, key_of(X509_get0_pubkey(certificate)));
  xmlNode* signature =
      xmlSecFindNode(xmlDocGetRootElement(document), xmlSecNodeSignature, xmlSecDSigNs);
  const ContextPtr context(xmlSecDSigCtxCreate(nullptr));
  context->enabledReferenceUris = xmlSecTransformUriTypeEmpty | xmlSecTransformUriTypeSameDocument;
  context->signKey = key.release();
  if (signature == nullptr || xmlSecDSigCtxVerify(context.get(), signature) != 0 ||
      context->status != xmlSecDSigStatusSucceeded)
    return fail("xmlsec does not find the signature well");
  return {};
}

Expected<void> check_form(std::string_view bytes, const Parts& parts, X509* certificate) {
  if (parts.before.find(signature_namespace) != std::string_view::npos)
    return fail("has more than one signature");
  NONIO_TRY(const auto document, parse_xml(bytes));
  if (auto sound = check_nodes(document.get()->children); !sound) return sound;
  if (std::string(xml_head) + canonical(document.get()) + "\n" != bytes)
    return fail("is not in its canonical form");
  return ask_xmlsec(document.get(), certificate);
}

class XmlCheck {
 public:
  XmlCheck(std::string_view bytes, const Verifier& verifier, std::string_view wanted)
      : bytes_(bytes), verifier_(verifier), wanted_(wanted), report_(out_) {
    out_.at = verifier.now;
  }

  Verified run() {
    const auto parts = Parts::of(bytes_);
    report_.add("xml.one", to_void(parts), "one signature, written as Nonio writes it");
    if (!parts) return std::move(out_);
    const auto certificates = certificates_in(parts->signature);
    report_.add("xml.certificates", to_void(certificates), "can be read");
    if (!certificates) return std::move(out_);
    X509* certificate = certificates->front().get();
    out_.certificate = parts->signature.certificates.front();
    auto holds = check_digests(*parts);
    if (holds) holds = check_value(parts->signature, certificate);
    report_.add("xml.content", holds, "the document is as it was signed");
    if (holds) check_people(parts->signature, certificate, *certificates);
    if (holds && (wanted_.empty() ? out_.holds() : wanted_ == out_.certificate))
      report_.add("xml.form", check_form(bytes_, *parts, certificate),
                  "is its own canonical form, without comments and instructions");
    else
      report_.skip("xml.form", "no trusted signer signed it");
    return std::move(out_);
  }

 private:
  void check_people(const XmlSignature& s, X509* certificate,
                    const std::vector<CertificatePtr>& all) {
    const auto known = trusted(verifier_);
    if (!known) return report_.add("certificate.chain", fail(known.error()), {});
    report_.check_stamp("xml.time", s.token, s.value_element(), s.time, *known, verifier_,
                        verifier_.existed);
    if (wanted_.empty()) {
      report_.check_signer(certificate, verifier_);
      report_.check_chain(certificate, all, *known, verifier_);
      return;
    }
    report_.add("xml.signer",
                wanted_ == out_.certificate ? Expected<void>{}
                                            : fail("signed by " + quoted(subject_of(certificate)) +
                                                   ", who did not sign the PDF"),
                "signed by the signer of the PDF");
  }

  std::string_view bytes_;
  const Verifier& verifier_;
  std::string_view wanted_;
  Verified out_;
  Report report_;
};

}  // namespace

Verified verify_xml(std::string_view bytes, const Verifier& verifier, std::string_view wanted) {
  return XmlCheck(bytes, verifier, wanted).run();
}

Expected<void> same_document(std::string_view signed_bytes, std::string_view written) {
  NONIO_TRY(const auto parts, Parts::of(signed_bytes));
  NONIO_TRY(const auto form, canonical_form(written));
  const std::string was = std::string(parts.before) + std::string(parts.after);
  if (was == form) return {};
  const auto differ = std::mismatch(was.begin(), was.end(), form.begin(), form.end());
  const auto line = 2 + std::count(was.begin(), differ.first, '\n');
  return fail("is another document than the readings give, from line " + std::to_string(line) +
              " on");
}

}  // namespace nonio::sign
