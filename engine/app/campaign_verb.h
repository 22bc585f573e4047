// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "campaign/modelling/campaign_model.h"
#include "campaign/modelling/model_change.h"
#include "campaign/modelling/model_words.h"
#include "common.h"

namespace nonio::app {

/// The campaign that a verb is about.
struct OpenCampaign {
  std::filesystem::path folder;
  std::unique_ptr<reading::Workplace> place;
  reading::ReadCampaign read;
  const Campaign& campaign() const { return read.manifest->campaign; }
};

/// Reads the campaign and reports its errors on stderr. The error is the exit status if the verb
/// cannot go on: 2 for the configuration, 1 for measurements of which none can be read. Errors of
/// single measurements stay in `read.errors` and leave the others.
tl::expected<OpenCampaign, int> open_campaign(
    const std::string& folder, const Common& common,
    reading::TemplatesFor what = reading::TemplatesFor::documents);

/// The fit of each part. The error of a part that cannot be fitted is printed and added to `errors`.
std::vector<modelling::Compared> compare_parts(std::vector<modelling::PartModel> parts,
                                               std::vector<Error>& errors);

/// Sentences in the language of the site, or English for JSON.
modelling::ModelWords words_for(const OpenCampaign& open, const Common& common);

/// "CAMPAIGN", --templates and the common options.
std::vector<Argument> campaign_arguments(std::string& folder, Common& common);

}  // namespace nonio::app
