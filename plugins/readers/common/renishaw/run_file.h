// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "nonio/sdk/error.h"

namespace nonio::renishaw {

struct FileLine {
  std::uint64_t number = 0;
  std::string_view text;
};

/// Values at the start and at the end; NaN if missing.
struct Environment {
  struct Pair {
    double start, end;
  };
  Pair air, pressure, humidity;  ///< degC, kPa, %
  std::vector<Pair> material;    ///< degC, of the connected sensors
  std::size_t unconnected = 0;   ///< number of sensors that read -10 twice
  Pair factor, expansion;        ///< um (effective half wavelength); ppm/K
  std::string_view times;        ///< bytes as in the file
};

/// Runs over targets, in units of the file.
struct RunFile {
  struct Row {
    std::uint32_t run = 0, target = 0;  ///< counted from 1
    double value = 0.0;                 ///< NaN if missing
    std::uint64_t line = 0;
  };
  std::string type, owner, version;
  std::vector<double> targets;  ///< in the order of the file
  std::vector<std::int64_t> flags;
  std::vector<FileLine> user;  ///< the seven lines of USER-TEXT, whose keys depend on the language
  std::uint32_t run_count = 0;
  std::vector<Row> rows;  ///< each combination of run and target once
  std::optional<Environment> environment;
};

/// Whether a file begins with HEADER:: and states this type ("rtl"), in upper or lower case.
bool is_type(std::string_view head, std::string_view type);

/// An error states the line.
Expected<RunFile> parse_run_file(std::string_view bytes, std::string_view type,
                                 std::string_view owner);

}  // namespace nonio::renishaw
