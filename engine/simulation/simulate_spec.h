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

/// Temperature of the material over time: a value at the start, degC, plus a drift, K/s, plus a
/// sine wave with an amplitude `swing`, K, and a period, s.
struct TemperatureCourse {
  double start = 20.0, drift = 0.0, swing = 0.0, period = 3600.0;
};

/// One [[cycle]]: how a measurement is simulated. All values are SI.
struct CycleSpec {
  Measurement measurement;
  Axis axis;
  std::uint64_t line = 0;  ///< line in the specification
  /// Targets, ascending, without random shifts, m or rad; while it is read, as written.
  std::vector<double> targets;
  std::optional<double> first, last, distance;  ///< range that replaces the targets, as written
  double offset = 0.0;  ///< largest random shift of a target, m or rad; while it is read, a share
  std::uint32_t runs = 5;
  bool pendulum = true;  ///< true: each run in both directions; false: every run in `direction`
  double direction = 1.0;
  bool timed = true;
  double dwell = 5.0;    ///< time at each target, s
  double feed = 0.0;     ///< feed rate, m/s or rad/s
  double pause = 0.0;    ///< pause before each further run, s
  double noise = 0.0;    ///< standard deviation of a reading, m or rad
  double misread = 0.0;  ///< probability that a reading is misread
  /// range of the size of a misreading, in multiples of the noise
  std::pair<double, double> misread_size{8.0, 40.0};
  std::optional<TemperatureCourse> temperature;
  std::uint32_t steps = 0;  ///< number of steps of a diagonal or step diagonal; 0: targets are used
  std::uint32_t readings = 720;               ///< number of readings per turn of a circle
  double set_up = 0.0;                        ///< angle of a straightedge to the axis, rad
  std::vector<std::array<double, 3>> balls;   ///< positions of the balls with the rotary axes at 0,
                                              ///< m
  std::string carrier;                        ///< another rotary axis that turns too; empty: none
  std::vector<double> carrier_at;             ///< positions of the carrier, rad; first as written
  std::vector<std::array<double, 3>> senses;  ///< directions of gauges, unit vectors
  std::string sensor;                         ///< for rtcp: "turns" (gauges that turn with the
                                              ///< axis), "probe", or else gauges at rest
  std::array<double, 3> ball_offset{};        ///< true position of the ball minus its position in
                                              ///< the control, m
  /// Method of a kind whose file only this method can write, simulated as runs along the axis; null
  /// for other kinds.
  const Method* method = nullptr;
  bool is(std::string_view kind) const { return measurement.kind == kind; }
  bool along_axis() const { return is("axis") || method != nullptr; }
};

/// True position of a rotary axis, and its position in the control. m, unit vectors.
struct RotarySpec {
  std::string axis;
  std::array<double, 3> centre{}, direction{0.0, 0.0, 1.0};
  std::optional<std::array<double, 3>> control_centre{}, control_direction{};
  std::string carries;  ///< part that the axis carries: table, head
};

/// A square: true error and set-up angle, rad.
struct SquareSpec {
  std::string name;
  double error = 0.0, set_up = 0.0;
};

/// One [[effect]], with its parameters as specified.
struct EffectSpec {
  Effect effect;
  std::string name;  ///< kind and axis: "backlash:X"
  Axis axis;
  std::uint64_t line = 0;
  std::vector<double> linear;                ///< linear parameters, SI
  std::vector<std::optional<double>> shape;  ///< nonlinear parameters, SI; without a value: not
                                             ///< specified
};

struct Specification {
  Campaign campaign;
  std::string manifest;  ///< text of the specification without the tables of the simulation
  std::uint64_t seed = 1;
  std::vector<Formula> hidden;                   ///< formulas that campaign.toml must not contain
  std::vector<Effect> catalogue;                 ///< the plugins' effects, and formulas
  const std::vector<Method>* methods = nullptr;  ///< the plugins' methods
  std::vector<CycleSpec> cycles;  ///< one per measurement, in the order of the measurements
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

/// Returns the declaration of the part of a specification that campaign.toml does not contain. The
/// functions below read or check its keys, as those of campaign/config/checks.h do.
const config::Key& specification_file();
/// Reads the [[cycle]] tables, one for each measurement, in the order of the measurements.
void read_cycles(config::TableReader&, const config::Key&, std::vector<CycleSpec>&, Specification&);
void read_effects(config::TableReader&, const config::Key&, std::vector<EffectSpec>&,
                  Specification&);
void check_simulation(config::TableReader&, Specification&);
void check_hidden(config::TableReader&, Formula&, Specification&);
void check_rotary(config::TableReader&, RotarySpec&, Specification&);
void check_square(config::TableReader&, SquareSpec&, Specification&);

using Vector = std::array<double, 3>;
/// Read the vectors of an array, three numbers each; directions become unit vectors. An array whose
/// size is 0 or not a multiple of three is an error.
void read_points(config::TableReader&, const config::Key&, std::vector<Vector>&);
void read_directions(config::TableReader&, const config::Key&, std::vector<Vector>&);
void read_point(config::TableReader&, const config::Key&, Vector&);
void read_direction(config::TableReader&, const config::Key&, Vector&);
void read_optional_point(config::TableReader&, const config::Key&, std::optional<Vector>&);
void read_optional_direction(config::TableReader&, const config::Key&, std::optional<Vector>&);

/// Return the quantity of a parameter on this kind of axis, and its key: "b_um", "a_um_per_m".
Quantity quantity_on(const Effect::Parameter& parameter, bool rotary);
std::string key_of(const Effect::Parameter& parameter, bool rotary);

}  // namespace nonio::simulation
