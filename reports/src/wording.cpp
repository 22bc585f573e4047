// SPDX-License-Identifier: Apache-2.0
#include "nonio/reports/wording.h"

#include <array>

#include "nonio/sdk/text.h"

namespace nonio::reports {

Wording::Wording(const Templates& templates, std::string language, std::vector<std::string> files)
    : language_(std::move(language)) {
  for (const std::string& name : files) {
    file_ = "words/" + language_ + "/" + name;
    const auto it = templates.tables.find(file_);
    if (it != templates.tables.end())
      settings_.push_back(&it->second);
    else if (absent_.empty())
      absent_ = file_;
  }
}

const std::string* Wording::find(std::string_view key) const {
  for (const Settings* settings : settings_) {
    const auto it = settings->values.find(key);
    if (it != settings->values.end()) return std::get_if<std::string>(&it->second);
  }
  return nullptr;
}

std::string Wording::get(std::string_view key) const {
  const std::string* text = find(key);
  if (text == nullptr && complaint_.empty())
    complaint_ = "the key \"" + std::string(key) + "\" is missing";
  return text != nullptr ? *text : std::string();
}

std::string Wording::get(std::string_view key, Places places) const {
  const std::string text = get(key);
  std::string out;
  for (std::size_t i = 0; i < text.size();) {
    const std::size_t close = text[i] == '{' ? text.find('}', i) : std::string::npos;
    bool found = false;
    if (close != std::string::npos)
      for (const auto& [name, value] : places)
        if (name == std::string_view(text).substr(i + 1, close - i - 1)) {
          out += value;
          found = true;
        }
    if (!found && close != std::string::npos && complaint_.empty())
      complaint_ = "the key \"" + std::string(key) + "\" has a place that is not known, " +
                   text.substr(i, close - i + 1);
    if (found)
      i = close + 1;
    else
      out += text[i++];
  }
  return out;
}

std::string Wording::get_or(std::string_view key, std::string otherwise) const {
  const std::string* text = find(key);
  if (text != nullptr) return *text;
  return otherwise;
}

Expected<void> Wording::complete() const {
  if (!absent_.empty())
    return fail(Error{"the words of this language are missing", "templates/" + absent_ + ".toml"});
  if (!complaint_.empty()) return fail(Error{complaint_, "templates/" + file_ + ".toml"});
  return {};
}

namespace {

bool letter(char c) { return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z'); }
bool digit(char c) { return c >= '0' && c <= '9'; }

}  // namespace

namespace {

/// Calls `prose` and `code` alternately with the parts of a sentence; an unpaired backquote is
/// prose.
template <typename Prose, typename Code>
void split_at_code(std::string_view s, const Prose& prose, const Code& code) {
  while (true) {
    const std::size_t from = s.find('`');
    const std::size_t to = from == s.npos ? s.npos : s.find('`', from + 1);
    if (to == s.npos) break;
    prose(s.substr(0, from));
    code(s.substr(from + 1, to - from - 1));
    s.remove_prefix(to + 1);
  }
  prose(s);
}

std::string typeset_prose(std::string_view s) {
  struct Unit {
    std::string_view plain, printed;
  };
  constexpr std::array<Unit, 4> units = {
      {{" um", " µm"}, {" degC", " °C"}, {" deg", "°"}, {" urad", " µrad"}}};
  std::string out;
  for (std::size_t i = 0; i < s.size();) {
    bool done = false;
    for (const Unit& unit : units) {
      const std::size_t end = i + unit.plain.size();
      if (i == 0 || !digit(s[i - 1]) || s.substr(i, unit.plain.size()) != unit.plain ||
          (end < s.size() && letter(s[end])))
        continue;
      out += unit.printed;
      i = end;
      done = true;
      break;
    }
    if (done) continue;
    const bool sign = s[i] == '-' && i + 1 < s.size() && digit(s[i + 1]) &&
                      (i == 0 || s[i - 1] == ' ' || s[i - 1] == '(');
    if (sign)
      out += "\u2212";
    else
      out += s[i];
    ++i;
  }
  return out;
}

}  // namespace

std::string typeset(std::string_view sentence) {
  std::string out;
  split_at_code(
      sentence, [&](std::string_view prose) { out += typeset_prose(prose); },
      [&](std::string_view code) { out += '"' + std::string(code) + '"'; });
  return out;
}

std::string typeset_html(std::string_view sentence) {
  const auto escaped = [](std::string_view text) {
    return escaped_markup(text, Markup::attribute);
  };
  std::string out;
  split_at_code(
      sentence, [&](std::string_view prose) { out += escaped(typeset_prose(prose)); },
      [&](std::string_view code) { out += "<code>" + escaped(code) + "</code>"; });
  return out;
}

}  // namespace nonio::reports
