// SPDX-License-Identifier: Apache-2.0
#include "batch/close/night_history.h"

#include "batch/close/shown_histories.h"
#include "platform/process/stop.h"

namespace nonio::batch {
using Action = CampaignState::Action;

void write_history(Night& night, HistoryUpdate& history, std::uint64_t known,
                   const std::vector<std::string>& done, const Expected<store::Told>& told,
                   const RunEvents& events) {
  auto notes = history.end(known, night.night.number, done, told);
  if (!notes) {
    night.history_error = notes.error().message;
    notes = {"this run is not in the history: " + night.history_error +
             "; the results are complete, and the next run enters them"};
  } else if (!notes->empty()) {
    night.history_error = notes->front();
  }
  for (std::string& note : *notes) {
    events.note(note);
    night.notes.push_back(std::move(note));
  }
}

bool show_histories(const RunOptions& options, const RunEvents& events,
                    const reading::Context& context, const NightState& state, ReleaseDesk desk,
                    HistoryUpdate& history, const Expected<store::Told>& told,
                    const std::string& only, Night& night) {
  if (!told || !night.history_error.empty()) return true;  // reported already; the next run does it
  const ShownHistories shown(options, context);
  auto others = shown.others(night.campaigns, *told, history.rebuilt());
  std::string error = others ? std::string() : others.error().message;
  bool all = true;
  if (others && !only.empty())
    all = std::erase_if(*others, [&](const auto& other) { return other.first != only; }) == 0;
  if (others && !others->empty())
    if (const auto begun = shown.begin(); !begun) error = begun.error().message;
  if (error.empty() && !others->empty()) {
    std::vector<std::string> again;
    for (CampaignState& c : night.campaigns) {
      if (!others->contains(c.id)) continue;
      if (c.action != Action::done) c.reason = "the history of its machine changed";
      c.action = Action::todo;
      again.push_back(c.id);
    }
    desk.histories = std::move(*others);
    if (!do_campaigns(options, events, context, state, desk, night.campaigns)) return false;
    write_history(night, history, state.number, again, told, events);
  }
  if (error.empty() && all)
    if (const auto ended = shown.end(night.campaigns, *told); !ended) error = ended.error().message;
  if (error.empty() || process::is_stop_requested()) return !process::is_stop_requested();
  night.history_error = "histories in reports are not up to date: " + error;
  night.notes.push_back(night.history_error + "; the next run writes them");
  events.note(night.notes.back());
  return true;
}

}  // namespace nonio::batch
