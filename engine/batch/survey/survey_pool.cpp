// SPDX-License-Identifier: Apache-2.0
#include "batch/survey/survey_pool.h"

#include <algorithm>
#include <map>
#include <span>
#include <thread>

#include "batch/survey/survey_look.h"
#include "platform/process/watched.h"
#include "platform/storage/files.h"

namespace nonio::batch {

namespace {

/// So many campaigns for one process: starting it is then cheap, and a crash costs little.
constexpr std::size_t campaigns_in_batch = 2000;
/// After so many that hang, a disk gets no more time than a second.
constexpr std::size_t most_patience = 8;

void pack(process::Parcel& parcel, const std::vector<Error>& errors) {
  parcel.add(errors.size());
  for (const Error& e : errors) parcel.add(e.message).add(e.file).add(e.line).add(e.column);
}

/// After those that `known` holds already.
std::vector<Error> unpack_errors(process::Parcel& parcel, std::vector<Error> known) {
  for (std::uint64_t n = parcel.number(); n-- > 0;) {
    Error error{parcel.text()};
    error.file = parcel.text();
    error.line = parcel.number();
    error.column = parcel.text();
    known.push_back(std::move(error));
  }
  return known;
}

process::Parcel packed(const CampaignState& state, const std::string& unknown) {
  process::Parcel parcel;
  parcel.add(state.id.view()).add(std::uint64_t{state.named_by_folder});
  parcel.add(static_cast<std::uint64_t>(state.action)).add(state.reason.view());
  parcel.add(static_cast<std::uint64_t>(state.status));
  parcel.add(unknown);
  pack(parcel, state.errors());
  pack(parcel, state.warnings());
  const std::vector<std::uint64_t> readings = state.readings();
  parcel.add(readings.size());
  for (const std::uint64_t digest : readings) parcel.add(digest);
  parcel.add(state.twins_before().size());
  for (const auto& [digest, id] : state.twins_before()) parcel.add(digest).add(id);
  parcel.add(std::uint64_t{state.shows_history}).add(state.history.view());
  return parcel;
}

/// Into a state that knows its folder; a number that the register does not know.
std::string unpack(process::Parcel& parcel, CampaignState& state) {
  state.id = parcel.text();
  state.named_by_folder = parcel.number() != 0;
  state.action = static_cast<CampaignState::Action>(parcel.number());
  state.reason = KeptText::shared(parcel.text());
  state.status = static_cast<evaluation::Status>(parcel.number());
  std::string unknown = parcel.text();
  state.set_errors(unpack_errors(parcel, state.errors()));
  state.set_warnings(unpack_errors(parcel, {}));
  std::vector<std::uint64_t> readings;
  for (std::uint64_t n = parcel.number(); n-- > 0;) readings.push_back(parcel.number());
  state.set_readings(readings);
  std::vector<CampaignState::TwinBefore> twins_before;
  for (std::uint64_t n = parcel.number(); n-- > 0;) {
    const std::uint64_t digest = parcel.number();
    twins_before.emplace_back(digest, parcel.text());
  }
  state.set_twins_before(std::move(twins_before));
  state.shows_history = parcel.number() != 0;
  state.history = parcel.text();
  return unknown;
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
    // Several for each core, so that all end at about the same time.
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
      process::wait_for_parcels(children_);
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
            send(packed(state, look.unknown_number()));
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
    for (process::Parcel& parcel : child.take())
      if (batch.received < batch.campaigns.size())
        if (auto unknown = unpack(parcel, states_[batch.campaigns[batch.received++]]);
            !unknown.empty())
          unknown_ = std::move(unknown);
    const double seconds = in_.context.site.limits.disk_seconds;
    const double patience = hung_ < most_patience ? seconds : std::min(seconds, 1.0);
    const bool silent = !child.ended() && child.is_silent(patience);
    if (!child.ended() && !silent) return;
    if (batch.received < batch.campaigns.size()) cut_short(child, batch, silent, patience);
    children_.erase(children_.begin() + static_cast<std::ptrdiff_t>(i));
    batches_.erase(batches_.begin() + static_cast<std::ptrdiff_t>(i));
  }

  /// The campaign that it was at is tried alone, or failed; the others are done by another process.
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
    state.set_errors({std::move(why)});
  }

  const SurveyInput& in_;
  std::vector<CampaignState>& states_;
  std::vector<Batch> todo_;  // before all others
  std::vector<process::Watched> children_;
  std::vector<Batch> batches_;  // of the children
  std::map<std::uint32_t, int> trials_;
  std::size_t hung_ = 0;
  std::string unknown_;
};

}  // namespace

Expected<void> look_at_all(const SurveyInput& input, std::span<const std::uint32_t> which,
                           std::vector<CampaignState>& states) {
  return Pool(input, states).run(which);
}

Error unknown_number(const std::string& number, const std::filesystem::path& out) {
  return Error{"the register of certificates does not know the number " + number + ", which " +
               out.string() +
               " states was issued: restore the register, or numbers would be used twice"};
}

}  // namespace nonio::batch
