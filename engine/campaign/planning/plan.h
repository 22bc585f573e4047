// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <string>
#include <vector>

#include "campaign/config/manifest.h"
#include "campaign/config/terminal_words.h"
#include "campaign/loader/plugins.h"
#include "nonio/math/rotary_plan.h"
#include "nonio/math/triples.h"

/// Texts and files of `nonio plan`, which need no campaign.
namespace nonio::planning {

using config::TerminalWords;

/// State why a plan is listed, and its disadvantages compared with the best plan.
std::string why_listed(const math::TriplePlan& plan, const TerminalWords& say);
std::string gives_up(const math::TriplePlan& plan, const math::TriplePlan& best,
                     const TerminalWords& say);
std::string aspect_warning(const math::TriplePlan& plan, const TerminalWords& say);
std::string why_nothing(const math::TriplePlans& plans, const TerminalWords& say);

std::string triples_json(const math::TripleRequest& wish, const math::TriplePlans& plans,
                         const TerminalWords& say);

/// Writes part programs with an output plugin, or the plan as a sheet (plan-sheet, requires
/// `templates`). `options`: texts such as "2.5", "true" or "axes,diagonals". The prefix "program-"
/// may be omitted.
config::Checked<std::vector<Artifact>> write_programs(
    const loader::Plugins& plugins, const std::string& output, const Machine& machine,
    const PointTable& rows, const std::map<std::string, std::string>& options,
    const Templates& templates = {});

struct RotaryRow {
  math::RotaryPlan plan;
  math::RotaryPlanU u;
};

/// Simulates the user's plan, then 3, 4, 5 and 10 balls at its radius, at 500 mm and at 50 mm. Only
/// an invalid plan of the user is an error.
Expected<std::vector<RotaryRow>> rotary_rows(const math::RotaryPlan& own, std::size_t trials,
                                             std::uint64_t seed);

/// Returns the smallest number of balls at the radius of the plan. U: k = 2, m and rad; 0 if not
/// required.
Expected<std::size_t> fewest_balls(const math::RotaryPlan& own, double U_centre,
                                   double U_direction);

}  // namespace nonio::planning
