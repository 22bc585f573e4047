// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <string>

#include "nonio/reports/document.h"

/// Plots for pages of a browser, by the code that draws them in documents.
namespace nonio::reports {

/// A colour that is a property of the page's style, which a dark screen changes: {colour, "accent"}
/// is written as var(--accent).
struct NamedColour {
  Colour colour;
  const char* name;
};

/// Elements of an SVG whose origin is its upper left corner. Texts are escaped.
struct Drawing {
  double height = 0.0;
  std::string elements;
  bool has_links = false;
};

/// `width` and the lengths of the style in px. Colours without a name are written as they are.
Drawing drawing_of(const Plot&, double width, const Style&, const Fonts&,
                   std::span<const NamedColour>);

}  // namespace nonio::reports
