// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>

namespace nonio::reports {

/// In zlib's format; level 1 (fast) to 12 (small).
std::string deflated(std::string_view bytes, int level);

/// Decimal digits of an integer.
void append_int(std::string& out, long long value);

/// With at most two decimals, as PDF operands; the size is limited to 30000, as PDF readers do.
void append_real(std::string& out, double value, char behind);

}  // namespace nonio::reports
