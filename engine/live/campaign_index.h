// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <map>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

#include "platform/storage/json_values.h"

/// The campaigns of a site as their files state them, kept in memory.
namespace nonio::live {

/// One campaign: what campaign.toml, run.json and results.json state.
struct ListedCampaign {
  std::string folder, id, day, customer, place;
  std::string machine, model;           ///< the name of the history; empty: none
  std::string state;                    ///< new, ok, attention, failed
  std::string verdict;                  ///< the worst decision on a tolerance; empty: none
  std::string certificate;              ///< its number
  std::string message;                  ///< the first error
  bool draft = false;                   ///< of a certificate that waits for its approval
  bool changed = false;                 ///< campaign.toml is another one than that of the results
  std::vector<std::string> files{};     ///< of the results
  std::vector<std::string> findings{};  ///< that require a decision, in words
  std::vector<std::string> columns{};   ///< that a person stated of its files
  /// What a form can take from it, by the keys of campaign.toml, units in the keys.
  std::map<std::string, std::string> values{};
  std::string words{};  ///< all that a search looks at, in small letters
};

struct CampaignQuery {
  std::string search{};  ///< words that all occur
  std::string folder{};  ///< only this one; empty: any
  std::string state{};   ///< also a verdict, "draft" or "certificate"; empty: any
  std::size_t page = 0, size = 50;
};

struct CampaignPage {
  std::size_t found = 0, all = 0;
  bool complete = false;  ///< false: not all campaigns have been read yet
  std::vector<ListedCampaign> campaigns{};
};

/// Reads the campaigns of a site in a thread of its own, and again what has changed: content of
/// files decides, size and time only show when to read. The first reading of 10,000 campaigns takes
/// seconds, an answer from memory milliseconds.
class CampaignIndex {
 public:
  /// `changed`: the campaigns are others, or their results are. `is_watched`: a page is open; while
  /// none is, files are left alone. `pause`: between two looks, at least.
  CampaignIndex(std::filesystem::path site, std::filesystem::path out,
                std::function<void()> changed, std::function<bool()> is_watched,
                std::chrono::duration<double> pause = std::chrono::seconds(5));
  CampaignIndex(const CampaignIndex&) = delete;
  CampaignIndex& operator=(const CampaignIndex&) = delete;
  ~CampaignIndex();

  /// By day, the newest first, then by id.
  CampaignPage find(const CampaignQuery& query) const;
  /// All of them, in the same order; `take` may not call the index.
  void each(const std::function<void(const ListedCampaign&)>& take) const;
  bool has(const std::string& folder) const;
  std::size_t size() const;
  /// Reads this campaign now, before anything else.
  void look_at(const std::string& folder);
  /// Something has changed: all are looked at soon.
  void look_soon();
  /// For a request: what may be old is looked at soon.
  void look_if_old();

 private:
  struct Seen {
    ListedCampaign campaign;
    std::string stamp;
  };
  std::string stamp_of(const std::string& folder, const std::string& id) const;
  Seen read(const std::string& folder) const;
  void run();
  /// False: nothing was new.
  bool look_at_all();
  bool is_over() const;

  std::filesystem::path site_, out_;
  std::function<void()> changed_;
  std::function<bool()> is_watched_;
  std::chrono::duration<double> pause_;
  std::chrono::steady_clock::time_point last_look_{};
  mutable std::mutex mutex_;
  std::condition_variable wake_;
  std::map<std::string, Seen> seen_{};  ///< by folder
  bool over_ = false, soon_ = true, complete_ = false;
  std::thread thread_;
};

}  // namespace nonio::live
