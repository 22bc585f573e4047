// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string_view>

/// Characters of UTF-8 texts and what may be done with them.
namespace nonio::reports {

inline constexpr char32_t not_utf8 = 0xFFFFFFFF;
inline constexpr char32_t acute_above = 0x0301;

/// The next character; `i` moves behind it. What is not UTF-8 gives not_utf8 and moves by a byte.
char32_t next_character(std::string_view text, std::size_t& i);

/// The same of the text in NFC: a letter and its marks are one character where Unicode has one.
char32_t next_composed(std::string_view text, std::size_t& i);

bool is_control(char32_t);

/// Letters over which an accent is set though no character has both: of Latin, Greek, Cyrillic.
bool bears_accent(char32_t);

/// Next to an ideograph, where else a line may be divided (GB/T 15834: punctuation).
bool begins_no_line(char32_t);
bool ends_no_line(char32_t);

}  // namespace nonio::reports
