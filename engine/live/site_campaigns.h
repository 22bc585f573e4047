// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <memory>
#include <mutex>
#include <string>
#include <vector>

#include "live/campaign_lists.h"
#include "live/service.h"
#include "live/tool.h"

namespace nonio::live {

/// Campaigns on the page of a site: lists, values for forms, preview of a dropped file, new
/// campaigns. Thread-safe.
class SiteCampaigns {
 public:
  /// `call` runs a command of this program; `changed` is called when a list has changed;
  /// `is_watched` returns whether a page is open.
  using Call = std::function<ToolEnd(std::vector<std::string>)>;
  SiteCampaigns(std::filesystem::path site, std::filesystem::path out, Call call,
                std::function<void()> changed, std::function<bool()> is_watched);

  static std::vector<Route> routes();
  /// `what` is the path after "/api/".
  Answer answer(const std::string& what, const Request& request);
  CampaignIndex& index() { return index_; }

 private:
  Answer list(const Request& request) const;
  Answer machines(const Request& request);
  std::shared_ptr<const CampaignLists> lists();
  Answer preview(const Request& request);
  Answer create(const Request& request);
  tl::expected<std::string, Answer> take_folder(const std::string& id);

  std::filesystem::path site_, out_;
  Call call_;
  std::mutex listing_;
  std::shared_ptr<const CampaignLists> lists_;
  CampaignIndex index_;  ///< declared last, because its thread uses all other members
};

}  // namespace nonio::live
