// SPDX-License-Identifier: Apache-2.0
#include "host/batch/twins.h"

#include <algorithm>

#include "host/storage/digest.h"

namespace nonio::host::batch {
void find_twins(std::vector<CampaignState>& campaigns) {
  using File = std::pair<std::uint64_t, std::uint32_t>;  // digest, campaign
  std::vector<File> files;
  for (std::size_t i = 0; i < campaigns.size(); ++i) {
    for (const std::uint64_t digest : campaigns[i].readings)
      files.emplace_back(digest, static_cast<std::uint32_t>(i));
    std::vector<std::uint64_t>().swap(campaigns[i].readings);
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

}  // namespace nonio::host::batch
