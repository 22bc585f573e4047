// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

namespace nonio {

/// `[options.fanuc.axes.X] number = 1` is {"X": {"number": 1}}.
using NumberTable = std::map<std::string, double, std::less<>>;
using NumberTables = std::map<std::string, NumberTable, std::less<>>;

using Setting = std::variant<bool, std::int64_t, double, std::string, std::vector<double>,
                             std::vector<std::string>, NumberTables, NumberTable>;

/// The options of one plugin, or one file of templates/ with its tables flattened
/// ("finding.drift.parallel.advice"). If the name is absent or has another type, an accessor
/// returns `otherwise` or an empty value; `number` also accepts an integer. The options that a
/// plugin receives are complete and have the declared types.
class Settings {
 public:
  std::map<std::string, Setting, std::less<>> values;

  bool has(std::string_view name) const { return values.find(name) != values.end(); }
  bool flag(std::string_view name, bool otherwise = false) const {
    return get<bool>(name, otherwise);
  }
  std::int64_t integer(std::string_view name, std::int64_t otherwise = 0) const {
    return get<std::int64_t>(name, otherwise);
  }
  double number(std::string_view name, double otherwise = 0.0) const {
    const auto it = values.find(name);
    if (it == values.end()) return otherwise;
    if (const auto* i = std::get_if<std::int64_t>(&it->second)) return static_cast<double>(*i);
    const auto* d = std::get_if<double>(&it->second);
    return d != nullptr ? *d : otherwise;
  }
  std::string text(std::string_view name, std::string otherwise = {}) const {
    return get<std::string>(name, std::move(otherwise));
  }
  std::vector<std::string> texts(std::string_view name) const {
    return get<std::vector<std::string>>(name, {});
  }
  std::vector<double> numbers(std::string_view name) const {
    return get<std::vector<double>>(name, {});
  }
  NumberTables tables(std::string_view name) const { return get<NumberTables>(name, {}); }
  NumberTable table(std::string_view name) const { return get<NumberTable>(name, {}); }

 private:
  template <class T>
  T get(std::string_view name, T otherwise) const {
    const auto it = values.find(name);
    if (it == values.end()) return otherwise;
    const T* value = std::get_if<T>(&it->second);
    return value != nullptr ? *value : otherwise;
  }
};

}  // namespace nonio
