// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "nonio/sdk/error.h"

namespace nonio::csv {

/// A column that a file may have. A name "*_c" is that of every column which ends so and is no other
/// one: the table has them by their own names.
struct ColumnSpec {
  enum class Kind : std::uint8_t {
    number,  ///< a reading: NaN where it was not taken
    place,   ///< a number that must be there: a coordinate, an angle
    whole,   ///< 1, 2, ...
    sign,    ///< + or -
    motion,  ///< + or -, or blank where the axis did not move
    word,
  };
  std::string name;
  Kind kind = Kind::number;
  bool required = false;
  std::vector<std::string> words{};  ///< of a word: what is allowed; empty: anything
};

/// A file of few rows (unlike the runs of an axis) by its columns: numbers in the unit of the file,
/// signs as +1, -1 and 0.
struct Table {
  std::vector<std::uint32_t> line;
  std::map<std::string, std::vector<double>, std::less<>> numbers;
  std::map<std::string, std::vector<std::string>, std::less<>> words;
  std::uint64_t empty_rows = 0;

  std::size_t size() const { return line.size(); }
  /// Null if the file does not have it.
  const std::vector<double>* column(std::string_view name) const {
    const auto found = numbers.find(name);
    return found == numbers.end() ? nullptr : &found->second;
  }
};

/// A whole file, or an error with its line and column.
Expected<Table> read_table(std::string_view bytes, const std::vector<ColumnSpec>& columns);

}  // namespace nonio::csv
