// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include "nonio/sdk/error.h"

namespace nonio::storage {

/// JSON written straight into a text, laid out as `dump` of json_values.h does it with a tree: for
/// large files, where the tree takes longer than everything else about them.
class JsonWriter {
 public:
  void begin_object() { begin('{'); }
  void end_object() { end('}'); }
  void begin_array() { begin('['); }
  void end_array() { end(']'); }

  void key(std::string_view name);
  void value(std::string_view text);
  void value(const char* text) { value(std::string_view(text)); }
  void value(double number);
  void value(std::int64_t number);
  void value(std::uint64_t number);
  void value(bool yes);
  void null() { item("null"); }
  template <class T>
  void member(std::string_view name, const T& of) {
    key(name);
    value(of);
  }

  /// What was written, with a newline at its end.
  std::string take();

 private:
  void begin(char bracket);
  void end(char bracket);
  void next();
  void item(std::string_view text);
  void quoted(std::string_view text);

  std::string out_;
  std::size_t depth_ = 0;
  bool empty_ = true;  // the innermost object or array
  bool after_key_ = false;
};

void put_error(JsonWriter& json, const Error& error);

}  // namespace nonio::storage
