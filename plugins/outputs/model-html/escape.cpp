// SPDX-License-Identifier: Apache-2.0
#include "escape.h"

#include "nonio/sdk/text.h"

namespace nonio::model_html {

std::string html(std::string_view text) { return escaped_markup(text, Markup::attribute); }

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

}  // namespace nonio::model_html
