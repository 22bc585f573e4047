// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "nonio/sdk/error.h"

namespace nonio {

/// Writes JSON (RFC 8259). Bytes that are not UTF-8 become replacement characters; a number that is
/// not finite becomes null.
class JsonWriter {
 public:
  /// lines: one value per line, indented by one blank per level, for comparison line by line.
  /// in_script: one line that may be embedded in a <script> of a page, because no text in it can
  /// end the element.
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
  void raw(std::string_view json) { item(json); }  ///< `json` must be valid JSON
  template <class T>
  void member(std::string_view name, const T& of) {
    key(name);
    value(of);
  }

  /// Writes an array member; `put` writes one element for each item.
  template <class Items, class Put>
  void list(std::string_view name, const Items& items, const Put& put) {
    key(name);
    begin_array();
    for (const auto& item : items) put(item);
    end_array();
  }
  /// Writes a member that is an array of objects; `put` writes the members of one object for each
  /// item.
  template <class Items, class Put>
  void objects(std::string_view name, const Items& items, const Put& put) {
    list(name, items, [&](const auto& item) {
      begin_object();
      put(item);
      end_object();
    });
  }

  /// Returns and clears the written text; with Layout::lines it ends with a newline.
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
  bool empty_ = true;  // whether the innermost open object or array is empty
  bool after_key_ = false;
};

void put_error(JsonWriter& json, const Error& error);

}  // namespace nonio
