// SPDX-License-Identifier: Apache-2.0
#include "campaign/planning/plan.h"

#include <algorithm>
#include <cmath>

#include "nonio/sdk/format.h"
#include "platform/process/guarded.h"
#include "platform/storage/json_values.h"
#include "platform/storage/nearest.h"

namespace nonio::planning {

namespace {

using math::TripleLimit;
using math::TriplePlan;
using math::TripleReason;

const char* to_text(TripleReason reason) {
  switch (reason) {
    case TripleReason::best:
      return "best";
    case TripleReason::area:
      return "area";
    case TripleReason::even:
      return "even";
    case TripleReason::dense:
      return "iso230-2";
    case TripleReason::fewest_stops:
      return "fewest-stops";
    case TripleReason::small_numbers:
      return "small-numbers";
    case TripleReason::next:
      break;
  }
  return "next";
}

std::string words_of(TripleReason reason, const TerminalWords& say) {
  switch (reason) {
    case TripleReason::best:
      return say("triples.best");
    case TripleReason::area:
      return say("triples.area");
    case TripleReason::even:
      return say("triples.even");
    case TripleReason::dense:
      return say("triples.dense");
    case TripleReason::fewest_stops:
      return say("triples.fewest-stops");
    case TripleReason::small_numbers:
      return say("triples.small-numbers");
    case TripleReason::next:
      break;
  }
  return say("triples.next");
}

const char* option_of(TripleLimit limit) {
  switch (limit) {
    case TripleLimit::largest_step:
      return "--max-step";
    case TripleLimit::max_points:
      return "--max-points";
    case TripleLimit::pitch:
      return "--pitch-x, --pitch-y";
    case TripleLimit::density:
      return "--density";
    case TripleLimit::even:
      return "--even";
    case TripleLimit::hypotenuse:
      return "--hypotenuse";
    case TripleLimit::travel:
      break;
  }
  return "--x, --y, --resolution";
}

void append(std::string& list, const std::string& text, const char* between) {
  list += (list.empty() ? "" : between) + text;
}

storage::Json wish_json(const math::TripleRequest& w) {
  const auto in_mm = [](double m) { return printed(m, Quantity::length); };
  const auto all_mm = [&](const std::vector<double>& list) {
    storage::Json out = storage::Json::array();
    for (const double m : list) out.push_back(in_mm(m));
    return out;
  };
  const char* even = w.even == math::EvenSteps::require  ? "require"
                     : w.even == math::EvenSteps::prefer ? "prefer"
                                                         : "any";
  storage::Json json = {{"x_mm", in_mm(w.x)},
                        {"y_mm", in_mm(w.y)},
                        {"over_travel_mm", in_mm(w.over_travel)},
                        {"resolution_mm", in_mm(w.resolution)},
                        {"max_points", w.max_points},
                        {"hypotenuse", w.hypotenuse},
                        {"density", w.density},
                        {"even", even}};
  if (w.resolution_x > 0.0) json["resolution_x_mm"] = in_mm(w.resolution_x);
  if (w.resolution_y > 0.0) json["resolution_y_mm"] = in_mm(w.resolution_y);
  if (w.largest_step > 0.0) json["max_step_mm"] = in_mm(w.largest_step);
  if (!w.pitch_x.empty()) json["pitch_x_mm"] = all_mm(w.pitch_x);
  if (!w.pitch_y.empty()) json["pitch_y_mm"] = all_mm(w.pitch_y);
  return json;
}

storage::Json row_json(const PointTable& table, std::size_t row, const TriplePlan& p,
                       const TriplePlan& best, const TerminalWords& say) {
  storage::Json json;
  for (const PointTable::Column& c : table.columns)
    if (c.quantity == Quantity::count)
      json[c.name] = std::llround(c.values[row]);
    else
      json[c.name] = printed(c.values[row], c.quantity);
  json["even"] = p.even();
  json["iso230_2_sampling"] = p.dense;
  json["reasons"] = storage::Json::array();
  for (const TripleReason r : p.reasons) json["reasons"].push_back(to_text(r));
  json["why"] = why_listed(p, say);
  json["gives_up"] = gives_up(p, best, say);
  if (const std::string warning = aspect_warning(p, say); !warning.empty())
    json["warning"] = warning;
  return json;
}

}  // namespace

std::string why_listed(const TriplePlan& plan, const TerminalWords& say) {
  std::string all;
  for (const TripleReason r : plan.reasons) append(all, words_of(r, say), "; ");
  return all;
}

std::string gives_up(const TriplePlan& plan, const TriplePlan& best, const TerminalWords& say) {
  std::string all;
  const auto less = [&](double share, const char* of) {
    if (share > 1e-9)
      append(all, say(of, {{"percent", localised(fixed_text(100.0 * share, 2), say.language())}}),
             "; ");
  };
  less(best.worst_cover() - plan.worst_cover(), "triples.less-coverage");
  less(1.0 - plan.area() / best.area(), "triples.less-area");
  if (plan.n > best.n)
    append(all, say("triples.more-stops", {{"count", std::to_string(plan.n - best.n)}}), "; ");
  if (!plan.even()) append(all, say("triples.odd"), "; ");
  if (!plan.dense) append(all, say("triples.sparse"), "; ");
  return all.empty() ? say("triples.no-disadvantage") : all;
}

std::string aspect_warning(const TriplePlan& plan, const TerminalWords& say) {
  if (!plan.flat()) return {};
  const bool x_long = plan.length_x > plan.length_y;
  const double gain = std::max(plan.gain_EYX(), plan.gain_EXY());
  return say("triples.flat", {{"axis", x_long ? "X" : "Y"},
                              {"straightness", x_long ? "EYX" : "EXY"},
                              {"gain", localised(fixed_text(gain, 1), say.language())}});
}

std::string why_nothing(const math::TriplePlans& plans, const TerminalWords& say) {
  std::string limits;
  if (!plans.blocked_by.empty()) {
    for (const TripleLimit l : plans.blocked_by) append(limits, option_of(l), ", ");
    return plans.blocked_by.front() == TripleLimit::travel
               ? say("triples.too-short", {{"limits", limits}})
               : say("triples.blocked", {{"limits", limits}});
  }
  for (const TripleLimit l : plans.together) append(limits, option_of(l), "; ");
  return say("triples.blocked-together", {{"limits", limits}});
}

std::string triples_json(const math::TripleRequest& wish, const math::TriplePlans& plans,
                         const TerminalWords& say) {
  storage::Json json = {
      {"schema", "nonio-triples/1"}, {"wish", wish_json(wish)}, {"tried", plans.tried}};
  const PointTable table = math::triple_table(plans.plans);
  json["row_units"] = storage::Json::object();
  for (const PointTable::Column& c : table.columns)
    json["row_units"][c.name] = std::string(unit_of(c.quantity).symbol);
  json["rows"] = storage::Json::array();
  for (std::size_t i = 0; i < plans.plans.size(); ++i)
    json["rows"].push_back(row_json(table, i, plans.plans[i], plans.plans.front(), say));
  if (plans.plans.empty()) json["nothing_fits"] = why_nothing(plans, say);
  return storage::dump(json);
}

config::Checked<std::vector<Artifact>> write_programs(
    const loader::Plugins& plugins, const std::string& output, const Machine& machine,
    const PointTable& rows, const std::map<std::string, std::string>& options,
    const Templates& templates) {
  const auto& all = plugins.outputs();
  // A control such as siemens-840d is written by the plugin of its family, program-siemens.
  const std::string family = "program-" + output.substr(0, output.find('-'));
  const auto found = std::find_if(all.begin(), all.end(), [&](const Output& o) {
    return o.info.name == output || o.info.name == "program-" + output || o.info.name == family;
  });
  const auto wrong = [](std::string message) {
    return tl::unexpected(std::vector<Error>{Error{std::move(message)}});
  };
  if (found == all.end()) {
    std::vector<std::string> names;
    for (const Output& o : all)
      if (o.info.name.starts_with("program-")) names.push_back(o.info.name.substr(8));
    const std::string short_name = output.starts_with("program-") ? output.substr(8) : output;
    return wrong("nothing writes part programs for the control \"" + output + "\"" +
                 storage::suggestion(short_name, names) + "; there are " + storage::listed(names));
  }
  const auto settings = config::options_from(found->info, options);
  if (!settings) return tl::unexpected(settings.error());
  Campaign campaign;
  campaign.machine = machine;
  const std::vector<Observations> none;
  Results results;
  results.analyses.push_back({"plan", "", "", {}});
  results.analyses.back().evaluation.rows = rows;
  auto written = process::guarded("output " + found->info.name, [&] {
    return found->write({campaign, none, results, *settings, templates});
  });
  if (!written) return wrong(written.error().message);
  return std::move(written->artifacts);
}

namespace {

std::vector<math::RotaryPlan> rotary_plans(const math::RotaryPlan& own) {
  std::vector<math::RotaryPlan> out{own};
  for (const double radius : {own.radius, 0.5, 0.05})
    for (const std::size_t balls : {3U, 4U, 5U, 10U}) {
      math::RotaryPlan p = own;
      p.radius = radius;
      p.balls = balls;
      const bool there = std::any_of(out.begin(), out.end(), [&](const math::RotaryPlan& o) {
        return o.balls == balls && std::fabs(o.radius - radius) < 1e-9;
      });
      if (!there) out.push_back(p);
    }
  return out;
}

}  // namespace

Expected<std::vector<RotaryRow>> rotary_rows(const math::RotaryPlan& own, std::size_t trials,
                                             std::uint64_t seed) {
  std::vector<RotaryRow> rows;
  for (const math::RotaryPlan& plan : rotary_plans(own)) {
    const auto u = math::simulated(plan, trials, seed);
    if (u)
      rows.push_back({plan, *u});
    else if (rows.empty())
      return fail(u.error());
  }
  return rows;
}

Expected<std::size_t> fewest_balls(const math::RotaryPlan& own, double U_centre,
                                   double U_direction) {
  return math::cheapest(own, U_centre, U_direction);
}

}  // namespace nonio::planning
