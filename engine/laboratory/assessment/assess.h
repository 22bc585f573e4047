// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <functional>
#include <memory>
#include <string>

#include "campaign/config/site_logs.h"
#include "laboratory/assessment/last_run.h"
#include "nonio/reports/site.h"

/// What the history of a laboratory's machines requires after the last run. It is computed from the
/// store of the history and from the summary of the run: the same bytes for the same store and run.
namespace nonio::assessment {

/// Kept in OUT/.nonio/machines.sqlite for the next time, by a run, which alone writes to the
/// folder.
enum class Keep { nothing, trends, all };

/// The machines with their series, what changed, what they will be at their next calibration, and
/// the lines of the worklist, in their order. `alive` is called repeatedly, as a sign of life. An
/// error if there is no store that this program reads.
Expected<reports::SiteHistory> assess(const std::filesystem::path& out, const LastRun& last_run,
                                      const std::function<void()>& alive,
                                      Keep keep = Keep::nothing);

/// The same for sites with very many campaigns: machines without a change since the previous run
/// are not read again (OUT/.nonio/machines.sqlite), and come without their series.
class Assessment {
 public:
  enum class Kept { ignored, used };
  /// `entered`: entries of people since the run that are applied before the next one: its
  /// acknowledgements replace those of the store, its new events are added.
  static Expected<Assessment> of(const std::filesystem::path& out, const LastRun& last_run,
                                 const std::function<void()>& alive, Kept kept,
                                 const config::SiteLogs* entered = nullptr);
  Assessment(Assessment&&) noexcept;
  Assessment& operator=(Assessment&&) noexcept;
  ~Assessment();

  /// What worklist_text, lines_json and the lists over all machines need.
  const reports::SiteHistory& site() const;
  /// A machine of `site`, with all its series.
  Expected<reports::MachineHistory> whole(std::size_t machine);
  /// Whether a page of it is still what was made of it. `templates`: of what else pages are made.
  bool has_page(std::size_t machine, const std::string& templates) const;
  /// It was written just now.
  void note_page(std::size_t machine, const std::string& templates);
  /// For the next run.
  void keep();
  reports::SiteHistory take_site() &&;
  /// With all series of all machines.
  Expected<reports::SiteHistory> take_whole(Keep keep) &&;

 private:
  class State;
  explicit Assessment(std::unique_ptr<State> state);
  std::unique_ptr<State> state_;
};

/// nonio-history/1: what `nonio machine history OUT --json` prints of these machines. Sentences in English.
std::string history_json(const reports::SiteHistory& site, const LastRun& last_run,
                         const Templates& templates);

/// The lines as a list: of summary.json, and what `nonio status --actions --json` prints. Numbers in the
/// printed unit, u standard, sentences in English.
std::string lines_json(const reports::SiteHistory& site, const Templates& templates,
                       const std::string& language = "en");

}  // namespace nonio::assessment
