// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <condition_variable>
#include <filesystem>
#include <functional>
#include <map>
#include <mutex>
#include <string>
#include <thread>

namespace nonio::live {

/// Checks once per second whether files have changed since they were read. Size and time of a file
/// only determine when its SHA-256 is computed again.
class Watch {
 public:
  using Tell = std::function<void(bool changed)>;
  explicit Watch(std::filesystem::path folder, Tell tell);
  Watch(const Watch&) = delete;
  Watch& operator=(const Watch&) = delete;
  ~Watch();

  /// Sets the names of the files and their expected SHA-256.
  void expect(std::map<std::string, std::string> digests);

 private:
  void look();
  void run();
  bool is_changed(const std::string& file, const std::string& digest);

  struct Seen {
    std::string stamp, digest;
  };
  std::filesystem::path folder_;
  Tell tell_;
  std::mutex mutex_;
  std::condition_variable over_or_new_;
  std::map<std::string, std::string> expected_;
  std::map<std::string, Seen> seen_;  ///< as last read; used by the thread only
  bool over_ = false, changed_ = false;
  std::thread thread_;
};

}  // namespace nonio::live
