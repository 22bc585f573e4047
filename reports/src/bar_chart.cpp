// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>

#include "pieces.h"

namespace nonio::reports {
namespace {

class BarSetter {
 public:
  BarSetter(const BarChart& chart, double width, const Context& context, std::string_view field)
      : chart_(chart),
        width_(width),
        context_(context),
        style_(context.style),
        field_(field),
        size_(context.style.small) {}

  Expected<Laid> lay() {
    if (auto ok = measure(); !ok) return fail(ok.error());
    if (auto ok = draw_head(); !ok) return fail(ok.error());
    const double top = y_;
    const double bottom = top - row_height() * static_cast<double>(chart_.rows.size());
    if (auto ok = draw_scale(top, bottom); !ok) return fail(ok.error());
    for (const BarChart::Row& row : chart_.rows)
      if (auto ok = draw_row(row); !ok) return fail(ok.error());
    if (chart_.line) {
      canvas_.stroke_colour(style_.text);
      canvas_.line(1.0, Dash::dashed);
      canvas_.segment(at(chart_.line->at), top, at(chart_.line->at), bottom);
      canvas_.line(1.0);
    }
    return Laid{{{-bottom + 2.9 * size_, 6, std::move(canvas_.ops), false}}};
  }

 private:
  static constexpr double bar_height = 7, between = 5;

  double row_height() const {
    return bar_height * static_cast<double>(std::max<std::size_t>(1, chart_.series.size())) +
           between;
  }
  double at(double value) const { return left_ + room_ * scale_.at(value); }

  Expected<void> measure() {
    double labels = 0, texts = 0, most = chart_.line ? chart_.line->at + chart_.line->half : 0.0;
    for (const BarChart::Row& row : chart_.rows) {
      NONIO_TRY(auto label, set_line(context_, row.label, false, size_, 0.4 * width_, field_));
      labels = std::max(labels, label.lines[0].width * size_);
      for (const BarChart::Bar& bar : row.bars) {
        NONIO_TRY(auto text,
                  set_line(context_, bar.text, false, size_ - 0.5, 0.3 * width_, field_));
        texts = std::max(texts, text.lines[0].width * size_);
        if (std::isfinite(bar.value)) most = std::max(most, bar.value);
      }
    }
    left_ = labels + 6;
    room_ = width_ - left_ - texts - 6;
    scale_ = axis_scale(0.0, most, 7, Ticks::decimal, chart_.language);
    return {};
  }

  Expected<void> draw_legend(const std::string& text, Colour colour, bool line, double& x) {
    NONIO_TRY(auto set, set_line(context_, text, false, size_ - 0.5, width_ / 2, field_));
    const double wide = 18 + set.lines[0].width * (size_ - 0.5);
    if (x > 0 && x + wide > width_) x = 0, y_ -= 1.4 * size_;
    if (line) {
      canvas_.filled(x + 2, y_ - size_, 8, size_ - 1, style_.rule);
      canvas_.stroke_colour(style_.text);
      canvas_.line(1.0, Dash::dashed);
      canvas_.segment(x + 6, y_ - size_, x + 6, y_ - 1);
      canvas_.line(1.0);
    } else {
      canvas_.filled(x, y_ - size_ + 0.5, 12, size_ - 2, colour);
    }
    canvas_.fill_colour(style_.text);
    set.draw(canvas_, 0, x + 16, y_);
    x += wide + 12;
    return {};
  }

  Expected<void> draw_head() {
    NONIO_TRY(auto title, set_line(context_, chart_.title, true, size_ + 0.5, width_, field_));
    canvas_.fill_colour(style_.text);
    title.draw(canvas_, 0, 0, 0);
    y_ = -title.height() - 2;
    double x = 0;
    const auto is_said = [](const BarChart::Series& s) { return !s.legend.empty(); };
    if (std::none_of(chart_.series.begin(), chart_.series.end(), is_said) && !chart_.line) {
      y_ -= 3;
      return {};
    }
    for (const auto& [legend, colour] : chart_.series)
      if (auto ok = draw_legend(legend, colour, false, x); !ok) return ok;
    if (chart_.line)
      if (auto ok = draw_legend(chart_.line->legend, {}, true, x); !ok) return ok;
    y_ -= 1.4 * size_ + 3;
    return {};
  }

  Expected<void> draw_scale(double top, double bottom) {
    if (chart_.line) {
      const double from = at(std::max(0.0, chart_.line->at - chart_.line->half));
      canvas_.filled(from, bottom, at(chart_.line->at + chart_.line->half) - from, top - bottom,
                     style_.rule);
    }
    canvas_.stroke_colour(style_.rule);
    canvas_.line(0.25);
    for (const double tick : scale_.ticks) canvas_.segment(at(tick), top, at(tick), bottom);
    canvas_.stroke_colour(style_.muted);
    canvas_.line(0.5);
    canvas_.segment(left_, top, left_, bottom);
    canvas_.fill_colour(style_.text);
    return draw_axis_text(canvas_, context_, scale_, chart_.x_title, left_, room_, bottom - 1,
                          size_ - 0.5, field_);
  }

  Expected<void> draw_row(const BarChart::Row& row) {
    NONIO_TRY(auto label, set_line(context_, row.label, false, size_, left_ - 6, field_));
    canvas_.fill_colour(style_.text);
    label.draw(canvas_, 0, 0, y_ - (row_height() - 1.25 * size_) / 2, left_ - 6, 1.0);
    double y = y_ - between / 2;
    for (std::size_t k = 0; k < row.bars.size(); ++k, y -= bar_height) {
      const BarChart::Bar& bar = row.bars[k];
      double end = left_;
      if (std::isfinite(bar.value) && k < chart_.series.size()) {
        end = at(bar.value);
        canvas_.filled(left_, y - bar_height + 0.7, end - left_, bar_height - 1.2,
                       chart_.series[k].colour);
      }
      NONIO_TRY(auto text, set_line(context_, bar.text, false, size_ - 0.5, 0.3 * width_, field_));
      canvas_.fill_colour(style_.text);
      if (chart_.line) end = std::max(end, at(chart_.line->at + chart_.line->half));
      text.draw(canvas_, 0, end + 3, y + 0.9);
    }
    y_ -= row_height();
    return {};
  }

  const BarChart& chart_;
  double width_;
  const Context& context_;
  const Style& style_;
  std::string_view field_;
  double size_;
  double left_ = 0, room_ = 0, y_ = 0;
  AxisScale scale_;
  PdfCanvas canvas_;
};

}  // namespace

Expected<Laid> lay_bars(const BarChart& chart, double width, const Context& context,
                        std::string_view field) {
  return BarSetter(chart, width, context, field).lay();
}

}  // namespace nonio::reports
