// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "nonio/math/measuring_path.h"
#include "nonio/sdk/plugin.h"

/// What every writer of part programs does alike: which lines to measure, where to stop, what to
/// state about it. A dialect only formats. Compiled into each plugin.
namespace nonio::programs {

/// One part program: a path and what a person at the machine must know.
struct Program {
  math::MeasuringPath path;
  std::vector<std::string> about;  ///< plain ASCII lines for comments
  double feed = 0.0;               ///< mm/min, or deg/min of a rotary axis
};

/// A position as programs have it: mm or deg, as many decimals as it needs up to six.
std::string position(const math::MeasuringPath& path, std::size_t axis, double si);
/// Seconds or a feed, without needless zeros.
std::string number(double value);

struct Dialect {
  std::string_view output;  ///< name of the plugin, and start of its file names
  std::string_view ending;  ///< ".ngc"
  std::string (*format)(const Program&, const Settings&) = nullptr;
  bool tried = false;       ///< on a real control or its interpreter
  bool long_names = false;  ///< an axis may be called X1
};

/// The options of each program writer; its own are added behind them.
std::vector<Option> options(std::vector<Option> own);
/// A file for each line to be measured.
Expected<OutputResult> written(const OutputInput& in, const Dialect& dialect);

}  // namespace nonio::programs
