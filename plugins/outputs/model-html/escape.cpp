// SPDX-License-Identifier: Apache-2.0
#include "escape.h"

#include "nonio/sdk/text.h"

namespace nonio::model_html {

std::string html(std::string_view text) { return escaped_markup(text, Markup::attribute); }

}  // namespace nonio::model_html
