// SPDX-License-Identifier: Apache-2.0
#include "nonio/sdk/templates.h"

#include <stdexcept>

namespace nonio {

namespace {

constexpr std::string_view words_folder = "words/";

/// Language of a name such as "words/en/site"; empty for other tables.
std::string_view language_of(std::string_view name) {
  if (!name.starts_with(words_folder)) return {};
  name.remove_prefix(words_folder.size());
  const std::size_t end = name.find('/');
  return end == std::string_view::npos ? std::string_view() : name.substr(0, end);
}

bool is_gathered(std::string_view key) {
  return key.starts_with("finding.") || key.starts_with("note.") || key.starts_with("term.");
}

}  // namespace

void TemplateTables::read_later(std::set<std::string> languages, Reader reader) {
  unread_ = {languages.begin(), languages.end()};
  reader_ = std::move(reader);
}

void TemplateTables::read(std::string_view language) const {
  const std::lock_guard lock(*lock_);
  read_now(language);
}

void TemplateTables::read_now(std::string_view language) const {
  const auto it = unread_.find(language);
  if (it == unread_.end()) return;
  const std::string& now = *it;
  reader_(now, tables_);
  gather(now);
  unread_.erase(it);
}

void TemplateTables::gather(const std::string& language) const {
  const std::string folder = std::string(words_folder) + language + "/";
  Settings& all = gathered_[language];
  for (auto table = tables_.lower_bound(folder);
       table != tables_.end() && table->first.starts_with(folder); ++table) {
    auto& values = table->second.values;
    for (auto it = values.begin(); it != values.end();) {
      const auto value = it++;
      if (is_gathered(value->first)) all.values.insert(values.extract(value));
    }
  }
}

Settings& TemplateTables::operator[](const std::string& name) {
  read(language_of(name));
  return tables_[name];
}

const Settings& TemplateTables::at(std::string_view name) const {
  const auto it = find(name);
  if (it == end()) throw std::out_of_range("no template " + std::string(name));
  return it->second;
}

TemplateTables::Map::const_iterator TemplateTables::find(std::string_view name) const {
  const std::lock_guard lock(*lock_);
  read_now(language_of(name));
  return tables_.find(name);
}

TemplateTables::Map::const_iterator TemplateTables::begin() const {
  const std::lock_guard lock(*lock_);
  while (!unread_.empty()) read_now(*unread_.begin());
  return tables_.begin();
}

std::string TemplateTables::text(std::string_view language, std::string_view key) const {
  const std::lock_guard lock(*lock_);
  read_now(language);
  if (const auto all = gathered_.find(language); all != gathered_.end() && is_gathered(key))
    return all->second.text(key);
  const std::string folder = std::string(words_folder).append(language) + "/";
  for (auto it = tables_.lower_bound(folder); it != tables_.end() && it->first.starts_with(folder);
       ++it)
    if (it->second.has(key)) return it->second.text(key);
  return {};
}

}  // namespace nonio
