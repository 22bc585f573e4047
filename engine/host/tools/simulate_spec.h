// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "host/config/manifest.h"
#include "host/config/toml_reader.h"
#include "nonio/sdk/plugin.h"

namespace nonio::host::tools {

/// One [[cycle]]: how a measurement is taken. SI.
struct CycleSpec {
  Measurement measurement;
  Axis axis;
  std::uint64_t line = 0;       ///< of the specification
  std::vector<double> targets;  ///< ascending; before the random offsets
  double offset = 0.0;          ///< largest random shift of a target, m or rad
  std::uint32_t runs = 5;
  bool pendulum = true;  ///< else every run in `direction`
  double direction = 1.0;
  bool timed = true;
  double dwell = 5.0;                                 ///< s
  double feed = 0.0;                                  ///< m/s or rad/s
  double pause = 0.0;                                 ///< before each further run, s
  double noise = 0.0;                                 ///< standard deviation, m or rad
  double misread = 0.0;                               ///< share of the readings
  std::pair<double, double> misread_size{8.0, 40.0};  ///< times the noise
  struct Course {
    double start = 20.0, drift = 0.0, swing = 0.0, period = 3600.0;  ///< degC, K/s, K, s
  };
  std::optional<Course> temperature;
};

/// One [[effect]], its parameters as written.
struct EffectSpec {
  Effect effect;
  std::string name;  ///< "backlash:X"
  Axis axis;
  std::uint64_t line = 0;
  std::vector<double> linear;                ///< SI
  std::vector<std::optional<double>> shape;  ///< SI; none: the readings fix it
};

struct Specification {
  Campaign campaign;
  std::string manifest;  ///< the text without what is only for the simulation
  std::uint64_t seed = 1;
  std::vector<Effect> catalogue;  ///< the plugins' effects, and formulas
  std::vector<CycleSpec> cycles;  ///< in the order of the measurements
  std::vector<EffectSpec> effects;
};

config::Checked<Specification> read_specification(std::string_view text, const std::string& file,
                                                  const std::vector<Effect>& effects);

/// The [[cycle]]s, one for each measurement, in their order.
std::vector<CycleSpec> read_cycles(config::TableReader& top, const Campaign& campaign,
                                   std::vector<Error>& errors);

/// Quantity of a parameter on this kind of axis, and its key: "b_um", "a_um_per_m".
Quantity quantity_on(const Effect::Parameter& parameter, bool rotary);
std::string key_of(const Effect::Parameter& parameter, bool rotary);

}  // namespace nonio::host::tools
