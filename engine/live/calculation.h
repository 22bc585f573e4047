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
  bool has_catalogue = false;  ///< whether the catalogue exists; false for very many readings, for
                               ///< which each child process that needs the catalogue makes its own
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

/// Returns the next part, of 5,000 to 200,000 readings, whose prepared matrices (groundwork) are
/// still missing; null if there is none. Parts with set-up effects are left out, because their
/// groundwork runs a plugin, and therefore must not be computed in the process that all requests
/// are forked from.
const modelling::PartModel* without_groundwork(const Bench& bench);
void do_groundwork(Bench& bench, const modelling::PartModel& part);

/// Function that receives the first part of an answer.
using First = std::function<void(const std::string&)>;

/// Answers one request. Has to run in a child process, since it changes `bench`. `residual`:
/// residual of each reading of the part in the order of the files, NaN for excluded ones; a fit
/// fills it, other requests read it if `fitted`. Errors are texts for the person at the page.
///
/// The answer to "fit" is packed: first the members "compare" and "text" as a text, then the value
/// of "page". For many readings, both are sent in `first` before the places where the model does
/// not fit are computed; the page of the final answer is then empty. The answer to "explain" sends
/// the explanation in `first`, and the fingerprints as the final answer.
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
