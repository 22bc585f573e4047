// SPDX-License-Identifier: Apache-2.0
#include "nonio/pdf/lexer.h"

#include <algorithm>
#include <charconv>

namespace nonio::pdf {

namespace {

bool is_space(char c) { return c == ' ' || c == '\n' || c == '\r' || c == '\t'; }
bool is_digit(char c) { return c >= '0' && c <= '9'; }
bool is_delimiter(char c) { return std::string_view("()<>[]{}/%").find(c) != std::string::npos; }

int digit_of(char c) {
  if (is_digit(c)) return c - '0';
  if (c >= 'a' && c <= 'f') return c - 'a' + 10;
  if (c >= 'A' && c <= 'F') return c - 'A' + 10;
  return -1;
}

}  // namespace

tl::unexpected<Error> Lexer::refuse(const std::string& what) const {
  return fail("byte " + std::to_string(at_) + ": " + what);
}

void Lexer::skip_space() {
  while (at_ < bytes_.size() && is_space(bytes_[at_])) ++at_;
}

bool Lexer::take(std::string_view word) {
  if (at_ > bytes_.size() || bytes_.substr(at_, word.size()) != word) return false;
  at_ += word.size();
  return true;
}

bool Lexer::take_number(std::size_t& number, std::size_t most) {
  std::size_t end = at_;
  while (end < bytes_.size() && is_digit(bytes_[end])) ++end;
  if (end == at_ || end - at_ > most || (bytes_[at_] == '0' && end - at_ > 1)) return false;
  return take_digits(number, end - at_);
}

bool Lexer::take_digits(std::size_t& number, std::size_t count) {
  if (at_ > bytes_.size() || bytes_.size() - at_ < count) return false;
  const char* from = bytes_.data() + at_;
  const auto parsed = std::from_chars(from, from + count, number);
  if (parsed.ec != std::errc() || parsed.ptr != from + count) return false;
  at_ += count;
  return true;
}

Expected<Value> Lexer::value() { return value_in(0); }

Expected<Value> Lexer::value_in(int depth) {
  skip_space();
  if (depth > 20) return refuse("values nested too deeply");
  if (*budget_ == 0) return refuse("more values than a certificate has");
  --*budget_;
  Value value;
  value.begin = at_;
  Expected<void> done;
  if (take("<<")) {
    value.kind = Value::Kind::dictionary;
    done = read_container(value, depth);
  } else if (take("[")) {
    value.kind = Value::Kind::array;
    done = read_container(value, depth);
  } else if (take("<")) {
    done = read_hexadecimal(value);
  } else if (take("(")) {
    done = read_text(value);
  } else if (take("/")) {
    value.kind = Value::Kind::name;
    done = read_name(value);
  } else if (take("true") || take("false")) {
    value.kind = Value::Kind::boolean;
  } else if (take("null")) {
  } else {
    done = read_number(value);
  }
  if (!done) return fail(done.error());
  value.end = at_;
  return value;
}

Expected<void> Lexer::read_container(Value& value, int depth) {
  const bool is_dictionary = value.is(Value::Kind::dictionary);
  for (;;) {
    skip_space();
    if (take(is_dictionary ? ">>" : "]")) return check_keys(value);
    if (is_dictionary) {
      Value key;
      if (!take("/")) return refuse("expected a key of a dictionary");
      if (auto done = read_name(key); !done) return done;
      value.keys.push_back(std::move(key.text));
      value.items.emplace_back();
    }
    NONIO_TRY(auto item, value_in(depth + 1));
    if (is_dictionary)
      value.items.back() = std::move(item);
    else
      value.items.push_back(std::move(item));
  }
}

/// Checks for duplicate keys. They are sorted, because comparing all pairs would take too long for
/// a file with many keys.
Expected<void> Lexer::check_keys(const Value& value) const {
  std::vector<std::string_view> keys(value.keys.begin(), value.keys.end());
  std::sort(keys.begin(), keys.end());
  const auto twice = std::adjacent_find(keys.begin(), keys.end());
  if (twice != keys.end()) return refuse("the key /" + std::string(*twice) + " is given twice");
  return {};
}

Expected<void> Lexer::read_number(Value& value) {
  const std::size_t from = at_;
  std::size_t end = at_;
  while (end < bytes_.size() && !is_space(bytes_[end]) && !is_delimiter(bytes_[end])) ++end;
  std::string_view word = bytes_.substr(from, end - from);
  if (word.starts_with('+')) word.remove_prefix(1);
  const char* last = word.data() + word.size();
  const auto parsed = std::from_chars(word.data(), last, value.integer);
  const bool is_integer = parsed.ec == std::errc() && parsed.ptr == last && !word.empty();
  const bool is_real = !is_integer && !word.empty() && word.size() < 30 &&
                       word.find_first_not_of("-.0123456789") == std::string_view::npos &&
                       std::count(word.begin(), word.end(), '.') == 1 &&
                       word.find('-', 1) == std::string_view::npos;
  if (!is_integer && !is_real) return refuse("expected a value");
  at_ = end;
  value.kind = is_integer ? Value::Kind::integer : Value::Kind::real;
  if (!is_integer) value.integer = 0;
  if (is_integer && value.integer > 0 && is_digit(word.front()) && take(" 0 R"))
    value.kind = Value::Kind::reference;
  return {};
}

Expected<void> Lexer::read_name(Value& value) {
  while (at_ < bytes_.size() && !is_space(bytes_[at_]) && !is_delimiter(bytes_[at_])) {
    char c = bytes_[at_++];
    if (c == '#') {
      const int high = digit_of(peek());
      const int low = at_ + 1 < bytes_.size() ? digit_of(bytes_[at_ + 1]) : -1;
      if (high < 0 || low < 0) return refuse("expected two digits in a name");
      c = static_cast<char>(high * 16 + low);
      at_ += 2;
    }
    if (c == '\0' || value.text.size() >= 127) return refuse("a name that is none");
    value.text += c;
  }
  if (value.text.empty()) return refuse("an empty name");
  return {};
}

Expected<void> Lexer::read_text(Value& value) {
  value.kind = Value::Kind::string;
  for (int open = 1; at_ < bytes_.size();) {
    const char c = bytes_[at_++];
    if (c == '\\') {
      if (auto done = read_escape(value); !done) return done;
      continue;
    }
    open += c == '(' ? 1 : c == ')' ? -1 : 0;
    if (open == 0) return {};
    value.text += c;
  }
  return refuse("a text without end");
}

Expected<void> Lexer::read_escape(Value& value) {
  constexpr std::string_view letters = "nrtbf()\\", means = "\n\r\t\b\f()\\";
  const char c = peek();
  if (const auto i = letters.find(c); i != std::string_view::npos) {
    value.text += means[i];
    ++at_;
    return {};
  }
  int code = 0, digits = 0;
  for (; digits < 3 && peek() >= '0' && peek() <= '7'; ++digits)
    code = code * 8 + (bytes_[at_++] - '0');
  if (digits == 0 || code > 255) return refuse("an escape in a text that is none");
  value.text += static_cast<char>(code);
  return {};
}

Expected<void> Lexer::read_hexadecimal(Value& value) {
  value.kind = Value::Kind::string;
  value.hexadecimal = true;
  const std::size_t end = bytes_.find('>', at_);
  if (end == std::string_view::npos || (end - at_) % 2 != 0)
    return refuse("expected an even number of hexadecimal digits");
  value.text.reserve((end - at_) / 2);
  for (; at_ < end; at_ += 2) {
    const int high = digit_of(bytes_[at_]), low = digit_of(bytes_[at_ + 1]);
    if (high < 0 || low < 0) return refuse("expected hexadecimal digits");
    value.text += static_cast<char>(high * 16 + low);
  }
  ++at_;
  return {};
}

}  // namespace nonio::pdf
