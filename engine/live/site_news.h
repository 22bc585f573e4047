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

/// State of the runs of an output folder.
struct NightNow {
  std::string state{};       ///< none, or as `nonio status` says
  std::uint64_t number = 0;  ///< of the last that began
  std::string date{};
  std::uint64_t last = 0;  ///< the last complete one; 0: none
  std::string last_date{};
  bool operator==(const NightNow&) const = default;
};

/// Looks once a second whether a site's morning has become another one: by a night, by what people
/// have entered, here or on a terminal, or by a release.
class SiteNews {
 public:
  /// `what`: night (it began or ended), morning (results or entries), drafts.
  using Tell = std::function<void(const std::string& what)>;
  SiteNews(std::filesystem::path site, std::filesystem::path out, Tell tell);
  SiteNews(const SiteNews&) = delete;
  SiteNews& operator=(const SiteNews&) = delete;
  ~SiteNews();

  NightNow night() const;
  /// Without waiting for the second to pass.
  void look_now();

 private:
  struct Seen {
    NightNow night{};
    std::string morning{}, drafts{};
  };
  Seen look() const;
  void run();

  std::filesystem::path site_, out_, register_;
  Tell tell_;
  mutable std::mutex mutex_;
  std::condition_variable wake_;
  bool over_ = false, now_ = false;
  Seen seen_;
  std::thread thread_;
};

}  // namespace nonio::live
