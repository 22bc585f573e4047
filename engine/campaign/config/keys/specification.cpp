// SPDX-License-Identifier: Apache-2.0
#include "campaign/config/keys/shared.h"

namespace nonio::config {
namespace declared {

constexpr Range from_0 = from(0.0, "expected a number from 0");
constexpr Unit percent{"%", 0.01}, degC{"degC"}, K_per_h{"K/h", 1.0 / 3600.0};
// Lists of kinds of cycles in which a key is allowed. The kind follows from measurement and axis.
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
    {"fraction", number, "Share of the readings that are misread.", from_0},
    {"size", numbers, "Range of a misreading, times the noise."},
};

constexpr Key temperature_keys[] = {
    {"start_c", number, "Temperature at the start.", degC},
    {"drift_K_per_h", number, "Drift.", K_per_h},
    {"swing_K", number, "Amplitude of the swing.", K},
    {"period_s", number, "Period of the swing.", seconds, above_0},
};

constexpr Choice orders[] = {{"pendulum"}, {"unidirectional"}};
constexpr Choice directions[] = {{"+"}, {"-"}};
constexpr Choice sensors[] = {
    {"turns"}, {"stationary"}, {"probe"}, {"stands", "former name of stationary"}};
constexpr Choice carried[] = {{"table"}, {"head"}};
/// Allows a key only in cycles of these kinds.
constexpr auto of(std::span<const Words> kinds) { return only({cycle_axis, kinds}); }

constexpr Key cycle_keys[] = {
    {"measurement", text, "Id of the simulated measurement.", required},
    {"targets_mm", numbers, "Targets, ascending.", mm, of(with_mm)},
    {"targets_deg", numbers, "Targets, ascending.", deg, of(with_deg)},
    {"from_mm", number, "First target.", Unit{"mm"}, of(with_mm)},
    {"from_deg", number, "First target.", Unit{"deg"}, of(with_deg)},
    {"to_mm", number, "End of the targets.", Unit{"mm"}, of(with_mm)},
    {"to_deg", number, "End of the targets.", Unit{"deg"}, of(with_deg)},
    {"step_mm", number, "Distance of targets.", Unit{"mm"}, of(with_mm)},
    {"step_deg", number, "Distance of targets.", Unit{"deg"}, of(with_deg)},
    {"random_offset_pct", number, "Largest shift of a target, as a part of the step.", from_0,
     percent, of(by_targets)},
    {"order", text,
     "Each run upwards and then downwards (a circle counter-clockwise and then clockwise), or all "
     "runs in one direction.",
     orders, of(in_order)},
    {"direction", text, "Direction of unidirectional runs; of a circle + is counter-clockwise.",
     directions, of(in_order)},
    {"steps", whole,
     "Equal steps along a diagonal, in place of targets; of a step diagonal the moves of each "
     "axis.",
     within(1, 10000, "expected 1 to 10000 steps"), of(stepwise)},
    {"readings", whole, "Readings of a turn, evenly spaced. Default: 720.",
     within(24, 100000, "expected 24 to 100000 readings"), of(circle_cycle)},
    {"set_up_urad", number,
     "Angle between the straightedge or beam and the axis: a slope of the readings.", urad,
     of(straightness_cycle)},
    {"ball_mm", numbers,
     "Place of the ball in machine coordinates with the axis at 0, [X, Y, Z]; of a further ball "
     "three numbers more.",
     mm, of(with_balls)},
    {"carrier", text,
     "Another rotary axis, which turned too: the table or head that carries this one, or the head "
     "in addition to this table.",
     of(centres_cycle)},
    {"carrier_deg", numbers, "Positions of the carrier: all targets at each of them.", deg,
     of(centres_cycle)},
    {"sensor", text,
     "A gauge that turns with the axis, a stationary gauge, or a probe that finds the whole "
     "centre.",
     sensors, of(rtcp_cycle)},
    {"sense", numbers,
     "Direction in which a gauge senses with the axis at 0, [1, 0, 0]; of a further gauge three "
     "numbers more.",
     of(rtcp_cycle)},
    {"ball_offset_um", numbers,
     "How far the ball was from where the control takes it to be, [X, Y, Z] with the axis at 0.",
     um, of(rtcp_cycle)},
    {"runs", whole, "Number of runs.", within(1, 100000, "expected 1 to 100000")},
    {"feed_mm_per_min", number, "Feed to the next target.", mm_per_min, above_0, of(moving_mm)},
    {"feed_deg_per_min", number, "Feed to the next target.", deg_per_min, above_0, of(with_deg)},
    {"dwell_s", number, "Dwell at a target.", seconds, from_0},
    {"pause_s", number, "Pause before each further run.", seconds, from_0},
    {"times", flag, "Whether the file has times."},
    {"noise_um", number, "Standard deviation of a reading.", um, from_0, of(in_um)},
    {"noise_arcsec", number, "Standard deviation of a reading.", arcsec, from_0, of(rotary)},
    {"misreadings", table, "Misreadings.", misreading_keys},
    {"temperature", table, "Temperature over time.", temperature_keys},
};

constexpr Key simulated_rotary_keys[] = {
    {"axis", text, "The rotary axis.", required},
    {"centre_mm", numbers, "A point of the axis as it is, in machine coordinates.", required, mm},
    {"direction", numbers, "Its direction: positive angles turn right-handed about it.", required},
    {"control_centre_mm", numbers, "The point that the control has of it (rtcp).", mm},
    {"control_direction", numbers, "The direction that the control has of it (rtcp)."},
    {"carries", text,
     "What the axis turns: the table or the head. Needed for rtcp; ball-centres: table.", carried},
};

constexpr Key simulated_square_keys[] = {
    {"name", text, "The [[square]].", required},
    {"error_urad", number, "Error of its angle: positive is over 90 deg.", urad},
    {"set_up_urad", number,
     "Its angle to the first axis, positive from the first axis to the second.", urad},
};

constexpr Key simulation_keys[] = {
    {"seed", whole, "The same seed gives the same readings."},
    {"rotary", tables, "A rotary axis, exact, for ball-centres and rtcp.", simulated_rotary_keys},
    {"square", tables, "A square as it is.", simulated_square_keys},
    {"formula", tables_of<Formula>, "A hidden effect, as a formula.", formula_keys},
};

/// All other keys of the table are parameters of the named effect.
constexpr Key effect_keys[] = {
    {"name", text, "The effect, \"kind:axis\".", required},
};
constexpr Key specification_keys[] = {
    {"simulation", table, "Seed and hidden formulas.", missing("[simulation] with a seed"),
     simulation_keys},
    {"cycle", tables, "Test cycle of a measurement.", cycle_keys},
    {"effect", tables, "A known effect.", effect_keys},
};

constexpr Key specification_toml = {"specification", table,
                                    "Specification of a simulated campaign.", specification_keys};

}  // namespace declared

const Key& specification_file() { return declared::specification_toml; }

}  // namespace nonio::config
