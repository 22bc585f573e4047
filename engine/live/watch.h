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

/// Looks once a second whether files still have the content that was read. Time and size only show
/// when to read: content decides.
class Watch {
 public:
  using Tell = std::function<void(bool changed)>;
  explicit Watch(std::filesystem::path folder, Tell tell);
  Watch(const Watch&) = delete;
  Watch& operator=(const Watch&) = delete;
  ~Watch();

  /// Names of files and the SHA-256 that they had.
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
  std::map<std::string, Seen> seen_;  ///< only the thread's own
  bool over_ = false, changed_ = false;
  std::thread thread_;
};

}  // namespace nonio::live
