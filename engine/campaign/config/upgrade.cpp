// SPDX-License-Identifier: Apache-2.0
#include "campaign/config/upgrade.h"

#include <algorithm>

#include "campaign/config/toml_reader.h"

namespace nonio::config {
namespace {

bool is_of_key(char c) {
  return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '_' ||
         c == '-';
}

std::size_t key_in(std::string_view line, std::string_view name) {
  for (std::size_t at = line.find(name); at != std::string_view::npos;
       at = line.find(name, at + 1)) {
    std::size_t end = at + name.size();
    if ((at > 0 && is_of_key(line[at - 1])) || (end < line.size() && is_of_key(line[end])))
      continue;
    if (end < line.size() && (line[end] == '"' || line[end] == '\'')) ++end;
    end = std::min(line.find_first_not_of(" \t", end), line.size());
    if (end < line.size() && (line[end] == '=' || line[end] == ']' || line[end] == '.')) return at;
  }
  return std::string_view::npos;
}

std::size_t value_in(std::string_view line, const std::string& value) {
  for (const char quote : {'"', '\''})
    if (const std::size_t at = line.find(quote + value + quote); at != std::string_view::npos)
      return at + 1;
  return std::string_view::npos;
}

std::vector<std::string> lines_of(std::string_view text) {
  std::vector<std::string> lines;
  while (!text.empty()) {
    const std::size_t end = std::min(text.find('\n'), text.size() - 1) + 1;
    lines.emplace_back(text.substr(0, end));
    text.remove_prefix(end);
  }
  return lines;
}

std::string without_end(std::string line) {
  line.erase(line.find_last_not_of("\r\n") + 1);
  return line;
}

tl::unexpected<Error> by_hand(const FormerKey& key, const std::string& file) {
  return fail(
      Error{"cannot be changed safely; rename " + key.former + " to " + key.name + " by hand", file,
            key.line});
}

}  // namespace

Expected<UpgradedFile> upgraded(std::string_view text, const Key& declaration,
                                const std::string& file) {
  NONIO_TRY(auto before, parse_toml(text, file));
  const std::vector<FormerKey> keys = rename_former_keys(before, declaration);
  UpgradedFile out{std::string(text), {}};
  if (keys.empty()) return out;
  std::vector<std::string> lines = lines_of(text);
  const std::vector<std::string> old_lines = lines;
  for (const FormerKey& key : keys) {
    if (key.line == 0 || key.line > lines.size()) return by_hand(key, file);
    std::string& line = lines[key.line - 1];
    std::size_t at = key_in(line, key.former);
    if (key.is_value) at = value_in(line, key.former);
    if (at == std::string::npos) return by_hand(key, file);
    line.replace(at, key.former.size(), key.name);
  }
  out.text.clear();
  for (std::size_t i = 0; i < lines.size(); ++i) {
    out.text += lines[i];
    if (lines[i] != old_lines[i])
      out.lines.push_back({i + 1, without_end(old_lines[i]), without_end(lines[i])});
  }
  auto after = parse_toml(out.text, file);
  if (!after || !rename_former_keys(*after, declaration).empty() || !(*after == before))
    return by_hand(keys.front(), file);
  return out;
}

}  // namespace nonio::config
