// SPDX-License-Identifier: Apache-2.0
#include <algorithm>

#include "pieces.h"

namespace nonio::reports {

void SetText::draw(Canvas& canvas, std::size_t i, double x, double y, double width,
                   double align) const {
  const TextLine& l = lines[i];
  canvas.text(x + align * (width - l.width * size), y - size, bold, size,
              std::span(glyphs).subspan(l.begin, l.end - l.begin));
}

void SetText::draw_all(Canvas& canvas, double x, double y, double width, double align) const {
  for (std::size_t i = 0; i < lines.size(); ++i)
    draw(canvas, i, x, y - leading() * static_cast<double>(i), width, align);
}

void note_glyphs(const Context& context, Glyphs& glyphs, bool bold) {
  if (context.medium == Medium::screen) return;  // a screen embeds no glyphs
  const std::vector<char>& common = context.fonts.weight(bold).common;
  auto& [common_only, wide, numbers, pictures] = context.used;
  for (Glyph& g : glyphs)
    if (g.wide) {
      if (wide.empty()) wide.push_back(0);
      numbers.resize(context.fonts.wide.common.size());
      if (numbers[g.id] == 0) {
        numbers[g.id] = static_cast<std::uint16_t>(wide.size());
        wide.push_back(g.id);
      }
      g.id = numbers[g.id];
    } else if (common[g.id] == 0) {
      common_only = false;
    }
}

Expected<SetText> set_text(const Context& context, std::string_view text, bool bold, double size,
                           double width, std::string_view field) {
  NONIO_TRY(auto glyphs, shape(text, context.fonts, bold, field, context.medium));
  note_glyphs(context, glyphs, bold);
  SetText out{std::move(glyphs), {}, bold, size};
  out.lines = wrap(out.glyphs, width / size);
  return out;
}

Expected<SetText> set_line(const Context& context, std::string_view text, bool bold, double size,
                           double width, std::string_view field) {
  NONIO_TRY(auto glyphs, shape(text, context.fonts, bold, field, context.medium));
  SetText out{
      shortened(std::move(glyphs), width / size, context.fonts.weight(bold)), {}, bold, size};
  note_glyphs(context, out.glyphs, bold);
  out.lines.push_back({0, out.glyphs.size(), width_of(out.glyphs)});
  return out;
}

Colour colour_of(const Style& style, Level level) {
  switch (level) {
    case Level::good:
      return style.good;
    case Level::attention:
      return style.attention;
    case Level::failed:
      return style.failed;
    case Level::info:
      break;
  }
  return style.accent;
}

Expected<void> draw_axis_text(Canvas& canvas, const Context& context, const AxisScale& scale,
                              std::string_view title, double left, double width, double top,
                              double size, std::string_view field) {
  double free_from = -1e9;
  canvas.begin_part("across");
  for (std::size_t i = 0; i < scale.ticks.size(); ++i) {
    NONIO_TRY(auto text, set_line(context, scale.labels[i], false, size, width, field));
    const double x = left + width * scale.at(scale.ticks[i]), half = text.lines[0].width * size / 2;
    if (x - half < free_from) continue;
    free_from = x + half + 3;
    text.draw(canvas, 0, x - 50, top, 100, 0.5);
  }
  canvas.end_item();
  // A title in two languages is reduced to the first one if it is too wide.
  constexpr std::string_view between = " · ";
  if (const auto whole = shape(title, context.fonts, false, field, context.medium);
      whole && width_of(*whole) * size > width && title.find(between) != std::string_view::npos)
    title = title.substr(0, title.find(between));
  NONIO_TRY(auto text, set_line(context, title, false, size, width, field));
  text.draw(canvas, 0, left, top - 1.3 * size, width, 0.5);
  return {};
}

void draw_mark(Canvas& canvas, const Style& style, Level level, double x, double y, double size) {
  canvas.fill_colour(colour_of(style, level));
  if (level == Level::attention) {
    canvas.move_to(x, y);
    canvas.line_to(x + size, y);
    canvas.line_to(x + size / 2, y + size);
    canvas.close();
    canvas.fill();
  } else if (level == Level::failed) {
    canvas.rectangle(x, y, size, size);
    canvas.fill();
  } else if (level == Level::good) {
    canvas.circle(x + size / 2, y + size / 2, size / 2);
    canvas.fill();
  } else {
    canvas.stroke_colour(colour_of(style, level));
    canvas.line(size / 5);
    canvas.circle(x + size / 2, y + size / 2, size * 0.4);
    canvas.stroke();
  }
}

namespace {

void add_text(std::vector<Piece>& pieces, const SetText& text, double indent, Colour colour,
              bool with_next = false) {
  constexpr std::size_t together = 8;
  for (std::size_t i = 0; i < text.lines.size();) {
    const std::size_t n = text.lines.size() <= together ? text.lines.size() : 1;
    PdfCanvas canvas;
    canvas.fill_colour(colour);
    for (std::size_t k = 0; k < n; ++k)
      text.draw(canvas, i + k, indent, -text.leading() * static_cast<double>(k));
    i += n;
    pieces.push_back({text.leading() * static_cast<double>(n), 0.0, std::move(canvas.ops),
                      with_next && i == text.lines.size()});
  }
}

Expected<Laid> lay(const Heading& heading, double width, const Context& context,
                   std::string_view field) {
  const Style& style = context.style;
  const double size = heading.level == 0   ? style.title
                      : heading.level == 1 ? style.heading
                                           : style.subheading;
  NONIO_TRY(auto text, set_text(context, heading.text, true, size, width, field));
  PdfCanvas canvas;
  canvas.fill_colour(heading.level == 2 ? style.text : style.accent);
  const double above = heading.level == 1 ? 9 : heading.level == 2 ? 4 : 0;
  text.draw_all(canvas, 0, -above);
  double height = above + text.height();
  if (heading.level == 1) {
    canvas.stroke_colour(style.accent);
    canvas.line(0.8);
    canvas.segment(0, -height - 1, width, -height - 1);
    height += 2;
  }
  return Laid{{{height, heading.level == 2 ? 2.0 : 4.0, std::move(canvas.ops), true}}};
}

Expected<Laid> lay(const Paragraph& paragraph, double width, const Context& context,
                   std::string_view field) {
  const Style& style = context.style;
  using Look = Paragraph::Look;
  const bool small = paragraph.look == Look::small || paragraph.look == Look::muted;
  NONIO_TRY(auto text, set_text(context, paragraph.text, paragraph.look == Look::bold,
                                small ? style.small : style.body, width, field));
  Laid out;
  add_text(out.pieces, text, 0, paragraph.look == Look::muted ? style.muted : style.text,
           paragraph.with_next);
  out.pieces.back().gap = small ? 1.5 : 3;
  return out;
}

Expected<Laid> lay(const Grid& grid, double width, const Context& context, std::string_view field) {
  const Style& style = context.style;
  Laid out;
  if (!grid.title.empty()) {
    NONIO_TRY(auto title, set_text(context, grid.title, true, style.body, width, field));
    add_text(out.pieces, title, 0, style.accent, true);
    out.pieces.back().gap = 1.5;
  }
  double label_width = 0;
  for (const Grid::Row& row : grid.rows)
    if (auto label = shape(row.label, context.fonts, false, row.field))
      label_width = std::max(label_width, width_of(*label) * style.small);
  label_width = std::min(label_width, 0.45 * width);
  for (const Grid::Row& row : grid.rows) {
    if (row.value.empty()) continue;
    NONIO_TRY(auto label, set_text(context, row.label, false, style.small, label_width, row.field));
    const double x = label_width + 6;
    NONIO_TRY(auto value, set_text(context, row.value, false, style.small, width - x, row.field));
    Piece first;
    PdfCanvas canvas;
    canvas.fill_colour(style.muted);
    label.draw_all(canvas, 0, 0);
    std::vector<Piece> lines;
    add_text(lines, value, x, style.text);
    first.ops = std::move(canvas.ops) + "q\n" + lines.front().ops + "Q\n";
    first.height = std::max(lines.front().height, label.height());
    lines.front() = std::move(first);
    lines.back().gap = 0.8;
    std::move(lines.begin(), lines.end(), std::back_inserter(out.pieces));
  }
  if (!out.pieces.empty()) out.pieces.back().gap = 5;
  return out;
}

Expected<Laid> lay(const Note& note, double width, const Context& context, std::string_view field) {
  const Style& style = context.style;
  constexpr double indent = 13;
  Laid out;
  const auto add = [&](const std::string& text, bool bold, bool with_next) -> Expected<void> {
    if (text.empty()) return {};
    NONIO_TRY(auto set, set_text(context, text, bold, style.body, width - indent, field));
    add_text(out.pieces, set, indent, style.text, with_next);
    return {};
  };
  if (auto ok = add(note.title, true, true); !ok) return fail(ok.error());
  if (auto ok = add(note.says, false, !note.advice.empty()); !ok) return fail(ok.error());
  if (auto ok = add(note.advice.empty() ? "" : "→ " + note.advice, false, false); !ok)
    return fail(ok.error());
  if (out.pieces.empty()) return out;
  PdfCanvas canvas;
  draw_mark(canvas, style, note.level, 0.5, -style.body, 7.5);
  out.pieces.front().ops = "q\n" + canvas.ops + "Q\n" + out.pieces.front().ops;
  out.pieces.back().with_next = false;
  out.pieces.back().gap = 4.5;
  return out;
}

Expected<Laid> lay(const Status& status, double width, const Context& context,
                   std::string_view field) {
  const Style& style = context.style;
  constexpr double pad = 6, bar = 4, indent = 24;
  std::vector<SetText> texts;
  NONIO_TRY(auto head,
            set_text(context, status.text, true, style.body + 1.5, width - indent - pad, field));
  texts.push_back(std::move(head));
  for (const std::string& line : status.lines) {
    NONIO_TRY(auto text,
              set_text(context, "• " + line, false, style.body, width - indent - pad, field));
    texts.push_back(std::move(text));
  }
  double height = 2 * pad;
  for (const SetText& text : texts) height += text.height();
  if (height > context.page_room) {
    Laid out;
    for (const SetText& text : texts) add_text(out.pieces, text, 0, style.text);
    return out;
  }
  PdfCanvas canvas;
  canvas.filled(0, -height, width, height, style.shade);
  canvas.filled(0, -height, bar, height, colour_of(style, status.level));
  draw_mark(canvas, style, status.level, bar + 6, -pad - style.body - 1.5, 9);
  canvas.fill_colour(style.text);
  double y = -pad;
  for (const SetText& text : texts) {
    text.draw_all(canvas, indent, y);
    y -= text.height();
  }
  return Laid{{{height, 6, std::move(canvas.ops), false}}};
}

Expected<Laid> lay(const Image& image, double width, const Context& context, std::string_view) {
  NONIO_TRY(auto picture, shared_picture(image.bytes, image.name));
  auto& pictures = context.used.pictures;
  auto it = std::find(pictures.begin(), pictures.end(), picture);
  if (it == pictures.end()) it = pictures.insert(it, picture);
  const double shape = static_cast<double>((*it)->width) / (*it)->height;
  const double height = std::min({image.height, width / shape, context.page_room});
  PdfCanvas canvas;
  canvas.picture(it - pictures.begin(), image.align * (width - shape * height), -height,
                 shape * height, height);
  return Laid{{{height, 4, std::move(canvas.ops), false}}};
}

Expected<Laid> lay(const Code& code, double width, const Context& context, std::string_view field) {
  return lay_code(code, width, context, field);
}

Expected<Laid> lay(const SignatureBox& box, double width, const Context& context,
                   std::string_view field) {
  return lay_signature(box, width, context, field);
}

Expected<Laid> lay(const Spacer& spacer, double, const Context&, std::string_view) {
  return Laid{{{0.0, spacer.height, {}, true}}};  // keeps the preceding block with the next one
}

Expected<Laid> lay(const PageBreak&, double, const Context&, std::string_view) {
  Piece piece;
  piece.with_next = piece.new_page = true;
  return Laid{{std::move(piece)}};
}

Expected<Laid> lay(const BarChart& chart, double width, const Context& context,
                   std::string_view field) {
  return lay_bars(chart, width, context, field);
}

Expected<Laid> lay(const Table& table, double width, const Context& context,
                   std::string_view field) {
  return lay_table(table, width, context, field);
}

Expected<Laid> lay(const Plot& plot, double width, const Context& context, std::string_view field) {
  return lay_plot(plot, width, context, field);
}

Expected<Laid> lay_all(const std::vector<Block>& blocks, double width, const Context& context) {
  Laid out;
  for (const Block& block : blocks) {
    auto laid = lay_block(block, width, context);
    if (!laid) return laid;
    std::move(laid->pieces.begin(), laid->pieces.end(), std::back_inserter(out.pieces));
  }
  return out;
}

Expected<void> put_in_line(Columns& columns, double room, const Context& context) {
  const auto share_of = [&](std::size_t i) {
    return i < columns.shares.size() ? columns.shares[i]
                                     : 1.0 / static_cast<double>(columns.parts.size());
  };
  double top = 0;
  std::vector<Plot*> plots;
  for (std::size_t i = 0; i < columns.parts.size(); ++i) {
    if (columns.parts[i].empty()) continue;
    Block& first = columns.parts[i].front();
    auto* plot = std::get_if<Plot>(&first.what);
    if (plot == nullptr) continue;
    NONIO_TRY(const auto own, plot_top(*plot, room * share_of(i), context, first.field));
    top = std::max(top, own);
    plots.push_back(plot);
  }
  if (plots.size() > 1)
    for (Plot* plot : plots) plot->top = top;
  return {};
}

SignatureFrame moved(SignatureFrame frame, double x, double y) {
  frame.x += x, frame.y += y;
  return frame;
}

Expected<Laid> lay(const Columns& given, double width, const Context& context, std::string_view) {
  constexpr double gutter = 16;
  Columns columns = given;
  const std::size_t n = columns.parts.size();
  const double room = width - gutter * static_cast<double>(n - 1);
  if (auto ok = put_in_line(columns, room, context); !ok) return fail(ok.error());
  PdfCanvas canvas;
  double x = 0, height = 0;
  bool with_next = false;
  std::optional<SignatureFrame> signature;
  for (std::size_t i = 0; i < n; ++i) {
    const double share =
        i < columns.shares.size() ? columns.shares[i] : 1.0 / static_cast<double>(n);
    auto part = lay_all(columns.parts[i], room * share, context);
    if (!part) return part;
    double y = 0;
    for (const Piece& piece : part->pieces) {
      canvas.place(x, -y, piece.ops);
      if (piece.signature) signature = moved(*piece.signature, x, -y);
      y += piece.height + piece.gap;
    }
    height = std::max(height, y);
    with_next = with_next || (!part->pieces.empty() && part->pieces.back().with_next);
    x += room * share + gutter;
  }
  if (height <= context.page_room)
    return Laid{{{height, 0, std::move(canvas.ops), with_next, false, signature}}};
  Laid out;
  for (const std::vector<Block>& blocks : columns.parts) {
    auto part = lay_all(blocks, width, context);
    if (!part) return part;
    std::move(part->pieces.begin(), part->pieces.end(), std::back_inserter(out.pieces));
  }
  return out;
}

}  // namespace

Expected<Laid> lay_block(const Block& block, double width, const Context& context) {
  return std::visit([&](const auto& what) { return lay(what, width, context, block.field); },
                    block.what);
}

}  // namespace nonio::reports
