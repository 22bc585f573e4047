// SPDX-License-Identifier: Apache-2.0
#include "campaign/reading/plausibility/plausibility.h"

#include <algorithm>
#include <cmath>
#include <ctime>
#include <map>

#include "campaign/reading/plausibility/plausibility_strokes.h"
#include "nonio/sdk/channels.h"
#include "nonio/sdk/format.h"
#include "platform/storage/digest.h"

namespace nonio::reading {
namespace {

/// Limits of readings of machine tools; others have another unit.
struct Bounds {
  double slope = 0.02;        ///< largest slope of the deviation over the travel, m/m or rad/rad
  double share = 0.002;       ///< largest range divided by the travel, for ranges above `size`
  double size, most;          ///< range above which `share` applies, and largest range, m or rad
  double small_share = 0.05;  ///< largest range divided by a short travel, above `small_size`
  double small_size;          ///< range that is plausible on any short travel, m or rad
  double scatter;             ///< largest standard deviation of readings, m or rad
  double least;               ///< smallest range over a travel of `least_travel`, m or rad
  double least_travel;
};
constexpr double um = 1e-6, arcsec = 1.0 / arcsec_per_rad;
constexpr Bounds of_lengths{.size = 300 * um,
                            .most = 20000 * um,
                            .small_size = 2 * um,
                            .scatter = 500 * um,
                            .least = 0.05 * um,
                            .least_travel = 0.02};
constexpr Bounds of_angles{.size = 600 * arcsec,
                           .most = 3600 * arcsec,
                           .small_size = 20 * arcsec,
                           .scatter = 200 * arcsec,
                           .least = 0.02 * arcsec,
                           .least_travel = 0.1};
constexpr double least_of_travel = 0.05, most_of_travel = 1.2;
/// Smallest pitch of a screw, m; shorter periods come from a scale.
constexpr double least_pitch = 1e-3;

bool along_one_axis(const Measurement& m) {
  return m.kind == "axis" || m.kind == "straightness" || m.kind == "angle";
}

/// Whether the deviation is along the line between two stated ends.
bool between_ends(const Measurement& m) { return !m.from.empty() && !m.to.empty(); }

double range_of(const std::vector<double>& values) {
  if (values.empty()) return 0.0;
  const auto [low, high] = std::minmax_element(values.begin(), values.end());
  return *high - *low;
}

std::string shortest(double value) {
  std::string text;
  append_shortest(text, value);
  return text;
}

double median(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

struct Cell {
  double target = 0.0;
  std::vector<double> deviations;
};

/// Position of the only axis; in space, distance from the first reading.
std::vector<double> along(const Observations& o) {
  if (o.axes.size() == 1) return o.axes.front().position;
  std::vector<double> out(o.size());
  for (const auto& axis : o.axes)
    for (std::size_t i = 0; i < out.size() && i < axis.position.size(); ++i)
      out[i] += std::pow(axis.position[i] - axis.position.front(), 2);
  for (double& d : out) d = std::sqrt(d);
  return out;
}

std::vector<Cell> cells_of(const Observations& o, const std::vector<double>& target) {
  std::map<std::pair<long long, int>, Cell> cells;
  for (std::size_t i = 0; i < o.size(); ++i) {
    const auto& approach = o.axes.front().approach;
    const int direction = approach.empty() ? 0 : approach[i];
    Cell& cell = cells[{std::llround(target[i] / grid_tolerance), direction}];
    cell.target = target[i];
    cell.deviations.push_back(o.deviation[i]);
  }
  std::vector<Cell> out;
  for (auto& one : cells) out.push_back(std::move(one.second));
  return out;
}

class Size {
 public:
  Size(const Campaign& campaign, const Measurement& m, const Observations& o)
      : campaign_(campaign),
        measurement_(m),
        o_(o),
        bounds_(o.angular ? of_angles : of_lengths),
        deviation_(o.angular ? Quantity::angular_deviation : Quantity::deviation),
        position_(o.axes.front().rotary ? Quantity::angle : Quantity::length) {
    const auto target = along(o);
    travel_ = range_of(target);
    std::vector<double> scatters;
    for (Cell& cell : cells_of(o, target)) {
      means_.push_back({cell.target, median(cell.deviations)});
      if (cell.deviations.size() > 1) scatters.push_back(scatter(cell.deviations));
    }
    if (!scatters.empty()) scatter_ = median(std::move(scatters));
    line();
  }

  void too_large(std::vector<Finding>& out) const {
    const bool position = measurement_.kind == "axis" || between_ends(measurement_);
    if (position && same_unit() && std::fabs(slope_) > bounds_.slope)
      return out.push_back({.id = "plausibility.deviation-grows-with-position",
                            .attention = true,
                            .evidence = {{"share", slope_, Quantity::ratio},
                                         {"range", range_, deviation_},
                                         {"travel", travel_, position_}}});
    // A straightedge or mirror can have any angle, so the slope is not checked.
    const double range = position ? range_ : range_of_rest_;
    const bool of_travel =
        same_unit() &&
        ((range > bounds_.share * travel_ && range > bounds_.size) ||
         (range > bounds_.small_share * travel_ && range > bounds_.small_size && travel_ > 0.0));
    if (of_travel || range > bounds_.most)
      return out.push_back(
          {.id = "plausibility.deviation-too-large",
           .attention = true,
           .evidence = {{"range", range, deviation_}, {"travel", travel_, position_}}});
    const Axis* axis = campaign_.machine.axis(measurement_.axis);
    if (position && axis != nullptr && axis->screw_pitch && *axis->screw_pitch >= least_pitch &&
        range > 0.5 * *axis->screw_pitch)
      return out.push_back({.id = "plausibility.deviation-beyond-pitch",
                            .attention = true,
                            .evidence = {{"range", range, deviation_},
                                         {"pitch", *axis->screw_pitch, Quantity::length}}});
    if (scatter_ > bounds_.scatter)
      out.push_back({.id = "plausibility.scatter-too-large",
                     .attention = true,
                     .evidence = {{"scatter", scatter_, deviation_}}});
  }

  void too_small(std::vector<Finding>& out) const {
    if (o_.size() < 4) return;
    const double range = range_of(o_.deviation);
    if (range == 0.0)
      return out.push_back(
          {.id = "plausibility.readings-all-equal",
           .attention = true,
           .evidence = {{"readings", static_cast<double>(o_.size()), Quantity::count},
                        {"value", o_.deviation.front(), deviation_}}});
    // The slope of a straightness measurement depends on the set-up, and the U of the laser does
    // not include the straightness optics.
    const bool straightness = measurement_.kind == "straightness";
    if (straightness && range_of_rest_ < 0.4 * bounds_.least && scatter_ < 0.4 * bounds_.least &&
        travel_ >= bounds_.least_travel && means_.size() > 2)
      return out.push_back(
          {.id = "plausibility.deviation-too-small",
           .attention = true,
           .evidence = {{"range", range_of_rest_, deviation_}, {"travel", travel_, position_}}});
    if (straightness) return;
    if (const auto [U, least] = uncertainty(); range < least)
      out.push_back({.id = "plausibility.deviation-below-uncertainty",
                     .attention = true,
                     .evidence = {{"range", range, deviation_}, {"U", U, deviation_}}});
    else if (range < bounds_.least && travel_ >= bounds_.least_travel &&
             (o_.angular || range < 1e-6 * travel_))
      out.push_back({.id = "plausibility.deviation-too-small",
                     .attention = true,
                     .evidence = {{"range", range, deviation_}, {"travel", travel_, position_}}});
  }

 private:
  bool same_unit() const { return o_.angular == o_.axes.front().rotary; }

  static double scatter(const std::vector<double>& values) {
    double mean = 0.0, sum = 0.0;
    for (const double v : values) mean += v / static_cast<double>(values.size());
    for (const double v : values) sum += (v - mean) * (v - mean);
    return std::sqrt(sum / static_cast<double>(values.size() - 1));
  }

  void line() {
    double t = 0.0, d = 0.0, tt = 0.0, td = 0.0;
    const auto n = static_cast<double>(means_.size());
    for (const auto& mean : means_) t += mean.first / n, d += mean.second / n;
    for (const auto& mean : means_) {
      tt += (mean.first - t) * (mean.first - t);
      td += (mean.first - t) * (mean.second - d);
    }
    slope_ = tt > 0.0 ? td / tt : 0.0;
    std::vector<double> values, rest;
    for (const auto& mean : means_) {
      values.push_back(mean.second);
      rest.push_back(mean.second - d - slope_ * (mean.first - t));
    }
    range_ = range_of(values);
    range_of_rest_ = range_of(rest);
  }

  /// Returns U of the instrument (k = 2; 0 if not stated) and the smallest plausible range of
  /// deviations. The length-dependent part of U has a smaller weight, because an adjustment with
  /// the same instrument cancels this part.
  std::pair<double, double> uncertainty() const {
    constexpr double of_fixed = 0.5, of_length = 0.15;
    const Instrument& i = campaign_.instrument;
    if (o_.angular) return {i.U_angle.value_or(0.0), of_fixed * i.U_angle.value_or(0.0)};
    const double fixed = i.U_fixed.value_or(0.0);
    const double with_length = i.U_per_length.value_or(0.0) * travel_;
    return {fixed + with_length, of_fixed * fixed + of_length * with_length};
  }

  const Campaign& campaign_;
  const Measurement& measurement_;
  const Observations& o_;
  const Bounds& bounds_;
  Quantity deviation_, position_;
  std::vector<std::pair<double, double>> means_;
  double travel_ = 0.0, slope_ = 0.0, range_ = 0.0, range_of_rest_ = 0.0, scatter_ = 0.0;
};

/// Each line of a step diagonal has a zero of its own.
std::vector<Observations> lines_of(const Observations& o) {
  if (o.lines.size() < 2) return {o};
  std::vector<Observations> out(o.lines.size());
  for (std::size_t i = 0; i < out.size(); ++i) {
    out[i].angular = o.angular;
    out[i].lines = {o.lines[i]};
    for (const auto& axis : o.axes) out[i].axes.push_back({axis.axis, axis.rotary, {}, {}});
  }
  for (std::size_t i = 0; i < o.size(); ++i) {
    Observations& line = out[o.line_of(i)];
    line.deviation.push_back(o.deviation[i]);
    for (std::size_t k = 0; k < o.axes.size(); ++k)
      line.axes[k].position.push_back(o.axes[k].position[i]);
  }
  std::erase_if(out, [](const Observations& line) { return line.size() == 0; });
  return out;
}

double span_along(const Observations& o, const std::string& axis) {
  const auto* column = o.axis(axis);
  return column == nullptr ? 0.0 : range_of(column->position);
}

bool near_ratio(double ratio, double wanted) { return std::fabs(ratio / wanted - 1.0) < 0.02; }

void implausible_span(const Campaign& campaign, const Measurement& m, const Observations& o,
                      const std::vector<Observations>& all, std::vector<Finding>& out) {
  const Axis* axis = campaign.machine.axis(m.axis);
  if (axis == nullptr || !along_one_axis(m)) return;
  const Quantity position = axis->rotary ? Quantity::angle : Quantity::length;
  const double span = span_along(o, m.axis);
  if (span <= 0.0) return;
  double widest = span;
  for (const Observations& other : all) widest = std::max(widest, span_along(other, m.axis));
  if (near_ratio(span / widest, 1e-3) || near_ratio(span / widest, 1.0 / 25.4) ||
      near_ratio(span / widest, 1.0 / deg_per_rad))
    return out.push_back({.id = "plausibility.span-of-another-unit",
                          .attention = true,
                          .evidence = {{"span", span, position}, {"other", widest, position}}});
  if (axis->travel || axis->rotary) {
    // Without a stated travel, or if no more than about one turn was measured, the travel is one
    // turn.
    const double turn = 360.0 / deg_per_rad,
                 stated = axis->travel ? axis->travel->second - axis->travel->first : turn;
    const double travel =
        axis->rotary && stated > turn && span <= most_of_travel * turn ? turn : stated;
    if (!axis->travel && widest > 7.0 / deg_per_rad && span <= most_of_travel * travel) return;
    if (widest < least_of_travel * travel || span > most_of_travel * travel)
      out.push_back({.id = "plausibility.span-against-travel",
                     .attention = true,
                     .evidence = {{"span", span, position},
                                  {"travel", travel, position},
                                  {"share", span / travel, Quantity::ratio}}});
  }
  if (axis->screw_pitch && *axis->screw_pitch >= least_pitch && widest < 0.5 * *axis->screw_pitch)
    out.push_back(
        {.id = "plausibility.span-against-pitch",
         .attention = true,
         .evidence = {{"span", span, position}, {"pitch", *axis->screw_pitch, Quantity::length}}});
}

/// Targets outside the travel show that travel and targets have different zeros.
void beyond_travel(const Campaign& campaign, const Observations& o, std::vector<Finding>& out) {
  constexpr double spare_share = 0.02;
  for (const auto& column : o.axes) {
    const Axis* axis = campaign.machine.axis(column.axis);
    if (axis == nullptr || !axis->travel || column.position.empty()) continue;
    const auto [from, to] = *axis->travel;
    const double spare = spare_share * (to - from);
    const auto [low, high] = std::minmax_element(column.position.begin(), column.position.end());
    if (*low >= from - spare && *high <= to + spare) continue;
    const Quantity position = axis->rotary ? Quantity::angle : Quantity::length;
    out.push_back({.id = "plausibility.targets-outside-travel",
                   .attention = true,
                   .evidence = {{"first", *low, position},
                                {"last", *high, position},
                                {"from", from, position},
                                {"to", to, position}},
                   .texts = {{"axis", column.axis}}});
  }
}

/// If the targets cover a small part of the diagonal, or the travel of one of its axes, they are
/// positions of this axis.
void short_diagonal(const Measurement& m, const Observations& o, std::vector<Finding>& out) {
  constexpr double nearly = 1e-3, shorter = 0.99;
  double square = 0.0;
  std::map<std::string, double> ways;
  for (const auto& [axis, from] : m.from)
    if (const auto to = m.to.find(axis); to != m.to.end()) {
      ways[axis] = std::fabs(to->second - from);
      square += std::pow(to->second - from, 2);
    }
  const double length = std::sqrt(square), span = range_of(along(o));
  const Number measured{"span", span, Quantity::length}, whole{"travel", length, Quantity::length};
  if (span < least_of_travel * length)
    return out.push_back(
        {.id = "plausibility.span-against-travel",
         .attention = true,
         .evidence = {measured, whole, {"share", span / length, Quantity::ratio}}});
  for (const auto& [axis, way] : ways)
    if (way < shorter * length && std::fabs(span - way) < nearly * way)
      return out.push_back({.id = "plausibility.span-of-one-axis",
                            .attention = true,
                            .evidence = {measured, whole},
                            .texts = {{"axis", axis}}});
}

/// A U above five times the largest value, and above that of an ordinary test: a very good axis has
/// small values and an ordinary U.
void uncertain(const std::vector<Results::Analysed>& analyses, const std::string& measurement,
               std::vector<Finding>& out) {
  constexpr double most = 5.0;
  for (const Results::Analysed& a : analyses) {
    if (a.measurement != measurement) continue;
    double value = 0.0, U = 0.0;
    Quantity quantity = Quantity::deviation;
    for (const Value& v : a.evaluation.values) {
      if (!v.U || (v.quantity != Quantity::deviation && v.quantity != Quantity::angular_deviation))
        continue;
      value = std::max(value, std::fabs(v.value));
      U = std::max(U, *v.U);
      quantity = v.quantity;
    }
    const double ordinary = 25.0 * (quantity == Quantity::deviation ? um : arcsec);
    if (U <= std::max(most * value, ordinary) || value <= 0.0) continue;
    return out.push_back({.id = "plausibility.uncertainty-beyond-deviation",
                          .attention = true,
                          .evidence = {{"U", U, quantity}, {"value", value, quantity}},
                          .texts = {{"analysis", a.plugin}}});
  }
}

std::vector<Finding> implausible_readings(const Campaign& campaign, std::size_t measurement,
                                          const std::vector<Observations>& all,
                                          const Passes& passes) {
  std::vector<Finding> out;
  const Measurement& m = campaign.measurements[measurement];
  const Observations& o = all[measurement];
  if (o.size() == 0 || o.axes.empty() || o.axes.front().position.empty()) return out;
  if (m.motion == Measurement::Motion::none) return out;
  const bool along_line = along_one_axis(m) || between_ends(m);
  const bool runs = along_line && o.lines.size() < 2;  // otherwise each pass has its own zero
  for (const Observations& line : lines_of(o)) {
    if (!along_line) break;
    const Size size(campaign, m, line);
    const std::size_t before = out.size();
    size.too_large(out);
    size.too_small(out);
    if (out.size() > before) break;
  }
  implausible_span(campaign, m, o, all, out);
  if (const Axis* axis = campaign.machine.axis(m.axis); axis != nullptr && m.kind == "axis")
    period_against_pitch(*axis, o, out);
  if (m.kind == "diagonal") short_diagonal(m, o, out);
  if (m.kind == "ball-centres") implausible_centres(m, o, out);
  beyond_travel(campaign, o, out);
  if (along_line) {
    const std::size_t before = out.size();
    implausible_passes(passes, o, runs, out);
    if (runs && out.size() == before) shifted_rows(passes, deviation_of(o.angular), out);
  }
  implausible_columns(m, passes, o, runs, out);
  return out;
}

}  // namespace

std::vector<Results::Analysed> implausible(const ReadCampaign& read, const Context& context,
                                           const Inputs& inputs,
                                           const std::vector<Results::Analysed>& analyses) {
  std::vector<Results::Analysed> out;
  const Campaign& campaign = read.manifest->campaign;
  const auto add = [&](const std::string& id, std::vector<Finding> findings) {
    if (findings.empty()) return;
    for (Finding& f : findings) f.measurement = id;
    out.push_back({std::string(plausibility_name), context.version, id, {}});
    out.back().evaluation.findings = std::move(findings);
  };
  add("", implausible_campaign(*read.manifest, context.today));
  std::map<std::string, std::string> digest_of, first_with;
  for (const auto& [name, digest] : inputs) digest_of[name] = digest;
  std::vector<Passes> passes;
  for (const Observations& o : read.observations) passes.push_back(passes_of(o));
  const auto twice = passes_of_another_measurement(campaign, read.observations, passes);
  for (std::size_t i = 0; i < campaign.measurements.size(); ++i) {
    const Measurement& m = campaign.measurements[i];
    std::vector<Finding> findings;
    for (const Finding& f : read.doubts)
      if (f.measurement == m.id) findings.push_back(f);
    const std::string& digest = digest_of[input_name(m.file)];
    if (const auto shared = digest_of.find(shared_name(m.file)); shared != digest_of.end())
      findings.push_back({.id = std::string(file_of_another_campaign),
                          .attention = true,
                          .texts = {{"file", m.file}, {"campaign", shared->second}}});
    if (const auto [first, is_new] = first_with.try_emplace(digest, m.file);
        !is_new && first->second != m.file && digest != config::absent)
      findings.push_back({.id = "plausibility.file-twice",
                          .attention = true,
                          .texts = {{"file", m.file}, {"other", first->second}}});
    else
      for (const Finding& f : twice)
        if (f.measurement == m.id) findings.push_back(f);
    for (Finding& f : implausible_readings(campaign, i, read.observations, passes[i]))
      findings.push_back(std::move(f));
    if (m.kind == "axis") uncertain(analyses, m.id, findings);
    add(m.id, std::move(findings));
  }
  return out;
}

void note_shared(const Twins& twins, Inputs& inputs) {
  Inputs shared;
  const std::string file = input_name("");
  for (const auto& [name, digest] : inputs)
    if (name.starts_with(file))
      for (const auto& [twin, campaign] : twins)
        if (digest != config::absent && storage::short_digest(digest) == twin)
          shared.emplace_back(shared_name(name.substr(file.size())), campaign);
  inputs.insert(inputs.end(), shared.begin(), shared.end());
}

Expected<void> possible_air(const Observations& o, const std::string& file) {
  struct Column {
    const char *name, *unit;
    const std::vector<double>& values;
    double least, most;
  };
  constexpr double coldest = -60.0, hottest = 150.0;  // degC
  for (const Observations::Channel& c : o.channels)
    for (std::size_t i = 0; c.is_temperature() && i < c.value.size(); ++i) {
      if ((c.value[i] >= coldest && c.value[i] <= hottest) || c.value[i] == no_thermometer)
        continue;
      Error error{"expected -60 to 150 degC, or nothing where it was not measured; found " +
                  shortest(c.value[i]) + " at time_s = " + shortest(c.time[i])};
      error.file = file;
      error.column = c.name + "_c";
      return fail(std::move(error));
    }
  for (const Column& c : {Column{"material_c", "degC", o.material, coldest, hottest},
                          Column{"air_c", "degC", o.air, coldest, hottest},
                          Column{"pressure_hpa", "hPa", o.pressure, 300.0, 1200.0},
                          Column{"humidity_pct", "%", o.humidity, 0.0, 105.0}})
    for (std::size_t i = 0; i < c.values.size(); ++i) {
      const double v = c.values[i];
      if (!std::isfinite(v) || (v >= c.least && v <= c.most)) continue;
      Error error{"expected " + shortest(c.least) + " to " + shortest(c.most) + " " + c.unit +
                  ", or nothing where it was not measured; found " + shortest(v)};
      error.file = file;
      error.line = o.source_line_of(i);
      error.column = c.name;
      return fail(std::move(error));
    }
  return {};
}

std::string day_of_clock() {
  const std::time_t now = std::time(nullptr);
  std::tm day{};
  ::localtime_r(&now, &day);
  char text[11];
  return {text, std::strftime(text, sizeof text, "%Y-%m-%d", &day)};
}

}  // namespace nonio::reading
