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

/// Calculations of the bench process, all of which run plugins. Each answer is JSON
/// (docs/dev/live.md).
namespace nonio::live {

struct BenchWish {
  std::filesystem::path folder;
  std::vector<std::filesystem::path> plugin_folders, template_folders;
  std::filesystem::path own_plugins;  ///< the program's own plugins; others were not tested with it
  std::string version;
};

/// A campaign that was read once, with its parts and readings.
struct Bench {
  std::filesystem::path folder;
  std::unique_ptr<reading::Workplace> place;
  reading::ReadCampaign read;
  std::vector<modelling::PartModel> parts;
  /// False for many readings; child processes that need the catalog then make their own.
  bool has_catalogue = false;
  /// Prepared matrices of large parts, which do not depend on the model.
  std::map<std::string, model::Groundwork> groundwork{};

  const Campaign& campaign() const { return read.manifest->campaign; }
  const std::string& language() const { return place->context.site.language; }
  modelling::PartModel* part(const std::string& name);
};

/// Reads the campaign. Afterwards the process is a confined child.
Expected<Bench> open_bench(const BenchWish& wish);

/// Returns campaign, machine, parts, catalogue, saved model, errors of single measurements and
/// limits.
storage::Json described(const Bench& bench);

/// Makes the catalogue of all parts if it does not exist. Returns the member "catalogue" of
/// `described`.
storage::Json fill_catalogue(Bench& bench);

/// Returns a part of 5,000 to 200,000 readings whose matrices must be prepared, or null. Parts with
/// set-up effects are omitted, because their matrices need a plugin, which must not run in the
/// process that is forked for each request.
const modelling::PartModel* without_groundwork(const Bench& bench);
void do_groundwork(Bench& bench, const modelling::PartModel& part);

using First = std::function<void(const std::string&)>;

/// Answers one request. Must be called in a child process, because it changes `bench`. `residual`
/// has one entry per reading of the part, in the order of the files, NaN for excluded ones; a fit
/// fills it, other requests read it if `fitted`. Error messages are shown on the page.
/// The answer to "fit" is packed: the members "compare" and "text", then the value of "page". For
/// many readings, `first` gets both before the residuals are tested, and the page of the final
/// answer is empty. For "explain", `first` gets the explanation and the final answer contains the
/// fingerprints.
Expected<std::string> calculate(Bench& bench, const storage::Json& request,
                                std::span<double> residual, bool fitted, const First& first);

/// Whether the request needs the residuals of a fit.
bool needs_residual(const storage::Json& request);

/// Whether the request reads or writes files, so that its process must not be confined.
bool needs_files(const std::string& kind);

/// Returns the members of a request on which the fit depends, as JSON.
std::string trial_key(const storage::Json& request);

}  // namespace nonio::live
