// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <map>
#include <utility>
#include <vector>

#include "campaign/config/keys.h"
#include "nonio/sdk/settings.h"

/// Declares a key together with the member that it fills:
///   {"dwell_s", into<&Measurement::dwell>, "Dwell at a target.", seconds, not_negative}
/// A member that no kind of key can fill is a compile-time error. An absent key leaves its member
/// unchanged.
namespace nonio::config {

using Span = std::pair<double, double>;
using Numbers = std::map<std::string, double>;
using Translations = std::map<std::string, std::string>;
/// The `Choice::value` of the text that a key contains.
struct Chosen {
  int value = 0;
};

/// Returns the value of a key in the unit of the member, and reports a wrong value as an error.
/// Returns nullopt if the key is absent, its text is empty, or its value cannot be used. A list of
/// whole numbers is always returned, without its wrong elements.
template <class T>
std::optional<T> value_of(TableReader&, const Key&);
// The specializations are defined with the reader (toml_reader.cpp).
template <>
std::optional<std::string> value_of(TableReader&, const Key&);
template <>
std::optional<Chosen> value_of(TableReader&, const Key&);
template <>
std::optional<double> value_of(TableReader&, const Key&);
template <>
std::optional<int> value_of(TableReader&, const Key&);
template <>
std::optional<bool> value_of(TableReader&, const Key&);
template <>
std::optional<std::vector<std::string>> value_of(TableReader&, const Key&);
template <>
std::optional<std::vector<double>> value_of(TableReader&, const Key&);
template <>
std::optional<std::vector<std::uint32_t>> value_of(TableReader&, const Key&);
template <>
std::optional<Span> value_of(TableReader&, const Key&);
template <>
std::optional<Numbers> value_of(TableReader&, const Key&);
template <>
std::optional<Translations> value_of(TableReader&, const Key&);

/// Fills one struct from `add` per table; `check` is called after the keys of a table were read.
void read_tables(TableReader&, const Key&, void* outer, void* (*add)(void* outer, std::string_view),
                 void (*check)(TableReader&, void* inner, void* outer));

namespace binding {

template <Key::Holds h, class T>
struct As {
  static constexpr Key::Holds holds = h;
  using Type = T;
};
template <class Member>
consteval auto usual() {
  using Holds = Key::Holds;
  if constexpr (std::is_same_v<Member, bool>)
    return As<Holds::flag, bool>{};
  else if constexpr (std::is_enum_v<Member>)
    return As<Holds::text, Chosen>{};
  else if constexpr (std::is_integral_v<Member>)
    return As<Holds::whole, int>{};
  else if constexpr (std::is_same_v<Member, double>)
    return As<Holds::number, double>{};
  else if constexpr (std::is_same_v<Member, std::string>)
    return As<Holds::text, std::string>{};
  else if constexpr (std::is_same_v<Member, Span>)
    return As<Holds::span, Span>{};
  else if constexpr (std::is_same_v<Member, Translations>)
    return As<Holds::translations, Translations>{};
  else if constexpr (std::is_same_v<Member, Numbers> || std::is_same_v<Member, NumberTable>)
    return As<Holds::number_table, Numbers>{};
  else if constexpr (std::is_same_v<Member, std::vector<std::string>>)
    return As<Holds::texts, Member>{};
  else if constexpr (std::is_same_v<Member, std::vector<double>>)
    return As<Holds::numbers, Member>{};
  else if constexpr (std::is_same_v<Member, std::vector<std::uint32_t>>)
    return As<Holds::wholes, Member>{};
}

template <class C, class M>
C class_of(M C::*);
template <class T>
struct Plain {
  using Type = T;
};
template <class T>
struct Plain<std::optional<T>> {
  using Type = T;
};
template <class T>
inline constexpr char tag = 0;

/// Accesses the member at the end of a path of members: &Manifest::campaign, &Campaign::id.
template <auto First, auto... Rest>
struct Path {
  using Class = decltype(class_of(First));
  static auto& in(auto& object) {
    if constexpr (sizeof...(Rest) == 0)
      return object.*First;
    else
      return Path<Rest...>::in(object.*First);
  }
  using Member = std::remove_reference_t<decltype(in(std::declval<Class&>()))>;
  using Value = typename Plain<Member>::Type;
};

template <class Kind, class Value, class Member>
void read(TableReader& reader, const Key& key, Member& to) {
  auto value = value_of<typename Kind::Type>(reader, key);
  if (!value) return;
  if constexpr (std::is_same_v<typename Kind::Type, Chosen>)
    to = static_cast<Value>(value->value);
  else if constexpr (std::is_integral_v<Value>)
    to = static_cast<Value>(*value);
  else if constexpr (std::is_same_v<Value, NumberTable>)
    to = NumberTable(value->begin(), value->end());
  else
    to = std::move(*value);
}

template <class P, class Kind>
constexpr Key::Into member() {
  return {Kind::holds,
          [](TableReader& reader, const Key& key, void* object) {
            read<Kind, typename P::Value>(reader, key,
                                          P::in(*static_cast<typename P::Class*>(object)));
          },
          &tag<typename P::Class>, nullptr, std::is_same_v<typename Kind::Type, Chosen>};
}

template <class T>
struct Table {
  using Inner = T;
  static constexpr Key::Holds holds = Key::Holds::table;
  static void* add(T& member, std::string_view) { return &member; }
};
template <class T>
struct Table<std::optional<T>> : Table<T> {
  static void* add(std::optional<T>& member, std::string_view) { return &member.emplace(); }
};
template <class T>
struct Table<std::vector<T>> {
  using Inner = T;
  static constexpr Key::Holds holds = Key::Holds::tables;
  static void* add(std::vector<T>& member, std::string_view) { return &member.emplace_back(); }
};
template <class T>
struct Table<std::map<std::string, T>> {
  using Inner = T;
  static constexpr Key::Holds holds = Key::Holds::named_tables;
  static void* add(std::map<std::string, T>& member, std::string_view name) {
    return &member[std::string(name)];
  }
};

template <auto check, Key::Holds holds, class C, class Inner, class Add>
constexpr Key::Into table(Add) {
  return {holds,
          [](TableReader& reader, const Key& key, void* object) {
            read_tables(reader, key, object, Add{}, [](TableReader& at, void* inner, void* outer) {
              if constexpr (std::is_invocable_v<decltype(check), TableReader&, Inner&>)
                check(at, *static_cast<Inner*>(inner));
              else if constexpr (!std::is_null_pointer_v<decltype(check)>)
                check(at, *static_cast<Inner*>(inner), *static_cast<C*>(outer));
            });
          },
          &tag<C>, &tag<Inner>};
}

template <auto check, class P, Key::Holds holds = Table<typename P::Member>::holds>
constexpr Key::Into nested() {
  using C = typename P::Class;
  using T = Table<typename P::Member>;
  return table<check, holds, C, typename T::Inner>([](void* outer, std::string_view name) {
    return T::add(P::in(*static_cast<C*>(outer)), name);
  });
}

template <auto read, Key::Holds holds, class P>
constexpr Key::Into by() {
  return {holds,
          [](TableReader& reader, const Key& key, void* object) {
            auto& outer = *static_cast<typename P::Class*>(object);
            auto& member = P::in(outer);
            if constexpr (std::is_invocable_v<decltype(read), TableReader&, const Key&,
                                              decltype(member)>)
              read(reader, key, member);
            else
              read(reader, key, member, outer);
          },
          &tag<typename P::Class>, &tag<typename Table<typename P::Member>::Inner>};
}

}  // namespace binding

namespace declared {

using enum Key::Holds;

template <class Kind, auto... path>
inline constexpr Key::Into as = binding::member<binding::Path<path...>, Kind>();
template <auto... path>
inline constexpr Key::Into into =
    as<decltype(binding::usual<typename binding::Path<path...>::Value>()), path...>;
template <auto... path>
inline constexpr Key::Into day = as<binding::As<date, std::string>, path...>;
template <auto... path>
inline constexpr Key::Into number_or_0 = as<binding::As<number_or_none, double>, path...>;
/// Fills a bool with the value of the chosen text (`choices`).
template <auto... path>
inline constexpr Key::Into chosen = as<binding::As<text, Chosen>, path...>;
/// Fills a struct or optional from a table, a vector from a list of tables, or a map from tables
/// under any name. After each table, `check` is called with the reader, the filled struct and, if
/// it has a third parameter, the struct that the outer table fills.
template <auto check, auto... path>
inline constexpr Key::Into checked = binding::nested<check, binding::Path<path...>>();
template <auto... path>
inline constexpr Key::Into nested = checked<nullptr, path...>;
/// Fills a vector from tables under any name. `check` is called after each table, as for `checked`.
template <auto check, auto... path>
inline constexpr Key::Into by_names =
    binding::nested<check, binding::Path<path...>, named_tables>();
/// Declares an inner table whose keys fill the same struct as the keys of the outer table. `check`
/// is called after the keys of the inner table were read.
template <class T, auto check = nullptr>
inline constexpr Key::Into same =
    binding::table<check, table, T, T>([](void* outer, std::string_view) { return outer; });
/// Declares a whole file whose keys fill a T.
template <class T>
inline constexpr Key::Into file{table, nullptr, nullptr, &binding::tag<T>};
/// Reads a key with the function `read(reader, key, member)`. If `read` has a fourth parameter, it
/// also receives the struct that contains the member.
template <auto read, Key::Holds holds, auto... path>
inline constexpr Key::Into by = binding::by<read, holds, binding::Path<path...>>();

template <std::size_t n, std::size_t m>
consteval std::array<Key, n + m> joined(const Key (&first)[n], const Key (&second)[m]) {
  return [&]<std::size_t... i, std::size_t... j>(std::index_sequence<i...>,
                                                 std::index_sequence<j...>) {
    return std::array<Key, n + m>{first[i]..., second[j]...};
  }
  (std::make_index_sequence<n>{}, std::make_index_sequence<m>{});
}

template <class T>
constexpr Choice choice(T value, std::string_view name, std::string_view meaning = {}) {
  return {name, meaning, static_cast<int>(value)};
}

struct Unit {
  std::string_view name;
  double scale = 1.0;
  constexpr void operator()(Key& key) const { key.unit = name, key.scale = scale; }
};
struct Range {
  std::string_view wanted;
  std::optional<double> least{}, most{};
  bool above = false;
  constexpr void operator()(Key& key) const {
    key.wanted = wanted, key.least = least, key.most = most, key.above = above;
  }
};
constexpr Range from(double least, std::string_view wanted) { return {wanted, least}; }
constexpr Range above(double least, std::string_view wanted) { return {wanted, least, {}, true}; }
constexpr Range within(double least, double most, std::string_view wanted) {
  return {wanted, least, most};
}
constexpr auto wanted(std::string_view words) {
  return [=](Key& key) { key.wanted = words; };
}
constexpr auto spelled(const TextRule& rule, std::string_view wanted = {}) {
  return [=](Key& key) { key.text = rule, key.wanted = wanted; };
}
inline constexpr auto required = [](Key& key) { key.required = true; };
constexpr auto missing(std::string_view words) {
  return [=](Key& key) { key.required = true, key.missing = words; };
}
constexpr auto otherwise(std::string_view value) {
  return [=](Key& key) { key.otherwise = value; };
}
constexpr auto only(When when) {
  return [=](Key& key) { key.only = when; };
}
constexpr auto former(std::string_view name) {
  return [=](Key& key) { key.former = name; };
}
constexpr auto longest(std::size_t entries) {
  return [=](Key& key) { key.longest_list = entries; };
}
inline constexpr auto distinct = [](Key& key) { key.distinct = true; };
inline constexpr auto secret = [](Key& key) { key.may_be_secret = true; };
/// Key `kind` defaults to rotary if the name of the axis begins with A, B or C (ISO 841).
inline constexpr auto kind_by_name = [](Key& key) {
  key.initials = "ABC", key.by_name = "kind", key.named_so = "rotary";
};

}  // namespace declared
}  // namespace nonio::config
