// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

namespace nonio::certificates {

/// Returns the mistake in the name of a person who approves; empty if the name is valid: one line
/// of up to 100 bytes without invisible characters, without compatibility characters (NFKC), and
/// without words that mix letters of two alphabets.
std::string mistake_in_name(const std::string& name);

/// Returns the letters and digits in lower case, with letters of other alphabets replaced by the
/// Latin letters that they resemble. Two names with the same result count as one person.
std::string likeness_of(const std::string& name);

}  // namespace nonio::certificates
