// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <set>
#include <string>
#include <thread>
#include <vector>

#include "platform/storage/json_values.h"

namespace nonio::live {

struct ListedCampaign {
  std::string folder, id, day, customer, place;
  std::string machine, model;  ///< name in the history and model; empty if not stated
  std::string state;           ///< new, ok, attention or failed
  std::string verdict;         ///< worst conformity decision; empty without one
  std::string certificate;     ///< number; empty if none was issued
  std::string message;         ///< first error; empty without errors
  bool draft = false;          ///< whether a draft of a certificate waits for approval
  /// Whether campaign.toml has changed since the results were stored.
  bool changed = false;
  std::vector<std::string> files{};
  std::vector<std::string> columns{};  ///< reader option `columns` in campaign.toml
  /// Values for the forms by key of campaign.toml; the keys contain the units.
  std::map<std::string, std::string> values{};
  std::string words{};
};

/// Returns a text that changes when the file is written or replaced; "-;" if it does not exist.
std::string file_stamp(const std::filesystem::path& path);

/// Returns the words of a search in lower case.
std::vector<std::string> words_of(const std::string& search);
/// Whether all words of a search occur in a text in lower case.
bool has_all(const std::string& text, const std::vector<std::string>& words);
/// Returns the index of the first entry of a page in a list of `all` entries, or that of the last
/// page if `page` does not exist.
std::size_t begin_of_page(std::size_t page, std::size_t size, std::size_t all);

struct CampaignQuery {
  std::string search{};  ///< words that must all occur
  std::string folder{};  ///< only this folder; empty for all
  std::string state{};   ///< state, verdict, "draft" or "certificate"; empty for all
  std::size_t page = 0, size = 50;
};

struct CampaignPage {
  std::size_t found = 0, all = 0;
  bool complete = false;
  std::vector<ListedCampaign> campaigns{};
};

/// Reads the campaigns of a site in a separate thread, and changed ones again. Size and time of a
/// file only determine whether it is read. Reading 10,000 campaigns takes seconds, an answer from
/// memory milliseconds.
class CampaignIndex {
 public:
  /// `changed` is called after a change of campaigns or results. `is_watched` returns whether a
  /// page is open; otherwise files are read only on request. `pause` is the shortest time between
  /// two checks of the files.
  CampaignIndex(std::filesystem::path site, std::filesystem::path out,
                std::function<void()> changed, std::function<bool()> is_watched,
                std::chrono::duration<double> pause = std::chrono::seconds(5));
  CampaignIndex(const CampaignIndex&) = delete;
  CampaignIndex& operator=(const CampaignIndex&) = delete;
  ~CampaignIndex();

  /// Returns one page of the matching campaigns, newest first, or the last page if `query.page`
  /// does not exist.
  CampaignPage find(const CampaignQuery& query) const;
  /// Calls `take` in the order of `find`; `take` must not call the index.
  void each(const std::function<void(const ListedCampaign&)>& take) const;
  std::uint64_t version() const;
  bool has(const std::string& folder) const;
  std::size_t size() const;
  /// Reads this campaign at once.
  void look_at(const std::string& folder);
  /// Requests a check of all campaigns without the pause.
  void look_soon();
  /// Requests a check of all campaigns if the last one ended longer ago than `pause`.
  void look_if_old();

 private:
  struct Seen {
    ListedCampaign campaign;
    std::string stamp;
  };
  /// What campaigns do not state themselves.
  struct SiteFacts {
    std::string stamp;
    std::map<std::string, std::string> asset_of_alias{}, certificate_in_force{};
    bool has_register = false;
  };
  void look_at_site();
  struct IsNewer {
    bool operator()(const ListedCampaign* a, const ListedCampaign* b) const;
  };
  std::string stamp_of(const std::string& folder, const std::string& id) const;
  Seen read(const std::string& folder) const;
  void run();
  /// Reads campaigns with changed files and removes those that no longer exist. Returns whether
  /// anything has changed; true after the first check, false if the index ends.
  bool look_at_all();
  bool is_over() const;

  std::filesystem::path site_, out_;
  std::function<void()> changed_;
  std::function<bool()> is_watched_;
  std::chrono::duration<double> pause_;
  std::chrono::steady_clock::time_point last_look_{};
  mutable std::mutex mutex_;
  std::condition_variable wake_;
  std::map<std::string, Seen> seen_{};
  std::shared_ptr<const SiteFacts> facts_ = std::make_shared<SiteFacts>();
  std::set<const ListedCampaign*, IsNewer> order_{};
  std::uint64_t version_ = 1;
  bool over_ = false, soon_ = true, complete_ = false;
  std::thread thread_;
};

}  // namespace nonio::live
