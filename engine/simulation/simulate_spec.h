// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "campaign/config/manifest.h"
#include "campaign/config/toml_reader.h"
#include "nonio/sdk/plugin.h"

namespace nonio::simulation {

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
  std::uint32_t steps = 0;                    ///< of a diagonal or step diagonal; 0: targets
  std::uint32_t readings = 720;               ///< of a circle, on a turn
  double set_up = 0.0;                        ///< of a straightedge against the axis, rad
  std::vector<std::array<double, 3>> balls;   ///< with the rotary axes at 0, m
  std::string carrier;                        ///< another rotary axis that turned too, or none
  std::vector<double> carrier_at;             ///< its positions, rad
  std::vector<std::array<double, 3>> senses;  ///< of gauges, unit vectors
  std::string sensor;                         ///< of rtcp: turns, stands or probe
  std::array<double, 3> ball_offset{};        ///< from where the control takes the ball to be, m
  /// Of a kind that only its method can write: runs along its axis.
  const Method* method = nullptr;
  bool is(std::string_view kind) const { return measurement.kind == kind; }
  bool along_axis() const { return is("axis") || method != nullptr; }
};

/// A rotary axis as it is, and as the control has it. m, unit vectors.
struct RotarySpec {
  std::string axis;
  std::array<double, 3> centre{}, direction{};
  std::optional<std::array<double, 3>> control_centre{}, control_direction{};
  std::string carries;  ///< table, head
};

/// A square as it is, rad.
struct SquareSpec {
  std::string name;
  double error = 0.0, set_up = 0.0;
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
  std::vector<RotarySpec> rotaries;
  std::vector<SquareSpec> squares;

  const RotarySpec* rotary(std::string_view axis) const {
    for (const RotarySpec& r : rotaries)
      if (r.axis == axis) return &r;
    return nullptr;
  }
};

config::Checked<Specification> read_specification(std::string_view text, const std::string& file,
                                                  const std::vector<Effect>& effects,
                                                  const std::vector<Method>& methods);

/// The [[cycle]]s, one for each measurement, in their order.
std::vector<CycleSpec> read_cycles(config::TableReader& top, const Campaign& campaign,
                                   const std::vector<Method>& methods, std::vector<Error>& errors);

/// [[simulation.rotary]] and [[simulation.square]].
void read_things(config::TableReader& simulation, Specification& s);
/// Three numbers at a time, times `scale`; an error for another number of them.
std::vector<std::array<double, 3>> vectors_at(config::TableReader& reader, std::string_view key,
                                              double scale);

/// Quantity of a parameter on this kind of axis, and its key: "b_um", "a_um_per_m".
Quantity quantity_on(const Effect::Parameter& parameter, bool rotary);
std::string key_of(const Effect::Parameter& parameter, bool rotary);

}  // namespace nonio::simulation
