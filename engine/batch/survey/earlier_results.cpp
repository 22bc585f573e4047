// SPDX-License-Identifier: Apache-2.0
#include "batch/survey/earlier_results.h"

#include <algorithm>
#include <map>
#include <string_view>

#include "batch/state/read_apart.h"
#include "campaign/config/manifest.h"
#include "campaign/evaluation/record.h"
#include "certificates/register_place.h"
#include "platform/storage/files.h"

namespace nonio::batch {

namespace fs = std::filesystem;

namespace {

class ByFolder {
 public:
  ByFolder(const std::vector<CampaignState>& campaigns, std::size_t ordered)
      : first_(campaigns.data()), end_(first_ + ordered) {
    for (const CampaignState& c : campaigns) {
      std::string text = storage::path_text(c.folder);
      if (&c >= end_ || text != c.folder) others_.emplace(std::move(text), &c);
    }
  }

  const CampaignState* at(const std::string& folder) const {
    const CampaignState* const found = std::lower_bound(
        first_, end_, folder,
        [](const CampaignState& c, const std::string& text) { return c.folder < text; });
    if (found != end_ && found->folder == folder) return found;
    const auto other = others_.find(folder);
    return other == others_.end() ? nullptr : other->second;
  }

 private:
  const CampaignState* first_;
  const CampaignState* end_;
  // Folders that are not UTF-8 or not in the sorted part.
  std::map<std::string, const CampaignState*> others_;
};

}  // namespace

ClaimedIds::ClaimedIds(const std::vector<CampaignState>& campaigns) : campaigns_(campaigns) {
  by_id_.reserve(campaigns.size());
  for (std::size_t i = 0; i < campaigns.size(); ++i)
    if (!campaigns[i].named_by_folder) by_id_.push_back(static_cast<std::uint32_t>(i));
  std::sort(by_id_.begin(), by_id_.end(),
            [&](std::uint32_t a, std::uint32_t b) { return campaigns[a].id < campaigns[b].id; });
}

bool ClaimedIds::contains(std::string_view id) const {
  const auto found = std::lower_bound(
      by_id_.begin(), by_id_.end(), id,
      [&](std::uint32_t i, std::string_view text) { return campaigns_[i].id < text; });
  return found != by_id_.end() && campaigns_[*found].id == id;
}

Expected<std::vector<EarlierResult>> unclaimed_results(const fs::path& out,
                                                       const ClaimedIds& claimed) {
  std::vector<EarlierResult> found;
  const auto take = [&](const fs::path& folder) {
    std::string id = folder.filename().string();
    if (!config::is_campaign_id(id) || claimed.contains(id)) return;
    if (const auto record = evaluation::read_record(folder))
      found.push_back({std::move(id), record->folder, record->run,
                       record->status == evaluation::Status::failed});
  };
  if (const auto listed = storage::each_results_folder(out, take); !listed)
    return fail(listed.error());
  std::sort(found.begin(), found.end(),
            [](const EarlierResult& a, const EarlierResult& b) { return a.id < b.id; });
  return found;
}

std::vector<Vanished> vanished_of(const std::vector<EarlierResult>& earlier,
                                  const std::vector<CampaignState>& campaigns, std::size_t ordered,
                                  const std::vector<SiteWalk::Unlisted>& unlisted,
                                  const fs::path& out, std::vector<std::string>& notes) {
  std::vector<Vanished> vanished;
  if (earlier.empty()) return vanished;
  const ByFolder by_folder(campaigns, ordered);
  for (const EarlierResult& e : earlier) {
    const CampaignState* const now = by_folder.at(e.folder);
    const std::string meant =
        "if it was removed on purpose, record that (nonio machine remove SITE " + e.id +
        " --by NAME --why TEXT); otherwise restore it";
    const auto above = std::find_if(unlisted.begin(), unlisted.end(), [&](const auto& u) {
      const std::string folder = storage::path_text(u.folder);
      return e.folder == folder || e.folder.starts_with(folder + "/");
    });
    if (now != nullptr && now->id == e.id) continue;
    if (now != nullptr && e.failed)
      notes.push_back(storage::own_folder(out, e.id).string() + " is left over: it states that " +
                      e.folder + " failed, which is the campaign " + now->id + " now");
    else if (now != nullptr)
      vanished.push_back(
          {e.id, e.folder, e.run,
           "its folder " + e.folder + " is the campaign " + now->id + " now; " + meant});
    else if (above != unlisted.end())
      vanished.push_back({e.id, e.folder, e.run,
                          "it was not seen: the folder " + storage::path_text(above->folder) +
                              " could not be listed"});
    else
      vanished.push_back({e.id, e.folder, e.run,
                          "its folder " + e.folder + " no longer exists, or has no " +
                              std::string(config::manifest_name) + " any more; " + meant});
  }
  return vanished;
}

namespace fs = std::filesystem;

namespace {

/// Returns an error if the register is in an output folder inside the site, because it would be
/// lost with this folder.
Expected<void> check_register_place(const RunOptions& options, const reading::Context& context) {
  NONIO_TRY(const auto place, certificates::register_place(options.site, context.site.numbering));
  std::error_code error;
  const auto is_below = [](const fs::path& one, const fs::path& folder) {
    const fs::path way = one.lexically_relative(folder);
    return !way.empty() && *way.begin() != "..";
  };
  const fs::path out = fs::weakly_canonical(options.out, error);
  if (is_below(place.file, out) && is_below(out, fs::weakly_canonical(options.site, error)))
    return fail("the register of certificates " + place.name +
                " would lie in the output folder; expected it elsewhere in the site");
  return {};
}

}  // namespace

Expected<std::optional<Known>> known_of(const RunOptions& options, const reading::Context& context,
                                        Look look) {
  const config::Numbering& numbering = context.site.numbering;
  const double patience = std::min(5.0, numbering.patience);
  auto known = read_apart<
      std::pair<std::vector<certificates::RegisterEntry>, std::vector<certificates::WaitingDraft>>>(
      "the register of certificates", context.site.limits.disk_seconds + patience,
      [&](process::SignsOfLife& signs)
          -> Expected<std::pair<std::vector<certificates::RegisterEntry>,
                                std::vector<certificates::WaitingDraft>>> {
        if (!numbering.server) signs.reading((options.site / numbering.register_file).string());
        if (const auto sound = check_register_place(options, context); !sound)
          return fail(sound.error());
        NONIO_TRY(auto numbers, certificates::Register::entries(options.site, numbering, patience));
        if (!numbers.empty() && look == Look::first) {
          NONIO_TRY(auto opened, certificates::Register::open(options.site, numbering, patience));
          if (auto sound = opened.check_journal(false); !sound) return fail(sound.error());
        }
        signs.beat();
        NONIO_TRY(auto drafts, certificates::Register::drafts(options.site, numbering, patience));
        return std::pair(std::move(numbers), std::move(drafts));
      });
  if (!known && storage::is_locked(known.error())) return std::nullopt;
  if (!known) return fail(known.error());
  return Known{std::move(known->first), std::move(known->second)};
}

std::uint64_t issued_so_far(const std::vector<certificates::RegisterEntry>& numbers) {
  std::uint64_t last = 0;
  for (const certificates::RegisterEntry& e : numbers) last = std::max(last, e.order);
  return last;
}

}  // namespace nonio::batch
