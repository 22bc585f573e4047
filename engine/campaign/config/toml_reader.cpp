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

std::string filled(std::string_view words, std::string_view value) {
  std::string text(words);
  if (const std::size_t at = text.find("{}"); at != std::string::npos) text.replace(at, 2, value);
  return text;
}

/// Lists choices for a message: "um (deviation), mm (position or period)".
std::string list_of(std::span<const Choice> choices) {
  std::string list;
  for (const Choice& c : choices)
    list += (list.empty() ? "" : ", ") + std::string(c.name) +
            (c.meaning.empty() ? "" : " (" + std::string(c.meaning) + ")");
  return list;
}

}  // namespace

void TableReader::fill(void* object, const void* type) {
  if (declaration_->into.inner != type)
    throw std::logic_error(std::string(declaration_->name) + ": fills another struct");
  errors_before_ = errors_.size();
  for (const Key& key : declaration_->keys)
    if (!key.only.key.empty() && !holds(key.only))
      continue;
    else if (key.into.read != nullptr)
      key.into.read(*this, key, object);
    else
      check(key);
}

const toml::node* TableReader::take(const Key& key) {
  read_.push_back(&key);
  const toml::node* node = table_.get(key.name);
  if (node == nullptr && is_needed(key)) missing(key);
  return node;
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

bool TableReader::check_choice(const Key& key, const std::string& value) {
  const auto is_it = [&](const Choice& choice) { return choice.name == value; };
  if (key.choices.empty() || std::any_of(key.choices.begin(), key.choices.end(), is_it))
    return true;
  std::vector<std::string> names;
  for (const Choice& choice : key.choices) names.emplace_back(choice.name);
  error(key.name, storage::not_one_of(names, value, list_of(key.choices)));
  return false;
}

template <>
std::optional<std::string> value_of(TableReader& reader, const Key& key) {
  const toml::node* node = reader.take(key);
  if (node == nullptr) return std::nullopt;
  if (key.holds == Key::Holds::date) return reader.date(key, *node);
  auto value = reader.one_line(key, *node);
  if (!value) return std::nullopt;
  if (value->empty()) {
    if (reader.is_needed(key)) reader.missing(key);
    return std::nullopt;
  }
  if (!obeys(*value, key.text)) reader.refuse(key, key.may_be_secret ? "" : *value);
  return reader.check_choice(key, *value) ? value : std::nullopt;
}

template <>
std::optional<Chosen> value_of(TableReader& reader, const Key& key) {
  const auto name = value_of<std::string>(reader, key);
  if (!name) return std::nullopt;
  return Chosen{std::find_if(key.choices.begin(), key.choices.end(), [&](const Choice& choice) {
                  return choice.name == *name;
                })->value};
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

template <>
std::optional<double> value_of(TableReader& reader, const Key& key) {
  const toml::node* node = reader.take(key);
  if (node == nullptr) return std::nullopt;
  if (const auto text = node->value_exact<std::string>();
      text && key.holds == Key::Holds::number_or_none) {
    if (*text == "none") return 0.0;
    reader.refuse(key, "\"" + *text + "\"");
    return std::nullopt;
  }
  const auto value = reader.finite(key.name, *node);
  if (!value) return std::nullopt;
  if (!in_range(*value, key)) {
    std::string shown;
    append_shortest(shown, *value);
    reader.refuse(key, shown);
    return std::nullopt;
  }
  return *value * key.scale;
}

template <>
std::optional<int> value_of(TableReader& reader, const Key& key) {
  const toml::node* node = reader.take(key);
  if (node == nullptr) return std::nullopt;
  const auto value = node->value_exact<std::int64_t>();
  if (!value)
    reader.wrong_type(key.name, *node, "a whole number");
  else if (*value < 0 || *value > 1'000'000'000)
    reader.error(key.name, "expected a whole number from 0 to 1000000000");
  else if (!in_range(static_cast<double>(*value), key))
    reader.refuse(key, std::to_string(*value));
  else
    return static_cast<int>(*value);
  return std::nullopt;
}

template <>
std::optional<bool> value_of(TableReader& reader, const Key& key) {
  const toml::node* node = reader.take(key);
  if (node == nullptr) return std::nullopt;
  const auto value = node->value_exact<bool>();
  if (!value) reader.wrong_type(key.name, *node, "true or false");
  return value;
}

std::optional<std::string> TableReader::date(const Key& key, const toml::node& node) {
  const auto value = node.value_exact<toml::date>();
  if (!value) {
    wrong_type(key.name, node, "a date without quotes, 2026-11-03");
    return std::nullopt;
  }
  constexpr int first_year = 1950, last_year = 2100;
  if (value->year < first_year || value->year > last_year) {
    error(key.name,
          "expected a day from 1950 to 2100; found one of the year " + std::to_string(value->year));
    return std::nullopt;
  }
  const auto digits = [](unsigned n, std::size_t width) {
    std::string s = std::to_string(n);
    return std::string(width > s.size() ? width - s.size() : 0, '0') + s;
  };
  return digits(value->year, 4) + "-" + digits(value->month, 2) + "-" + digits(value->day, 2);
}

template <>
std::optional<std::vector<std::string>> value_of(TableReader& reader, const Key& key) {
  const toml::node* node = reader.take(key);
  if (node == nullptr) return std::nullopt;
  const auto setting = node->is_array() ? to_setting(*node) : std::nullopt;
  if (!setting || !std::holds_alternative<std::vector<std::string>>(*setting)) {
    reader.wrong_type(key.name, *node, "a list of texts");
    return std::nullopt;
  }
  auto list = std::get<std::vector<std::string>>(*setting);
  const std::set<std::string_view> distinct(list.begin(), list.end());
  const bool good = std::all_of(list.begin(), list.end(), [&](const std::string& one) {
    return one.size() >= key.text.shortest && obeys(one, key.text);
  });
  if (!good || (key.longest_list != 0 && list.size() > key.longest_list) ||
      (key.distinct && distinct.size() != list.size()))
    reader.refuse(key);
  for (const std::string& one : list)
    if (!reader.check_choice(key, one)) break;
  return list;
}

std::optional<std::vector<double>> TableReader::number_list(const Key& key) {
  const toml::node* node = take(key);
  if (node == nullptr) return std::nullopt;
  if (node->is_array() && node->as_array()->empty()) return std::vector<double>{};
  const auto setting = node->is_array() ? to_setting(*node) : std::nullopt;
  if (!setting || !std::holds_alternative<std::vector<double>>(*setting)) {
    wrong_type(key.name, *node, "a list of numbers");
    return std::nullopt;
  }
  return std::get<std::vector<double>>(*setting);
}

template <>
std::optional<std::vector<double>> value_of(TableReader& reader, const Key& key) {
  return reader.number_list(key);
}

template <>
std::optional<std::vector<std::uint32_t>> value_of(TableReader& reader, const Key& key) {
  std::vector<std::uint32_t> list;
  for (const double value : reader.number_list(key).value_or(std::vector<double>{}))
    if (in_range(value, key) && value == std::floor(value))
      list.push_back(static_cast<std::uint32_t>(value));
    else
      reader.refuse(key);
  return list;
}

template <>
std::optional<Span> value_of(TableReader& reader, const Key& key) {
  const auto ends = reader.number_list(key);
  if (!ends) return std::nullopt;
  const auto is_finite = [&](double value) { return std::isfinite(value) && in_range(value, key); };
  if (ends->size() == 2 && (*ends)[0] < (*ends)[1] &&
      std::all_of(ends->begin(), ends->end(), is_finite))
    return std::pair{(*ends)[0] * key.scale, (*ends)[1] * key.scale};
  reader.refuse(key);
  return std::nullopt;
}

template <>
std::optional<Numbers> value_of(TableReader& reader, const Key& key) {
  const toml::table* child = reader.table_at(key);
  if (child == nullptr) return std::nullopt;
  if (child->empty() && reader.is_needed(key)) reader.missing(key);
  TableReader inner = reader.inside(*child, key, reader.place(key.name));
  Numbers out;
  for (const auto& [name, node] : *child) {
    const auto value = inner.finite(name.str(), node);
    if (value && !in_range(*value, key))
      reader.error(key.name, std::string(name.str()) + ": " + std::string(key.wanted));
    else if (value)
      out.emplace(name.str(), *value * key.scale);
  }
  return out;
}

template <>
std::optional<Translations> value_of(TableReader& reader, const Key& key) {
  const toml::node* node = reader.table_.get(key.name);
  Translations out;
  if (node != nullptr && node->is_string()) {
    if (const auto text = reader.one_line(key, *reader.take(key)); text && !text->empty())
      out[""] = *text;
    return out;
  }
  const toml::table* table = reader.table_at(key);
  if (table == nullptr) return std::nullopt;
  for (const auto& [name, value] : *table) {
    const std::string_view language = name.str();
    const auto text = value.value_exact<std::string>();
    if (text && language.size() == 2 && obeys(language, key.text))
      out[std::string(language)] = *text;
    else
      reader.refuse(key);
  }
  return out;
}

const toml::table* TableReader::table_at(const Key& key) {
  const toml::node* node = take(key);
  if (node == nullptr) return nullptr;
  if (!node->is_table()) wrong_type(key.name, *node, "a table");
  return node->as_table();
}

void TableReader::check(const Key& key) {
  using enum Key::Holds;
  switch (key.holds) {
    case text:
    case date:
      value_of<std::string>(*this, key);
      break;
    case number:
    case number_or_none:
      value_of<double>(*this, key);
      break;
    case whole:
      value_of<int>(*this, key);
      break;
    case span:
      value_of<Span>(*this, key);
      break;
    default:
      throw std::logic_error(place(key.name) + ": declared without a member");
  }
}

std::vector<TableReader> TableReader::tables(const Key& key) {
  std::vector<TableReader> out;
  const std::string at = place(key.name);
  if (key.holds == Key::Holds::tables) {
    const toml::node* node = take(key);
    if (node == nullptr) return out;
    const toml::array* list = node->as_array();
    if (list == nullptr || (!list->empty() && !list->is_homogeneous(toml::node_type::table))) {
      wrong_type(key.name, *node, "tables, each headed [[" + at + "]]");
      return out;
    }
    if (list->empty() && is_needed(key)) missing(key);
    if (key.longest_list != 0 && list->size() > key.longest_list) {
      refuse(key, std::to_string(list->size()));
      return out;
    }
    for (const toml::node& one : *list) {
      out.push_back(inside(*one.as_table(), key, at));
      out.back().settled_ = settled_;
      out.back().name_ = name_;
    }
    return out;
  }
  const toml::table* table = table_at(key);
  if (table == nullptr) return out;
  if (key.holds == Key::Holds::table) return {inside(*table, key, at)};
  for (const auto& [name, node] : *table) {
    const std::string named = at + "." + std::string(name.str());
    if (const toml::table* child = node.as_table()) {
      out.push_back(inside(*child, key, named));
      out.back().name_ = name.str();
      out.back().settle_by_name();
    } else {
      errors_.push_back(
          Error{named + ": expected a table, found " + type_name(node), file_, line_of_node(node)});
    }
  }
  return out;
}

void TableReader::settle_by_name() {
  const Key* by_name = find_key(declaration_->keys, declaration_->by_name);
  if (by_name == nullptr) return;
  const auto stated = table_[by_name->name].value_exact<std::string>();
  const bool named =
      !name_.empty() && declaration_->initials.find(name_.front()) != std::string_view::npos;
  std::string_view value;
  for (const Choice& choice : by_name->choices) {
    if (stated == choice.name) return settle(by_name->name, choice.name);
    if (named == (choice.name == declaration_->named_so)) value = choice.name;
  }
  settle(by_name->name, value);
}

void read_tables(TableReader& reader, const Key& key, void* outer,
                 void* (*add)(void* outer, std::string_view name),
                 void (*check)(TableReader&, void* inner, void* outer)) {
  for (TableReader& at : reader.tables(key)) {
    void* const inner = add(outer, at.name());
    at.fill(inner, key.into.inner);
    check(at, inner, outer);
    at.finish();
  }
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
