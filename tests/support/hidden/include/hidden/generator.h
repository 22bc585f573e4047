// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "nonio/sdk/campaign.h"
#include "nonio/sdk/error.h"
#include "nonio/sdk/observations.h"

/// Campaigns whose hidden effects come from physics and geometry, not from the basis functions of
/// the effect plugins, so that the tests of `explain` do not prove what they put in.
///
/// What is not hidden, because the readings could not show it (`random_scenario` draws again):
///  - a lead error or a worm mesh that the targets meet at about the same phase, or so slowly
///    moving that it looks like a smooth pitch curve;
///  - a period that the manifest does not give and that is shorter than 0.6 of the mean distance of
///    uneven targets, or than 2.3 distances of even ones, or longer than a third of the stretch;
///  - a measured temperature that runs along with time;
///  - two causes that act alike: warm-up, growth and temperature exclude each other;
///  - an effect that, with the others of its campaign in the model, is significant by less than
///    `seen_from` standard deviations, or differs by less than `told_from` from the most similar
///    effect (a warm-up from a steady growth, a jump from a drift);
///  - a slip within the first or last tenth of the readings;
///  - something outside the catalogue that the catalogue can nearly describe (a random walk that
///    happens to be a jump).
/// Idealised so that a name of the catalogue is correct: screws are fixed at the middle of the
/// stretch (at a bearing in `fixed_end`) and start cold at the first reading; the controller's
/// backlash value takes out the constant part of a wind-up; the shop is at 20 degC in the mean.
/// Measurements without times have no pauses, so that the order of the readings is nearly the time.
namespace nonio::hidden {

inline constexpr double seen_from = 7.0;
inline constexpr double told_from = 5.0;

/// Physical causes, each with its kind in the catalogue, or "outside".
enum class Source {
  wrong_scale,         ///< laser out of line, or wrong pitch: scale
  ground_pitch,        ///< pitch errors of grinding, accumulated: pitch-curve
  lead_error,          ///< once per revolution of the screw, not quite a sine: periodic
  lost_motion,         ///< play and friction of a nut, as a play operator: backlash
  preload_loss,        ///< nut whose second flank has come free: backlash
  screw_wind_up,       ///< friction against the stiffness of a long screw: backlash-slope
  dead_path_air,       ///< refractive index of the uncompensated path: zero-drift
  leaning_instrument,  ///< tripod that warms slowly: zero-drift
  screw_heating,       ///< heat equation in a screw that levels off: warm-up
  slow_heating,        ///< two bodies much slower than the measurement: growth-drift
  wrong_expansion,     ///< coefficient wrong, temperature follows the room: temperature
  optics_slip,         ///< step with a short creep: run-jump
  eccentric_scale,     ///< exact geometry: eccentricity
  tilted_scale,        ///< exact geometry: harmonic2
  worm_mesh,           ///< tooth error, not quite a sine: gear-mesh
  unbalance_wind_up,   ///< friction that follows a rotating weight: elastic-reversal
  shop_day,            ///< screw or scale follows the shop's day and night: day-wave
  dent,                ///< outside: one target
  creeping_reversal,   ///< outside: lost motion that grows from zero
  sawtooth,            ///< outside: a scale of sections that do not meet
  zero_walk,           ///< outside: random walk of the zero
  travel_hysteresis,   ///< outside: reversal that depends on the travel since turning
  wild_run,            ///< unrepeatable: one run scatters much more
  contradiction,       ///< unrepeatable: readings fall into one of two states
};
const char* to_text(Source source);
/// Kind of the catalogue, "scale"; empty if outside.
std::string kind_of(Source source);

enum class Kind {
  one,                 ///< one hidden effect, 3.5 to 9 times the noise
  several,             ///< two or three, 1.6 to 4 times the noise, 1 % misreadings
  complete,            ///< the model holds all that is there
  outside,             ///< something outside the catalogue, with up to two effects of the model
  wave_under_curve,    ///< a lead error; the model holds the screw's ground pitch
  screw_and_curve,     ///< both hidden
  beside,              ///< one of 6 to 9 times the noise, and something outside of 2.5 to 4
  grouped,             ///< one; the file lists all runs towards + before those towards -, no times
  fixed_end,           ///< one that grows (warm-up, temperature, growth) from a bearing at an end
  blank_temperatures,  ///< a wrong expansion; some rows have no temperature
  day_wave,            ///< a day's wave over 8 to 30 hours
  smallest,            ///< one, to be made as large as `explain` says that it would be found
  short_misread,       ///< one that a single run of 10 to 12 readings shows, one of them misread
  short_complete,      ///< such a run, and nothing that the model does not hold
};

struct Piece {
  Source source;
  double size;  ///< RMS of its noiseless deviation, mean taken out, in units of the noise
};

/// How the noise differs from independent readings of one scatter.
struct Unrest {
  double correlation = 0.0;  ///< of a reading with the one before: AR(1), on through all passes
  double run_zero = 0.0;     ///< each run its own zero: standard deviation in units of the noise
  double walk = 0.0;         ///< of the zero, RMS about its mean in units of the noise
  double rough = 1.0;        ///< a stretch of a quarter to a half scatters so many times as much
  double digit = 0.0;        ///< last digit of the display in units of the noise; 0: fine
};

/// One campaign as it is to be made.
struct Scenario {
  Kind kind = Kind::one;
  std::uint64_t seed = 0;
  bool rotary = false;
  std::size_t targets = 21;
  double length = 1.0;  ///< of the measured stretch, m; 2 pi on a rotary axis
  bool even = false;    ///< targets at equal distances
  std::uint32_t runs = 3;
  bool timed = true;
  bool temperatures = false;  ///< the readings have a material temperature
  double dwell = 4.0;         ///< at each target, s
  double feed = 0.1;          ///< m/s or rad/s
  double pause = 0.0;         ///< before each further run, s; 0 if not timed
  double pitch = 0.01;        ///< of the screw, m
  bool pitch_known = true;    ///< the manifest gives pitch or teeth
  int teeth = 90;
  /// Point of the screw or scale that stays where it is, from the middle of the stretch, in
  /// lengths of the stretch.
  double fixed = 0.0;
  bool one_way = false;      ///< the targets are met from one side only
  double noise = 5e-7;       ///< standard deviation of a reading, m or rad
  double misread = 0.0;      ///< share of readings that are wrong by 8 to 40 times the noise
  bool one_misread = false;  ///< instead: exactly one
  Unrest unrest{};
  std::vector<Piece> model;   ///< causes that the campaign's model holds already
  std::vector<Piece> hidden;  ///< causes that it does not
};

/// Random, the same for the same seed; nothing in it that the readings cannot show.
Scenario random_scenario(Kind kind, std::uint64_t seed);

/// What is true of a parameter of the catalogue: least squares of its columns on the noiseless
/// deviation of that cause alone.
struct TrueValue {
  std::string effect, name;  ///< "backlash:X", "b"
  double value = 0.0;        ///< SI
};

struct Truth {
  std::vector<std::string> model, hidden;  ///< effects, "backlash:X"
  std::string verdict;                     ///< missing, nothing, unknown, unrepeatable
  std::vector<std::string> places;         ///< outside: each of these is right; the best first
  std::optional<double> at;                ///< where it sits, m, rad or s
  std::vector<TrueValue> values;
  /// What the named effects leave of their causes, RMS in units of the noise; NaN where that takes
  /// a search (pitch-curve).
  std::vector<double> imperfection;
};

struct Hidden {
  Scenario scenario;
  Campaign campaign;  ///< one measurement, axis X or C; model as in the truth
  Observations table;
  std::vector<std::vector<double>> causes;  ///< noiseless deviation of model, then of hidden pieces
  std::vector<std::size_t> misread;         ///< rows
  Truth truth;
};

Hidden generate(const Scenario& scenario);

/// A thermal test of the axis: its screw, exercised from cold for five time constants and read at
/// both ends and in the middle, with another size, another point that stays where it is, another
/// set-up and zero than the campaign's runs. `times`: the screw has so many times the time constant
/// of the runs' (a test that does not belong to them). Of a linear axis.
Observations thermal_test(const Scenario& scenario, double times);

/// campaign.toml and readings into `folder`, the truth into the file `truth` (JSON).
Expected<void> write(const Hidden& hidden, const std::filesystem::path& folder,
                     const std::filesystem::path& truth);

}  // namespace nonio::hidden
