// SPDX-License-Identifier: Apache-2.0
#include <unistd.h>

#include <algorithm>
#include <iostream>
#include <memory>
#include <numbers>
#include <optional>

#include "axis_argument.h"
#include "campaign/planning/plan.h"
#include "nonio/sdk/format.h"
#include "platform/storage/json_values.h"
#include "site_words.h"
#include "text_layout.h"
#include "verbs.h"

namespace nonio::app {

namespace {

struct RotaryWish {
  std::string axis, radius, language = "en";
  double arc = 360.0, probe_u = 0.0, want_centre = 0.0, want_direction = 0.0;
  std::int64_t balls = 4, trials = 2000;
  std::uint64_t seed = 1;
};

using planning::RotaryRow;

constexpr double um_of_m = 1e6;

std::vector<std::string> cells_of(const RotaryRow& row, const std::string& language) {
  const math::RotaryPlanU& u = row.u;
  std::vector<std::string> cells{std::to_string(row.plan.balls),
                                 evidence_text({"", row.plan.radius, Quantity::length})};
  for (const double m : {2.0 * u.across, 2.0 * u.along, u.centre_rms, u.centre_mean})
    cells.push_back(fixed_text(um_of_m * m, 2));
  for (const double rad : {2.0 * u.tilt, u.direction_rms, u.direction_mean})
    cells.push_back(fixed_text(um_of_m * rad, 1));
  for (std::string& cell : cells) cell = localised(std::move(cell), language);
  return cells;
}

storage::Json json_of(const RotaryRow& row) {
  const math::RotaryPlanU& u = row.u;
  return {{"balls", row.plan.balls},
          {"radius_mm", 1e3 * row.plan.radius},
          {"U_across_um", um_of_m * 2.0 * u.across},
          {"U_along_um", um_of_m * 2.0 * u.along},
          {"centre_rms_um", um_of_m * u.centre_rms},
          {"centre_mean_um", um_of_m * u.centre_mean},
          {"U_tilt_urad", um_of_m * 2.0 * u.tilt},
          {"direction_rms_urad", um_of_m * u.direction_rms},
          {"direction_mean_urad", um_of_m * u.direction_mean}};
}

using Fewest = std::optional<Expected<std::size_t>>;

void print_rotary_json(const RotaryWish& wish, const std::vector<RotaryRow>& rows,
                       double two_points, const Fewest& fewest) {
  storage::Json out{{"schema", "nonio-rotary-plan/1"}, {"axis", wish.axis},
                    {"probe_u_um", wish.probe_u},      {"arc_deg", wish.arc},
                    {"trials", wish.trials},           {"seed", wish.seed},
                    {"U_two_points_um", two_points}};
  for (const RotaryRow& row : rows) out["plans"].push_back(json_of(row));
  if (fewest && *fewest) out["fewest_balls"] = **fewest;
  print_json(out);
}

void print_plans_of(const RotaryWish& wish, const std::vector<RotaryRow>& rows, double two_points,
                    const Fewest& fewest, const config::TerminalWords& say) {
  const std::size_t width = line_width(STDOUT_FILENO);
  const auto number = [&](double x, int decimals) {
    return localised(fixed_text(x, decimals), say.language());
  };
  std::cout << wrapped(say("rotary.wish", {{"axis", wish.axis},
                                           {"u", number(wish.probe_u, 2)},
                                           {"arc", number(wish.arc, 1)},
                                           {"count", std::to_string(wish.trials)},
                                           {"seed", std::to_string(wish.seed)}}),
                       0, width)
            << "\n";
  std::vector<std::vector<std::string>> cells{
      {say("rotary.balls"), "R mm", say("rotary.across"), say("rotary.along"), say("rotary.rms"),
       say("rotary.mean"), say("rotary.tilt"), say("rotary.rms-direction"),
       say("rotary.mean-direction")}};
  for (const RotaryRow& row : rows) cells.push_back(cells_of(row, say.language()));
  const std::vector<std::string> lines = table_rows(cells, width);
  for (std::size_t i = 0; i < lines.size(); ++i) std::cout << lines[i] << (i == 1 ? "\n" : "");
  std::cout << "\n"
            << wrapped(say("rotary.legend", {{"U", number(two_points, 2)}}), 0, width)
            << wrapped(say("rotary.not-contained"), 0, width);
  if (fewest && *fewest)
    std::cout << wrapped(say("rotary.fewest", {{"count", std::to_string(**fewest)}}), 0, width);
}

int plan_rotary(const RotaryWish& wish, const Common& common) {
  const Axis axis = axis_named(wish.axis);
  if (!is_axis_name(wish.axis) || !axis.rotary)
    return complain("--axis: expected a rotary axis (A, B or C), found \"" + wish.axis + "\"");
  const auto radius = length_of("--radius", wish.radius);
  if (!radius) return complain(radius.error().message);
  math::RotaryPlan own;
  own.balls = static_cast<std::size_t>(std::max<std::int64_t>(0, wish.balls));
  own.radius = *radius;
  own.arc = wish.arc * std::numbers::pi / 180.0;
  own.sigma = wish.probe_u / um_of_m;
  const auto rows = planning::rotary_rows(own, static_cast<std::size_t>(wish.trials), wish.seed);
  if (!rows) return complain(rows.error().message);
  Fewest fewest;
  if (wish.want_centre > 0.0 || wish.want_direction > 0.0)
    fewest = planning::fewest_balls(own, wish.want_centre / um_of_m, wish.want_direction / um_of_m);
  const double two_points = 2.0 * wish.probe_u / std::numbers::sqrt2;
  if (common.json)
    print_rotary_json(wish, *rows, two_points, fewest);
  else
    print_plans_of(wish, *rows, two_points, fewest, SiteWords(common, wish.language).get());
  if (fewest && !*fewest) return complain(fewest->error().message, exit_failed);
  return exit_done;
}

}  // namespace

Verb plan_rotary_verb(Common& common) {
  auto wish = std::make_shared<RotaryWish>();
  return {
      .name = "rotary",
      .summary = "U of a rotary axis's centre and direction from balls, before the measurement",
      .arguments = joined(
          {required({"--axis", &wish->axis, "The rotary axis: A, B or C"}),
           required(number({"--radius", &wish->radius, "Distance of the ball from the axis, mm"})),
           required(within(0.001, 1000.0,
                           {"--probe-u", &wish->probe_u,
                            "Standard uncertainty of one coordinate of a ball's centre, um"})),
           within(3, 1000, {"--balls", &wish->balls, "Positions of the axis (default 4)"}),
           within(1.0, 360.0, {"--arc", &wish->arc, "Range of the axis, deg (default 360)"}),
           within(0.0, 1e4,
                  {"--want-centre", &wish->want_centre,
                   "Wanted U (k = 2) of the centre across the axis, um: prints the fewest balls"}),
           within(0.0, 1e5,
                  {"--want-direction", &wish->want_direction,
                   "Wanted U (k = 2) of the direction, urad: prints the fewest balls"}),
           within(10, 1000000,
                  {"--trials", &wish->trials, "Simulated measurements (default 2000)"}),
           {"--seed", &wish->seed, "Seed of the simulation (default 1)"},
           one_of({"de", "en", "it"}, {"--language", &wish->language, "Language of the text"}),
           templates_argument(common)},
          common_arguments(common)),
      .footer =
          "A larger radius helps the direction only; more balls help both, with the root of their "
          "number. An arc of less than half a turn costs far more than fewer balls do.\n\nExit "
          "status: 0; 1 no number of balls reaches the wanted U; 2 usage.",
      .examples =
          {"nonio plan rotary --axis C --balls 5 --radius 250 --probe-u 1.5 --want-centre 2"},
      .run = [wish, &common] { return plan_rotary(*wish, common); }};
}

}  // namespace nonio::app
