// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <string>
#include <vector>

#include "campaign/config/manifest.h"
#include "campaign/loader/plugins.h"
#include "nonio/math/triples.h"

/// What `nonio plan` says and writes; none of it needs a campaign.
namespace nonio::planning {

/// In English: why a plan is listed, and what it gives up against the best one.
std::string why_listed(const math::TriplePlan& plan);
std::string gives_up(const math::TriplePlan& plan, const math::TriplePlan& best);
/// Diagonals that run nearly along one axis; empty if they do not.
std::string aspect_warning(const math::TriplePlan& plan);
/// Which limits to ease, by the options of the verb.
std::string why_nothing(const math::TriplePlans& plans);

/// nonio-triples/1
std::string triples_json(const math::TripleRequest& wish, const math::TriplePlans& plans);

/// Part programs by the output plugin of that name ("program-" may be left out), with its options
/// as texts: 2.5, true, axes,diagonals. Or the plan as a sheet, by the output plan-sheet, which wants
/// templates.
config::Checked<std::vector<Artifact>> write_programs(
    const loader::Plugins& plugins, const std::string& output, const Machine& machine,
    const PointTable& rows, const std::map<std::string, std::string>& options,
    const Templates& templates = {});

}  // namespace nonio::planning
