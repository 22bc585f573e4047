// SPDX-License-Identifier: Apache-2.0
#include "nonio/controllers/cross_job.h"

#include <algorithm>
#include <cmath>

#include "nonio/controllers/replay.h"
#include "nonio/controllers/size.h"
#include "nonio/controllers/text.h"
#include "nonio/math/compensated.h"
#include "resolution.h"

namespace nonio::controllers {

namespace {

/// A straightness and its squareness; the error is the series plus `sign` times the squareness
/// times the distance. C0Y rotates +Y towards -X, B0Z rotates +Z towards +X, A0Z rotates +Z towards
/// -Y (ISO 230-1).
struct Part {
  const char *series, *squareness;
  double sign;
};
constexpr std::array<Part, 6> parts{{{"EYX", nullptr, 0.0},
                                     {"EZX", nullptr, 0.0},
                                     {"EXY", "C0Y", -1.0},
                                     {"EZY", nullptr, 0.0},
                                     {"EXZ", "B0Z", 1.0},
                                     {"EYZ", "A0Z", -1.0}}};

const Series* series_of(const Evaluation& e, std::string_view name) {
  for (const Series& s : e.series)
    if (s.name == name) return &s;
  return nullptr;
}

const Value* value_of(const Evaluation& e, std::string_view name) {
  for (const Value& v : e.values)
    if (v.name == name) return &v;
  return nullptr;
}

std::optional<CrossCurve> curve_of(const Evaluation& e, const Part& part, const std::string& output,
                                   const char* ending = "") {
  const Series* s = series_of(e, std::string(part.series) + ending);
  const Value* square = part.squareness == nullptr ? nullptr : value_of(e, part.squareness);
  if (s == nullptr || s->position.size() < 2 || (part.squareness != nullptr && square == nullptr))
    return std::nullopt;
  CrossCurve curve{s->over, output, s->position, s->value};
  for (std::size_t i = 0; square != nullptr && i < curve.value.size(); ++i)
    curve.value[i] += part.sign * square->value * (s->position[i] - s->position.front());
  return curve;
}

void make_zero(CrossCurve& curve, const NumberTables& settings) {
  curve.reference = std::clamp(0.0, curve.position.front(), curve.position.back());
  if (const auto axis = settings.find(curve.input); axis != settings.end())
    if (const auto said = axis->second.find("reference_mm"); said != axis->second.end()) {
      curve.reference = said->second / 1e3;
      curve.told = true;
    }
  const double zero = math::ErrorCurve::at(curve.position, curve.value, curve.reference);
  for (double& v : curve.value) v -= zero;
}

TableSize size_of_curve(const CrossCurve& curve) {
  TableSize size;
  size.take(curve.position, curve.value);
  return size;
}

/// Size of the entries that the control reads; that of the curve where no table is given.
TableSize size_in(const std::vector<LoadedTable>& tables, const CrossCurve& curve) {
  for (const LoadedTable& t : tables) {
    if (t.output != curve.output || t.input != std::vector{curve.input}) continue;
    TableSize size;
    size.take(t.position.front(), t.plus);
    return size;
  }
  return size_of_curve(curve);
}

NumberTables known_settings(const ControllerInput& in) {
  return settings_of_axes(in.options).value_or(NumberTables{});
}

const Measurement* measurement_named(const Campaign& campaign, std::string_view id) {
  for (const Measurement& m : campaign.measurements)
    if (m.id == id) return &m;
  return nullptr;
}

void put_readings(ReadLine& line, const ControllerInput& in, const Measurement& m) {
  const auto index = static_cast<std::size_t>(&m - in.campaign.measurements.data());
  if (index >= in.observations.size() || in.observations[index].axes.empty()) return;
  const Observations& readings = in.observations[index];
  const auto& approach = readings.axes.front().approach;
  std::vector<int> ways;
  for (const int way : {1, -1})
    if (std::find(approach.begin(), approach.end(), way) != approach.end()) ways.push_back(way);
  if (!ways.empty()) line.ways = ways;
  line.U = math::compensated_uncertainty_along(in.campaign, m, readings);
}

bool any_active(const ControllerInput& in, const ReadLine& line, const Measurement& m) {
  return m.compensation != "off" &&
         std::any_of(line.sense.begin(), line.sense.end(), [&](const auto& of) {
           const Axis* axis = in.campaign.machine.axis(of.first);
           return axis != nullptr && axis->active_table && !axis->active_table->empty();
         });
}

/// Replaces the deviations by those of the readings, from which the host has removed the tables
/// that were active. Without a reading at a stop, the line stays as it is.
void take_without_tables(ReadLine& line, const ControllerInput& in, const Measurement& m) {
  constexpr double same_place = 1e-6;  // m
  const auto index = static_cast<std::size_t>(&m - in.campaign.measurements.data());
  const auto& all = in.measured != nullptr ? *in.measured : in.observations;
  if (index >= all.size() || all[index].axes.empty()) return;
  const Observations& o = all[index];
  std::vector<double> raw;
  for (const auto& at : line.at) {
    double sum[2]{}, count[2]{};
    for (std::size_t i = 0; i < o.size(); ++i) {
      if (std::any_of(o.axes.begin(), o.axes.end(), [&](const auto& axis) {
            return std::fabs(axis.position[i] - at.at(axis.axis)) > same_place;
          }))
        continue;
      const bool minus = !o.axes.front().approach.empty() && o.axes.front().approach[i] < 0;
      sum[minus] += o.deviation[i], count[minus] += 1.0;
    }
    if (count[0] + count[1] == 0.0) return;
    double mean = 0.0;
    for (const int way : {0, 1})
      if (count[way] > 0.0)
        mean +=
            sum[way] / count[way] / ((count[0] > 0.0 ? 1.0 : 0.0) + (count[1] > 0.0 ? 1.0 : 0.0));
    raw.push_back(mean);
  }
  line.measured = std::exchange(line.deviation, std::move(raw));
}

const Measurement* diagonal_over(const ControllerInput& in, const Results::Analysed& a,
                                 const Series& x, const Series& y, bool rising) {
  std::vector<std::string> ids = a.evaluation.uses;
  ids.push_back(a.measurement);
  constexpr double same_place = 1e-6;
  const auto spans = [&](double from, double to, const Series& s) {
    return std::fabs(std::min(from, to) - s.position.front()) < same_place &&
           std::fabs(std::max(from, to) - s.position.back()) < same_place;
  };
  for (const std::string& id : ids) {
    const Measurement* m = measurement_named(in.campaign, id);
    if (m == nullptr || m->kind != "diagonal" || !m->from.contains(x.over) ||
        !m->from.contains(y.over) || !m->to.contains(x.over) || !m->to.contains(y.over))
      continue;
    const double x0 = m->from.at(x.over), x1 = m->to.at(x.over), y0 = m->from.at(y.over),
                 y1 = m->to.at(y.over);
    if (spans(x0, x1, x) && spans(y0, y1, y) && ((x1 - x0) * (y1 - y0) > 0.0) == rising) return m;
  }
  return nullptr;
}

std::optional<CrossJob> of_diagonals(const ControllerInput& in, const Results::Analysed& a) {
  const Evaluation& e = a.evaluation;
  const bool even_only = series_of(e, "q_odd") != nullptr;
  // A repeated measurement of two diagonals after compensation shows the remaining errors; a table
  // from it would wrongly replace the tables.
  if (even_only && std::any_of(e.findings.begin(), e.findings.end(), [](const Finding& found) {
        return found.id == "diagonals.remeasured";
      }))
    return std::nullopt;
  const char* const ending = even_only ? "_even" : "";
  const Series *f = series_of(e, std::string("EYX") + ending),
               *g = series_of(e, std::string("EXY") + ending);
  const auto *D1 = e.points.column("D1"), *D2 = e.points.column("D2");
  if (f == nullptr || g == nullptr || D1 == nullptr || D2 == nullptr) return std::nullopt;
  const auto along_x = curve_of(e, parts[0], g->over, ending),
             along_y = curve_of(e, parts[2], f->over, ending);
  if (!along_x || !along_y) return std::nullopt;
  CrossJob job{a.measurement, e.uses, {*along_x, *along_y}, {}};
  if (const Series* odd = series_of(e, "q_odd")) {
    job.odd_left = 0.0;
    for (const double q : odd->value) job.odd_left = std::max(*job.odd_left, std::fabs(q));
  }
  const auto &x = f->position, &y = g->position;
  const double Lx = x.back() - x.front(), Ly = y.back() - y.front(), L = std::hypot(Lx, Ly);
  for (const bool rising : {true, false}) {
    ReadLine line{rising ? "D1" : "D2",
                  {{f->over, Lx / L}, {g->over, (rising ? Ly : -Ly) / L}},
                  {},
                  (rising ? D1 : D2)->values};
    for (std::size_t i = 0; i < x.size(); ++i)
      line.at.push_back({{f->over, x[i]}, {g->over, y[rising ? i : y.size() - 1 - i]}});
    if (const Measurement* m = diagonal_over(in, a, *f, *g, rising)) {
      put_readings(line, in, *m);
      if (any_active(in, line, *m)) take_without_tables(line, in, *m);
    }
    job.lines.push_back(std::move(line));
  }
  return job;
}

/// The points at which all axes have moved equally far, where a tilted mirror has no effect.
std::vector<ReadLine> body_diagonals(const Campaign& campaign, const Measurement& m,
                                     const Observations& o) {
  constexpr double same_part = 1e-6;
  std::vector<std::vector<char>> equal(o.lines.size(), std::vector<char>(o.size()));
  std::vector<ReadLine> lines;
  for (const Observations::Line& of : o.lines) {
    ReadLine line{of.name.substr(std::min(m.id.size() + 1, of.name.size())), {}, {{}}, {0.0}, {1}};
    for (std::size_t k = 0; k < o.axes.size(); ++k) {
      const auto from = m.from.find(o.axes[k].axis), to = m.to.find(o.axes[k].axis);
      if (k > 2 || from == m.from.end() || to == m.to.end()) return {};
      line.sense[from->first] = of.sense[k];
      const auto [low, high] = std::minmax(from->second, to->second);
      line.at.front()[from->first] = of.sense[k] > 0.0 ? low : high;
    }
    lines.push_back(std::move(line));
  }
  for (std::size_t i = 0; i < o.size(); ++i) {
    ReadLine& line = lines[o.line.empty() ? 0 : o.line[i]];
    std::map<std::string, double> at;
    std::vector<double> gone;
    for (const auto& axis : o.axes) {
      at[axis.axis] = axis.position[i];
      gone.push_back((axis.position[i] - line.at.front()[axis.axis]) /
                     (m.to.at(axis.axis) - m.from.at(axis.axis)));
    }
    const auto [least, most] = std::minmax_element(
        gone.begin(), gone.end(), [](double a, double b) { return std::fabs(a) < std::fabs(b); });
    if (std::fabs(*most) - std::fabs(*least) > same_part) continue;
    line.at.push_back(std::move(at));
    line.deviation.push_back(o.deviation[i]);
    equal[o.line.empty() ? 0 : o.line[i]][i] = 1;
  }
  for (std::size_t l = 0; l < lines.size(); ++l) {
    Observations readings = o;
    keep_rows(readings, equal[l]);
    Measurement along = m;
    for (const auto& [axis, sense] : lines[l].sense) {
      along.from[axis] = sense > 0.0 ? std::min(m.from.at(axis), m.to.at(axis))
                                     : std::max(m.from.at(axis), m.to.at(axis));
      along.to[axis] = m.from.at(axis) + m.to.at(axis) - along.from[axis];
    }
    lines[l].U = math::compensated_uncertainty_along(campaign, along, readings);
  }
  return lines;
}

std::optional<CrossJob> of_volume(const ControllerInput& in, const Results::Analysed& a,
                                  std::size_t index) {
  const Evaluation& e = a.evaluation;
  const Observations& o = in.observations[index];
  if (o.axes.size() != 3) return std::nullopt;
  CrossJob job{a.measurement, e.uses, {}, {}, true};
  for (const Part& part : parts)
    if (auto curve = curve_of(e, part, o.axes[static_cast<std::size_t>(part.series[1] - 'X')].axis))
      job.curves.push_back(std::move(*curve));
  if (job.curves.empty()) return std::nullopt;
  const Measurement& m = in.campaign.measurements[index];
  job.lines = body_diagonals(in.campaign, m, o);
  // The host has removed the tables that were active from the readings, not from the results.
  for (ReadLine& line : job.lines)
    if (const auto* read = e.points.column(line.name); read != nullptr && any_active(in, line, m))
      line.measured = read->values;
  return job;
}

}  // namespace

std::vector<std::string> CrossJob::moving() const {
  std::vector<std::string> names;
  for (const CrossCurve& c : curves) names.insert(names.end(), {c.input, c.output});
  return names;
}

std::string CrossJob::axes() const {
  std::vector<std::string> names;
  for (const CrossCurve& c : curves)
    for (const std::string& name : {c.input, c.side_of.empty() ? c.output : c.side_of})
      if (std::find(names.begin(), names.end(), name) == names.end()) names.push_back(name);
  std::sort(names.begin(), names.end());
  std::string out;
  for (const std::string& name : names) out += name;
  return out;
}

std::vector<std::string> CrossJob::outputs() const {
  std::vector<std::string> names;
  for (const CrossCurve& c : curves)
    if (std::find(names.begin(), names.end(), c.output) == names.end()) names.push_back(c.output);
  std::sort(names.begin(), names.end());
  return names;
}

namespace {

/// Adds the curves of the second gantry side according to `rule`. Returns false, with a finding, if
/// the effect of a table on that side is not known.
bool both_sides(CrossJob& job, SecondSide rule, const Campaign& campaign, OutputResult& result) {
  if (rule == SecondSide::moves_along) return true;
  std::vector<CrossCurve> all;
  for (CrossCurve& curve : job.curves) {
    all.push_back(curve);
    const Axis* axis = campaign.machine.axis(curve.output);
    if (axis == nullptr || axis->slave.empty()) continue;
    if (rule == SecondSide::not_known) {
      refuse_second_side(*axis, job.measurement, result);
      return false;
    }
    all.push_back(curve);
    all.back().output = axis->slave;
    all.back().side_of = axis->name;
  }
  job.curves = std::move(all);
  return true;
}

bool is_by_slave_zero(const ControllerInput& in, bool volume) {
  return !volume && in.options.has("squareness") && in.options.text("squareness") == "slave-zero";
}

std::string shift_words(const SlaveZero& z) {
  return (z.shift < 0.0 ? "" : "+") + decimal(z.shift * 1e3, 4) + " mm";
}

std::vector<std::string> drawing(const SlaveZero& z) {
  const bool plus = z.shift > 0.0;
  const auto place = [&](const std::string& side, double at) {
    return plain(side) + ", at " + plain(z.along) + " " + decimal(at * 1e3, 1);
  };
  std::string one = place(z.axis, z.at_axis), other = place(z.slave, z.at_slave);
  const std::size_t width = std::max(one.size(), other.size());
  one.resize(width, ' '), other.resize(width, ' ');
  std::vector<std::string> lines{
      "  " + other + (plus ? "     |==>|   " : " |<==|       ") + "zero moves by " + shift_words(z),
      "  " + std::string(width, ' ') + (plus ? "     |  /    " : "  \\  |       ") +
          "the beam turns",
      "  " + one + "     |       zero stays"};
  if (z.at_slave < z.at_axis) std::swap(lines.front(), lines.back());
  lines.push_back("  " + std::string(width, ' ') + "  ----------->  +" + plain(z.axis));
  return lines;
}

bool all_active_stated(const ControllerInput& in, const CrossJob& job, OutputResult& result) {
  bool all = true;
  for (const std::string& axis : job.moving())
    all = states_active(in, axis, job.measurement, true, result) && all;
  return all;
}

}  // namespace

void refuse_second_side(const Axis& axis, const std::string& measurement, OutputResult& result) {
  result.findings.push_back(
      {"table.gantry-second-side",
       true,
       {},
       {{"axis", axis.name}, {"slave", axis.slave}},
       measurement,
       "The maker does not document what such a table does to the second side of a "
       "gantry: ask the maker, or shift the zero of " +
           axis.slave + " by slave_shift, which takes the squareness away."});
}

std::vector<CrossJob> cross_jobs(const ControllerInput& in, SecondSide rule, OutputResult& result) {
  std::vector<CrossJob> jobs;
  const auto settings = known_settings(in);
  const auto& measurements = in.campaign.measurements;
  for (const Results::Analysed& a : in.results.analyses) {
    const auto of = std::find_if(measurements.begin(), measurements.end(),
                                 [&](const Measurement& m) { return m.id == a.measurement; });
    const auto index = static_cast<std::size_t>(of - measurements.begin());
    const bool volume =
        of != measurements.end() && of->kind == "step-diagonal" && index < in.observations.size();
    if (auto job = volume ? of_volume(in, a, index) : of_diagonals(in, a)) {
      if (is_by_slave_zero(in, volume)) {
        const Value* square = value_of(a.evaluation, "C0Y");
        if (square == nullptr || !shift_slave(in, *job, square->value, settings)) {
          result.findings.push_back(
              {"table.slave-zero-unknown", true, {}, {}, job->measurement, {}});
          continue;
        }
      } else if (!volume && rule == SecondSide::own_table) {
        turn_to_reference(in, *job, settings);
      }
      for (CrossCurve& curve : job->curves) make_zero(curve, settings);
      if (any_unresolved(in, *job, result)) continue;
      if (both_sides(*job, rule, in.campaign, result) && all_active_stated(in, *job, result))
        jobs.push_back(std::move(*job));
    }
  }
  return jobs;
}

bool oversized(const CrossJob& job, const ControllerInput& in, OutputResult& result) {
  const auto settings = known_settings(in);
  bool beyond = false;
  for (const CrossCurve& curve : job.curves) {
    const auto axis = settings.find(curve.output);
    if (axis == settings.end()) continue;
    const TableSize size = size_of_curve(curve);
    const auto hold = [&](const char* key, Quantity q, double found, double at) {
      const auto said = axis->second.find(key);
      if (said == axis->second.end()) return;
      const double limit = said->second / unit_of(q).per_si;
      if (found <= limit * (1.0 + 1e-9)) return;
      beyond = true;
      result.findings.push_back(
          {"table.refused-cross",
           true,
           {{"found", found, q}, {"limit", limit, q}, {"at", at, Quantity::length}},
           {{"axis", curve.output}, {"input", curve.input}, {"key", key}},
           job.measurement,
           "The machine's maker allows no more (" + std::string(key) +
               "): repair or adjust the axis first; a table can only compensate the residual "
               "error."});
    };
    hold("largest_um", Quantity::deviation, size.largest, size.largest_at);
    hold("slope_um_per_m", Quantity::deviation_per_length, size.slope, size.slope_from);
  }
  return beyond;
}

std::string cross_words(const CrossCurve& curve, double step, const std::vector<double>& at) {
  std::vector<double> entries;
  for (const double x : at) entries.push_back(math::ErrorCurve::at(curve.position, curve.value, x));
  TableSize size;
  size.take(at, math::rounded(entries, step));
  return plain(curve.output) + " over " + plain(curve.input) + ": zero at " +
         decimal(curve.reference * 1e3, 4) + " mm of " + plain(curve.input) +
         (curve.told ? "" : ", taken as reference point") + "; largest entry " +
         decimal(size.largest * 1e6, 3) + " um at " + decimal(size.largest_at * 1e3, 4) +
         " mm, steepest " + decimal(size.slope * 1e6, 3) + " um/m";
}

std::vector<std::string> set_words(const CrossJob& job) {
  std::vector<std::string> lines;
  if (job.odd_left)
    lines.push_back(
        "NOT in these tables: the odd part of both straightnesses, which two diagonals do not "
        "separate; "
        "q_odd is up to " +
        decimal(*job.odd_left * 1e6, 3) + " um and stays on both diagonals");
  if (job.slave_zero) {
    const SlaveZero& z = *job.slave_zero;
    lines.push_back("the squareness is NOT in these tables: shift the zero of " + plain(z.slave) +
                    " by " + shift_words(z) + ", so that at the same command it is that far " +
                    (z.shift < 0.0 ? "towards minus" : "towards plus") + " of where it is now:");
    for (std::string& line : drawing(z)) lines.push_back(std::move(line));
  }
  if (job.yaw_at_reference != 0.0)
    lines.push_back(
        "the squareness is that of the beam where the pitch tables of both sides are zero: C0Y and "
        "a yaw of " +
        decimal(job.yaw_at_reference * 1e6, 3) + " urad; load all of these tables or none");
  return lines;
}

void note_cross(const CrossJob& job, const std::vector<LoadedTable>& tables, OutputResult& result) {
  for (const CrossCurve& curve : job.curves) {
    const TableSize size = size_in(tables, curve);
    result.notes.push_back({curve.told ? "table.cross-zero-at" : "table.cross-zero-taken",
                            {{"reference", curve.reference, Quantity::length},
                             {"largest", size.largest, Quantity::deviation},
                             {"slope", size.slope, Quantity::deviation_per_length}},
                            {{"axis", curve.output}, {"input", curve.input}}});
  }
  if (job.slave_zero)
    result.notes.push_back({"table.slave-zero",
                            {{"shift", job.slave_zero->shift, Quantity::deviation}},
                            {{"slave", job.slave_zero->slave}, {"axis", job.slave_zero->axis}},
                            job.measurement});
  if (job.yaw_at_reference != 0.0)
    result.notes.push_back({"table.cross-yaw-at-reference",
                            {{"yaw", job.yaw_at_reference, Quantity::small_angle}},
                            {},
                            job.measurement});
  if (job.odd_left)
    result.findings.push_back(
        {"table.cross-even-only",
         false,
         {{"q_odd", *job.odd_left, Quantity::deviation}},
         {{"axes", job.axes()}},
         job.measurement,
         "Measure a third diagonal, or one straightness directly, and write the tables again."});
}

Option squareness_option() {
  return one_of({"table", "slave-zero"},
                {"squareness", std::string("table"), "",
                 "Where the squareness of a gantry goes: into the cross table, or into a shift of "
                 "the zero of its second side, which the file states."});
}

bool together(const CrossJob& set, const AxisJob& job, const Campaign& campaign) {
  if (set.measurement == job.measurement) return true;
  bool names_one = false;
  for (const std::string& id : set.uses) {
    if (id == job.measurement) return true;
    const Measurement* m = measurement_named(campaign, id);
    names_one = names_one || (m != nullptr && m->kind == "axis" &&
                              control_axis(campaign.machine, *m) == job.axis);
  }
  if (names_one) return false;
  if (!set.volume) return true;
  const Measurement *one = measurement_named(campaign, set.measurement),
                    *other = measurement_named(campaign, job.measurement);
  return one != nullptr && other != nullptr && state_of(*one) == state_of(*other);
}

Expected<void> fits(const CrossJob& job, const Settings& options) {
  const auto most = static_cast<std::size_t>(options.integer("max_points", 1000000));
  for (const CrossCurve& curve : job.curves)
    if (curve.position.size() > most)
      return fail("diagonals of " + job.measurement + ": " + std::to_string(curve.position.size()) +
                  " points, the control takes " + std::to_string(most) + " (max_points)");
  return {};
}

}  // namespace nonio::controllers
