// SPDX-License-Identifier: Apache-2.0
#include "host/config/keys/shared.h"

namespace nonio::host::config {
namespace declared {

constexpr Words from_0 = "expected a number from 0";
constexpr When linear_cycle{cycle_axis, linear}, rotary_cycle{cycle_axis, rotary};
constexpr Key misreading_keys[] = {
    {.name = "fraction",
     .holds = number,
     .help = "Share of the readings that are misread.",
     .wanted = from_0,
     .least = 0.0},
    {.name = "size", .holds = numbers, .help = "Range of a misreading, times the noise."},
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
/// A key of a linear axis' cycle, and that of a rotary one.
constexpr Key of_axis(Key key, std::string_view unit) {
  key.unit = unit;
  key.only = unit.starts_with("mm") || unit == "um" ? linear_cycle : rotary_cycle;
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
    of_axis({.name = "targets_mm", .holds = numbers, .help = "Targets, ascending."}, "mm"),
    of_axis({.name = "targets_deg", .holds = numbers, .help = "Targets, ascending."}, "deg"),
    of_axis({.name = "from_mm", .holds = number, .help = "First target."}, "mm"),
    of_axis({.name = "from_deg", .holds = number, .help = "First target."}, "deg"),
    of_axis({.name = "to_mm", .holds = number, .help = "End of the targets."}, "mm"),
    of_axis({.name = "to_deg", .holds = number, .help = "End of the targets."}, "deg"),
    of_axis({.name = "step_mm", .holds = number, .help = "Distance of targets."}, "mm"),
    of_axis({.name = "step_deg", .holds = number, .help = "Distance of targets."}, "deg"),
    {.name = "random_offset_pct",
     .holds = number,
     .help = "Largest shift of a target, as a part of the step.",
     .unit = "%",
     .wanted = from_0,
     .least = 0.0},
    {.name = "order",
     .holds = text,
     .help = "Each run upwards and then downwards, or all runs in one direction.",
     .choices = orders},
    {.name = "direction",
     .holds = text,
     .help = "Direction of unidirectional runs.",
     .choices = directions},
    {.name = "runs",
     .holds = whole,
     .help = "Number of runs.",
     .wanted = "expected 1 to 100000",
     .least = 1,
     .most = 100000},
    of_axis(feed("feed_mm_per_min"), "mm/min"),
    of_axis(feed("feed_deg_per_min"), "deg/min"),
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
    {.name = "times", .holds = flag, .help = "Whether the file has times."},
    of_axis(noise("noise_um"), "um"),
    of_axis(noise("noise_arcsec"), "arcsec"),
    {.name = "misreadings", .holds = table, .help = "Misreadings.", .keys = misreading_keys},
    {.name = "temperature",
     .holds = table,
     .help = "Temperature over time.",
     .keys = temperature_keys},
};

constexpr Key simulation_keys[] = {
    {.name = "seed", .holds = whole, .help = "The same seed gives the same readings."},
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

}  // namespace nonio::host::config
