// SPDX-License-Identifier: Apache-2.0
// Methods that break one law each, which their name says. All read a deviation at a target.
#include <cmath>
#include <cstdlib>

#include "nonio/sdk/plugin.h"

using namespace nonio;

namespace {

using Role = Method::Column::Role;

/// The observations, with the deviation that `of` makes of a reading.
template <class Of>
Expected<Observations> observed(const MethodInput& in, Of of) {
  Observations o;
  o.measurement = in.measurement.id;
  o.axes.push_back({in.measurement.axis, false, {}, {}});
  o.lines.push_back({in.measurement.id, {1.0, 0.0, 0.0}});
  for (std::size_t i = 0; i < in.readings.size(); ++i) {
    o.axes[0].position.push_back((*in.readings.column("target"))[i]);
    o.deviation.push_back(of((*in.readings.column("gauge"))[i]));
    o.source_line.push_back(in.readings.source_line[i]);
  }
  return o;
}

Expected<Readings> reversed(const SimulationInput& in) {
  Readings r;
  for (std::size_t i = 0; i < in.observations.size(); ++i) {
    r.columns["target"].push_back(in.observations.axes[0].position[i]);
    r.columns["gauge"].push_back(in.observations.deviation[i]);
    r.source_line.push_back(in.observations.source_line_of(i));
  }
  return r;
}

Expected<Observations> halved(const MethodInput& in) {
  return observed(in, [](double gauge) { return 0.5 * gauge; });
}
Expected<Observations> divided(const MethodInput& in) {
  return observed(in, [](double gauge) { return gauge * (gauge / gauge); });
}
Expected<Observations> crashing(const MethodInput& in) {
  if (in.readings.size() == 0) std::abort();
  return observed(in, [](double gauge) { return gauge; });
}
Expected<Observations> at_home(const MethodInput& in) {
  const char* home = std::getenv("HOME");
  const double more = home == nullptr ? 0.0 : 1e-6 * static_cast<double>(std::string(home).size());
  return observed(in, [&](double gauge) { return gauge + more; });
}
Expected<Readings> from_home(const SimulationInput& in) {
  auto r = reversed(in);
  const char* home = std::getenv("HOME");
  const double more = home == nullptr ? 0.0 : 1e-6 * static_cast<double>(std::string(home).size());
  for (double& gauge : r->columns["gauge"]) gauge -= more;
  return r;
}

Option axis() {
  return {.name = "axis",
          .default_value = std::string(),
          .unit = "",
          .help = "The axis that moves.",
          .required = true,
          .missing = "the axis that moves"};
}

Method made(const char* name, Expected<Observations> (*observe)(const MethodInput&)) {
  Method m;
  m.info = {name, "1", "Wrong on purpose", {axis()}};
  m.columns = {{"target", Quantity::length, Role::position, "Position."},
               {"gauge", Quantity::deviation, Role::none, "Reading."}};
  m.observe = observe;
  m.simulate = reversed;
  return m;
}

}  // namespace

NONIO_PLUGIN(registry) {
  registry.add(made("halves-readings", halved));
  registry.add(made("divides-by-readings", divided));
  registry.add(made("crash-on-empty", crashing));
  Method home = made("of-its-home", at_home);
  home.simulate = from_home;
  registry.add(std::move(home));
  Method twice = made("two-columns-of-a-name", halved);
  twice.columns.push_back(twice.columns.back());
  registry.add(std::move(twice));
  Method key = made("key-without-help", halved);
  key.info.options[0].help.clear();
  registry.add(std::move(key));
}
