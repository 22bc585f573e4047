// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <vector>

#include "nonio/host/evaluate.h"
#include "nonio/host/register.h"
#include "nonio/host/run.h"

namespace nonio::host {

struct SurveyInput {
  std::filesystem::path site, out;
  const Context& context;
  std::uint64_t night;  ///< the one that is being done
  bool force;
  const std::vector<RegisterEntry>& numbers;  ///< all of the site's register
  std::vector<std::string>& notes;            ///< what was passed over, for the summary
  bool (*stopped)();  ///< asked now and then; what is returned then is not whole
};

/// All campaigns of a site, by id, each with what is to be done with it and why. Campaigns whose
/// ids collide come out failed, with an error that names all their folders.
Expected<std::vector<CampaignState>> survey(const SurveyInput& input);

}  // namespace nonio::host
