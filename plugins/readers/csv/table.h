// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "header.h"
#include "nonio/sdk/error.h"

namespace nonio::csv {

/// A column that a file may have. A name "*_c" matches all other columns with this ending.
struct ColumnSpec {
  enum class Kind : std::uint8_t {
    number,  ///< NaN if missing
    place,   ///< mandatory number: coordinate or angle
    whole,   ///< 1, 2, ...
    sign,    ///< + or -
    motion,  ///< + or -, or blank if the axis did not move
    word,
  };
  std::string name;
  Kind kind = Kind::number;
  bool required = false;
  std::vector<std::string> words{};  ///< allowed values of a word; any if empty
};

/// Columns of a short file: numbers in units of the file, signs as +1, -1 and 0.
struct Table {
  std::vector<std::uint32_t> line;
  std::map<std::string, std::vector<double>, std::less<>> numbers;
  std::map<std::string, std::vector<std::string>, std::less<>> words;
  std::uint64_t empty_rows = 0;

  std::size_t size() const { return line.size(); }
  const std::vector<double>* column(std::string_view name) const {
    const auto found = numbers.find(name);
    return found == numbers.end() ? nullptr : &found->second;
  }
};

/// `stated`: names that columns have instead. Error: an invalid line or column.
Expected<Table> read_table(std::string_view bytes, const std::vector<ColumnSpec>& columns,
                           const StatedColumns* stated = nullptr);

}  // namespace nonio::csv
