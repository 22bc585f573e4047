// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

#include "live/launcher.h"
#include "live/tool.h"

namespace nonio::live {

struct ResultsNow {
  std::string status;                 ///< empty without results
  std::string sha256;                 ///< digest of results.json
  std::vector<std::string> findings;  ///< findings of severity warning
};
ResultsNow results_now(const std::filesystem::path& out, const std::string& id);

/// A `nonio run` that was started from a page: one at a time, for one campaign or for all changed
/// campaigns. Its state is JSON: progress (`state`, `stage`, `done`, `to_do`), messages and, at the
/// end, the differences of the results.
class SiteRun {
 public:
  /// `changed` is called when `now()` has changed.
  SiteRun(Launcher& launcher, std::filesystem::path out, std::function<void()> changed);
  SiteRun(const SiteRun&) = delete;
  SiteRun& operator=(const SiteRun&) = delete;
  ~SiteRun();

  /// Starts a run of the campaign `id`, or of all changed campaigns if `id` is empty. Returns false
  /// if a run is in progress.
  Expected<bool> begin(const std::vector<std::string>& arguments, const std::string& command,
                       const std::string& id);
  /// Returns false if no run is in progress.
  bool cancel();
  bool is_running() const;
  /// Returns the state of the last run, or null.
  storage::Json now() const;
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
