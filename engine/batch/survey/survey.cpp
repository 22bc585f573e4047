// SPDX-License-Identifier: Apache-2.0
#include "batch/survey/survey.h"

#include <algorithm>
#include <map>
#include <numeric>
#include <set>

#include "batch/survey/earlier_results.h"
#include "batch/survey/site_walk.h"
#include "batch/survey/survey_pool.h"
#include "batch/survey/twins.h"
#include "campaign/evaluation/record.h"
#include "platform/storage/files.h"

namespace nonio::batch {
namespace fs = std::filesystem;

namespace {

/// An id for a campaign whose manifest does not give one: its folder's name.
std::string folder_id(const std::string& folder) {
  std::string id = folder == "." ? "campaign" : fs::path(folder).filename().string();
  for (char& c : id) {
    if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
    if (!config::is_campaign_id(std::string("a") + c)) c = '-';
  }
  id.insert(0, id.empty() || id.front() == '.' || !config::is_campaign_id(id) ? "campaign-" : "");
  return id.substr(0, 100);
}

/// A name for each campaign whose manifest gives none: the one under which its folder has results,
/// else the folder's, which gives way to every id that is taken.
void name_by_folder(std::vector<CampaignState>& states, const std::vector<EarlierResult>& earlier,
                    const ClaimedIds& claimed) {
  std::map<std::string_view, std::string_view> known;  // id by folder
  std::set<std::string> taken;
  for (const EarlierResult& e : earlier) {
    // A name that was made of the folder itself gives way to one that a manifest gave.
    const auto [at, is_new] = known.emplace(e.folder, e.id);
    if (!is_new && !e.failed) at->second = e.id;
    taken.insert(e.id);
  }
  for (CampaignState& s : states) {
    if (!s.named_by_folder) continue;
    if (const auto at = known.find(storage::path_text(s.folder.view())); at != known.end()) {
      s.id = at->second;
      known.erase(at);
      continue;
    }
    const std::string name = folder_id(s.folder);
    std::string id = name;
    for (int n = 2; claimed.contains(id) || !taken.insert(id).second; ++n)
      id = name + "." + std::to_string(n);
    s.id = id;
  }
}

/// Different campaigns with one id: none of them may claim the output folder. The message names a
/// few of them only, since all of them carry it.
void fail_collisions(std::vector<CampaignState>& states) {
  constexpr std::size_t most_named = 4;
  for (std::size_t i = 0; i < states.size();) {
    std::size_t end = i + 1;
    while (end < states.size() && states[end].id == states[i].id) ++end;
    if (end - i > 1) {
      std::string folders;
      const std::size_t named = std::min(end, i + most_named);
      for (std::size_t k = i; k < named; ++k)
        folders += (k == i         ? ""
                    : k + 1 == end ? " and "
                                   : ", ") +
                   storage::path_text(states[k].folder.view());
      if (named < end) folders += " and " + std::to_string(end - named) + " more folders";
      for (std::size_t k = i; k < end; ++k) {
        states[k].action = CampaignState::Action::todo;
        states[k].status = evaluation::Status::failed;
        states[k].reason = "no result: its id is not unique";
        states[k].set_errors({Error{"campaign.id \"" + states[k].id.str() + "\" is used by " +
                                        folders + "; expected one id for one campaign",
                                    config::manifest_name}});
      }
    }
    i = end;
  }
}

CampaignState failed_folder(const SiteWalk::Unlisted& unlisted) {
  CampaignState state;
  state.folder = unlisted.folder;
  state.named_by_folder = true;
  state.is_campaign = false;
  state.status = evaluation::Status::failed;
  state.reason = "the folder cannot be listed";
  state.set_errors({Error{"the folder " + storage::path_text(unlisted.folder) +
                          " cannot be listed, so its content is not known: " + unlisted.why}});
  return state;
}

/// Whether other campaigns share readings as they did when the record was written.
void compare_twins(CampaignState& state, const std::vector<CampaignState>& all) {
  const reading::Twins before = state.twins_before();
  state.set_twins_before({});
  if (state.action == CampaignState::Action::todo) return;
  const reading::Twins now = twins_of(state, all);
  if (now == before) return;
  state.action = CampaignState::Action::todo;
  state.status = evaluation::Status::none;
  state.set_errors({});
  state.reason = now.empty() ? "no other campaign has its readings any more"
                             : "campaign " + now.front().second + " has the same readings";
}

}  // namespace

Expected<void> check_numbers(const fs::path& out, const std::vector<CampaignState>& campaigns,
                             const std::vector<certificates::RegisterEntry>& numbers) {
  std::set<std::string> known;
  for (const certificates::RegisterEntry& e : numbers) known.insert(e.number);
  for (const CampaignState& c : campaigns)
    if (const auto record = evaluation::read_record(storage::results_folder(out, c.id));
        record && !record->certificate.empty() && !known.contains(record->certificate))
      return fail(unknown_number(record->certificate, out));
  return {};
}

Expected<Surveyed> survey(const SurveyInput& input) {
  Surveyed all;
  std::vector<CampaignState>& states = all.campaigns;
  auto walk =
      walk_site(input.site, input.out, input.context.site.limits.disk_seconds, input.stopped);
  if (!walk) return fail(walk.error());
  for (std::string& note : walk->notes) input.notes.push_back(std::move(note));
  states.reserve(walk->campaigns.size() + walk->unlisted.size());
  for (const KeptText& folder : walk->campaigns) {
    states.emplace_back();
    states.back().folder = folder;
  }
  std::vector<KeptText>().swap(walk->campaigns);
  {
    std::vector<std::uint32_t> each(states.size());
    std::iota(each.begin(), each.end(), std::uint32_t{0});
    if (auto looked = look_at_all(input, each, states); !looked) return fail(looked.error());
  }
  if (input.stopped()) return all;
  const std::size_t walked = states.size();
  for (const SiteWalk::Unlisted& u : walk->unlisted) states.push_back(failed_folder(u));
  {
    const ClaimedIds claimed(states);
    const auto earlier = unclaimed_results(input.out, claimed);
    if (!earlier) return fail(earlier.error());
    name_by_folder(states, *earlier, claimed);
    std::vector<std::uint32_t> which;
    for (std::size_t i = 0; i < states.size(); ++i)
      if (states[i].named_by_folder && states[i].status == evaluation::Status::none)
        which.push_back(static_cast<std::uint32_t>(i));
    if (auto looked = look_at_all(input, which, states); !looked) return fail(looked.error());
    all.vanished = vanished_of(*earlier, states, walked, walk->unlisted, input.out, input.notes);
  }
  set_in_order(states);
  return all;
}

void set_in_order(std::vector<CampaignState>& campaigns) {
  std::sort(campaigns.begin(), campaigns.end(), [](const CampaignState& a, const CampaignState& b) {
    const auto by_id = a.id <=> b.id;
    return by_id == 0 ? a.folder < b.folder : by_id < 0;
  });
  fail_collisions(campaigns);
  find_twins(campaigns);
  for (CampaignState& state : campaigns) compare_twins(state, campaigns);
}

}  // namespace nonio::batch
