// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <vector>

namespace reader_cases {

/// One file for one reader, and what is expected of it.
struct Case {
  std::string name;  ///< file and line
  std::string reader, axis = "X", kind = "axis";
  bool rotary = false;
  std::string other_axis;                 ///< one more axis of the machine
  double expansion = 0.0;                 ///< um/(m K), 0: not stated
  std::string serial, date, slave, side;  ///< of machine, campaign, axis, measurement
  std::map<std::string, std::string> options;
  std::string bytes;
  struct Line {
    std::size_t number;
    std::string text;
  };
  std::vector<Line> expectations;
};

/// All cases of a file; on a mistake in it `error` says which. A case that wants a real file which
/// is not in `data` is counted in `absent` and left out.
std::vector<Case> read_cases(const std::filesystem::path& path, const std::filesystem::path& data,
                             std::string& error, int& absent);

}  // namespace reader_cases
