// SPDX-License-Identifier: Apache-2.0
#include "campaign/config/keys.h"

#include <algorithm>

namespace nonio::config {
namespace {

/// Whether a class of letters such as "a-z0-9_-" contains a character.
bool has_letter(std::string_view letters, char c) {
  for (std::size_t i = 0; i < letters.size(); ++i) {
    const bool range = i + 2 < letters.size() && letters[i + 1] == '-';
    if (range ? c >= letters[i] && c <= letters[i + 2] : c == letters[i]) return true;
    if (range) i += 2;
  }
  return false;
}

}  // namespace

bool obeys(std::string_view text, const TextRule& rule) {
  if (text.empty()) return true;
  const bool letters = std::all_of(text.begin(), text.end(), [&](char c) {
    return rule.letters.empty() || has_letter(rule.letters, c);
  });
  return letters && text.find_first_of(rule.not_letters) == std::string_view::npos &&
         rule.not_first.find(text.front()) == std::string_view::npos &&
         text.size() >= rule.shortest && (rule.longest == 0 || text.size() <= rule.longest) &&
         std::find(rule.except.begin(), rule.except.end(), text) == rule.except.end() &&
         text.starts_with(rule.begins);
}

bool in_range(double value, const Key& key) {
  if (key.least && (key.above ? !(value > *key.least) : !(value >= *key.least))) return false;
  return !key.most || value <= *key.most;
}

const Key* find_key(std::span<const Key> keys, std::string_view name) {
  const auto found =
      std::find_if(keys.begin(), keys.end(), [&](const Key& key) { return key.name == name; });
  return found == keys.end() ? nullptr : &*found;
}

}  // namespace nonio::config
