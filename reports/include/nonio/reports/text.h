// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>

#include "nonio/reports/font.h"

namespace nonio::reports {

/// Error with character and `field` if the fonts cannot print the text.
Expected<void> check_text(std::string_view text, const Fonts&, std::string_view field);

/// Unprintable characters become <U+6821> and invalid bytes <0xFF>, for messages that quote damaged
/// files.
std::string visible_text(std::string_view text, const Fonts&);

}  // namespace nonio::reports
