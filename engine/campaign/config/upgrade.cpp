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

// Replaces names from earlier versions in campaign.toml and site.toml: names of keys, and ids of
// findings.
namespace {

/// First version that rejects the former names.
constexpr const char* accepted_until = "0.3";

struct FormerFinding {
  std::string_view plugin, former, name;
};
constexpr FormerFinding former_findings[] = {{"rtcp.", "not-told", "not-identifiable"},
                                             {"rtcp.", "not-told-ball", "not-identifiable-ball"},
                                             {"rotary-chain.", "not-told", "not-identifiable"}};

class Renaming {
 public:
  void table(toml::table& table, const Key& declaration, const std::string& place) {
    for (const Key& key : declaration.keys) {
      rename(table, key, place);
      toml::node* node = table.get(key.name);
      if (node == nullptr) continue;
      if (key.name == "finding") rename_finding(*node, place);
      const std::string inside =
          place.empty() ? std::string(key.name) : place + "." + std::string(key.name);
      if (key.holds == Key::Holds::named_tables)
        each_of(*node, key, inside);
      else
        tables(*node, key, inside);
    }
  }

  std::vector<FormerKey> in_order() && {
    std::stable_sort(found_.begin(), found_.end(),
                     [](const FormerKey& a, const FormerKey& b) { return a.line < b.line; });
    return std::move(found_);
  }

 private:
  void rename(toml::table& in, const Key& key, const std::string& place) {
    const auto old = key.former.empty() ? in.end() : in.find(key.former);
    if (old == in.end() || in.contains(key.name)) return;
    const std::uint64_t line = old->first.source().begin.line;
    note(key, place, line);
    // Each further [[header]] of a list also contains the former name, so its line is reported too.
    if (const toml::array* list = old->second.as_array())
      for (const toml::node& one : *list)
        if (const toml::table* headed = one.as_table();
            headed != nullptr && !headed->is_inline() && headed->source().begin.line != line)
          note(key, place, headed->source().begin.line);
    in.insert(toml::key(key.name, toml::source_region(old->first.source())),
              std::move(old->second));
    in.erase(key.former);
  }

  void rename_finding(toml::node& node, const std::string& place) {
    toml::value<std::string>* id = node.as_string();
    if (id == nullptr) return;
    for (const FormerFinding& f : former_findings) {
      const std::string former = std::string(f.plugin) + std::string(f.former);
      if (id->get() != former) continue;
      const std::string name = std::string(f.plugin) + std::string(f.name);
      found_.push_back({place, former, name, node.source().begin.line, true});
      *id = name;
      return;
    }
  }

  void note(const Key& key, const std::string& place, std::uint64_t line) {
    found_.push_back({place, std::string(key.former), std::string(key.name), line});
  }

  void tables(toml::node& node, const Key& declaration, const std::string& place) {
    if (toml::table* one = node.as_table()) return table(*one, declaration, place);
    if (toml::array* list = node.as_array())
      for (toml::node& one : *list)
        if (toml::table* inner = one.as_table()) table(*inner, declaration, place);
  }

  void each_of(toml::node& node, const Key& declaration, const std::string& place) {
    if (toml::table* named = node.as_table())
      for (auto&& [name, one] : *named)
        tables(one, declaration, place + "." + std::string(name.str()));
  }

  std::vector<FormerKey> found_{};
};

}  // namespace

std::vector<FormerKey> rename_former_keys(toml::table& table, const Key& declaration) {
  Renaming renaming;
  renaming.table(table, declaration, {});
  return std::move(renaming).in_order();
}

std::vector<Error> warnings_of(const std::vector<FormerKey>& keys, const std::string& file) {
  std::vector<Error> warnings;
  for (std::size_t i = 0; i < keys.size(); ++i) {
    const FormerKey& k = keys[i];
    const auto same = [&](const FormerKey& other) {
      return other.place == k.place && other.former == k.former;
    };
    if (std::any_of(keys.begin(), keys.begin() + static_cast<std::ptrdiff_t>(i), same)) continue;
    const std::string before = k.place.empty() || k.is_value ? "" : k.place + ".";
    warnings.push_back(Error{"warning: " + before + k.former + " is now named " + before + k.name +
                                 "; `nonio upgrade` renames it. Version " + accepted_until +
                                 " will reject the former name",
                             file, k.line});
  }
  return warnings;
}

}  // namespace nonio::config
