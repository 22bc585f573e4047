// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>

#include "nonio/reports/font.h"

namespace nonio::reports {

/// Whether both fonts can print the text; else the error that names the character and the field.
Expected<void> check_text(std::string_view text, const Fonts&, std::string_view field);

/// The text with every character that cannot be printed written as <U+6821>, and what is not UTF-8
/// as <0xFF>: for messages that quote from broken files.
std::string visible_text(std::string_view text, const Fonts&);

}  // namespace nonio::reports
