// SPDX-License-Identifier: Apache-2.0
#include "host/batch/earlier_results.h"

#include <algorithm>
#include <map>
#include <string_view>

#include "host/config/manifest.h"
#include "host/evaluation/record.h"
#include "host/storage/files.h"

namespace nonio::host::batch {
namespace fs = std::filesystem;

Expected<std::vector<EarlierResult>> unclaimed_results(
    const fs::path& out, const std::vector<CampaignState>& campaigns) {
  std::vector<std::string_view> claimed;
  for (const CampaignState& c : campaigns)
    if (!c.named_by_folder) claimed.push_back(c.id);
  std::sort(claimed.begin(), claimed.end());
  std::vector<EarlierResult> found;
  const auto take = [&](const fs::path& folder) {
    std::string id = folder.filename().string();
    if (!config::is_campaign_id(id) || std::binary_search(claimed.begin(), claimed.end(), id))
      return;
    if (const auto record = evaluation::read_record(folder))
      found.push_back({std::move(id), record->folder, record->night,
                       record->status == evaluation::Status::failed});
  };
  if (const auto listed = storage::each_results_folder(out, take); !listed)
    return fail(listed.error());
  std::sort(found.begin(), found.end(),
            [](const EarlierResult& a, const EarlierResult& b) { return a.id < b.id; });
  return found;
}

std::vector<Vanished> vanished_of(const std::vector<EarlierResult>& earlier,
                                  const std::vector<CampaignState>& campaigns,
                                  const std::vector<SiteWalk::Unlisted>& unlisted,
                                  const fs::path& out, std::vector<std::string>& notes) {
  std::vector<Vanished> vanished;
  if (earlier.empty()) return vanished;
  std::map<std::string, std::string_view> id_of;  // by folder
  for (const CampaignState& c : campaigns) id_of.emplace(storage::path_text(c.folder), c.id);
  for (const EarlierResult& e : earlier) {
    const auto now = id_of.find(e.folder);
    const std::string meant = "if it was removed on purpose, record that (nonio forget SITE " +
                              e.id + " --by NAME --why TEXT); otherwise restore it";
    const auto above = std::find_if(unlisted.begin(), unlisted.end(), [&](const auto& u) {
      const std::string folder = storage::path_text(u.folder);
      return e.folder == folder || e.folder.starts_with(folder + "/");
    });
    if (now != id_of.end() && now->second == e.id) continue;
    if (now != id_of.end() && e.failed)
      notes.push_back(storage::own_folder(out, e.id).string() + " is left over: it says that " +
                      e.folder + " failed, which is the campaign " + std::string(now->second) +
                      " now");
    else if (now != id_of.end())
      vanished.push_back({e.id, e.folder, e.night,
                          "its folder " + e.folder + " is the campaign " +
                              std::string(now->second) + " now; " + meant});
    else if (above != unlisted.end())
      vanished.push_back({e.id, e.folder, e.night,
                          "it was not seen: the folder " + storage::path_text(above->folder) +
                              " could not be listed"});
    else
      vanished.push_back({e.id, e.folder, e.night,
                          "its folder " + e.folder + " is gone, or has no " +
                              std::string(config::manifest_name) + " any more; " + meant});
  }
  return vanished;
}

}  // namespace nonio::host::batch
