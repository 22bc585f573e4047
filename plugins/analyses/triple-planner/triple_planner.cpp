// SPDX-License-Identifier: Apache-2.0
// Plans the targets of two axes and of the diagonals of their rectangle on a common grid.
#include <algorithm>

#include "nonio/math/triples.h"
#include "nonio/sdk/plugin.h"

namespace nonio::triple_planner {

using namespace math;

namespace {

constexpr double mm = 1e-3;

Expected<const Axis*> planned_axis(const CampaignInput& in, const char* option) {
  const std::string name = in.options.text(option);
  const Axis* axis = in.campaign.machine.axis(name);
  if (axis == nullptr) {
    Error error{std::string("option ") + option + ": the machine has no axis \"" + name + "\""};
    error.key = option;
    return fail(std::move(error));
  }
  if (axis->rotary || !axis->travel) {
    Error error{"axis " + name + ": expected a linear axis with its travel, found " +
                (axis->rotary ? "a rotary one" : "no travel")};
    error.key = "machine.axes." + name;
    return fail(std::move(error));
  }
  return axis;
}

std::vector<double> pitches(const Axis& axis, const std::vector<double>& others_mm) {
  std::vector<double> all;
  if (axis.screw_pitch) all.push_back(*axis.screw_pitch);
  for (const double p : others_mm) all.push_back(p * mm);
  return all;
}

TripleRequest wish_of(const Axis& x, const Axis& y, const Settings& o) {
  TripleRequest w;
  w.x = x.travel->second - x.travel->first;
  w.y = y.travel->second - y.travel->first;
  w.over_travel = o.number("over_travel_mm") * mm;
  w.resolution = o.number("resolution_mm") * mm;
  w.largest_step = o.number("max_step_mm") * mm;
  w.max_points = o.integer("max_points");
  w.pitch_x = pitches(x, o.numbers("pitch_x_mm"));
  w.pitch_y = pitches(y, o.numbers("pitch_y_mm"));
  w.density = o.flag("density");
  const std::string even = o.text("even");
  w.even = even == "require"  ? EvenSteps::require
           : even == "prefer" ? EvenSteps::prefer
                              : EvenSteps::any;
  w.hypotenuse = o.integer("hypotenuse");
  w.count = static_cast<std::size_t>(o.integer("count"));
  return w;
}

const char* option_of(TripleLimit limit) {
  switch (limit) {
    case TripleLimit::largest_step:
      return "max_step_mm";
    case TripleLimit::max_points:
      return "max_points";
    case TripleLimit::pitch:
      return "screw_pitch_mm, pitch_x_mm, pitch_y_mm";
    case TripleLimit::density:
      return "density";
    case TripleLimit::even:
      return "even";
    case TripleLimit::hypotenuse:
      return "hypotenuse";
    case TripleLimit::travel:
      break;
  }
  return "travel, resolution_mm";
}

Finding nothing_fits(const TriplePlans& found, const Axis& x, const Axis& y) {
  std::string limits;
  for (const auto* list : {&found.blocked_by, &found.together})
    for (const TripleLimit limit : *list)
      limits += std::string(limits.empty() ? "" : ", ") + option_of(limit);
  return {.id = "triples.nothing-fits",
          .attention = true,
          .texts = {{"x", x.name}, {"y", y.name}, {"limits", limits}}};
}

Remark best_plan(const TriplePlan& p, const Axis& x, const Axis& y) {
  return {.id = "triples.plan",
          .evidence = {{"a", static_cast<double>(p.a), Quantity::count},
                       {"b", static_cast<double>(p.b), Quantity::count},
                       {"c", static_cast<double>(p.c), Quantity::count},
                       {"n", static_cast<double>(p.n), Quantity::count},
                       {"step_x", p.step_x, Quantity::length},
                       {"step_y", p.step_y, Quantity::length},
                       {"step_d", p.step_d, Quantity::length},
                       {"cover_x", 100.0 * p.cover_x, Quantity::ratio},
                       {"cover_y", 100.0 * p.cover_y, Quantity::ratio}},
          .texts = {{"x", x.name}, {"y", y.name}}};
}

Expected<Evaluation> analyse(const CampaignInput& in) {
  const auto x = planned_axis(in, "x"), y = planned_axis(in, "y");
  if (!x) return fail(x.error());
  if (!y) return fail(y.error());
  NONIO_TRY(const auto found, plan_triples(wish_of(**x, **y, in.options)));
  Evaluation e;
  if (found.plans.empty()) {
    e.findings.push_back(nothing_fits(found, **x, **y));
    return e;
  }
  e.rows = triple_table(found.plans);
  const TriplePlan& best = found.plans.front();
  e.notes.push_back(best_plan(best, **x, **y));
  if (best.flat())
    e.findings.push_back(
        {.id = "triples.flat",
         .evidence = {{"gain", std::max(best.gain_EYX(), best.gain_EXY()), Quantity::ratio}}});
  return e;
}

std::vector<Option> options() {
  return {
      {"x", std::string("X"), "", "The axis of leg a."},
      {"y", std::string("Y"), "", "The axis of leg b."},
      at_least(0.0, {"over_travel_mm", 0.0, "mm", "Kept free at each end of both axes."}),
      at_least(1e-6, {"resolution_mm", 1.0, "mm", "Steps are whole multiples of it."}),
      at_least(0.0, {"max_step_mm", 0.0, "mm", "Largest step of either axis; 0: any."}),
      at_least(5.0, {"max_points", std::int64_t{1500}, "", "Entries of the control's table."}),
      {"pitch_x_mm", std::vector<double>{}, "mm",
       "Pitches of x, in addition to its screw_pitch_mm, of which no step is a whole multiple."},
      {"pitch_y_mm", std::vector<double>{}, "mm", "The same of y."},
      {"density", false, "", "Only stops that are an ISO 230-2 sampling of both axes."},
      one_of({"any", "prefer", "require"},
             {"even", std::string("any"), "",
              "An even number of steps, for a diagonal to half of y."}),
      within(5.0, 1e6, {"hypotenuse", std::int64_t{5000}, "", "Largest c of the triples."}),
      within(1.0, 1000.0, {"count", std::int64_t{5}, "", "Plans to give."})};
}

}  // namespace

NONIO_PLUGIN(registry) {
  Analysis a;
  a.info = {"triple-planner", "1.0.0",
            "Stops for two axes and both diagonals of their rectangle, with equal whole steps.",
            options(), true};
  a.analyse_campaign = analyse;
  a.states_followed = true;
  registry.add(std::move(a));
}

}  // namespace nonio::triple_planner
