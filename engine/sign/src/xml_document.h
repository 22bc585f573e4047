// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <libxml/tree.h>

#include <memory>
#include <string_view>

#include "openssl.h"

namespace nonio::sign {

using DocumentPtr = std::unique_ptr<xmlDoc, Freed<xmlFreeDoc>>;

/// Parses XML without network access and without a document type, because entities could read other
/// files or grow without limit.
Expected<DocumentPtr> parse_xml(std::string_view bytes);

}  // namespace nonio::sign
