// SPDX-License-Identifier: Apache-2.0
// Office Open XML, ECMA-376 part 1, 18.2 (workbook), 18.3 (worksheet), 18.4 (shared strings), 18.8
// (styles).
#include <cstdlib>
#include <map>

#include "archive.h"
#include "sheet.h"
#include "xml.h"

namespace nonio::spreadsheet {

namespace {

Expected<std::string> needed(std::string_view archive, const std::string& name) {
  NONIO_TRY(auto found, member(archive, name));
  if (!found) return fail("the file is no XLSX workbook: it has no " + name);
  return std::move(*found);
}

struct Listed {
  std::string name, id;
};

Expected<std::vector<Listed>> listed_sheets(std::string_view archive, bool& from_1904) {
  NONIO_TRY(const auto xml, needed(archive, "xl/workbook.xml"));
  std::vector<Listed> out;
  const auto read = read_xml(xml, [&](const Node& node) -> Expected<void> {
    if (node.kind == Node::Kind::begins && node.name == "sheet")
      out.push_back({node.attribute("name"), node.attribute("r:id")});
    if (node.kind == Node::Kind::begins && node.name == "workbookPr") {
      const std::string base = node.attribute("date1904");
      from_1904 = base == "1" || base == "true";
    }
    return {};
  });
  if (!read) return fail(read.error());
  return out;
}

Expected<std::map<std::string, std::string>> targets(std::string_view archive) {
  NONIO_TRY(const auto xml, needed(archive, "xl/_rels/workbook.xml.rels"));
  std::map<std::string, std::string> out;
  const auto read = read_xml(xml, [&](const Node& node) -> Expected<void> {
    if (node.kind != Node::Kind::begins || node.name != "Relationship") return {};
    const std::string target = node.attribute("Target");
    out[node.attribute("Id")] = target.starts_with('/') ? target.substr(1) : "xl/" + target;
    return {};
  });
  if (!read) return fail(read.error());
  return out;
}

Expected<std::vector<std::string>> shared_strings(std::string_view archive) {
  std::vector<std::string> out;
  NONIO_TRY(const auto xml, member(archive, "xl/sharedStrings.xml"));
  if (!xml) return out;
  bool in_text = false, phonetic = false;
  const auto read = read_xml(*xml, [&](const Node& node) -> Expected<void> {
    if (node.kind == Node::Kind::text) {
      if (in_text && !phonetic && !out.empty()) out.back() += node.text;
      return {};
    }
    const bool begins = node.kind == Node::Kind::begins;
    if (begins && node.name == "si") out.emplace_back();
    if (node.name == "t") in_text = begins;
    if (node.name == "rPh") phonetic = begins;
    if (out.size() > most_cells) return fail("expected up to 20 million texts");
    return {};
  });
  if (!read) return fail(read.error());
  return out;
}

enum class Shown { number, date, duration };

Shown shown_by(const std::string& format) {
  bool quoted = false, bracketed = false, day = false, time = false;
  for (std::size_t i = 0; i < format.size(); ++i) {
    const char c = format[i];
    if (c == '\\' || c == '_' || c == '*') {
      ++i;
      continue;
    }
    if (c == '"') quoted = !quoted;
    if (quoted) continue;
    if (c == '[') bracketed = true;
    if (c == ']') bracketed = false;
    if (bracketed && (i + 1 >= format.size() || format[i + 1] != ']')) {
      time = time || ((c == 'h' || c == 'm' || c == 's') && i > 0 && format[i - 1] == '[');
      continue;
    }
    day = day || c == 'y' || c == 'd' || c == 'Y' || c == 'D';
    time = time || c == 'h' || c == 's' || c == 'H' || c == 'S';
  }
  return day ? Shown::date : time ? Shown::duration : Shown::number;
}

Shown shown_by(int id, const std::map<int, std::string>& own) {
  if (const auto format = own.find(id); format != own.end())
    return format->second == "General" ? Shown::number : shown_by(format->second);
  if ((id >= 14 && id <= 17) || id == 22 || (id >= 27 && id <= 36) || (id >= 50 && id <= 58))
    return Shown::date;
  if ((id >= 18 && id <= 21) || (id >= 45 && id <= 47)) return Shown::duration;
  return Shown::number;
}

Expected<std::vector<Shown>> styles(std::string_view archive) {
  std::vector<Shown> out;
  NONIO_TRY(const auto xml, member(archive, "xl/styles.xml"));
  if (!xml) return out;
  std::map<int, std::string> formats;
  bool in_cells = false;
  const auto read = read_xml(*xml, [&](const Node& node) -> Expected<void> {
    const bool begins = node.kind == Node::Kind::begins;
    if (node.name == "cellXfs") in_cells = begins;
    if (!begins) return {};
    if (node.name == "numFmt")
      formats[std::atoi(node.attribute("numFmtId").c_str())] = node.attribute("formatCode");
    if (in_cells && node.name == "xf")
      out.push_back(shown_by(std::atoi(node.attribute("numFmtId").c_str()), formats));
    return {};
  });
  if (!read) return fail(read.error());
  return out;
}

bool place_of(const std::string& reference, std::size_t& row, std::size_t& column) {
  std::size_t i = 0, letters = 0, number = 0;
  for (; i < reference.size() && reference[i] >= 'A' && reference[i] <= 'Z' && i < 4; ++i)
    letters = letters * 26 + static_cast<std::size_t>(reference[i] - 'A' + 1);
  const std::size_t digits = i;
  for (; i < reference.size() && reference[i] >= '0' && reference[i] <= '9' && i < digits + 8; ++i)
    number = number * 10 + static_cast<std::size_t>(reference[i] - '0');
  if (digits == 0 || i == digits || i != reference.size() || number == 0) return false;
  row = number - 1, column = letters - 1;
  return true;
}

struct Common {
  std::vector<std::string> strings;
  std::vector<Shown> styles;
  bool from_1904 = false;
};

class SheetReader {
 public:
  SheetReader(Sheet& sheet, const Common& common) : sheet_(sheet), common_(common) {}
  std::size_t row() const { return row_; }

  Expected<void> take(const Node& node) {
    if (node.kind == Node::Kind::text) {
      if (in_value_) value_ += node.text;
      return {};
    }
    const bool begins = node.kind == Node::Kind::begins;
    if (node.name == "row" && begins) {
      const std::string number = node.attribute("r");
      row_ = number.empty() ? row_ + 1 : static_cast<std::size_t>(std::atoll(number.c_str()));
      column_ = 0;
    }
    if (node.name == "c" && begins) begin(node);
    if ((node.name == "v" || node.name == "t") && begins) in_value_ = true;
    if ((node.name == "v" || node.name == "t") && !begins) in_value_ = false;
    if (node.name == "c" && !begins) return end();
    return {};
  }

 private:
  void begin(const Node& node) {
    const std::string reference = node.attribute("r");
    std::size_t row = row_ == 0 ? 0 : row_ - 1, column = column_;
    if (!reference.empty()) is_wrong_ = !place_of(reference, row, column);
    at_row_ = row, column_ = column;
    type_ = node.attribute("t");
    style_ = node.attribute("s");
    value_.clear();
  }

  Expected<void> end() {
    if (is_wrong_) return fail("sheet \"" + sheet_.name + "\": a cell has no place");
    NONIO_TRY(auto put, text());
    return sheet_.put(at_row_, column_++, std::move(put));
  }

  Expected<std::string> text() const {
    if (value_.empty()) return std::string();
    if (type_ == "s") {
      const auto at = static_cast<std::size_t>(std::atoll(value_.c_str()));
      if (at >= common_.strings.size())
        return fail("sheet \"" + sheet_.name + "\": a text of the workbook is missing");
      return common_.strings[at];
    }
    if (!type_.empty() && type_ != "n") return value_;
    const auto style = static_cast<std::size_t>(std::atoll(style_.c_str()));
    const Shown shown =
        style < common_.styles.size() && !style_.empty() ? common_.styles[style] : Shown::number;
    if (shown == Shown::number)
      return value_.ends_with(".0") ? value_.substr(0, value_.size() - 2) : value_;
    constexpr double days_1904 = 1462.0;
    const double days = std::strtod(value_.c_str(), nullptr);
    return date_text(days + (common_.from_1904 && shown == Shown::date ? days_1904 : 0.0),
                     shown == Shown::date);
  }

  Sheet& sheet_;
  const Common& common_;
  std::size_t row_ = 0, column_ = 0, at_row_ = 0;
  std::string type_, style_, value_;
  bool in_value_ = false, is_wrong_ = false;
};

}  // namespace

Expected<Book> read_xlsx(std::string_view archive, std::size_t most_rows) {
  Common common;
  NONIO_TRY(const auto listed, listed_sheets(archive, common.from_1904));
  NONIO_TRY(const auto files, targets(archive));
  NONIO_TRY(common.strings, shared_strings(archive));
  NONIO_TRY(common.styles, styles(archive));
  Book book;
  for (const Listed& one : listed) {
    const auto file = files.find(one.id);
    if (file == files.end()) continue;
    NONIO_TRY(const auto xml, member(archive, file->second));
    if (!xml) continue;  // a chart sheet has no cells
    Sheet sheet;
    sheet.name = one.name;
    sheet.most_rows = most_rows;
    SheetReader reader(sheet, common);
    const auto read = read_xml(
        *xml, [&](const Node& node) { return reader.take(node); },
        [&] { return reader.row() > most_rows; });
    if (!read) return fail(read.error());
    book.sheets.push_back(std::move(sheet));
  }
  if (book.sheets.empty()) return fail("the workbook has no sheet with cells");
  return book;
}

}  // namespace nonio::spreadsheet
