// SPDX-License-Identifier: Apache-2.0
#include "platform/storage/json_writer.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <system_error>
#include <utility>

#include "nonio/sdk/format.h"
#include "platform/storage/json_values.h"

namespace nonio::storage {

void JsonWriter::next() {
  if (!std::exchange(after_key_, false) && depth_ != 0) {
    out_ += empty_ ? "\n" : ",\n";
    out_.append(depth_, ' ');
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
  if (!std::exchange(empty_, false)) {
    out_ += '\n';
    out_.append(depth_, ' ');
  }
  out_ += bracket;
}

void JsonWriter::quoted(std::string_view text) {
  const auto plain = [](char c) { return c >= ' ' && c <= '~' && c != '"' && c != '\\'; };
  if (std::all_of(text.begin(), text.end(), plain))
    ((out_ += '"') += text) += '"';
  else
    out_ += Json(text).dump(-1, ' ', false, Json::error_handler_t::replace);
}

void JsonWriter::key(std::string_view name) {
  next();
  quoted(name);
  out_ += ": ";
  after_key_ = true;
}

void JsonWriter::value(std::string_view text) {
  next();
  quoted(text);
}

/// The shortest number that reads back the same, with ".0" if it is whole.
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

std::string JsonWriter::take() { return std::exchange(out_, {}) + "\n"; }

void put_error(JsonWriter& json, const Error& error) {
  json.begin_object();
  if (!error.file.empty()) json.member("file", error.file);
  if (error.line != 0) json.member("line", error.line);
  if (!error.column.empty()) json.member("column", error.column);
  json.member("message", error.message);
  json.end_object();
}

}  // namespace nonio::storage
