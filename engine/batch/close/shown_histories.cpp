// SPDX-License-Identifier: Apache-2.0
#include "batch/close/shown_histories.h"

#include <algorithm>

#include "batch/state/read_apart.h"
#include "batch/state/run_state.h"
#include "platform/process/stop.h"
#include "platform/storage/digest.h"
#include "platform/storage/files.h"
#include "platform/storage/json_values.h"

namespace nonio::batch {

namespace fs = std::filesystem;

namespace {

constexpr const char* histories_name = "histories";

/// The rest of a history changes only with a campaign.
std::string digest_of_records(const store::SiteRecords& records) {
  storage::Json json = storage::Json::array();
  for (const auto* events : {&records.logs.events, &records.of_records}) {
    json.push_back(storage::Json::array());
    for (const config::Event& e : *events)
      json.back().push_back({e.date, e.machine, e.axis, e.kind, e.text});
  }
  for (const config::Alias& a : records.aliases) json.push_back({"alias", a.name, a.asset});
  for (const config::DueRule& d : records.due) json.push_back({"due", d.machine, d.months});
  return storage::sha256(json.dump(-1, ' ', false, storage::Json::error_handler_t::replace));
}

std::string noted_histories(const fs::path& out) {
  const auto text = storage::read_small_file(out / state_folder / histories_name);
  return text ? *text : std::string();
}

bool shows_history(const CampaignState& c) { return c.is_campaign && c.shows_history; }

}  // namespace

Expected<void> ShownHistories::begin() const {
  const std::string none = "none\n", now = noted_histories(options_.out);
  if (now.empty() || now == none) return {};
  return storage::publish(options_.out / state_folder, {{histories_name, none}});
}

Expected<std::map<std::string, assessment::HistoryBasis>> ShownHistories::others(
    const std::vector<CampaignState>& campaigns, const store::SiteRecords& records,
    bool looked) const {
  using Bases = std::map<std::string, assessment::HistoryBasis>;
  std::map<std::string, std::string> shown;
  for (const CampaignState& c : campaigns)
    if (shows_history(c)) shown[c.id] = c.history;
  if (shown.empty() ||
      (!looked && noted_histories(options_.out) == digest_of_records(records) + "\n"))
    return Bases();
  return read_apart<Bases>("the history of the machines", context_.site.limits.disk_seconds,
                           [&](process::SignsOfLife& signs) -> Expected<Bases> {
                             signs.reading(options_.out.string());
                             std::vector<std::string> ids;
                             for (const auto& [id, digest] : shown) ids.push_back(id);
                             NONIO_TRY(auto bases, assessment::history_bases(options_.out, ids));
                             Bases out;
                             for (assessment::HistoryBasis& b : bases)
                               if (b.sha256 != shown[b.campaign])
                                 out.emplace(b.campaign, std::move(b));
                             return out;
                           });
}

Expected<void> ShownHistories::end(const std::vector<CampaignState>& campaigns,
                                   const store::SiteRecords& records) const {
  if (std::none_of(campaigns.begin(), campaigns.end(), shows_history)) return {};
  std::string now = digest_of_records(records) + "\n";
  if (noted_histories(options_.out) == now) return {};
  return storage::publish(options_.out / state_folder, {{histories_name, std::move(now)}});
}

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
