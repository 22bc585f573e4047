// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <map>
#include <mutex>
#include <set>
#include <string>
#include <thread>
#include <vector>

#include "platform/storage/json_values.h"

/// Index of a site's campaigns, kept in memory.
namespace nonio::live {

/// One campaign as stated in campaign.toml, run.json and results.json.
struct ListedCampaign {
  std::string folder, id, day, customer, place;
  std::string machine, model;           ///< name of the machine in the history, and its model;
                                        ///< empty: none
  std::string state;                    ///< state of the campaign: new, ok, attention, failed
  std::string verdict;                  ///< worst decision on a tolerance; empty: none
  std::string certificate;              ///< number of the certificate; empty: none
  std::string message;                  ///< message of the first error; empty: no error
  bool draft = false;                   ///< whether a draft of a certificate waits for approval
  bool changed = false;                 ///< whether campaign.toml has changed since the results
                                        ///< were made
  std::vector<std::string> files{};     ///< names of the output files
  std::vector<std::string> findings{};  ///< findings with severity warning, as text
  std::vector<std::string> columns{};   ///< entries of the reader's option `columns` in
                                        ///< campaign.toml
  /// Values that a form can take over, by keys of campaign.toml, with units in the keys.
  std::map<std::string, std::string> values{};
  std::string words{};  ///< all searchable text in lower case
};

/// Returns a text that changes when the file is written or replaced; "-;" if it does not exist.
std::string file_stamp(const std::filesystem::path& path);

/// Returns the words of a search in lower case.
std::vector<std::string> words_of(const std::string& search);
/// Whether all words of a search occur in a text in lower case.
bool has_all(const std::string& text, const std::vector<std::string>& words);
/// Returns the first place of a page in a list of `all` entries; of the last page, if `page` is
/// beyond it.
std::size_t begin_of_page(std::size_t page, std::size_t size, std::size_t all);

struct CampaignQuery {
  std::string search{};  ///< words that must all occur
  std::string folder{};  ///< folder of the only campaign to find; empty: any
  std::string state{};   ///< required state or verdict, "draft" or "certificate"; empty: any
  std::size_t page = 0, size = 50;
};

struct CampaignPage {
  std::size_t found = 0, all = 0;
  bool complete = false;  ///< whether all campaigns have been read
  std::vector<ListedCampaign> campaigns{};
};

/// Reads the campaigns of a site in a thread of its own, and reads changed ones again. Size and
/// time of a file only determine when it is read again, not the state of the campaign. The first
/// reading of 10,000 campaigns takes seconds, an answer from memory milliseconds.
class CampaignIndex {
 public:
  /// `changed` is called when campaigns or results have changed. `is_watched` returns whether a
  /// page is open; while none is, files are read only on request. `pause`: shortest time between
  /// two checks of the files.
  CampaignIndex(std::filesystem::path site, std::filesystem::path out,
                std::function<void()> changed, std::function<bool()> is_watched,
                std::chrono::duration<double> pause = std::chrono::seconds(5));
  CampaignIndex(const CampaignIndex&) = delete;
  CampaignIndex& operator=(const CampaignIndex&) = delete;
  ~CampaignIndex();

  /// Returns one page of the matching campaigns by day, the newest first, then by id; beyond the
  /// last page, the last page.
  CampaignPage find(const CampaignQuery& query) const;
  /// Calls `take` for all campaigns in the order of `find`; `take` must not call the index.
  void each(const std::function<void(const ListedCampaign&)>& take) const;
  /// Returns a number that grows with each change of a campaign.
  std::uint64_t version() const;
  bool has(const std::string& folder) const;
  std::size_t size() const;
  /// Reads this campaign at once.
  void look_at(const std::string& folder);
  /// Requests a check of all campaigns soon, because something has changed.
  void look_soon();
  /// Requests a check of all campaigns soon if the last one ended longer ago than `pause`.
  void look_if_old();

 private:
  struct Seen {
    ListedCampaign campaign;
    std::string stamp;
  };
  struct IsNewer {
    bool operator()(const ListedCampaign* a, const ListedCampaign* b) const;
  };
  std::string stamp_of(const std::string& folder, const std::string& id) const;
  Seen read(const std::string& folder) const;
  void run();
  /// Reads all campaigns whose files have changed, and removes those that no longer exist. Returns
  /// whether anything has changed; true for the first complete check, and false if the index ends.
  bool look_at_all();
  bool is_over() const;

  std::filesystem::path site_, out_;
  std::function<void()> changed_;
  std::function<bool()> is_watched_;
  std::chrono::duration<double> pause_;
  std::chrono::steady_clock::time_point last_look_{};
  mutable std::mutex mutex_;
  std::condition_variable wake_;
  std::map<std::string, Seen> seen_{};  ///< campaigns as they were last read, by folder
  std::set<const ListedCampaign*, IsNewer> order_{};  ///< the campaigns of `seen_`
  std::uint64_t version_ = 1;
  bool over_ = false, soon_ = true, complete_ = false;
  std::thread thread_;
};

}  // namespace nonio::live
