// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <cstddef>
#include <string>

#include "batch/run.h"
#include "site_words.h"

namespace nonio::app {

/// How a run shows what it does: a bar on stderr where that is a terminal, else a plain line for
/// each campaign that failed; with --json one event per line on stdout; with --quiet only failures.
class Progress {
 public:
  Progress(const Common& common, bool quiet, bool json);
  batch::RunEvents events();
  /// English until the run has read site.toml.
  const config::TerminalWords& words() const { return words_.get(); }
  /// Ends the bar's line.
  void end();
  /// Names the campaigns that failed and were not done again.
  void still_failed(const batch::RunResult& run);

 private:
  void note(const std::string& message);
  void planned(std::size_t campaigns, std::size_t to_do);
  void finished(const batch::CampaignState& campaign);
  void draw();
  void clear();
  std::string failed_word() const;

  using Clock = std::chrono::steady_clock;
  SiteWords words_;
  bool quiet_, json_, bar_;
  std::size_t to_do_ = 0, done_ = 0, failed_ = 0;
  Clock::time_point began_ = Clock::now(), drawn_{};
  bool drawn_once_ = false;
};

}  // namespace nonio::app
