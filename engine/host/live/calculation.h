// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "host/modelling/campaign_model.h"
#include "host/storage/json_values.h"

/// What the bench process calculates of its campaign, each answer as JSON (docs/live.md). All of it
/// runs plugins.
namespace nonio::host::live {

/// What a bench process is about.
struct BenchWish {
  std::filesystem::path folder;  ///< of the campaign
  std::vector<std::filesystem::path> plugin_folders, template_folders;
  std::filesystem::path own_plugins;  ///< beside the program: tested with it
  std::string version;
};

/// A campaign as it was read once, and its parts with all readings.
struct Bench {
  std::filesystem::path folder;
  std::unique_ptr<reading::Workplace> place;
  reading::ReadCampaign read;
  std::vector<modelling::PartModel> parts;  ///< with any model

  const Campaign& campaign() const { return read.manifest->campaign; }
  const std::string& language() const { return place->context.site.language; }
  modelling::PartModel* part(const std::string& name);
};

/// Reads the campaign; the process goes on in a child that is kept apart. An error tells why the
/// campaign cannot be opened.
Expected<Bench> open_bench(const BenchWish& wish);

/// Campaign, machine, parts, catalogue, saved model, errors of single measurements, limits.
storage::Json described(const Bench& bench);

/// Answers one request, in a process of its own: it changes `bench`. `residual`: of each reading of
/// the part as the files have it, NaN where it is excluded; a fit fills it, others read it if
/// `fitted`. Errors are for the person at the page.
Expected<std::string> calculate(Bench& bench, const storage::Json& request,
                                std::span<double> residual, bool fitted);

/// What must be read from files, or written: such a request is not confined to calculating.
bool needs_files(const std::string& kind);

/// The fit, or what was asked of it, depends on this of a request.
std::string trial_key(const storage::Json& request);

}  // namespace nonio::host::live
