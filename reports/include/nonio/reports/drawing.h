// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <string>

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
};

/// `width` and lengths of the style are in px. Colors without a name are written as values.
Drawing drawing_of(const Plot&, double width, const Style&, const Fonts&,
                   std::span<const NamedColour>);

}  // namespace nonio::reports
