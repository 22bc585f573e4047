// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <string>
#include <string_view>

#include "campaign/config/keys.h"
#include "campaign/schema/schema.h"

namespace nonio::schema {

namespace {

std::string help_of(const config::Key& file, std::string_view path) {
  const config::Key* key = &file;
  while (key != nullptr && !path.empty()) {
    const std::size_t end = std::min(path.find('.'), path.size());
    key = config::find_key(key->keys, path.substr(0, end));
    path.remove_prefix(std::min(end + 1, path.size()));
  }
  if (key == nullptr) return {};
  const std::string help(key->help);
  return key->unit.empty() ? help : std::string(key->unit) + ": " + help;
}

}  // namespace

std::string campaign_key_help(std::string_view path) {
  return help_of(config::campaign_file(), path);
}
std::string site_key_help(std::string_view path) { return help_of(config::site_file(), path); }

}  // namespace nonio::schema
