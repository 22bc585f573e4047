// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <condition_variable>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <map>
#include <mutex>
#include <string>
#include <thread>

namespace nonio::live {

/// State of the runs in an output folder.
struct RunNow {
  std::string state{};       ///< state of the last run as in `nonio status`, or none
  std::uint64_t number = 0;  ///< number of the last run that began
  std::string date{};
  std::uint64_t last = 0;  ///< number of the last complete run; 0: none
  std::string last_date{};
  bool operator==(const RunNow&) const = default;
};

/// Returns a text that changes when the results or entries of the worklist change.
std::string worklist_stamp(const std::filesystem::path& site, const std::filesystem::path& out);

/// Checks once per second whether the worklist of a site has changed by a run, by an entry made on
/// a page or on a terminal, or by an approval.
class SiteNews {
 public:
  /// `what`: run (a run began or ended), worklist (results or entries changed), drafts.
  using Tell = std::function<void(const std::string& what)>;
  SiteNews(std::filesystem::path site, std::filesystem::path out, Tell tell);
  SiteNews(const SiteNews&) = delete;
  SiteNews& operator=(const SiteNews&) = delete;
  ~SiteNews();

  RunNow run() const;
  /// Requests an immediate check.
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
