// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "batch/state/campaign_state.h"
#include "campaign/config/terminal_words.h"
#include "campaign/evaluation/evaluate.h"
#include "campaign/evaluation/record.h"
#include "campaign/evaluation/status.h"
#include "certificates/register.h"
#include "platform/process/stop.h"

namespace nonio::batch {

struct RunOptions {
  std::filesystem::path site, out;
  std::vector<std::filesystem::path> plugin_folders, template_folders;
  std::filesystem::path own_plugins;  ///< plugin folder of the installed program
  std::size_t jobs = 0;               ///< number of worker processes; 0: one for each core
  bool force = false;
  std::string only{};  ///< folder below the site, or id, of the only campaign to be evaluated again
                       ///< after a complete run; empty: all campaigns
  bool dry_run = false;
  bool verify_results = false;  ///< whether to compare the digests of all output files, even if
                                ///< their times are unchanged
  std::string date{};           ///< date of the run, YYYY-MM-DD; empty: today
  std::string version;
  bool as_root = false;  ///< whether root may start the run even if other users can change the
                         ///< plugins
  bool confine = true;   ///< whether plugins are confined; false is used to measure what
                         ///< confinement costs
  /// Part of the run that this process does; `whole`: the run is not divided.
  enum class Step { whole, plan, shard, merge } step = Step::whole;
  std::uint64_t shard = 0, shards = 0;  ///< zero-based index of this shard, and number of shards
  bool pack = false;                    ///< whether the shard hands its results over as one file
  std::filesystem::path
      scratch{};          ///< local folder of a packed shard; empty: the system's temporary folder
  double patience = 0.0;  ///< time that a merge waits for results of other hosts to appear, s
};

/// A campaign that has results and is no longer in the site, or another part of the site that is
/// lost (SiteParts). The results are kept; forgotten.toml confirms that the removal was intended.
struct Vanished {
  std::string id, folder;  ///< id, and former folder as text; for a lost part of the site, both are
                           ///< its path
  std::uint64_t run = 0;   ///< number of the run that evaluated the campaign last, or that wrote
                           ///< the inventory of the site last
  std::string why;         ///< what the site contains instead, and the required action
};

/// Callbacks during a run; only `stage` and `words` may be empty.
struct RunEvents {
  std::function<void(const std::string& message)> note;
  std::function<void(std::size_t campaigns, std::size_t to_do)> planned;
  std::function<void(const CampaignState&)> finished;
  std::function<void()> tick;  ///< called several times per second, so that the progress display
                               ///< can be redrawn
  /// Called at the beginning of each stage: survey, campaigns, history, pages.
  std::function<void(const char* name)> stage{};
  /// Called first, as soon as site.toml and the templates are read.
  std::function<void(const config::TerminalWords&)> words{};
};

struct RunResult {
  enum class End { complete, interrupted, refused } end = End::complete;
  evaluation::RunLabel run{};
  std::optional<std::uint64_t> seen_before{};  ///< number of campaigns in the previous run; none:
                                               ///< first run
  std::string error;                           ///< why the run was refused or could not be
                                               ///< completed; empty: neither
  std::vector<CampaignState> campaigns;        ///< campaigns of the run, ordered by id
  std::vector<std::string> notes;
  std::vector<certificates::RegisterEntry> issued;  ///< certificates issued since the previous run
  std::vector<certificates::WaitingDraft> waiting;  ///< drafts that wait for approval
  std::vector<Vanished> vanished;                   ///< vanished campaigns and lost parts of the
                                                    ///< site, ordered by id
  std::size_t failed() const;      ///< number of failed campaigns and of folders that could not be
                                   ///< listed
  std::size_t lost_parts() const;  ///< number of entries in `vanished` that are not campaigns
  /// Returns whether a campaign failed, more campaigns vanished than site.toml allows, a part of
  /// the site is lost, or the history or the worklist could not be written.
  bool any_failed() const {
    return failed() > 0 || lost_parts() > 0 || vanished.size() > may_vanish ||
           !history_error.empty() || !worklist_error.empty();
  }
  std::size_t may_vanish = 0;  ///< largest number of vanished campaigns that is not a failure, from
                               ///< site.toml
  std::string actions{};       ///< JSON list of lines that require action, in the language of the
                               ///< site
  std::optional<std::uint64_t> asking{};  ///< number of worklist lines that require action; none if
                                          ///< the worklist was not made
  std::string worklist_error{};           ///< why the pages were not made or the mail was not sent;
                                          ///< empty: no error
  std::string history_error{};            ///< why OUT/history.sqlite does not contain this run, or
                                          ///< histories in reports are outdated; empty: no error
  /// Number of campaigns in each shard; only for a planned run.
  std::vector<std::uint64_t> planned{};
};

}  // namespace nonio::batch
