// SPDX-License-Identifier: Apache-2.0
#include "campaign/modelling/model_edit.h"

#include <algorithm>
#include <optional>
#include <vector>

#include "campaign/config/toml_reader.h"
#include "platform/storage/json_values.h"

namespace nonio::modelling {

namespace {

using Names = std::vector<std::string>;

/// toml++ numbers lines and columns from 1 and measures columns in code points.
std::size_t offset_of(std::string_view text, toml::source_position at) {
  std::size_t i = text.starts_with("\xEF\xBB\xBF") ? 3 : 0;
  for (toml::source_index line = 1; line < at.line; ++line) {
    const std::size_t end = text.find('\n', i);
    if (end == std::string_view::npos) return text.size();
    i = end + 1;
  }
  for (toml::source_index column = 1; column < at.column && i < text.size(); ++column) {
    ++i;
    while (i < text.size() && (static_cast<unsigned char>(text[i]) & 0xC0U) == 0x80U) ++i;
  }
  return i;
}

std::size_t next_mark(std::string_view text, std::size_t i) {
  while (i < text.size()) {
    if (text[i] == '#')
      i = std::min(text.find('\n', i), text.size());
    else if (text[i] == ' ' || text[i] == '\t' || text[i] == '\r' || text[i] == '\n')
      ++i;
    else
      break;
  }
  return i;
}

std::size_t line_begin(std::string_view text, std::size_t i) {
  const std::size_t before = i == 0 ? std::string_view::npos : text.rfind('\n', i - 1);
  return before == std::string_view::npos ? 0 : before + 1;
}

std::size_t line_end(std::string_view text, std::size_t i) {
  std::size_t end = std::min(text.find('\n', i), text.size());
  if (end > i && end < text.size() && text[end - 1] == '\r') --end;
  return end;
}

std::string newline_of(std::string_view text) {
  const std::size_t end = text.find('\n');
  return end != std::string_view::npos && end > 0 && text[end - 1] == '\r' ? "\r\n" : "\n";
}

std::string quoted(const std::string& name) { return "\"" + name + "\""; }

/// Element of a list: [begin, end) includes quotes. `comma`: position of the next comma.
struct Item {
  std::size_t begin, end;
  std::optional<std::size_t> comma;
};

struct List {
  std::size_t open, close;  ///< positions of the brackets
  std::vector<Item> items;
};

std::size_t text_end(std::string_view text, std::size_t i) {
  const char quote = text[i];
  const std::string three(3, quote);
  if (text.substr(i).starts_with(three)) {
    const std::size_t end = text.find(three, i + 3);
    return end == std::string_view::npos ? text.size() : end + 3;
  }
  for (++i; i < text.size() && text[i] != quote; ++i)
    if (text[i] == '\\' && quote == '"') ++i;
  return std::min(i + 1, text.size());
}

std::size_t word_end(std::string_view text, std::size_t i) {
  const std::size_t end = text.find_first_of(" \t\r\n,]}#\"'[", i);
  return std::min(end, text.size());
}

std::optional<List> list_at(std::string_view text, std::size_t open) {
  if (open >= text.size() || text[open] != '[') return std::nullopt;
  List list{open, 0, {}};
  for (std::size_t i = next_mark(text, open + 1); i < text.size(); i = next_mark(text, i)) {
    if (text[i] == ']') {
      list.close = i;
      return list;
    }
    if (text[i] == ',' && !list.items.empty())
      list.items.back().comma = i++;
    else {
      const bool is_text = text[i] == '"' || text[i] == '\'';
      const std::size_t end = is_text ? text_end(text, i) : word_end(text, i);
      if (end == i) return std::nullopt;
      list.items.push_back({i, end, std::nullopt});
      i = end;
    }
  }
  return std::nullopt;
}

std::string appended(std::string_view text, const List& list, const std::string& value) {
  std::string out(text);
  if (list.items.empty()) return out.insert(list.open + 1, value);
  const Item& last = list.items.back();
  const std::size_t after = last.comma ? *last.comma + 1 : last.end;
  const std::size_t end = line_end(text, after);
  const bool own_line = list.items.size() > 1
                            ? line_begin(text, last.begin) > list.items[list.items.size() - 2].begin
                            : line_begin(text, last.begin) > list.open;
  if (own_line && list.close > end) {
    const std::size_t begin = line_begin(text, last.begin);
    const std::string indent(text.substr(begin, text.find_first_not_of(" \t", begin) - begin));
    out.insert(end, newline_of(text) + indent + value + (last.comma ? "," : ""));
    if (!last.comma) out.insert(last.end, ",");
    return out;
  }
  const std::string before = last.comma ? " " : ", ";
  if (own_line) {
    const std::size_t begin = line_begin(text, last.begin);
    const std::string indent(text.substr(begin, text.find_first_not_of(" \t", begin) - begin));
    return out.insert(after, (last.comma ? "" : ",") + newline_of(text) + indent + value);
  }
  return out.insert(after, before + value + (last.comma ? "," : ""));
}

bool blank(std::string_view text) {
  return text.find_first_not_of(" \t\r") == std::string_view::npos;
}

std::string removed(std::string_view text, const List& list, std::size_t index) {
  std::string out(text);
  const Item& item = list.items[index];
  const bool last = index + 1 == list.items.size();
  std::size_t begin = item.begin, end = item.end;
  if (item.comma && (blank(text.substr(item.end, *item.comma - item.end)))) end = *item.comma + 1;
  const std::size_t from = line_begin(text, begin), to = line_end(text, end);
  const bool alone = from > list.open && blank(text.substr(from, begin - from)) &&
                     blank(text.substr(end, to - end));
  if (alone) {  // the element fills its line
    begin = from;
    end = std::min(text.find('\n', to), text.size());
    if (end < text.size()) ++end;
  } else if (!last && end < text.size()) {
    end = std::min(text.find_first_not_of(" \t", end), text.size());
  }
  out.erase(begin, end - begin);
  if (item.comma && *item.comma >= end) {
    out.erase(*item.comma - (end - begin), 1);
  } else if (!item.comma && index > 0) {
    const std::size_t comma = *list.items[index - 1].comma;
    const bool apart =
        text.substr(comma + 1, begin - comma - 1).find_first_not_of(" \t\r\n") != text.npos;
    const std::size_t blanks = apart ? 1 : begin - comma;
    out.erase(comma, alone ? 1 : blanks);
  }
  return out;
}

Names names_in(const toml::table& root) {
  Names names;
  if (const toml::array* list = root["model"]["effects"].as_array())
    for (const toml::node& node : *list) names.push_back(node.value_or(std::string()));
  return names;
}

bool differs_elsewhere(toml::table a, toml::table b) {
  for (toml::table* root : {&a, &b})
    if (toml::table* model = (*root)["model"].as_table()) {
      model->erase("effects");
      if (model->empty()) root->erase("model");
    }
  return a != b;
}

bool is_meant(const toml::table& before, const std::string& text, const Names& wanted) {
  const auto after = config::parse_toml(text, config::manifest_name);
  return after && names_in(*after) == wanted && !differs_elsewhere(before, *after);
}

tl::unexpected<Error> refusal(const std::string& why, std::uint64_t line) {
  return fail(Error{"model.effects: " + why + "; nothing was changed, edit the list by hand",
                    config::manifest_name, line});
}

/// Returns the possible texts: a list below a header [model], or a new table at the end.
std::vector<std::string> with_new_list(std::string_view text, const std::string& effect) {
  const std::string nl = newline_of(text), line = "effects = [" + quoted(effect) + "]";
  std::vector<std::string> out;
  for (std::size_t i = 0; i < text.size(); i = std::min(text.find('\n', i), text.size() - 1) + 1) {
    std::size_t at = text.find_first_not_of(" \t", i);
    if (at == std::string_view::npos || text[at] != '[') continue;
    std::string header;
    for (++at; at < text.size() && text[at] != '\n' && text[at] != '#'; ++at)
      if (text[at] != ' ' && text[at] != '\t' && text[at] != '\r') header += text[at];
    if (header != "model]" && header != "\"model\"]") continue;
    std::string one(text);
    out.push_back(one.insert(line_end(text, i), nl + line));
  }
  std::string whole(text);
  if (!whole.empty() && whole.back() != '\n') whole += nl;
  out.push_back(whole + nl + "[model]" + nl + line + nl);
  return out;
}

struct Parsed {
  toml::table root;
  std::optional<List> list;
  std::uint64_t line = 0;
};

Expected<Parsed> look(std::string_view text) {
  NONIO_TRY(auto root, config::parse_toml(text, config::manifest_name));
  Parsed out{std::move(root), std::nullopt, 0};
  const toml::node* node = out.root["model"]["effects"].node();
  if (node == nullptr) return out;
  out.line = node->source().begin.line;
  if (node->is_array()) out.list = list_at(text, offset_of(text, node->source().begin));
  const toml::array* const all = node->as_array();
  if (!out.list || out.list->items.size() != all->size() ||
      std::any_of(all->begin(), all->end(), [](const auto& one) { return !one.is_string(); }))
    return refusal("expected a list of texts", out.line);
  return out;
}

}  // namespace

Expected<std::string> with_effect(std::string_view text, const std::string& effect) {
  NONIO_TRY(const auto parsed, look(text));
  Names wanted = names_in(parsed.root);
  wanted.push_back(effect);
  const std::vector<std::string> tries =
      parsed.list ? std::vector{appended(text, *parsed.list, quoted(effect))}
                  : with_new_list(text, effect);
  for (const std::string& one : tries)
    if (is_meant(parsed.root, one, wanted)) return one;
  return refusal("\"" + effect + "\" could not be added without changing something else",
                 parsed.line);
}

Expected<std::string> without_effect(std::string_view text, const std::string& effect) {
  NONIO_TRY(const auto parsed, look(text));
  Names wanted = names_in(parsed.root);
  const auto found = std::find(wanted.begin(), wanted.end(), effect);
  if (found == wanted.end()) return refusal("\"" + effect + "\" is not in it", parsed.line);
  const auto index = static_cast<std::size_t>(found - wanted.begin());
  wanted.erase(found);
  std::string one = removed(text, *parsed.list, index);
  if (is_meant(parsed.root, one, wanted)) return one;
  return refusal("\"" + effect + "\" could not be taken out without changing something else",
                 parsed.line);
}

namespace {

tl::unexpected<Error> not_meant(const std::string& key, const toml::table& table) {
  return fail(Error{key + ": could not be written without changing something else; nothing was "
                          "changed, edit it by hand",
                    config::manifest_name, table.source().begin.line});
}

std::string with_line(std::string_view text, const toml::table& table, const char* behind,
                      const std::string& line) {
  const toml::node* const above = table.get(behind);
  const std::size_t at = offset_of(text, (above == nullptr ? table : *above).source().begin);
  const auto list = above != nullptr ? list_at(text, at) : std::nullopt;
  const std::size_t begin = line_begin(text, at);
  const std::string indent(text.substr(begin, text.find_first_not_of(" \t", begin) - begin));
  std::string out(text);
  return out.insert(line_end(text, list ? list->close : at), newline_of(text) + indent + line);
}

std::string with_value(std::string_view text, const toml::node& node, const std::string& value) {
  const std::size_t at = offset_of(text, node.source().begin);
  const std::size_t end = node.is_string() ? text_end(text, at) : word_end(text, at);
  std::string out(text);
  return out.replace(at, end - at, value);
}

toml::table* measurement_in(toml::table& root, const std::string& id) {
  if (toml::array* const all = root["measurement"].as_array())
    for (toml::node& one : *all)
      if (toml::table* const table = one.as_table(); table && (*table)["id"].value_or("") == id)
        return table;
  return nullptr;
}

}  // namespace

Expected<std::string> with_excluded(std::string_view text, const std::string& measurement,
                                    const std::vector<std::uint32_t>& lines,
                                    const std::string& why) {
  NONIO_TRY(auto root, config::parse_toml(text, config::manifest_name));
  toml::table* table = measurement_in(root, measurement);
  if (table == nullptr)
    return fail(Error{"there is no measurement \"" + measurement + "\"", config::manifest_name});
  toml::array wanted;
  if (const toml::array* const there = (*table)["exclude"].as_array()) wanted = *there;
  std::string out(text), numbers;
  for (const std::uint32_t line : lines) {
    const auto is_line = [&](const toml::node& one) { return one.value_or(-1LL) == line; };
    if (std::any_of(wanted.begin(), wanted.end(), is_line)) continue;
    wanted.push_back(static_cast<std::int64_t>(line));
    numbers += (numbers.empty() ? "" : ", ") + std::to_string(line);
  }
  if (const toml::node* const there = table->get("exclude")) {
    const auto list = list_at(text, offset_of(text, there->source().begin));
    if (!list) return not_meant("exclude", *table);
    if (!numbers.empty()) out = appended(text, *list, numbers);
  } else if (!numbers.empty()) {
    out = with_line(text, *table, "file", "exclude = [" + numbers + "]");
  }
  table->insert_or_assign("exclude", std::move(wanted));
  auto half = config::parse_toml(out, config::manifest_name);
  toml::table* const now = half ? measurement_in(*half, measurement) : nullptr;
  if (now == nullptr) return not_meant("exclude", *table);
  const std::string before = (*now)["exclude_reason"].value_or(std::string());
  std::string reason = before;
  if (before.find(why) == std::string::npos) reason += (before.empty() ? "" : "; ") + why;
  const std::string value = storage::Json(reason).dump();
  if (const toml::node* const there = now->get("exclude_reason"))
    out = with_value(out, *there, value);
  else
    out = with_line(out, *now, "exclude", "exclude_reason = " + value);
  table->insert_or_assign("exclude_reason", reason);
  const auto after = config::parse_toml(out, config::manifest_name);
  if (!after || *after != root) return not_meant("exclude", *table);
  return out;
}

Expected<std::string> with_period(std::string_view text, const std::string& axis, double mm) {
  constexpr const char* key = "screw_pitch_mm";
  NONIO_TRY(auto root, config::parse_toml(text, config::manifest_name));
  toml::table* const table = root["machine"]["axes"][axis].as_table();
  if (table == nullptr)
    return fail(Error{"does not describe axis " + axis +
                          ": write screw_pitch_mm by hand, here or "
                          "in the record of the machine; nothing was changed",
                      config::manifest_name});
  const std::string value = storage::Json(mm).dump();
  std::string out;
  if (const toml::node* const there = table->get(key))
    out = with_value(text, *there, value);
  else
    out = with_line(text, *table, "kind", key + (" = " + value));
  table->insert_or_assign(key, mm);
  const auto after = config::parse_toml(out, config::manifest_name);
  if (!after || *after != root) return not_meant(key, *table);
  return out;
}

}  // namespace nonio::modelling
