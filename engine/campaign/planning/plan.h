// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <string>
#include <vector>

#include "campaign/config/manifest.h"
#include "campaign/config/terminal_words.h"
#include "campaign/loader/plugins.h"
#include "nonio/math/triples.h"

/// What `nonio plan` prints and writes; none of it needs a campaign.
namespace nonio::planning {

using config::TerminalWords;

/// Why a plan is listed, and its disadvantages compared with the best one.
std::string why_listed(const math::TriplePlan& plan, const TerminalWords& say);
std::string gives_up(const math::TriplePlan& plan, const math::TriplePlan& best,
                     const TerminalWords& say);
/// That the diagonals run nearly along one axis; empty if they do not.
std::string aspect_warning(const math::TriplePlan& plan, const TerminalWords& say);
/// Which limits to relax, by the options of the command.
std::string why_nothing(const math::TriplePlans& plans, const TerminalWords& say);

/// nonio-triples/1; its sentences in the language of `say`.
std::string triples_json(const math::TripleRequest& wish, const math::TriplePlans& plans,
                         const TerminalWords& say);

/// Part programs by the output plugin of that name ("program-" may be left out), with its options
/// as texts: 2.5, true, axes,diagonals. Or the plan as a sheet, by the output plan-sheet, which needs
/// templates.
config::Checked<std::vector<Artifact>> write_programs(
    const loader::Plugins& plugins, const std::string& output, const Machine& machine,
    const PointTable& rows, const std::map<std::string, std::string>& options,
    const Templates& templates = {});

}  // namespace nonio::planning
