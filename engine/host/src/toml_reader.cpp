// SPDX-License-Identifier: Apache-2.0
#include "toml_reader.h"

#include <algorithm>
#include <cmath>

#include "nonio/host/nearest.h"

namespace nonio::host {

namespace {

std::uint64_t line_of_node(const toml::node& node) { return node.source().begin.line; }

bool is_bare_key_character(char c) {
  return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '-' ||
         c == '_';
}

/// What toml++ 3.3 meets with undefined behaviour instead of an error: a byte outside ASCII that
/// stands in neither a string nor a comment, or where a text goes on after a backslash; and a table
/// header that begins with no key.
class Precheck {
 public:
  explicit Precheck(std::string_view text) : text_(text) {}

  /// The complaint, or "" if the parser may have the text; `line` is where the reading stopped.
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
        continue;
      }
      const bool header = line_begins && c == '[' && open_.empty() && closing_.empty();
      if (c != ' ' && c != '\t') line_begins = false;
      if (header && !key_follows()) return "wanted the name of a table after [";
      if (quote_within_word()) return "a quote in the middle of a word";
      if (goes_on_outside_ascii())
        return "after \\ and blanks a text in \"\"\" cannot go on with a letter outside ASCII "
               "here: "
               "leave the \\ out, or break the line elsewhere";
      if (!step(c)) return "a letter outside a-z 0-9 _ - needs quotes around it";
    }
    return {};
  }

 private:
  /// There toml++ goes on in the word, and may meet in it what stands in a string here.
  bool quote_within_word() const {
    const bool opens = closing_.empty() && (text_[at_] == '"' || text_[at_] == '\'');
    return opens &&
           (in_word_ || (at_ > 0 && std::string_view(" \t\r\n=,[{.\xBF").find(text_[at_ - 1]) ==
                                        std::string_view::npos));
  }

  /// There toml++ asks whether it is one more blank to skip, which it knows of few such letters.
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

  /// Outside strings and comments: keys or values, and whether a value without quotes has begun.
  void step_outside(char c) {
    if (std::string_view(" \t\r,]}").find(c) != std::string_view::npos) {
      in_word_ = false;
      if (c == ',') wants_value_ = !open_.empty() && open_.back() == '[';
      if ((c == ']' || c == '}') && !open_.empty()) open_.pop_back();
    } else if (in_word_) {
      return;
    } else if (c == '=') {
      wants_value_ = true;
    } else if (c == '[' || c == '{') {
      // A bracket where a key is wanted is that of a table's header: keys stand in it.
      open_ += wants_value_ ? c : '{';
      wants_value_ = open_.back() == '[';
    } else {
      in_word_ = wants_value_;
    }
  }

  std::string_view text_;
  std::size_t at_ = 0;
  std::string_view closing_;  // of the string or comment that is open
  std::string open_;          // brackets: [ holds values, { keys
  bool wants_value_ = false, in_word_ = false;
};

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
    return fail(
        Error{"not valid TOML: " + std::string(e.description()), file, e.source().begin.line});
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

std::optional<Setting> to_setting(const toml::node& node) {
  if (const auto v = node.value_exact<bool>()) return Setting(*v);
  if (const auto v = node.value_exact<std::int64_t>()) return Setting(*v);
  if (const auto v = node.value_exact<double>()) return Setting(*v);
  if (const auto v = node.value_exact<std::string>()) return Setting(*v);
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

const toml::node* TableReader::find(const char* key) {
  known_.emplace_back(key);
  return table_.get(key);
}

std::uint64_t TableReader::line_of(const char* key) const {
  const toml::node* node = table_.get(key);
  return node != nullptr ? line_of_node(*node) : line_of_node(table_);
}

void TableReader::error(const char* key, std::string message) {
  errors_.push_back(Error{place(key) + ": " + std::move(message), file_, line_of(key)});
}

void TableReader::wrong_type(const char* key, const toml::node& found, const char* wanted) {
  error(key, std::string("wanted ") + wanted + ", found " + type_name(found));
}

std::string TableReader::text(const char* key, bool required) {
  const toml::node* node = find(key);
  if (node == nullptr) {
    if (required) errors_.push_back(Error{place(key) + " is missing", file_, line_of_node(table_)});
    return {};
  }
  const auto value = node->value_exact<std::string>();
  if (!value) {
    wrong_type(key, *node, "a text in quotes");
    return {};
  }
  for (const char c : *value)
    if (static_cast<unsigned char>(c) < 0x20 || c == 0x7f) {
      error(key,
            std::string("wanted one line of text, found ") + (c == '\n'   ? "a line break"
                                                              : c == '\t' ? "a tab"
                                                                          : "a control character"));
      return {};
    }
  if (required && value->empty()) error(key, "is empty");
  return *value;
}

std::optional<double> TableReader::number(const char* key, double scale) {
  const toml::node* node = find(key);
  if (node == nullptr) return std::nullopt;
  const auto value = node->is_number() ? node->value<double>() : std::nullopt;
  if (!value) {
    wrong_type(key, *node, "a number");
    return std::nullopt;
  }
  if (!std::isfinite(*value)) {
    error(key, "wanted a finite number");
    return std::nullopt;
  }
  return *value * scale;
}

std::optional<int> TableReader::whole(const char* key) {
  const toml::node* node = find(key);
  if (node == nullptr) return std::nullopt;
  const auto value = node->value_exact<std::int64_t>();
  if (!value) {
    wrong_type(key, *node, "a whole number");
    return std::nullopt;
  }
  if (*value < 0 || *value > 1'000'000'000) {
    error(key, "wanted a whole number from 0 to 1000000000");
    return std::nullopt;
  }
  return static_cast<int>(*value);
}

std::optional<bool> TableReader::flag(const char* key) {
  const toml::node* node = find(key);
  if (node == nullptr) return std::nullopt;
  const auto value = node->value_exact<bool>();
  if (!value) wrong_type(key, *node, "true or false");
  return value;
}

std::string TableReader::date(const char* key) {
  const toml::node* node = find(key);
  if (node == nullptr) return {};
  const auto value = node->value_exact<toml::date>();
  if (!value) {
    wrong_type(key, *node, "a date without quotes, 2026-11-03");
    return {};
  }
  const auto digits = [](unsigned n, std::size_t width) {
    std::string s = std::to_string(n);
    return std::string(width > s.size() ? width - s.size() : 0, '0') + s;
  };
  return digits(value->year, 4) + "-" + digits(value->month, 2) + "-" + digits(value->day, 2);
}

std::optional<std::vector<std::string>> TableReader::texts(const char* key) {
  const toml::node* node = find(key);
  if (node == nullptr) return std::nullopt;
  const auto setting = node->is_array() ? to_setting(*node) : std::nullopt;
  if (!setting || !std::holds_alternative<std::vector<std::string>>(*setting)) {
    wrong_type(key, *node, "a list of texts");
    return std::nullopt;
  }
  return std::get<std::vector<std::string>>(*setting);
}

std::optional<std::vector<double>> TableReader::numbers(const char* key) {
  const toml::node* node = find(key);
  if (node == nullptr) return std::nullopt;
  if (node->is_array() && node->as_array()->empty()) return std::vector<double>{};
  const auto setting = node->is_array() ? to_setting(*node) : std::nullopt;
  if (!setting || !std::holds_alternative<std::vector<double>>(*setting)) {
    wrong_type(key, *node, "a list of numbers");
    return std::nullopt;
  }
  return std::get<std::vector<double>>(*setting);
}

std::vector<std::pair<std::string, double>> TableReader::number_table(const char* key,
                                                                      double scale) {
  std::vector<std::pair<std::string, double>> out;
  const toml::table* child = table(key);
  if (child == nullptr) return out;
  TableReader reader(*child, place(key), file_, errors_);
  for (const auto& [name, node] : *child) {
    const std::string text_name(name.str());
    if (const auto value = reader.number(text_name.c_str(), scale))
      out.emplace_back(text_name, *value);
  }
  return out;
}

const toml::table* TableReader::table(const char* key) {
  const toml::node* node = find(key);
  if (node == nullptr) return nullptr;
  if (!node->is_table()) wrong_type(key, *node, "a table");
  return node->as_table();
}

const toml::array* TableReader::tables(const char* key) {
  const toml::node* node = find(key);
  if (node == nullptr) return nullptr;
  const toml::array* list = node->as_array();
  if (list == nullptr || (!list->empty() && !list->is_homogeneous(toml::node_type::table))) {
    const std::string wanted = "tables, each headed [[" + place(key) + "]]";
    wrong_type(key, *node, wanted.c_str());
    return nullptr;
  }
  return list;
}

std::string TableReader::choice(const char* key, const std::vector<std::string>& allowed,
                                bool required) {
  std::string value = text(key, required);
  if (value.empty()) return value;
  std::string list;
  for (const std::string& a : allowed) {
    if (a == value) return value;
    list += (list.empty() ? "" : ", ") + a;
  }
  error(key, "wanted one of " + list + "; found \"" + value + "\"" + suggestion(value, allowed));
  return {};
}

void TableReader::finish() {
  for (const auto& [key, node] : table_) {
    const std::string name(key.str());
    if (std::find(known_.begin(), known_.end(), name) != known_.end()) continue;
    const std::uint64_t line = key.source().begin.line;
    errors_.push_back(Error{"unknown key " + place(name) + suggestion(name, known_), file_,
                            line != 0 ? line : line_of_node(node)});
  }
}

}  // namespace nonio::host
