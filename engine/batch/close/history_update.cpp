// SPDX-License-Identifier: Apache-2.0
#include "batch/close/history_update.h"

#include "batch/state/read_apart.h"
#include "laboratory/store/place.h"

namespace nonio::batch {

namespace {

std::string in_one_line(const std::vector<Error>& errors) {
  std::string all;
  for (const Error& e : errors) {
    if (!all.empty()) all += "; ";
    if (!e.file.empty()) all += e.file + (e.line == 0 ? "" : ":" + std::to_string(e.line)) + ": ";
    all += e.message;
  }
  return all;
}

/// Returns an event of kind "compensation" for each state of a control in the machine records. Its
/// text is the loaded table, "none" without a table, or empty if the record does not state it.
std::vector<config::Event> events_of(const config::MachineRecords& records) {
  std::vector<config::Event> events;
  for (const config::RecordFile& file : records) {
    if (!file.record) continue;  // campaigns of this machine report the error
    for (const auto& [axis, recorded] : file.record->axes) {
      for (const config::ControlState& state : recorded.states) {
        if (state.source == "backup")
          continue;  // the date is that of a backup; no table was loaded
        events.push_back({state.since,
                          file.asset,
                          axis,
                          "compensation",
                          !state.table           ? ""
                          : state.table->empty() ? "none"
                                                 : *state.table,
                          {},
                          state.line_of_since});
      }
    }
  }
  return events;
}

}  // namespace

Expected<store::SiteRecords> read_records(const RunOptions& options,
                                          const reading::Context& context) {
  auto logs = read_apart<config::SiteLogs>(
      "what the site states of its machines", context.site.limits.disk_seconds,
      [&](process::SignsOfLife& signs) -> Expected<config::SiteLogs> {
        signs.reading((options.site / config::events_name).string());
        auto read = config::read_site_logs(options.site);
        if (!read) return fail(in_one_line(read.error()));
        return std::move(*read);
      });
  if (!logs) return fail(logs.error());
  return store::SiteRecords{std::move(*logs), context.site.aliases, events_of(context.machines),
                            context.site.due};
}

Expected<void> HistoryUpdate::begin(std::optional<std::uint64_t> planned) {
  NONIO_TRY(const auto known, store::known_run(options_.out));
  known_ = known ? known : planned;
  std::optional<storage::Server> server;
  if (const auto& choice = context_.site.database)
    server =
        storage::Server{choice->url, choice->schema,
                        choice->password_file.empty()
                            ? std::filesystem::path()
                            : std::filesystem::absolute(options_.site / choice->password_file)};
  NONIO_TRY(const auto elsewhere, store::note_place(options_.out, server));
  if (elsewhere) known_.reset();
  return store::forget_known_run(options_.out);
}

Expected<std::vector<std::string>> HistoryUpdate::end(std::uint64_t last, std::uint64_t run,
                                                      const std::vector<std::string>& campaigns,
                                                      const Expected<store::SiteRecords>& records) {
  if (!records) return fail(records.error());
  auto updated =
      read_apart<store::Updated>("the history", context_.site.limits.disk_seconds,
                                 [&](process::SignsOfLife& signs) -> Expected<store::Updated> {
                                   signs.reading((options_.out / store::store_name).string());
                                   return store::update(options_.out, known_ != last, campaigns,
                                                        *records, [&] { signs.beat(); });
                                 });
  if (!updated) return fail(updated.error());
  rebuilt_ = rebuilt_ || updated->rebuilt;
  std::vector<std::string> notes;
  for (const std::string& left : updated->left_out) notes.push_back("not in the history: " + left);
  if (!notes.empty()) return notes;
  if (auto noted = store::note_known_run(options_.out, run); !noted) return fail(noted.error());
  known_ = run;
  return notes;
}

void HistoryUpdate::nothing_done() const {
  // If the note cannot be written, the next run rebuilds the store.
  if (known_) [[maybe_unused]]
    const auto noted = store::note_known_run(options_.out, *known_);
}

Expected<std::vector<std::string>> HistoryUpdate::end(const std::vector<std::string>& campaigns,
                                                      const Expected<store::SiteRecords>& records) {
  if (!known_) return std::vector<std::string>{};
  return end(*known_, *known_, campaigns, records);
}

}  // namespace nonio::batch
