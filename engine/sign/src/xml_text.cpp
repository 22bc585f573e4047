// SPDX-License-Identifier: Apache-2.0
// Sources: XML-Signature (W3C, 2nd edition), Exclusive XML Canonicalization 1.0 (W3C), ETSI EN 319
// 132-1 (XAdES; the list of its required properties was not compared with the standard).
#include "xml_text.h"

#include <algorithm>

#include "openssl.h"

namespace nonio::sign {

namespace {

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

}  // namespace

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

namespace {

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

}  // namespace

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

}  // namespace nonio::sign
