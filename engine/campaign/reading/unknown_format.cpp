// SPDX-License-Identifier: Apache-2.0
#include "campaign/reading/unknown_format.h"

#include <algorithm>
#include <iterator>

#include "platform/process/guarded.h"

namespace nonio::reading {

namespace {

constexpr std::string_view wanted =
    "expected a CSV file whose header row names the columns "
    "(run,direction,target_mm,deviation_um) with \",\", \";\" or a tab between them";

std::string_view first_content(std::string_view bytes, std::uint64_t& number) {
  number = 0;
  if (bytes.starts_with("\xEF\xBB\xBF")) bytes.remove_prefix(3);
  while (!bytes.empty()) {
    ++number;
    const std::size_t end = std::min(bytes.find('\n'), bytes.size());
    std::string_view line = bytes.substr(0, end);
    bytes.remove_prefix(std::min(end + 1, bytes.size()));
    line = line.substr(std::min(line.find_first_not_of(" \t\r"), line.size()));
    while (!line.empty() && (line.back() == '\r' || line.back() == ' ')) line.remove_suffix(1);
    if (!line.empty() && line.front() != '#') return line;
  }
  number = 1;
  return {};
}

std::string quoted(std::string_view line) {
  constexpr std::size_t most = 60;
  std::string out = "\"";
  for (const char c : line.substr(0, most))
    out += static_cast<unsigned char>(c) < ' ' || static_cast<unsigned char>(c) > '~' ? '?' : c;
  return out + (line.size() > most ? "...\"" : "\"");
}

std::string known_by_name(std::string_view file) {
  constexpr std::string_view keysight[] = {"lin", "ang", "str", "squ", "par", "rot", "way",
                                           "fla", "dia", "ltb", "atb", "stb", "lda"};
  const std::size_t dot = file.rfind('.');
  if (dot == file.npos) return {};
  std::string suffix(file.substr(dot + 1));
  std::transform(suffix.begin(), suffix.end(), suffix.begin(),
                 [](char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c + 32) : c; });
  if (std::find(std::begin(keysight), std::end(keysight), suffix) == std::end(keysight)) return {};
  return "its name ends as those of Keysight's laser program E1733A do (" +
         quoted(file.substr(dot)) +
         "), whose layout is not public. Export the readings from that program as text and read "
         "them with a column map (reader = \"long-table\" or \"wide-table\"); to read the file "
         "itself, such a file is needed with the values that the program shows for it";
}

bool is_numbers(std::string_view line) {
  const auto numeric = [](char c) {
    return std::string_view("0123456789+-.eE").find(c) != std::string_view::npos;
  };
  const auto between = [](char c) {
    return std::string_view(",; \t|").find(c) != std::string_view::npos;
  };
  return std::all_of(line.begin(), line.end(), [&](char c) { return numeric(c) || between(c); }) &&
         std::any_of(line.begin(), line.end(), [](char c) { return c >= '0' && c <= '9'; });
}

}  // namespace

std::uint64_t first_content_line(std::string_view bytes) {
  std::uint64_t number = 0;
  first_content(bytes, number);
  return number;
}

std::string what_is_wrong(std::string_view bytes, std::string_view file) {
  if (auto known = known_by_name(file); !known.empty()) return known;
  if (bytes.find('\n') == bytes.npos && bytes.find('\r') + 1 < bytes.size() &&
      bytes.find('\r') != bytes.npos)
    return "expected lines that end with LF or CR LF, found CR only (the line ends of an old "
           "Macintosh), so that the whole file is one line";
  std::uint64_t number = 0;
  const std::string_view line = first_content(bytes, number);
  const std::string found = std::string(wanted) + "; found ";
  if (line.empty()) return found + "nothing but blanks and comments";
  if (line.find('\0') != line.npos) return found + "bytes that are no text";
  if (is_numbers(line)) return found + "numbers in its place: " + quoted(line);
  for (const auto& [c, name] : {std::pair{'|', "\"|\""}, {':', "\":\""}, {' ', "blanks"}})
    if (line.find_first_of(",;\t") == line.npos && line.find(c) != line.npos)
      return found + name + std::string(" between the names: ") + quoted(line);
  return found + "no column that is known: " + quoted(line);
}

std::optional<StatedTable> stated_table(const loader::Plugins& plugins, std::string_view bytes,
                                        std::size_t most) {
  for (const Reader& r : plugins.readers()) {
    if (r.first_rows == nullptr) continue;
    auto rows =
        process::guarded("reader " + r.info.name, [&] { return r.first_rows(bytes, most); });
    if (rows && !rows->empty() && rows->front().size() > 1)
      return StatedTable{&r, std::move(*rows)};
  }
  return std::nullopt;
}

}  // namespace nonio::reading
