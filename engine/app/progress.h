// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <cstddef>
#include <string>

#include "batch/run.h"
#include "site_words.h"

namespace nonio::app {

/// Shows the progress of a run on stderr: notes, failed campaigns, and a bar on a terminal. With
/// --quiet the bar is omitted; with --json stdout gets one event per line instead.
class Progress {
 public:
  Progress(const Common& common, bool quiet, bool json);
  batch::RunEvents events();
  /// English until the run has read site.toml.
  const config::TerminalWords& words() const { return words_.get(); }
  void end();
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
