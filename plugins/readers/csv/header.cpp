// SPDX-License-Identifier: Apache-2.0
#include "header.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <optional>

#include "nonio/sdk/fields.h"

namespace nonio::csv {
using namespace readers;
namespace {

enum class Measures : std::uint8_t { neither, length, angle };

struct Known {
  std::string_view name;
  Role role;
  Measures measures = Measures::neither;
  bool position = false;
};

constexpr std::array<Known, 13> known_columns = {{
    {"run", Role::run},
    {"direction", Role::direction},
    {"target_mm", Role::target, Measures::length},
    {"target_deg", Role::target, Measures::angle},
    {"deviation_um", Role::reading, Measures::length},
    {"deviation_arcsec", Role::reading, Measures::angle},
    {"position_mm", Role::reading, Measures::length, true},
    {"position_deg", Role::reading, Measures::angle, true},
    {"time_s", Role::time},
    {"material_c", Role::material},
    {"air_c", Role::air},
    {"pressure_hpa", Role::pressure},
    {"humidity_pct", Role::humidity},
}};

const Known* find(std::string_view name) {
  const auto it = std::find_if(known_columns.begin(), known_columns.end(),
                               [&](auto& k) { return k.name == name; });
  return it == known_columns.end() ? nullptr : &*it;
}

tl::unexpected<Error> fail_at(std::string_view column, std::string message) {
  Error error{std::move(message)};
  // Names that cannot be displayed unchanged appear only in the message.
  if (shown(column) == "\"" + std::string(column) + "\"") error.column = column;
  return fail(std::move(error));
}

std::optional<Error> wrong_unit(const Known& column, const Expectation& e) {
  const bool target = column.role == Role::target;
  const bool angle = target ? e.rotary : e.angular_reading();
  if (column.measures == Measures::neither || (column.measures == Measures::angle) == angle)
    return std::nullopt;
  const std::string want = target            ? e.target()
                           : column.position ? std::string(angle ? "position_deg" : "position_mm")
                                             : e.deviation();
  std::string why = "axis \"" + e.axis + "\" is " + (e.rotary ? "rotary" : "linear");
  if (e.axis.empty()) why = "distance and deviation of a diagonal are lengths";
  if (e.straightness && !target) why = "the deviation of a straightness is a length";
  if (e.angle && !target) why = "yaw, pitch and roll are angles";
  Error error{"wrong unit: found column \"" + std::string(column.name) + "\", but " + why +
              "; expected \"" + want + "\""};
  error.column = column.name;
  return error;
}

std::optional<Error> missing_column(const Header& header, const Expectation& e) {
  std::string missing;
  if (!header.has(Role::run))
    missing = "\"run\"";
  else if (!header.has(Role::direction))
    missing = "\"direction\"";
  else if (!header.has(Role::target))
    missing = "\"" + e.target() + "\"";
  else if (!header.has(Role::reading)) {
    missing = "\"" + e.deviation() + "\"";
    if (!e.across()) missing += e.rotary ? " (or \"position_deg\")" : " (or \"position_mm\")";
  }
  if (missing.empty()) return std::nullopt;
  std::string found;
  for (const std::string& name : header.names) found += (found.empty() ? "" : ", ") + name;
  return Error{"missing column: expected " + missing + ", found " + found};
}

tl::unexpected<Error> twice(const std::string& before, std::string_view name) {
  if (before == name)
    return fail_at(name, "column \"" + before + "\" occurs twice; expected it once");
  return fail_at(name, "columns \"" + before + "\" and \"" + std::string(name) +
                           "\" state the same thing; expected only one of them");
}

}  // namespace

bool is_channel(std::string_view name) {
  constexpr std::size_t slip = 2;
  const auto ends = [&](const ChannelEnding& e) {
    return name.size() > e.end.size() && name.ends_with(e.end);
  };
  if (std::none_of(std::begin(channel_endings), std::end(channel_endings), ends)) return false;
  if (shown(name) != "\"" + std::string(name) + "\"") return false;
  return std::none_of(known_columns.begin(), known_columns.end(), [&](const Known& k) {
    return edit_distance(name, k.name) <= slip && k.name.size() > 5;
  });
}

tl::unexpected<Error> unknown_column(std::string_view name, std::size_t number) {
  if (name.empty())
    return fail("column " + std::to_string(number) +
                " of the header row has no name; check for an extra separator");
  if (parse_number(name, true).kind == Field::Kind::taken)
    return fail("expected a header row with the names of the columns, found the number " +
                shown(name));
  const bool slip =
      edit_distance(name, "deviation_um") <= 2 || edit_distance(name, "deviation_arcsec") <= 2;
  if (!slip && (name.ends_with("_um") || name.ends_with("_arcsec")))
    return fail_at(name,
                   "unknown column " + shown(name) +
                       ": a row has one deviation, deviation_um or deviation_arcsec. Write the "
                       "readings of each sensor into a file of its own, or state the one that "
                       "is evaluated with option columns: " +
                       shown(std::string(name) + " = deviation_um") + " or " +
                       shown(std::string(name) + " = ignore"));
  std::vector<std::string_view> names;
  for (const Known& k : known_columns) names.push_back(k.name);
  return fail_at(name, "unknown column " + shown(name) + "; did you mean \"" +
                           std::string(nearest(name, names)) + "\"?");
}

namespace {

std::size_t column_number(std::string_view text) {
  std::size_t number = 0;
  if (!text.starts_with('#') || text.size() < 2 || text[1] == '0') return 0;
  const auto [end, error] = std::from_chars(text.data() + 1, text.data() + text.size(), number);
  return error == std::errc() && end == text.data() + text.size() ? number : 0;
}

}  // namespace

bool Header::has(Role role) const {
  return std::find(roles.begin(), roles.end(), role) != roles.end();
}

namespace {

/// Whether this is the name of a column, and no slip of one of `names`.
bool is_of_another_kind(std::string_view name, const std::vector<std::string_view>& names) {
  constexpr std::size_t slip = 2;
  const auto belongs = [](char c) {
    return (c >= 'a' && c <= 'z') || (c >= '0' && c <= '9') || c == '_';
  };
  return name.find('_') != name.npos && std::all_of(name.begin(), name.end(), belongs) &&
         std::none_of(names.begin(), names.end(),
                      [&](std::string_view known) { return edit_distance(name, known) <= slip; });
}

}  // namespace

Expected<StatedColumns> StatedColumns::of(const std::vector<std::string>& entries,
                                          std::vector<std::string_view> names) {
  if (names.empty())
    for (const Known& k : known_columns) names.push_back(k.name);
  StatedColumns out;
  for (const std::string& entry : entries) {
    const std::size_t equals = entry.rfind('=');
    const auto name = trimmed(std::string_view(entry).substr(0, std::min(equals, entry.size())));
    const auto known = equals == entry.npos ? std::string_view()
                                            : trimmed(std::string_view(entry).substr(equals + 1));
    const bool is_known =
        known == ignore || std::find(names.begin(), names.end(), known) != names.end();
    if (!name.empty() && !is_known && is_of_another_kind(known, names)) continue;
    if (name.empty() || !is_known) {
      std::string list;
      for (const std::string_view one : names) list += std::string(one) + ", ";
      const std::string first(names.front());
      return fail("option columns: expected entries such as \"Soll mm = " + first +
                  "\" or \"#3 = " + first + "\", with one of " + list + "ignore; found " +
                  shown(entry));
    }
    if (std::any_of(out.names_.begin(), out.names_.end(),
                    [&](const Stated& one) { return one.name == name; }))
      return fail("option columns: \"" + std::string(name) + "\" is stated twice");
    out.names_.push_back({std::string(name), column_number(name), std::string(known)});
  }
  return out;
}

std::string_view StatedColumns::known(std::string_view name, std::size_t index) const {
  for (const Stated& one : names_)
    if (one.number == index + 1) return one.known;
  for (const Stated& one : names_)
    if (one.number == 0 && one.name == trimmed(name)) return one.known;
  return name;
}

bool StatedColumns::all_in(const std::vector<std::string_view>& row) const {
  const bool has_name =
      std::any_of(names_.begin(), names_.end(), [](const Stated& one) { return one.number == 0; });
  const bool only_ignores = std::all_of(names_.begin(), names_.end(),
                                        [](const Stated& one) { return one.known == ignore; });
  return std::all_of(names_.begin(), names_.end(), [&](const Stated& one) {
    if (one.known == ignore && one.number == 0 && !only_ignores) return true;
    // The last names of a row may be blank.
    if (one.number != 0) return has_name || one.number <= row.size();
    return std::any_of(row.begin(), row.end(),
                       [&](std::string_view name) { return trimmed(name) == one.name; });
  });
}

std::size_t StatedColumns::last_number() const {
  std::size_t last = 0;
  for (const Stated& one : names_) last = std::max(last, one.number);
  return last;
}

std::string StatedColumns::list() const {
  std::string out;
  for (const Stated& one : names_) out += (out.empty() ? "" : ", ") + shown(one.name);
  return out;
}

std::size_t known_names(std::string_view row, char separator, const StatedColumns& stated) {
  std::vector<std::string_view> names;
  if (!split(row, separator, names)) return 0;
  std::size_t known_ones = 0;
  for (std::size_t i = 0; i < names.size(); ++i) {
    const std::string_view known = stated.known(names[i], i);
    known_ones += known == ignore || find(known) != nullptr ? 1 : 0;
  }
  return known_ones;
}

char find_separator(std::string_view row, const StatedColumns& stated) {
  char best = ',';
  for (const char separator : {';', '\t'})
    if (known_names(row, separator, stated) > known_names(row, best, stated)) best = separator;
  return best;
}

Expected<Header> parse_header(std::string_view row, const Expectation& e,
                              const StatedColumns& stated) {
  Header header;
  header.separator = find_separator(row, stated);
  std::vector<std::string_view> names;
  if (!split(row, header.separator, names))
    return fail("header row: unterminated quoted field, or text after the closing quote");
  if (const std::size_t last = stated.last_number(); last > names.size())
    return fail("option columns: \"#" + std::to_string(last) + "\" is stated, and the row has " +
                std::to_string(names.size()) + " columns");
  for (std::size_t i = 0; i < names.size(); ++i) {
    // Column numbers alone would accept a row of readings as header.
    if (stated.last_number() != 0 && parse_number(names[i], true).kind == Field::Kind::taken)
      return fail(
          "option columns: expected a row with the names of the columns, which may be "
          "blank, found the number " +
          shown(names[i]));
    if (!stated.empty() && stated.known(names[i], i) == ignore) {
      header.roles.push_back(Role::ignored);
      header.names.emplace_back(trimmed(names[i]));
      continue;
    }
    const Known* column = find(stated.known(names[i], i));
    if (column == nullptr && is_channel(names[i])) {
      const std::string name(names[i]);
      if (std::find(header.names.begin(), header.names.end(), name) != header.names.end())
        return twice(name, name);
      header.roles.push_back(Role::channel);
      header.names.push_back(name);
      continue;
    }
    if (column == nullptr) return unknown_column(names[i], i + 1);
    const auto same = std::find(header.roles.begin(), header.roles.end(), column->role);
    if (same != header.roles.end())
      return twice(header.names[static_cast<std::size_t>(same - header.roles.begin())], names[i]);
    if (auto error = wrong_unit(*column, e)) return fail(std::move(*error));
    if (column->position && e.across())
      return fail_at(names[i], "a position along the axis does not contain its " +
                                   std::string(e.angle ? "angle" : "straightness") +
                                   "; expected \"" + e.deviation() + "\"");
    header.roles.push_back(column->role);
    header.names.emplace_back(names[i]);
    header.reading_is_position |= column->position;
  }
  if (auto error = missing_column(header, e)) return fail(std::move(*error));
  if (header.has(Role::channel) && !header.has(Role::time)) {
    const auto first = std::find(header.roles.begin(), header.roles.end(), Role::channel);
    const std::string& name = header.names[static_cast<std::size_t>(first - header.roles.begin())];
    return fail_at(name, "missing column: \"" + name +
                             "\" was recorded over the time; expected \"time_s\" next to it");
  }
  return header;
}

}  // namespace nonio::csv
