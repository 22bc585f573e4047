// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <functional>
#include <memory>
#include <string>

#include "campaign/config/site_logs.h"
#include "laboratory/assessment/last_run.h"
#include "nonio/reports/site.h"

/// The assessment of the machines depends only on the store of the history and on the summary of
/// the run.
namespace nonio::assessment {

/// What `assess` stores in OUT/.nonio/machines.sqlite for the next run. Only a run, which has
/// exclusive use of the folder, may store data.
enum class Keep { nothing, trends, all };

/// Returns the machines with series, changes and forecasts, and the sorted worklist. `alive` is
/// called repeatedly as a sign of life. An error if there is no store of this version.
Expected<reports::SiteHistory> assess(const std::filesystem::path& out, const LastRun& last_run,
                                      const std::function<void()>& alive,
                                      Keep keep = Keep::nothing);

/// Assessment for sites with many campaigns: machines without changes since the previous run are
/// read from OUT/.nonio/machines.sqlite without their series.
class Assessment {
 public:
  enum class Kept { ignored, used };
  /// `entered` contains the present logs of the site: its acknowledgements replace those of the
  /// store, and its new events are added. Null uses the store alone.
  static Expected<Assessment> of(const std::filesystem::path& out, const LastRun& last_run,
                                 const std::function<void()>& alive, Kept kept,
                                 const config::SiteLogs* entered = nullptr);
  Assessment(Assessment&&) noexcept;
  ~Assessment();

  /// Without series, which worklist_text, lines_json and the lists of all machines do not need.
  const reports::SiteHistory& site() const;
  /// Returns the machine with this index in `site`, with all its series.
  Expected<reports::MachineHistory> whole(std::size_t machine);
  /// Whether the stored page of a machine is up to date. `templates` is the digest of templates and
  /// language.
  bool has_page(std::size_t machine, const std::string& templates) const;
  void note_page(std::size_t machine, const std::string& templates);
  void keep();
  reports::SiteHistory take_site() &&;
  /// Returns the site with all series, after storing data according to `keep`.
  Expected<reports::SiteHistory> take_whole(Keep keep) &&;

 private:
  class State;
  explicit Assessment(std::unique_ptr<State> state);
  std::unique_ptr<State> state_;
};

/// Returns the JSON of schema nonio-history/1 with English sentences.
std::string history_json(const reports::SiteHistory& site, const LastRun& last_run,
                         const Templates& templates);

/// Returns the worklist as a JSON list, with values in the printed unit, standard uncertainties u,
/// and sentences in `language`.
std::string lines_json(const reports::SiteHistory& site, const Templates& templates,
                       const std::string& language = "en");

}  // namespace nonio::assessment
