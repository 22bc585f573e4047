// SPDX-License-Identifier: Apache-2.0
#include "text_layout.h"

#include <sys/ioctl.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <limits>
#include <sstream>
#include <string_view>

#include "platform/storage/characters.h"

namespace nonio::app {

namespace {

constexpr std::size_t narrowest = 60, widest = 100;

std::string spaces_for(const std::string& text, std::size_t width) {
  const std::size_t has = columns_of(text);
  return std::string(has < width ? width - has : 0, ' ');
}

}  // namespace

std::size_t columns_of(const std::string& text) {
  return static_cast<std::size_t>(
      std::count_if(text.begin(), text.end(), [](char c) { return (c & 0xC0) != 0x80; }));
}

std::string padded(const std::string& text, std::size_t width) {
  return text + spaces_for(text, width);
}

std::string padded_left(const std::string& text, std::size_t width) {
  return spaces_for(text, width) + text;
}

std::size_t line_width(int descriptor) {
  winsize size{};
  const bool known = ::ioctl(descriptor, TIOCGWINSZ, &size) == 0 && size.ws_col != 0;
  return known ? std::clamp<std::size_t>(size.ws_col, narrowest, widest) : widest;
}

std::size_t sentence_width(int descriptor) {
  return ::isatty(descriptor) == 1 ? line_width(descriptor)
                                   : std::numeric_limits<std::size_t>::max();
}

std::string wrapped(const std::string& text, std::size_t indent, std::size_t width,
                    std::size_t hanging) {
  std::string out;
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);) {
    if (line.starts_with(' ') || line.empty()) {
      out += (line.empty() ? "" : std::string(indent, ' ')) + line + "\n";
      continue;
    }
    std::string row(indent, ' ');
    std::size_t used = 0, room = width - std::min(width, indent);
    std::istringstream words(line);
    for (std::string word; std::getline(words, word, ' ');) {
      const std::size_t has = columns_of(word);
      if (used > 0 && used + 1 + has > room) {
        out += row + "\n";
        row.assign(indent + hanging, ' ');
        room = width - std::min(width, indent + hanging);
        used = 0;
      }
      row += (used > 0 ? " " : "") + word;
      used += has + (used > 0 ? 1 : 0);
    }
    out += row + "\n";
  }
  return out;
}

std::vector<std::string> table_rows(const std::vector<std::vector<std::string>>& rows,
                                    std::size_t width) {
  std::vector<std::size_t> widths(rows.empty() ? 0 : rows.front().size());
  for (const auto& row : rows)
    for (std::size_t i = 0; i < widths.size(); ++i)
      widths[i] = std::max(widths[i], columns_of(row[i]) + (i == 0 ? 0 : 2));
  std::vector<std::string> out;
  for (const auto& row : rows) {
    std::string text;
    std::size_t used = 0;
    for (std::size_t i = 0; i < widths.size(); ++i) {
      if (used > 0 && used + widths[i] > width) {
        text += "\n" + std::string(widths.front(), ' ');
        used = widths.front();
      }
      text += padded_left(row[i], widths[i]);
      used += widths[i];
    }
    out.push_back(text + "\n");
  }
  return out;
}

using storage::Character;

namespace {

std::string escaped(const char* format, std::uint32_t code) {
  std::array<char, 16> text{};
  std::snprintf(text.data(), text.size(), format, code);
  return text.data();
}

}  // namespace

std::string printable(std::string_view text) {
  std::string out;
  while (!text.empty()) {
    const Character c = storage::first_of(text);
    const std::size_t size = c.size == 0 ? 1 : c.size;
    if (c.size == 0)
      out += escaped("\\x%02x", static_cast<unsigned char>(text.front()));
    else if (storage::is_shown(c.code))
      out += text.substr(0, size);
    else
      out += escaped(c.code < 0x100 ? "\\x%02x" : "\\u%04x", c.code);
    text.remove_prefix(size);
  }
  return out;
}

namespace {

bool shows_colours(int descriptor) {
  const char* const no = std::getenv("NO_COLOR");
  if (no != nullptr && *no != '\0') return false;
  const char* const terminal = std::getenv("TERM");
  return terminal != nullptr && std::string_view(terminal) != "dumb" && ::isatty(descriptor) == 1;
}

const char* code_of(Colour colour) {
  switch (colour) {
    case Colour::red:
      return "31";
    case Colour::yellow:
      return "33";
    case Colour::green:
      return "32";
    case Colour::bold:
      break;
  }
  return "1";
}

}  // namespace

std::string coloured(const std::string& text, Colour colour, int descriptor) {
  if (!shows_colours(descriptor)) return text;
  return std::string("\033[") + code_of(colour) + "m" + text + "\033[0m";
}

Colour status_colour(const std::string& status) {
  if (status == "failed" || status == "does not conform") return Colour::red;
  return status == "ok" || status == "conforms" ? Colour::green : Colour::yellow;
}

std::string status_word(const std::string& status, int descriptor) {
  std::string word = status;
  word.resize(std::max<std::size_t>(word.size(), 9), ' ');
  return coloured(word, status_colour(status), descriptor);
}

}  // namespace nonio::app
