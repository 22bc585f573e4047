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

/// Material temperature: `start`, degC, plus `drift`, K/s, plus a sine wave with amplitude `swing`,
/// K, and `period`, s.
struct TemperatureCourse {
  double start = 20.0, drift = 0.0, swing = 0.0, period = 3600.0;
};

/// One [[cycle]]: the simulation of a measurement, in SI units.
struct CycleSpec {
  Measurement measurement;
  Axis axis;
  std::uint64_t line = 0;  ///< line in the specification
  /// Ascending, without random shifts, m or rad; in file units until the table is read.
  std::vector<double> targets;
  std::optional<double> first, last, distance;  ///< range that replaces the targets, in file units
  double offset = 0.0;                          ///< largest random shift of a target, m or rad
  std::uint32_t runs = 5;
  /// Whether each run has both directions; otherwise every run is in `direction`.
  bool pendulum = true;
  double direction = 1.0;
  bool timed = true;
  double dwell = 5.0;    ///< time at each target, s
  double feed = 0.0;     ///< m/s or rad/s
  double pause = 0.0;    ///< pause before each further run, s
  double noise = 0.0;    ///< standard deviation of a reading, m or rad
  double misread = 0.0;  ///< probability of a misreading
  /// Size of a misreading in multiples of the noise.
  std::pair<double, double> misread_size{8.0, 40.0};
  std::optional<TemperatureCourse> temperature;
  std::uint32_t steps = 0;       ///< steps of a diagonal or step diagonal; targets are used if 0
  std::uint32_t readings = 720;  ///< readings per turn of a circle
  double set_up = 0.0;           ///< angle between straightedge and axis, rad
  std::vector<std::array<double, 3>> balls;  ///< positions with the rotary axes at 0, m
  /// Another rotary axis that rotates too; may be empty.
  std::string carrier;
  std::vector<double> carrier_at;             ///< positions of the carrier, rad
  std::vector<std::array<double, 3>> senses;  ///< directions of gauges, unit vectors
  /// For rtcp: "turns" (gauges that rotate with the axis) or "probe"; otherwise gauges at rest.
  std::string sensor;
  /// True position of the ball minus its position in the control, m.
  std::array<double, 3> ball_offset{};
  /// Method whose files only the method itself can write, simulated as runs along the axis;
  /// otherwise null.
  const Method* method = nullptr;
  bool is(std::string_view kind) const { return measurement.kind == kind; }
  bool along_axis() const { return is("axis") || method != nullptr; }
};

/// True position of a rotary axis, and its position in the control; m and unit vectors.
struct RotarySpec {
  std::string axis;
  std::array<double, 3> centre{}, direction{0.0, 0.0, 1.0};
  std::optional<std::array<double, 3>> control_centre{}, control_direction{};
  std::string carries;  ///< table or head
};

/// True error and setup angle of a reference square, rad.
struct SquareSpec {
  std::string name;
  double error = 0.0, set_up = 0.0;
};

struct EffectSpec {
  Effect effect;
  std::string name;  ///< "backlash:X"
  Axis axis;
  std::uint64_t line = 0;
  std::vector<double> linear;  ///< linear parameters, SI
  std::vector<std::optional<double>>
      shape;  ///< nonlinear parameters, SI; std::nullopt if not specified
};

struct Specification {
  Campaign campaign;
  std::string manifest;  ///< the specification without the tables of the simulation
  std::uint64_t seed = 1;
  std::vector<Formula> hidden;    ///< formulas that campaign.toml must not contain
  std::vector<Effect> catalogue;  ///< the plugins' effects, and formulas
  const std::vector<Method>* methods = nullptr;
  std::vector<CycleSpec> cycles;  ///< one per measurement, in the same order
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

/// Declares the part of a specification that campaign.toml does not contain. The functions below
/// read or check its keys, like those of campaign/config/checks.h.
const config::Key& specification_file();
/// One cycle per measurement, in the same order.
void read_cycles(config::TableReader&, const config::Key&, std::vector<CycleSpec>&, Specification&);
void read_effects(config::TableReader&, const config::Key&, std::vector<EffectSpec>&,
                  Specification&);
void check_simulation(config::TableReader&, Specification&);
void check_hidden(config::TableReader&, Formula&, Specification&);
void check_rotary(config::TableReader&, RotarySpec&, Specification&);
void check_square(config::TableReader&, SquareSpec&, Specification&);

using Vector = std::array<double, 3>;
/// Vectors are three numbers each, and directions become unit vectors. An array whose size is 0 or
/// not a multiple of three is an error.
void read_points(config::TableReader&, const config::Key&, std::vector<Vector>&);
void read_directions(config::TableReader&, const config::Key&, std::vector<Vector>&);
void read_point(config::TableReader&, const config::Key&, Vector&);
void read_direction(config::TableReader&, const config::Key&, Vector&);
void read_optional_point(config::TableReader&, const config::Key&, std::optional<Vector>&);
void read_optional_direction(config::TableReader&, const config::Key&, std::optional<Vector>&);

/// Quantity of a parameter on this kind of axis, and its key: "b_um", "a_um_per_m".
Quantity quantity_on(const Effect::Parameter& parameter, bool rotary);
std::string key_of(const Effect::Parameter& parameter, bool rotary);

}  // namespace nonio::simulation
