// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <functional>
#include <memory>
#include <string>

#include "campaign/config/site_logs.h"
#include "laboratory/assessment/tonight.h"
#include "nonio/reports/site.h"

/// What the history of a laboratory's machines asks for this morning. Everything comes out of the
/// history's store and of what the night knows: the same bytes for the same store and night.
namespace nonio::assessment {

/// What stays in OUT/.nonio/machines.sqlite for the next time: for a night, which has the folder to
/// itself.
enum class Keep { nothing, trends, all };

/// The machines with their series, what changed, what they will be at their next calibration, and
/// the lines that ask for a decision, in their order. `alive` is called now and then. An error if
/// there is no store that this program reads.
Expected<reports::SiteHistory> assess(const std::filesystem::path& out, const Tonight& tonight,
                                      const std::function<void()>& alive,
                                      Keep keep = Keep::nothing);

/// The same for sites with very many campaigns: machines of which nothing is new since the night
/// before are not read again (OUT/.nonio/machines.sqlite), and come without their series.
class Assessment {
 public:
  enum class Kept { ignored, used };
  /// `entered`: what people have said until now, where the next night should not be waited for: its
  /// acknowledgements in place of those of the store, its new events besides.
  static Expected<Assessment> of(const std::filesystem::path& out, const Tonight& tonight,
                                 const std::function<void()>& alive, Kept kept,
                                 const config::SiteLogs* entered = nullptr);
  Assessment(Assessment&&) noexcept;
  Assessment& operator=(Assessment&&) noexcept;
  ~Assessment();

  /// What morning_text, lines_json and the lists over all machines need.
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
std::string history_json(const reports::SiteHistory& site, const Tonight& tonight,
                         const Templates& templates);

/// The lines as a list: of summary.json, and what `nonio status --actions --json` prints. Numbers in the
/// printed unit, u standard, sentences in English.
std::string lines_json(const reports::SiteHistory& site, const Templates& templates,
                       const std::string& language = "en");

}  // namespace nonio::assessment
