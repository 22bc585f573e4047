// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "nonio/reports/font.h"
#include "nonio/sdk/error.h"

/// A document as data: blocks from top to bottom, and their style. Texts are UTF-8 in NFC. `field`
/// is the source of a text, for messages about unprintable text. Lengths in pt.
namespace nonio::reports {

struct Colour {
  float red = 0, green = 0, blue = 0;
  bool operator==(const Colour&) const = default;
};

enum class Dash : std::uint8_t { solid, dashed, dotted, dash_dot };
enum class Marker : std::uint8_t {
  none,
  up,
  down,
  dot,
  ring,
  around,
  square
};  // `around` has an empty center

struct Style {
  double page_width = 595.28, page_height = 841.89;  // ISO 216 A4
  double left = 51, right = 51, top = 43, bottom = 43;
  double title = 18, heading = 12, subheading = 9.5, body = 8.5, small = 7.5;
  double plot_height = 150, rule_width = 0.25;  ///< default height of a plot; width of its rules
  double see_through = 0.25;
  Colour text, muted, rule, shade, accent, attention, failed, good, plus, minus;
};

enum class Level : std::uint8_t { good, attention, failed, info };

struct Heading {
  std::string text;
  int level = 1;  ///< 0 for the document title, 1 for a heading with a rule, 2 for that of a table
                  ///< or list
};

struct Paragraph {
  enum class Look : std::uint8_t { body, bold, small, muted };
  std::string text;
  Look look = Look::body;
  bool with_next = false;  ///< whether it is kept on one page with the next block
};

/// Rows with an empty value are omitted.
struct Grid {
  struct Row {
    std::string label, value, field;
  };
  std::string title;
  std::vector<Row> rows;
};

struct Table {
  struct Column {
    std::string title, unit;
    bool number = false;  ///< right-aligned
  };
  struct Cell {
    std::string text;
    bool bold = false;
    Level level = Level::info;  ///< marked if attention or failed
  };
  std::string title;
  std::vector<Column> columns;
  std::vector<std::vector<Cell>> rows;
};

/// Lines, bands and markers over a horizontal axis, in printed units.
struct Plot {
  struct Curve {
    enum class Kind : std::uint8_t { line, band, bars, points };
    Kind kind = Kind::line;  ///< not all of many overlapping points are drawn, but all extremes
    std::vector<double> x, y;
    std::vector<double> y2{};  ///< other side of a band; bars extend from y to y2
    Colour colour{};
    double width = 0.8;
    Dash dash = Dash::solid;
    Marker marker = Marker::none;
    double marker_size = 2.2;
    std::string legend{};  ///< entry in the legend; none if empty
    /// On a web page: tooltip and link of each point; a single title applies to the whole curve.
    std::vector<std::string> titles{}, links{};
  };
  /// A band over the full width in the background.
  struct Belt {
    double from, to;
    Colour colour{};
  };
  /// A range of the vertical axis, drawn as a dimension line on the right.
  struct Span {
    double from, to;
    std::string text;
  };
  /// A limit line over the full width.
  struct Limit {
    double at;
    Colour colour{};
  };
  /// An event at a position of the horizontal axis, with a short text at the top.
  struct Event {
    double at;
    std::string text, title;
  };
  /// A label with an offset away from the center.
  struct Label {
    double x, y;
    std::string text;
  };
  std::string title, x_title, y_title;
  std::string language{};  ///< for number formats
  std::vector<Curve> curves;
  std::vector<Label> labels{};  ///< for a figure without scales
  std::vector<Span> spans{};
  std::vector<Belt> belts{};
  std::vector<Limit> limits{};
  std::vector<Event> events{};
  std::optional<std::pair<double, double>> range{};    ///< of the vertical axis; determined from
                                                       ///< the data if absent
  std::optional<std::pair<double, double>> x_range{};  ///< of the horizontal axis; determined from
                                                       ///< the data if absent
  /// Ticks of a horizontal axis with texts (days, names).
  std::vector<std::pair<double, std::string>> ticks{};
  bool degrees = false;  ///< horizontal angle axis with ticks at fractions of a revolution
  bool whole = false;    ///< horizontal axis with whole-number ticks
  /// Names of lanes of width 1 on the horizontal axis, from 0.
  std::vector<std::string> lanes{};
  bool zero_line = true;
  bool same_scale = false;   ///< equal scales of both axes
  bool scales = true;        ///< whether axes are drawn; otherwise x_title becomes the caption
  bool only_legend = false;  ///< common legend of the following plots, without title and figure
  double height = 0;         ///< including title and legend; default of the style if 0
  double top = 0;            ///< minimum height of title and legend, to align plots
  double number_room = 0;    ///< minimum width of the numbers on the left, to align plots
  std::string empty_text{};  ///< shown if there is nothing to draw
};

/// Horizontal bars on a scale from 0, one or more per row, and a reference line.
struct BarChart {
  struct Series {
    std::string legend;  ///< may be empty if there is one series
    Colour colour{};
  };
  struct Bar {
    double value = 0.0;  ///< in printed units; no bar is drawn if it is not finite
    std::string text;
  };
  struct Row {
    std::string label;
    std::vector<Bar> bars;  ///< one per series
  };
  struct Line {
    double at = 0.0, half = 0.0;  ///< position; half the width of the band about it
    std::string legend;
  };
  std::string title, x_title;
  std::string language{};  ///< for number formats
  std::vector<Series> series;
  std::vector<Row> rows;
  std::optional<Line> line{};
};

struct Note {
  Level level = Level::info;
  std::string title, says, advice;
};

struct Status {
  Level level = Level::good;
  std::string text;
  std::vector<std::string> lines{};
};

/// A logo or mark from a PNG or JPEG file (picture.h).
struct Image {
  std::string bytes;
  std::string name;    ///< file name for messages
  double height = 40;  ///< reduced if the image would be too wide
  double align = 0;    ///< 0 left, 0.5 center, 1 right
};

/// A QR code (ISO/IEC 18004) with a caption.
struct Code {
  std::string text;     ///< up to 500 bytes
  std::string caption;  ///< may be empty
  double size = 62;     ///< side length including the quiet zone
};

/// The frame of the electronic signature, at most one. Its position is stored in the page
/// (`pdf::signature_key`) for the signing program.
struct SignatureBox {
  std::string title;
  std::vector<std::string> lines;
};
struct Spacer {
  double height = 6;
};

struct PageBreak {};

struct Block;

/// Parts side by side or, if too high for a page, below each other.
struct Columns {
  std::vector<std::vector<Block>> parts;
  std::vector<double> shares{};  ///< fractions of the width; equal if empty
};

struct Block {
  std::variant<Heading, Paragraph, Grid, Table, Plot, BarChart, Note, Status, Image, Code,
               SignatureBox, Spacer, PageBreak, Columns>
      what;
  std::string field{};
};

struct Document {
  std::string title, author, subject, language;
  std::string date;  ///< YYYY-MM-DD, for the file properties; may be empty
  std::string head;  ///< header from the second page on
  std::string foot;  ///< footer of every page
  std::string page_of = "{page}/{pages}";
  std::string mark{};  ///< diagonal text over every page: DRAFT
  /// ICC profile of sRGB for archiving; colors, XMP properties and an identifier are then stored.
  /// May be empty.
  std::string profile{};
  Style style;
  std::vector<Block> blocks;
  /// Blocks at the bottom of the first page, up to half of the page; their space is reserved.
  std::vector<Block> first_foot{};
};

/// Available height for blocks on one page.
double page_room(const Style&);

/// Equal documents and fonts give equal bytes.
Expected<std::string> pdf_bytes(const Document&, const Fonts&);

}  // namespace nonio::reports
