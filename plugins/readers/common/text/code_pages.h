// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

/// Free text of instruments: in the code page of the computer that wrote it, which no file
/// declares.
namespace nonio::readers {

/// The names that `decoded` knows.
const std::vector<std::string>& code_pages();

/// As UTF-8, trimmed and without control characters; nothing if the bytes are not of that code
/// page.
std::optional<std::string> decoded(std::string_view bytes, std::string_view code_page);

}  // namespace nonio::readers
