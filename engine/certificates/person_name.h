// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

namespace nonio::certificates {

/// What is wrong with the name of a person who approves; empty if nothing. A name is one line that
/// looks like what it is: nothing invisible, no compatibility characters (NFKC), no
/// word with letters of two alphabets.
std::string mistake_in_name(const std::string& name);

/// Letters and digits of a name: in lower case, and of other alphabets as the Latin letters that
/// they look like. Two names with the same one are not two persons.
std::string likeness_of(const std::string& name);

}  // namespace nonio::certificates
