// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>

#include "font_subset.h"
#include "nonio/pdf/writer.h"
#include "nonio/sdk/format.h"
#include "pieces.h"

namespace nonio::reports {
namespace {

constexpr double head_room = 16, foot_room = 16;

class Pages {
 public:
  Pages(const Style& style, bool head, const Laid& foot)
      : style_(style),
        room_(style.page_height - style.top - style.bottom - foot_room),
        head_(head ? head_room : 0),
        foot_(foot) {
    pages_.emplace_back();
    for (const Piece& piece : foot.pieces) kept_ += piece.height + piece.gap;
  }

  void add(const Laid& laid) {
    const std::vector<Piece>& pieces = laid.pieces;
    for (std::size_t i = 0; i < pieces.size();) {
      std::size_t end = i + 1;
      double height = pieces[i].height;
      while (pieces[end - 1].with_next && end < pieces.size()) {
        height += pieces[end - 1].gap + pieces[end].height;
        ++end;
      }
      if (height > room_ - head_) end = i + 1, height = pieces[i].height;
      if ((y_ + height > room() + 0.01 || pieces[i].new_page) &&
          (y_ > top_of_page() || room() < room_)) {
        next_page();
        if (i > laid.rows_from)
          for (const Piece& piece : laid.repeated) put(piece);
      }
      for (; i < end; ++i) put(pieces[i]);
    }
  }

  std::vector<PdfCanvas> take() {
    if (pages_.size() == 1) end_first_page();
    return std::move(pages_);
  }
  const std::optional<pdf::SignaturePlace>& signature() const { return signature_; }

 private:
  double room() const { return pages_.size() > 1 ? room_ : room_ - kept_; }
  double top_of_page() const { return pages_.size() > 1 ? head_ : 0.0; }
  void end_first_page() {
    y_ = room_ - kept_;
    for (const Piece& piece : foot_.pieces) put(piece);
  }
  void next_page() {
    if (pages_.size() == 1) end_first_page();
    pages_.emplace_back();
    y_ = top_of_page();
  }
  void put(const Piece& piece) {
    const double x = style_.left, y = style_.page_height - style_.top - y_;
    pages_.back().place(x, y, piece.ops);
    if (const auto& frame = piece.signature)
      signature_ = {pages_.size() - 1, x + frame->x, y + frame->y - frame->height,
                    x + frame->x + frame->width, y + frame->y};
    y_ += piece.height + piece.gap;
  }

  const Style& style_;
  double room_, head_;
  const Laid& foot_;
  std::vector<PdfCanvas> pages_;
  double y_ = 0.0, kept_ = 0.0;
  std::optional<pdf::SignaturePlace> signature_;
};

Expected<Laid> lay_first_foot(const Document& document, double width, const Context& context) {
  Laid foot;
  double height = 0.0;
  for (const Block& block : document.first_foot) {
    auto laid = lay_block(block, width, context);
    if (!laid) return laid;
    for (Piece& piece : laid->pieces) {
      height += piece.height + piece.gap;
      foot.pieces.push_back(std::move(piece));
    }
  }
  if (height > context.page_room / 2)
    return fail("the foot of the first page takes " + fixed_text(height, 0) +
                " pt, expected up to " + fixed_text(context.page_room / 2, 0) +
                " pt: shorter texts in " + document.first_foot.front().field);
  return foot;
}

std::string numbered(std::string text, std::string_view place, std::size_t number) {
  for (std::size_t at; (at = text.find(place)) != std::string::npos;)
    text.replace(at, place.size(), std::to_string(number));
  return text;
}

/// Second pass, because the number of pages is then known.
Expected<void> add_heads_and_feet(std::vector<PdfCanvas>& pages, const Document& document,
                                  const Context& context) {
  const Style& style = document.style;
  const double width = style.page_width - style.left - style.right;
  for (std::size_t i = 0; i < pages.size(); ++i) {
    PdfCanvas canvas;
    const std::string number =
        numbered(numbered(document.page_of, "{page}", i + 1), "{pages}", pages.size());
    NONIO_TRY(auto right, set_line(context, number, false, style.small, 0.4 * width, "page_of"));
    NONIO_TRY(auto left, set_line(context, document.foot, false, style.small,
                                  width - right.lines[0].width * style.small - 10, "foot"));
    canvas.stroke_colour(style.rule);
    canvas.line(0.4);
    canvas.segment(0, foot_room - 2, width, foot_room - 2);
    canvas.fill_colour(style.muted);
    left.draw(canvas, 0, 0, foot_room - 5);
    right.draw(canvas, 0, 0, foot_room - 5, width, 1.0);
    pages[i].place(style.left, style.bottom - 6, canvas.ops);
    if (i == 0 || document.head.empty()) continue;
    PdfCanvas head;
    NONIO_TRY(auto text, set_line(context, document.head, false, style.small, width, "head"));
    head.fill_colour(style.muted);
    text.draw(head, 0, 0, 0);
    head.stroke_colour(style.rule);
    head.line(0.4);
    head.segment(0, -style.small * 1.3 - 1, width, -style.small * 1.3 - 1);
    pages[i].place(style.left, style.page_height - style.top, head.ops);
  }
  return {};
}

/// Draws the mark diagonally, so that no part of a page can be mistaken for a final one.
Expected<void> add_mark(std::vector<PdfCanvas>& pages, const Document& document,
                        const Context& context) {
  if (document.mark.empty()) return {};
  const Style& style = document.style;
  auto glyphs = shape(document.mark, context.fonts, true, "mark");
  if (!glyphs) return fail(glyphs.error());
  // Bold ideographs have an opaque outline.
  const bool bold =
      std::none_of(glyphs->begin(), glyphs->end(), [](const Glyph& g) { return g.wide; });
  if (!bold) glyphs = shape(document.mark, context.fonts, false, "mark");
  if (!glyphs) return fail(glyphs.error());
  note_glyphs(context, *glyphs, bold);
  const double diagonal = std::hypot(style.page_width, style.page_height);
  const double cosine = style.page_width / diagonal, sine = style.page_height / diagonal;
  const double size = std::min(110.0, 0.8 * diagonal / std::max(width_of(*glyphs), 0.1));
  const double length = width_of(*glyphs) * size, half = 0.35 * size;
  for (PdfCanvas& page : pages) {
    PdfCanvas canvas;
    canvas.see_through(true);
    canvas.fill_colour(style.failed);
    canvas.text_along((style.page_width - length * cosine) / 2 + half * sine,
                      (style.page_height - length * sine) / 2 - half * cosine, cosine, sine, bold,
                      size, *glyphs);
    canvas.see_through(false);
    page.place(0, 0, canvas.ops);
  }
  return {};
}

pdf::Font as_embedded(const Font& font, const pdf::EmbeddedFont* embedded, int stem) {
  return {embedded, font.box, font.ascent, font.descent, font.cap_height, stem};
}

pdf::NewFile new_file(const Document& document, const Fonts& fonts, Used& used) {
  pdf::NewFile file;
  file.title = document.title;
  file.author = document.author;
  file.subject = document.subject;
  file.language = document.language;
  file.date = document.date;
  file.width = document.style.page_width;
  file.height = document.style.page_height;
  file.see_through = document.style.see_through;
  const auto part = [&](const Font& font) {
    return used.common_only ? &font.with_common : &with_all(font);
  };
  file.fonts[0] = as_embedded(fonts.regular, part(fonts.regular), 80);
  file.fonts[1] = as_embedded(fonts.bold, part(fonts.bold), 140);
  file.fonts[2] = as_embedded(fonts.wide, nullptr, 80);
  file.pictures = std::move(used.pictures);
  file.profile = document.profile;
  return file;
}

}  // namespace

double page_room(const Style& style) {
  return style.page_height - style.top - style.bottom - head_room - foot_room;
}

Expected<std::string> pdf_bytes(const Document& document, const Fonts& fonts) {
  const Style& style = document.style;
  const double width = style.page_width - style.left - style.right;
  const double room = page_room(style);
  if (!(width > 100 && room > 100))
    return fail("the page's margins leave no room: " + std::to_string(width) + " pt by " +
                std::to_string(room) + " pt");
  Used used;
  const Context context{style, fonts, room, used};
  for (const auto& [text, field] :
       {std::pair(&document.title, "title"), std::pair(&document.author, "author"),
        std::pair(&document.subject, "subject")})
    if (auto glyphs = shape(*text, fonts, false, field); !glyphs) return fail(glyphs.error());
  Laid waiting;
  NONIO_TRY(const auto foot, lay_first_foot(document, width, context));
  Pages pages(style, !document.head.empty(), foot);
  std::optional<Laid> before_last;  // the last block is not alone on a page
  for (const Block& block : document.blocks) {
    auto laid = lay_block(block, width, context);
    if (!laid) return fail(laid.error());
    const auto left = &document.blocks.back() - &block;
    if (before_last && !laid->pieces.empty()) {
      before_last->pieces.back().with_next = !laid->pieces.front().new_page;
      std::move(laid->pieces.begin(), laid->pieces.end(), std::back_inserter(before_last->pieces));
      laid = std::move(*before_last);
    }
    if (!waiting.pieces.empty()) {
      laid->pieces.insert(laid->pieces.begin(), waiting.pieces.begin(), waiting.pieces.end());
      laid->rows_from += waiting.pieces.size();
      waiting.pieces.clear();
    }
    if (!laid->pieces.empty() && laid->pieces.back().with_next)
      waiting = std::move(*laid);
    else if (left == 1 && !laid->pieces.empty())
      before_last = std::move(*laid);
    else
      pages.add(*laid);
  }
  while (!waiting.pieces.empty() && waiting.pieces.back().new_page) waiting.pieces.pop_back();
  for (Piece& piece : waiting.pieces) piece.with_next = false;
  pages.add(waiting);
  std::vector<PdfCanvas> drawn = pages.take();
  if (auto ok = add_heads_and_feet(drawn, document, context); !ok) return fail(ok.error());
  if (auto ok = add_mark(drawn, document, context); !ok) return fail(ok.error());
  pdf::EmbeddedFont wide;  // must exist until the file is written
  if (!used.wide.empty()) wide = embedded_part(fonts.wide, used.wide);
  if (!used.wide.empty() && wide.name.empty())
    return fail(
        Error{"a TrueType font was expected, but no part of it can be taken out", fonts.wide.name});
  pdf::NewFile file = new_file(document, fonts, used);
  file.fonts[2].embedded = used.wide.empty() ? nullptr : &wide;
  file.signature = pages.signature();
  for (PdfCanvas& canvas : drawn) file.pages.push_back(std::move(canvas.ops));
  return pdf::write(std::move(file));
}

}  // namespace nonio::reports
