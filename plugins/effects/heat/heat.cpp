// SPDX-License-Identifier: Apache-2.0
// Displacements over time caused by recorded channels. L(x, tau): first-order lag of x with the
// time constant tau, s (sdk/channels.h); T, T1, T2: temperatures, degC; n: speed or load; t: time
// since the first reading, s.
//
//     heat:T               g L(T, tau)                      g: m/K
//     heat-slow:T          g L(T, tau), tau longer than that of heat:T    g: m/K
//     heat-difference:T1-T2   g (L(T1, tau) - L(T2, tau))   g: m/K
//     heat-source:n        a L(|n/n0|^m, tau)               a: m at the largest n0; m: 1 or 2
//     heat-source-slow:n   a L(|n/n0|^m, tau), tau longer than that of heat-source:n
//     settling:time        z exp(-t/tau)                    z: m
//
// In space, heat:T/X and heat-growth:T/X are the effects on the component along X.
#include <algorithm>
#include <cmath>
#include <limits>

#include "nonio/sdk/channels.h"
#include "nonio/sdk/plugin.h"

namespace nonio::heat {

namespace {

using Channel = Observations::Channel;
using Columns = Effect::Columns;

/// Minimum range of a temperature channel, K; a smaller range is regarded as sensor noise.
constexpr double least_range = 0.05;
/// Smallest significant component of a direction of sensing.
constexpr double least_share = 1e-9;

/// Whether a channel varies, within a measurement or from one measurement to another.
bool varies(const Observations& o, const Channel& c, double least) {
  double low = std::numeric_limits<double>::infinity(), high = -low;
  return std::any_of(o.channels.begin(), o.channels.end(), [&](const Channel& same) {
    return same.name == c.name && std::any_of(same.value.begin(), same.value.end(), [&](double v) {
             low = std::min(low, v);
             high = std::max(high, v);
             return high - low > least;
           });
  });
}

bool is_source(const Channel& c) { return !c.is_temperature(); }

template <class Kind>
std::vector<std::string> names(const Observations& o, const Kind& kind) {
  std::vector<std::string> out;
  for (const Channel& c : o.channels)
    if (kind(c) && std::find(out.begin(), out.end(), c.name) == out.end()) out.push_back(c.name);
  return out;
}

/// Whether readings are sensed in space: over several axes, or across the axis that moved.
bool in_space(const Observations& o) {
  if (o.lines.empty()) return false;
  if (o.axes.size() != 1) return o.axes.size() > 1 && !o.angular;
  const std::size_t k = coordinate_of(o.axes.front().axis);
  for (std::size_t i = 0; i < o.size() && k < 3; ++i)
    for (std::size_t other = 0; other < 3; ++other)
      if (other != k && std::fabs(o.sense_of(i)[other]) > least_share) return true;
  return false;
}

/// The name of the axis along a coordinate, "X" where none of the readings' axes is.
std::string axis_along(const Observations& o, std::size_t k) {
  for (const auto& axis : o.axes)
    if (!axis.rotary && coordinate_of(axis.axis) == k) return axis.axis;
  return std::string(1, "XYZ"[k]);
}

bool is_sensed(const Observations& o, std::size_t k) {
  for (std::size_t i = 0; i < o.size(); ++i)
    if (std::fabs(o.sense_of(i)[k]) > least_share) return true;
  return false;
}

bool moves(const Observations::AxisColumn& axis) {
  const auto [low, high] = std::minmax_element(axis.position.begin(), axis.position.end());
  return low != high && *low < *high &&
         std::all_of(axis.position.begin(), axis.position.end(),
                     [](double x) { return std::isfinite(x); });
}

/// Names of temperatures; in space "T/X" for each coordinate that is sensed, or for growth each
/// axis that moves and is sensed along.
std::vector<std::string> places_of(const Observations& o, bool growth) {
  const std::vector<std::string> all =
      names(o, [&](const Channel& c) { return c.is_temperature() && varies(o, c, least_range); });
  if (!in_space(o)) return all;
  std::vector<std::string> out;
  for (const std::string& name : all)
    for (std::size_t k = 0; k < 3; ++k) {
      const std::string along = axis_along(o, k);
      const auto* axis = o.axis(along);
      if (is_sensed(o, k) && (!growth || (axis != nullptr && moves(*axis))))
        out.push_back(name + "/" + along);
    }
  return out;
}

std::vector<std::string> temperatures(const Observations& o) { return places_of(o, false); }
std::vector<std::string> growths(const Observations& o) { return places_of(o, true); }

std::vector<std::string> sources(const Observations& o) {
  return names(o, [&](const Channel& c) { return is_source(c) && varies(o, c, 0.0); });
}

/// Whether the temperature may bend the structure: its role is "structure" or not stated.
bool may_bend(const Observations& o, const Channel& c) {
  return c.is_temperature() && (c.role.empty() || c.role == "structure") &&
         varies(o, c, least_range);
}

/// Pairs "A-B"; channels with "-" in their name are omitted.
std::vector<std::string> differences(const Observations& o) {
  std::vector<std::string> out;
  const std::vector<std::string> all = names(o, [&](const Channel& c) { return may_bend(o, c); });
  for (std::size_t i = 0; i < all.size(); ++i)
    for (std::size_t j = i + 1; j < all.size(); ++j)
      if (all[i].find('-') == std::string::npos && all[j].find('-') == std::string::npos)
        out.push_back(all[i] + "-" + all[j]);
  return out;
}

std::vector<std::string> of_time(const Observations& o) {
  return o.time.size() == o.size() && o.size() > 2 ? std::vector<std::string>{"time"}
                                                   : std::vector<std::string>{};
}

const Observations::AxisColumn* moved(const Observations& o) {
  if (o.axes.size() != 1 || o.axes.front().position.size() != o.size()) return nullptr;
  return o.axes.front().axis == "S" ? nullptr : &o.axes.front();
}

bool has_times(const Observations& o) {
  return o.time.size() == o.size() &&
         std::all_of(o.time.begin(), o.time.end(), [](double t) { return std::isfinite(t); });
}

/// Tests over time only. Positioning runs use the effects of `applies_to_runs`.
bool applies(const Observations& o, const Axis&) {
  return has_times(o) && !in_space(o) && moved(o) == nullptr;
}
bool applies_to_all(const Observations& o, const Axis&) { return has_times(o); }
bool applies_to_runs(const Observations& o, const Axis&) {
  return has_times(o) && (in_space(o) || (moved(o) != nullptr && !moved(o)->rotary));
}

Effect::Shape lag(const char* name, const char* help) {
  return {.parameter = {name, help, Quantity::time},
          .grid = [](const Observations& o, const Axis&) { return time_constants_for(o.time); }};
}

Effect::Shape decay(const char* name, const char* help) {
  return {.parameter = {name, help, Quantity::time},
          .grid = [](const Observations& o, const Axis&) {
            std::vector<double> all = time_constants_for(o.time);
            if (!all.empty()) all.erase(all.begin());
            return all;
          }};
}

Effect::Shape slow(const char* name, const char* help) {
  return {.parameter = {name, help, Quantity::time},
          .grid = [](const Observations& o, const Axis&) {
            const std::vector<double> all = time_constants_for(o.time);
            return std::vector<double>(all.begin() + static_cast<std::ptrdiff_t>(all.size() / 2),
                                       all.end());
          }};
}

Effect::Shape power() {
  return {.parameter = {"m", "power of the channel", Quantity::number},
          .grid =
              [](const Observations&, const Axis&) {
                return std::vector<double>{1.0, 2.0};
              },
          .continuous = false};
}

tl::unexpected<Error> no_channel(const std::string& name) {
  return fail("there is no channel \"" + name + "\"");
}

Expected<Columns> heat(const Observations& o, const Axis& of, const std::vector<double>& shape) {
  const std::size_t slash = std::min(of.name.find('/'), of.name.size());
  const std::string name = of.name.substr(0, slash);
  if (o.channel(name) == nullptr) return no_channel(name);
  if (shape.size() != 1) return fail("heat: expected a time constant");
  std::vector<double> column = lagged(o, name, shape[0]);
  if (slash < of.name.size()) {
    const std::size_t k = coordinate_of(of.name.substr(slash + 1));
    if (k > 2) return fail("heat: expected an axis X, Y or Z after \"/\"");
    for (std::size_t i = 0; i < column.size(); ++i) column[i] *= o.sense_of(i)[k];
  }
  return Columns{std::move(column)};
}

Expected<Columns> growth(const Observations& o, const Axis& of, const std::vector<double>& shape) {
  auto columns = heat(o, of, shape);
  if (!columns) return columns;
  const std::size_t slash = of.name.find('/');
  const auto* axis = slash == std::string::npos ? moved(o) : o.axis(of.name.substr(slash + 1));
  if (axis == nullptr) return fail("heat-growth: no axis was moved");
  const auto [low, high] = std::minmax_element(axis->position.begin(), axis->position.end());
  const double middle = 0.5 * (*low + *high);
  std::vector<double> along = columns->front();
  for (std::size_t i = 0; i < along.size(); ++i) along[i] *= axis->position[i] - middle;
  columns->insert(columns->begin(), std::move(along));
  return columns;
}

Expected<Columns> difference(const Observations& o, const Axis& of,
                             const std::vector<double>& shape) {
  const std::size_t dash = of.name.find('-');
  const Channel* one = o.channel(of.name.substr(0, dash));
  const Channel* two = dash == std::string::npos ? nullptr : o.channel(of.name.substr(dash + 1));
  if (one == nullptr || two == nullptr || shape.size() != 1) return no_channel(of.name);
  std::vector<double> column = lagged(*one, shape[0], o.time);
  const std::vector<double> less = lagged(*two, shape[0], o.time);
  for (std::size_t i = 0; i < column.size(); ++i) column[i] -= less[i];
  return Columns{std::move(column)};
}

Expected<Columns> source(const Observations& o, const Axis& of, const std::vector<double>& shape) {
  const Channel* c = o.channel(of.name);
  if (c == nullptr || shape.size() != 2) return no_channel(of.name);
  Channel power = *c;
  double largest = c->largest.value_or(0.0);
  if (!c->largest)
    for (const double n : power.value) largest = std::max(largest, std::fabs(n));
  if (!(largest > 0.0)) return fail("channel \"" + of.name + "\" is 0 everywhere");
  for (double& n : power.value) n = std::pow(std::fabs(n) / largest, shape[1]);
  return Columns{lagged(power, shape[0], o.time)};
}

Expected<Columns> settling(const Observations& o, const Axis&, const std::vector<double>& shape) {
  if (shape.size() != 1 || !(shape[0] > 0.0)) return fail("settling: expected a time constant");
  const double first = o.time.empty() ? 0.0 : *std::min_element(o.time.begin(), o.time.end());
  std::vector<double> column;
  for (const double t : o.time) column.push_back(std::exp(-(t - first) / shape[0]));
  return Columns{std::move(column)};
}

Effect effect(const char* name, const char* summary, std::vector<Effect::Parameter> linear,
              std::vector<Effect::Shape> shapes,
              std::vector<std::string> (*instances)(const Observations&),
              Expected<Columns> (*columns)(const Observations&, const Axis&,
                                           const std::vector<double>&)) {
  Effect e;
  e.info = {name, "1.0.0", summary};
  e.linear = std::move(linear);
  e.shapes = std::move(shapes);
  e.applies = applies;
  e.columns = columns;
  e.instances = instances;
  e.of_channels = true;
  return e;
}

Effect::Parameter settled() {
  return {"a", "displacement at the largest value, settled", Quantity::deviation,
          Quantity::angular_deviation};
}

}  // namespace

NONIO_PLUGIN(registry) {
  const Quantity per_kelvin = Quantity::deviation_per_kelvin,
                 tilt_per_kelvin = Quantity::angle_per_kelvin;
  Effect follows = effect("heat", "A displacement follows a measured temperature with a lag",
                          {{"g", "displacement per kelvin", per_kelvin, tilt_per_kelvin}},
                          {lag("tau", "time constant of the lag")}, temperatures, heat);
  follows.applies = applies_to_all;
  registry.add(std::move(follows));
  Effect grows =
      effect("heat-growth", "A screw, scale or bed grows with a measured temperature with a lag",
             {{"w", "expansion", Quantity::expansion}, {"s", "shift of the middle", per_kelvin}},
             {lag("tau", "time constant of the lag")}, growths, growth);
  grows.applies = applies_to_runs;
  registry.add(std::move(grows));
  registry.add(effect("heat-slow",
                      "A second, slower displacement follows a measured temperature too",
                      {{"g", "displacement per kelvin", per_kelvin, tilt_per_kelvin}},
                      {slow("tau", "time constant of the slow part")}, temperatures, heat));
  registry.add(effect("heat-difference",
                      "A structure bends with the difference of two temperatures",
                      {{"g", "displacement per kelvin of difference", per_kelvin, tilt_per_kelvin}},
                      {lag("tau", "time constant of the lag")}, differences, difference));
  registry.add(effect("heat-source", "A displacement follows a speed or a load with a lag",
                      {settled()}, {decay("tau", "time constant"), power()}, sources, source));
  registry.add(effect("heat-source-slow",
                      "A second, slower displacement follows a speed or a load too", {settled()},
                      {slow("tau", "time constant of the slow part"), power()}, sources, source));
  registry.add(
      effect("settling", "A displacement that dies away from the first reading on",
             {{"z", "displacement at the start", Quantity::deviation, Quantity::angular_deviation}},
             {decay("tau", "time constant")}, of_time, settling));
}

}  // namespace nonio::heat
