// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <set>
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
  std::filesystem::path own_plugins;
  std::size_t jobs = 0;  ///< number of worker processes; 0 for one per core
  bool force = false;
  /// --only: folder or id of the only campaign that is evaluated again after a complete run.
  std::string only{};
  bool dry_run = false;
  /// Whether to compare the digests of all output files, even if their times are unchanged.
  bool verify_results = false;
  std::string date{};  ///< YYYY-MM-DD; empty for today
  std::string version;
  bool as_root = false;
  /// Whether plugins are confined; false measures the cost of the confinement.
  bool confine = true;
  /// `whole` for a run without shards.
  enum class Step { whole, plan, shard, merge } step = Step::whole;
  std::uint64_t shard = 0, shards = 0;  ///< zero-based index of the shard and number of shards
  bool pack = false;                    ///< whether the shard delivers its results as one file
  /// Local folder of a packed shard; empty for the temporary folder of the system.
  std::filesystem::path scratch{};
  double patience = 0.0;  ///< waiting time of a merge for results of other hosts, s
};

/// A campaign with results that the site no longer contains, or a lost part of the site
/// (SiteParts). An entry in forgotten.toml confirms that the removal was intended.
struct Vanished {
  std::string id, folder;  ///< id and former folder; for a part of the site, its path
  std::uint64_t run = 0;   ///< last run that evaluated the campaign or read the part
  std::string why;
};

/// Callbacks during a run; only `stage` and `words` may be empty.
struct RunEvents {
  std::function<void(const std::string& message)> note;
  std::function<void(std::size_t campaigns, std::size_t to_do)> planned;
  std::function<void(const CampaignState&)> finished;
  std::function<void()> tick;  ///< called several times per second for the progress bar
  /// Called with "survey", "campaigns", "history" and "pages".
  std::function<void(const char* name)> stage{};
  /// Called once, after site.toml and the templates were read.
  std::function<void(const config::TerminalWords&)> words{};
};

struct RunResult {
  enum class End { complete, interrupted, refused } end = End::complete;
  evaluation::RunLabel run{};
  std::optional<std::uint64_t> seen_before{};
  /// Reason why the run was refused or is not complete.
  std::string error;
  std::vector<CampaignState> campaigns;  ///< sorted by id
  std::vector<std::string> notes;
  std::vector<certificates::RegisterEntry> issued;
  std::set<std::string> out_of_force{};             ///< numbers of certificates no longer in force
  std::vector<certificates::WaitingDraft> waiting;  ///< drafts that wait for approval
  std::vector<Vanished> vanished;                   ///< sorted by id
  std::size_t failed() const;                       ///< includes folders that could not be listed
  std::size_t lost_parts() const;  ///< number of entries in `vanished` that are not campaigns
  /// Whether a campaign failed, more campaigns are missing than site.toml accepts, a part of the
  /// site is lost, or the history or the worklist could not be written.
  bool any_failed() const {
    return failed() > 0 || lost_parts() > 0 || vanished.size() > may_vanish ||
           !history_error.empty() || !worklist_error.empty();
  }
  std::size_t may_vanish = 0;  ///< number of missing campaigns that site.toml accepts
  /// JSON list of worklist lines that require action, in the language of the site.
  std::string actions{};
  /// Number of worklist lines that require action, if the worklist was made.
  std::optional<std::uint64_t> asking{};
  std::string worklist_error{};  ///< error of the pages or of the mail
  /// Reason why the history lacks this run or some results, or why reports contain outdated
  /// histories.
  std::string history_error{};
  /// Number of campaigns per shard after the step `plan`.
  std::vector<std::uint64_t> planned{};
};

}  // namespace nonio::batch
