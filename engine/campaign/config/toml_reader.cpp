// SPDX-License-Identifier: Apache-2.0
#include "campaign/config/toml_reader.h"

#include <algorithm>
#include <cmath>
#include <set>
#include <stdexcept>

#include "nonio/sdk/format.h"
#include "platform/storage/nearest.h"

namespace nonio::config {

namespace {

std::uint64_t line_of_node(const toml::node& node) { return node.source().begin.line; }

/// `words` with `value` in place of {}.
std::string filled(std::string_view words, std::string_view value) {
  std::string text(words);
  if (const std::size_t at = text.find("{}"); at != std::string::npos) text.replace(at, 2, value);
  return text;
}

/// "um (deviation), mm (position or period)".
std::string list_of(std::span<const Choice> choices) {
  std::string list;
  for (const Choice& c : choices)
    list += (list.empty() ? "" : ", ") + std::string(c.name) +
            (c.meaning.empty() ? "" : " (" + std::string(c.meaning) + ")");
  return list;
}

}  // namespace

TableReader::Found TableReader::find(std::string_view name, std::initializer_list<Key::Holds> as) {
  const Key* key = find_key(declaration_->keys, name);
  if (key == nullptr || std::find(as.begin(), as.end(), key->holds) == as.end())
    throw std::logic_error(std::string(declaration_->name) + " (" + place(name) + "): " +
                           (key == nullptr ? "read and not declared" : "read not as declared"));
  read_.push_back(key);
  const toml::node* node = table_.get(name);
  if (node == nullptr && is_needed(*key)) missing(*key);
  return {*key, node};
}

bool TableReader::holds(const When& when) const {
  if (when.key.empty()) return false;
  std::optional<std::string> value;
  if (settled_.first == when.key)
    value = settled_.second;
  else if (const toml::node* node = table_.get(when.key))
    value = node->value_exact<std::string>();
  return value && std::find(when.values.begin(), when.values.end(), *value) != when.values.end();
}

std::uint64_t TableReader::line_of(std::string_view key) const {
  const toml::node* node = table_.get(key);
  return node != nullptr ? line_of_node(*node) : line_of_node(table_);
}

void TableReader::error(std::string_view key, std::string message) {
  errors_.push_back(Error{place(key) + ": " + std::move(message), file_, line_of(key)});
}

void TableReader::missing(const Key& key) {
  if (!key.missing.empty())
    error(key.name, "is missing: " + filled(key.missing, list_of(key.choices)));
  else if (table_.contains(key.name))
    error(key.name, "is empty");
  else
    errors_.push_back(Error{place(key.name) + " is missing", file_, line_of_node(table_)});
}

void TableReader::refuse(const Key& key, const std::string& found) {
  const bool says = found.empty() || key.wanted.find("{}") != std::string_view::npos;
  error(key.name, filled(key.wanted, found) + (says ? "" : "; found " + found));
}

void TableReader::wrong_type(std::string_view key, const toml::node& found,
                             std::string_view wanted) {
  error(key, "expected " + std::string(wanted) + ", found " + type_name(found));
}

std::optional<std::string> TableReader::one_line(const Key& key, const toml::node& node) {
  auto value = node.value_exact<std::string>();
  if (!value) {
    wrong_type(key.name, node, "a text in quotes");
    return std::nullopt;
  }
  for (const char c : *value)
    if (static_cast<unsigned char>(c) < 0x20 || c == 0x7f) {
      error(key.name, std::string("expected one line of text, found ") +
                          (c == '\n'   ? "a line break"
                           : c == '\t' ? "a tab"
                                       : "a control character"));
      return std::nullopt;
    }
  return value;
}

void TableReader::check_choice(const Key& key, std::string& value) {
  const auto is_it = [&](const Choice& choice) { return choice.name == value; };
  if (key.choices.empty() || std::any_of(key.choices.begin(), key.choices.end(), is_it)) return;
  std::vector<std::string> names;
  for (const Choice& choice : key.choices) names.emplace_back(choice.name);
  error(key.name, "expected one of " + list_of(key.choices) + "; found \"" + value + "\"" +
                      storage::suggestion(value, names));
  value.clear();
}

std::string TableReader::text(std::string_view name) {
  const Found found = find(name, {Key::Holds::text});
  if (found.node == nullptr) return {};
  auto value = one_line(found.key, *found.node);
  if (!value) return {};
  if (value->empty()) {
    if (is_needed(found.key)) missing(found.key);
    return {};
  }
  if (!obeys(*value, found.key.text)) refuse(found.key, found.key.may_be_secret ? "" : *value);
  check_choice(found.key, *value);
  return *value;
}

std::optional<double> TableReader::finite(std::string_view key, const toml::node& node) {
  const auto value = node.is_number() ? node.value<double>() : std::nullopt;
  if (!value) {
    wrong_type(key, node, "a number");
  } else if (!std::isfinite(*value)) {
    error(key, "expected a finite number");
    return std::nullopt;
  }
  return value;
}

std::optional<double> TableReader::number(std::string_view name, double scale) {
  return number_at(find(name, {Key::Holds::number}), scale);
}

std::optional<double> TableReader::number_or_none(std::string_view name, double scale) {
  const Found found = find(name, {Key::Holds::number_or_none});
  if (found.node == nullptr) return std::nullopt;
  if (const auto text = found.node->value_exact<std::string>()) {
    if (*text == "none") return 0.0;
    refuse(found.key, "\"" + *text + "\"");
    return std::nullopt;
  }
  return number_at(found, scale);
}

std::optional<double> TableReader::number_at(const Found& found, double scale) {
  if (found.node == nullptr) return std::nullopt;
  const auto value = finite(found.key.name, *found.node);
  if (!value) return std::nullopt;
  if (!in_range(*value, found.key)) {
    std::string shown;
    append_shortest(shown, *value);
    refuse(found.key, shown);
    return std::nullopt;
  }
  return *value * scale;
}

std::optional<int> TableReader::integer(std::string_view name) {
  const Found found = find(name, {Key::Holds::whole});
  if (found.node == nullptr) return std::nullopt;
  const auto value = found.node->value_exact<std::int64_t>();
  if (!value) {
    wrong_type(name, *found.node, "a whole number");
    return std::nullopt;
  }
  if (*value < 0 || *value > 1'000'000'000) {
    error(name, "expected a whole number from 0 to 1000000000");
    return std::nullopt;
  }
  if (!in_range(static_cast<double>(*value), found.key)) {
    refuse(found.key, std::to_string(*value));
    return std::nullopt;
  }
  return static_cast<int>(*value);
}

std::optional<bool> TableReader::flag(std::string_view name) {
  const Found found = find(name, {Key::Holds::flag});
  if (found.node == nullptr) return std::nullopt;
  const auto value = found.node->value_exact<bool>();
  if (!value) wrong_type(name, *found.node, "true or false");
  return value;
}

std::string TableReader::date(std::string_view name) {
  const Found found = find(name, {Key::Holds::date});
  if (found.node == nullptr) return {};
  const auto value = found.node->value_exact<toml::date>();
  if (!value) {
    wrong_type(name, *found.node, "a date without quotes, 2026-11-03");
    return {};
  }
  constexpr int first_year = 1950, last_year = 2100;
  if (value->year < first_year || value->year > last_year) {
    error(name,
          "expected a day from 1950 to 2100; found one of the year " + std::to_string(value->year));
    return {};
  }
  const auto digits = [](unsigned n, std::size_t width) {
    std::string s = std::to_string(n);
    return std::string(width > s.size() ? width - s.size() : 0, '0') + s;
  };
  return digits(value->year, 4) + "-" + digits(value->month, 2) + "-" + digits(value->day, 2);
}

std::optional<std::vector<std::string>> TableReader::texts(std::string_view name) {
  const Found found = find(name, {Key::Holds::texts});
  if (found.node == nullptr) return std::nullopt;
  const auto setting = found.node->is_array() ? to_setting(*found.node) : std::nullopt;
  if (!setting || !std::holds_alternative<std::vector<std::string>>(*setting)) {
    wrong_type(name, *found.node, "a list of texts");
    return std::nullopt;
  }
  auto list = std::get<std::vector<std::string>>(*setting);
  const Key& key = found.key;
  const std::set<std::string_view> distinct(list.begin(), list.end());
  const bool good = std::all_of(list.begin(), list.end(), [&](const std::string& one) {
    return one.size() >= key.text.shortest && obeys(one, key.text);
  });
  if (!good || (key.longest_list != 0 && list.size() > key.longest_list) ||
      (key.distinct && distinct.size() != list.size()))
    refuse(key);
  return list;
}

std::optional<std::vector<double>> TableReader::number_list(const Found& found) {
  if (found.node == nullptr) return std::nullopt;
  if (found.node->is_array() && found.node->as_array()->empty()) return std::vector<double>{};
  const auto setting = found.node->is_array() ? to_setting(*found.node) : std::nullopt;
  if (!setting || !std::holds_alternative<std::vector<double>>(*setting)) {
    wrong_type(found.key.name, *found.node, "a list of numbers");
    return std::nullopt;
  }
  return std::get<std::vector<double>>(*setting);
}

std::optional<std::vector<double>> TableReader::numbers(std::string_view name) {
  return number_list(find(name, {Key::Holds::numbers}));
}

std::vector<std::uint32_t> TableReader::integers(std::string_view name) {
  const Found found = find(name, {Key::Holds::wholes});
  std::vector<std::uint32_t> list;
  for (const double value : number_list(found).value_or(std::vector<double>{}))
    if (in_range(value, found.key) && value == std::floor(value))
      list.push_back(static_cast<std::uint32_t>(value));
    else
      refuse(found.key);
  return list;
}

std::optional<std::pair<double, double>> TableReader::span(std::string_view name, double scale) {
  const Found found = find(name, {Key::Holds::span});
  const auto ends = number_list(found);
  if (!ends) return std::nullopt;
  const auto is_finite = [&](double value) {
    return std::isfinite(value) && in_range(value, found.key);
  };
  if (ends->size() == 2 && (*ends)[0] < (*ends)[1] &&
      std::all_of(ends->begin(), ends->end(), is_finite))
    return std::pair{(*ends)[0] * scale, (*ends)[1] * scale};
  refuse(found.key);
  return std::nullopt;
}

std::vector<std::pair<std::string, double>> TableReader::number_table(std::string_view name,
                                                                      double scale) {
  std::vector<std::pair<std::string, double>> out;
  const Found found = find(name, {Key::Holds::number_table});
  const toml::table* child = table_at(found);
  if (child == nullptr) return out;
  if (child->empty() && is_needed(found.key)) missing(found.key);
  TableReader reader = inside(*child, found.key, place(name));
  for (const auto& [key, node] : *child) {
    const auto value = reader.finite(key.str(), node);
    if (value && !in_range(*value, found.key))
      error(name, std::string(key.str()) + ": " + std::string(found.key.wanted));
    else if (value)
      out.emplace_back(key.str(), *value * scale);
  }
  return out;
}

std::map<std::string, std::string> TableReader::translations(std::string_view name) {
  std::map<std::string, std::string> out;
  const Found found = find(name, {Key::Holds::translations});
  if (found.node == nullptr) return out;
  if (found.node->is_string()) {
    if (const auto text = one_line(found.key, *found.node); text && !text->empty()) out[""] = *text;
    return out;
  }
  const toml::table* table = table_at(found);
  if (table == nullptr) return out;
  for (const auto& [key, value] : *table) {
    const std::string_view language = key.str();
    const auto text = value.value_exact<std::string>();
    if (text && language.size() == 2 && obeys(language, found.key.text))
      out[std::string(language)] = *text;
    else
      refuse(found.key);
  }
  return out;
}

const toml::table* TableReader::table_at(const Found& found) {
  if (found.node == nullptr) return nullptr;
  if (!found.node->is_table()) wrong_type(found.key.name, *found.node, "a table");
  return found.node->as_table();
}

const toml::table* TableReader::anything(std::string_view name) {
  return table_at(find(name, {Key::Holds::anything, Key::Holds::options}));
}

std::optional<TableReader> TableReader::table(std::string_view name) {
  const Found found = find(name, {Key::Holds::table});
  const toml::table* table = table_at(found);
  if (table == nullptr) return std::nullopt;
  return inside(*table, found.key, place(name));
}

std::vector<TableReader> TableReader::tables(std::string_view name) {
  const Found found = find(name, {Key::Holds::tables});
  std::vector<TableReader> out;
  if (found.node == nullptr) return out;
  const toml::array* list = found.node->as_array();
  if (list == nullptr || (!list->empty() && !list->is_homogeneous(toml::node_type::table))) {
    wrong_type(name, *found.node, "tables, each headed [[" + place(name) + "]]");
    return out;
  }
  if (list->empty() && is_needed(found.key)) missing(found.key);
  if (found.key.longest_list != 0 && list->size() > found.key.longest_list) {
    refuse(found.key, std::to_string(list->size()));
    return out;
  }
  for (const toml::node& node : *list)
    out.push_back(inside(*node.as_table(), found.key, place(name)));
  return out;
}

std::vector<std::pair<std::string, TableReader>> TableReader::named_tables(std::string_view name) {
  const Found found = find(name, {Key::Holds::named_tables});
  std::vector<std::pair<std::string, TableReader>> out;
  const toml::table* table = table_at(found);
  if (table == nullptr) return out;
  for (const auto& [key, node] : *table) {
    const std::string at = place(name) + "." + std::string(key.str());
    if (const toml::table* child = node.as_table())
      out.emplace_back(key.str(), inside(*child, found.key, at));
    else
      errors_.push_back(
          Error{at + ": expected a table, found " + type_name(node), file_, line_of_node(node)});
  }
  return out;
}

TableReader TableReader::declared(const Key& declaration) const {
  TableReader same = inside(table_, declaration, place_);
  same.settled_ = settled_;
  return same;
}

void TableReader::finish() {
  std::vector<std::string> known;
  for (const Key& key : declaration_->keys) {
    if (!key.only.key.empty() && !holds(key.only)) continue;
    if (std::find(read_.begin(), read_.end(), &key) == read_.end())
      throw std::logic_error(std::string(declaration_->name) + " (" + place(key.name) +
                             "): declared and not read");
    known.emplace_back(key.name);
  }
  for (const auto& [key, node] : table_) {
    const std::string name(key.str());
    if (std::find(known.begin(), known.end(), name) != known.end()) continue;
    const std::uint64_t line = key.source().begin.line;
    errors_.push_back(Error{"unknown key " + place(name) + storage::suggestion(name, known), file_,
                            line != 0 ? line : line_of_node(node)});
  }
}

}  // namespace nonio::config
