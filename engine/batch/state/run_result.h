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
  std::filesystem::path own_plugins;  ///< the program's own plugin folder
  std::size_t jobs = 0;               ///< 0: one for each core
  bool force = false;
  std::string only{};  ///< a campaign's folder below the site, or its id: that alone, between runs
  bool dry_run = false;
  bool verify_results = false;  ///< compare the digests of all files given out, touched or not
  std::string date{};           ///< of the run, YYYY-MM-DD; empty: today's
  std::string version;
  bool as_root = false;  ///< root may run it, whoever can write the plugins
  bool confine = true;   ///< false: only to measure what confining plugins costs
  /// Of a run that is done in parts; `whole`: it is not.
  enum class Step { whole, plan, shard, merge } step = Step::whole;
  std::uint64_t shard = 0, shards = 0;  ///< which of how many
  bool pack = false;                    ///< the shard hands its results over as one file
  std::filesystem::path
      scratch{};          ///< where it does them before; empty: the system's folder for such
  double patience = 0.0;  ///< s, for results of other hosts to appear here; of a merge
};

/// A campaign that has results and is not in the site any more, or another part of the site that is
/// lost (SiteParts). Results stay; a person states that this was meant (forgotten.toml).
struct Vanished {
  std::string id, folder;  ///< folder: where it was, as text; id of a part: the same
  std::uint64_t run = 0;   ///< in which it was done last
  std::string why;         ///< what is there instead, and what to do
};

/// Calls of a run while it is going on.
struct RunEvents {
  std::function<void(const std::string& message)> note;
  std::function<void(std::size_t campaigns, std::size_t to_do)> planned;
  std::function<void(const CampaignState&)> finished;
  std::function<void()> tick;  ///< several times a second, to redraw
  /// What is done from now on: survey, campaigns, history, pages.
  std::function<void(const char* name)> stage{};
  /// Before everything else, once site.toml and the templates are read.
  std::function<void(const config::TerminalWords&)> words{};
};

struct RunResult {
  enum class End { complete, interrupted, refused } end = End::complete;
  evaluation::RunLabel run{};
  std::optional<std::uint64_t> seen_before{};  ///< campaigns that the previous run saw
  std::string error;                           ///< of a refused run: usage or configuration
  std::vector<CampaignState> campaigns;        ///< ordered by id
  std::vector<std::string> notes;
  std::vector<certificates::RegisterEntry>
      issued;  ///< certificates that are new since the previous run
  std::vector<certificates::WaitingDraft> waiting;  ///< for their release
  std::vector<Vanished> vanished;                   ///< ordered by id
  std::size_t failed() const;      ///< campaigns, and folders that could not be listed
  std::size_t lost_parts() const;  ///< so many in `vanished` are no campaigns
  /// Whether anything failed or vanished, or is not in the history.
  bool any_failed() const {
    return failed() > 0 || lost_parts() > 0 || vanished.size() > may_vanish ||
           !history_error.empty() || !worklist_error.empty();
  }
  std::size_t may_vanish = 0;  ///< so many campaigns may vanish, by site.toml
  std::string actions{};       ///< JSON: lines that require action, in the language of the site
  std::optional<std::uint64_t> asking{};  ///< lines of the worklist that require action
  std::string worklist_error{};           ///< why the pages were not made, or the mail not sent
  std::string history_error{};            ///< why OUT/history.sqlite does not contain this run
  /// How many campaigns each shard has; of a run that was planned only.
  std::vector<std::uint64_t> planned{};
};

}  // namespace nonio::batch
