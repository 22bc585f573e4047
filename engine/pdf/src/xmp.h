// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>

#include "nonio/pdf/writer.h"

namespace nonio::pdf {

/// The document's properties as XMP (ISO 16684-1), equal to those of its Info dictionary.
std::string xmp_packet(const NewFile&, std::string_view producer);

}  // namespace nonio::pdf
