// SPDX-License-Identifier: Apache-2.0
#include "programs.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "nonio/sdk/format.h"

namespace nonio::programs {

namespace {

std::string plain(std::string_view text) {
  std::string out;
  for (const char c : text) {
    const bool ends_comment = c == '(' || c == ')' || c == ';' || c == '%' || c == '"';
    out += c < 0x20 || c > 0x7e ? '?' : ends_comment ? ' ' : c;
  }
  return out;
}

using math::MeasuringPath;
using math::MeasuringRequest;

constexpr double mm = 1e-3;
constexpr double deg = 1.0 / deg_per_rad;
constexpr double full_turn = 360.0 * deg;
constexpr double slack = 1e-9;         // m or rad, tolerance for rounding
constexpr double most_readings = 1e5;  // limit per program: 140 h at 5 s per reading

struct Plan {
  std::string x, y;
  int n = 0;
  double step_x = 0.0, step_y = 0.0;
};

std::optional<double> cell(const PointTable& rows, std::string_view name, std::size_t row) {
  const PointTable::Column* column = rows.column(name);
  if (column == nullptr || row >= column->values.size()) return std::nullopt;
  return column->values[row];
}

std::optional<Plan> plan_of(const OutputInput& in) {
  const auto row = static_cast<std::size_t>(in.options.integer("plan", 1) - 1);
  for (const Results::Analysed& a : in.results.analyses) {
    const auto n = cell(a.evaluation.rows, "n", row);
    const auto x = cell(a.evaluation.rows, "step_x", row);
    const auto y = cell(a.evaluation.rows, "step_y", row);
    if (n && x && y)
      return Plan{in.options.text("x"), in.options.text("y"), static_cast<int>(*n), *x, *y};
  }
  return std::nullopt;
}

tl::unexpected<Error> wrong(std::string key, const std::string& message) {
  Error error{message};
  error.key = std::move(key);
  return fail(std::move(error));
}

class Requests {
 public:
  explicit Requests(const OutputInput& in) : in_(in), o_(in.options), plan_(plan_of(in)) {
    wish_.runs = static_cast<int>(o_.integer("runs"));
    wish_.dwell = o_.number("dwell_s");
    wish_.resolution = o_.number("resolution_mm") * mm;
    wish_.both_directions = o_.flag("both_directions", true);
  }

  Expected<std::vector<Program>> all() {
    std::vector<std::string> asked = o_.texts("programs");
    if (asked.empty()) {
      asked = {"axes"};
      if (plan_) asked.emplace_back("diagonals");
    }
    for (auto it = asked.begin(); it != asked.end(); ++it) {
      const std::string& what = *it;
      if (std::find(asked.begin(), it, what) != it) continue;
      const auto done = what == "axes"             ? axes()
                        : what == "diagonals"      ? diagonals(false)
                        : what == "half-diagonal"  ? diagonals(true)
                        : what == "step-diagonals" ? step_diagonals()
                        : what == "sign-probe"     ? sign_probe()
                                                   : unknown(what);
      if (!done) return fail(done.error());
    }
    return std::move(programs_);
  }

 private:
  static Expected<void> unknown(const std::string& what) {
    return wrong("programs",
                 "programs: expected axes, diagonals, half-diagonal, step-diagonals; found \"" +
                     what + "\"");
  }

  double over_travel(bool rotary) const {
    return rotary ? o_.number("over_travel_deg") * deg : o_.number("over_travel_mm") * mm;
  }

  Expected<const Axis*> axis(const std::string& name) const {
    const Axis* a = in_.campaign.machine.axis(name);
    if (a == nullptr || a->rotary || !a->travel)
      return wrong("machine.axes." + name,
                   "axis " + name + ": expected a linear axis with its travel");
    return a;
  }

  Expected<void> room(const Axis& a, double length) const {
    const double wanted = length + 2.0 * over_travel(a.rotary);
    const double travel = a.travel->second - a.travel->first;
    if (wanted <= travel + slack) return {};
    return wrong("over_travel_mm", "axis " + a.name + ": " + number(length / mm) +
                                       " mm and the over-travel at both ends want " +
                                       number(wanted / mm) + " mm, the travel is " +
                                       number(travel / mm) + " mm");
  }

  Expected<void> bounded(const std::string& name, double stops) const {
    const double readings = stops * wish_.runs * (wish_.both_directions ? 2.0 : 1.0);
    if (readings <= most_readings) return {};
    return wrong("runs", name + ": " + number(readings) + " readings, expected at most " +
                             number(most_readings) + ": fewer runs or larger intervals");
  }

  Expected<void> axes() {
    const std::vector<std::string> names = o_.texts("axes");
    for (const std::string& name : names)
      if (const Axis* a = in_.campaign.machine.axis(name); a == nullptr || !a->travel)
        return wrong("axes", "axes: the machine has no axis \"" + name + "\" with a travel");
    bool any = false;
    for (const Axis& a : in_.campaign.machine.axes) {
      const bool asked =
          names.empty() || std::find(names.begin(), names.end(), a.name) != names.end();
      if (!a.travel || !asked) continue;
      any = true;
      if (auto done = axis_program(a); !done) return done;
    }
    if (!any) return wrong("machine.axes", "no axis has a travel: expected travel = [from, to]");
    return {};
  }

  Expected<void> axis_program(const Axis& a) {
    math::AxisTargets wanted;
    std::string how;
    const std::string choice = o_.text("targets", "auto");
    const bool planned = plan_ && choice != "random" && (a.name == plan_->x || a.name == plan_->y);
    const auto [first, last] = range(a);
    wanted.first = first;
    wanted.last = last;
    wanted.resolution = a.rotary ? 1e-4 * deg : o_.number("resolution_mm") * mm;
    wanted.seed = static_cast<std::uint64_t>(o_.integer("seed"));
    if (planned) {
      const double step = a.name == plan_->x ? plan_->step_x : plan_->step_y;
      if (auto fits = room(a, plan_->n * step); !fits) return fits;
      wanted.points = plan_->n + 1;
      wanted.last = wanted.first + plan_->n * step;
      how = "targets: the grid of the plan, " + number(step / mm) + " mm";
      if (auto fine = bounded(a.name, wanted.points); !fine) return fine;
    } else if (auto fine = spread(a, choice, wanted, how); !fine) {
      return fine;
    }
    const auto targets = math::axis_targets(wanted);
    if (!targets)
      return wrong("machine.axes." + a.name, "axis " + a.name + ": " + targets.error().message);
    wish_.over_travel = over_travel(a.rotary);
    if (beyond(a, targets->front(), targets->back()))
      how += "; the travel is a whole turn: it is taken to go on beyond its ends";
    add(math::axis_path(a.name, a.rotary, *targets, wish_), how);
    return {};
  }

  bool beyond(const Axis& a, double first, double last) const {
    return first - over_travel(a.rotary) < a.travel->first - slack ||
           last + over_travel(a.rotary) > a.travel->second + slack;
  }

  /// The travel without the over-travel. A rotary axis with a full revolution has targets at 0 deg
  /// and 360 deg, if possible from a cardinal angle, even if the over-travel then exceeds the
  /// travel.
  std::pair<double, double> range(const Axis& a) const {
    const auto [from, to] = *a.travel;
    const double o = over_travel(a.rotary);
    if (!a.rotary || to - from < full_turn - slack) return {from + o, to - o};
    for (const double angle : math::cardinal_angles(from + o, to - o - full_turn))
      return {angle, angle + full_turn};
    for (const double angle : math::cardinal_angles(from, to - full_turn))
      return {angle, angle + full_turn};
    return {from, from + full_turn};
  }

  Expected<void> spread(const Axis& a, const std::string& choice, math::AxisTargets& wanted,
                        std::string& how) const {
    const double length = wanted.last - wanted.first;
    const double interval =
        a.rotary ? o_.number("interval_deg") * deg : o_.number("interval_mm") * mm;
    const double intervals = interval > 0.0 ? std::ceil(length / interval - slack) : length / 0.2;
    if (auto fine = bounded(a.name, intervals + 1.0); !fine) return fine;
    wanted.points = interval > 0.0 ? 1 + static_cast<int>(intervals) : math::axis_points(length);
    wanted.points = std::max(wanted.points, a.rotary ? math::rotary_points(length) : 2);
    wanted.scatter = choice != "even";
    wanted.period = a.rotary ? full_turn / a.teeth.value_or(1) : a.screw_pitch.value_or(0.0);
    how = wanted.scatter ? "targets: random offsets, seed " + std::to_string(wanted.seed)
                         : "targets: even";
    if (!a.rotary || !wanted.scatter) return {};
    wanted.among = math::cardinal_angles(wanted.first, wanted.last);
    how += "; 0, 90, 180, 270 deg as ISO 230-2 requires";
    return {};
  }

  Expected<void> diagonals(bool half) {
    if (!plan_)
      return wrong("programs",
                   "the diagonals follow a plan with equal steps of both axes, and "
                   "there is none (analysis triple-planner makes one)");
    const auto x = axis(plan_->x), y = axis(plan_->y);
    if (!x) return fail(x.error());
    if (!y) return fail(y.error());
    if (auto fits = room(**x, plan_->n * plan_->step_x); !fits) return fits;
    if (auto fits = room(**y, plan_->n * plan_->step_y); !fits) return fits;
    if (auto fine = bounded("diagonals", plan_->n + 1.0); !fine) return fine;
    if (half && plan_->n % 2 != 0)
      return wrong("plan", "the half diagonal wants an even number of steps, the plan has " +
                               std::to_string(plan_->n));
    wish_.over_travel = over_travel(false);
    const math::Rectangle r{plan_->x,      plan_->y,      start(**x), start(**y),
                            plan_->step_x, plan_->step_y, plan_->n};
    const std::string how = std::to_string(plan_->n) + " steps of " + plan_->x + " " +
                            number(plan_->step_x / mm) + " mm, " + plan_->y + " " +
                            number(plan_->step_y / mm) + " mm";
    if (half)
      add(math::half_diagonal_path(r, wish_), how + ", every second of " + plan_->x);
    else
      for (MeasuringPath& path : math::diagonal_paths(r, wish_)) add(std::move(path), how);
    return {};
  }

  double start(const Axis& a) const { return a.travel->first + over_travel(false); }

  Expected<void> step_diagonals() {
    math::Volume v;
    v.axes = {o_.text("x"), o_.text("y"), o_.text("z")};
    v.n = static_cast<int>(o_.integer("steps"));
    if (auto fine = bounded("step diagonals", 3.0 * v.n + 1.0); !fine) return fine;
    const double unit = o_.number("resolution_mm") * mm;
    std::string how = std::to_string(v.n) + " steps of";
    for (const std::string& name : v.axes) {
      NONIO_TRY(const auto a, axis(name));
      const double usable = a->travel->second - a->travel->first - 2.0 * over_travel(false);
      const double step = std::floor(usable / v.n / unit + slack) * unit;
      if (!(step > 0.0))
        return wrong("steps", "axis " + name + ": no room for " + std::to_string(v.n) + " steps");
      v.from.push_back(start(*a));
      v.step.push_back(step);
      how += " " + name + " " + number(step / mm) + " mm";
    }
    wish_.over_travel = over_travel(false);
    for (MeasuringPath& path : math::step_diagonal_paths(v, wish_))
      add(std::move(path), how + ", one axis after the other, always from the start to the end");
    return {};
  }

  Expected<void> sign_probe() {
    const std::vector<std::string> names = o_.texts("axes");
    const Axis* a = names.size() == 1 ? in_.campaign.machine.axis(names.front()) : nullptr;
    for (const Results::Analysed& analysed : in_.results.analyses) {
      const PointTable& rows = analysed.evaluation.rows;
      const auto start = cell(rows, "start", 0), from = cell(rows, "from", 0),
                 to = cell(rows, "to", 0);
      if (a == nullptr || !start || !from || !to) continue;
      const double size = a->rotary ? deg : mm;
      wish_.runs = 1;
      add(math::probe_path(a->name, a->rotary, *start, *from, *to, wish_),
          "set the instrument to zero at the first stop, " + number(*from / size) +
              ", read it at the second, " + number(*to / size) + ": actual - nominal");
      return {};
    }
    return wrong("programs",
                 "the stops of a sign probe are chosen by `nonio table probe CAMPAIGN --out p`");
  }

  void add(MeasuringPath path, const std::string& how) {
    Program p{std::move(path), {}, 0.0};
    const bool rotary = p.path.rotary.front();
    p.feed = o_.number(rotary ? "feed_deg_per_min" : "feed_mm_per_min");
    p.about = about(p, how);
    programs_.push_back(std::move(p));
  }

  std::vector<std::string> about(const Program& p, const std::string& how) const {
    const Machine& m = in_.campaign.machine;
    const MeasuringPath& path = p.path;
    const bool rotary = path.rotary.front();
    std::string axes;
    for (const std::string& a : path.axes) axes += (axes.empty() ? "" : " ") + a;
    const auto readings = std::count_if(path.moves.begin(), path.moves.end(),
                                        [](const auto& move) { return move.dwell > 0.0; });
    std::vector<std::string> lines;
    for (const std::string& part : {m.maker, m.model, m.serial})
      if (!part.empty()) lines = {(lines.empty() ? "machine:" : lines.front()) + " " + part};
    if (lines.empty() && path.moves.back().stop)
      lines.emplace_back("machine: not named in the manifest");
    lines.push_back("measurement " + path.name + ": moves " + axes + ", the other axes stay");
    lines.push_back(how);
    lines.push_back(std::to_string(wish_.runs) + " runs, " + direction(path) + ", " +
                    std::to_string(readings) + " readings");
    const bool probe = path.moves.back().stop;
    const std::string over_travel =
        ", over-travel " + number(rotary ? wish_.over_travel / deg : wish_.over_travel / mm) +
        (rotary ? " deg" : " mm");
    lines.push_back("dwell " + number(wish_.dwell) + " s at each reading" +
                    (probe ? ", then a stop" : over_travel) + ", feed " + number(p.feed) +
                    (rotary ? " deg/min" : " mm/min"));
    if (!probe && wish_.over_travel <= 0.0)
      lines.emplace_back("no over-travel: the targets at the ends are reached from inside only");
    lines.emplace_back("DRY RUN FIRST, without instrument, at low override");
    lines.emplace_back("positions are those of the machine: no offset may be active");
    for (std::string& line : lines) line = plain(line);
    return lines;
  }

  std::string direction(const MeasuringPath& path) const {
    const bool one_way = path.axes.size() == 3 || path.moves.back().stop;
    return wish_.both_directions && !one_way ? "both directions" : "one direction";
  }

  const OutputInput& in_;
  const Settings& o_;
  std::optional<Plan> plan_;
  MeasuringRequest wish_;
  std::vector<Program> programs_;
};

Expected<std::vector<Program>> requested(const OutputInput& in) { return Requests(in).all(); }

std::string trimmed(std::string text) {
  text.erase(text.find_last_not_of('0') + 1);
  if (text.back() == '.') text.pop_back();
  return text;
}

std::string file_part(std::string_view name) {
  std::string out;
  for (const char c : name)
    out += (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') ? c : '_';
  return out;
}

/// In some dialects a digit after the axis letter would be read as part of the position.
Expected<void> check_name(const std::string& axis, const Dialect& dialect) {
  const auto letter = [](char c) { return (c >= 'A' && c <= 'Z') || (c >= 'a' && c <= 'z'); };
  if (letter(axis.front()) && file_part(axis) == axis && (axis.size() == 1 || dialect.long_names))
    return {};
  Error error{"axis " + axis + ": expected " +
              (dialect.long_names ? "letters and digits" : "a single letter") +
              " for a name in a program; option axes leaves it out"};
  error.key = "machine.axes." + axis;
  return fail(std::move(error));
}

}  // namespace

std::string position(const math::MeasuringPath& path, std::size_t axis, double si) {
  std::string text = trimmed(fixed_text(printed(si, position_of(path.rotary[axis])), 6));
  // Some controls read a number without a decimal point as increments.
  return text.find('.') == std::string::npos ? text + ".0" : text;
}

std::string number(double value) { return trimmed(fixed_text(value, 6)); }

std::vector<Option> options(std::vector<Option> own) {
  std::vector<Option> all = {
      {"programs", std::vector<std::string>{}, "",
       "Which: axes, diagonals, half-diagonal, step-diagonals; empty: axes, and the diagonals "
       "where the campaign has a plan (sign-probe is for `nonio table probe`)."},
      {"axes", std::vector<std::string>{}, "", "Of the axis runs; empty: all that have a travel."},
      within(1.0, 1000.0,
             {"plan", std::int64_t{1}, "", "Row of the plan that the diagonals follow."}),
      {"x", std::string("X"), "", "First axis of the diagonals."},
      {"y", std::string("Y"), "", "Second axis of the diagonals."},
      {"z", std::string("Z"), "", "Third axis of the step diagonals."},
      within(1.0, 1000.0,
             {"steps", std::int64_t{30}, "", "Steps of each axis of a step diagonal."}),
      within(1.0, 100.0, {"runs", std::int64_t{5}, "", "Runs of each program."}),
      {"both_directions", true, "", "Readings on the way back too (not in step diagonals)."},
      within(0.1, 3600.0, {"dwell_s", 5.0, "s", "Rest at each target."}),
      within(1.0, 1e5, {"feed_mm_per_min", 2000.0, "mm/min", "Feed between the targets."}),
      within(1.0, 1e6, {"feed_deg_per_min", 720.0, "deg/min", "The same of a rotary axis."}),
      within(0.0, 1e4, {"over_travel_mm", 1.0, "mm", "Kept free beyond the targets at both ends."}),
      within(0.0, 360.0, {"over_travel_deg", 1.0, "deg", "The same of a rotary axis."}),
      one_of({"auto", "random", "even"}, {"targets", std::string("auto"), "",
                                          "Of the axis runs: auto takes the plan's grid, else "
                                          "random offsets as ISO 230-2 requires."}),
      within(0.0, 1e5, {"interval_mm", 0.0, "mm", "Between targets; 0: as ISO 230-2 requires."}),
      within(0.1, 360.0, {"interval_deg", 30.0, "deg", "Between targets of a rotary axis."}),
      within(1e-6, 10.0, {"resolution_mm", 0.001, "mm", "Targets are whole multiples of it."}),
      within(0.0, 1e9,
             {"seed", std::int64_t{1}, "",
              "Of the random offsets; the same seed, the same targets."})};
  for (Option& option : own) all.push_back(std::move(option));
  return all;
}

Expected<OutputResult> written(const OutputInput& in, const Dialect& dialect) {
  NONIO_TRY(const auto programs, requested(in));
  OutputResult result;
  for (const Program& p : programs)
    for (const std::string& axis : p.path.axes)
      if (auto named = check_name(axis, dialect); !named) return fail(named.error());
  for (const Program& p : programs)
    result.artifacts.push_back(
        {std::string(dialect.output) + "-" + file_part(p.path.name) + std::string(dialect.ending),
         dialect.format(p, in.options)});
  result.notes.push_back({.id = "program.dry-run"});
  if (!dialect.tried)
    result.notes.push_back(
        {.id = "program.no-control", .texts = {{"output", std::string(dialect.output)}}});
  return result;
}

}  // namespace nonio::programs
