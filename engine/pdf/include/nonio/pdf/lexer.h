// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "nonio/pdf/reader.h"

namespace nonio::pdf {

/// Reads the tokens and values of a PDF from front to back. Comments are rejected, because the PDFs
/// that Nonio signs or verifies contain none after the head of the file.
class Lexer {
 public:
  Lexer(std::string_view bytes, std::size_t at) : bytes_(bytes), at_(at) {}
  /// `budget` is the number of values that may still be read; several lexers can share it.
  Lexer(std::string_view bytes, std::size_t at, std::size_t& budget)
      : bytes_(bytes), at_(at), budget_(&budget) {}

  std::size_t at() const { return at_; }
  void skip(std::size_t n) { at_ += n; }
  void skip_space();
  bool take(std::string_view word);
  /// Reads 1 to `most` digits without superfluous leading zeros; false if there is no such number.
  bool take_number(std::size_t& number, std::size_t most);
  /// Reads exactly `count` digits; false if there are fewer.
  bool take_digits(std::size_t& number, std::size_t count);
  Expected<Value> value();

 private:
  tl::unexpected<Error> refuse(const std::string& what) const;
  Expected<Value> value_in(int depth);
  Expected<void> read_container(Value& value, int depth);
  Expected<void> check_keys(const Value& value) const;
  Expected<void> read_number(Value& value);
  Expected<void> read_name(Value& value);
  Expected<void> read_text(Value& value);
  Expected<void> read_escape(Value& value);
  Expected<void> read_hexadecimal(Value& value);
  char peek() const { return at_ < bytes_.size() ? bytes_[at_] : '\0'; }

  std::string_view bytes_;
  std::size_t at_;
  std::size_t own_budget_ = 10000;
  std::size_t* budget_ = &own_budget_;
};

}  // namespace nonio::pdf
