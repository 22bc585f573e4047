// SPDX-License-Identifier: Apache-2.0
#include "nonio/controllers/kit.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <set>

#include "nonio/controllers/size.h"
#include "nonio/sdk/format.h"

namespace nonio::controllers {
namespace {

const math::ErrorCurve& compensated_curve(const AxisJob& job, const Writer& w) {
  return w.turn_end == TurnEnd::repeats ? job.table_curve() : job.curve;
}

using Entry = ControlTable::Entry;

int decimals_of(double step, double unit) {
  return std::max(0, static_cast<int>(std::ceil(-std::log10(step / unit) - 1e-9)));
}

std::string in_steps(double si, double step, double unit) {
  const int decimals = decimals_of(step, unit);
  return decimals == 0 ? fixed_text(si / unit, 0) : decimal(si * (1.0 / unit), decimals);
}

bool anchored(const ControlTable& t) {
  return t.entry == Entry::increment || t.zero == ControlTable::Zero::first;
}

math::GridRule rule_of(const AxisJob& job, const ControllerInput& input, const Writer& w,
                       const ControlTable& t, double reference) {
  math::GridRule rule;
  rule.unit = t.position_step.of(job.rotary);
  rule.most = t.points == 0 ? 100000 : t.points;
  rule.step = w.fixed_step > 0.0 ? w.fixed_step : wished_step(job, input.options);
  rule.rotary = job.rotary;
  rule.axis = job.axis;
  rule.turn = job.turn.has_value() && w.turn_end == TurnEnd::repeats && !w.power_of_two;
  if (!rule.turn) rule.first = job.position_setting("first");
  rule.power_of_two = w.power_of_two;
  if (anchored(t)) {
    rule.anchor = reference;
    if (t.entry == Entry::increment) rule.most = std::max<std::size_t>(rule.most, 3) - 1;
  }
  return rule;
}

/// Increments must exist on both sides of the reference, even if it is at an end of the axis.
void surround(math::Grid& grid, double reference) {
  if (reference - grid.first < grid.step / 2.0) {
    grid.first -= grid.step;
    ++grid.points;
  }
  if (grid.last() - reference < grid.step / 2.0) ++grid.points;
}

std::vector<double> wanted(const AxisJob& job, const Writer& w) {
  if (w.wanted) return w.wanted(job);
  if (w.turn_end == TurnEnd::repeats) return job.table_curve().position;
  std::vector<double> rows = job.curve.position;
  if (job.turn && rows.back() < rows.front() + full_turn - 1e-9)
    rows.push_back(rows.front() + full_turn);
  return rows;
}

std::vector<double> listed(const AxisJob& job, const Writer& w, const ControlTable& t) {
  const double unit = t.position_unit.of(job.rotary);
  const int digits = decimals_of(t.position_step.of(job.rotary), unit);
  std::vector<double> rows;
  for (const double x : wanted(job, w))
    if (rows.empty() || fixed_text(x / unit, digits) != fixed_text(rows.back() / unit, digits))
      rows.push_back(x);
  return rows;
}

Expected<void> place_points(Sheet& s, const Writer& w) {
  const ControlTable& t = s.table;
  if (t.grid == ControlTable::Grid::listed && wished_step(s.job, s.input.options) == 0.0) {
    s.position = listed(s.job, w, t);
    if (t.points == 0 || s.position.size() <= t.points) return {};
  }
  if (w.fixed_step > 0.0 && wished_step(s.job, s.input.options) != 0.0)
    return fail("axis " + s.job.axis + ": this control has its points every " +
                with_unit(s.job, w.fixed_step, 4) + ", step_mm has no effect");
  const math::GridRule rule = rule_of(s.job, s.input, w, t, s.reference);
  const std::vector<double> targets = wanted(s.job, w);
  NONIO_TRY(s.grid, math::choose_grid(targets, rule));
  if (t.entry == Entry::increment && !rule.turn) surround(s.grid, s.reference);
  constexpr double rounding = 1e-9;
  if (w.within_turn && s.job.rotary &&
      (s.grid.first < -rounding || targets.back() > full_turn + rounding))
    return fail("axis " + s.job.axis +
                ": this control uses entries of rotary axes from 0 to 360 deg only, and these "
                "readings are from " +
                with_unit(s.job, targets.front(), 4) + " to " +
                with_unit(s.job, targets.back(), 4) +
                ": measure, or state, positions from 0 to 360 deg");
  s.position.clear();
  for (std::size_t i = 0; i < s.grid.points; ++i) s.position.push_back(s.grid.position(i));
  return {};
}

/// If the table of a revolution is not repeated, the gap after its last point is interpolated to
/// the first value.
double value_at(const AxisJob& job, const Writer& w, const std::vector<double>& values, double x) {
  const auto& position = compensated_curve(job, w).position;
  const double open = position.front() + full_turn - position.back();
  if (w.turn_end == TurnEnd::repeats || !job.turn || x <= position.back() || open < 1e-9)
    return math::ErrorCurve::at(position, values, x);
  const double part = std::min(1.0, (x - position.back()) / open);
  return values.back() + part * (values.front() - values.back());
}

/// The error at the reference, which is subtracted because the zero of the instrument is arbitrary.
double zero_of(const Sheet& s, const Writer& w, const math::ErrorCurve& curve) {
  const auto& values = !s.directions || w.zero_of == ZeroOf::mean ? curve.mean
                       : w.zero_of == ZeroOf::plus                ? curve.plus
                                                                  : curve.minus;
  return math::ErrorCurve::at(curve.position, values, s.reference);
}

void fill(Sheet& s, const Writer& w) {
  const math::ErrorCurve& curve = compensated_curve(s.job, w);
  const double zero = zero_of(s, w, curve);
  const double sign = s.table.sign == ControlTable::Sign::error ? 1.0 : -1.0;
  const bool dead = s.directions && w.directions != Directions::by_option;
  const auto entries = [&](const std::vector<double>& values, int direction) {
    const double half = dead ? direction * s.job.present_backlash() / 2.0 : 0.0;
    std::vector<double> out;
    for (const double x : s.position) {
      const double v = sign * (value_at(s.job, w, values, x) - half - zero);
      out.push_back((s.table.entry == Entry::position ? x + v : v) + 0.0);
    }
    return out;
  };
  const auto& up = curve.plus.empty() ? curve.minus : curve.plus;
  const auto& down = curve.minus.empty() ? curve.plus : curve.minus;
  s.plus = entries(s.directions ? up : curve.mean, +1);
  if (s.directions) s.minus = entries(down, -1);
}

std::vector<std::int64_t> steps_of(const std::vector<double>& values, double step, Entry entry) {
  const auto absolute = math::quantised(values, step);
  return entry == Entry::increment ? math::increments(absolute) : absolute;
}

struct Outside {
  std::int64_t largest = 0;
  std::size_t where = 0;
};

Outside outside(const Sheet& s, double coarser) {
  Outside out;
  if (!s.table.increment) return out;
  for (const auto* values : {&s.plus, &s.minus}) {
    const auto all = steps_of(*values, s.value_step() * coarser, s.table.entry);
    for (std::size_t i = 0; i < all.size(); ++i)
      if ((all[i] < s.table.increment->first || all[i] > s.table.increment->second) &&
          std::abs(all[i]) > std::abs(out.largest))
        out = {all[i], i};
  }
  return out;
}

/// An option value is suggested only if it is sufficient.
std::string advice(const Sheet& s, const Writer::Coarser& c) {
  const std::string smaller = s.job.rotary ? "step_deg" : "step_mm";
  if (c.option.empty()) return "set a smaller " + smaller;
  for (std::int64_t k = c.now + 1; k <= c.most; ++k)
    if (outside(s, static_cast<double>(k) / static_cast<double>(c.now)).largest == 0)
      return "set " + c.option + " = " + std::to_string(k) + " or a smaller " + smaller + c.or_else;
  return c.option + " = " + std::to_string(c.most) +
         ", the largest, is not enough either: repair the axis or measure it again" + c.or_else;
}

Expected<void> check_range(const Sheet& s, const Writer& w) {
  const ControlTable& t = s.table;
  const auto& job = s.job;
  if (const Outside out = outside(s, 1.0); out.largest != 0)
    return fail("axis " + job.axis + ": the interval from " +
                with_unit(job, s.position[out.where], 4) + " on would need an increment of " +
                std::to_string(out.largest) + ", the control takes " +
                std::to_string(t.increment->first) + ".." + std::to_string(t.increment->second) +
                ": " + advice(s, w.coarser));
  for (const auto* values : {&s.plus_steps, &s.minus_steps})
    for (const std::int64_t v : *values)
      if (const double size = std::fabs(static_cast<double>(v)) * s.value_step() / s.value_unit();
          t.entry == Entry::absolute && t.largest > 0.0 && size > t.largest)
        return fail("axis " + job.axis + ": an entry would be " + short_text(size, 6) +
                    ", the control takes " + short_text(t.largest, 6) +
                    ": repair the axis or measure it again");
  return {};
}

/// Called before the points are placed. Increments are relative to the reference, so it cannot be
/// the nearest end of the measured range.
Expected<void> set_reference(Sheet& s, OutputResult& result) {
  const auto told = s.job.position_setting("reference");
  if (!anchored(s.table)) {
    s.reference = told.value_or(0.0);
    return {};
  }
  if (s.job.turn && told.value_or(0.0) != 0.0)
    return wrong_axes("axis " + s.job.axis +
                          ": the table of a whole turn begins at the reference position of the "
                          "axis, which must be 0 deg: measure from there, or state the positions "
                          "of the readings from there; reference_deg is " +
                          with_unit(s.job, *told, 4),
                      s.job.axis + ".reference_deg");
  if (s.table.zero == ControlTable::Zero::first && told.value_or(0.0) != 0.0)
    return wrong_axes(
        "axis " + s.job.axis +
            ": the table of this control starts at the zero of the axis, where the entry "
            "is 0: reference_" +
            std::string(s.job.unit()) + " must be 0, found " + with_unit(s.job, *told, 4),
        s.job.axis + ".reference_" + std::string(s.job.unit()));
  s.reference = told.value_or(0.0);
  if (!told) result.notes.push_back(remark(s.job, "table.reference-at-zero"));
  return {};
}

Expected<Sheet> sheet_of(const AxisJob& job, const ControlTable& table,
                         const ControllerInput& input, const Writer& w, bool directions,
                         OutputResult& result) {
  Sheet s{.job = job,
          .table = table,
          .input = input,
          .directions = directions,
          .position = {},
          .plus = {},
          .minus = {},
          .plus_steps = {},
          .minus_steps = {},
          .holds_documented = w.holds_documented,
          .repeats = w.turn_end == TurnEnd::repeats};
  if (auto ok = set_reference(s, result); !ok) return tl::unexpected<Error>(ok.error());
  if (auto placed = place_points(s, w); !placed) return tl::unexpected<Error>(placed.error());
  if (!anchored(table))
    s.reference = reference_position(job, s.position.front(), s.position.back());
  fill(s, w);
  s.plus_steps = steps_of(s.plus, s.value_step(), table.entry);
  s.minus_steps = steps_of(s.minus, s.value_step(), table.entry);
  if (auto fits = check_range(s, w); !fits) return tl::unexpected<Error>(fits.error());
  s.warning = warnings(job, result);
  return s;
}

void look_at_reversal(const AxisJob& job, const ControlTable& t, OutputResult& result) {
  if (!t.backlash.empty()) return doubt_backlash(job, result);
  Remark stays = remark(job, "table.reversal-stays");
  stays.evidence = {{"mean", job.mean_reversal(), deviation_of(job.rotary)}};
  result.notes.push_back(std::move(stays));
}

Expected<bool> write_axis(AxisJob& job, const ControllerInput& input, const Writer& w,
                          OutputResult& result) {
  const bool directions =
      w.directions == Directions::always_without_backlash ||
      (w.table.bidirectional && input.options.flag("directions") && job.curve.bidirectional());
  if (refused(job, directions ? Columns::both : Columns::mean, result)) return false;
  if (job.rotary && !w.table.rotary)
    return fail("axis " + job.axis + ": these tables are of linear axes only");
  NONIO_TRY(const auto table,
            w.of_axis ? w.of_axis(job, w.table) : Expected<ControlTable>(w.table));
  job.backlash_step = w.backlash_in_steps
                          ? table.value_step.of(job.rotary) / static_cast<double>(w.coarser.now)
                          : 1e-6 / job.per_si();
  NONIO_TRY(const auto sheet, sheet_of(job, table, input, w, directions, result));
  NONIO_TRY(auto files, w.files(sheet));
  const Campaign campaign = with_axes_of(input, {job});
  auto read = w.parse({files, campaign, input.options});
  std::optional<math::Correction> correction;
  if (read) correction = math::correction_of(*read, job.axis, job.present_backlash());
  if (!correction)
    return fail("axis " + job.axis + ": the table written cannot be read back: " +
                (read ? "it is of another axis" : read.error().message));
  const TableSize size = size_of(*read, job.axis, sheet.position);
  if (oversized(job, size, sheet.value_step(), result)) return false;
  if (!sheet.directions && job.curve.bidirectional()) look_at_reversal(job, table, result);
  predict(job, *correction, result);
  if (!anchored(table) || job.position_setting("reference"))
    note_zero(job, sheet.reference, result);
  note_size(job, size, result);
  job.loaded = std::move(*read);
  for (Artifact& f : files) result.artifacts.push_back(std::move(f));
  return true;
}

std::string other_side(const Machine& machine, const std::string& axis) {
  for (const Axis& a : machine.axes) {
    if (a.slave.empty()) continue;
    if (a.name == axis) return a.slave;
    if (a.slave == axis) return a.name;
  }
  return {};
}

/// A table for one gantry side only would rotate the beam, so it is replaced by a finding.
void withdraw_one_sided(std::vector<AxisJob>& jobs, std::vector<OutputResult>& of_jobs,
                        const Machine& machine) {
  std::set<std::string> written;
  for (const AxisJob& job : jobs)
    if (job.loaded) written.insert(job.axis);
  for (std::size_t i = 0; i < jobs.size(); ++i) {
    const std::string other = other_side(machine, jobs[i].axis);
    if (!jobs[i].loaded || other.empty() || written.contains(other)) continue;
    jobs[i].loaded.reset();
    of_jobs[i] = {};
    of_jobs[i].findings.push_back(
        {"table.gantry-one-side",
         true,
         {},
         {{"axis", jobs[i].axis}, {"other", other}},
         jobs[i].measurement,
         "Measure the line of " + other +
             " too, or remove what prevents its table: both sides get one, or none."});
  }
}

void append(OutputResult part, OutputResult& result) {
  const auto move_to = [](auto& from, auto& to) {
    to.insert(to.end(), std::make_move_iterator(from.begin()), std::make_move_iterator(from.end()));
  };
  move_to(part.artifacts, result.artifacts);
  move_to(part.predictions, result.predictions);
  move_to(part.findings, result.findings);
  move_to(part.notes, result.notes);
}

}  // namespace

std::string Sheet::at(std::size_t i) const {
  return in_steps(position[i], table.position_step.of(job.rotary), position_unit());
}

std::int64_t Sheet::minus_start() const {
  if (!directions || table.entry != Entry::increment) return 0;
  const auto at = [&](const std::vector<double>& values) {
    return math::quantised(std::vector{math::ErrorCurve::at(position, values, reference)},
                           value_step())
        .front();
  };
  return at(minus) - at(plus);
}

std::vector<double> Sheet::held(const std::vector<double>& entries) const {
  std::vector<double> c = math::rounded(entries, value_step());
  if (table.entry == Entry::position) {
    const auto points = math::rounded(position, table.position_step.of(job.rotary));
    for (std::size_t i = 0; i < c.size(); ++i) c[i] -= points[i];
  }
  // Only changes are in the file: both columns are 0 where that of plus is.
  const double zero =
      table.entry == Entry::increment && !c.empty()
          ? math::ErrorCurve::at(position, math::rounded(plus, value_step()), reference)
          : 0.0;
  for (double& v : c) v -= zero;
  return c;
}

std::vector<std::string> Sheet::zero_and_size() const {
  TableSize size;
  for (const auto* entries : {&plus, &minus}) size.take(position, held(*entries));
  return {"zero at " + with_unit(job, reference, 4) +
              (job.position_setting("reference") ? "" : ", taken as reference point"),
          outside_words(), size_words(job, size)};
}

std::string Sheet::outside_words() const {
  if (job.turn && repeats) return "the table repeats after each turn";
  return "below " + with_unit(job, position.front(), 4) + " and above " +
         with_unit(job, position.back(), 4) + " the value of that end holds" +
         (holds_documented ? "" : " (assumed: not documented)");
}

std::string Sheet::entry(double si) const { return in_steps(si, value_step(), value_unit()); }

std::vector<std::string> Sheet::words() const {
  std::vector<std::string> lines = warning;
  lines.insert(lines.end(), job.about.begin(), job.about.end());
  lines.push_back(table.sign == ControlTable::Sign::error
                      ? "sign: the measured deviation (actual - nominal) with its own sign"
                      : "sign: the opposite of the measured deviation (actual - nominal)");
  for (std::string& line : zero_and_size()) lines.push_back(std::move(line));
  lines.push_back(points_said + std::to_string(plus_steps.size()));
  const bool stays = table.backlash.empty() && !directions && job.curve.bidirectional();
  lines.push_back(stays ? "mean reversal B = " + deviation_words(job, job.mean_reversal()) +
                              ": it stays, the table is of the mean of both directions"
                        : reversal_words(job, columns()));
  if (!table.backlash.empty() && job.curve.bidirectional())
    lines.push_back(table.backlash + " = " + with_unit(job, backlash(), 6));
  return lines;
}

std::vector<Option> table_options(const ControlTable& t, std::string keys_of_axes,
                                  std::vector<Option> more) {
  std::vector<Option> list = step_options();
  if (t.bidirectional)
    list.push_back({"directions", false, "",
                    "A table for each direction of travel in place of mean and backlash."});
  if (t.points > 0)
    list.push_back(
        within(2.0, 100000.0,
               {"max_points", static_cast<std::int64_t>(t.points), "", "Points of one table."}));
  for (const ControlTable::Fact& f : t.facts)
    if (f.id == "sign" && f.confidence == ControlTable::Confidence::unsure)
      list.push_back(
          one_of({"", "error", "correction"},
                 {"sign", std::string(), "",
                  "What an entry is, as a sign probe showed it on the machine: the measured error, "
                  "or the correction; nothing is written before it is said."}));
  for (Option& o : more) list.push_back(std::move(o));
  list.push_back(axes_option(std::move(keys_of_axes)));
  return list;
}

Expected<ControlTable> chosen(ControlTable t, const Settings& options) {
  if (options.has("max_points")) t.points = static_cast<std::size_t>(options.integer("max_points"));
  if (!options.has("sign")) return t;
  const std::string sign = options.text("sign");
  if (sign.empty()) {
    Error unknown{"the maker does not state which sign " + t.name +
                  " has: find it out with a sign probe (nonio table probe --help), then set "
                  "sign = \"error\" or \"correction\""};
    unknown.key = "sign";
    return fail(std::move(unknown));
  }
  t.sign = sign == "error" ? ControlTable::Sign::error : ControlTable::Sign::correction;
  return t;
}

Campaign with_axes_of(const ControllerInput& input, const std::vector<AxisJob>& jobs) {
  Campaign campaign = input.campaign;
  auto& axes = campaign.machine.axes;
  for (const Axis& a : input.campaign.machine.axes)
    if (!a.slave.empty() && campaign.machine.axis(a.slave) == nullptr)
      axes.push_back({.name = a.slave, .rotary = a.rotary});
  for (const AxisJob& job : jobs) {
    const auto it =
        std::find_if(axes.begin(), axes.end(), [&](const Axis& a) { return a.name == job.axis; });
    if (it == axes.end())
      axes.push_back({.name = job.axis, .rotary = job.rotary});
    else
      it->rotary = job.rotary;
  }
  return campaign;
}

Expected<std::vector<AxisJob>> write_axes(const ControllerInput& input, const Writer& w,
                                          OutputResult& result) {
  auto jobs = axis_jobs(input, w.keys, result);
  if (!jobs) return jobs;
  std::vector<OutputResult> of_jobs;
  for (AxisJob& job : *jobs)
    if (auto done = write_axis(job, input, w, of_jobs.emplace_back()); !done)
      return tl::unexpected<Error>(done.error());
  withdraw_one_sided(*jobs, of_jobs, input.campaign.machine);
  for (OutputResult& part : of_jobs) append(std::move(part), result);
  return jobs;
}

Expected<OutputResult> write_tables(const ControllerInput& input, const Writer& w) {
  OutputResult result;
  if (auto jobs = write_axes(input, w, result); !jobs) return tl::unexpected<Error>(jobs.error());
  note_facts(w, result);
  return result;
}

void note_facts(const Writer& w, OutputResult& result) {
  if (result.artifacts.empty()) return;
  for (const ControlTable::Fact& f : w.table.facts)
    if (f.confidence == ControlTable::Confidence::inferred ||
        f.confidence == ControlTable::Confidence::unsure)
      result.notes.push_back({.id = w.name + "." + f.id, .english = f.description});
}

Expected<LoadedTable> loaded(const ControlTable& t, const RawTable& raw) {
  const bool rotary = raw.axis.rotary;
  const double position_unit = t.position_unit.of(rotary), unit = t.value_unit.of(rotary);
  LoadedTable out{.output = raw.axis.name,
                  .input = {raw.axis.name},
                  .position = {{}},
                  .plus = {},
                  .minus = {},
                  .outside = raw.outside,
                  .backlash = raw.backlash,
                  .rotary = rotary};
  for (const double x : raw.position) out.position[0].push_back(x * position_unit);
  const auto correction = [&](std::vector<double> entry, double start) {
    double sum = 0.0, zero = 0.0;
    for (std::size_t i = 0; i < entry.size(); ++i) {
      if (t.entry == Entry::increment) entry[i] = sum += entry[i];
      if (t.entry == Entry::increment && i == raw.reference) zero = entry[i];
      if (t.entry == Entry::position && i < raw.position.size()) entry[i] -= raw.position[i];
    }
    for (double& v : entry) v += start;
    for (double& v : entry)
      v = (t.sign == ControlTable::Sign::error ? zero - v : v - zero) * unit + 0.0;
    return entry;
  };
  if (t.zero == ControlTable::Zero::first && raw.reference != 0)
    return fail("axis " + raw.axis.name + ": the table is declared to be 0 at its first point, " +
                "found its zero at point " + std::to_string(raw.reference + 1));
  out.plus = correction(raw.plus, 0.0);
  out.minus = correction(raw.minus, t.entry == Entry::increment ? raw.minus_start : 0.0);
  if (auto ok = math::validate_table(out); !ok) return tl::unexpected<Error>(ok.error());
  return out;
}

Controller controller(Info info, const ControlTable& table,
                      Expected<OutputResult> (*write)(const ControllerInput&),
                      Expected<std::vector<LoadedTable>> (*parse)(const TableInput&),
                      Offered offered) {
  Controller out;
  out.info = std::move(info);
  out.info.opt_in = offered == Offered::by_name;
  out.table = table;
  out.applies = has_tables;
  out.write = write;
  out.parse = parse;
  return out;
}

}  // namespace nonio::controllers
