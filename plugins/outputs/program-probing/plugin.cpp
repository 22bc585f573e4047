// SPDX-License-Identifier: Apache-2.0
// Part programs that probe a ball on a rotary axis, or on a pair of stacked rotary axes, at several
// angles and heights (kind ball-centres). Each touch is logged as nine numbers, X Y Z A B C U V W,
// for the reader linuxcnc-probe.
#include "nonio/sdk/plugin.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <numbers>

#include "nonio/sdk/format.h"
#include "programs.h"

namespace nonio::program_probing {
namespace {

using Vector = std::array<double, 3>;

struct Turning {
  std::string axis;
  Vector centre{};
  bool with = true;  ///< right-handed about +X, +Y or +Z; otherwise left-handed
  std::size_t about() const { return static_cast<std::size_t>(axis.front() - 'A'); }
  Vector direction(const Vector&, double angle) const;
  Vector point(const Vector&, double angle) const;
};

struct Ball {
  Turning table;                      ///< the axis that carries the ball
  std::optional<Turning> carrier;     ///< absent if no other axis carries the table
  Vector at{}, stem{0.0, 0.0, -1.0};  ///< mm; unit vector along the stem; at axis positions 0
  double radius = 0.0, approach = 0.0, beyond = 0.0;
};

struct Place {
  double angle = 0.0;
  std::optional<double> carrier{};
  Vector ball{}, stem{};
};

struct Touch {
  Vector from{}, to{};
};

Vector Turning::direction(const Vector& v, double angle) const {
  const std::size_t k = about(), i = (k + 1) % 3, j = (k + 2) % 3;
  const double t = (with ? angle : -angle) * std::numbers::pi / 180.0;
  Vector out = v;
  out[i] = v[i] * std::cos(t) - v[j] * std::sin(t);
  out[j] = v[i] * std::sin(t) + v[j] * std::cos(t);
  return out;
}

Vector Turning::point(const Vector& p, double angle) const {
  Vector from{};
  for (std::size_t i = 0; i < 3; ++i) from[i] = p[i] - centre[i];
  Vector out = direction(from, angle);
  for (std::size_t i = 0; i < 3; ++i) out[i] += centre[i];
  return out;
}

/// The ball, `height` higher along the table axis, rotated about the table axis and then about the
/// carrier.
Place place_of(const Ball& ball, double height, double angle, std::optional<double> carrier) {
  Vector at = ball.at;
  at[ball.table.about()] += height;
  Place out{angle, carrier, ball.table.point(at, angle), ball.table.direction(ball.stem, angle)};
  if (!carrier || !ball.carrier) return out;
  out.ball = ball.carrier->point(out.ball, *carrier);
  out.stem = ball.carrier->direction(out.stem, *carrier);
  return out;
}

/// Touches from above and from four sides at the height of the center. A side less than 60 deg from
/// the stem is replaced by free directions between the sides. Empty if the stem points up.
std::vector<Touch> touches(const Ball& ball, const Place& place) {
  constexpr double diagonal = std::numbers::sqrt2 / 2.0, nearest = 0.5;  // cos 60 deg
  const auto is_free = [&](const Vector& way) {
    return way[0] * place.stem[0] + way[1] * place.stem[1] + way[2] * place.stem[2] <
           nearest - 1e-9;
  };
  const Vector above{0.0, 0.0, 1.0};
  if (!is_free(above)) return {};
  std::vector<Vector> ways{above};
  const Vector sides[] = {{1.0, 0.0, 0.0}, {-1.0, 0.0, 0.0}, {0.0, 1.0, 0.0}, {0.0, -1.0, 0.0}};
  for (const Vector& side : sides)
    if (is_free(side)) ways.push_back(side);
  if (ways.size() < 5)
    for (const double x : {diagonal, -diagonal})
      for (const double y : {diagonal, -diagonal})
        if (is_free({x, y, 0.0})) ways.push_back({x, y, 0.0});
  std::vector<Touch> out;
  for (const Vector& way : ways) {
    Touch t{place.ball, place.ball};
    for (std::size_t k = 0; k < 3; ++k) {
      t.from[k] += way[k] * (ball.radius + ball.approach);
      t.to[k] += way[k] * (ball.radius - ball.beyond);
    }
    out.push_back(t);
  }
  return out;
}

constexpr std::array<const char*, 3> linear{"X", "Y", "Z"};

struct Wish {
  std::string dialect;
  Ball ball;
  std::vector<double> angles, carrier_angles, heights;
  double feed = 0.0, feed_deg = 0.0, probe_feed = 0.0;
  std::int64_t runs = 1;
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

struct Dialect {
  const Wish& w;
  std::string log;
  std::string out;

  bool siemens() const { return w.dialect == "siemens"; }
  void line(const std::string& text) { out += text + "\n"; }
  void comment(const std::string& text) { line(siemens() ? "; " + text : "(" + text + ")"); }

  std::string columns(const Place& place, const std::array<std::string, 3>& xyz,
                      const char* between) {
    std::array<std::string, 3> angles{"0", "0", "0"};
    angles[w.ball.table.about()] = mm(place.angle);
    if (place.carrier) angles[w.ball.carrier->about()] = mm(*place.carrier);
    std::string text;
    for (const auto& values : {xyz, angles})
      for (const std::string& value : values) text += value + between;
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

  void touch(const Touch& t, const Place& place) {
    const std::string feed = " F" + programs::number(w.probe_feed);
    std::string to;
    std::size_t k = 0;
    for (std::size_t i = 0; i < 3; ++i) {
      if (t.from[i] != t.to[i]) to += (to.empty() ? "" : " ") + (linear[i] + mm(t.to[i]));
      if (std::fabs(t.from[i] - t.to[i]) > std::fabs(t.from[k] - t.to[k])) k = i;
    }
    if (siemens()) {
      // All three axes, because only positions of axes in the block are stored.
      std::string all;
      for (std::size_t i = 0; i < 3; ++i) all += std::string(" ") + linear[i] + mm(t.to[i]);
      line("MEAS=1 G1" + all + feed);
      line("STOPRE");
      line("IF $AC_MEA[1]==0 GOTOF NO_CONTACT");
      const auto value = [](const char* axis) {
        return "\"<<$AA_MM[" + std::string(axis) + "]<<\"";
      };
      line("WRITE(RC,\"" + log + "\",\"" +
           columns(place, {value("X"), value("Y"), value("Z")}, " ") + "\")");
    } else if (w.dialect == "fanuc") {
      line("G31 " + to + feed);
      line("IF [ABS[#" + std::to_string(5061 + k) + "-[" + mm(t.to[k]) +
           "]] LT 0.002] THEN #3000=1(NO CONTACT)");
      line("DPRNT[" + columns(place, {"#5061[44]", "#5062[44]", "#5063[44]"}, "*") + "]");
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

Expected<void> add_carrier(const Settings& o, const Machine& machine, Wish& w) {
  Turning carrier;
  carrier.axis = o.text("carried_by");
  if (carrier.axis.empty()) return {};
  const Axis* axis = machine.axis(carrier.axis);
  if (axis == nullptr || !axis->rotary || carrier.axis == w.ball.table.axis)
    return wrong("carried_by", "carried_by: expected another rotary axis of the machine than " +
                                   w.ball.table.axis + ", found " + carrier.axis);
  const auto centre = three(o, "carrier_centre_mm");
  if (!centre)
    return wrong("carrier_centre_mm",
                 "carrier_centre_mm: expected X, Y, Z of a point of axis " + carrier.axis);
  w.carrier_angles = o.numbers("carrier_deg");
  if (w.carrier_angles.empty())
    return wrong("carrier_deg", "carrier_deg: expected the positions of axis " + carrier.axis +
                                    ", three or more; found none");
  carrier.centre = *centre;
  carrier.with = o.text("carrier_turns") == "right-handed";
  w.ball.carrier = std::move(carrier);
  return {};
}

Expected<Wish> wish_of(const Settings& o, const Machine& machine) {
  Wish w;
  w.dialect = o.text("dialect");
  if (w.dialect == "heidenhain")
    return wrong("dialect",
                 "heidenhain: no public text of the blocks of its touch-probe cycles was found, so "
                 "no program is written; expected linuxcnc, fanuc or siemens");
  w.ball.table.axis = o.text("axis");
  const auto centre = three(o, "centre_mm"), ball = three(o, "ball_mm");
  if (!centre) return wrong("centre_mm", "centre_mm: expected X, Y, Z of a point of the axis");
  if (!ball) return wrong("ball_mm", "ball_mm: expected X, Y, Z of the ball with the axis at 0");
  w.ball.table.centre = *centre, w.ball.at = *ball;
  w.heights = o.numbers("heights_mm");
  if (w.heights.empty()) w.heights = {0.0};
  w.ball.radius = o.number("radius_mm"), w.ball.approach = o.number("approach_mm");
  w.ball.beyond = o.number("beyond_mm");
  if (w.ball.beyond >= w.ball.radius)
    return wrong("beyond_mm", "beyond_mm: expected less than radius_mm, " + mm(w.ball.radius) +
                                  "; found " + mm(w.ball.beyond));
  w.feed = o.number("feed_mm_per_min"), w.feed_deg = o.number("feed_deg_per_min");
  w.probe_feed = o.number("probe_feed_mm_per_min");
  const std::string stem = o.text("stem");
  w.ball.stem = {};
  w.ball.stem[static_cast<std::size_t>(stem[1] - 'X')] = stem[0] == '+' ? 1.0 : -1.0;
  w.ball.table.with = o.text("turns") == "right-handed";
  w.runs = o.integer("runs");
  const double from = o.number("from_deg"), to = o.number("to_deg");
  const auto places = static_cast<std::size_t>(o.integer("places"));
  if (!(from < to) || to - from > 360.0)
    return wrong("to_deg", "from_deg to_deg: expected a range of at most 360 deg, from below to");
  const bool turn = to - from > 359.999;
  for (std::size_t i = 0; i < places; ++i)
    w.angles.push_back(from + (to - from) * static_cast<double>(i) /
                                  static_cast<double>(turn ? places : places - 1));
  const Axis* axis = machine.axis(w.ball.table.axis);
  if (axis == nullptr || !axis->rotary)
    return wrong("axis", "the machine has no rotary axis " + w.ball.table.axis);
  if (auto added = add_carrier(o, machine, w); !added) return fail(added.error());
  return w;
}

Expected<void> reaches(const Machine& machine, const char* name, double value, bool rotary) {
  const Axis* axis = machine.axis(name);
  if (axis == nullptr || !axis->travel) return {};
  const double si = rotary ? value * std::numbers::pi / 180.0 : value * 1e-3;
  const auto [from, to] = *axis->travel;
  if (si > from - 1e-9 && si < to + 1e-9) return {};
  return wrong("machine.axes",
               std::string("axis ") + name + " would go to " + mm(value) + ", outside its travel");
}

std::vector<Place> places_of(const Wish& w, double height) {
  std::vector<Place> out;
  std::vector<std::optional<double>> carrier(w.carrier_angles.begin(), w.carrier_angles.end());
  if (!w.ball.carrier) carrier = {std::nullopt};
  for (std::int64_t run = 0; run < w.runs; ++run)
    for (const auto& carried : carrier)
      for (const double angle : w.angles) out.push_back(place_of(w.ball, height, angle, carried));
  return out;
}

void begin(Dialect& d, const Wish& w) {
  const std::string angles = std::to_string(w.angles.size()) + " angles, ",
                    runs = std::to_string(w.runs) + " runs";
  if (w.ball.carrier)
    d.comment("ball on " + w.ball.table.axis + ", carried by " + w.ball.carrier->axis + ", " +
              std::to_string(w.carrier_angles.size()) + " times " + angles + runs);
  else
    d.comment("ball on " + w.ball.table.axis + ", " + angles + runs + ", 5 touches each");
  d.comment("positions: machine, mm, of the stylus tip; no offset may be active");
  d.comment(
      "from above and from four sides at the height of the centre: the stem must not be there");
  for (const Turning* turning : {&w.ball.table, w.ball.carrier ? &*w.ball.carrier : nullptr})
    if (turning != nullptr)
      d.comment("the ball goes " + std::string(turning->with ? "right-handed" : "left-handed") +
                " about " + (w.ball.carrier ? "axis " + turning->axis : std::string("the axis")) +
                ": LOOK AT IT FIRST");
  d.comment("DRY RUN FIRST, WITHOUT THE BALL, AT LOW OVERRIDE");
  d.begin();
}

Expected<void> reaches(const Wish& w, const Machine& machine, const Place& place, double safe) {
  if (auto there = reaches(machine, w.ball.table.axis.c_str(), place.angle, true); !there)
    return there;
  if (place.carrier)
    if (auto there = reaches(machine, w.ball.carrier->axis.c_str(), *place.carrier, true); !there)
      return there;
  const std::vector<Touch> all = touches(w.ball, place);
  if (all.empty())
    return wrong("stem",
                 "stem: at " + w.ball.table.axis + mm(place.angle) +
                     (place.carrier ? " " + w.ball.carrier->axis + mm(*place.carrier) : "") +
                     " the stem is above the ball, where the stylus comes from");
  for (const Touch& t : all)
    for (std::size_t k = 0; k < 3; ++k)
      for (const double at : {t.from[k], t.to[k], k == 2 ? safe : t.from[k]})
        if (auto there = reaches(machine, linear[k], at, false); !there) return there;
  return {};
}

Expected<std::string> program(const Wish& w, const Machine& machine, double height,
                              const std::string& name) {
  const std::vector<Place> places = places_of(w, height);
  double safe = places.front().ball[2];
  for (const Place& place : places) safe = std::max(safe, place.ball[2]);
  safe += w.ball.radius + 2.0 * w.ball.approach;
  Dialect d{w, w.dialect == "siemens" ? "NONIO_" + name : "nonio-" + name + ".txt", {}};
  begin(d, w);
  d.move("Z" + mm(safe), w.feed);
  for (const Place& place : places) {
    if (auto there = reaches(w, machine, place, safe); !there) return fail(there.error());
    std::string turn = w.ball.table.axis + mm(place.angle);
    if (place.carrier) turn = w.ball.carrier->axis + mm(*place.carrier) + " " + turn;
    d.move(turn, w.feed_deg);
    for (const Touch& t : touches(w.ball, place)) {
      d.move("X" + mm(t.from[0]) + " Y" + mm(t.from[1]), w.feed);
      d.move("Z" + mm(t.from[2]), w.feed);
      d.touch(t, place);
      std::string back;
      for (std::size_t k = 0; k < 3; ++k)
        if (t.from[k] != t.to[k]) back += (back.empty() ? "" : " ") + (linear[k] + mm(t.from[k]));
      d.move(back, w.feed);
      d.move("Z" + mm(safe), w.feed);
    }
  }
  d.end();
  return d.out;
}

Expected<OutputResult> write(const OutputInput& in) {
  const Machine& machine = in.campaign.machine;
  NONIO_TRY(const auto w, wish_of(in.options, machine));
  OutputResult result;
  const char* ending = w.dialect == "siemens" ? ".mpf" : ".ngc";
  for (std::size_t i = 0; i < w.heights.size(); ++i) {
    const std::string name = (w.ball.carrier ? w.ball.carrier->axis : std::string()) +
                             w.ball.table.axis +
                             (w.heights.size() > 1 ? std::to_string(i + 1) : std::string());
    NONIO_TRY(auto text, program(w, machine, w.heights[i], name));
    result.artifacts.push_back({"program-probing-" + name + ending, std::move(text)});
  }
  result.notes.push_back({.id = "program.dry-run"});
  if (w.dialect != "linuxcnc")
    result.notes.push_back({.id = "program.no-control", .texts = {{"output", "program-probing"}}});
  return result;
}

std::vector<Option> options() {
  return {
      one_of(
          {"linuxcnc", "fanuc", "siemens", "heidenhain"},
          {"dialect", std::string("linuxcnc"), "",
           "linuxcnc: G38.2; fanuc: G31; siemens: MEAS; heidenhain is refused, with the reason."}),
      one_of({"A", "B", "C"},
             {"axis", std::string("C"), "", "The rotary axis that carries the ball."}),
      {"centre_mm", std::vector<double>{}, "mm",
       "X, Y, Z of a point of the axis, roughly; with all axes at 0."},
      {"ball_mm", std::vector<double>{}, "mm",
       "X, Y, Z of the machine with the stylus tip in the ball's centre, the axis at 0."},
      one_of({"-Z", "+X", "-X", "+Y", "-Y"},
             {"stem", std::string("-Z"), "",
              "Where the ball's stem goes from the ball, with all axes at 0."}),
      {"heights_mm", std::vector<double>{}, "mm",
       "A program for each: how far along the axis the ball is set on; empty: one, 0."},
      one_of({"right-handed", "left-handed"},
             {"turns", std::string("right-handed"), "",
              "How the ball goes round as the axis's coordinate grows, about +X, +Y or +Z."}),
      one_of({"", "A", "B", "C"},
             {"carried_by", std::string(), "",
              "A rotary axis on the bed that carries the other one and turns too."}),
      {"carrier_centre_mm", std::vector<double>{}, "mm",
       "X, Y, Z of a point of that axis, roughly."},
      {"carrier_deg", std::vector<double>{}, "deg",
       "Its positions: all angles are probed at each of them."},
      one_of({"right-handed", "left-handed"},
             {"carrier_turns", std::string("right-handed"), "", "As turns, of that axis."}),
      within(3.0, 1000.0, {"places", std::int64_t{8}, "", "Angles, evenly."}),
      within(-3600.0, 3600.0, {"from_deg", 0.0, "deg", "First angle."}),
      within(-3600.0, 3600.0,
             {"to_deg", 360.0, "deg", "Last angle; a whole turn: the first again."}),
      within(1.0, 100.0, {"runs", std::int64_t{1}, "", "Each angle so many times."}),
      within(0.5, 500.0, {"radius_mm", 15.0, "mm", "Ball and stylus tip together."}),
      within(0.1, 500.0, {"approach_mm", 5.0, "mm", "From where a touch begins to the surface."}),
      within(0.1, 500.0, {"beyond_mm", 3.0, "mm", "How far below the surface a touch ends."}),
      within(1.0, 1e5, {"feed_mm_per_min", 1000.0, "mm/min", "Between the touches."}),
      within(1.0, 1e6, {"feed_deg_per_min", 720.0, "deg/min", "Of the rotary axis."}),
      within(1.0, 1e4, {"probe_feed_mm_per_min", 100.0, "mm/min", "Of a touch."})};
}

}  // namespace

NONIO_PLUGIN(registry) {
  Output output;
  output.info = {"program-probing", "1.0.0",
                 "Part programs that probe a ball on a rotary axis, or on two, at several angles.",
                 options(), true};
  output.applies = [](const Campaign&) { return true; };
  output.write = write;
  registry.add(std::move(output));
}

}  // namespace nonio::program_probing
