// SPDX-License-Identifier: Apache-2.0
#include "live/difference.h"

#include <algorithm>
#include <vector>

namespace nonio::live {

namespace {

std::vector<std::string_view> lines_of(std::string_view text) {
  std::vector<std::string_view> out;
  while (!text.empty()) {
    const std::size_t end = std::min(text.find('\n'), text.size() - 1) + 1;
    out.push_back(text.substr(0, end));
    text.remove_prefix(end);
  }
  return out;
}

/// Example: "@@ -3,7 +3,8 @@". An empty side begins at the previous line.
std::string hunk_head(std::size_t from, std::size_t before, std::size_t after) {
  const auto side = [from](std::size_t count) {
    return std::to_string(count == 0 ? from : from + 1) + "," + std::to_string(count);
  };
  return "@@ -" + side(before) + " +" + side(after) + " @@\n";
}

void append_line(std::string& out, char mark, std::string_view line) {
  out += mark;
  out += line;
  if (line.empty() || line.back() != '\n') out += "\n\\ No newline at end of file\n";
}

}  // namespace

std::string unified_difference(const std::string& name, std::string_view before,
                               std::string_view after) {
  constexpr std::size_t context = 3;
  if (before == after) return {};
  const auto a = lines_of(before), b = lines_of(after);
  const std::size_t least = std::min(a.size(), b.size());
  std::size_t same = 0, end = 0;
  while (same < least && a[same] == b[same]) ++same;
  while (end < least - same && a[a.size() - 1 - end] == b[b.size() - 1 - end]) ++end;
  const std::size_t from = same - std::min(same, context), tail = std::min(end, context);
  std::string out = "--- " + name + "\n+++ " + name + "\n" +
                    hunk_head(from, a.size() - end + tail - from, b.size() - end + tail - from);
  for (std::size_t i = from; i < same; ++i) append_line(out, ' ', a[i]);
  for (std::size_t i = same; i < a.size() - end; ++i) append_line(out, '-', a[i]);
  for (std::size_t i = same; i < b.size() - end; ++i) append_line(out, '+', b[i]);
  for (std::size_t i = a.size() - end; i < a.size() - end + tail; ++i) append_line(out, ' ', a[i]);
  return out;
}

}  // namespace nonio::live
