// SPDX-License-Identifier: Apache-2.0
#include "nonio/sdk/json_writer.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <utility>

#include "nonio/sdk/format.h"
#include "nonio/sdk/json.h"

namespace nonio {

void JsonWriter::new_line() {
  if (layout_ != Layout::lines) return;
  out_ += '\n';
  out_.append(depth_, ' ');
}

void JsonWriter::next() {
  if (!std::exchange(after_key_, false) && depth_ != 0) {
    if (!empty_) out_ += ',';
    new_line();
  }
  empty_ = false;
}

void JsonWriter::item(std::string_view text) {
  next();
  out_ += text;
}

void JsonWriter::begin(char bracket) {
  next();
  out_ += bracket;
  ++depth_;
  empty_ = true;
}

void JsonWriter::end(char bracket) {
  --depth_;
  if (!std::exchange(empty_, false)) new_line();
  out_ += bracket;
}

void JsonWriter::quoted(std::string_view text) {
  const auto plain = [](char c) { return c >= ' ' && c <= '~' && c != '"' && c != '\\'; };
  if (layout_ == Layout::in_script) {
    for (const char c : json_text(text))
      if (c == '<' || c == '>' || c == '&')
        out_ += c == '<' ? "\\u003c" : c == '>' ? "\\u003e" : "\\u0026";
      else
        out_ += c;
  } else if (std::all_of(text.begin(), text.end(), plain)) {
    ((out_ += '"') += text) += '"';
  } else {
    out_ += json_text(text);
  }
}

void JsonWriter::key(std::string_view name) {
  next();
  quoted(name);
  out_ += layout_ == Layout::lines ? ": " : ":";
  after_key_ = true;
}

void JsonWriter::value(std::string_view text) {
  next();
  quoted(text);
}

/// Writes the shortest number that parses to the same double, with ".0" if it is an integer below
/// 1e15; null if it is not finite.
void JsonWriter::value(double number) {
  if (!std::isfinite(number)) return null();
  const double size = std::fabs(number);
  if (const auto decimal = size >= 1e-4 ? shortest_decimal(size) : std::nullopt)
    return item(decimal->places == 0
                    ? decimal_text(10 * decimal->digits, 1, number < 0.0)
                    : decimal_text(decimal->digits, decimal->places, number < 0.0));
  char text[32];
  const bool plain = number == 0.0 || (size >= 1e-4 && size < 1e15);
  const auto format = plain ? std::chars_format::fixed : std::chars_format::scientific;
  char* end = std::to_chars(text, text + sizeof text - 2, number, format).ptr;
  if (plain && std::find(text, end, '.') == end) {
    *end++ = '.';
    *end++ = '0';
  }
  item({text, static_cast<std::size_t>(end - text)});
}

void JsonWriter::value(std::int64_t number) { item(std::to_string(number)); }
void JsonWriter::value(std::uint64_t number) { item(std::to_string(number)); }

void JsonWriter::value(bool yes) { item(yes ? "true" : "false"); }

void JsonWriter::value(const std::vector<std::string>& texts) {
  begin_array();
  for (const std::string& text : texts) value(text);
  end_array();
}

std::string JsonWriter::take() {
  if (layout_ == Layout::lines) out_ += '\n';
  return std::exchange(out_, {});
}

void put_error(JsonWriter& json, const Error& error) {
  json.begin_object();
  if (!error.file.empty()) json.member("file", error.file);
  if (error.line != 0) json.member("line", error.line);
  if (!error.column.empty()) json.member("column", error.column);
  json.member("message", error.message);
  json.end_object();
}

}  // namespace nonio
