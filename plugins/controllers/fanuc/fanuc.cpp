// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <map>

#include "axis_job.h"
#include "consumer.h"
#include "nonio/sdk/format.h"
#include "nonio/sdk/plugin.h"

namespace nonio {
namespace {

using controllers::AxisJob;
using math::Grid;
using Integers = std::vector<std::int64_t>;

constexpr std::int64_t most_magnification = 100;

struct Choices {
  bool directions, extended, returns_towards_plus;
  std::size_t max_points;
  std::int64_t magnification, reference_number, negative_numbers, last_number;
  double detection_um, detection_arcsec, interval_um, interval_arcsec;

  double detection(bool rotary) const {
    return rotary ? detection_arcsec / arcsec_per_rad : detection_um * 1e-6;
  }
  double interval_unit(bool rotary) const {
    return rotary ? interval_arcsec / arcsec_per_rad : interval_um * 1e-6;
  }
  std::int64_t least() const { return extended ? -128 : -7; }
  std::int64_t most() const { return extended ? 127 : 7; }
};

// The parameters 3620 to 3627 of one axis and its numbers.
struct Table {
  std::int64_t reference_number = 0;  // 3620
  std::int64_t low = 0, high = 0;     // 3621, 3622
  std::int64_t magnification = 1;     // 3623
  std::int64_t interval = 0;          // 3624
  std::int64_t turn = 0;              // 3625, 0 where the axis has no end to close
  std::int64_t negative_low = 0;      // 3626
  std::int64_t opposite = 0;          // 3627
  std::int64_t backlash = 0;          // 1851
  bool both = false;                  // minus has numbers of its own
  Integers plus, minus;               // increments for low..high
  double reference = 0.0;             // m or rad
};

// The reference position is a point of the grid, with an interval on both sides of it: an axis
// homed at its end still has 3621 <= 3620 < 3622.
Expected<Grid> grid_of(const AxisJob& job, const OutputInput& input, const Choices& choices,
                       double reference) {
  math::GridRule rule;
  rule.unit = choices.interval_unit(job.rotary);
  rule.most = std::max<std::size_t>(choices.max_points, 3) - 1;
  rule.step = controllers::wished_step(job, input.options);
  rule.rotary = job.rotary;
  rule.axis = job.axis;
  rule.turn = job.turn.has_value();
  rule.anchor = rule.turn ? 0.0 : reference;
  auto grid = math::choose_grid(job.table_curve().position, rule);
  if (!grid) return grid;
  if (!rule.turn && reference - grid->first < grid->step / 2.0) {
    grid->first -= grid->step;
    ++grid->points;
  }
  if (!rule.turn && grid->last() - reference < grid->step / 2.0) ++grid->points;
  return grid;
}

// The compensation -(e - zero) of one direction in whole pulses at the points of the grid.
Integers pulses(const math::ErrorCurve& curve, const std::vector<double>& values, const Grid& grid,
                double zero, double pulse) {
  std::vector<double> wanted = math::sampled(curve.position, values, grid, zero);
  for (double& v : wanted) v = 0.0 - v;
  return math::quantised(wanted, pulse);
}

// The absolute curve is rounded and then differenced. A turn begins with the number of the
// reference position, which repeats the last interval of the turn.
Integers numbers_of(const Integers& absolute, bool turn) {
  Integers steps = math::increments(absolute);
  if (turn) steps.insert(steps.begin(), steps.back());
  return steps;
}

Table table_of(const AxisJob& job, const Grid& grid, const Choices& choices, bool directions,
               double reference) {
  const auto& curve = job.table_curve();
  const bool turn = job.turn.has_value();
  const double pulse = choices.detection(job.rotary) * static_cast<double>(choices.magnification);
  Table t;
  t.reference = turn ? 0.0 : reference;
  t.magnification = choices.magnification;
  t.interval = std::llround(grid.step / choices.interval_unit(job.rotary));
  if (turn) t.turn = t.interval * static_cast<std::int64_t>(grid.points - 1);
  t.both = directions;
  const auto at_reference = [&](const std::vector<double>& values) {
    return math::ErrorCurve::at(curve.position, values, t.reference);
  };
  t.backlash = std::llround((directions ? job.present_backlash() : job.backlash()) /
                            choices.detection(job.rotary));
  if (!directions) {
    t.plus = numbers_of(pulses(curve, curve.mean, grid, at_reference(curve.mean), pulse), turn);
    return t;
  }
  // Zero where the axis returns to reference; 3627 is what the other direction has there.
  const double zero = at_reference(choices.returns_towards_plus ? curve.plus : curve.minus);
  t.plus = numbers_of(pulses(curve, curve.plus, grid, zero, pulse), turn);
  t.minus = numbers_of(pulses(curve, curve.minus, grid, zero, pulse), turn);
  const double other = at_reference(choices.returns_towards_plus ? curve.minus : curve.plus);
  t.opposite = std::llround((zero - other) / pulse);
  return t;
}

struct Outside {
  std::int64_t largest = 0, where = 0;  // 0: all numbers are in range
};

Outside outside_range(const Table& t, const Choices& choices) {
  Outside out;
  for (const Integers* list : {&t.plus, &t.minus})
    for (std::size_t i = 0; i < list->size(); ++i) {
      const std::int64_t v = (*list)[i];
      const bool outside = v < choices.least() || v > choices.most();
      if (outside && std::abs(v) > std::abs(out.largest))
        out = {v, t.low + static_cast<std::int64_t>(i)};
    }
  return out;
}

// The way out of a table that is out of range, tried before it is advised.
std::string range_advice(const AxisJob& job, const Grid& grid, Choices choices, const Table& t) {
  const std::string extended =
      choices.extended ? "" : ", or set extended = true if the control takes -128..127";
  for (++choices.magnification; choices.magnification <= most_magnification;
       ++choices.magnification)
    if (outside_range(table_of(job, grid, choices, t.both, t.reference), choices).largest == 0)
      return "set magnification = " + std::to_string(choices.magnification) + " or a smaller " +
             (job.rotary ? "step_deg" : "step_mm") + extended;
  return "magnification = " + std::to_string(most_magnification) +
         ", the largest, is not enough either: the axis must be mended or measured again" +
         extended;
}

Expected<void> check_range(const AxisJob& job, const Table& t, const Grid& grid,
                           const Choices& choices) {
  if (const Outside out = outside_range(t, choices); out.largest != 0)
    return fail("axis " + job.axis + ": number " + std::to_string(out.where) +
                " would need an increment of " + std::to_string(out.largest) +
                ", the control takes " + std::to_string(choices.least()) + ".." +
                std::to_string(choices.most()) + ": " + range_advice(job, grid, choices, t));
  if (std::abs(t.backlash) > 9999)
    return fail("axis " + job.axis + ": parameter 1851 would be " + std::to_string(t.backlash) +
                ", the control takes -9999..9999: set a larger detection_unit_um");
  return {};
}

// Numbers of all axes share one list; each axis gets the next free ones unless it is told.
struct Numbering {
  std::int64_t next = 0;
  struct Range {
    std::string axis;
    std::int64_t low, high;
  };
  std::vector<Range> taken;

  Expected<void> place(const AxisJob& job, Table& t, const Grid& grid, const Choices& choices) {
    const auto count = static_cast<std::int64_t>(t.plus.size());
    const std::int64_t before =  // numbers below that of the reference position
        t.turn != 0 ? 0 : std::llround((t.reference - grid.first) / grid.step) - 1;
    const auto asked = job.setting("reference_number");
    const bool told = asked || choices.reference_number >= 0;
    const std::int64_t reference =
        asked ? static_cast<std::int64_t>(std::llround(*asked)) : choices.reference_number;
    t.low = told ? reference - before : next;
    t.reference_number = t.low + before;
    t.high = t.low + count - 1;
    t.negative_low = choices.negative_numbers + t.low;
    if (t.low < 0 || t.high > choices.last_number)
      return fail("axis " + job.axis + ": numbers " + std::to_string(t.low) + " to " +
                  std::to_string(t.high) + " are not all in 0.." +
                  std::to_string(choices.last_number) +
                  ": set another reference_number or a larger step");
    for (const Range& r : taken)
      if (r.axis != job.axis && t.low <= r.high && r.low <= t.high)
        return fail("axes " + r.axis + " and " + job.axis + " would share numbers " +
                    std::to_string(std::max(r.low, t.low)) + " to " +
                    std::to_string(std::min(r.high, t.high)) + ": set axes = [\"" + job.axis +
                    " reference_number=...\"]");
    taken.push_back({job.axis, t.low, t.high});
    next = std::max(next, t.high + 1);
    return {};
  }
};

// Parameters of a whole word only: 3605 holds other bits that belong to the machine's builder.
std::string parameter_text(const AxisJob& job, const Table& t) {
  std::string out = "%\n";
  const auto parameter = [&](int number, std::int64_t value) {
    out += "N" + std::to_string(number) + "A" + std::to_string(job.number) + "P" +
           std::to_string(value) + "\n";
  };
  if (job.curve.bidirectional()) parameter(1851, t.backlash);
  parameter(3620, t.reference_number);
  parameter(3621, t.low);
  parameter(3622, t.high);
  parameter(3623, t.magnification);
  parameter(3624, t.interval);
  if (t.turn != 0) parameter(3625, t.turn);
  if (t.both) {
    parameter(3626, t.negative_low);
    parameter(3627, t.opposite);
  }
  const auto data = [&](std::int64_t first, const Integers& values) {
    for (std::size_t i = 0; i < values.size(); ++i)
      out += "N" + std::to_string(10000 + first + static_cast<std::int64_t>(i)) + "P" +
             std::to_string(values[i]) + "\n";
  };
  data(t.low, t.plus);
  if (t.both) data(t.negative_low, t.minus);
  return out + "%\n";
}

std::string words(const AxisJob& job, const Table& t, const Choices& choices,
                  const std::vector<std::string>& warning) {
  std::string out;
  const auto line = [&](const std::string& text) { out += text + "\n"; };
  for (const std::string& w : warning) line(w);
  for (const std::string& w : job.about) line(w);
  line(
      "sign: numbers are changes of the compensation, the opposite of the measured deviation "
      "(actual - nominal), read in the direction of plus");
  line("unit of a number: " + std::to_string(t.magnification) + " x " +
       short_text(job.rotary ? choices.detection_arcsec : choices.detection_um, 4) +
       (job.rotary ? " arcsec" : " um"));
  line(controllers::reversal_words(job, t.both));
  line("controlled axis number " + std::to_string(job.number) + "; reference position at " +
       controllers::with_unit(job, t.reference, 4));
  line(std::string("3605#0 (both directions) = ") + (t.both ? "1" : "0") +
       ", by hand: the other bits of 3605 belong to the builder of the machine");
  line("3620 = " + std::to_string(t.reference_number) + ", 3621 = " + std::to_string(t.low) +
       ", 3622 = " + std::to_string(t.high) + ", 3623 = " + std::to_string(t.magnification) +
       ", 3624 = " + std::to_string(t.interval));
  if (t.turn != 0) line("3625 = " + std::to_string(t.turn) + ", type of axis: rotary");
  if (t.both)
    line("3626 = " + std::to_string(t.negative_low) + ", 3627 = " + std::to_string(t.opposite));
  if (job.curve.bidirectional())
    line("1851 = " + std::to_string(t.backlash) +
         "; 1852 the same where rapid traverse has its own (1800#4)");
  line(
      "save the present parameters and pitch data first; power off and on after loading, then "
      "return to reference");
  return out;
}

fanuc::Machine consumer_of(const AxisJob& job, const Table& t, const Choices& choices) {
  fanuc::Machine m;
  m.axis = static_cast<int>(job.number);
  m.rotary = job.rotary;
  m.detection = choices.detection(job.rotary);
  m.interval_unit = choices.interval_unit(job.rotary);
  m.reference = t.reference;
  m.least = choices.least();
  m.most = choices.most();
  m.bidirectional = t.both;
  m.returns_towards_plus = choices.returns_towards_plus;
  m.backlash = job.present_backlash();
  return m;
}

Expected<void> write_axis(const AxisJob& job, const OutputInput& input, const Choices& choices,
                          Numbering& numbering, OutputResult& result) {
  const bool directions = choices.directions && job.curve.bidirectional();
  if (controllers::refused(job, directions, result)) return {};
  // Where it is shifts the whole table, so the nearest end of what was measured will not do.
  const double reference = job.position_setting("reference").value_or(0.0);
  if (!job.position_setting("reference"))
    result.notes.push_back(controllers::remark(job, "fanuc.reference-at-zero"));
  const auto grid = grid_of(job, input, choices, reference);
  if (!grid) return tl::unexpected<Error>(grid.error());
  Table table = table_of(job, *grid, choices, directions, reference);
  if (auto placed = numbering.place(job, table, *grid, choices); !placed) return placed;
  if (auto fits = check_range(job, table, *grid, choices); !fits) return fits;
  const auto warning = controllers::warnings(job, result);
  Artifact load{"fanuc-" + job.stem + ".prm", parameter_text(job, table)};
  Artifact text{"fanuc-" + job.stem + ".txt", words(job, table, choices, warning)};
  const auto correction = fanuc::load(load.bytes, consumer_of(job, table, choices));
  if (!correction)
    return fail("axis " + job.axis +
                ": the table written cannot be read back: " + correction.error().message);
  if (!directions && job.curve.bidirectional()) controllers::doubt_backlash(job, result);
  controllers::predict(job, *correction, result);
  result.artifacts.push_back(std::move(load));
  result.artifacts.push_back(std::move(text));
  return {};
}

void notes(const Choices& choices, OutputResult& result) {
  result.notes.push_back({"fanuc.sign-inferred"});
  result.notes.push_back({"fanuc.form-unsure"});
  if (choices.directions) result.notes.push_back({"fanuc.negative-unsure"});
}

Choices choices_of(const Settings& o) {
  Choices c{};
  c.directions = o.flag("directions");
  c.extended = o.flag("extended");
  c.returns_towards_plus = o.text("reference_return", "+") != "-";
  c.max_points = static_cast<std::size_t>(o.integer("max_points", 128));
  c.magnification = o.integer("magnification", 1);
  c.reference_number = o.integer("reference_number", -1);
  c.negative_numbers = o.integer("negative_numbers", 3000);
  c.last_number = o.integer("last_number", 1023);
  c.detection_um = o.number("detection_unit_um", 1.0);
  c.detection_arcsec = o.number("detection_unit_arcsec", 3.6);
  c.interval_um = o.number("interval_unit_um", 1.0);
  c.interval_arcsec = o.number("interval_unit_arcsec", 3.6);
  return c;
}

Expected<OutputResult> write(const OutputInput& input) {
  OutputResult result;
  const Choices choices = choices_of(input.options);
  const auto jobs = controllers::axis_jobs(
      input, {"number:", "reference_number:", "step", "reference", "backlash"}, result);
  if (!jobs) return tl::unexpected<Error>(jobs.error());
  Numbering numbering;
  for (const AxisJob& job : *jobs)
    if (auto done = write_axis(job, input, choices, numbering, result); !done)
      return tl::unexpected<Error>(done.error());
  if (!result.artifacts.empty()) notes(choices, result);
  return result;
}

Option whole(std::string name, std::int64_t otherwise, std::string help, double least,
             double most) {
  return {std::move(name), otherwise, "", std::move(help), {}, least, most};
}

Option unit(std::string name, double otherwise, std::string in, std::string help) {
  return {std::move(name), otherwise, std::move(in), std::move(help), {}, 1e-4, 1e4};
}

std::vector<Option> options() {
  std::vector<Option> list = controllers::step_options();
  list.push_back(
      {"directions", false, "",
       "Numbers for each direction (3605#0, 3626, 3627) in place of mean and backlash."});
  list.push_back({"extended", false, "", "The control takes -128..127 in a number, not -7..7."});
  list.push_back({"reference_return",
                  std::string("+"),
                  "",
                  "Direction in which the axis returns to reference.",
                  {"+", "-"}});
  list.push_back(whole("max_points", 128, "Numbers of one axis.", 3, 1024));
  list.push_back(whole("magnification", 1, "Parameter 3623.", 1, most_magnification));
  list.push_back(whole("reference_number", -1,
                       "Parameter 3620; -1: the next free numbers are taken.", -1, 1535));
  list.push_back(whole("negative_numbers", 3000,
                       "Distance from a number of the plus direction to that of minus.", 1, 5000));
  list.push_back(whole("last_number", 1023, "Largest number of the control.", 3, 9999));
  list.push_back(unit("detection_unit_um", 1.0, "um", "Detection unit of linear axes."));
  list.push_back(unit("detection_unit_arcsec", 3.6, "arcsec", "Detection unit of rotary axes."));
  list.push_back(unit("interval_unit_um", 1.0, "um", "Unit of 3624 on linear axes."));
  list.push_back(
      unit("interval_unit_arcsec", 3.6, "arcsec", "Unit of 3624 and 3625 on rotary axes."));
  list.push_back(controllers::axes_option(
      "number (controlled axis), reference_number (3620), step_mm, reference_mm, backlash_mm (1851 "
      "while measured), and the same with _deg"));
  return list;
}

}  // namespace
}  // namespace nonio

NONIO_PLUGIN(registry) {
  nonio::Output output;
  output.info = {"fanuc", "1.0.0",
                 "Stored pitch error compensation (3620-3627) and backlash (1851) for FANUC.",
                 nonio::options()};
  output.stage = nonio::Output::Stage::table;
  output.applies = nonio::controllers::has_tables;
  output.write = nonio::write;
  registry.add(std::move(output));
}
