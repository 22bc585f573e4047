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

/// Results of a campaign at one moment, to compare them before and after a run.
struct ResultsNow {
  std::string status;                 ///< status of the campaign; empty: there are no results
  std::string sha256;                 ///< digest of results.json
  std::vector<std::string> findings;  ///< findings with severity warning
};
ResultsNow results_now(const std::filesystem::path& out, const std::string& id);

/// A `nonio run` started from a page: one at a time, for one campaign or for all changed ones. Its
/// state is JSON: state, stage, done, to_do, and the differences in the results afterwards.
class SiteRun {
 public:
  /// `changed` is called when `now()` has changed.
  SiteRun(Launcher& launcher, std::filesystem::path out, std::function<void()> changed);
  SiteRun(const SiteRun&) = delete;
  SiteRun& operator=(const SiteRun&) = delete;
  ~SiteRun();

  /// Starts a run. `id` is the campaign that is run alone; empty for a run of all changed
  /// campaigns. Returns false if a run is in progress already.
  Expected<bool> begin(const std::vector<std::string>& arguments, const std::string& command,
                       const std::string& id);
  /// Ends the present run. Returns false if there is none.
  bool cancel();
  bool is_running() const;
  /// Returns the state of the last run; null if there was none.
  storage::Json now() const;
  /// Ends the present run and prevents new ones.
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
