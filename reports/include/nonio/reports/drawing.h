// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <span>
#include <string>
#include <vector>

#include "nonio/reports/document.h"

namespace nonio::reports {

/// A color that is a property of the page style, so that a dark mode can change it: {colour,
/// "accent"} is written as var(--accent).
struct NamedColour {
  Colour colour;
  const char* name;
};

/// SVG elements with the origin in the upper left corner; texts are escaped.
struct Drawing {
  double height = 0.0;
  std::string elements;
  bool has_links = false;
  /// x, y, width and height of the frame; first and last value on its horizontal and on its
  /// vertical axis. Empty without axes.
  std::vector<double> frame{};
};

/// Names of the texts of templates/words/<language>/pictures.toml that page/chart.js uses.
inline constexpr std::array<const char*, 6> chart_words = {
    "chart.in", "chart.out", "chart.left", "chart.right", "chart.all", "chart.tools"};

/// `width` and lengths of the style are in px. Colors without a name are written as values.
Drawing drawing_of(const Plot&, double width, const Style&, const Fonts&,
                   std::span<const NamedColour>);

}  // namespace nonio::reports
