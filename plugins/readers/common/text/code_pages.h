// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

/// Decodes free text of instruments, which is in the code page of the computer that wrote it; no
/// file declares the code page.
namespace nonio::readers {

const std::vector<std::string>& code_pages();

/// Converts to UTF-8, trimmed and without control characters; none if the bytes are not valid in
/// that code page.
std::optional<std::string> decoded(std::string_view bytes, std::string_view code_page);

}  // namespace nonio::readers
