// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "nonio/math/measuring_path.h"
#include "nonio/sdk/plugin.h"

/// Functions for all writers of part programs: which lines to measure, where to stop, and the
/// comments. A dialect only formats. They are compiled into each plugin.
namespace nonio::programs {

struct Program {
  math::MeasuringPath path;
  std::vector<std::string> about;  ///< comment lines in plain ASCII
  double feed = 0.0;               ///< mm/min, or deg/min of a rotary axis
};

/// mm or deg, with as many decimals as needed, at most six.
std::string position(const math::MeasuringPath& path, std::size_t axis, double si);
/// Formats seconds or a feed, without trailing zeros.
std::string number(double value);

struct Dialect {
  std::string_view output;  ///< name of the plugin, and start of its file names
  std::string_view ending;  ///< file name extension: ".ngc"
  std::string (*format)(const Program&, const Settings&) = nullptr;
  bool tried = false;       ///< whether it was tested on a real control or its interpreter
  bool long_names = false;  ///< whether an axis may have a name such as X1
};

/// The options common to all program writers, followed by `own`.
std::vector<Option> options(std::vector<Option> own);
/// Writes one file for each line to be measured.
Expected<OutputResult> written(const OutputInput& in, const Dialect& dialect);

}  // namespace nonio::programs
