// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <functional>
#include <memory>
#include <string>

#include "campaign/config/site_logs.h"
#include "laboratory/assessment/last_run.h"
#include "nonio/reports/site.h"

/// Assesses the history of a laboratory's machines after a run, and lists the actions required. The
/// result depends only on the store of the history and on the summary of the run.
namespace nonio::assessment {

/// What `assess` stores in OUT/.nonio/machines.sqlite for the next run. Only a run may store,
/// because it has exclusive use of the folder.
enum class Keep { nothing, trends, all };

/// Returns the machines with their series, changes and forecasts, and the lines of the worklist in
/// their order. `alive` is called repeatedly as a sign of life. An error if no store of this
/// version exists.
Expected<reports::SiteHistory> assess(const std::filesystem::path& out, const LastRun& last_run,
                                      const std::function<void()>& alive,
                                      Keep keep = Keep::nothing);

/// Assessment of sites with very many campaigns: machines without a change since the previous run
/// are taken from OUT/.nonio/machines.sqlite instead of the store, and come without their series.
class Assessment {
 public:
  enum class Kept { ignored, used };
  /// `entered`: present entries of people, null: those of the store. Its acknowledgements replace
  /// those of the store, and its new events are added.
  static Expected<Assessment> of(const std::filesystem::path& out, const LastRun& last_run,
                                 const std::function<void()>& alive, Kept kept,
                                 const config::SiteLogs* entered = nullptr);
  Assessment(Assessment&&) noexcept;
  Assessment& operator=(Assessment&&) noexcept;
  ~Assessment();

  /// The site without series: sufficient for worklist_text, lines_json and the lists over all
  /// machines.
  const reports::SiteHistory& site() const;
  /// Returns machine number `machine` of `site` with all its series.
  Expected<reports::MachineHistory> whole(std::size_t machine);
  /// Whether the stored page of a machine is up to date. `templates`: digest of the templates and
  /// language that pages are made from.
  bool has_page(std::size_t machine, const std::string& templates) const;
  /// Notes that the page of a machine was written just now.
  void note_page(std::size_t machine, const std::string& templates);
  /// Stores the results of the assessment for the next run.
  void keep();
  reports::SiteHistory take_site() &&;
  /// Returns the site with all series of all machines, after storing the results that `keep` names
  /// for the next run.
  Expected<reports::SiteHistory> take_whole(Keep keep) &&;

 private:
  class State;
  explicit Assessment(std::unique_ptr<State> state);
  std::unique_ptr<State> state_;
};

/// Returns the JSON that `nonio machine history OUT --json` prints (nonio-history/1), with
/// sentences in English.
std::string history_json(const reports::SiteHistory& site, const LastRun& last_run,
                         const Templates& templates);

/// Returns the worklist as a JSON list, for summary.json and `nonio status --actions --json`.
/// Values are in the printed unit, u is a standard uncertainty, sentences are in `language`.
std::string lines_json(const reports::SiteHistory& site, const Templates& templates,
                       const std::string& language = "en");

}  // namespace nonio::assessment
