// SPDX-License-Identifier: Apache-2.0
#include "code_pages.h"

#include <Poco/Windows1250Encoding.h>
#include <Poco/Windows1251Encoding.h>
#include <Poco/Windows1252Encoding.h>

#include <cstdint>

#include "nonio/sdk/fields.h"
#include "nonio/sdk/text.h"

namespace nonio::readers {
namespace {

const Poco::TextEncoding* encoding_of(std::string_view code_page) {
  static const Poco::Windows1250Encoding central;
  static const Poco::Windows1251Encoding cyrillic;
  static const Poco::Windows1252Encoding western;
  if (code_page == "windows-1250") return &central;
  if (code_page == "windows-1251") return &cyrillic;
  if (code_page == "windows-1252") return &western;
  return nullptr;
}

/// nullopt if the code page lacks the byte (Poco returns U+FFFE or a control character).
std::optional<std::uint32_t> character(const Poco::TextEncoding& encoding, unsigned char byte) {
  const auto c = static_cast<std::uint32_t>(encoding.convert(&byte));
  if (c >= 0xFFFE || (c >= 0x80 && c < 0xA0)) return std::nullopt;
  return c;
}

}  // namespace

const std::vector<std::string>& code_pages() {
  static const std::vector<std::string> names{"utf-8", "windows-1250", "windows-1251",
                                              "windows-1252"};
  return names;
}

std::optional<std::string> decoded(std::string_view bytes, std::string_view code_page) {
  const Poco::TextEncoding* const encoding = encoding_of(code_page);
  std::string out;
  if (encoding == nullptr && !is_utf8(bytes)) return std::nullopt;
  for (const char c : bytes) {
    const auto byte = static_cast<unsigned char>(c);
    if (byte < 0x20 || byte == 0x7F) continue;
    if (byte < 0x80 || encoding == nullptr) {
      out += c;
      continue;
    }
    const auto letter = character(*encoding, byte);
    if (!letter) return std::nullopt;
    append_utf8(out, *letter);
  }
  return std::string(trimmed(out));
}

}  // namespace nonio::readers
