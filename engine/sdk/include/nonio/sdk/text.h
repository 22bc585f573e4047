// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "nonio/sdk/error.h"

/// Conversion of the text of files: UTF-8, and the encodings that Windows uses instead.
namespace nonio {

inline constexpr std::string_view utf8_mark = "\xEF\xBB\xBF";

inline std::string_view without_mark(std::string_view text) {
  if (text.starts_with(utf8_mark)) text.remove_prefix(utf8_mark.size());
  return text;
}

/// RFC 3629.
inline bool is_utf8(std::string_view text) {
  const auto at = [&](std::size_t i) { return static_cast<unsigned char>(text[i]); };
  for (std::size_t i = 0; i < text.size();) {
    const unsigned c = at(i);
    if (c < 0x80) {
      ++i;
      continue;
    }
    const std::size_t more = c >= 0xF0 ? 3 : c >= 0xE0 ? 2 : 1;
    if (c < 0xC2 || c > 0xF4 || i + more >= text.size()) return false;
    for (std::size_t k = 1; k <= more; ++k)
      if ((at(i + k) & 0xC0U) != 0x80) return false;
    const unsigned second = at(i + 1);
    // Overlong forms, surrogates, beyond U+10FFFF (RFC 3629 section 4).
    if ((c == 0xE0 && second < 0xA0) || (c == 0xED && second > 0x9F) ||
        (c == 0xF0 && second < 0x90) || (c == 0xF4 && second > 0x8F))
      return false;
    i += more + 1;
  }
  return true;
}

/// Appends code point `c`, at most U+10FFFF and not a surrogate, in UTF-8.
inline void append_utf8(std::string& out, std::uint32_t c) {
  const auto add = [&](std::uint32_t byte) { out += static_cast<char>(byte); };
  if (c < 0x80) return add(c);
  if (c < 0x800) {
    add(0xC0U | (c >> 6U));
  } else {
    if (c < 0x10000) {
      add(0xE0U | (c >> 12U));
    } else {
      add(0xF0U | (c >> 18U));
      add(0x80U | ((c >> 12U) & 0x3FU));
    }
    add(0x80U | ((c >> 6U) & 0x3FU));
  }
  add(0x80U | (c & 0x3FU));
}

/// Position of a text in XML or HTML: between tags, or in a quoted attribute.
enum class Markup { element, attribute };

/// Control characters below U+0020, except tab and line feed, are omitted. Quotes are escaped only
/// in an attribute.
inline std::string escaped_markup(std::string_view text, Markup where = Markup::element) {
  std::string out;
  for (const char c : text) {
    if (c == '&')
      out += "&amp;";
    else if (c == '<')
      out += "&lt;";
    else if (c == '>')
      out += "&gt;";
    else if (c == '"' && where == Markup::attribute)
      out += "&quot;";
    else if (c == '\'' && where == Markup::attribute)
      out += "&#39;";
    else if (static_cast<unsigned char>(c) >= 0x20 || c == '\t' || c == '\n')
      out += c;
  }
  return out;
}

/// Converts UTF-16 text with a byte-order mark (Excel's "Unicode text") to UTF-8; std::nullopt
/// without such a mark. An error, with its line, if the bytes are not valid UTF-16.
inline Expected<std::optional<std::string>> utf8_of_utf16(std::string_view bytes) {
  const bool little = bytes.starts_with("\xFF\xFE"), big = bytes.starts_with("\xFE\xFF");
  if (!little && !big) return std::nullopt;
  std::string out;
  out.reserve(bytes.size() / 2);
  std::uint64_t line = 1;
  const auto wrong = [&](const char* found) {
    Error error{std::string("expected text in UTF-16 as its byte-order mark says, found ") + found};
    error.line = line;
    return fail(std::move(error));
  };
  const auto unit = [&](std::size_t i) {
    const auto first = static_cast<unsigned char>(bytes[i]),
               second = static_cast<unsigned char>(bytes[i + 1]);
    return static_cast<std::uint32_t>(little ? first | (second << 8U) : second | (first << 8U));
  };
  for (std::size_t i = 2; i < bytes.size(); i += 2) {
    if (i + 1 == bytes.size()) return wrong("half a character at its end; was the file cut?");
    std::uint32_t c = unit(i);
    if (c >= 0xD800 && c < 0xE000) {
      const std::uint32_t low = i + 3 < bytes.size() ? unit(i + 2) : 0;
      if (c >= 0xDC00 || low < 0xDC00 || low >= 0xE000) return wrong("half a pair of surrogates");
      c = 0x10000U + ((c - 0xD800U) << 10U) + (low - 0xDC00U);
      i += 2;
    }
    if (c == 0) return wrong("a NUL character; is the file binary?");
    if (c == '\n') ++line;
    append_utf8(out, c);
  }
  return out;
}

}  // namespace nonio
