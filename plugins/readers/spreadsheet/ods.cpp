// SPDX-License-Identifier: Apache-2.0
// OpenDocument 1.3 part 3, chapter 9 (tables) and 19.385 (values).
#include <cstdlib>

#include "archive.h"
#include "sheet.h"
#include "xml.h"

namespace nonio::spreadsheet {

namespace {

constexpr std::string_view type_of_ods = "application/vnd.oasis.opendocument.spreadsheet";

std::string duration_text(const std::string& iso) {
  double hours = 0.0;
  std::size_t i = 0;
  const double sign = iso.starts_with('-') ? -1.0 : 1.0;
  while (i < iso.size() && iso[i] != 'T') ++i;
  for (std::size_t from = ++i; i < iso.size(); ++i) {
    const double unit = iso[i] == 'H'   ? 1.0
                        : iso[i] == 'M' ? 1.0 / 60.0
                        : iso[i] == 'S' ? 1.0 / 3600.0
                                        : 0.0;
    if (unit == 0.0) continue;
    hours += unit * std::strtod(iso.c_str() + from, nullptr);
    from = i + 1;
  }
  return date_text(sign * hours / 24.0, false);
}

class OdsReader {
 public:
  OdsReader(Book& book, std::size_t most_rows) : book_(book), most_rows_(most_rows) {}

  Expected<void> take(const Node& node) {
    if (node.kind == Node::Kind::text) {
      if (in_text_ && !in_note_) text_ += node.text;
      return {};
    }
    const bool begins = node.kind == Node::Kind::begins;
    if (node.name == "annotation") in_note_ = begins;
    if (node.name == "table" && begins) {
      Sheet& sheet = book_.sheets.emplace_back();
      sheet.name = node.attribute("table:name");
      sheet.most_rows = most_rows_;
      row_ = 0;
    }
    if (book_.sheets.empty()) return {};
    if (node.name == "table-row") {
      if (begins) {
        column_ = 0, rows_ = repeated(node, "table:number-rows-repeated");
      } else {
        row_ += rows_;
      }
    }
    if (node.name == "p" && !in_note_) {
      if (begins && !text_.empty()) text_ += ' ';
      in_text_ = begins;
    }
    if (node.name != "table-cell" && node.name != "covered-table-cell") return {};
    if (!begins) return put();
    type_ = node.attribute("office:value-type");
    columns_ = repeated(node, "table:number-columns-repeated");
    value_ = node.attribute(type_ == "date"      ? "office:date-value"
                            : type_ == "time"    ? "office:time-value"
                            : type_ == "boolean" ? "office:boolean-value"
                                                 : "office:value");
    if (value_.ends_with(".0")) value_.resize(value_.size() - 2);
    text_.clear();
    return {};
  }

 private:
  static std::size_t repeated(const Node& node, const char* name) {
    const std::string text = node.attribute(name);
    const long long n = text.empty() ? 1 : std::atoll(text.c_str());
    return n < 1 ? 1 : static_cast<std::size_t>(n);
  }

  Expected<void> put() {
    const std::string value = type_ == "time"  ? duration_text(value_)
                              : value_.empty() ? text_
                                               : value_;
    if (!value.empty())
      for (std::size_t r = 0; r < rows_ && row_ + r < most_rows_; ++r)
        for (std::size_t c = 0; c < columns_; ++c)
          if (auto put = book_.sheets.back().put(row_ + r, column_ + c, value); !put) return put;
    column_ += columns_;
    return {};
  }

  Book& book_;
  std::size_t most_rows_;
  std::size_t row_ = 0, rows_ = 1, column_ = 0, columns_ = 1;
  std::string type_, value_, text_;
  bool in_text_ = false, in_note_ = false;
};

}  // namespace

bool is_ods(std::string_view archive) {
  return archive.substr(0, 200).find(type_of_ods) != archive.npos;
}

Expected<Book> read_ods(std::string_view archive, std::size_t most_rows) {
  NONIO_TRY(const auto xml, member(archive, "content.xml"));
  if (!xml) return fail("the file is no ODS spreadsheet: it has no content.xml");
  Book book;
  OdsReader reader(book, most_rows);
  const auto read = read_xml(*xml, [&](const Node& node) { return reader.take(node); });
  if (!read) return fail(read.error());
  if (book.sheets.empty()) return fail("the spreadsheet has no sheet");
  return book;
}

}  // namespace nonio::spreadsheet
