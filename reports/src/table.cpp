// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <numeric>

#include "pieces.h"

namespace nonio::reports {
namespace {

constexpr double pad = 3;           // pt, left and right of a cell
constexpr double rounding = 0.001;  // pt, so that rounding does not cause line breaks

struct Cells {
  std::vector<Glyphs> text;
  std::vector<bool> bold;
};

struct Needs {
  std::vector<double> natural, least, numbers;
};

/// The natural widths, limited by a common maximum that fits `width`, so that a single long column
/// does not cause line breaks in short ones.
std::vector<double> up_to_a_level(const Needs& needs, double width) {
  std::vector<double> out(needs.least.size());
  const auto all_at = [&](double most) {
    double sum = 0.0;
    for (std::size_t c = 0; c < out.size(); ++c)
      sum += out[c] = std::max(needs.least[c], std::min(needs.natural[c], most));
    return sum;
  };
  double low = 0.0, high = width;
  for (int i = 0; i < 40; ++i) {
    const double most = (low + high) / 2.0;
    (all_at(most) > width ? high : low) = most;
  }
  all_at(low);
  return out;
}

using Widths = std::vector<double>;

/// Alternative column widths. With enough space: natural widths plus equal surplus. Otherwise the
/// widest word plus a share of the rest, or short columns first. If even words do not fit, only
/// numbers stay unbroken.
std::vector<Widths> column_widths(const Needs& needs, double width) {
  const auto sum = [](const std::vector<double>& v) {
    return std::accumulate(v.begin(), v.end(), 0.0);
  };
  const auto between = [&](const std::vector<double>& low, const std::vector<double>& high) {
    const double share = (width - sum(low)) / (sum(high) - sum(low));
    std::vector<double> out;
    for (std::size_t c = 0; c < low.size(); ++c) out.push_back(low[c] + (high[c] - low[c]) * share);
    return out;
  };
  std::vector<double> out = needs.natural;
  if (const double all = sum(out); all <= width) {
    for (double& w : out) w += (width - all) / static_cast<double>(out.size());
    return {out};
  }
  if (sum(needs.least) <= width)
    return {up_to_a_level(needs, width), between(needs.least, needs.natural)};
  if (sum(needs.numbers) <= width) return {between(needs.numbers, needs.least)};
  out = needs.numbers;
  for (double& w : out) w *= width / sum(needs.numbers);
  return {out};
}

/// Minimum width for ideographs, which can be divided anywhere: four characters, the usual word
/// length, in units of the font size.
double kept(const Glyphs& text) {
  constexpr double word = 4.0;
  return std::any_of(text.begin(), text.end(), [](const Glyph& g) { return g.wide; }) ? word : 0.0;
}

class TableSetter {
 public:
  TableSetter(const Table& table, double width, const Context& context, std::string_view field)
      : table_(table), width_(width), context_(context), field_(field) {}

  Expected<Laid> lay() {
    if (auto ok = shape_all(); !ok) return fail(ok.error());
    Laid out;
    if (auto ok = add_title(out); !ok) return fail(ok.error());
    out.repeated.push_back(header());
    out.pieces.push_back(out.repeated.front());
    out.rows_from = out.pieces.size();
    for (std::size_t r = 0; r < rows_.size(); ++r) add_row(out.pieces, r);
    keep_together(out);
    end_rule(out.pieces.back());
    return out;
  }

 private:
  std::string name_of(std::size_t c) const {
    std::string name(field_);
    if (!table_.title.empty()) name += (name.empty() ? "" : ", ") + table_.title;
    return name + ", " + table_.columns[c].title;
  }

  Expected<void> shape_all() {
    const std::size_t n = table_.columns.size();
    std::vector<std::string> names;
    for (std::size_t c = 0; c < n; ++c) names.push_back(name_of(c));
    const std::vector<double> margins(n, 2 * pad + context_.style.small);
    Needs needs{margins, margins, margins};
    const auto measure = [&](std::size_t c, const Glyphs& text, bool number) {
      const auto ask = [&](std::vector<double>& of, double room) {
        of[c] = std::max(of[c], room + 2 * pad + rounding);
      };
      const double size = context_.style.small, most = 0.4 * width_;
      const double all = width_of(text) * size,
                   word = std::max(widest_word(text) * size, std::min(all, kept(text) * size));
      ask(needs.natural, all);
      ask(needs.least, std::min(number ? all : word, most));
      if (number) ask(needs.numbers, std::min(all, most));
    };
    for (std::size_t c = 0; c < n; ++c) {
      NONIO_TRY(auto title, shape(table_.columns[c].title, context_.fonts, true, names[c]));
      NONIO_TRY(auto unit, shape(table_.columns[c].unit, context_.fonts, false, names[c]));
      constexpr double short_title = 48;  // such as "U (k = 2)", "Nr. / No."
      const double wide = width_of(title) * context_.style.small;
      measure(c, title, false);
      if (wide <= short_title) needs.least[c] = std::max(needs.least[c], wide + 2 * pad + rounding);
      measure(c, unit, false);
      titles_.push_back(std::move(title));
      units_.push_back(std::move(unit));
    }
    for (const auto& row : table_.rows) {
      Cells cells;
      for (std::size_t c = 0; c < n && c < row.size(); ++c) {
        NONIO_TRY(auto text, shape(row[c].text, context_.fonts, row[c].bold, names[c]));
        measure(c, text, table_.columns[c].number);
        cells.text.push_back(std::move(text));
        cells.bold.push_back(row[c].bold);
      }
      rows_.push_back(std::move(cells));
    }
    choose(column_widths(needs, width_));
    return {};
  }

  void choose(const std::vector<Widths>& ways) {
    std::size_t least = 0;
    for (const Widths& way : ways) {
      const std::size_t n = ways.size() == 1 ? 0 : lines(way);
      if (widths_.empty() || n < least) widths_ = way, least = n;
    }
  }

  std::size_t lines(const Widths& widths) const {
    const auto in = [&](const Glyphs& text, std::size_t c) {
      return wrap(text, (widths[c] - 2 * pad) / context_.style.small).size();
    };
    std::size_t all = 0, header = 0;
    for (std::size_t c = 0; c < titles_.size(); ++c) header = std::max(header, in(titles_[c], c));
    for (const Cells& row : rows_) {
      std::size_t height = 1;
      for (std::size_t c = 0; c < row.text.size(); ++c)
        height = std::max(height, in(row.text[c], c));
      all += height;
    }
    return header + all;
  }

  Expected<void> add_title(Laid& out) const {
    if (table_.title.empty()) return {};
    const Style& style = context_.style;
    NONIO_TRY(auto text, set_text(context_, table_.title, true, style.subheading, width_, field_));
    PdfCanvas canvas;
    canvas.fill_colour(style.text);
    text.draw_all(canvas, 0, -3);
    out.pieces.push_back({text.height() + 3, 2, std::move(canvas.ops), true});
    return {};
  }

  SetText set(Glyphs glyphs, bool bold, std::size_t c) const {
    note_glyphs(context_, glyphs, bold);
    SetText text{std::move(glyphs), {}, bold, context_.style.small};
    text.lines = wrap(text.glyphs, (widths_[c] - 2 * pad) / text.size);
    return text;
  }

  Piece header() const {
    const Style& style = context_.style;
    std::vector<SetText> titles, units;
    double title_height = 0, unit_height = 0;
    for (std::size_t c = 0; c < widths_.size(); ++c) {
      titles.push_back(set(titles_[c], true, c));
      title_height = std::max(title_height, titles[c].height());
      units.push_back(set(units_[c], false, c));
      if (!units_[c].empty()) unit_height = std::max(unit_height, units[c].height());
    }
    constexpr double above_rows = 1.2;
    const double height = title_height + unit_height + 3.5;
    PdfCanvas canvas;
    canvas.stroke_colour(style.text);
    canvas.line(0.8);
    canvas.segment(0, 0, width_, 0);
    canvas.line(0.4);
    canvas.segment(0, -height, width_, -height);
    double x = 0;
    for (std::size_t c = 0; c < widths_.size(); ++c) {
      const double align = table_.columns[c].number ? 1.0 : 0.0, room = widths_[c] - 2 * pad;
      canvas.fill_colour(style.text);
      titles[c].draw_all(canvas, x + pad, -1.5 - (title_height - titles[c].height()), room, align);
      canvas.fill_colour(style.muted);
      if (!units_[c].empty()) units[c].draw_all(canvas, x + pad, -1.5 - title_height, room, align);
      x += widths_[c];
    }
    return {height + above_rows, 0, std::move(canvas.ops), true};
  }

  void add_row(std::vector<Piece>& pieces, std::size_t r) const {
    constexpr std::size_t together = 20;
    const Style& style = context_.style;
    std::vector<SetText> cells;
    std::size_t lines = 1;
    for (std::size_t c = 0; c < rows_[r].text.size(); ++c) {
      cells.push_back(set(rows_[r].text[c], rows_[r].bold[c], c));
      lines = std::max(lines, cells[c].lines.size());
    }
    const std::size_t each = lines <= together ? lines : 1;
    for (std::size_t first = 0; first < lines; first += each) {
      PdfCanvas canvas;
      const double leading = style.small * 1.3;
      const double above = first == 0 ? 0.5 : 0.0, below = first + each >= lines ? 0.5 : 0.0;
      const double height = leading * static_cast<double>(each) + above + below;
      if (r % 2 == 1) canvas.filled(0, -height, width_, height, style.shade);
      double x = 0;
      for (std::size_t c = 0; c < cells.size(); ++c) {
        const Level status = table_.rows[r][c].level;
        canvas.fill_colour(status == Level::info ? style.text : colour_of(style, status));
        for (std::size_t i = first; i < std::min(first + each, cells[c].lines.size()); ++i)
          cells[c].draw(canvas, i, x + pad, -above - leading * static_cast<double>(i - first),
                        widths_[c] - 2 * pad, table_.columns[c].number ? 1.0 : 0.0);
        x += widths_[c];
      }
      pieces.push_back({height, 0, std::move(canvas.ops), false});
    }
  }

  /// Keeps short tables on one page; a page break in a long table leaves at least two rows on each
  /// side.
  void keep_together(Laid& laid) const {
    constexpr std::size_t whole = 14;
    const std::size_t n = laid.pieces.size();
    for (std::size_t i = 0; i + 1 < n; ++i)
      if (rows_.size() <= whole || i <= laid.rows_from || i + 2 == n)
        laid.pieces[i].with_next = true;
  }

  void end_rule(Piece& last) const {
    PdfCanvas canvas;
    canvas.stroke_colour(context_.style.text);
    canvas.line(0.4);
    canvas.segment(0, -last.height, width_, -last.height);
    last.ops += canvas.ops;
    last.gap = 6;
    last.with_next = false;
  }

  const Table& table_;
  double width_;
  const Context& context_;
  std::string_view field_;
  std::vector<Glyphs> titles_, units_;
  std::vector<Cells> rows_;
  std::vector<double> widths_;
};

}  // namespace

Expected<Laid> lay_table(const Table& table, double width, const Context& context,
                         std::string_view field) {
  if (table.columns.empty() || table.rows.empty()) return Laid{};
  return TableSetter(table, width, context, field).lay();
}

}  // namespace nonio::reports
