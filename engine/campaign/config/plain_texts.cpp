// SPDX-License-Identifier: Apache-2.0
#include "campaign/config/plain_texts.h"

#include <algorithm>
#include <set>
#include <string>
#include <utility>

#include "nonio/sdk/text.h"

namespace nonio::config {

namespace {

/// What follows is only read if it is certain; every doubt is left to the parser.
class PlainTexts {
 public:
  bool read(std::string_view toml) {
    const bool is_control = std::any_of(toml.begin(), toml.end(), [](char c) {
      return (static_cast<unsigned char>(c) < 0x20 && c != '\n') || c == 0x7f;
    });
    if (is_control || !is_utf8(toml)) return false;
    for (rest_ = toml; !rest_.empty();)
      if (!read_line()) return false;
    const auto is_value = [&](const std::string& table) { return settings.has(table); };
    return std::none_of(tables_.begin(), tables_.end(), is_value) &&
           std::none_of(dotted_.begin(), dotted_.end(), [&](const std::string& table) {
             return is_value(table) || tables_.count(table) != 0;
           });
  }

  Settings settings{};

 private:
  bool read_line() {
    const char c = rest_.front();
    if (c == '#') {
      rest_.remove_prefix(std::min(rest_.find('\n'), rest_.size() - 1) + 1);
      return true;
    }
    if (c == '\n') return ends_line();
    return c == '[' ? read_header() : read_value();
  }

  bool read_header() {
    rest_.remove_prefix(1);
    prefix_.clear();
    if (!read_path(prefix_, tables_) || !rest_.starts_with(']')) return false;
    rest_.remove_prefix(1);
    tables_.insert(prefix_);
    const bool is_new = headers_.insert(prefix_).second;
    prefix_ += '.';
    return is_new && ends_line();
  }

  bool read_value() {
    std::string name = prefix_, text;
    if (!read_path(name, dotted_) || !rest_.starts_with(" = \"")) return false;
    rest_.remove_prefix(3);
    return read_text(text) && ends_line() &&
           settings.values.emplace(std::move(name), std::move(text)).second;
  }

  /// Appends keys with dots between them; `above` receives the tables that they are in.
  bool read_path(std::string& path, std::set<std::string>& above) {
    for (int names = 1; read_key(path); ++names) {
      if (!rest_.starts_with('.')) return true;
      if (names == 8) return false;
      rest_.remove_prefix(1);
      above.insert(path);
      path += '.';
    }
    return false;
  }

  bool read_key(std::string& name) {
    if (rest_.starts_with('"')) return read_text(name);
    const auto end = std::find_if_not(rest_.begin(), rest_.end(), is_bare_key_character);
    const auto size = static_cast<std::size_t>(end - rest_.begin());
    name += rest_.substr(0, size);
    rest_.remove_prefix(size);
    return size > 0;
  }

  /// Reads a text in quotes without line breaks; the only escapes are \" and \\.
  bool read_text(std::string& text) {
    rest_.remove_prefix(1);
    for (;;) {
      std::size_t stop = 0;  // find_first_of would take half of the time of all reading
      while (stop < rest_.size() && rest_[stop] != '"' && rest_[stop] != '\\' &&
             rest_[stop] != '\n')
        ++stop;
      if (stop == rest_.size() || rest_[stop] == '\n') return false;
      text += rest_.substr(0, stop);
      const bool ends = rest_[stop] == '"';
      rest_.remove_prefix(stop + 1);
      if (ends) return true;
      if (!rest_.starts_with('"') && !rest_.starts_with('\\')) return false;
      text += rest_.front();
      rest_.remove_prefix(1);
    }
  }

  bool ends_line() {
    if (rest_.empty()) return true;
    if (rest_.front() != '\n') return false;
    rest_.remove_prefix(1);
    return true;
  }

  std::string_view rest_{};
  std::string prefix_{};
  /// Tables that headers name, these and the tables above them, and those that keys with dots make.
  std::set<std::string> headers_{}, tables_{}, dotted_{};
};

}  // namespace

std::optional<Settings> plain_texts(std::string_view toml) {
  PlainTexts reader;
  if (!reader.read(toml)) return std::nullopt;
  return std::move(reader.settings);
}

}  // namespace nonio::config
