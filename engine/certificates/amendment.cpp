// SPDX-License-Identifier: Apache-2.0
#include "certificates/amendment.h"

#include <toml++/toml.h>

#include <algorithm>
#include <sstream>
#include <string_view>
#include <vector>

namespace nonio::certificates {

namespace {

using Keys = std::map<std::string, std::string>;

std::string toml_text(const toml::node& node) {
  if (const auto text = node.value_exact<std::string>()) return *text;
  std::ostringstream out;
  node.visit([&](const auto& value) { out << value; });
  return out.str();
}

void flatten(const toml::node& node, const std::string& place, Keys& out) {
  const auto below = [&](std::string_view key) {
    return place.empty() ? std::string(key) : place + "." + std::string(key);
  };
  if (const toml::table* table = node.as_table()) {
    for (const auto& [key, value] : *table) flatten(value, below(key.str()), out);
    return;
  }
  const toml::array* list = node.as_array();
  if (list == nullptr || list->empty() || !list->is_homogeneous(toml::node_type::table)) {
    out[place] = toml_text(node);
    return;
  }
  for (std::size_t i = 0; i < list->size(); ++i) {
    const toml::table& one = *list->get_as<toml::table>(i);
    std::string name = one["id"].value_or(std::to_string(i + 1));
    if (out.contains(below(name) + ".id")) name += "(" + std::to_string(i + 1) + ")";
    flatten(one, below(name), out);
  }
}

std::vector<std::string> lines_of(std::string_view text) {
  std::vector<std::string> lines;
  while (!text.empty()) {
    const std::size_t end = std::min(text.find('\n'), text.size());
    std::string_view line = text.substr(0, end);
    if (line.ends_with('\r')) line.remove_suffix(1);
    lines.emplace_back(line);
    text.remove_prefix(std::min(end + 1, text.size()));
  }
  return lines;
}

bool is_text(std::string_view bytes) {
  constexpr std::size_t longest_line = 500;
  std::size_t line = 0;
  for (const char c : bytes) {
    line = c == '\n' ? 0 : line + 1;
    if (c == '\0' || line > longest_line) return false;
  }
  return true;
}

class ChangeList {
 public:
  explicit ChangeList(FileChange& into) : into_(into) {}
  void add(Change change) {
    if (into_.changes.size() < most_changes)
      into_.changes.push_back(std::move(change));
    else
      ++into_.more;
  }

 private:
  FileChange& into_;
};

void compare_keys(const Keys& before, const Keys& after, FileChange& out) {
  ChangeList list(out);
  for (const auto& [key, value] : after) {
    const auto old = before.find(key);
    if (key == amendment_key || (old != before.end() && old->second == value)) continue;
    list.add({key, 0, old == before.end() ? std::nullopt : std::optional(old->second), value});
  }
  for (const auto& [key, value] : before)
    if (key != amendment_key && !after.contains(key)) list.add({key, 0, value, std::nullopt});
}

/// Between the equal lines at both ends, lines are compared one by one if the files have the same
/// number of lines; otherwise all removed and all new lines are listed.
void compare_lines(const std::vector<std::string>& a, const std::vector<std::string>& b,
                   FileChange& out) {
  ChangeList list(out);
  std::size_t begin = 0, end = 0;
  const std::size_t shorter = std::min(a.size(), b.size());
  while (begin < shorter && a[begin] == b[begin]) ++begin;
  while (end < shorter - begin && a[a.size() - 1 - end] == b[b.size() - 1 - end]) ++end;
  if (a.size() == b.size()) {
    for (std::size_t i = begin; i < a.size() - end; ++i)
      if (a[i] != b[i]) list.add({{}, i + 1, a[i], b[i]});
    return;
  }
  for (std::size_t i = begin; i < a.size() - end; ++i) list.add({{}, i + 1, a[i], std::nullopt});
  for (std::size_t i = begin; i < b.size() - end; ++i) list.add({{}, i + 1, std::nullopt, b[i]});
}

}  // namespace

std::map<std::string, std::string> flat_toml(std::string_view text) {
  Keys out;
  try {
    flatten(toml::parse(text), "", out);
  } catch (const toml::parse_error&) {
    out.clear();
  }
  return out;
}

FileChange change_of(const std::string& file, const std::string* before, const std::string* after) {
  FileChange change{file};
  if (before == nullptr || after == nullptr) return change;
  if (file.ends_with(".toml"))
    compare_keys(flat_toml(*before), flat_toml(*after), change);
  else if (is_text(*before) && is_text(*after))
    compare_lines(lines_of(*before), lines_of(*after), change);
  return change;
}

}  // namespace nonio::certificates
