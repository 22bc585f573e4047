// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <condition_variable>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <mutex>
#include <string>
#include <thread>

namespace nonio::live {

struct RunNow {
  std::string state{};       ///< as in `nonio status`, or "none"
  std::uint64_t number = 0;  ///< last run that began
  std::string date{};
  std::uint64_t last = 0;  ///< last complete run; 0 if there is none
  std::string last_date{};
  bool operator==(const RunNow&) const = default;
};

/// Returns a text that changes with the results or the logs.
std::string worklist_stamp(const std::filesystem::path& site, const std::filesystem::path& out);

/// Returns the file of the register of certificates; empty if it is not a file.
std::filesystem::path register_of(const std::filesystem::path& site);

/// Checks once per second whether a run, an entry on a page or a terminal, or an approval has
/// changed the worklist.
class SiteNews {
 public:
  /// `what` is "run" (a run began or ended), "worklist" (results or logs changed) or "drafts".
  using Tell = std::function<void(const std::string& what)>;
  SiteNews(std::filesystem::path site, std::filesystem::path out, Tell tell);
  SiteNews(const SiteNews&) = delete;
  SiteNews& operator=(const SiteNews&) = delete;
  ~SiteNews();

  RunNow run() const;
  void look_now();

 private:
  struct Seen {
    RunNow run{};
    std::string worklist{}, drafts{};
  };
  Seen look() const;
  void watch();

  std::filesystem::path site_, out_, register_;
  Tell tell_;
  mutable std::mutex mutex_;
  std::condition_variable wake_;
  bool over_ = false, now_ = false;
  Seen seen_;
  std::thread thread_;
};

}  // namespace nonio::live
