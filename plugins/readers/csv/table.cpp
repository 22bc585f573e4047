// SPDX-License-Identifier: Apache-2.0
#include "table.h"

#include <algorithm>
#include <deque>
#include <limits>
#include <optional>

#include "lines.h"
#include "nonio/sdk/fields.h"

namespace nonio::csv {
using namespace readers;
namespace {

using Kind = ColumnSpec::Kind;

bool is_letter(char c) {
  return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '_' ||
         c == '-' || c == '.';
}

bool fits(std::string_view pattern, std::string_view name) {
  if (!pattern.starts_with('*')) return pattern == name;
  return name.size() >= pattern.size() && name.size() <= 64 && name.ends_with(pattern.substr(1)) &&
         std::all_of(name.begin(), name.end(), is_letter);
}

const ColumnSpec* find(const std::vector<ColumnSpec>& columns, std::string_view name) {
  const ColumnSpec* found = nullptr;
  for (const ColumnSpec& c : columns)
    if (fits(c.name, name) && (found == nullptr || c.name == name)) found = &c;
  return found;
}

class TableReader {
 public:
  TableReader(const std::vector<ColumnSpec>& columns, const StatedColumns* stated)
      : columns_(columns), stated_(stated) {}

  Expected<Table> read(std::string_view bytes) {
    Lines lines(bytes);
    std::string_view line;
    std::optional<Error> error;
    bool header = true;
    while (!error && next_content(lines, line, error)) {
      line_ = lines.number();
      error = not_text(line);
      if (!error && header) error = other_separator(lines.separator(), separator_of(line));
      if (!error) error = header ? take_header(line) : take_row(line);
      header = false;
    }
    if (error) {
      if (error->line == 0) error->line = lines.number();
      return fail(std::move(*error));
    }
    if (header) return fail("expected a header row, found an empty file");
    if (table_.size() == 0) return fail("expected readings, found only a header row");
    return std::move(table_);
  }

 private:
  Error at(std::size_t column, std::string message) const {
    Error error{std::move(message)};
    error.column = own_[column]->name;
    return error;
  }

  std::string_view meaning_of(std::string_view name, std::size_t index) const {
    return stated_ == nullptr ? name : stated_->known(name, index);
  }

  char separator_of(std::string_view row) const {
    char best = ',';
    std::ptrdiff_t most = -1;
    for (const char separator : {',', ';', '\t'}) {
      std::vector<std::string_view> names;
      if (!split(row, separator, names)) continue;
      std::size_t at = 0;
      const auto known = std::count_if(names.begin(), names.end(), [&](auto name) {
        const std::string_view meant = meaning_of(name, at++);
        return meant == ignore || find(columns_, meant) != nullptr;
      });
      if (known > most) {
        most = known;
        best = separator;
      }
    }
    return best;
  }

  std::optional<Error> take_header(std::string_view row) {
    separator_ = separator_of(row);
    if (!split(row, separator_, fields_))
      return Error{"header row: unterminated quoted field, or text after the closing quote"};
    for (std::size_t i = 0; i < fields_.size(); ++i) {
      const std::string_view name = meaning_of(fields_[i], i);
      if (name == ignore) {
        own_.push_back(nullptr);
        continue;
      }
      const ColumnSpec* spec = find(columns_, name);
      if (spec == nullptr) return unknown(name);
      if (has(name))
        return Error{"column \"" + std::string(name) + "\" occurs twice; expected it once"};
      found_.push_back(*spec);
      found_.back().name = name;
      own_.push_back(&found_.back());
    }
    for (const ColumnSpec& spec : columns_)
      if (spec.required && !has(spec.name)) return missing(spec.name);
    for (const ColumnSpec* spec : own_)
      if (spec == nullptr)
        words_.push_back(nullptr), numbers_.push_back(nullptr);
      else if (spec->kind == Kind::word)
        words_.push_back(&table_.words[spec->name]), numbers_.push_back(nullptr);
      else
        numbers_.push_back(&table_.numbers[spec->name]), words_.push_back(nullptr);
    return std::nullopt;
  }

  bool has(std::string_view name) const {
    return std::any_of(own_.begin(), own_.end(),
                       [&](const auto* own) { return own != nullptr && own->name == name; });
  }

  Error unknown(std::string_view name) const {
    if (name.empty())
      return Error{"a column of the header row has no name; check for an extra separator"};
    if (parse_number(name, true).kind == Field::Kind::taken)
      return Error{"expected a header row with the names of the columns, found the number " +
                   shown(name)};
    std::vector<std::string_view> names;
    for (const ColumnSpec& c : columns_)
      if (!c.name.starts_with('*')) names.push_back(c.name);
    Error error{"unknown column " + shown(name) + "; did you mean \"" +
                std::string(nearest(name, names)) + "\"?"};
    if (stated_ != nullptr)
      error.message += " Otherwise state what it is with option columns: " +
                       shown(std::string(name) + " = ignore");
    return error;
  }

  Error missing(const std::string& name) const {
    std::string found;
    for (const std::string_view field : fields_)
      found += (found.empty() ? "" : ", ") + std::string(field);
    return Error{"missing column: expected \"" + name + "\", found " + found};
  }

  std::optional<Error> take_row(std::string_view row) {
    if (!split(row, separator_, fields_))
      return Error{"unterminated quoted field, or text after the closing quote: " + shown(row)};
    if (std::all_of(fields_.begin(), fields_.end(), [](auto f) { return f.empty(); })) {
      ++table_.empty_rows;
      return std::nullopt;
    }
    if (fields_.size() != own_.size())
      return Error{"expected " + std::to_string(own_.size()) +
                   " fields as in the header row, found " + std::to_string(fields_.size()) +
                   (separator_ == ',' && fields_.size() > own_.size()
                        ? "; a decimal comma needs \";\" or a tab between the fields: "
                        : ": ") +
                   shown(row)};
    if (line_ > std::numeric_limits<std::uint32_t>::max())
      return Error{"expected at most 4294967295 lines"};
    for (std::size_t i = 0; i < own_.size(); ++i)
      if (auto error = own_[i] != nullptr ? take_field(i) : std::nullopt) return error;
    table_.line.push_back(static_cast<std::uint32_t>(line_));
    return std::nullopt;
  }

  std::optional<Error> take_field(std::size_t i) {
    const std::string_view text = fields_[i];
    const ColumnSpec& spec = *own_[i];
    switch (spec.kind) {
      case Kind::word:
        return take_word(i);
      case Kind::whole:
        numbers_[i]->push_back(parse_run(text));
        if (numbers_[i]->back() > 0.0) return std::nullopt;
        return at(i, "expected a whole number from 1 to 4294967295, found " + shown(text));
      case Kind::sign:
      case Kind::motion:
        numbers_[i]->push_back(text == "+" ? 1.0 : text == "-" ? -1.0 : 0.0);
        if (text == "+" || text == "-" || (spec.kind == Kind::motion && text.empty()))
          return std::nullopt;
        return at(i, "expected + or -" +
                         std::string(spec.kind == Kind::motion
                                         ? ", or nothing where the axis was stationary"
                                         : "") +
                         ", found " + shown(text));
      case Kind::number:
      case Kind::place:
        break;
    }
    return take_number(i);
  }

  std::optional<Error> take_word(std::size_t i) {
    const std::string_view text = fields_[i];
    const auto& allowed = own_[i]->words;
    words_[i]->emplace_back(text);
    if (allowed.empty() || std::find(allowed.begin(), allowed.end(), text) != allowed.end())
      return std::nullopt;
    std::string list;
    for (const std::string& word : allowed) list += (list.empty() ? "" : ", ") + word;
    return at(i, "expected one of " + list + ", found " + shown(text));
  }

  std::optional<Error> take_number(std::size_t i) {
    const std::string_view text = fields_[i];
    const bool comma = separator_ != ',';
    const Field number = parse_number(text, comma);
    if (number.kind == Field::Kind::bad)
      return at(i, "expected a number, found " + shown(text) +
                       (!comma && parse_number(text, true).kind == Field::Kind::taken
                            ? "; a decimal comma needs \";\" or a tab between the fields"
                            : ""));
    const bool taken = number.kind == Field::Kind::taken;
    if (!taken && own_[i]->kind == Kind::place)
      return at(i, "expected a number, found " + shown(text));
    if (comma && number.mark != DecimalMark::none)
      if (auto error = mixed_marks(i, number.mark)) return error;
    numbers_[i]->push_back(taken ? number.value : std::numeric_limits<double>::quiet_NaN());
    return std::nullopt;
  }

  /// Mixed decimal marks are refused, because 1.234 in a file with decimal commas may mean 1234.
  std::optional<Error> mixed_marks(std::size_t i, DecimalMark mark) {
    const bool point = mark == DecimalMark::point;
    std::uint64_t& first = point ? first_point_ : first_comma_;
    const std::uint64_t other = point ? first_comma_ : first_point_;
    if (first == 0) first = line_;
    if (other == 0) return std::nullopt;
    return at(i, "found " + shown(fields_[i]) + " with a decimal " + (point ? "point" : "comma") +
                     ", but a decimal " + (point ? "comma" : "point") + " in line " +
                     std::to_string(other) + "; expected the same everywhere");
  }

  const std::vector<ColumnSpec>& columns_;
  const StatedColumns* stated_;
  std::deque<ColumnSpec> found_;
  std::vector<const ColumnSpec*> own_;
  std::vector<std::vector<double>*> numbers_;
  std::vector<std::vector<std::string>*> words_;
  std::vector<std::string_view> fields_;
  char separator_ = ',';
  std::uint64_t line_ = 0;
  std::uint64_t first_point_ = 0, first_comma_ = 0;  ///< first line with each decimal mark, or 0
  Table table_;
};

}  // namespace

Expected<Table> read_table(std::string_view bytes, const std::vector<ColumnSpec>& columns,
                           const StatedColumns* stated) {
  return TableReader(columns, stated).read(bytes);
}

}  // namespace nonio::csv
