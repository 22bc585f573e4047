// SPDX-License-Identifier: Apache-2.0
#include "two_languages.h"

#include <algorithm>

namespace nonio::pages {

using namespace reports;

namespace {

using Blocks = std::vector<Block>;

/// The same but for the decimal sign.
bool same(const std::string& a, const std::string& b) {
  const auto plain = [](char c) { return c == ',' ? '.' : c; };
  return std::equal(a.begin(), a.end(), b.begin(), b.end(),
                    [&](char x, char y) { return plain(x) == plain(y); });
}

/// "Hall 4 (beim Auftraggeber / at the customer's)": the common beginning is printed once.
bool join_in_brackets(std::string& a, const std::string& b) {
  const std::size_t open = a.find(" (");
  if (open == std::string::npos || open == 0 || b.find(" (") != open || !a.ends_with(')') ||
      !b.ends_with(')') || !same(a.substr(0, open), b.substr(0, open)))
    return false;
  a.pop_back();
  a += " / " + b.substr(open + 2);
  return true;
}

void join(std::string& a, const std::string& b, const char* between = " / ") {
  if (!same(a, b) && !join_in_brackets(a, b)) a += between + b;
}

Blocks joined(Blocks first, const Blocks& second);

void merge(Table& a, const Table& b) {
  join(a.title, b.title);
  for (std::size_t i = 0; i < a.columns.size(); ++i) join(a.columns[i].title, b.columns[i].title);
  for (std::size_t r = 0; r < a.rows.size(); ++r)
    for (std::size_t i = 0; i < a.rows[r].size(); ++i)
      if (!a.columns[i].number) join(a.rows[r][i].text, b.rows[r][i].text);
}

void merge(Grid& a, const Grid& b) {
  join(a.title, b.title);
  for (std::size_t i = 0; i < a.rows.size(); ++i) {
    join(a.rows[i].label, b.rows[i].label);
    join(a.rows[i].value, b.rows[i].value);
  }
}

/// Titles of axes have a stroke before their unit. Upwards there is no room for two.
void merge(Plot& a, const Plot& b) {
  join(a.title, b.title);
  join(a.x_title, b.x_title, " · ");
  join(a.empty_text, b.empty_text);
  for (std::size_t i = 0; i < std::min(a.curves.size(), b.curves.size()); ++i)
    join(a.curves[i].legend, b.curves[i].legend);
}

/// The labels of its rows have to be the same in both.
void merge(BarChart& a, const BarChart& b) {
  join(a.title, b.title);
  join(a.x_title, b.x_title, " · ");
}

Block merged(Block a, const Block& b) {
  if (auto* heading = std::get_if<Heading>(&a.what)) {
    join(heading->text, std::get<Heading>(b.what).text);
  } else if (auto* paragraph = std::get_if<Paragraph>(&a.what)) {
    constexpr std::size_t line = 60;
    const std::string& other = std::get<Paragraph>(b.what).text;
    if (same(paragraph->text, other)) return a;
    if (paragraph->text.size() > line || other.size() > line) return {Columns{{{a}, {b}}}, a.field};
    join(paragraph->text, other);
  } else if (auto* grid = std::get_if<Grid>(&a.what)) {
    merge(*grid, std::get<Grid>(b.what));
  } else if (auto* table = std::get_if<Table>(&a.what)) {
    merge(*table, std::get<Table>(b.what));
  } else if (auto* plot = std::get_if<Plot>(&a.what)) {
    merge(*plot, std::get<Plot>(b.what));
  } else if (auto* chart = std::get_if<BarChart>(&a.what)) {
    merge(*chart, std::get<BarChart>(b.what));
  } else if (auto* note = std::get_if<Note>(&a.what)) {
    const Note& other = std::get<Note>(b.what);
    join(note->title, other.title);
    join(note->says, other.says);
    join(note->advice, other.advice);
  } else if (auto* code = std::get_if<Code>(&a.what)) {
    join(code->caption, std::get<Code>(b.what).caption);
  } else if (auto* box = std::get_if<SignatureBox>(&a.what)) {
    const SignatureBox& other = std::get<SignatureBox>(b.what);
    join(box->title, other.title);
    for (std::size_t i = 0; i < box->lines.size(); ++i) join(box->lines[i], other.lines[i]);
  } else if (auto* columns = std::get_if<Columns>(&a.what)) {
    const Columns& other = std::get<Columns>(b.what);
    for (std::size_t i = 0; i < columns->parts.size(); ++i)
      columns->parts[i] = joined(std::move(columns->parts[i]), other.parts[i]);
  }
  return a;
}

Blocks joined(Blocks first, const Blocks& second) {
  for (std::size_t i = 0; i < first.size(); ++i) first[i] = merged(std::move(first[i]), second[i]);
  return first;
}

}  // namespace

Document side_by_side(Document first, const Document& second) {
  join(first.title, second.title);
  join(first.page_of, second.page_of);
  join(first.mark, second.mark);
  first.blocks = joined(std::move(first.blocks), second.blocks);
  first.first_foot = joined(std::move(first.first_foot), second.first_foot);
  return first;
}

}  // namespace nonio::pages
