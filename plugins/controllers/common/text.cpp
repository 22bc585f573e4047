// SPDX-License-Identifier: Apache-2.0
#include "nonio/controllers/text.h"

#include <algorithm>
#include <charconv>
#include <cmath>

#include "nonio/sdk/format.h"

namespace nonio::controllers {
namespace {

template <class Number>
std::optional<Number> number(std::string_view text) {
  if (text.size() > 1 && text.front() == '+' && text[1] != '-') text.remove_prefix(1);
  Number value{};
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  return error == std::errc() && end == text.data() + text.size() ? std::optional(value)
                                                                  : std::nullopt;
}

}  // namespace

Expected<void> ends_whole(std::string_view name, std::string_view text) {
  if (text.empty() || text.back() == '\n') return {};
  return fail(std::string(name) + ": the last line has no end: the file was cut");
}

std::vector<std::string_view> lines_of(std::string_view text) {
  std::vector<std::string_view> lines;
  while (!text.empty()) {
    const std::size_t end = std::min(text.find('\n'), text.size());
    std::string_view line = text.substr(0, end);
    if (!line.empty() && line.back() == '\r') line.remove_suffix(1);
    lines.push_back(line);
    text.remove_prefix(std::min(end + 1, text.size()));
  }
  return lines;
}

tl::unexpected<Error> fail_at(std::string_view name, std::size_t line, const std::string& message) {
  Error error{std::string(name) + ", line " + std::to_string(line) + ": " + message};
  error.line = line;
  return fail(std::move(error));
}

std::vector<std::string_view> words_of(std::string_view line, std::string_view separators) {
  std::vector<std::string_view> words;
  for (std::size_t i = 0; i < line.size();) {
    const std::size_t start = line.find_first_not_of(separators, i);
    if (start == std::string_view::npos) break;
    i = std::min(line.find_first_of(separators, start), line.size());
    words.push_back(line.substr(start, i - start));
  }
  return words;
}

std::string_view trimmed(std::string_view text) {
  const std::size_t from = text.find_first_not_of(" \t\r");
  if (from == std::string_view::npos) return {};
  return text.substr(from, text.find_last_not_of(" \t\r") - from + 1);
}

std::optional<std::string> with_lines(const std::string& text,
                                      const std::function<bool(std::string_view)>& is_own,
                                      const std::string& lines,
                                      std::optional<std::size_t> otherwise) {
  std::string out, fresh = lines;
  std::optional<std::size_t> place;
  for (std::size_t at = 0; at < text.size();) {
    const std::size_t next = std::min(text.find('\n', at), text.size() - 1) + 1;
    const std::string_view one = std::string_view(text).substr(at, next - at);
    if (is_own(one.substr(0, one.find_last_not_of("\r\n") + 1))) {
      if (!place) place = out.size();
    } else {
      out += one;
    }
    at = next;
  }
  if (!place) place = otherwise;
  if (!place) return std::nullopt;
  if (*place > 0 && out[*place - 1] != '\n') fresh.insert(0, "\n");
  if (text.find("\r\n") != std::string::npos)
    for (std::size_t at = 0; (at = fresh.find('\n', at)) != std::string::npos; at += 2)
      fresh.replace(at, 1, "\r\n");
  return out.insert(*place, fresh);
}

std::string without_origin(const std::string& text, std::string_view mark, std::string_view axis,
                           const std::function<bool(std::string_view)>& follows) {
  std::string out;
  std::vector<std::string_view> block;
  const std::string origin = "axis " + plain(axis) + ", measurement ";
  const auto flush = [&](bool is_of_table) {
    std::size_t from = block.size();
    const auto has = [](std::string_view line, std::string_view what) {
      return line.find(what) != std::string_view::npos;
    };
    for (std::size_t i = 0; is_of_table && i < block.size() && from == block.size(); ++i)
      if ((has(block[i], ", campaign ") &&
           (has(block[i], origin) || has(block[i], "diagonals of "))) ||
          (has(block[i], ": axis ") && has(block[i], " by the position of ")))
        from = i;
    const auto is_ours = [&](std::string_view line) {
      return line.find("machine: ") != std::string_view::npos ||
             line.find("WARNING: the axis drifted while ") != std::string_view::npos ||
             line.find("WARNING: the table contains suspect ") != std::string_view::npos;
    };
    while (from > 0 && from < block.size() && is_ours(block[from - 1])) --from;
    for (std::size_t i = 0; i < from; ++i) out += block[i];
    block.clear();
  };
  for (std::size_t at = 0; at < text.size();) {
    const std::size_t next = std::min(text.find('\n', at), text.size() - 1) + 1;
    const std::string_view one = std::string_view(text).substr(at, next - at);
    at = next;
    if (trimmed(one).starts_with(mark)) {
      block.push_back(one);
      continue;
    }
    if (!block.empty()) flush(follows(one));
    out += one;
  }
  flush(false);
  return out;
}

std::optional<double> real(std::string_view text) {
  const auto value = number<double>(text);
  return value && std::isfinite(*value) ? value : std::nullopt;
}

std::optional<std::int64_t> whole(std::string_view text) { return number<std::int64_t>(text); }

std::vector<std::pair<std::int64_t, std::int64_t>> ranges_of(
    const std::vector<std::string>& texts) {
  std::vector<std::pair<std::int64_t, std::int64_t>> out;
  for (const std::string& text : texts) {
    const auto parts = words_of(text, "-");
    if (parts.empty()) continue;
    const auto low = whole(parts.front()), high = whole(parts.back());
    if (low && high) out.emplace_back(*low, *high);
  }
  return out;
}

std::string plain(std::string_view text) {
  std::string out;
  for (const char c : text) {
    const auto u = static_cast<unsigned char>(c);
    if ((u & 0xC0U) == 0x80U) continue;  // continuation byte of a UTF-8 character
    out += u < 0x20 || u > 0x7E ? '?' : c;
  }
  return out;
}

std::string file_part(std::string_view text) {
  std::string out;
  for (const char c : text) {
    const bool ok = (c >= '0' && c <= '9') || (c >= 'A' && c <= 'Z') || (c >= 'a' && c <= 'z') ||
                    c == '_' || c == '-' || (c == '.' && !out.empty());
    out += ok ? c : '_';
  }
  return out.empty() ? "_" : out;
}

std::string decimal(double value, int decimals) {
  std::string text = fixed_text(value, decimals);
  while (text.size() > 2 && text.back() == '0' && text[text.size() - 2] != '.') text.pop_back();
  return text;
}

std::string signed_decimal(double value, int decimals) {
  const std::string text = fixed_text(value, decimals);
  return text.empty() || text.front() == '-' ? text : "+" + text;
}

std::string comments(const std::vector<std::string>& lines, std::string_view mark) {
  std::string out;
  for (const std::string& line : lines) out += std::string(mark) + line + "\n";
  return out;
}

std::string joined(const std::vector<std::string>& words, std::string_view between) {
  std::string out;
  for (const std::string& w : words) {
    if (!out.empty()) out += between;
    out += w;
  }
  return out;
}

}  // namespace nonio::controllers
