// SPDX-License-Identifier: Apache-2.0
#include "batch/state/campaign_state.h"

#include <bit>
#include <cstring>

namespace nonio::batch {

static_assert(sizeof(CampaignState) == 56, "docs/dev/scale.md states what a campaign takes");

const CampaignState::Seldom& CampaignState::seldom() const {
  static const Seldom nothing;
  return seldom_.at ? *seldom_.at : nothing;
}

CampaignState::Seldom& CampaignState::change() {
  if (!seldom_.at) seldom_.at = std::make_unique<Seldom>();
  return *seldom_.at;
}

void CampaignState::set_errors(std::vector<Error> errors) {
  if (seldom_.at || !errors.empty()) change().errors = std::move(errors);
}

void CampaignState::set_warnings(std::vector<Error> warnings) {
  if (seldom_.at || !warnings.empty()) change().warnings = std::move(warnings);
}

void CampaignState::set_twins_before(std::vector<TwinBefore> twins) {
  if (seldom_.at || !twins.empty()) change().twins_before = std::move(twins);
}

std::vector<std::uint64_t> CampaignState::readings() const {
  if (has_ == Readings::none) return {};
  if (has_ == Readings::one) return {readings_};
  const std::string_view bytes = std::bit_cast<KeptText>(readings_).view();
  std::vector<std::uint64_t> digests(bytes.size() / sizeof(std::uint64_t));
  std::memcpy(digests.data(), bytes.data(), bytes.size());
  return digests;
}

void CampaignState::set_readings(std::span<const std::uint64_t> digests) {
  has_ = digests.empty() ? Readings::none : digests.size() == 1 ? Readings::one : Readings::several;
  readings_ = 0;
  if (has_ == Readings::one) readings_ = digests.front();
  if (has_ == Readings::several)
    readings_ = std::bit_cast<std::uint64_t>(
        KeptText({reinterpret_cast<const char*>(digests.data()), digests.size_bytes()}));
}

}  // namespace nonio::batch
