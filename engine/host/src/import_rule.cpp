// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <sstream>

#include "nonio/host/import.h"
#include "toml_reader.h"

namespace nonio::host {

namespace {

/// A pattern taken apart: text and places in turn.
struct Token {
  std::string text;
  bool place = false;
};

Expected<std::vector<Token>> tokens_of(const std::string& pattern) {
  std::vector<Token> tokens;
  for (std::size_t i = 0; i < pattern.size();) {
    if (pattern[i] == '}') return fail("pattern: wanted a { before }, found none: " + pattern);
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
          "pattern: wanted {name} of small letters, or {*} for what does not count, found \"" +
          pattern.substr(i) + "\"");
    if (!tokens.empty() && tokens.back().place)
      return fail("pattern: wanted something between {" + tokens.back().text + "} and {" + name +
                  "}: nobody could tell where one ends");
    const auto same = [&](const Token& t) { return t.place && t.text == name && name != "*"; };
    if (std::any_of(tokens.begin(), tokens.end(), same))
      return fail("pattern: {" + name + "} is there twice");
    tokens.push_back({name, true});
    i = close + 1;
  }
  return tokens;
}

bool all_of_digits(std::string_view text) {
  return !text.empty() &&
         std::all_of(text.begin(), text.end(), [](char c) { return c >= '0' && c <= '9'; });
}

/// Whether a place can hold this text. Axes are capital letters and digits; a date has its year
/// first, as all other orders can be taken for one another.
bool fits(const std::string& place, std::string_view text) {
  if (text.empty() || text.find('/') != text.npos) return false;
  if (place == "axis")
    return text.size() <= 8 && text[0] >= 'A' && text[0] <= 'Z' &&
           std::all_of(text.begin(), text.end(),
                       [](char c) { return (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9'); });
  if (place == "date")
    return (text.size() == 8 && all_of_digits(text)) ||
           (text.size() == 10 && text[4] == '-' && text[7] == '-' &&
            all_of_digits(text.substr(0, 4)) && all_of_digits(text.substr(5, 2)) &&
            all_of_digits(text.substr(8)));
  return true;
}

class Matcher {
 public:
  Matcher(const std::vector<Token>& tokens, std::string_view text) : tokens_(tokens), text_(text) {}
  std::vector<Places> match() {
    from(0, 0);
    if (steps_ > most_steps) found_.resize(2);  // not looked at to the end, so not known to be one
    return std::move(found_);
  }

 private:
  /// Counts only readings that differ in a place that counts.
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
    for (std::size_t length = 1; at + length <= text_.size(); ++length) {
      const std::string_view part = text_.substr(at, length);
      if (part.back() == '/') return;
      if (!fits(t.text, part)) continue;
      if (t.text != "*") now_[t.text] = part;
      from(token + 1, at + length);
      if (t.text != "*") now_.erase(t.text);
    }
  }

  static constexpr std::uint64_t most_steps = 200000;

  const std::vector<Token>& tokens_;
  std::string_view text_;
  Places now_;
  std::vector<Places> found_;
  std::uint64_t steps_ = 0;
};

constexpr Key rule_keys[] = {
    {.name = "pattern",
     .holds = Key::Holds::text,
     .help = "How the names of the files are made.",
     .required = true},
    {.name = "campaign", .holds = Key::Holds::text, .help = "How the campaigns' ids are made."},
    {.name = "kind", .holds = Key::Holds::text, .help = "Kind of the measurements."},
    {.name = "reader", .holds = Key::Holds::text, .help = "Reader of the files."},
    {.name = "exclude",
     .holds = Key::Holds::texts,
     .help = "Files whose path holds one of these are passed over."},
    {.name = "manifest",
     .holds = Key::Holds::anything,
     .help = "What goes into every campaign.toml."},
};
constexpr Key rule_file = {
    .name = "rule", .holds = Key::Holds::table, .help = "Rule of an import.", .keys = rule_keys};

Expected<void> check(const ImportRule& rule) {
  if (rule.pattern.empty()) return fail("pattern: is missing: how the names of the files are made");
  const auto tokens = tokens_of(rule.pattern);
  if (!tokens) return fail(tokens.error());
  return {};
}

}  // namespace

Checked<ImportRule> import_rule_of_pattern(const std::string& pattern) {
  ImportRule rule;
  rule.pattern = pattern;
  if (auto ok = check(rule); !ok) return tl::unexpected(std::vector<Error>{ok.error()});
  return rule;
}

Checked<ImportRule> parse_import_rule(std::string_view text, const std::string& file) {
  const auto root = parse_toml(text, file);
  if (!root) return tl::unexpected(std::vector<Error>{root.error()});
  std::vector<Error> errors;
  TableReader reader(*root, rule_file, file, errors);
  ImportRule rule;
  rule.pattern = reader.text("pattern");
  rule.campaign = reader.text("campaign");
  if (const std::string kind = reader.text("kind"); !kind.empty()) rule.kind = kind;
  rule.reader = reader.text("reader");
  rule.exclude = reader.texts("exclude").value_or(std::vector<std::string>{});
  if (const toml::table* manifest = reader.anything("manifest")) {
    for (const char* own : {"format", "measurement"})
      if (manifest->contains(own))
        reader.error("manifest", std::string("wanted no \"") + own + "\", which the import writes");
    std::ostringstream out;
    out << *manifest;
    rule.manifest = out.str();
  }
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
  return Matcher(*tokens, name).match();
}

}  // namespace nonio::host
