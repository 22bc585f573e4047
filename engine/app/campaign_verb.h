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

struct OpenCampaign {
  std::filesystem::path folder;
  std::unique_ptr<reading::Workplace> place;
  reading::ReadCampaign read;
  const Campaign& campaign() const { return read.manifest->campaign; }
  config::TerminalWords words() const {
    return {place->context.templates, place->context.site.language};
  }
};

/// Reads the campaign and prints its errors on stderr. The error is the exit status: 2 for a wrong
/// configuration, 1 if no measurement can be read. Errors of single measurements are kept in
/// `read.errors`.
tl::expected<OpenCampaign, int> open_campaign(
    const std::string& folder, const Common& common,
    reading::TemplatesFor what = reading::TemplatesFor::terminal_with_library);

/// Compares each part with its model. The error of a part without a comparison is printed and added
/// to `errors`.
std::vector<modelling::Compared> compare_parts(std::vector<modelling::PartModel> parts,
                                               std::vector<Error>& errors);

/// Returns templates and language of the sentences about a model: English for JSON, otherwise the
/// language of the site.
modelling::ModelWords words_for(const OpenCampaign& open, const Common& common);

std::vector<Argument> campaign_arguments(std::string& folder, Common& common);

}  // namespace nonio::app
