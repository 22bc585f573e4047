// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <sstream>

#include "campaign/config/toml_reader.h"
#include "campaign/importing/import.h"

namespace nonio::importing {

namespace {

struct Token {
  std::string text;
  bool place = false;
};

Expected<std::vector<Token>> tokens_of(const std::string& pattern) {
  std::vector<Token> tokens;
  for (std::size_t i = 0; i < pattern.size();) {
    if (pattern[i] == '}') return fail("pattern: expected a { before }, found none: " + pattern);
    if (pattern[i] != '{') {
      const std::size_t end = std::min(pattern.find_first_of("{}", i), pattern.size());
      tokens.push_back({pattern.substr(i, end - i)});
      i = end;
      continue;
    }
    const std::size_t close = pattern.find('}', i);
    const std::string name = pattern.substr(i + 1, std::min(close, pattern.size()) - i - 1);
    const bool known = !name.empty() && std::all_of(name.begin(), name.end(), [](char c) {
      return (c >= 'a' && c <= 'z') || c == '_' || c == '*';
    });
    if (close == std::string::npos || !known)
      return fail(
          "pattern: expected {name} of small letters, or {*} for what does not count, found \"" +
          pattern.substr(i) + "\"");
    // The end of an axis or date can be recognized by its form. A file is not imported if its name
    // can be divided among the placeholders in two ways.
    const auto bounded = [](const std::string& place) {
      return place == "axis" || place == "date";
    };
    const bool told = !tokens.empty() && ((name == "*" && bounded(tokens.back().text)) ||
                                          (tokens.back().text == "*" && bounded(name)));
    if (!tokens.empty() && tokens.back().place && !told)
      return fail("pattern: expected something between {" + tokens.back().text + "} and {" + name +
                  "}: the end of one cannot be found");
    tokens.push_back({name, true});
    i = close + 1;
  }
  return tokens;
}

bool all_of_digits(std::string_view text) {
  return !text.empty() &&
         std::all_of(text.begin(), text.end(), [](char c) { return c >= '0' && c <= '9'; });
}

/// Whether the text consists of capital letters and digits, or of a small letter of ISO 841 and
/// digits (x and u2 name X and U2); at most 8 characters.
bool is_axis(std::string_view text) {
  if (text.empty() || text.size() > 8) return false;
  const auto digit = [](char c) { return c >= '0' && c <= '9'; };
  if (std::string_view("xyzabcuvw").find(text[0]) != std::string_view::npos)
    return std::all_of(text.begin() + 1, text.end(), digit);
  return text[0] >= 'A' && text[0] <= 'Z' && std::all_of(text.begin(), text.end(), [&](char c) {
           return (c >= 'A' && c <= 'Z') || digit(c);
         });
}

/// A date must begin with the year, because all other orders are ambiguous. {*} may be empty.
bool fits(const ImportRule& rule, const std::string& place, std::string_view text) {
  if (text.find('/') != text.npos) return false;
  if (place == "*") return true;
  if (text.empty()) return false;
  if (place == "axis") return rule.axes.empty() ? is_axis(text) : rule.axes.contains(text);
  if (place == "date")
    return (text.size() == 8 && all_of_digits(text)) ||
           (text.size() == 10 && text[4] == '-' && text[7] == '-' &&
            all_of_digits(text.substr(0, 4)) && all_of_digits(text.substr(5, 2)) &&
            all_of_digits(text.substr(8)));
  return true;
}

class Matcher {
 public:
  Matcher(const ImportRule& rule, const std::vector<Token>& tokens, std::string_view text)
      : rule_(rule), tokens_(tokens), text_(text) {}
  std::vector<Places> match() {
    from(0, 0);
    if (steps_ > most_steps) found_.resize(2);
    return std::move(found_);
  }

 private:
  /// Matches that differ only in the text of {*} are regarded as one.
  void from(std::size_t token, std::size_t at) {
    if (found_.size() > 1 || ++steps_ > most_steps) return;
    if (token == tokens_.size()) {
      if (at == text_.size() && std::find(found_.begin(), found_.end(), now_) == found_.end())
        found_.push_back(now_);
      return;
    }
    const Token& t = tokens_[token];
    if (!t.place) {
      if (text_.substr(at).starts_with(t.text)) from(token + 1, at + t.text.size());
      return;
    }
    for (std::size_t length = 0; at + length <= text_.size(); ++length) {
      const std::string_view part = text_.substr(at, length);
      if (part.ends_with('/')) return;
      if (!fits(rule_, t.text, part)) continue;
      const auto known = now_.find(t.text);
      if (known != now_.end() && known->second != part) continue;
      const bool names = t.text != "*" && known == now_.end();
      if (names) now_[t.text] = part;
      from(token + 1, at + length);
      if (names) now_.erase(t.text);
    }
  }

  static constexpr std::uint64_t most_steps = 200000;

  const ImportRule& rule_;
  const std::vector<Token>& tokens_;
  std::string_view text_;
  Places now_;
  std::vector<Places> found_;
  std::uint64_t steps_ = 0;
};

void read_axes(config::TableReader& reader, const config::Key& key, Places& axes) {
  if (const toml::table* table = reader.anything(key))
    for (const auto& [word, node] : *table)
      axes[std::string(word.str())] = node.value_or(std::string());
}

void read_rest(config::TableReader& reader, const config::Key& key, std::string& text) {
  const toml::table* manifest = reader.anything(key);
  if (manifest == nullptr) return;
  for (const char* own : {"format", "measurement"})
    if (manifest->contains(own))
      reader.error(key.name, std::string("expected no \"") + own + "\", which the import writes");
  std::ostringstream out;
  out << *manifest;
  text = out.str();
}

using config::declared::into, config::declared::by, config::declared::anything;
constexpr config::Key rule_keys[] = {
    {"pattern", into<&ImportRule::pattern>, "How the names of the files are made.",
     config::declared::required},
    {"campaign", into<&ImportRule::campaign>, "How the campaigns' ids are made."},
    {"kind", into<&ImportRule::kind>, "Kind of the measurements."},
    {"reader", into<&ImportRule::reader>, "Reader of the files."},
    {"exclude", into<&ImportRule::exclude>, "Files whose path holds one of these are passed over."},
    {"axis", into<&ImportRule::axis>, "Axis of every file, where no name states it."},
    {"axes", by<read_axes, anything, &ImportRule::axes>,
     "Texts accepted at {axis}, and the axis that each means."},
    {"manifest", by<read_rest, anything, &ImportRule::manifest>,
     "What goes into every campaign.toml."},
};
constexpr config::Key rule_file{"rule", config::declared::file<ImportRule>, "Rule of an import.",
                                rule_keys};

void check_axes(const ImportRule& rule, config::TableReader& reader) {
  const auto axis = [](const std::string& name) {
    return is_axis(name) && name[0] >= 'A' && name[0] <= 'Z';
  };
  const char* const wanted = "expected an axis of capital letters and digits, found \"";
  if (!rule.axis.empty() && !axis(rule.axis)) reader.error("axis", wanted + rule.axis + "\"");
  for (const auto& [word, name] : rule.axes)
    if (!axis(name)) reader.error("axes", wanted + name + "\" for \"" + word + "\"");
  const bool place = rule.pattern.find("{axis}") != std::string::npos;
  if (!rule.axis.empty() && place)
    reader.error("axis", "expected the axis here or at {axis} of the pattern, found both");
  if (!rule.axes.empty() && !place)
    reader.error("axes", "expected a place {axis} in the pattern, found none");
}

Expected<void> check(const ImportRule& rule) {
  if (rule.pattern.empty()) return fail("pattern: is missing: how the names of the files are made");
  NONIO_TRY(const auto tokens, tokens_of(rule.pattern));
  return {};
}

}  // namespace

config::Checked<ImportRule> import_rule_of_pattern(const std::string& pattern) {
  ImportRule rule;
  rule.pattern = pattern;
  if (auto ok = check(rule); !ok) return tl::unexpected(std::vector<Error>{ok.error()});
  return rule;
}

config::Checked<ImportRule> parse_import_rule(std::string_view text, const std::string& file) {
  const auto root = config::parse_toml(text, file);
  if (!root) return tl::unexpected(std::vector<Error>{root.error()});
  std::vector<Error> errors;
  config::TableReader reader(*root, rule_file, file, errors);
  ImportRule rule;
  reader.fill(rule);
  check_axes(rule, reader);
  reader.finish();
  if (auto ok = check(rule); !ok && !rule.pattern.empty()) {
    Error error = ok.error();
    error.file = file;
    error.line = reader.line_of("pattern");
    errors.push_back(std::move(error));
  }
  if (!errors.empty()) return tl::unexpected(std::move(errors));
  return rule;
}

std::vector<Places> readings_of_name(const ImportRule& rule, const std::string& path) {
  const auto tokens = tokens_of(rule.pattern);
  if (!tokens) return {};
  const bool whole_path = rule.pattern.find('/') != std::string::npos;
  const std::size_t slash = path.rfind('/');
  const std::string name = whole_path || slash == std::string::npos ? path : path.substr(slash + 1);
  return Matcher(rule, *tokens, name).match();
}

}  // namespace nonio::importing
