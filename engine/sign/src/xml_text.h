// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "nonio/sign/sign.h"

namespace nonio::sign {

/// How a signed document begins; what follows is its canonical form (Canonical XML 1.0) and a new
/// line.
inline constexpr std::string_view xml_head = "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n";

/// The content of an enveloped XML signature of Nonio (XML-DSig; XAdES B-B, with `token` B-T). It
/// has one way to be written, so that whoever reads one writes it again and compares.
struct XmlSignature {
  bool rsa = false;        ///< else ECDSA
  std::string content;     ///< SHA-256 of the document's canonical form without signature
  std::string properties;  ///< SHA-256 of `signed_properties`
  std::string value;       ///< of the signature over `signed_info`
  std::vector<std::string> certificates;  ///< DER, the signer's first
  std::string time;                       ///< 2026-11-22T14:20:00Z, as the signer states
  std::string certificate;                ///< SHA-256 of the signer's, signed with the rest
  std::string token{};                    ///< RFC 3161, over `value_element`; empty: none

  std::string text() const;  ///< the whole element
  // Parts of it in the canonical form (exclusive) in which they are signed or stamped.
  std::string signed_info() const;
  std::string signed_properties() const;
  std::string value_element() const;
};

/// From an element that begins with `signature_begin`. An error if it is written in any other way.
Expected<XmlSignature> read_xml_signature(std::string_view element);
inline constexpr std::string_view signature_begin =
    "<Signature xmlns=\"http://www.w3.org/2000/09/xmldsig#\"";
inline constexpr std::string_view signature_end = "</Signature>";
inline constexpr std::string_view signature_namespace = "http://www.w3.org/2000/09/xmldsig#";
inline constexpr std::size_t longest_xml_signature = 200'000;

}  // namespace nonio::sign
