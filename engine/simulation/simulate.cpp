// SPDX-License-Identifier: Apache-2.0
#include "simulation/simulate.h"

#include <algorithm>
#include <cmath>
#include <map>

#include "nonio/model/explain.h"
#include "nonio/sdk/format.h"
#include "nonio/sdk/method.h"
#include "platform/storage/json_values.h"
#include "platform/storage/random.h"
#include "simulation/simulate_rows.h"

namespace nonio::simulation {
namespace {

using storage::Json;

enum Stream : std::uint64_t { offsets, noise, misreadings, streams };

storage::Random stream_of(const Specification& s, std::size_t cycle, Stream stream) {
  return {s.seed, 1000000 + cycle * streams + stream};
}

std::vector<double> shifted_targets(const CycleSpec& c, storage::Random random) {
  std::vector<double> targets = c.targets;
  if (c.offset == 0.0) return targets;
  const double resolution = c.axis.rotary ? 1e-4 / deg_per_rad : 1e-6;
  for (std::size_t i = 0; i < targets.size(); ++i) {
    double by = random.uniform(-c.offset, c.offset);
    if (i == 0) by = std::fabs(by);  // end targets stay within the range
    if (i + 1 == targets.size()) by = -std::fabs(by);
    targets[i] = std::round((targets[i] + by) / resolution) * resolution;
  }
  return targets;
}

/// Readings to which an effect is applied jointly.
struct Seen {
  Observations table;
  std::vector<std::pair<std::size_t, std::size_t>> from;  ///< cycle and row of each reading
  const model::Part* part = nullptr;  ///< null for a measurement of kind ball-centres or rtcp
  double sign = 1.0;                  ///< sign of the effects in the readings
};

/// Returns the axis or instance of the effect; std::nullopt if it does not affect these readings.
std::optional<Axis> place_in(const Seen& seen, const EffectSpec& e, const Machine& machine) {
  Effect effect = e.effect;
  if (seen.part != nullptr) {
    effect.is_nuisance = false;  // The orientation of a straightedge may also be simulated.
    const auto terms = model::terms_of(*seen.part, machine, {e.name}, {effect});
    if (!terms || terms->empty()) return std::nullopt;
    return terms->front().axis;
  }
  const std::string of = e.name.substr(e.name.find(':') + 1);
  if (!effect.instances || effect.is_nuisance) return std::nullopt;
  const auto names = effect.instances(seen.table);
  if (std::find(names.begin(), names.end(), of) == names.end()) return std::nullopt;
  Axis place;
  place.name = of;
  return place;
}

/// The parts are those of `explain`, and each measurement of kind ball-centres or rtcp.
std::vector<Seen> seen_of(const Specification& s, const std::vector<Observations>& rows,
                          const std::vector<model::Part>& parts) {
  std::vector<Seen> all;
  std::map<std::string, std::size_t> cycle;
  for (std::size_t k = 0; k < s.cycles.size(); ++k) cycle[s.cycles[k].measurement.id] = k;
  for (const model::Part& part : parts) {
    Seen seen{part.table, {}, &part, 1.0};
    for (std::size_t i = 0; i < part.row.size(); ++i)
      seen.from.emplace_back(cycle.at(part.measurements[part.measurement[i]]), part.row[i]);
    all.push_back(std::move(seen));
  }
  for (std::size_t k = 0; k < s.cycles.size(); ++k) {
    const CycleSpec& c = s.cycles[k];
    if (!c.is("ball-centres") && !c.is("rtcp")) continue;
    // Ball centers: with the axes at P, the reading is P - e. RTCP: axes commanded to P are at P +
    // e. e is the error of the axes.
    Seen seen{rows[k], {}, nullptr, c.is("rtcp") ? -1.0 : 1.0};
    for (std::size_t i = 0; i < rows[k].size(); ++i) seen.from.emplace_back(k, i);
    all.push_back(std::move(seen));
  }
  return all;
}

double rms(const std::vector<double>& values) {
  double sum = 0.0;
  for (const double v : values) sum += v * v;
  return std::sqrt(sum / static_cast<double>(values.size()));
}

/// Deviation of each reading due to all columns, m or rad. The coefficients of a curve are random,
/// and are scaled so that the curve has the specified RMS over the readings. For a curve in space,
/// the coefficients are scaled instead, because not every reading senses it, and its basis
/// functions are orthogonal over the positions and have an RMS of 1.
std::vector<double> deviation_of_columns(const EffectSpec& e, const Effect::Columns& columns,
                                         storage::Random random) {
  std::vector<double> factor = e.linear, sum(columns.empty() ? 0 : columns[0].size(), 0.0);
  const bool places = e.effect.curve && e.effect.instances;
  if (e.effect.curve) {
    factor.clear();
    double square = 0.0;
    for (std::size_t k = 0; k < columns.size(); ++k) {
      factor.push_back(random.normal());
      square += factor.back() * factor.back();
    }
    if (places)
      for (double& f : factor) f *= e.linear[0] / std::sqrt(square);
  }
  for (std::size_t k = 0; k < columns.size(); ++k)
    for (std::size_t i = 0; i < sum.size(); ++i) sum[i] += factor[k] * columns[k][i];
  if (e.effect.curve && !places) {
    const double size = rms(sum);
    for (double& v : sum) v *= size > 0.0 ? e.linear[0] / size : 0.0;
  }
  return sum;
}

/// A shape parameter that is not specified has the only value that readings and manifest allow,
/// otherwise its usual value. An error if there is neither.
Expected<std::vector<double>> shape_of(const EffectSpec& e, const Observations& o,
                                       const Axis& place) {
  std::vector<double> shape;
  for (std::size_t k = 0; k < e.shape.size(); ++k) {
    if (e.shape[k]) {
      shape.push_back(*e.shape[k]);
      continue;
    }
    const Effect::Shape& searched = e.effect.shapes[k];
    const std::vector<double> grid = searched.grid(o, place);
    if (grid.size() != 1 && searched.usual) {
      shape.push_back(*searched.usual);
      continue;
    }
    if (grid.size() != 1)
      return fail("effect." + key_of(searched.parameter, e.axis.rotary) +
                  " is missing: " + searched.parameter.help + " of " + e.name);
    shape.push_back(grid[0]);
  }
  return shape;
}

Json parameter_json(const EffectSpec& e, const Effect::Parameter& parameter, double value) {
  const Quantity quantity = quantity_on(parameter, e.axis.rotary);
  Json json = {{"name", parameter.name}, {"value", printed(value, quantity)}};
  if (const auto symbol = unit_of(quantity).symbol; !symbol.empty()) json["unit"] = symbol;
  return json;
}

Json quantity_json(double value, bool rotary) {
  return {{"value", printed(value, deviation_of(rotary))},
          {"unit", unit_of(deviation_of(rotary)).symbol}};
}

/// Returns the component of the direction of sensing of reading i along the axis `place`; 1 with a
/// single axis, on a rotary axis and for effects in space, as in `explain`.
double sensed(const Seen& seen, const EffectSpec& e, const Axis& place, std::size_t i) {
  const std::size_t k = coordinate_of(place.name);
  if (seen.part == nullptr || e.effect.instances || seen.table.axes.size() < 2 || place.rotary ||
      k > 2)
    return 1.0;
  return seen.table.sense_of(i)[k];
}

Expected<void> add_effect(const EffectSpec& e, const Specification& s, const std::vector<Seen>& all,
                          std::vector<Observations>& rows, Json& truth, storage::Random random) {
  std::vector<double> whole;
  std::vector<double> shape;
  for (const Seen& seen : all) {
    const auto place = place_in(seen, e, s.campaign.machine);
    if (!place) continue;
    if (!e.effect.applies(seen.table, *place))
      return fail(e.name + " does not apply to these readings: " + e.effect.info.summary);
    NONIO_TRY(const auto found, shape_of(e, seen.table, *place));
    shape = found;
    const auto columns = e.effect.columns(seen.table, *place, shape);
    if (!columns) return fail(e.name + ": " + columns.error().message);
    if (!e.effect.curve && columns->size() != e.linear.size())
      return fail(e.name + ": its plugin gives " + std::to_string(columns->size()) +
                  " columns for " + std::to_string(e.linear.size()) + " parameters");
    std::vector<double> part = deviation_of_columns(e, *columns, random);
    for (std::size_t i = 0; i < part.size(); ++i) {
      part[i] *= sensed(seen, e, *place, i);
      if (!std::isfinite(part[i])) return fail(e.name + " gives no finite deviation");
      rows[seen.from[i].first].deviation[seen.from[i].second] += seen.sign * part[i];
    }
    whole.insert(whole.end(), part.begin(), part.end());
  }
  if (whole.empty())
    return fail(e.name + ": no measurement shows it" +
                (e.effect.instances ? "" : ", none moves axis " + e.axis.name));
  Json parameters = Json::array();
  for (std::size_t k = 0; k < e.linear.size(); ++k)
    parameters.push_back(parameter_json(e, e.effect.linear[k], e.linear[k]));
  for (std::size_t k = 0; k < shape.size(); ++k)
    parameters.push_back(parameter_json(e, e.effect.shapes[k].parameter, shape[k]));
  truth["effects"].push_back({{"effect", e.name},
                              {"parameters", std::move(parameters)},
                              {"rms", quantity_json(rms(whole), e.axis.rotary)}});
  return {};
}

/// Subtracts the reading at the start of each step diagonal, where the display is set to 0.
void preset(const CycleSpec& c, Observations& o) {
  if (!c.is("step-diagonal")) return;
  const std::size_t each = 3 * c.steps + 1;
  for (std::size_t i = o.size(); i-- > 0;) o.deviation[i] -= o.deviation[i - i % each];
}

Expected<std::string> readings(const Specification& s, std::size_t k, const Observations& o,
                               Json& truth) {
  const CycleSpec& c = s.cycles[k];
  const bool rotary = o.angular;
  storage::Random noise_of = stream_of(s, k, noise), wrong = stream_of(s, k, misreadings);
  std::string text = std::string(simulated_mark) + "\n" + header_of(c);
  Observations as_read = o;
  std::size_t file_line = 2;
  Json misread = Json::array();
  const std::size_t each = readings_in_row(c);
  std::vector<double> read(each);
  for (std::size_t i = 0; i < o.size(); i += each) {
    if (c.is("step-diagonal") && i % (3 * c.steps + 1) == 0) continue;
    ++file_line;
    for (std::size_t n = 0; n < each; ++n) {
      double& e = read[n] = o.deviation[i + n] + c.noise * noise_of.normal();
      const bool off = wrong.uniform() < c.misread;
      const double by = (wrong.uniform() < 0.5 ? -1.0 : 1.0) * c.noise *
                        wrong.uniform(c.misread_size.first, c.misread_size.second);
      if (!off) continue;
      e += by;
      misread.push_back({{"line", file_line}, {"by", quantity_json(by, rotary)}});
    }
    if (c.method != nullptr)
      as_read.deviation[i] = read[0];
    else
      text += row_of(c, o, i, read);
  }
  truth["measurements"].push_back({{"id", c.measurement.id},
                                   {"file", c.measurement.file},
                                   {"noise", quantity_json(c.noise, rotary)},
                                   {"misread", std::move(misread)}});
  if (c.method == nullptr) return text;
  NONIO_TRY(const auto written, nonio::simulate(*c.method, {s.campaign, c.measurement, as_read}));
  return std::string(simulated_mark) + "\n" + table_of(*c.method, written);
}

void tell_things(const Specification& s, Json& truth) {
  const auto mm = [](const std::array<double, 3>& v) {
    return Json{printed(v[0], Quantity::length), printed(v[1], Quantity::length),
                printed(v[2], Quantity::length)};
  };
  for (const RotarySpec& r : s.rotaries) {
    Json one = {{"axis", r.axis}, {"centre_mm", mm(r.centre)}, {"direction", r.direction}};
    if (r.control_centre) one["control_centre_mm"] = mm(*r.control_centre);
    if (r.control_direction) one["control_direction"] = *r.control_direction;
    truth["rotary"].push_back(std::move(one));
  }
  for (const SquareSpec& q : s.squares)
    truth["squares"].push_back(
        {{"name", q.name}, {"error_urad", q.error * 1e6}, {"set_up_urad", q.set_up * 1e6}});
}

std::string manifest_text(const std::string& lines) {
  std::string text = std::string(simulated_mark) + "\n";
  for (const char c : lines)
    if (c != '\n' || !text.ends_with("\n\n")) text += c;
  while (text.ends_with("\n\n")) text.pop_back();
  return text;
}

}  // namespace

config::Checked<Simulated> simulate(std::string_view specification, const std::string& file,
                                    const std::vector<Effect>& effects,
                                    const std::vector<Method>& methods) {
  const auto s = read_specification(specification, file, effects, methods);
  if (!s) return tl::unexpected(s.error());
  std::vector<Error> errors;
  Json truth = {{"schema", "nonio-truth/1"},
                {"campaign", s->campaign.id},
                {"seed", s->seed},
                {"effects", Json::array()},
                {"measurements", Json::array()}};
  std::vector<Observations> rows;
  for (std::size_t k = 0; k < s->cycles.size(); ++k) {
    const CycleSpec& c = s->cycles[k];
    auto made = rows_of(*s, c, shifted_targets(c, stream_of(*s, k, offsets)));
    if (!made) errors.push_back(Error{made.error().message, file, c.line});
    rows.push_back(made ? std::move(*made) : Observations{});
  }
  if (!errors.empty()) return tl::unexpected(std::move(errors));
  // Ball-centres and rtcp are excluded, because `seen_of` adds them separately.
  std::vector<Observations> linear = rows;
  for (std::size_t k = 0; k < rows.size(); ++k)
    if (s->cycles[k].is("ball-centres") || s->cycles[k].is("rtcp")) linear[k] = {};
  const std::vector<model::Part> parts = model::parts_of(s->campaign, linear);
  const std::vector<Seen> seen = seen_of(*s, rows, parts);
  for (std::size_t k = 0; k < s->effects.size(); ++k) {
    const EffectSpec& e = s->effects[k];
    if (auto done = add_effect(e, *s, seen, rows, truth, storage::Random(s->seed, k)); !done)
      errors.push_back(Error{done.error().message, file, e.line});
  }
  if (!errors.empty()) return tl::unexpected(std::move(errors));
  tell_things(*s, truth);
  Simulated out;
  for (std::size_t k = 0; k < s->cycles.size(); ++k) {
    preset(s->cycles[k], rows[k]);
    auto text = readings(*s, k, rows[k], truth);
    if (!text) {
      errors.push_back(Error{text.error().message, file, s->cycles[k].line});
      continue;
    }
    out.campaign.push_back({s->cycles[k].measurement.file, std::move(*text)});
  }
  if (!errors.empty()) return tl::unexpected(std::move(errors));
  out.campaign.push_back({"campaign.toml", manifest_text(s->manifest)});
  out.truth = truth.dump(1) + "\n";
  return out;
}

}  // namespace nonio::simulation
