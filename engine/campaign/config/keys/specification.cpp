// SPDX-License-Identifier: Apache-2.0
#include "campaign/config/keys/shared.h"

namespace nonio::config {
namespace declared {

constexpr Words from_0 = "expected a number from 0";
// A cycle is of one of these, by the kind of its measurement and axis.
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
    {.name = "fraction",
     .holds = number,
     .help = "Share of the readings that are misread.",
     .wanted = from_0,
     .least = 0.0},
    {"size", numbers, "Range of a misreading, times the noise."},
};

constexpr Key temperature_keys[] = {
    {.name = "start_c", .holds = number, .help = "Temperature at the start.", .unit = "degC"},
    {.name = "drift_K_per_h", .holds = number, .help = "Drift.", .unit = "K/h"},
    {.name = "swing_K", .holds = number, .help = "Amplitude of the swing.", .unit = "K"},
    {.name = "period_s",
     .holds = number,
     .help = "Period of the swing.",
     .unit = "s",
     .wanted = above_0,
     .least = 0.0,
     .above = true},
};

constexpr Choice orders[] = {{"pendulum"}, {"unidirectional"}};
constexpr Choice directions[] = {{"+"}, {"-"}};
constexpr Choice sensors[] = {{"turns"}, {"stands"}, {"probe"}};
constexpr Choice carried[] = {{"table"}, {"head"}};
/// A key of cycles of these kinds.
constexpr Key of_kinds(Key key, std::span<const Words> kinds, std::string_view unit = {}) {
  key.unit = unit;
  key.only = {cycle_axis, kinds};
  return key;
}

constexpr Key feed(std::string_view name) {
  return {.name = name,
          .holds = number,
          .help = "Feed to the next target.",
          .wanted = above_0,
          .least = 0.0,
          .above = true};
}

constexpr Key noise(std::string_view name) {
  return {.name = name,
          .holds = number,
          .help = "Standard deviation of a reading.",
          .wanted = from_0,
          .least = 0.0};
}

constexpr Key cycle_keys[] = {
    {.name = "measurement",
     .holds = text,
     .help = "Id of the simulated measurement.",
     .required = true},
    of_kinds({"targets_mm", numbers, "Targets, ascending."}, with_mm, "mm"),
    of_kinds({"targets_deg", numbers, "Targets, ascending."}, with_deg, "deg"),
    of_kinds({"from_mm", number, "First target."}, with_mm, "mm"),
    of_kinds({"from_deg", number, "First target."}, with_deg, "deg"),
    of_kinds({"to_mm", number, "End of the targets."}, with_mm, "mm"),
    of_kinds({"to_deg", number, "End of the targets."}, with_deg, "deg"),
    of_kinds({"step_mm", number, "Distance of targets."}, with_mm, "mm"),
    of_kinds({"step_deg", number, "Distance of targets."}, with_deg, "deg"),
    of_kinds({.name = "random_offset_pct",
              .holds = number,
              .help = "Largest shift of a target, as a part of the step.",
              .wanted = from_0,
              .least = 0.0},
             by_targets, "%"),
    of_kinds({.name = "order",
              .holds = text,
              .help = "Each run upwards and then downwards (a circle counter-clockwise and then "
                      "clockwise), or all runs in one direction.",
              .choices = orders},
             in_order),
    of_kinds({.name = "direction",
              .holds = text,
              .help = "Direction of unidirectional runs; of a circle + is counter-clockwise.",
              .choices = directions},
             in_order),
    of_kinds({.name = "steps",
              .holds = whole,
              .help = "Equal steps along a diagonal, in place of targets; of a step diagonal the "
                      "moves of each axis.",
              .wanted = "expected 1 to 10000 steps",
              .least = 1,
              .most = 10000},
             stepwise),
    of_kinds({.name = "readings",
              .holds = whole,
              .help = "Readings of a turn, evenly spaced. Default: 720.",
              .wanted = "expected 24 to 100000 readings",
              .least = 24,
              .most = 100000},
             circle_cycle),
    of_kinds({"set_up_urad", number,
              "Angle between the straightedge or beam and the axis: a slope of the readings."},
             straightness_cycle, "urad"),
    of_kinds({"ball_mm", numbers,
              "Place of the ball in machine coordinates with the axis at 0, [X, Y, Z]; "
              "of a further ball three numbers more."},
             with_balls, "mm"),
    of_kinds({"carrier", text,
              "Another rotary axis, which turned too: the table or head that carries this "
              "one, or the head in addition to this table."},
             centres_cycle),
    of_kinds({"carrier_deg", numbers, "Positions of the carrier: all targets at each of them."},
             centres_cycle, "deg"),
    of_kinds({.name = "sensor",
              .holds = text,
              .help = "A gauge that turns with the axis, a stationary gauge, or a probe "
                      "that finds the whole centre.",
              .choices = sensors},
             rtcp_cycle),
    of_kinds({"sense", numbers,
              "Direction in which a gauge senses with the axis at 0, [1, 0, 0]; of a "
              "further gauge three numbers more."},
             rtcp_cycle),
    of_kinds({"ball_offset_um", numbers,
              "How far the ball was from where the control takes it to be, [X, Y, Z] with "
              "the axis at 0."},
             rtcp_cycle, "um"),
    {.name = "runs",
     .holds = whole,
     .help = "Number of runs.",
     .wanted = "expected 1 to 100000",
     .least = 1,
     .most = 100000},
    of_kinds(feed("feed_mm_per_min"), moving_mm, "mm/min"),
    of_kinds(feed("feed_deg_per_min"), with_deg, "deg/min"),
    {.name = "dwell_s",
     .holds = number,
     .help = "Dwell at a target.",
     .unit = "s",
     .wanted = from_0,
     .least = 0.0},
    {.name = "pause_s",
     .holds = number,
     .help = "Pause before each further run.",
     .unit = "s",
     .wanted = from_0,
     .least = 0.0},
    {"times", flag, "Whether the file has times."},
    of_kinds(noise("noise_um"), in_um, "um"),
    of_kinds(noise("noise_arcsec"), rotary, "arcsec"),
    {.name = "misreadings", .holds = table, .help = "Misreadings.", .keys = misreading_keys},
    {.name = "temperature",
     .holds = table,
     .help = "Temperature over time.",
     .keys = temperature_keys},
};

constexpr Key simulated_rotary_keys[] = {
    {.name = "axis", .holds = text, .help = "The rotary axis.", .required = true},
    {.name = "centre_mm",
     .holds = numbers,
     .help = "A point of the axis as it is, in machine coordinates.",
     .unit = "mm",
     .required = true},
    {.name = "direction",
     .holds = numbers,
     .help = "Its direction: positive angles turn right-handed about it.",
     .required = true},
    {.name = "control_centre_mm",
     .holds = numbers,
     .help = "The point that the control has of it (rtcp).",
     .unit = "mm"},
    {"control_direction", numbers, "The direction that the control has of it (rtcp)."},
    {.name = "carries",
     .holds = text,
     .help = "What the axis turns: the table or the head. Needed for rtcp; ball-centres: table.",
     .choices = carried},
};

constexpr Key simulated_square_keys[] = {
    {.name = "name", .holds = text, .help = "The [[square]].", .required = true},
    {.name = "error_urad",
     .holds = number,
     .help = "Error of its angle: positive is over 90 deg.",
     .unit = "urad"},
    {.name = "set_up_urad",
     .holds = number,
     .help = "Its angle to the first axis, positive from the first axis to the second.",
     .unit = "urad"},
};

constexpr Key simulation_keys[] = {
    {"seed", whole, "The same seed gives the same readings."},
    {.name = "rotary",
     .holds = tables,
     .help = "A rotary axis, exact, for ball-centres and rtcp.",
     .keys = simulated_rotary_keys},
    {.name = "square",
     .holds = tables,
     .help = "A square as it is.",
     .keys = simulated_square_keys},
    {.name = "formula",
     .holds = tables,
     .help = "A hidden effect, as a formula.",
     .keys = formula_keys},
};

/// The others are parameters of the effect that it names.
constexpr Key effect_keys[] = {
    {.name = "name", .holds = text, .help = "The effect, \"kind:axis\".", .required = true},
};
constexpr Key specification_keys[] = {
    {.name = "simulation",
     .holds = table,
     .help = "Seed and hidden formulas.",
     .required = true,
     .missing = "[simulation] with a seed",
     .keys = simulation_keys},
    {.name = "cycle", .holds = tables, .help = "Test cycle of a measurement.", .keys = cycle_keys},
    {.name = "effect", .holds = tables, .help = "A known effect.", .keys = effect_keys},
};

constexpr Key specification_toml = {.name = "specification",
                                    .holds = table,
                                    .help = "Specification of a simulated campaign.",
                                    .keys = specification_keys};

}  // namespace declared

const Key& specification_file() { return declared::specification_toml; }

}  // namespace nonio::config
