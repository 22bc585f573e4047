// SPDX-License-Identifier: Apache-2.0
#include <qrencode.h>

#include <algorithm>
#include <memory>

#include "pieces.h"

namespace nonio::reports {
namespace {

constexpr int quiet_zone = 4;  // modules on each side (ISO/IEC 18004)

using Modules = std::unique_ptr<QRcode, decltype(&QRcode_free)>;

Modules modules_of(const std::string& text) {
  return {QRcode_encodeData(static_cast<int>(text.size()),
                            reinterpret_cast<const unsigned char*>(text.data()), 0, QR_ECLEVEL_M),
          &QRcode_free};
}

void draw_modules(Canvas& canvas, const QRcode& code, double size) {
  const int width = code.width;
  const double module = size / (width + 2 * quiet_zone);
  for (int row = 0; row < width; ++row)
    for (int column = 0; column < width;) {
      int end = column;
      while (end < width && (code.data[row * width + end] & 1U) != 0) ++end;
      if (end > column)
        canvas.rectangle((quiet_zone + column) * module, -(quiet_zone + row + 1) * module,
                         (end - column) * module, module);
      column = std::max(end, column + 1);
    }
  canvas.fill();
}

}  // namespace

Expected<Laid> lay_code(const Code& code, double width, const Context& context,
                        std::string_view field) {
  constexpr std::size_t longest = 500;
  const Modules modules = modules_of(code.text);
  if (code.text.empty() || code.text.size() > longest || !modules)
    return fail(std::string(field) + ": a QR code takes 1 to " + std::to_string(longest) +
                " bytes, found " + std::to_string(code.text.size()));
  const double size = std::min(code.size, width);
  PdfCanvas canvas;
  canvas.fill_colour({0, 0, 0});
  draw_modules(canvas, *modules, size);
  double height = size;
  if (!code.caption.empty()) {
    NONIO_TRY(auto caption,
              set_text(context, code.caption, false, context.style.small - 1, width, field));
    canvas.fill_colour(context.style.muted);
    caption.draw_all(canvas, 0, -height);
    height += caption.height();
  }
  return Laid{{{height, 4, std::move(canvas.ops), false}}};
}

Expected<Laid> lay_signature(const SignatureBox& box, double width, const Context& context,
                             std::string_view field) {
  constexpr double pad = 5, least = 58;
  const Style& style = context.style;
  std::vector<SetText> texts;
  for (std::size_t i = 0; i <= box.lines.size(); ++i) {
    NONIO_TRY(auto text, set_text(context, i == 0 ? box.title : box.lines[i - 1], i == 0,
                                  style.small, width - 2 * pad, field));
    texts.push_back(std::move(text));
  }
  double height = 2 * pad;
  for (const SetText& text : texts) height += text.height();
  height = std::max(height, least);
  PdfCanvas canvas;
  canvas.stroke_colour(style.accent);
  canvas.line(0.8);
  canvas.rectangle(0.4, -height + 0.4, width - 0.8, height - 0.8);
  canvas.stroke();
  double y = -pad;
  for (const SetText& text : texts) {
    canvas.fill_colour(&text == &texts.front() ? style.accent : style.text);
    text.draw_all(canvas, pad, y);
    y -= text.height();
  }
  Piece piece{height, 4, std::move(canvas.ops), false, false, SignatureFrame{0, 0, width, height}};
  return Laid{{std::move(piece)}};
}

}  // namespace nonio::reports
