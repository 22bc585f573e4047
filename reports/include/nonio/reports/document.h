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

/// A document as a value: blocks from top to bottom, and how they look. Texts are UTF-8 in NFC;
/// `field` states where a text came from, for the message when it cannot be printed. Lengths in pt.
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
};  // around: leaves its middle

struct Style {
  double page_width = 595.28, page_height = 841.89;  // ISO 216 A4
  double left = 51, right = 51, top = 43, bottom = 43;
  double title = 18, heading = 12, subheading = 9.5, body = 8.5, small = 7.5;
  double plot_height = 150, rule_width = 0.25;  ///< of plots
  double see_through = 0.25;
  Colour text, muted, rule, shade, accent, attention, failed, good, plus, minus;
};

enum class Level : std::uint8_t { good, attention, failed, info };

struct Heading {
  std::string text;
  int level = 1;  ///< 0: the document's title, 1: with a rule, 2: of a table or a list
};

struct Paragraph {
  enum class Look : std::uint8_t { body, bold, small, muted };
  std::string text;
  Look look = Look::body;
  bool with_next = false;  ///< not the last thing on a page
};

/// Labels with their values; a value that is empty has no row.
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
    bool number = false;  ///< to the right
  };
  struct Cell {
    std::string text;
    bool bold = false;
    Level level = Level::info;  ///< attention and failed are marked
  };
  std::string title;
  std::vector<Column> columns;
  std::vector<std::vector<Cell>> rows;
};

/// Lines, bands and markers over one horizontal axis, in the units that are printed.
struct Plot {
  struct Curve {
    enum class Kind : std::uint8_t { line, band, bars, points };
    Kind kind = Kind::line;  ///< points: of many in one place one is drawn, extremes always
    std::vector<double> x, y;
    std::vector<double> y2{};  ///< of a band, its other side; bars go from y to y2
    Colour colour{};
    double width = 0.8;
    Dash dash = Dash::solid;
    Marker marker = Marker::none;
    double marker_size = 2.2;
    std::string legend{};  ///< empty: not in the legend
    /// Of points, where a page is drawn: what is stated about each when it is pointed at, and where
    /// it leads; one title alone is of the whole curve.
    std::vector<std::string> titles{}, links{};
  };
  /// A band across the whole width, behind everything.
  struct Belt {
    double from, to;
    Colour colour{};
  };
  /// A span of the vertical axis, drawn as a dimension line at the right.
  struct Span {
    double from, to;
    std::string text;
  };
  /// A limit across the whole width.
  struct Limit {
    double at;
    Colour colour{};
  };
  /// Something that happened at a place of the horizontal axis, with a short text at its top.
  struct Event {
    double at;
    std::string text, title;
  };
  /// A word in the picture, next to its place as seen from the middle.
  struct Label {
    double x, y;
    std::string text;
  };
  std::string title, x_title, y_title;
  std::string language{};  ///< of the numbers
  std::vector<Curve> curves;
  std::vector<Label> labels{};  ///< of a picture without scales
  std::vector<Span> spans{};
  std::vector<Belt> belts{};
  std::vector<Limit> limits{};
  std::vector<Event> events{};
  std::optional<std::pair<double, double>> range{};    ///< of the vertical axis; else what is drawn
  std::optional<std::pair<double, double>> x_range{};  ///< the same of the horizontal axis
  /// Of the horizontal axis, where it has no numbers: days, names.
  std::vector<std::pair<double, std::string>> ticks{};
  bool degrees = false;  ///< the horizontal axis is an angle: ticks at parts of a turn
  bool whole = false;    ///< the horizontal axis counts: ticks at whole numbers
  /// The horizontal axis has a lane of width 1 for each name, from 0 on.
  std::vector<std::string> lanes{};
  bool zero_line = true;
  bool same_scale = false;   ///< a length is as long across as up: a picture of something
  bool scales = true;        ///< false: nothing but the picture, and x_title as its caption
  bool only_legend = false;  ///< of plots that follow: neither title nor picture
  double height = 0;         ///< with title and legend; 0: the style's
  double top = 0;            ///< least height of title and legend: plots side by side are in line
  double number_room = 0;    ///< least width of the numbers at the left: plots one below the other
  std::string empty_text{};  ///< what is stated where there is nothing to draw
};

/// Horizontal bars over one scale that begins at 0, in rows of one bar or more, and a line with
/// which they are compared.
struct BarChart {
  struct Series {
    std::string legend;  ///< empty: of one series the title of the axis states it
    Colour colour{};
  };
  struct Bar {
    double value = 0.0;  ///< in the unit that is printed; not finite: there is none
    std::string text;    ///< next to it
  };
  struct Row {
    std::string label;
    std::vector<Bar> bars;  ///< one for each series
  };
  struct Line {
    double at = 0.0, half = 0.0;  ///< half: of the band about it
    std::string legend;
  };
  std::string title, x_title;
  std::string language{};  ///< of the numbers
  std::vector<Series> series;
  std::vector<Row> rows;
  std::optional<Line> line{};
};

/// Something that the reader must know: a mark, a title, what it states, what to do.
struct Note {
  Level level = Level::info;
  std::string title, says, advice;
};

/// The line that is read first.
struct Status {
  Level level = Level::good;
  std::string text;
  std::vector<std::string> lines{};
};

/// A logo or a mark: a PNG or JPEG file (picture.h).
struct Image {
  std::string bytes;
  std::string name;    ///< of the file, for messages
  double height = 40;  ///< less where it would be wider than its place
  double align = 0;    ///< 0 left, 0.5 centre, 1 right
};

/// A QR code (ISO/IEC 18004) of a short text, with a line below it.
struct Code {
  std::string text;     ///< up to 500 bytes
  std::string caption;  ///< may be empty
  double size = 62;     ///< of its side, with the quiet zone
};

/// A frame in which the file's electronic signature is shown; there is one at most. Its position is
/// noted in the page (`pdf::signature_key`), for the program that signs.
struct SignatureBox {
  std::string title;
  std::vector<std::string> lines;
};
struct Spacer {
  double height = 6;
};

/// What follows begins on a new page.
struct PageBreak {};

struct Block;

/// Parts side by side; too high for a page they come one below the other.
struct Columns {
  std::vector<std::vector<Block>> parts;
  std::vector<double> shares{};  ///< of the width; empty: equal
};

struct Block {
  std::variant<Heading, Paragraph, Grid, Table, Plot, BarChart, Note, Status, Image, Code,
               SignatureBox, Spacer, PageBreak, Columns>
      what;
  std::string field{};
};

struct Document {
  std::string title, author, subject, language;
  std::string date;  ///< YYYY-MM-DD, for the file's properties; may be empty
  std::string head;  ///< at the top of the second page and those that follow
  std::string foot;  ///< at the bottom of every page
  std::string page_of = "{page}/{pages}";
  std::string mark{};  ///< across every page, above everything: DRAFT
  /// An ICC profile of sRGB: the file is to be kept for long, and states its colours, its
  /// properties also as XMP, and an identifier.
  std::string profile{};
  Style style;
  std::vector<Block> blocks;
  /// At the foot of the first page, whatever is above it: its space is reserved. It takes up to
  /// half of a page.
  std::vector<Block> first_foot{};
};

/// The height that blocks can have on one page.
double page_room(const Style&);

/// The same document and fonts give the same bytes.
Expected<std::string> pdf_bytes(const Document&, const Fonts&);

}  // namespace nonio::reports
