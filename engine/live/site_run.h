// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "live/launcher.h"
#include "live/tool.h"

namespace nonio::live {

/// What a campaign's results were at a moment.
struct ResultsNow {
  std::string status;                 ///< empty: there were none
  std::string sha256;                 ///< of results.json
  std::vector<std::string> findings;  ///< those that require action
};
ResultsNow results_now(const std::filesystem::path& out, const std::string& id);

/// A `nonio run` that a page has started: one at a time, of one campaign or of all that has
/// changed. It reports as JSON: state, stage, done, to_do, what was different afterwards.
class SiteRun {
 public:
  /// `changed`: something of `now()` is new.
  SiteRun(Launcher& launcher, std::filesystem::path out, std::function<void()> changed);
  SiteRun(const SiteRun&) = delete;
  SiteRun& operator=(const SiteRun&) = delete;
  ~SiteRun();

  /// `id`: of the campaign; empty: a whole run. False if one is at work.
  Expected<bool> begin(const std::vector<std::string>& arguments, const std::string& command,
                       const std::string& id);
  /// Ends the one at work. False if there is none.
  bool cancel();
  bool is_running() const;
  /// nothing if there was none.
  storage::Json now() const;
  /// What is at work is ended.
  void close();

 private:
  void follow(process::Handle channel);
  void take(const std::string& line);
  void end(const ToolEnd& end);

  Launcher& launcher_;
  std::filesystem::path out_;
  std::function<void()> changed_;
  mutable std::mutex mutex_;
  storage::Json now_;
  std::string id_, last_words_;
  ResultsNow before_;
  bool running_ = false, cancelled_ = false, over_ = false;
  int channel_ = -1;
  std::thread thread_;
};

}  // namespace nonio::live
