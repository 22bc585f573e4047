// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "nonio/sign/sign.h"

namespace nonio::sign {

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

/// Returns an error unless `element` is the unique serialization.
Expected<XmlSignature> read_xml_signature(std::string_view element);
inline constexpr std::string_view signature_begin =
    "<Signature xmlns=\"http://www.w3.org/2000/09/xmldsig#\"";
inline constexpr std::string_view signature_end = "</Signature>";
inline constexpr std::string_view signature_namespace = "http://www.w3.org/2000/09/xmldsig#";
inline constexpr std::size_t longest_xml_signature = 200'000;

}  // namespace nonio::sign
