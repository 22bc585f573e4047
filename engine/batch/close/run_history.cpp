// SPDX-License-Identifier: Apache-2.0
#include "batch/close/run_history.h"

#include "batch/close/shown_histories.h"
#include "platform/process/stop.h"

namespace nonio::batch {
using Action = CampaignState::Action;

void write_history(RunResult& run, HistoryUpdate& history, std::uint64_t known,
                   const std::vector<std::string>& done,
                   const Expected<store::SiteRecords>& records, const RunEvents& events) {
  auto notes = history.end(known, run.run.number, done, records);
  if (!notes) {
    run.history_error = notes.error().message;
    notes = {"this run is not in the history: " + run.history_error +
             "; the results are complete, and the next run enters them"};
  } else if (!notes->empty()) {
    run.history_error = notes->front();
  }
  for (std::string& note : *notes) {
    events.note(note);
    run.notes.push_back(std::move(note));
  }
}

bool show_histories(const RunOptions& options, const RunEvents& events,
                    const reading::Context& context, const RunState& state, ReleaseDesk desk,
                    HistoryUpdate& history, const Expected<store::SiteRecords>& records,
                    const std::string& only, RunResult& run) {
  if (!records || !run.history_error.empty()) return true;
  const ShownHistories shown(options, context);
  auto others = shown.others(run.campaigns, *records, history.rebuilt());
  std::string error = others ? std::string() : others.error().message;
  bool all = true;
  if (others && !only.empty())
    all = std::erase_if(*others, [&](const auto& other) { return other.first != only; }) == 0;
  if (others && !others->empty())
    if (const auto begun = shown.begin(); !begun) error = begun.error().message;
  if (error.empty() && !others->empty()) {
    std::vector<std::string> again;
    for (CampaignState& c : run.campaigns) {
      if (!others->contains(c.id)) continue;
      if (c.action != Action::done) c.reason = "the history of its machine changed";
      c.action = Action::todo;
      again.push_back(c.id);
    }
    desk.histories = std::move(*others);
    if (!do_campaigns(options, events, context, state, desk, run.campaigns)) return false;
    write_history(run, history, state.number, again, records, events);
  }
  if (error.empty() && all)
    if (const auto ended = shown.end(run.campaigns, *records); !ended)
      error = ended.error().message;
  if (error.empty() || process::is_stop_requested()) return !process::is_stop_requested();
  run.history_error = "histories in reports are not up to date: " + error;
  run.notes.push_back(run.history_error + "; the next run writes them");
  events.note(run.notes.back());
  return true;
}

}  // namespace nonio::batch
