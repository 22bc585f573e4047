// SPDX-License-Identifier: Apache-2.0
#include "batch/survey/survey.h"

#include <algorithm>
#include <cstdint>
#include <map>
#include <numeric>
#include <set>
#include <span>
#include <string>
#include <thread>
#include <vector>

#include "batch/state/wire.h"
#include "batch/survey/earlier_results.h"
#include "batch/survey/site_walk.h"
#include "batch/survey/survey_look.h"
#include "batch/survey/twins.h"
#include "campaign/evaluation/record.h"
#include "platform/process/watched.h"
#include "platform/storage/files.h"

namespace nonio::storage {
NONIO_MEMBERS(batch::CampaignState, a, b, c, d, e, f, g, h, i, j, k, l, m, n)
}  // namespace nonio::storage

namespace nonio::batch {
namespace fs = std::filesystem;

namespace {

/// Large enough that starting a process is cheap compared with its work, small enough that a crash
/// costs little.
constexpr std::size_t campaigns_in_batch = 2000;
/// Number of campaigns without a response after which the waiting time is one second.
constexpr std::size_t most_patience = 8;

Error unknown_number(const std::string& number, const std::filesystem::path& out) {
  return Error{"the register of certificates does not know the number " + number + ", which " +
               out.string() +
               " states was issued: restore the register, or numbers would be used twice"};
}

struct Batch {
  std::vector<std::uint32_t> campaigns{};
  bool rough = false;
  std::size_t received = 0;
};

class Pool {
 public:
  Pool(const SurveyInput& input, std::vector<CampaignState>& states)
      : in_(input), states_(states) {}

  Expected<void> run(std::span<const std::uint32_t> which) {
    const std::size_t cores = std::max(1U, std::thread::hardware_concurrency());
    // Several batches per core let all cores end at about the same time.
    const std::size_t size =
        std::clamp(which.size() / (4 * cores), std::size_t{1}, campaigns_in_batch);
    while ((!which.empty() || !todo_.empty() || !children_.empty()) && !in_.stopped()) {
      while ((!which.empty() || !todo_.empty()) && children_.size() < cores) {
        if (todo_.empty()) {
          const auto next = which.first(std::min(size, which.size()));
          todo_.push_back({{next.begin(), next.end()}});
          which = which.subspan(next.size());
        }
        if (auto started = start(); !started) return started;
      }
      process::wait_for_any(children_);
      for (std::size_t i = children_.size(); i-- > 0;) serve(i);
    }
    if (!unknown_.empty()) return fail(unknown_number(unknown_, in_.out));
    return {};
  }

 private:
  Expected<void> start() {
    Batch batch = std::move(todo_.back());
    todo_.pop_back();
    auto child = process::Watched::start(
        [&](process::SignsOfLife& signs, const process::Watched::Send& send) {
          ChangeDetector look(in_, signs);
          for (std::size_t i = 0; i < batch.campaigns.size(); ++i) {
            signs.index = i;
            const CampaignState state = look.at(states_[batch.campaigns[i]], batch.rough);
            send(storage::pack(state, look.unknown_number()));
          }
        },
        in_.context.site.limits.memory_MB);
    if (!child) return fail(child.error());
    children_.push_back(std::move(*child));
    batches_.push_back(std::move(batch));
    return {};
  }

  void serve(std::size_t i) {
    process::Watched& child = children_[i];
    Batch& batch = batches_[i];
    for (const std::string& piece : child.take())
      if (batch.received < batch.campaigns.size()) {
        std::string unknown;
        storage::unpack(piece, states_[batch.campaigns[batch.received++]], unknown);
        if (!unknown.empty()) unknown_ = std::move(unknown);
      }
    const double seconds = in_.context.site.limits.disk_seconds;
    const double patience = hung_ < most_patience ? seconds : std::min(seconds, 1.0);
    const bool silent = !child.ended() && child.is_silent(patience);
    if (!child.ended() && !silent) return;
    if (batch.received < batch.campaigns.size()) cut_short(child, batch, silent, patience);
    children_.erase(children_.begin() + static_cast<std::ptrdiff_t>(i));
    batches_.erase(batches_.begin() + static_cast<std::ptrdiff_t>(i));
  }

  /// A campaign whose files do not respond fails. After a crash, the campaign is tried alone, at
  /// most twice, and then fails. Another process continues with the rest of the batch.
  void cut_short(process::Watched& child, const Batch& batch, bool silent, double patience) {
    const std::size_t at =
        std::clamp<std::size_t>(child.signs().index, batch.received, batch.campaigns.size() - 1);
    const std::string place = storage::path_text(child.signs().reads_from());
    const bool hangs = silent && child.signs().reads;
    const process::ChildEnd end = child.end();
    const std::uint32_t campaign = batch.campaigns[at];
    Batch rest{{}, batch.rough};
    for (std::size_t i = batch.received; i < batch.campaigns.size(); ++i)
      if (i != at) rest.campaigns.push_back(batch.campaigns[i]);
    if (!rest.campaigns.empty()) todo_.push_back(std::move(rest));
    const int tried = ++trials_[campaign];
    if (hangs) ++hung_;
    if (hangs)
      fail_at(campaign, {process::no_answer(patience), place});
    else if (tried <= 2)
      todo_.push_back({{campaign}, tried == 2 || silent});
    else
      fail_at(campaign, {"the process that looked at it ended: " + end.words, place});
  }

  void fail_at(std::uint32_t campaign, Error why) {
    CampaignState& state = states_[campaign];
    state.named_by_folder = true;
    state.status = evaluation::Status::failed;
    state.reason = "not evaluated";
    state.errors = {std::move(why)};
  }

  const SurveyInput& in_;
  std::vector<CampaignState>& states_;
  std::vector<Batch> todo_;
  std::vector<process::Watched> children_;
  std::vector<Batch> batches_;
  std::map<std::uint32_t, int> trials_;
  std::size_t hung_ = 0;
  std::string unknown_;
};

/// Sets the states with the indices `which` on all cores, in child processes, so that a disk that
/// hangs or a crash does no harm. An error if no process can be started or the register lacks a
/// number.
Expected<void> look_at_all(const SurveyInput& input, std::span<const std::uint32_t> which,
                           std::vector<CampaignState>& states) {
  return Pool(input, states).run(which);
}

std::string folder_id(const std::string& folder) {
  std::string id = folder == "." ? "campaign" : fs::path(folder).filename().string();
  for (char& c : id) {
    if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
    if (!config::is_campaign_id(std::string("a") + c)) c = '-';
  }
  id.insert(0, id.empty() || id.front() == '.' || !config::is_campaign_id(id) ? "campaign-" : "");
  return id.substr(0, 100);
}

/// Sets the id of campaigns whose manifest states none: the id of earlier results of the folder,
/// otherwise a unique id made from the name of the folder.
void name_by_folder(std::vector<CampaignState>& states, const std::vector<EarlierResult>& earlier,
                    const ClaimedIds& claimed) {
  std::map<std::string_view, std::string_view> known;
  std::set<std::string> taken;
  for (const EarlierResult& e : earlier) {
    // A result that did not fail has the id of a valid manifest, which has precedence.
    const auto [at, is_new] = known.emplace(e.folder, e.id);
    if (!is_new && !e.failed) at->second = e.id;
    taken.insert(e.id);
  }
  for (CampaignState& s : states) {
    if (!s.named_by_folder) continue;
    if (const auto at = known.find(storage::path_text(s.folder)); at != known.end()) {
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

/// Campaigns with equal ids fail, because their results would share a folder. A message names at
/// most four of their folders.
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
                   storage::path_text(states[k].folder);
      if (named < end) folders += " and " + std::to_string(end - named) + " more folders";
      for (std::size_t k = i; k < end; ++k) {
        states[k].action = CampaignState::Action::todo;
        states[k].status = evaluation::Status::failed;
        states[k].reason = "no result: its id is not unique";
        states[k].errors = {Error{"campaign.id \"" + states[k].id + "\" is used by " + folders +
                                      "; expected one id for one campaign",
                                  config::manifest_name}};
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
  state.errors = {Error{"the folder " + storage::path_text(unlisted.folder) +
                        " cannot be listed, so its content is not known: " + unlisted.why}};
  return state;
}

void compare_twins(CampaignState& state, const std::vector<CampaignState>& all) {
  const reading::Twins before = state.twins_before;
  state.twins_before = {};
  if (state.action == CampaignState::Action::todo) return;
  const reading::Twins now = twins_of(state, all);
  if (now == before) return;
  state.action = CampaignState::Action::todo;
  state.status = evaluation::Status::none;
  state.errors = {};
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
  for (const std::string& folder : walk->campaigns) {
    states.emplace_back();
    states.back().folder = folder;
  }
  walk->campaigns = std::vector<std::string>();
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
    NONIO_TRY(const auto earlier, unclaimed_results(input.out, claimed));
    name_by_folder(states, earlier, claimed);
    std::vector<std::uint32_t> which;
    for (std::size_t i = 0; i < states.size(); ++i)
      if (states[i].named_by_folder && states[i].status == evaluation::Status::none)
        which.push_back(static_cast<std::uint32_t>(i));
    if (auto looked = look_at_all(input, which, states); !looked) return fail(looked.error());
    all.vanished = vanished_of(earlier, states, walked, walk->unlisted, input.out, input.notes);
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
