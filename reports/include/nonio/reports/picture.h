// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <string>
#include <string_view>

#include "nonio/sdk/error.h"

namespace nonio::reports {

/// A PNG or JPEG file as documents hold it: decoded and compressed once, then only copied.
struct Picture {
  unsigned width = 0, height = 0;  ///< pixels
  bool grey = false;               ///< else red, green, blue; 8 bits each
  bool jpeg = false;               ///< `colours` is the file; else deflated rows
  std::string colours;
  std::string opacity;  ///< deflated rows of 8 bits; empty where nothing shines through
};

/// Up to 4000 pixels a side and 2 MB. `name` is the file's, for messages. The last few are
/// remembered; what is given depends on the bytes alone.
Expected<std::shared_ptr<const Picture>> shared_picture(std::string_view bytes,
                                                        std::string_view name);

}  // namespace nonio::reports
