// SPDX-License-Identifier: Apache-2.0
#include "batch/survey/twins.h"

#include <algorithm>

#include "platform/storage/digest.h"

namespace nonio::batch {

namespace {

/// Returns the sorted digests that occur more than once. They are few, so that only their campaigns
/// must be stored.
std::vector<std::uint64_t> found_again(const std::vector<CampaignState>& campaigns) {
  std::size_t count = 0;
  for (const CampaignState& c : campaigns) count += c.readings.size();
  std::vector<std::uint64_t> all;
  all.reserve(count);
  for (const CampaignState& c : campaigns)
    for (const std::uint64_t digest : c.readings) all.push_back(digest);
  std::sort(all.begin(), all.end());
  std::vector<std::uint64_t> again;
  for (std::size_t i = 1; i < all.size(); ++i)
    if (all[i] == all[i - 1] && (again.empty() || again.back() != all[i])) again.push_back(all[i]);
  return again;
}

}  // namespace

void find_twins(std::vector<CampaignState>& campaigns) {
  using File = std::pair<std::uint64_t, std::uint32_t>;
  const std::vector<std::uint64_t> often = found_again(campaigns);
  std::vector<File> files;
  for (std::size_t i = 0; i < campaigns.size(); ++i) {
    for (const std::uint64_t digest : campaigns[i].readings)
      if (std::binary_search(often.begin(), often.end(), digest))
        files.emplace_back(digest, static_cast<std::uint32_t>(i));
    campaigns[i].readings = std::vector<std::uint64_t>();
  }
  std::sort(files.begin(), files.end());
  files.erase(std::unique(files.begin(), files.end()), files.end());
  for (std::size_t i = 0, end = 0; i < files.size(); i = end) {
    for (end = i + 1; end < files.size() && files[end].first == files[i].first;) ++end;
    for (std::size_t k = i; end - i > 1 && k < end; ++k)
      campaigns[files[k].second].twins.emplace_back(files[k].first,
                                                    files[k == i ? i + 1 : i].second);
  }
}

reading::Twins twins_of(const CampaignState& campaign, const std::vector<CampaignState>& all) {
  reading::Twins twins;
  for (const auto& [digest, other] : campaign.twins) twins.emplace_back(digest, all[other].id);
  std::sort(twins.begin(), twins.end());
  return twins;
}

reading::Twins twins_of(const reading::Inputs& inputs) {
  reading::Twins twins;
  const std::string shared = reading::shared_name(""), file = reading::input_name("");
  for (const auto& [name, other] : inputs)
    if (name.starts_with(shared))
      for (const auto& [input, digest] : inputs)
        if (input == file + name.substr(shared.size()))
          twins.emplace_back(storage::short_digest(digest), other);
  std::sort(twins.begin(), twins.end());
  twins.erase(std::unique(twins.begin(), twins.end()), twins.end());
  return twins;
}

}  // namespace nonio::batch
