// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <condition_variable>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <map>
#include <mutex>
#include <set>
#include <string>
#include <thread>

#include "live/launcher.h"

namespace nonio::live {

/// Controls a bench process from the server: numbers the requests, and receives the answers in a
/// thread of its own. If the bench process dies, its requests fail and it is restarted; one that
/// died within 2 s of its start is restarted only by the next request.
class BenchClient {
 public:
  /// Receives the number of the job (0: the campaign itself), one of `job_state`, and a text. It is
  /// called without a lock, always by the same thread. State "ended" of job 0: the process has
  /// died; text "again": it is restarted.
  using Tell = std::function<void(std::uint64_t, const std::string&, std::string)>;

  BenchClient(Launcher& launcher, std::filesystem::path campaign, Tell tell);
  BenchClient(const BenchClient&) = delete;
  BenchClient& operator=(const BenchClient&) = delete;
  ~BenchClient();

  /// Sends a request and returns its number; `tell` may be called before this returns.
  std::uint64_t ask(const storage::Json& request);
  void cancel(std::uint64_t job);
  /// Starts a new bench process, which reads the files again.
  void restart();

 private:
  void listen();
  bool connect();
  void hear();
  void fail_all(const std::string& words);
  bool send(std::string_view what, std::uint64_t job, const std::string& text);

  Launcher& launcher_;
  std::filesystem::path campaign_;
  Tell tell_;
  std::mutex mutex_;
  std::condition_variable wanted_;
  process::Handle channel_;
  std::set<std::uint64_t> open_;                 ///< jobs that are not answered yet
  std::map<std::uint64_t, std::string> unsent_;  ///< requests made while there was no process
  std::uint64_t last_ = 0;
  bool again_ = true, over_ = false;
  std::thread listener_;
};

}  // namespace nonio::live
