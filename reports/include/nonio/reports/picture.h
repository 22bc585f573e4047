// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <string>
#include <string_view>

#include "nonio/pdf/writer.h"
#include "nonio/sdk/error.h"

namespace nonio::reports {

using pdf::Picture;

/// A PNG or JPEG file. Up to 4000 pixels a side and 2 MB. `name` is the file's, for messages. The
/// last few are remembered; what is given depends on the bytes alone.
Expected<std::shared_ptr<const Picture>> shared_picture(std::string_view bytes,
                                                        std::string_view name);

}  // namespace nonio::reports
