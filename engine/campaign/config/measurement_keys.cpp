// SPDX-License-Identifier: Apache-2.0
#include "campaign/config/measurement_keys.h"

#include <algorithm>

#include "campaign/config/bind.h"
#include "nonio/sdk/format.h"

namespace nonio::config {
namespace {

using Holds = Key::Holds;

std::span<const Key> common_keys() { return find_key(campaign_file().keys, "measurement")->keys; }

Holds holds_of(const Setting& value) {
  return std::visit(
      []<class T>(const T&) {
        if constexpr (std::is_same_v<T, NumberTables>)
          return Holds::by_kind;
        else
          return decltype(binding::usual<T>())::holds;
      },
      value);
}

void read_setting(TableReader& reader, const Key& key, void* measurement) {
  auto& values = static_cast<Measurement*>(measurement)->settings.values;
  std::visit(
      [&]<class T>(T& to) {
        if constexpr (!std::is_same_v<T, NumberTables>)
          binding::read<decltype(binding::usual<T>()), T>(reader, key, to);
      },
      values.find(key.name)->second);
}

/// Returns the method's text, otherwise the limits of the option, for messages.
std::string expected_of(const Option& option) {
  if (!option.expected.empty()) return option.expected;
  if (std::holds_alternative<std::string>(option.default_value)) {
    std::string words;
    if (option.max) words = "expected up to " + short_text(*option.max, 6) + " characters";
    if (option.forbidden.empty()) return words;
    return (words.empty() ? "expected a text" : words) + " without " + option.forbidden;
  }
  if (!option.min && !option.max) return {};
  return "expected a number" +
         (option.min ? " from " + short_text(*option.min, 6) : std::string()) +
         (option.max ? " up to " + short_text(*option.max, 6) : std::string());
}

bool same_names(std::span<const Choice> a, std::span<const Choice> b) {
  return std::equal(a.begin(), a.end(), b.begin(), b.end(),
                    [](const Choice& x, const Choice& y) { return x.name == y.name; });
}

bool declared_alike(const Key& a, const Key& b) {
  return a.holds == b.holds && a.least == b.least && a.most == b.most &&
         a.text.longest == b.text.longest && a.text.not_letters == b.text.not_letters &&
         same_names(a.choices, b.choices);
}

}  // namespace

const Key* common_key(std::string_view name) { return find_key(common_keys(), name); }

KindKeys::KindKeys(const Method& method)
    : keys_(common_keys().begin(), common_keys().end()),
      table_(*find_key(campaign_file().keys, "measurement")) {
  for (const Option& option : method.info.options) keys_.push_back(key_of(option));
  table_.keys = keys_;
}

Key KindKeys::key_of(const Option& option) {
  Key key{option.name,
          {holds_of(option.default_value), read_setting, &binding::tag<Measurement>},
          option.help};
  key.unit = option.unit;
  key.required = option.required;
  key.missing = option.missing;
  key.wanted = texts_.emplace_back(expected_of(option));
  if (key.holds == Holds::text) {
    key.text.not_letters = option.forbidden;
    if (option.max) key.text.longest = static_cast<std::size_t>(*option.max);
  } else {
    key.least = option.min;
    key.most = option.max;
  }
  auto& choices = choices_.emplace_back();
  for (const std::string& choice : option.choices) choices.push_back({choice});
  key.choices = choices;
  return key;
}

CampaignKeys::CampaignKeys(const std::vector<Method>& methods)
    : measurement_(common_keys().begin(), common_keys().end()),
      top_(campaign_file().keys.begin(), campaign_file().keys.end()),
      file_(campaign_file()) {
  for (const Method& method : methods) {
    const KindKeys& kind = of_kinds_.emplace_back(method);
    for (std::size_t i = common_keys().size(); i < kind.keys_.size(); ++i)
      add(method, kind.keys_[i]);
  }
  for (std::size_t i = 0; i < kinds_.size(); ++i) {
    Key& key = measurement_[common_keys().size() + i];
    key.required = false;
    key.only = {"kind", kinds_[i].declaring};
    if (!kinds_[i].requiring.empty()) key.needed = {"kind", kinds_[i].requiring};
  }
  for (Key& key : top_)
    if (key.name == "measurement") key.keys = measurement_;
  file_.keys = top_;
}

void CampaignKeys::add(const Method& method, const Key& key) {
  const std::size_t common = common_keys().size();
  const auto known =
      std::find_if(measurement_.begin() + static_cast<std::ptrdiff_t>(common), measurement_.end(),
                   [&](const Key& other) { return other.name == key.name; });
  const auto at = static_cast<std::size_t>(known - measurement_.begin()) - common;
  if (known == measurement_.end()) {
    measurement_.push_back(key);
    kinds_.emplace_back();
  } else if (!declared_alike(*known, key)) {
    known->holds = Holds::by_kind;
  }
  kinds_[at].declaring.push_back(method.info.name);
  if (key.required) kinds_[at].requiring.push_back(method.info.name);
}

}  // namespace nonio::config
