// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <list>
#include <map>
#include <string>
#include <vector>

#include "campaign/reading/campaign_reader.h"

namespace nonio::modelling {

/// Largest number of readings of a part that is searched, which limits the memory for the columns of
/// all effects.
inline constexpr std::size_t most_readings = 20000;

/// Whether the readings are of parts that the machine made.
bool of_parts(const Observations& o);

/// The campaigns whose parts were joined, by the id of the joint campaign.
using Joined = std::map<std::string, std::vector<const reading::ReadCampaign*>>;

/// Replaces the parts that one machine made in several campaigns by one campaign with all of them,
/// up to `most_readings`. `made` owns the campaigns that are changed.
std::vector<const reading::ReadCampaign*> join_parts(
    std::vector<const reading::ReadCampaign*> campaigns, std::list<reading::ReadCampaign>& made,
    Joined& joined);

}  // namespace nonio::modelling
