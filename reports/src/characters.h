// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string_view>

namespace nonio::reports {

inline constexpr char32_t not_utf8 = 0xFFFFFFFF;
inline constexpr char32_t acute_above = 0x0301;

/// Decodes a character and advances `i`. An invalid byte gives not_utf8 and is skipped.
char32_t next_character(std::string_view text, std::size_t& i);

/// Like next_character, with NFC composition of a letter and its marks.
char32_t next_composed(std::string_view text, std::size_t& i);

bool is_control(char32_t);

/// Letters (Latin, Greek, Cyrillic) over which a separate accent can be set.
bool bears_accent(char32_t);

/// Line-breaking restrictions next to ideographs (GB/T 15834: punctuation).
bool begins_no_line(char32_t);
bool ends_no_line(char32_t);

}  // namespace nonio::reports
