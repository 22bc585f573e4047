// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>

namespace nonio::model_html {

/// Text as it may stand between tags and in quoted attributes.
std::string html(std::string_view text);

}  // namespace nonio::model_html
