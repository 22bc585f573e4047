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

/// Calculations of the bench process, each answer as JSON (docs/dev/live.md). All of them run
/// plugins.
namespace nonio::live {

/// What a bench process needs to open its campaign.
struct BenchWish {
  std::filesystem::path folder;  ///< folder of the campaign
  std::vector<std::filesystem::path> plugin_folders, template_folders;
  std::filesystem::path own_plugins;  ///< the program's own plugin folder; other plugins were not
                                      ///< tested with it
  std::string version;
};

/// A campaign that was read once, and its parts with all readings.
struct Bench {
  std::filesystem::path folder;
  std::unique_ptr<reading::Workplace> place;
  reading::ReadCampaign read;
  std::vector<modelling::PartModel> parts;  ///< all parts; each request sets their model
  bool has_catalogue = false;  ///< false for very many readings: each process that needs the
                               ///< catalogue makes it
  /// Prepared matrices of large parts, which are the same for every tried model.
  std::map<std::string, model::Groundwork> groundwork{};

  const Campaign& campaign() const { return read.manifest->campaign; }
  const std::string& language() const { return place->context.site.language; }
  modelling::PartModel* part(const std::string& name);
};

/// Reads the campaign. The process continues as a confined child. An error states why the campaign
/// cannot be opened.
Expected<Bench> open_bench(const BenchWish& wish);

/// Returns campaign, machine, parts, catalogue, saved model, errors of single measurements, and
/// limits as JSON.
storage::Json described(const Bench& bench);

/// Makes the catalogue of all parts if it does not exist yet. Returns it as in the member
/// "catalogue" of `described`.
storage::Json fill_catalogue(Bench& bench);

/// Returns the next part whose groundwork has to be done; null if none. Only parts without a
/// set-up: their groundwork runs no plugin, so it may be done in the process that all requests are
/// forked from.
const modelling::PartModel* without_groundwork(const Bench& bench);
void do_groundwork(Bench& bench, const modelling::PartModel& part);

/// Receives the first part of an answer.
using First = std::function<void(const std::string&)>;

/// Answers one request. Has to run in a child process, since it changes `bench`. `residual`:
/// residual of each reading of the part in the order of the files, NaN for excluded ones; a fit
/// fills it, other requests read it if `fitted`. Errors are texts for the person at the page.
///
/// fit: packed, the members "compare" and "text", and the value of "page". For many readings this
/// is sent first without the places, and then the page is empty. explain: the explanation is sent
/// first, then the fingerprints.
Expected<std::string> calculate(Bench& bench, const storage::Json& request,
                                std::span<double> residual, bool fitted, const First& first);

/// Whether the request needs the residuals of a fit.
bool needs_residual(const storage::Json& request);

/// Whether the request reads or writes files, so that its process must not be confined to
/// calculating.
bool needs_files(const std::string& kind);

/// Returns the members of a request that the fit and its results depend on.
std::string trial_key(const storage::Json& request);

}  // namespace nonio::live
