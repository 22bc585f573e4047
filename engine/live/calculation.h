// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <functional>
#include <map>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "campaign/modelling/campaign_model.h"
#include "platform/storage/json_values.h"

/// What the bench process calculates of its campaign, each answer as JSON (docs/dev/live.md). All of it
/// runs plugins.
namespace nonio::live {

/// What a bench process is about.
struct BenchWish {
  std::filesystem::path folder;  ///< of the campaign
  std::vector<std::filesystem::path> plugin_folders, template_folders;
  std::filesystem::path own_plugins;  ///< of the program's own folder: tested with it
  std::string version;
};

/// A campaign as it was read once, and its parts with all readings.
struct Bench {
  std::filesystem::path folder;
  std::unique_ptr<reading::Workplace> place;
  reading::ReadCampaign read;
  std::vector<modelling::PartModel> parts;  ///< with any model
  bool has_catalogue = false;  ///< of very many readings each process that requires it makes it
  /// Of parts with many readings: the same for each model that is tried.
  std::map<std::string, model::Groundwork> groundwork{};

  const Campaign& campaign() const { return read.manifest->campaign; }
  const std::string& language() const { return place->context.site.language; }
  modelling::PartModel* part(const std::string& name);
};

/// Reads the campaign; the process goes on in a child that is kept apart. An error states why the
/// campaign cannot be opened.
Expected<Bench> open_bench(const BenchWish& wish);

/// Campaign, machine, parts, catalogue, saved model, errors of single measurements, limits.
storage::Json described(const Bench& bench);

/// The catalogue of all parts, where it is not there yet; as "catalogue" of `described`.
storage::Json fill_catalogue(Bench& bench);

/// The next part whose groundwork is to be done; none if all is. Of parts without a set-up:
/// no plugin takes part, so it may be done in the process that all requests come from.
const modelling::PartModel* without_groundwork(const Bench& bench);
void do_groundwork(Bench& bench, const modelling::PartModel& part);

/// What is there of an answer before all of it.
using First = std::function<void(const std::string&)>;

/// Answers one request, in a process of its own: it changes `bench`. `residual`: of each reading of
/// the part as the files have it, NaN where it is excluded; a fit fills it, others read it if
/// `fitted`. Errors are for the person at the page.
///
/// fit: packed, the members "compare" and "text", and the value of "page". Of many readings this
/// comes first, without the places; then the page is empty. explain: the explanation first, then
/// the fingerprints.
Expected<std::string> calculate(Bench& bench, const storage::Json& request,
                                std::span<double> residual, bool fitted, const First& first);

/// Whether it needs what a fit leaves of each reading.
bool needs_residual(const storage::Json& request);

/// What must be read from files, or written: such a request is not confined to calculating.
bool needs_files(const std::string& kind);

/// The part of a request that the fit and its results depend on.
std::string trial_key(const storage::Json& request);

}  // namespace nonio::live
