// SPDX-License-Identifier: Apache-2.0
#include "escape.h"

#include <charconv>

namespace nonio::model_html {

std::string html(std::string_view text) {
  std::string out;
  for (const char c : text) switch (c) {
      case '&':
        out += "&amp;";
        break;
      case '<':
        out += "&lt;";
        break;
      case '>':
        out += "&gt;";
        break;
      case '"':
        out += "&quot;";
        break;
      case '\'':
        out += "&#39;";
        break;
      default:
        if (static_cast<unsigned char>(c) >= 0x20 || c == '\n') out += c;
    }
  return out;
}

std::string json(std::string_view text) {
  constexpr std::string_view digits = "0123456789abcdef";
  std::string out = "\"";
  for (const char c : text) {
    const auto code = static_cast<unsigned char>(c);
    if (code < 0x20 || c == '"' || c == '\\' || c == '<' || c == '>' || c == '&')
      out += {'\\', 'u', '0', '0', digits[code >> 4], digits[code & 15]};
    else
      out += c;
  }
  return out + '"';
}

std::string csp_source(std::string_view sha256) {
  constexpr std::string_view digits =
      "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string out = "sha256-";
  unsigned held = 0;
  int bits = 0;
  for (std::size_t i = 0; i + 1 < sha256.size(); i += 2) {
    unsigned byte = 0;
    std::from_chars(sha256.data() + i, sha256.data() + i + 2, byte, 16);
    held = held << 8 | byte;
    for (bits += 8; bits >= 6; bits -= 6) out += digits[held >> (bits - 6) & 63];
  }
  if (bits > 0) out += digits[held << (6 - bits) & 63];
  while ((out.size() - 7) % 4 != 0) out += '=';
  return out;
}

}  // namespace nonio::model_html
