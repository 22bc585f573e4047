// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "nonio/sign/sign.h"

namespace nonio::sign {

/// Beginning of a signed document; its canonical form (Canonical XML 1.0) and a line feed follow.
inline constexpr std::string_view xml_head = "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n";

/// The content of an enveloped XML signature of Nonio (XML-DSig; XAdES B-B, with `token` B-T). It
/// has exactly one serialization, so that a reader can write it again and compare.
struct XmlSignature {
  bool rsa = false;        ///< whether the signature is RSA; otherwise it is ECDSA
  std::string content;     ///< SHA-256 of the document's canonical form without signature
  std::string properties;  ///< SHA-256 of `signed_properties`
  std::string value;       ///< signature over `signed_info`
  std::vector<std::string> certificates;  ///< certificates in DER, the signer's first
  std::string time;                       ///< time stated by the signer, for example
                                          ///< 2026-11-22T14:20:00Z
  std::string certificate;                ///< SHA-256 of the signer's certificate, which is signed
                                          ///< too
  std::string token{};                    ///< RFC 3161 time stamp over `value_element`; empty: none

  std::string text() const;  ///< returns the complete element
  // Parts of the element in exclusive canonical form, as they are signed or stamped.
  std::string signed_info() const;
  std::string signed_properties() const;
  std::string value_element() const;
};

/// Parses an element that begins with `signature_begin`. An error if it differs from the only
/// accepted serialization.
Expected<XmlSignature> read_xml_signature(std::string_view element);
inline constexpr std::string_view signature_begin =
    "<Signature xmlns=\"http://www.w3.org/2000/09/xmldsig#\"";
inline constexpr std::string_view signature_end = "</Signature>";
inline constexpr std::string_view signature_namespace = "http://www.w3.org/2000/09/xmldsig#";
inline constexpr std::size_t longest_xml_signature = 200'000;

}  // namespace nonio::sign
