// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <string>
#include <string_view>

#include "nonio/pdf/writer.h"
#include "nonio/sdk/error.h"

namespace nonio::reports {

using pdf::Picture;

/// Reads a PNG or JPEG file of up to 4000 pixels per side and 2 MB. `name` is the file name for
/// messages. Pictures are cached; the result depends only on the bytes.
Expected<std::shared_ptr<const Picture>> shared_picture(std::string_view bytes,
                                                        std::string_view name);

}  // namespace nonio::reports
