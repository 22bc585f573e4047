// SPDX-License-Identifier: Apache-2.0
#include "campaign/tables/table_check.h"

#include <algorithm>
#include <cmath>

#include "nonio/math/beam.h"
#include "nonio/math/compensated.h"
#include "nonio/math/distributions.h"
#include "nonio/math/loaded_table.h"
#include "nonio/sdk/format.h"
#include "platform/process/guarded.h"
#include "platform/storage/files.h"
#include "platform/storage/nearest.h"

namespace nonio::tables {
namespace {

using Tables = std::vector<LoadedTable>;

bool same_axes(const LoadedTable& a, const LoadedTable& b) {
  return a.output == b.output && a.input == b.input;
}

/// `dir`: direction of motion, +1 or -1.
double sum_at(const std::vector<const LoadedTable*>& tables, const std::vector<double>& x,
              int dir) {
  double sum = 0.0;
  for (const LoadedTable* t : tables) sum += math::added(*t, x, dir);
  return sum;
}

using Knots = std::vector<std::vector<double>>;  // m or rad, by input axis

void merge(Knots& knots, const std::vector<const LoadedTable*>& tables) {
  for (const LoadedTable* t : tables)
    for (std::size_t k = 0; k < knots.size(); ++k)
      knots[k].insert(knots[k].end(), t->position[k].begin(), t->position[k].end());
  for (auto& k : knots) {
    std::sort(k.begin(), k.end());
    k.erase(std::unique(k.begin(), k.end(), [](double a, double b) { return b - a < 1e-9; }),
            k.end());
  }
}

std::vector<std::vector<double>> points_of(const Knots& knots) {
  std::vector<std::vector<double>> points{{}};
  for (const auto& k : knots) {
    std::vector<std::vector<double>> next;
    for (const auto& p : points)
      for (const double x : k) {
        next.push_back(p);
        next.back().push_back(x);
      }
    points = std::move(next);
  }
  return points;
}

TableShape shape_of(const std::vector<const LoadedTable*>& tables) {
  TableShape s;
  Knots knots(tables.front()->input.size());
  merge(knots, tables);
  for (const LoadedTable* t : tables)
    if (t->backlash) s.backlash = t->backlash;
  const auto points = points_of(knots);
  for (const int dir : {1, -1})
    for (std::size_t k = 0, stride = points.size(); k < knots.size(); ++k) {
      stride /= knots[k].size();
      for (std::size_t i = 0; i < points.size(); ++i) {
        const double c = sum_at(tables, points[i], dir);
        s.largest = std::max(s.largest, std::fabs(c));
        if (i + stride >= points.size() || points[i + stride][k] <= points[i][k]) continue;
        const double step = std::fabs(sum_at(tables, points[i + stride], dir) - c);
        if (step > s.step) s.step = step, s.step_at = points[i].front();
        s.slope = std::max(s.slope, step / (points[i + stride][k] - points[i][k]));
      }
    }
  return s;
}

void compare(TableDifference& d, const std::vector<const LoadedTable*>& was,
             const std::vector<const LoadedTable*>& will) {
  Knots knots(d.input.size());
  merge(knots, was);
  merge(knots, will);
  double low = 0.0, high = 0.0;
  bool any = false;
  for (const auto& p : points_of(knots))
    for (const int dir : {1, -1}) {
      const double v = sum_at(will, p, dir) - sum_at(was, p, dir);
      low = any ? std::min(low, v) : v;
      high = any ? std::max(high, v) : v;
      any = true;
      if (std::fabs(v) > d.largest) d.largest = std::fabs(v), d.at = p.front();
    }
  d.range = high - low;
  if (!was.empty()) d.present = shape_of(was);
  if (!will.empty()) d.next = shape_of(will);
}

/// Returns the range (m or rad) that means at the targets exceed by scatter alone in 5 % of cases;
/// 0 without repeated readings. The factor is from a simulation with 10 to 200 means.
double range_of_scatter(const math::AxisTest& test) {
  double squares = 0.0, n = 0.0, means = 0.0;
  for (std::size_t i = 0; i < test.targets.size(); ++i)
    for (const auto& readings : {test.plus(i), test.minus(i)}) {
      if (readings.empty()) continue;
      const std::vector<double> values = math::deviations(readings);
      double mean = 0.0;
      for (const double v : values) mean += v / static_cast<double>(values.size());
      for (const double v : values) squares += (v - mean) * (v - mean);
      n += static_cast<double>(values.size()), means += 1.0;
    }
  if (!(n > means) || means < 2.0) return 0.0;
  const double u = std::sqrt(squares / (n - means) / (n / means));
  return 2.0 * u * math::normal_quantile((1.0 + std::pow(0.8, 1.0 / means)) / 2.0);
}

double present_backlash(const Settings& options, const std::string& axis, bool rotary) {
  return stated_backlash(options, axis, rotary).value_or(0.0);
}

bool corrects(const Tables& tables, const std::string& axis) {
  return std::any_of(tables.begin(), tables.end(), [&](const LoadedTable& t) {
    return t.output == axis && t.input.size() == 1 && t.input.front() == axis;
  });
}

Observations without(const Observations& o, const std::string& axis, const Tables& tables) {
  Observations raw = o;
  if (raw.axes.empty()) return raw;
  const auto& a = raw.axes.front();
  for (std::size_t i = 0; i < raw.size(); ++i)
    for (const LoadedTable& t : tables)
      if (t.output == axis && t.input.size() == 1 && t.input.front() == axis)
        raw.deviation[i] -= math::added(t, std::span(&a.position[i], 1), a.approach[i]);
  return raw;
}

/// Returns readings along a diagonal without the correction of these tables; none if that depends
/// on the positions of a gantry's sides, which are not stated.
Observations diagonal_without(const Campaign& campaign, const Measurement& m, const Observations& o,
                              const Tables& tables) {
  Observations raw = o;
  const auto beams = math::beams_of(campaign);
  const bool relative = o.lines.size() > 1;  // each is zero at its start, which is no reading
  for (std::size_t i = 0; i < o.size(); ++i) {
    math::Places at, start;
    math::MotionSigns ways;
    for (const auto& axis : o.axes) {
      at[axis.axis] = axis.position[i];
      if (!axis.approach.empty())
        ways[axis.axis] = axis.approach[i] == 0 ? 0 : axis.approach[i] > 0 ? 1 : -1;
      const std::size_t k = coordinate_of(axis.axis);
      if (!relative || k > 2) continue;
      const auto [low, high] = std::minmax(m.from.at(axis.axis), m.to.at(axis.axis));
      start[axis.axis] = o.sense_of(i)[k] > 0.0 ? low : high;
    }
    for (const auto& axis : o.axes) {
      const std::size_t k = coordinate_of(axis.axis);
      if (axis.rotary || k > 2 || o.sense_of(i)[k] == 0.0) continue;
      const auto moved = [&](const math::Places& places) {
        return math::added_on_beam(
            beams, axis.axis, places, ways,
            [&](const std::string& one, const math::Places& there, const math::MotionSigns& of) {
              return math::added(tables, one, there, of);
            });
      };
      const auto here = moved(at), before = relative ? moved(start) : 0.0;
      if (!here || !before) return {};
      raw.deviation[i] -= o.sense_of(i)[k] * (*here - *before);
    }
  }
  return raw;
}

/// Whether several axes moved from one end of a line to the other.
bool is_diagonal(const Measurement& m) {
  return !m.from.empty() && m.motion == Measurement::Motion::targets;
}

void state_backlash_of(Settings& options, const Tables& tables) {
  for (const LoadedTable& t : tables)
    if (t.backlash && present_backlash(options, t.output, t.rotary) == 0.0)  // 0 is stated too
      state_backlash(options, t.output, t.rotary, *t.backlash);
}

void state_active_compensation(Campaign& campaign, const Settings& options, const Tables& present) {
  for (Axis& axis : campaign.machine.axes) {
    if (!corrects(present, axis.name)) continue;
    axis.active_table = "nonio table predict --active-table";
    axis.active_backlash = present_backlash(options, axis.name, axis.rotary);
  }
}

}  // namespace

Expected<Tables> tables_in(const Controller& o, const std::vector<Artifact>& files,
                           const Campaign& c, const Settings& options) {
  return process::guarded("controller " + o.info.name, [&] {
    return o.parse({files, c, options});
  });
}

Expected<const Controller*> control_of(const loader::Plugins& plugins, const std::string& name,
                                       const std::vector<Artifact>& files, const Campaign& campaign,
                                       const std::map<std::string, std::string>& options) {
  std::vector<const Controller*> all, named, able;
  std::vector<std::string> names;
  for (const Controller& o : plugins.controllers()) {
    all.push_back(&o);
    names.push_back(o.info.name);
    if (o.info.name == name) return &o;
    if (files.front().name.rfind(o.info.name + "-", 0) == 0) named.push_back(&o);
  }
  if (!name.empty())
    return fail("no control \"" + name + "\"" + storage::suggestion(name, names) + "; there are " +
                storage::listed(names));
  if (named.size() == 1) return named.front();
  std::vector<const Controller*> nearly;
  for (const Controller* o : all) {
    const auto settled = config::options_from(o->info, options);
    if (!settled) continue;
    const auto tables = tables_in(*o, files, campaign, *settled);
    if (tables) able.push_back(o);
    if (!tables && tables.error().line != 0) nearly.push_back(o);
  }
  if (able.empty()) able = std::move(nearly);
  if (able.size() == 1) return able.front();
  if (able.empty())
    return fail(files.front().name +
                ": no control known to Nonio could have written it; known are " +
                storage::listed(names));
  names.clear();
  for (const Controller* o : able) names.push_back(o->info.name);
  return fail(files.front().name + ": " + std::to_string(able.size()) +
              " controls could have written it; state --control, one of " + storage::listed(names));
}

std::vector<TableDifference> differences(const Tables& present, const Tables& next) {
  std::vector<TableDifference> out;
  for (const Tables* tables : {&present, &next})
    for (const LoadedTable& t : *tables) {
      if (std::any_of(out.begin(), out.end(), [&](const TableDifference& d) {
            return d.output == t.output && d.input == t.input;
          }))
        continue;
      TableDifference d{.output = t.output, .input = t.input, .rotary = t.rotary};
      std::vector<const LoadedTable*> was, will;
      for (const LoadedTable& o : present)
        if (same_axes(o, t)) was.push_back(&o);
      for (const LoadedTable& o : next)
        if (same_axes(o, t)) will.push_back(&o);
      compare(d, was, will);
      out.push_back(std::move(d));
    }
  return out;
}

namespace {
const char* backlash_key(bool rotary) { return rotary ? "backlash_deg" : "backlash_mm"; }
}  // namespace

std::optional<double> stated_backlash(const Settings& options, const std::string& axis,
                                      bool rotary) {
  const NumberTables axes = options.tables("axes");
  const auto table = axes.find(axis);
  if (table == axes.end()) return std::nullopt;
  const auto number = table->second.find(backlash_key(rotary));
  if (number == table->second.end()) return std::nullopt;
  return number->second / (rotary ? deg_per_rad : 1e3);
}

void state_backlash(Settings& options, const std::string& axis, bool rotary, double value) {
  NumberTables axes = options.tables("axes");
  axes[axis][backlash_key(rotary)] = rounded_to_places(value * (rotary ? deg_per_rad : 1e3), 9);
  options.values["axes"] = std::move(axes);
}

std::vector<Observations> without_tables(const Campaign& campaign,
                                         const std::vector<Observations>& readings,
                                         const Tables& tables) {
  std::vector<Observations> raw;
  for (std::size_t i = 0; i < readings.size(); ++i)
    raw.push_back(campaign.measurements[i].compensation == "off" ? readings[i]
                  : is_diagonal(campaign.measurements[i])
                      ? diagonal_without(campaign, campaign.measurements[i], readings[i], tables)
                      : without(readings[i],
                                control_axis(campaign.machine, campaign.measurements[i]), tables));
  return raw;
}

namespace {

bool is_curve(const Series& s) {
  return s.name.size() >= 3 && s.name[0] == 'E' && s.quantity == Quantity::deviation;
}

/// Takes out how far the pitch tables of both sides of a gantry turn its beam at the first target,
/// from which diagonals have their squareness.
void take_out_racking(const Campaign& campaign, const Tables& tables, Evaluation& e) {
  for (const math::Beam& beam : math::beams_of(campaign)) {
    const auto first = std::find_if(e.series.begin(), e.series.end(), [&](const Series& s) {
      return is_curve(s) && s.over == beam.axis && !s.position.empty();
    });
    if (beam.along.empty() || first == e.series.end()) continue;
    const double at = first->position.front();
    const math::Places places{{beam.axis, at}, {beam.slave, at}};
    double moved = 0.0;
    for (const int way : {1, -1}) {
      const math::MotionSigns ways{{beam.axis, way}, {beam.slave, way}};
      moved += (math::added(tables, beam.slave, places, ways) -
                math::added(tables, beam.axis, places, ways)) /
               2.0;
    }
    const double turn = moved / (beam.at_slave - beam.at_axis);
    if (beam.along.front() == 'Y') {
      for (Value& v : e.values)
        if (v.name == "C0Y") v.value += turn;
    } else {
      for (Series& s : e.series)
        for (std::size_t i = 0;
             is_curve(s) && s.over == beam.along && s.name[1] == beam.axis[0] && i < s.value.size();
             ++i)
          s.value[i] -= turn * (s.position[i] - s.position.front());
    }
  }
}

}  // namespace

Results without_tables(const Campaign& campaign, const Results& results, const Tables& tables) {
  Results out = results;
  for (Results::Analysed& a : out.analyses) {
    const auto m = std::find_if(campaign.measurements.begin(), campaign.measurements.end(),
                                [&](const Measurement& one) { return one.id == a.measurement; });
    const bool known = m != campaign.measurements.end();
    if (known && m->compensation == "off") continue;
    if (known && is_diagonal(*m)) take_out_racking(campaign, tables, a.evaluation);
    std::map<char, std::string> axis_of;
    for (const Series& s : a.evaluation.series)
      if (is_curve(s)) axis_of.emplace(s.name[2], s.over);
    for (Series& s : a.evaluation.series) {
      const auto output = axis_of.find(is_curve(s) ? s.name[1] : '\0');
      if (output == axis_of.end()) continue;
      for (const LoadedTable& t : tables)
        for (std::size_t i = 0;
             t.output == output->second && t.input == std::vector{s.over} && i < s.position.size();
             ++i)
          for (const int direction : {1, -1})
            s.value[i] -= math::added(t, std::span(&s.position[i], 1), direction) / 2.0;
    }
  }
  return out;
}

Campaign with_one(Campaign campaign, Measurement m) {
  m.axis = control_axis(campaign.machine, m);
  m.side.clear();
  for (Axis& axis : campaign.machine.axes) axis.slave.clear();
  campaign.measurements = {std::move(m)};
  return campaign;
}

namespace {

/// Returns the tables by one position of which the sum is a table by two. Error: there are none.
Expected<Tables> by_one_position(const LoadedTable& t) {
  if (t.input.size() == 1) return Tables{t};
  const std::size_t m = t.position[1].size();
  Tables parts;
  for (const std::size_t k : {0U, 1U}) {
    LoadedTable part = t;
    part.input = {t.input[k]}, part.position = {t.position[k]};
    for (auto* values : {&part.plus, &part.minus}) {
      if (values->empty()) continue;
      std::vector<double> along;
      for (std::size_t i = 0; i < t.position[k].size(); ++i)
        along.push_back((*values)[k == 0 ? i * m : i] - (k == 0 ? 0.0 : values->front()));
      *values = std::move(along);
    }
    if (k == 1) part.backlash.reset();
    parts.push_back(std::move(part));
  }
  const double most = 2.0 * same_within_um * 1e-6;  // of four rounded values
  const auto is_sum = [&](const std::vector<double>& all, const std::vector<double>& first,
                          const std::vector<double>& second) {
    for (std::size_t i = 0; i < all.size(); ++i)
      if (std::fabs(all[i] - first[i / m] - second[i % m]) > most) return false;
    return true;
  };
  if (!is_sum(t.plus, parts[0].plus, parts[1].plus) ||
      !is_sum(t.minus, parts[0].minus, parts[1].minus))
    return fail("the table of " + t.output + " by " + t.input[0] + " and " + t.input[1] +
                " is no sum of tables by one position, so it cannot be removed from the curves: "
                "measure with this table off (compensation = \"off\")");
  std::erase_if(parts, [](const LoadedTable& part) {
    const auto [low, high] = std::minmax_element(part.plus.begin(), part.plus.end());
    return *high - *low == 0.0 && part.minus.empty() && !part.backlash;
  });
  return parts;
}

}  // namespace

Expected<std::optional<Underlay>> active_compensation(const reading::ReadCampaign& read,
                                                      const Controller& controller,
                                                      const Settings& options) {
  if (read.active_tables.empty()) return std::optional<Underlay>();
  const Campaign& campaign = read.manifest->campaign;
  Underlay on{{}, options, {}};
  for (const auto& [name, files] : read.active_tables) {
    const std::string& axis = name;  // clang 14 cannot capture a structured binding
    const std::string who =
        "the compensation that was active while axis " + axis + " was measured: ";
    auto tables = tables_in(controller, files, campaign, options);
    if (!tables) return fail(who + tables.error().message);
    if (std::none_of(tables->begin(), tables->end(),
                     [&](const LoadedTable& t) { return t.output == axis; }))
      return fail(who + "its files hold no table of " + axis +
                  (tables->empty() ? "" : ", but of " + tables->front().output) +
                  "; which number has the axis in the control?");
    for (const LoadedTable& t : *tables) {
      if (t.output != axis) continue;
      const auto stated = stated_backlash(options, axis, t.rotary);
      if (stated && t.backlash.value_or(0.0) != 0.0 && std::fabs(*stated - *t.backlash) > 5e-10)
        return fail(who + "its files hold another backlash than active_backlash states");
      auto parts = by_one_position(t);
      if (!parts) return fail(who + parts.error().message);
      on.tables.insert(on.tables.end(), parts->begin(), parts->end());
    }
  }
  state_backlash_of(on.options, on.tables);
  on.readings = without_tables(campaign, read.observations, on.tables);
  return std::optional(std::move(on));
}

void compare_with_measured(const reading::ReadCampaign& read, OutputResult& result) {
  const auto& measurements = read.manifest->campaign.measurements;
  std::erase_if(result.findings, [&](const Finding& f) {
    return (f.id == "table.no-gain" || f.id == "table.worse-mean") &&
           std::any_of(measurements.begin(), measurements.end(), [&](const Measurement& m) {
             return m.id == f.measurement && m.kind == "axis";
           });
  });
  for (std::size_t i = 0; i < measurements.size(); ++i) {
    const Measurement& m = measurements[i];
    if (m.kind != "axis" || read.observations[i].size() == 0) continue;
    const auto test = math::AxisTest::arrange(read.observations[i]);
    const auto was = math::before(math::error_curve(test));
    for (Prediction& p : result.predictions) {
      if (p.measurement != m.id) continue;
      p.before = p.name == "B" ? was.B() : p.name == "M" ? was.M() : was.E();
      if (!p.name.starts_with("E") || p.after < p.before) continue;
      const Quantity q = deviation_of(test.rotary);
      result.findings.push_back({"table.present-as-good",
                                 true,
                                 {{"before", p.before, q}, {"after", p.after, q}},
                                 {{"axis", m.axis}},
                                 m.id,
                                 "Keep the active table."});
    }
  }
}

std::vector<TableForecast> forecast(const reading::ReadCampaign& read, const Tables& tables,
                                    const Settings& options, const std::optional<Underlay>& on) {
  std::vector<TableForecast> out;
  const auto& measurements = read.manifest->campaign.measurements;
  for (std::size_t i = 0; i < read.observations.size(); ++i) {
    const Measurement& m = measurements[i];
    const std::string axis = control_axis(read.manifest->campaign.machine, m);
    if (m.kind != "axis" || read.observations[i].size() == 0 || !corrects(tables, axis)) continue;
    if (math::error_curve(math::AxisTest::arrange(read.observations[i])).position.size() < 2)
      continue;
    out.push_back(forecast_of_axis(read.manifest->campaign, m, axis, read.observations[i],
                                   on ? on->readings[i] : read.observations[i], tables,
                                   on ? on->options : options));
  }
  return out;
}

TableForecast forecast_of_axis(const Campaign& campaign, const Measurement& m,
                               const std::string& axis, const Observations& readings,
                               const Observations& raw, const Tables& tables,
                               const Settings& options) {
  const auto test = math::AxisTest::arrange(readings);
  const double present =
      m.compensation == "off" ? 0.0 : present_backlash(options, axis, test.rotary);
  const math::ErrorCurve measured = math::error_curve(test);
  TableForecast f{m.id, axis, test.rotary};
  const auto was = math::before(measured);
  f.E[0] = was.E(), f.B[0] = was.B(), f.M[0] = was.M();
  const auto whole = math::correction_of(tables, axis, present);
  const math::Correction c = [&](double x, int dir) {
    return whole ? (*whole)(x, dir) - (dir > 0 ? present / 2.0 : -present / 2.0) : 0.0;
  };
  const auto will = math::after(math::error_curve(math::AxisTest::arrange(raw)), c);
  const auto U = math::compensated_uncertainty(campaign, m, readings, test, true);
  const double U_B = math::reversal_uncertainty(measured, c, U.B, U.B_mean);
  f.U_known = !std::isnan(U.E);
  f.B[1] = math::predicted_after(was.B(), will.B(), U_B);
  f.E[1] = math::predicted_E_after(was.E(), will.E(), U.E, U_B, f.B[1]);
  f.M[1] = math::predicted_after(was.M(), will.M(), U.M);
  f.grows = will.E() > was.E();
  f.scatter = std::max(will.E() + range_of_scatter(test) - f.E[1], 0.0);
  // Values of the axis require all targets.
  if (measured.left_out > 0)
    for (double* value : {f.E, f.B, f.M})
      value[0] = value[1] = std::nan(""), f.scatter = 0.0, f.grows = false;
  return f;
}

Expected<RenewedTables> renew(const reading::ReadCampaign& read, const Controller& controller,
                              Settings options, const Tables& present) {
  Campaign campaign = read.manifest->campaign;
  state_backlash_of(options, present);
  state_active_compensation(campaign, options, present);
  const std::vector<Observations> raw = without_tables(campaign, read.observations, present);
  const Results none;
  const auto write = [&](const Campaign& c, const std::vector<Observations>& o) {
    return process::guarded("controller " + controller.info.name, [&] {
      return controller.write({c, o, none, options});
    });
  };
  NONIO_TRY(auto whole, write(campaign, raw));
  RenewedTables out{std::move(whole.artifacts), {}, {}, std::move(whole.findings)};
  for (std::size_t i = 0; i < raw.size(); ++i) {
    const Measurement& m = campaign.measurements[i];
    if (m.kind != "axis" || raw[i].size() == 0) continue;
    const Campaign one = with_one(campaign, m);
    NONIO_TRY(const auto files, write(one, {raw[i]}));
    if (files.artifacts.empty()) continue;
    NONIO_TRY(const auto tables, tables_in(controller, files.artifacts, one, options));
    out.forecast.push_back(forecast_of_axis(campaign, m, control_axis(campaign.machine, m),
                                            read.observations[i], raw[i], tables, options));
    out.tables.insert(out.tables.end(), tables.begin(), tables.end());
  }
  return out;
}

Expected<SignProbe> sign_probe(const Measurement& m, const Observations& raw,
                               const Observations& measured) {
  const auto test = math::AxisTest::arrange(raw);
  const auto curve = math::error_curve(test);
  const auto with = math::error_curve(math::AxisTest::arrange(measured));
  const auto& e = curve.plus;
  if (e.size() < 3)
    return fail("measurement " + m.id +
                ": expected 3 targets or more that were reached moving "
                "towards plus, found " +
                std::to_string(e.size()));
  SignProbe probe{m.id, m.axis, test.rotary, curve.position.front()};
  for (std::size_t i = 1; i < e.size(); ++i)  // the first target is the start of the move
    for (std::size_t k = i + 1; k < e.size(); ++k)
      if (std::fabs(e[k] - e[i]) > std::fabs(probe.difference)) {
        probe.difference = e[k] - e[i];
        probe.as_measured = with.plus[k] - with.plus[i];
        probe.from = curve.position[i];
        probe.to = curve.position[k];
      }
  double sum = 0.0;
  std::size_t n = 0;
  for (std::size_t i = 0; i < test.targets.size(); ++i) {
    const auto readings = test.plus(i);
    double mean = 0.0;
    for (const auto& r : readings) mean += r.deviation / static_cast<double>(readings.size());
    for (const auto& r : readings) sum += (r.deviation - mean) * (r.deviation - mean);
    n += readings.empty() ? 0 : readings.size() - 1;
  }
  probe.scatter = n == 0 ? 0.0 : std::sqrt(sum / static_cast<double>(n));
  return probe;
}

}  // namespace nonio::tables
