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

/// A campaign that a command has opened.
struct OpenCampaign {
  std::filesystem::path folder;
  std::unique_ptr<reading::Workplace> place;
  reading::ReadCampaign read;
  const Campaign& campaign() const { return read.manifest->campaign; }
};

/// Reads the campaign and prints its errors on stderr. The error is the exit status if the command
/// cannot continue: 2 for a mistake in the configuration, 1 if no measurement can be read. Errors
/// of single measurements are kept in `read.errors`, and the other measurements are used.
tl::expected<OpenCampaign, int> open_campaign(
    const std::string& folder, const Common& common,
    reading::TemplatesFor what = reading::TemplatesFor::documents);

/// Compares each part with its model. The error of a part that cannot be compared is printed and
/// added to `errors`.
std::vector<modelling::Compared> compare_parts(std::vector<modelling::PartModel> parts,
                                               std::vector<Error>& errors);

/// Returns the templates and the language of the sentences about a model: the language of the site,
/// or English for JSON.
modelling::ModelWords words_for(const OpenCampaign& open, const Common& common);

/// Returns the arguments "CAMPAIGN" and --templates, and the common ones.
std::vector<Argument> campaign_arguments(std::string& folder, Common& common);

}  // namespace nonio::app
