// SPDX-License-Identifier: Apache-2.0
#include "text_layout.h"

#include <sys/ioctl.h>
#include <unistd.h>

#include <algorithm>
#include <limits>
#include <sstream>

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

}  // namespace nonio::app
