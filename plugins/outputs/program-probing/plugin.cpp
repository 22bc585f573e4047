// SPDX-License-Identifier: Apache-2.0
//
// Part programs that probe a ball on a rotary axis at several angles and heights, for the kind
// ball-centres. Each touch is logged as nine numbers, X Y Z A B C U V W, as the reader
// linuxcnc-probe takes them.
#include "nonio/sdk/plugin.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <optional>

#include "nonio/sdk/format.h"
#include "programs.h"

namespace nonio {
namespace {

using Vector = std::array<double, 3>;

constexpr std::array<const char*, 3> linear{"X", "Y", "Z"};
constexpr double degree = std::numbers::pi / 180.0;

/// What the options ask for, mm and deg.
struct Wish {
  std::string dialect, axis;
  Vector centre{}, ball{};
  std::vector<double> angles, heights;
  double radius = 0.0, approach = 0.0, beyond = 0.0, feed = 0.0, feed_deg = 0.0, probe_feed = 0.0;
  bool with = true;
  std::int64_t runs = 1;
  std::size_t about() const { return static_cast<std::size_t>(axis.front() - 'A'); }
};

/// One touch: from beside the ball to inside it.
struct Touch {
  Vector from{}, to{};
};

tl::unexpected<Error> wrong(const char* key, std::string message) {
  Error error{"program-probing: " + std::move(message)};
  error.key = key;
  return fail(std::move(error));
}

std::string mm(double value) {
  std::string text = programs::number(std::round(value * 1e4) / 1e4);
  if (text == "-0") text = "0";
  return text.find('.') == std::string::npos ? text + ".0" : text;
}

/// Where the ball is at an angle: turned about a line along a coordinate.
Vector turned(const Wish& w, double height, double angle) {
  const std::size_t k = w.about(), i = (k + 1) % 3, j = (k + 2) % 3;
  const double t = (w.with ? angle : -angle) * degree;
  const double u = w.ball[i] - w.centre[i], v = w.ball[j] - w.centre[j];
  Vector out;
  out[i] = w.centre[i] + u * std::cos(t) - v * std::sin(t);
  out[j] = w.centre[j] + u * std::sin(t) + v * std::cos(t);
  out[k] = w.ball[k] + height;
  return out;
}

/// From above, then from four sides at the height of the centre.
std::vector<Touch> touches(const Wish& w, const Vector& c) {
  std::vector<Touch> out;
  for (const auto& [k, side] :
       {std::pair<std::size_t, double>{2, 1.0}, {0, 1.0}, {0, -1.0}, {1, 1.0}, {1, -1.0}}) {
    Touch t{c, c};
    t.from[k] += side * (w.radius + w.approach);
    t.to[k] += side * (w.radius - w.beyond);
    out.push_back(t);
  }
  return out;
}

/// The words of a control.
struct Dialect {
  const Wish& w;
  std::string log;  ///< name of the file
  std::string out;

  bool siemens() const { return w.dialect == "siemens"; }
  void line(const std::string& text) { out += text + "\n"; }
  void comment(const std::string& text) { line(siemens() ? "; " + text : "(" + text + ")"); }

  std::string columns(double angle, const std::array<std::string, 3>& xyz, const char* between) {
    std::string text;
    for (const std::string& value : xyz) text += value + between;
    for (std::size_t k = 0; k < 3; ++k) text += (k == w.about() ? mm(angle) : "0") + between;
    return text + "0" + between + "0" + between + "0";
  }

  void begin() {
    if (siemens()) {
      line("DEF INT RC");
      line("G710 G90 G94 G40 G500 D0");
      return;
    }
    line("G21 G17 G90 G94 G40 G49 G80");
    line("G54");
    line(w.dialect == "fanuc" ? "POPEN" : "(PROBEOPEN " + log + ")");
  }

  void move(const std::string& words, double feed) {
    line("G1 " + words + " F" + programs::number(feed));
  }

  void touch(const Touch& t, std::size_t k, double angle) {
    const std::string feed = " F" + programs::number(w.probe_feed);
    const std::string to = linear[k] + mm(t.to[k]);
    if (siemens()) {
      // All three: positions are stored of the axes that the block names.
      std::string all;
      for (std::size_t i = 0; i < 3; ++i) all += std::string(" ") + linear[i] + mm(t.to[i]);
      line("MEAS=1 G1" + all + feed);
      line("STOPRE");
      line("IF $AC_MEA[1]==0 GOTOF NO_CONTACT");
      const auto value = [](const char* axis) {
        return "\"<<$AA_MM[" + std::string(axis) + "]<<\"";
      };
      line("WRITE(RC,\"" + log + "\",\"" +
           columns(angle, {value("X"), value("Y"), value("Z")}, " ") + "\")");
    } else if (w.dialect == "fanuc") {
      line("G31 " + to + feed);
      line("IF [ABS[#" + std::to_string(5061 + k) + "-[" + mm(t.to[k]) +
           "]] LT 0.002] THEN #3000=1(NO CONTACT)");
      line("DPRNT[" + columns(angle, {"#5061[44]", "#5062[44]", "#5063[44]"}, "*") + "]");
    } else {
      line("G38.2 " + to + feed);
    }
  }

  void end() {
    if (siemens()) {
      line("M30");
      line("NO_CONTACT:");
      line("MSG(\"no contact\")");
      line("M0");
    } else {
      line(w.dialect == "fanuc" ? "PCLOS" : "(PROBECLOSE)");
    }
    line("M30");
  }
};

std::optional<Vector> three(const Settings& o, const char* name) {
  const std::vector<double> v = o.numbers(name);
  if (v.size() != 3) return {};
  return Vector{v[0], v[1], v[2]};
}

Expected<Wish> wish_of(const Settings& o, const Machine& machine) {
  Wish w;
  w.dialect = o.text("dialect");
  if (w.dialect == "heidenhain")
    return wrong("dialect",
                 "heidenhain: no public text of the blocks of its touch-probe cycles was found, so "
                 "no program is written; expected linuxcnc, fanuc or siemens");
  w.axis = o.text("axis");
  const auto centre = three(o, "centre_mm"), ball = three(o, "ball_mm");
  if (!centre) return wrong("centre_mm", "centre_mm: expected X, Y, Z of a point of the axis");
  if (!ball) return wrong("ball_mm", "ball_mm: expected X, Y, Z of the ball with the axis at 0");
  w.centre = *centre, w.ball = *ball;
  w.heights = o.numbers("heights_mm");
  if (w.heights.empty()) w.heights = {0.0};
  w.radius = o.number("radius_mm"), w.approach = o.number("approach_mm");
  w.beyond = o.number("beyond_mm");
  if (w.beyond >= w.radius)
    return wrong("beyond_mm", "beyond_mm: expected less than radius_mm, " + mm(w.radius) +
                                  "; found " + mm(w.beyond));
  w.feed = o.number("feed_mm_per_min"), w.feed_deg = o.number("feed_deg_per_min");
  w.probe_feed = o.number("probe_feed_mm_per_min");
  w.with = o.text("turns") == "right-handed";
  w.runs = o.integer("runs");
  const double from = o.number("from_deg"), to = o.number("to_deg");
  const auto places = static_cast<std::size_t>(o.integer("places"));
  if (!(from < to) || to - from > 360.0)
    return wrong("to_deg", "from_deg to_deg: expected a range of at most 360 deg, from below to");
  const bool turn = to - from > 359.999;  // the last place would be the first one
  for (std::size_t i = 0; i < places; ++i)
    w.angles.push_back(from + (to - from) * static_cast<double>(i) /
                                  static_cast<double>(turn ? places : places - 1));
  const Axis* axis = machine.axis(w.axis);
  if (axis == nullptr || !axis->rotary)
    return wrong("axis", "the machine has no rotary axis " + w.axis);
  return w;
}

/// That the machine reaches a place, if its travel is known.
Expected<void> reaches(const Machine& machine, const char* name, double value, bool rotary) {
  const Axis* axis = machine.axis(name);
  if (axis == nullptr || !axis->travel) return {};
  const double si = rotary ? value * degree : value * 1e-3;
  const auto [from, to] = *axis->travel;
  if (si > from - 1e-9 && si < to + 1e-9) return {};
  return wrong("machine.axes",
               std::string("axis ") + name + " would go to " + mm(value) + ", outside its travel");
}

Expected<std::string> program(const Wish& w, const Machine& machine, double height,
                              const std::string& name) {
  std::vector<Vector> centres;
  for (const double angle : w.angles) centres.push_back(turned(w, height, angle));
  double safe = centres.front()[2];
  for (const Vector& c : centres) safe = std::max(safe, c[2]);
  safe += w.radius + 2.0 * w.approach;
  Dialect d{w, w.dialect == "siemens" ? "NONIO_" + name : "nonio-" + name + ".txt", {}};
  d.comment("ball on " + w.axis + ", " + std::to_string(w.angles.size()) + " angles, " +
            std::to_string(w.runs) + " runs, 5 touches each");
  d.comment("positions: machine, mm, of the stylus tip; no offset may be active");
  d.comment(
      "from above and from four sides at the height of the centre: the stem must not be there");
  d.comment("the ball goes " + std::string(w.with ? "right-handed" : "left-handed") +
            " about the axis: LOOK AT IT FIRST");
  d.comment("DRY RUN FIRST, WITHOUT THE BALL, AT LOW OVERRIDE");
  d.begin();
  d.move("Z" + mm(safe), w.feed);
  for (std::int64_t run = 0; run < w.runs; ++run)
    for (std::size_t i = 0; i < centres.size(); ++i) {
      if (auto there = reaches(machine, w.axis.c_str(), w.angles[i], true); !there)
        return fail(there.error());
      d.move(w.axis + mm(w.angles[i]), w.feed_deg);
      for (const Touch& t : touches(w, centres[i])) {
        for (std::size_t k = 0; k < 3; ++k)
          for (const double at : {t.from[k], t.to[k], k == 2 ? safe : t.from[k]})
            if (auto there = reaches(machine, linear[k], at, false); !there)
              return fail(there.error());
        std::size_t k = 0;
        for (std::size_t n = 0; n < 3; ++n)
          if (t.from[n] != t.to[n]) k = n;
        d.move("X" + mm(t.from[0]) + " Y" + mm(t.from[1]), w.feed);
        d.move("Z" + mm(t.from[2]), w.feed);
        d.touch(t, k, w.angles[i]);
        d.move(linear[k] + mm(t.from[k]), w.feed);
        d.move("Z" + mm(safe), w.feed);
      }
    }
  d.end();
  return d.out;
}

Expected<OutputResult> write(const OutputInput& in) {
  const Machine& machine = in.campaign.machine;
  const auto w = wish_of(in.options, machine);
  if (!w) return fail(w.error());
  OutputResult result;
  const char* ending = w->dialect == "siemens" ? ".mpf" : ".ngc";
  for (std::size_t i = 0; i < w->heights.size(); ++i) {
    const std::string name =
        w->axis + (w->heights.size() > 1 ? std::to_string(i + 1) : std::string());
    auto text = program(*w, machine, w->heights[i], name);
    if (!text) return fail(text.error());
    result.artifacts.push_back({"program-probing-" + name + ending, std::move(*text)});
  }
  result.notes.push_back({.id = "program.dry-run"});
  if (w->dialect != "linuxcnc")
    result.notes.push_back({.id = "program.no-control", .texts = {{"output", "program-probing"}}});
  return result;
}

std::vector<Option> options() {
  return {
      {"dialect",
       std::string("linuxcnc"),
       "",
       "linuxcnc: G38.2; fanuc: G31; siemens: MEAS; heidenhain is refused, with the reason.",
       {"linuxcnc", "fanuc", "siemens", "heidenhain"}},
      {"axis", std::string("C"), "", "The rotary axis.", {"A", "B", "C"}},
      {"centre_mm", std::vector<double>{}, "mm", "X, Y, Z of a point of the axis, roughly."},
      {"ball_mm", std::vector<double>{}, "mm",
       "X, Y, Z of the machine with the stylus tip in the ball's centre, the axis at 0."},
      {"heights_mm", std::vector<double>{}, "mm",
       "A program for each: how far along the axis the ball is set on; empty: one, 0."},
      {"turns",
       std::string("right-handed"),
       "",
       "How the ball goes round as the axis's coordinate grows, about +X, +Y or +Z.",
       {"right-handed", "left-handed"}},
      {"places", std::int64_t{8}, "", "Angles, evenly.", {}, 3.0, 1000.0},
      {"from_deg", 0.0, "deg", "First angle.", {}, -3600.0, 3600.0},
      {"to_deg", 360.0, "deg", "Last angle; a whole turn: the first again.", {}, -3600.0, 3600.0},
      {"runs", std::int64_t{1}, "", "Each angle so many times.", {}, 1.0, 100.0},
      {"radius_mm", 15.0, "mm", "Ball and stylus tip together.", {}, 0.5, 500.0},
      {"approach_mm", 5.0, "mm", "From where a touch begins to the surface.", {}, 0.1, 500.0},
      {"beyond_mm", 3.0, "mm", "How far behind the surface a touch ends.", {}, 0.1, 500.0},
      {"feed_mm_per_min", 1000.0, "mm/min", "Between the touches.", {}, 1.0, 1e5},
      {"feed_deg_per_min", 720.0, "deg/min", "Of the rotary axis.", {}, 1.0, 1e6},
      {"probe_feed_mm_per_min", 100.0, "mm/min", "Of a touch.", {}, 1.0, 1e4}};
}

}  // namespace
}  // namespace nonio

NONIO_PLUGIN(registry) {
  nonio::Output output;
  output.info = {"program-probing", "1.0.0",
                 "Part programs that probe a ball on a rotary axis at several angles.",
                 nonio::options(), true};
  output.applies = [](const nonio::Campaign&) { return true; };
  output.write = nonio::write;
  registry.add(std::move(output));
}
