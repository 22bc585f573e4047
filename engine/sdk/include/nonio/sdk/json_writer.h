// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "nonio/sdk/error.h"

namespace nonio {

/// JSON (RFC 8259) written straight into a text. Text that is not UTF-8 gets replacement
/// characters; a number that is not finite is null.
class JsonWriter {
 public:
  /// A line for each value, indented by one, so that a difference of two files reads well; or one
  /// line for all; or one line that may be within a <script> of a page: nothing in it ends the
  /// element.
  enum class Layout { lines, one_line, in_script };
  explicit JsonWriter(Layout layout = Layout::lines) : layout_(layout) {}

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
  void value(const std::vector<std::string>& texts);
  void null() { item("null"); }
  void raw(std::string_view json) { item(json); }  ///< a value that is JSON already
  template <class T>
  void member(std::string_view name, const T& of) {
    key(name);
    value(of);
  }

  /// An array of what `put` writes of each item.
  template <class Items, class Put>
  void list(std::string_view name, const Items& items, const Put& put) {
    key(name);
    begin_array();
    for (const auto& item : items) put(item);
    end_array();
  }
  /// An array of objects, of which `put` writes the members.
  template <class Items, class Put>
  void objects(std::string_view name, const Items& items, const Put& put) {
    list(name, items, [&](const auto& item) {
      begin_object();
      put(item);
      end_object();
    });
  }

  /// What was written; in lines, with a newline at its end.
  std::string take();

 private:
  void begin(char bracket);
  void end(char bracket);
  void next();
  void new_line();
  void item(std::string_view text);
  void quoted(std::string_view text);

  Layout layout_;
  std::string out_;
  std::size_t depth_ = 0;
  bool empty_ = true;  // the innermost object or array
  bool after_key_ = false;
};

void put_error(JsonWriter& json, const Error& error);

}  // namespace nonio
