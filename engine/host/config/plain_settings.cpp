// SPDX-License-Identifier: Apache-2.0
#include "host/config/plain_settings.h"

#include <simdjson.h>

#include <algorithm>
#include <string>
#include <unordered_map>
#include <vector>

namespace nonio::host::config {

namespace {

bool is_bare(char c) {
  return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '-' ||
         c == '_';
}

/// Bytes that are no text on one line, or that this reader leaves to the other.
bool has_control_characters(std::string_view text) {
  return std::any_of(text.begin(), text.end(), [](char c) {
    const auto byte = static_cast<unsigned char>(c);
    return (byte < 0x20 && c != '\n') || byte == 0x7f;
  });
}

/// One line from front to back.
class Line {
 public:
  explicit Line(std::string_view text) : text_(text) {}
  bool at_end() const { return text_.empty(); }
  bool take(char c) {
    if (!text_.starts_with(c)) return false;
    text_.remove_prefix(1);
    return true;
  }
  void skip_blanks() { text_.remove_prefix(std::min(text_.find_first_not_of(' '), text_.size())); }

  /// A text in double quotes in which nothing is escaped but the quotes.
  bool take_text(std::string& out) {
    if (!take('"')) return false;
    for (;;) {
      const std::size_t end = text_.find_first_of("\"\\");
      if (end == std::string_view::npos) return false;
      out += text_.substr(0, end);
      const bool escaped = text_[end] == '\\';
      text_.remove_prefix(end + 1);
      if (!escaped) return true;
      if (!take('"')) return false;
      out += '"';
    }
  }

  /// "finding" and "finding.place.run" of [finding."place.run"]: each key with those before it.
  bool take_keys(const std::string& prefix, std::vector<std::string>& paths) {
    constexpr std::size_t most_keys = 8;
    std::string path = prefix;
    do {
      if (!path.empty()) path += '.';
      const std::size_t begin = path.size();
      if (text_.starts_with('"')) {
        if (!take_text(path)) return false;
      } else {
        const auto end = std::find_if_not(text_.begin(), text_.end(), is_bare) - text_.begin();
        if (end == 0) return false;
        path += text_.substr(0, static_cast<std::size_t>(end));
        text_.remove_prefix(static_cast<std::size_t>(end));
      }
      if (path.size() == begin) return false;
      paths.push_back(path);
    } while (paths.size() <= most_keys && take('.'));
    return paths.size() <= most_keys;
  }

 private:
  std::string_view text_;
};

class PlainReader {
 public:
  bool read(std::string_view line) {
    if (line.empty() || line.front() == '#') return true;
    Line rest(line);
    std::vector<std::string> paths;
    if (rest.take('[')) {
      if (!rest.take_keys("", paths) || !rest.take(']') || !rest.at_end()) return false;
      return open_table(paths);
    }
    std::string value;
    if (!rest.take_keys(table_, paths)) return false;
    rest.skip_blanks();
    if (!rest.take('=')) return false;
    rest.skip_blanks();
    if (!rest.take_text(value) || !rest.at_end()) return false;
    return keep(paths, std::move(value));
  }
  Settings take() { return std::move(settings_); }

 private:
  /// How a table came to be. The rules are stricter than those of TOML: what is refused here is read again there.
  enum class Table { above_another, by_header, by_dots };

  bool open_table(const std::vector<std::string>& paths) {
    for (std::size_t i = 0; i < paths.size(); ++i) {
      const bool last = i + 1 == paths.size();
      if (settings_.values.contains(paths[i])) return false;
      const auto [at, is_new] =
          tables_.try_emplace(paths[i], last ? Table::by_header : Table::above_another);
      if (is_new) continue;
      if (at->second == Table::by_dots || (last && at->second == Table::by_header)) return false;
      if (last) at->second = Table::by_header;
    }
    table_ = paths.back();
    return true;
  }

  bool keep(const std::vector<std::string>& paths, std::string value) {
    for (std::size_t i = 0; i + 1 < paths.size(); ++i) {
      const auto [at, is_new] = tables_.try_emplace(paths[i], Table::by_dots);
      if (at->second != Table::by_dots || settings_.values.contains(paths[i])) return false;
    }
    return !tables_.contains(paths.back()) &&
           settings_.values.try_emplace(paths.back(), std::move(value)).second;
  }

  Settings settings_;
  std::string table_;
  std::unordered_map<std::string, Table> tables_;
};

}  // namespace

std::optional<Settings> plain_settings(std::string_view text) {
  if (has_control_characters(text) || !simdjson::validate_utf8(text)) return std::nullopt;
  PlainReader reader;
  while (!text.empty()) {
    const std::size_t end = std::min(text.find('\n'), text.size());
    if (!reader.read(text.substr(0, end))) return std::nullopt;
    text.remove_prefix(std::min(end + 1, text.size()));
  }
  return reader.take();
}

}  // namespace nonio::host::config
