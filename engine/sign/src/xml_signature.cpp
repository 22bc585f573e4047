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
#include <string>
#include <string_view>
#include <vector>

#include "key.h"
#include "nonio/pdf/signature_field.h"
#include "nonio/sign/sign.h"
#include "openssl.h"
#include "time_stamp.h"
#include "verify_parts.h"
#include "xml_document.h"

namespace nonio::sign {

namespace {

/// Beginning of a signed document; Canonical XML 1.0 and a line feed follow.
inline constexpr std::string_view xml_head = "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n";

/// Content of an enveloped XML signature (XML-DSig; XAdES B-B, with `token` B-T). Its serialization
/// is unique, so that a reader can write it again and compare.
struct XmlSignature {
  bool rsa = false;     ///< RSA if true, otherwise ECDSA
  std::string content;  ///< SHA-256 of the document's canonical form without signature
  std::string properties;
  std::string value;
  std::vector<std::string> certificates;  ///< in DER, the signer's first
  std::string time;         ///< as stated by the signer, for example 2026-11-22T14:20:00Z
  std::string certificate;  ///< SHA-256 of the signer's certificate
  std::string token{};      ///< RFC 3161 time stamp over `value_element`, or empty

  std::string text() const;
  // Parts in exclusive canonical form, as they are signed or stamped.
  std::string signed_info() const;
  std::string signed_properties() const;
  std::string value_element() const;
};
inline constexpr std::string_view signature_begin =
    "<Signature xmlns=\"http://www.w3.org/2000/09/xmldsig#\"";
inline constexpr std::string_view signature_end = "</Signature>";
inline constexpr std::string_view signature_namespace = "http://www.w3.org/2000/09/xmldsig#";
inline constexpr std::size_t longest_xml_signature = 200'000;
// Sources: XML-Signature (W3C, 2nd edition), Exclusive XML Canonicalization 1.0 (W3C), ETSI EN 319
// 132-1 (XAdES; the list of its required properties was not compared with the standard).

constexpr std::string_view dsig = "xmlns=\"http://www.w3.org/2000/09/xmldsig#\"";
constexpr std::string_view xades = "xmlns:xades=\"http://uri.etsi.org/01903/v1.3.2#\"";
constexpr std::string_view exclusive = "http://www.w3.org/2001/10/xml-exc-c14n#";
constexpr std::string_view inclusive = "http://www.w3.org/TR/2001/REC-xml-c14n-20010315";
constexpr std::string_view enveloped = "http://www.w3.org/2000/09/xmldsig#enveloped-signature";
constexpr std::string_view sha256_method = "http://www.w3.org/2001/04/xmlenc#sha256";
constexpr std::string_view by_rsa = "http://www.w3.org/2001/04/xmldsig-more#rsa-sha256";
constexpr std::string_view by_ecdsa = "http://www.w3.org/2001/04/xmldsig-more#ecdsa-sha256";
constexpr std::string_view properties_type = "http://uri.etsi.org/01903#SignedProperties";

constexpr std::string_view certificate_begin = "<X509Certificate>",
                           certificate_end = "</X509Certificate>\n";

std::string base64(std::string_view bytes) {
  std::string out((bytes.size() + 2) / 3 * 4 + 1, '\0');
  out.resize(
      static_cast<std::size_t>(EVP_EncodeBlock(reinterpret_cast<unsigned char*>(out.data()),
                                               data_of(bytes), static_cast<int>(bytes.size()))));
  return out;
}

/// Returns "" for invalid text; `read_xml_signature` detects noncanonical Base64.
std::string from_base64(std::string_view text) {
  std::string out(text.size() / 4 * 3 + 3, '\0');
  const int size = EVP_DecodeBlock(reinterpret_cast<unsigned char*>(out.data()), data_of(text),
                                   static_cast<int>(text.size()));
  if (size < 0) return {};
  auto real = static_cast<std::size_t>(size);
  for (std::size_t i = text.size(); i > 0 && text[i - 1] == '=' && real > 0; --i) --real;
  out.resize(real);
  return out;
}

/// Empty elements have an end tag, as the canonical form requires.
std::string element(std::string_view name, std::string_view attributes, std::string_view content) {
  std::string out = "<";
  out += name;
  if (!attributes.empty()) (out += ' ') += attributes;
  ((out += '>') += content) += "</";
  return (out += name) + ">\n";
}

std::string attribute(std::string_view name, std::string_view value) {
  return std::string(name) + "=\"" + std::string(value) + "\"";
}

std::string algorithm(std::string_view name, std::string_view value, std::string_view scope = {}) {
  return element(
      name, (scope.empty() ? "" : std::string(scope) + " ") + attribute("Algorithm", value), {});
}

std::string digest(std::string_view value, std::string_view scope = {}) {
  return algorithm("DigestMethod", sha256_method, scope) +
         element("DigestValue", scope, base64(value));
}

std::string without_line_end(std::string text) {
  text.pop_back();
  return text;
}

/// `alone`: whether the element declares the namespaces that it would inherit from its parents.
std::string info(const XmlSignature& s, bool alone) {
  const std::string content = element(
      "Reference", attribute("Id", "content") + " " + attribute("URI", ""),
      "\n" +
          element("Transforms", {},
                  "\n" + algorithm("Transform", enveloped) + algorithm("Transform", inclusive)) +
          digest(s.content));
  const std::string properties =
      element("Reference",
              attribute("Type", properties_type) + " " + attribute("URI", "#signed-properties"),
              "\n" + element("Transforms", {}, "\n" + algorithm("Transform", exclusive)) +
                  digest(s.properties));
  return element("SignedInfo", alone ? dsig : std::string_view{},
                 "\n" + algorithm("CanonicalizationMethod", exclusive) +
                     algorithm("SignatureMethod", s.rsa ? by_rsa : by_ecdsa) + content +
                     properties);
}

std::string properties(const XmlSignature& s, bool alone) {
  const std::string_view scope = alone ? dsig : std::string_view{};
  const std::string certificate = element(
      "xades:SigningCertificateV2", {},
      "\n" + element("xades:Cert", {},
                     "\n" + element("xades:CertDigest", {}, "\n" + digest(s.certificate, scope))));
  const std::string signature =
      element("xades:SignedSignatureProperties", {},
              "\n" + element("xades:SigningTime", {}, s.time) + certificate);
  const std::string object =
      element("xades:SignedDataObjectProperties", {},
              "\n" + element("xades:DataObjectFormat", attribute("ObjectReference", "#content"),
                             "\n" + element("xades:MimeType", {}, "text/xml")));
  return element("xades:SignedProperties",
                 (alone ? std::string(xades) + " " : "") + attribute("Id", "signed-properties"),
                 "\n" + signature + object);
}

std::string stamp(const XmlSignature& s) {
  if (s.token.empty()) return {};
  return element(
      "xades:UnsignedProperties", {},
      "\n" +
          element("xades:UnsignedSignatureProperties", {},
                  "\n" + element("xades:SignatureTimeStamp", {},
                                 "\n" + algorithm("CanonicalizationMethod", exclusive) +
                                     element("xades:EncapsulatedTimeStamp", {}, base64(s.token)))));
}

std::string value(const XmlSignature& s, bool alone) {
  return element("SignatureValue",
                 (alone ? std::string(dsig) + " " : "") + attribute("Id", "signature-value"),
                 base64(s.value));
}

std::string XmlSignature::signed_info() const { return without_line_end(info(*this, true)); }
std::string XmlSignature::signed_properties() const {
  return without_line_end(sign::properties(*this, true));
}
std::string XmlSignature::value_element() const {
  return without_line_end(sign::value(*this, true));
}

std::string XmlSignature::text() const {
  std::string list = "\n";
  for (const std::string& c : certificates) list += element("X509Certificate", {}, base64(c));
  const std::string qualifying = element(
      "xades:QualifyingProperties", std::string(xades) + " " + attribute("Target", "#signature"),
      "\n" + sign::properties(*this, false) + stamp(*this));
  return without_line_end(element("Signature",
                                  std::string(dsig) + " " + attribute("Id", "signature"),
                                  "\n" + info(*this, false) + sign::value(*this, false) +
                                      element("KeyInfo", {}, "\n" + element("X509Data", {}, list)) +
                                      element("Object", {}, "\n" + qualifying)));
}

/// Returns the text between two marks and advances `rest` to the second mark, if both exist.
std::string_view between(std::string_view& rest, std::string_view begin, std::string_view end) {
  const std::size_t from = rest.find(begin);
  if (from == std::string_view::npos) return {};
  const std::size_t to = rest.find(end, from + begin.size());
  if (to == std::string_view::npos) return {};
  const std::string_view out = rest.substr(from + begin.size(), to - from - begin.size());
  rest.remove_prefix(to);
  return out;
}

bool is_time(std::string_view text) {
  constexpr std::string_view form = "0000-00-00T00:00:00Z";
  return text.size() == form.size() &&
         std::equal(text.begin(), text.end(), form.begin(),
                    [](char c, char f) { return f == '0' ? c >= '0' && c <= '9' : c == f; });
}

/// Returns an error unless `element` is the unique serialization.
Expected<XmlSignature> read_xml_signature(std::string_view whole) {
  constexpr std::size_t most_certificates = 20;
  constexpr std::string_view digest_begin = "<DigestValue>", digest_end = "</DigestValue>";
  XmlSignature s;
  std::string_view rest = whole;
  s.rsa = whole.find(by_rsa) != std::string_view::npos;
  s.content = from_base64(between(rest, digest_begin, digest_end));
  s.properties = from_base64(between(rest, digest_begin, digest_end));
  s.value =
      from_base64(between(rest, "<SignatureValue Id=\"signature-value\">", "</SignatureValue>"));
  std::string_view list = between(rest, "<X509Data>", "</X509Data>");
  while (s.certificates.size() < most_certificates && !list.empty()) {
    const std::string_view one = between(list, certificate_begin, certificate_end);
    if (one.empty()) break;
    s.certificates.push_back(from_base64(one));
  }
  s.time = between(rest, "<xades:SigningTime>", "</xades:SigningTime>");
  s.certificate = from_base64(between(rest, digest_begin, digest_end));
  s.token =
      from_base64(between(rest, "<xades:EncapsulatedTimeStamp>", "</xades:EncapsulatedTimeStamp>"));
  const std::string again = s.text();
  if (again != whole || s.certificates.empty() || !is_time(s.time)) {
    const auto differ = std::mismatch(again.begin(), again.end(), whole.begin(), whole.end());
    return fail("has a signature that is written in another way than Nonio writes one: its byte " +
                std::to_string(differ.first - again.begin()));
  }
  return s;
}

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
