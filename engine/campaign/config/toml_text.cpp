// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>

#include "campaign/config/plain_texts.h"
#include "campaign/config/toml_reader.h"
#include "nonio/sdk/fields.h"

namespace nonio::config {

namespace {

/// Finds text for which toml++ 3.3 has undefined behavior instead of an error: a byte outside ASCII
/// that is neither in a string nor in a comment, or where a string continues after a backslash; a
/// table header that does not begin with a key; a quote within a word; too deeply nested tables.
class Precheck {
 public:
  explicit Precheck(std::string_view text) : text_(text) {}

  std::string run(std::uint64_t& line) {
    line = 1;
    bool line_begins = true;
    for (at_ = text_.starts_with("\xEF\xBB\xBF") ? 3 : 0; at_ < text_.size(); ++at_) {
      const char c = text_[at_];
      if (c == '\n') {
        ++line;
        line_begins = true;
        if (closing_.size() == 1) closing_ = {};
        if (open_.empty()) wants_value_ = false;
        in_word_ = false;
        dots_ = 0;
        continue;
      }
      const bool header = line_begins && c == '[' && open_.empty() && closing_.empty();
      if (c != ' ' && c != '\t') line_begins = false;
      if (header && !key_follows()) return "expected the name of a table after [";
      if (quote_within_word()) return "a quote in the middle of a word";
      if (goes_on_outside_ascii())
        return "after \\ and blanks a text in \"\"\" cannot go on with a letter outside ASCII "
               "here: leave the \\ out, or break the line elsewhere";
      if (dots_ > most_dots || open_.size() > most_open)
        return "tables within tables, more than 32 with dots or 64 with brackets; expected few";
      if (!step(c)) return "a letter outside a-z 0-9 _ - needs quotes around it";
    }
    return {};
  }

 private:
  /// toml++ regards a quote within a word as part of the word; this check would begin a string.
  bool quote_within_word() const {
    const bool opens = closing_.empty() && (text_[at_] == '"' || text_[at_] == '\'');
    return opens &&
           (in_word_ || (at_ > 0 && std::string_view(" \t\r\n=,[{.\xBF").find(text_[at_ - 1]) ==
                                        std::string_view::npos));
  }

  /// toml++ tests for a blank after a backslash incorrectly for most characters outside ASCII.
  bool goes_on_outside_ascii() const {
    if (text_[at_] != '\\' || closing_ != "\"\"\"") return false;
    const std::size_t next = text_.find_first_not_of(" \t\r\n", at_ + 1);
    return next != std::string_view::npos && static_cast<unsigned char>(text_[next]) >= 0x80;
  }

  bool key_follows() const {
    std::size_t i = at_ + 1;
    const auto skip_blanks = [&] { i = std::min(text_.find_first_not_of(" \t", i), text_.size()); };
    skip_blanks();
    if (i < text_.size() && text_[i] == '[') {
      ++i;
      skip_blanks();
    }
    return i == text_.size() || is_bare_key_character(text_[i]) || text_[i] == '"' ||
           text_[i] == '\'';
  }

  bool step(char c) {
    if (!closing_.empty()) {
      if (c == '\\' && closing_[0] == '"') {
        if (at_ + 1 < text_.size() && text_[at_ + 1] != '\n') ++at_;
      } else if (c == closing_[0] && text_.substr(at_).starts_with(closing_)) {
        at_ += closing_.size() - 1;
        closing_ = {};
      }
    } else if (c == '"' || c == '\'') {
      const bool three = text_.substr(at_).starts_with(std::string(3, c));
      closing_ = text_.substr(at_, three ? 3 : 1);
      at_ += closing_.size() - 1;
    } else if (c == '#') {
      closing_ = "\n";
    } else {
      step_outside(c);
    }
    return !closing_.empty() || static_cast<unsigned char>(c) < 0x80;
  }

  void step_outside(char c) {
    if (c == '.' && !wants_value_) ++dots_;
    if (std::string_view("=,{").find(c) != std::string_view::npos) dots_ = 0;
    if (std::string_view(" \t\r,]}").find(c) != std::string_view::npos) {
      in_word_ = false;
      if (c == ',') wants_value_ = !open_.empty() && open_.back() == '[';
      if ((c == ']' || c == '}') && !open_.empty()) open_.pop_back();
    } else if (in_word_) {
      return;
    } else if (c == '=') {
      wants_value_ = true;
    } else if (c == '[' || c == '{') {
      open_ += wants_value_ ? c : '{';
      wants_value_ = open_.back() == '[';
    } else {
      in_word_ = wants_value_;
    }
  }

  std::string_view text_;
  std::size_t at_ = 0;
  std::string_view closing_;  // end of the open string or comment
  std::string open_;          // open brackets: [ contains values, { contains keys
  bool wants_value_ = false, in_word_ = false;
  /// toml++ reads and frees tables recursively, so deep nesting would end the process.
  static constexpr std::size_t most_dots = 31, most_open = 64;
  std::size_t dots_ = 0;
};

std::string dotted_date(std::string_view text, std::uint64_t line) {
  for (; line > 1 && text.find('\n') != text.npos; --line) text.remove_prefix(text.find('\n') + 1);
  text = text.substr(0, text.find_first_of("#\r\n"));
  const std::size_t equals = text.find('=');
  if (equals == text.npos) return {};
  const std::string value(readers::trimmed(text.substr(equals + 1)));
  const bool is_date = value.size() >= 8 && value.size() <= 10 &&
                       std::count(value.begin(), value.end(), '.') == 2 &&
                       value.find_first_not_of("0123456789.") == value.npos;
  return is_date ? value : std::string();
}

}  // namespace

Expected<toml::table> parse_toml(std::string_view text, const std::string& file) {
  if (text.find('\0') != std::string_view::npos)
    return fail(Error{"not a TOML file: it contains a zero byte", file});
  std::uint64_t line = 0;
  if (const std::string complaint = Precheck(text).run(line); !complaint.empty())
    return fail(Error{"not valid TOML: " + complaint, file, line});
  try {
    return toml::parse(text);
  } catch (const toml::parse_error& e) {
    if (const std::string date = dotted_date(text, e.source().begin.line); !date.empty())
      return fail(
          Error{"expected a date such as 2026-03-23, found " + date, file, e.source().begin.line});
    const std::string complaint(e.description());
    // Editors on Windows call an 8-bit code page "ANSI".
    return fail(
        Error{complaint.find("utf-8") == complaint.npos
                  ? "not valid TOML: " + complaint
                  : "not valid TOML: the file is not UTF-8; save it with the encoding UTF-8, "
                    "not ANSI",
              file, e.source().begin.line});
  }
}

void note_lines(const toml::table& table, const std::string& prefix, KeyLines& lines) {
  for (const auto& [key, node] : table) {
    const std::string name = prefix + std::string(key.str());
    lines[name] = node.source().begin.line;
    if (const toml::table* child = node.as_table()) note_lines(*child, name + ".", lines);
    if (const toml::array* list = node.as_array())
      for (const toml::node& item : *list)
        if (const toml::table* child = item.as_table()) {
          const std::string one = name + "." + (*child)["id"].value_or(std::string());
          lines[one] = child->source().begin.line;
          note_lines(*child, one + ".", lines);
        }
  }
}

std::string type_name(const toml::node& node) {
  switch (node.type()) {
    case toml::node_type::table:
      return "a table";
    case toml::node_type::array:
      return "a list";
    case toml::node_type::string:
      return "a text";
    case toml::node_type::integer:
      return "a whole number";
    case toml::node_type::floating_point:
      return "a number";
    case toml::node_type::boolean:
      return "true or false";
    case toml::node_type::date:
      return "a date";
    default:
      return "a time";
  }
}

namespace {

std::optional<Setting> number_tables(const toml::table& table) {
  NumberTables tables;
  for (const auto& [name, node] : table) {
    const toml::table* entries = node.as_table();
    if (entries == nullptr) return std::nullopt;
    NumberTable& out = tables[std::string(name.str())];
    for (const auto& [key, item] : *entries) {
      const auto number = item.is_number() ? item.value<double>() : std::nullopt;
      if (!number || !std::isfinite(*number)) return std::nullopt;
      out[std::string(key.str())] = *number;
    }
  }
  return Setting(std::move(tables));
}

}  // namespace

std::optional<Setting> to_setting(const toml::node& node) {
  if (const auto v = node.value_exact<bool>()) return Setting(*v);
  if (const auto v = node.value_exact<std::int64_t>()) return Setting(*v);
  if (const auto v = node.value_exact<double>()) return Setting(*v);
  if (const auto v = node.value_exact<std::string>()) return Setting(*v);
  if (const toml::table* table = node.as_table()) return number_tables(*table);
  const toml::array* list = node.as_array();
  if (list == nullptr) return std::nullopt;
  std::vector<std::string> words;
  std::vector<double> numbers;
  for (const toml::node& item : *list) {
    if (const auto w = item.value_exact<std::string>())
      words.push_back(*w);
    else if (const auto n = item.is_number() ? item.value<double>() : std::nullopt)
      numbers.push_back(*n);
    else
      return std::nullopt;
  }
  if (!words.empty() && !numbers.empty()) return std::nullopt;
  return numbers.empty() ? Setting(std::move(words)) : Setting(std::move(numbers));
}

std::string quoted_toml(const std::string& text) {
  constexpr const char* digits = "0123456789ABCDEF";
  std::string out = "\"";
  for (const char c : text) {
    const auto byte = static_cast<unsigned char>(c);
    if (c == '"' || c == '\\')
      out += std::string("\\") + c;
    else if (byte < 0x20 || byte == 0x7f)
      out += std::string("\\u00") + digits[byte >> 4] + digits[byte & 15];
    else
      out += c;
  }
  return out + "\"";
}

}  // namespace nonio::config
