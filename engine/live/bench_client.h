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

#include "live/tool.h"

namespace nonio::live {

/// Controls a bench process from the server; a separate thread receives the answers. If the process
/// ends, its requests fail and it is restarted, or only by the next request if it ended within 2 s
/// of its start.
class BenchClient {
 public:
  /// Receives the number of the job (0 is the campaign), a `job_state` and a text, without a lock
  /// and always in the same thread. After the end of the process, job 0 gets the state "ended",
  /// with the text "again" if the process is restarted.
  using Tell = std::function<void(std::uint64_t, const std::string&, std::string)>;

  BenchClient(Launcher& launcher, std::filesystem::path campaign, Tell tell);
  BenchClient(const BenchClient&) = delete;
  BenchClient& operator=(const BenchClient&) = delete;
  ~BenchClient();

  /// Sends a request and returns its number. `tell` may be called before this function returns.
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
  std::set<std::uint64_t> open_;
  std::map<std::uint64_t, std::string> unsent_;
  std::uint64_t last_ = 0;
  bool again_ = true, over_ = false;
  std::thread listener_;
};

}  // namespace nonio::live
