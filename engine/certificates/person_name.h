// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

namespace nonio::certificates {

/// Returns what is wrong with the name of a person who approves; empty if nothing. A name is one
/// line of up to 100 bytes without invisible characters, without compatibility characters (NFKC),
/// and without words that mix letters of two alphabets.
std::string mistake_in_name(const std::string& name);

/// Returns the letters and digits of a name in lower case, with letters of other alphabets replaced
/// by the Latin ones that they resemble. Two names with the same result count as one person.
std::string likeness_of(const std::string& name);

}  // namespace nonio::certificates
