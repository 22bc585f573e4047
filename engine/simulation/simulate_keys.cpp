// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>

#include "campaign/config/keys/shared.h"
#include "platform/storage/nearest.h"
#include "simulation/simulate_spec.h"

namespace nonio::simulation {

namespace {
namespace declared {

using namespace config::declared;
using config::Choice, config::Key, config::declared::Unit;
using Cycle = CycleSpec;
using Course = TemperatureCourse;

constexpr Range from_0 = from(0.0, "expected a number from 0");
constexpr Unit percent{"%", 0.01}, degC{"degC"}, K_per_h{"K/h", 1.0 / 3600.0};
// Kinds of cycles in which a key is allowed. The kind follows from measurement and axis.
constexpr Words with_mm[] = {"linear", "straightness", "diagonal"};
constexpr Words with_deg[] = {"rotary", "ball-centres", "rtcp"};
constexpr Words in_um[] = {"linear",       "straightness", "diagonal", "step-diagonal",
                           "ball-centres", "rtcp",         "circle"};
constexpr Words moving_mm[] = {"linear", "straightness", "diagonal", "step-diagonal"};
constexpr Words by_targets[] = {"linear",   "rotary",       "straightness",
                                "diagonal", "ball-centres", "rtcp"};
constexpr Words in_order[] = {"linear",       "rotary", "straightness", "diagonal",
                              "ball-centres", "rtcp",   "circle"};
constexpr Words stepwise[] = {"diagonal", "step-diagonal"};
constexpr Words step_diagonal_cycle[] = {"step-diagonal"}, straightness_cycle[] = {"straightness"};
constexpr Words with_balls[] = {"ball-centres", "rtcp"}, rtcp_cycle[] = {"rtcp"},
                circle_cycle[] = {"circle"}, centres_cycle[] = {"ball-centres"};
constexpr Key misreading_keys[] = {
    {"fraction", into<&Cycle::misread>, "Share of the readings that are misread.",
     within(0.0, 1.0, "expected 0 to 1")},
    {"size", into<&Cycle::misread_size>, "Range of a misreading, times the noise.",
     from(0.0, "expected two numbers, times the noise, the smaller one first")},
};

constexpr Key temperature_keys[] = {
    {"start_c", into<&Course::start>, "Temperature at the start.", degC},
    {"drift_K_per_h", into<&Course::drift>, "Drift.", K_per_h},
    {"swing_K", into<&Course::swing>, "Amplitude of the swing.", K},
    {"period_s", into<&Course::period>, "Period of the swing.", seconds, above_0},
};

constexpr Choice orders[] = {choice(true, "pendulum"), choice(false, "unidirectional")};
constexpr Choice directions[] = {choice(1, "+"), choice(-1, "-")};
constexpr Choice sensors[] = {
    {"turns"}, {"stationary"}, {"probe"}, {"stands", "former name of stationary"}};
constexpr Choice carried[] = {{"table"}, {"head"}};
constexpr auto of(std::span<const Words> kinds) { return only({config::cycle_axis, kinds}); }

constexpr Key cycle_keys[] = {
    {"measurement", into<&Cycle::measurement, &Measurement::id>, "Id of the simulated measurement.",
     required},
    {"targets_mm", into<&Cycle::targets>, "Targets, ascending.", mm, of(with_mm)},
    {"targets_deg", into<&Cycle::targets>, "Targets, ascending.", deg, of(with_deg)},
    {"from_mm", into<&Cycle::first>, "First target.", Unit{"mm"}, of(with_mm)},
    {"from_deg", into<&Cycle::first>, "First target.", Unit{"deg"}, of(with_deg)},
    {"to_mm", into<&Cycle::last>, "End of the targets.", Unit{"mm"}, of(with_mm)},
    {"to_deg", into<&Cycle::last>, "End of the targets.", Unit{"deg"}, of(with_deg)},
    {"step_mm", into<&Cycle::distance>, "Distance of targets.", Unit{"mm"}, of(with_mm)},
    {"step_deg", into<&Cycle::distance>, "Distance of targets.", Unit{"deg"}, of(with_deg)},
    {"random_offset_pct", into<&Cycle::offset>, "Largest shift of a target, as a part of the step.",
     from_0, percent, of(by_targets)},
    {"order", chosen<&Cycle::pendulum>,
     "Each run upwards and then downwards (a circle counter-clockwise and then clockwise), or all "
     "runs in one direction.",
     orders, of(in_order)},
    {"direction", chosen<&Cycle::direction>,
     "Direction of unidirectional runs; of a circle + is counter-clockwise.", directions,
     of(in_order)},
    {"steps", into<&Cycle::steps>,
     "Equal steps along a diagonal, in place of targets; of a step diagonal the moves of each "
     "axis.",
     within(1, 10000, "expected 1 to 10000 steps"), of(stepwise)},
    {"readings", into<&Cycle::readings>, "Readings of a turn, evenly spaced. Default: 720.",
     within(24, 100000, "expected 24 to 100000 readings"), of(circle_cycle)},
    {"set_up_urad", into<&Cycle::set_up>,
     "Angle between the straightedge or beam and the axis: a slope of the readings.", urad,
     of(straightness_cycle)},
    {"ball_mm", by<read_points, numbers, &Cycle::balls>,
     "Place of the ball in machine coordinates with the axis at 0, [X, Y, Z]; of a further ball "
     "three numbers more.",
     mm, of(with_balls)},
    {"carrier", into<&Cycle::carrier>,
     "Another rotary axis, which turned too: the table or head that carries this one, or the head "
     "in addition to this table.",
     of(centres_cycle)},
    {"carrier_deg", into<&Cycle::carrier_at>,
     "Positions of the carrier: all targets at each of them.", deg, of(centres_cycle)},
    {"sensor", into<&Cycle::sensor>,
     "A gauge that turns with the axis, a stationary gauge, or a probe that finds the whole "
     "centre.",
     sensors, of(rtcp_cycle)},
    {"sense", by<read_directions, numbers, &Cycle::senses>,
     "Direction in which a gauge senses with the axis at 0, [1, 0, 0]; of a further gauge three "
     "numbers more.",
     of(rtcp_cycle)},
    {"ball_offset_um", by<read_point, numbers, &Cycle::ball_offset>,
     "How far the ball was from where the control takes it to be, [X, Y, Z] with the axis at 0.",
     um, of(rtcp_cycle)},
    {"runs", into<&Cycle::runs>, "Number of runs.", within(1, 100000, "expected 1 to 100000")},
    {"feed_mm_per_min", into<&Cycle::feed>, "Feed to the next target.", mm_per_min, above_0,
     of(moving_mm)},
    {"feed_deg_per_min", into<&Cycle::feed>, "Feed to the next target.", deg_per_min, above_0,
     of(with_deg)},
    {"dwell_s", into<&Cycle::dwell>, "Dwell at a target.", seconds, from_0},
    {"pause_s", into<&Cycle::pause>, "Pause before each further run.", seconds, from_0},
    {"times", into<&Cycle::timed>, "Whether the file has times."},
    {"noise_um", into<&Cycle::noise>, "Standard deviation of a reading.", um, from_0, of(in_um)},
    {"noise_arcsec", into<&Cycle::noise>, "Standard deviation of a reading.", arcsec, from_0,
     of(rotary)},
    {"misreadings", same<Cycle>, "Misreadings.", misreading_keys},
    {"temperature", nested<&Cycle::temperature>, "Temperature over time.", temperature_keys},
};

constexpr Key simulated_rotary_keys[] = {
    {"axis", into<&RotarySpec::axis>, "The rotary axis.", required},
    {"centre_mm", by<read_point, numbers, &RotarySpec::centre>,
     "A point of the axis as it is, in machine coordinates.", required, mm},
    {"direction", by<read_direction, numbers, &RotarySpec::direction>,
     "Its direction: positive angles turn right-handed about it.", required},
    {"control_centre_mm", by<read_optional_point, numbers, &RotarySpec::control_centre>,
     "The point that the control has of it (rtcp).", mm},
    {"control_direction", by<read_optional_direction, numbers, &RotarySpec::control_direction>,
     "The direction that the control has of it (rtcp)."},
    {"carries", into<&RotarySpec::carries>,
     "What the axis turns: the table or the head. Needed for rtcp; ball-centres: table.", carried},
};

constexpr Key simulated_square_keys[] = {
    {"name", into<&SquareSpec::name>, "The [[square]].", required},
    {"error_urad", into<&SquareSpec::error>, "Error of its angle: positive is over 90 deg.", urad},
    {"set_up_urad", into<&SquareSpec::set_up>,
     "Its angle to the first axis, positive from the first axis to the second.", urad},
};

constexpr Key simulation_keys[] = {
    {"seed", into<&Specification::seed>, "The same seed gives the same readings.",
     missing("a whole number: the same seed gives the same readings")},
    {"rotary", checked<check_rotary, &Specification::rotaries>,
     "A rotary axis, exact, for ball-centres and rtcp.", simulated_rotary_keys},
    {"square", checked<check_square, &Specification::squares>, "A square as it is.",
     simulated_square_keys},
    {"formula", checked<check_hidden, &Specification::hidden>, "A hidden effect, as a formula.",
     formula_keys},
};

constexpr Key effect_keys[] = {
    {"name", into<&EffectSpec::name>, "The effect, \"kind:axis\".", required},
};
constexpr Key specification_keys[] = {
    {"simulation", same<Specification, check_simulation>, "Seed and hidden formulas.",
     missing("[simulation] with a seed"), simulation_keys},
    {"cycle", by<read_cycles, tables, &Specification::cycles>, "Test cycle of a measurement.",
     cycle_keys},
    {"effect", by<read_effects, tables, &Specification::effects>, "A known effect.", effect_keys},
};

constexpr Key specification_toml = {"specification", file<Specification>,
                                    "Specification of a simulated campaign.", specification_keys};

}  // namespace declared
}  // namespace

const config::Key& specification_file() { return declared::specification_toml; }

void read_points(config::TableReader& reader, const config::Key& key, std::vector<Vector>& to) {
  const auto numbers = config::value_of<std::vector<double>>(reader, key);
  if (!numbers) return;
  if (numbers->empty() || numbers->size() % 3 != 0)
    return reader.error(key.name,
                        "expected three numbers, along X, Y and Z, or three more of each further "
                        "one; found " +
                            std::to_string(numbers->size()));
  for (std::size_t i = 0; i < numbers->size(); i += 3)
    to.push_back(
        {key.scale * (*numbers)[i], key.scale * (*numbers)[i + 1], key.scale * (*numbers)[i + 2]});
}

void read_directions(config::TableReader& reader, const config::Key& key, std::vector<Vector>& to) {
  read_points(reader, key, to);
  for (Vector& direction : to) {
    const double size = std::hypot(direction[0], direction[1], direction[2]);
    if (!(size > 0.0)) reader.error(key.name, "expected a direction, found 0, 0, 0");
    for (double& x : direction) x /= size > 0.0 ? size : 1.0;
  }
}

namespace {

template <class To>
void read_one(void (*read)(config::TableReader&, const config::Key&, std::vector<Vector>&),
              config::TableReader& reader, const config::Key& key, To& to) {
  std::vector<Vector> found;
  read(reader, key, found);
  if (found.size() > 1) reader.error(key.name, "expected three numbers");
  if (!found.empty()) to = found.front();
}

}  // namespace

void read_point(config::TableReader& reader, const config::Key& key, Vector& to) {
  read_one(read_points, reader, key, to);
}
void read_direction(config::TableReader& reader, const config::Key& key, Vector& to) {
  read_one(read_directions, reader, key, to);
}
void read_optional_point(config::TableReader& reader, const config::Key& key,
                         std::optional<Vector>& to) {
  read_one(read_points, reader, key, to);
}
void read_optional_direction(config::TableReader& reader, const config::Key& key,
                             std::optional<Vector>& to) {
  read_one(read_directions, reader, key, to);
}

void check_rotary(config::TableReader& reader, RotarySpec& r, Specification& s) {
  std::vector<std::string> axes;
  for (const Axis& axis : s.campaign.machine.axes)
    if (axis.rotary) axes.push_back(axis.name);
  if (!r.axis.empty() && std::find(axes.begin(), axes.end(), r.axis) == axes.end())
    reader.error("axis", "the machine has no rotary axis \"" + r.axis + "\"" +
                             storage::suggestion(r.axis, axes));
  if (s.rotary(r.axis) != &r) reader.error("axis", r.axis + " is given twice");
}

void check_square(config::TableReader& reader, SquareSpec& q, Specification& s) {
  std::vector<std::string> squares;
  for (const Square& square : s.campaign.squares) squares.push_back(square.name);
  if (!q.name.empty() && std::find(squares.begin(), squares.end(), q.name) == squares.end())
    reader.error("name", "no [[square]] is called \"" + q.name + "\"" +
                             storage::suggestion(q.name, squares));
}

}  // namespace nonio::simulation
