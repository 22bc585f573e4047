// SPDX-License-Identifier: Apache-2.0
#include "batch/close/summary.h"

#include <algorithm>
#include <map>
#include <vector>

#include "batch/state/run_state.h"
#include "batch/workers/runner.h"
#include "platform/storage/files.h"
#include "platform/storage/json_values.h"
#include "platform/storage/spool.h"

namespace nonio::batch {
namespace fs = std::filesystem;

namespace {

using Action = CampaignState::Action;

std::string where(const Error& e) {
  std::string text = e.file;
  if (e.line != 0) text += ":" + std::to_string(e.line);
  if (!e.column.empty()) text += " (" + e.column + ")";
  return text.empty() ? e.message : text + ": " + e.message;
}

std::string one_reason(const std::string& text, const config::TerminalWords& words) {
  if (std::string whole = words.of("reason", text); whole != text) return whole;
  for (const char* what : {" changed", " is missing from the output", " was changed in the output"})
    if (text.ends_with(what))
      return words(
          std::string("reason.*") + what,
          {{"what",
            words.of("input", text.substr(0, text.size() - std::string_view(what).size()))}});
  return text;
}

constexpr std::size_t most_shown = 6;

/// A list of the summary: `text` contains the first entries for summary.txt, `json` all entries.
struct List {
  List(const char* list_name, const fs::path& folder)
      : name(list_name), text(storage::Spool::in(folder)), json(storage::Spool::in(folder)) {}
  const char* name;
  std::size_t count = 0;
  storage::Spool text, json;

  void add(const std::string& line, const storage::Json& entry) {
    if (count < most_shown) text.add("  " + line + "\n");
    json.add((count == 0 ? "\n  " : ",\n  ") +
             entry.dump(-1, ' ', false, storage::Json::error_handler_t::replace));
    ++count;
  }
};

storage::Json entry_json(const CampaignState& c, const std::string& reason) {
  storage::Json json = {{"id", c.id},
                        {"folder", storage::path_text(c.folder)},
                        {"status", to_text(c.status)},
                        {"reason", reason}};
  if (!c.errors.empty()) {
    storage::Json errors = storage::Json::array();
    for (const Error& e : c.errors) errors.push_back(storage::to_json(e));
    json["errors"] = std::move(errors);
  }
  return json;
}

std::string run_words(const evaluation::RunLabel& run, const config::TerminalWords& words) {
  return words(run.date.empty() ? "night" : "night-of",
               {{"number", std::to_string(run.number)}, {"date", run.date}});
}

storage::Json run_json(const evaluation::RunLabel& run) {
  return {{"night", run.number}, {"date", run.date}};
}

std::string run_line(const RunResult& run, const config::TerminalWords& words) {
  std::string line =
      run_words(run.run, words) + "; " + words.counted("seen", run.campaigns.size()) + ", ";
  if (line[0] >= 'a' && line[0] <= 'z') line[0] = static_cast<char>(line[0] - 'a' + 'A');
  return line +
         (run.seen_before ? words("seen-before", {{"count", std::to_string(*run.seen_before)}})
                          : words("first-night")) +
         "\n";
}

struct Fresh {
  std::size_t count = 0;
  std::string where;
};

struct Lists {
  Lists(const fs::path& folder, const config::TerminalWords& in_words)
      : words(in_words),
        done("done", folder),
        unchanged("unchanged", folder),
        attention("attention", folder),
        failed("failed", folder),
        vanished("vanished", folder),
        fresh("new_findings", folder) {}
  const config::TerminalWords& words;
  List done, unchanged, attention, failed, vanished, fresh;
  std::map<std::string, Fresh> fresh_by_heading;

  void add(const Vanished& v) {
    vanished.add(
        v.id + (config::is_campaign_id(v.id) ? ": " : " ") + v.why,
        {{"campaign", v.id}, {"folder", v.folder}, {"last_done_night", v.run}, {"message", v.why}});
  }

  /// Reads the record of a campaign that was evaluated in this run or has the status `attention`.
  /// An error if it cannot be read.
  Expected<void> add(const CampaignState& c, const fs::path& out) {
    if (c.status == evaluation::Status::failed) {
      add_failed(c, out);
      return {};
    }
    const bool is_done = c.action == Action::done;
    (is_done ? done : unchanged)
        .add(is_done ? c.id + ": " + reason_in(c.reason, words) : c.id, entry_json(c, c.reason));
    if (!is_done && c.status == evaluation::Status::ok) return {};
    NONIO_TRY(const auto record, evaluation::read_record(storage::results_folder(out, c.id)));
    if (c.status == evaluation::Status::attention) {
      std::string said, english;
      for (const evaluation::KnownFinding& f : record.findings) {
        if (!f.attention) continue;
        const std::string of = f.measurement.empty() ? "" : f.measurement + ": ";
        said += (said.empty() ? "" : "; ") + of + f.heading();
        english += (english.empty() ? "" : "; ") + of + f.title;
      }
      if (english.empty()) {
        english = "see the notes in its results.json";
        said = words("see-notes");
      }
      attention.add(c.id + ": " + said, entry_json(c, english));
    }
    if (!is_done) return {};
    for (const evaluation::KnownFinding& f : record.findings)
      if (std::none_of(record.previous.begin(), record.previous.end(),
                       [&](const evaluation::KnownFinding& p) { return p.same(f); }))
        add_fresh(c, f);
    return {};
  }

 private:
  /// The entry contains the first run of an unbroken series of failures and the folder of earlier
  /// good results.
  void add_failed(const CampaignState& c, const fs::path& out) {
    std::string line = c.id + ": " + first_error(c, words);
    storage::Json entry = entry_json(c, first_error(c, {words.templates(), "en"}));
    const fs::path results = storage::results_folder(out, c.id);
    const auto record = evaluation::read_record(results);
    if (record && record->failed_since) {
      const evaluation::RunLabel& since = *record->failed_since;
      entry["failed_since"] = run_json(since);
      if (since.number != record->run)
        line += "; " + words("failed-since", {{"night", run_words(since, words)}});
    }
    const std::string folder = (storage::own_folder(out, c.id) / evaluation::last_good_name)
                                   .lexically_relative(out)
                                   .generic_string();
    if (const auto good = evaluation::read_record(results / evaluation::last_good_name)) {
      const evaluation::RunLabel run{good->run, good->date};
      entry["last_good"] = run_json(run);
      entry["last_good"]["status"] = to_text(good->status);
      entry["last_good"]["folder"] = folder;
      line += "; " + words("last-good", {{"night", run_words(run, words)}, {"folder", folder}});
    }
    failed.add(line, entry);
  }

  void add_fresh(const CampaignState& c, const evaluation::KnownFinding& f) {
    const std::string where = c.id + (f.measurement.empty() ? "" : ", " + f.measurement);
    fresh.add(where + ": " + f.heading(), {{"campaign", c.id},
                                           {"measurement", f.measurement},
                                           {"id", f.id},
                                           {"severity", f.attention ? "attention" : "info"},
                                           {"title", f.title}});
    if (!f.attention) return;
    constexpr std::size_t most_places = 3;
    Fresh& alike = fresh_by_heading[f.heading()];
    if (++alike.count <= most_places) alike.where += (alike.count == 1 ? "" : "; ") + where;
    if (alike.count == most_places + 1) alike.where += "; ...";
  }
};

std::string issued_line(const std::vector<certificates::RegisterEntry>& issued,
                        const config::TerminalWords& words) {
  constexpr std::size_t most = 8;
  std::string line = words.counted("issued", issued.size()) + ": ";
  if (issued.size() > most)
    return line + issued.front().number + " .. " + issued.back().number + "\n";
  for (const certificates::RegisterEntry& e : issued)
    line += (&e == &issued.front() ? "" : ", ") + e.number + " (" + e.campaign +
            (e.replaces.empty() ? "" : ", " + words("replaces", {{"number", e.replaces}})) + ")";
  return line + "\n";
}

std::string waiting_line(const std::vector<certificates::WaitingDraft>& drafts,
                         const config::TerminalWords& words) {
  constexpr std::size_t most = 8;
  std::string line = words.counted("waiting", drafts.size()) + ": ";
  for (std::size_t i = 0; i < std::min(most, drafts.size()); ++i)
    line += (i == 0 ? "" : ", ") + drafts[i].campaign;
  return line + (drafts.size() > most ? ", ..." : "") + "\n";
}

/// Example: "Nonio 2026-12: 12 campaigns: 3 done, 9 unchanged, 0 failed; 2 lines: action required".
std::string counts_line(const RunResult& run, const Lists& lists, const WorklistPages& worklist,
                        const std::string& version) {
  const auto n = [](std::size_t count) { return std::to_string(count); };
  const config::TerminalWords& words = lists.words;
  return "Nonio " + version + ": " + words.counted("campaigns", run.campaigns.size()) + ": " +
         words("counts", {{"done", n(lists.done.count)},
                          {"unchanged", n(lists.unchanged.count)},
                          {"failed", n(lists.failed.count)}}) +
         "; " +
         (lists.vanished.count == 0
              ? ""
              : words("vanished", {{"count", n(lists.vanished.count)}}) + "; ") +
         words.counted("asking", worklist.asking) + "\n";
}

void write_fresh(storage::Spool& out, const Lists& lists) {
  if (lists.fresh_by_heading.empty()) return;
  std::vector<std::pair<std::string, Fresh>> all(lists.fresh_by_heading.begin(),
                                                 lists.fresh_by_heading.end());
  std::stable_sort(all.begin(), all.end(),
                   [](const auto& a, const auto& b) { return a.second.count > b.second.count; });
  out.add("\n" + lists.words("heading.new") + "\n");
  for (std::size_t i = 0; i < std::min(all.size(), most_shown); ++i)
    out.add("  " + all[i].first + ": " + std::to_string(all[i].second.count) + " (" +
            all[i].second.where + ")\n");
  if (all.size() > most_shown)
    out.add("  " + lists.words("more-lines", {{"count", std::to_string(all.size() - most_shown)}}) +
            "\n");
}

/// Whether the run has nothing to report: no campaign was evaluated, failed or missing, no
/// certificate was issued or is waiting for approval, and the worklist requires no action.
bool is_quiet(const RunResult& run, const Lists& lists, const WorklistPages& worklist) {
  return lists.done.count == 0 && lists.failed.count == 0 && lists.vanished.count == 0 &&
         worklist.asking == 0 && !worklist.json.empty() && run.issued.empty() &&
         run.waiting.empty() && run.notes.empty();
}

/// Writes one line if there is nothing to report. Otherwise failures and the worklist precede the
/// evaluated campaigns. Long lists are cut, because summary.json contains them in full.
void write_text(storage::Spool& out, const RunResult& run, Lists& lists, const std::string& version,
                const WorklistPages& worklist) {
  const config::TerminalWords& words = lists.words;
  if (is_quiet(run, lists, worklist)) {
    std::string line = run_line(run, words);
    line.pop_back();
    out.add(line + ": " + words(worklist.judged ? "quiet" : "quiet.not-judged") + "\n");
    return;
  }
  out.add(counts_line(run, lists, worklist, version));
  out.add(run_line(run, words));
  if (!run.issued.empty()) out.add(issued_line(run.issued, words));
  if (!run.waiting.empty()) out.add(waiting_line(run.waiting, words));
  const auto section = [&](const char* heading, List& list) {
    if (list.count == 0) return;
    out.add("\n" + words(heading) + "\n");
    out.add(list.text);
    if (list.count > most_shown)
      out.add("  " + words("more-lines", {{"count", std::to_string(list.count - most_shown)}}) +
              "\n");
  };
  section("heading.failed", lists.failed);
  section("heading.vanished", lists.vanished);
  if (!worklist.text.empty()) out.add("\n" + words("heading.worklist") + "\n" + worklist.text);
  write_fresh(out, lists);
  section("heading.done", lists.done);
  if (!run.notes.empty()) out.add("\n" + words("heading.notes") + "\n");
  for (const std::string& note : run.notes) out.add("  " + note + "\n");
}

void write_json(storage::Spool& out, const RunResult& run, Lists& lists, const std::string& version,
                const fs::path& out_folder, const WorklistPages& worklist) {
  const std::initializer_list<List*> all{&lists.done,   &lists.unchanged, &lists.attention,
                                         &lists.failed, &lists.vanished,  &lists.fresh};
  storage::Json seen = {{"tonight", run.campaigns.size()}, {"night_before", nullptr}};
  if (run.seen_before) seen["night_before"] = *run.seen_before;
  storage::Json counts = {{"campaigns", run.campaigns.size()}};
  for (const List* l : all)
    if (l != &lists.fresh) counts[l->name] = l->count;
  out.add("{\n \"schema\": \"nonio-summary/1\",\n \"nonio\": " + storage::Json(version).dump() +
          ",\n \"night\": " + std::to_string(run.run.number) +
          ",\n \"date\": " + storage::Json(run.run.date).dump() +
          ",\n \"language\": " + storage::Json(lists.words.language()).dump() +
          ",\n \"seen\": " + seen.dump() + ",\n \"counts\": " + counts.dump());
  for (List* l : all) {
    out.add(std::string(",\n \"") + l->name + "\": [");
    out.add(l->json);
    out.add(l->count == 0 ? "]" : "\n ]");
  }
  out.add(",\n \"lines\": " + (worklist.json.empty() ? "[]" : worklist.json));
  storage::Json issued = storage::Json::array();
  for (const certificates::RegisterEntry& e : run.issued) {
    storage::Json one = {{"number", e.number}, {"campaign", e.campaign}};
    if (!e.replaces.empty()) one["replaces"] = e.replaces;
    issued.push_back(std::move(one));
  }
  out.add(",\n \"issued\": " + issued.dump());
  storage::Json waiting = storage::Json::array();
  for (const certificates::WaitingDraft& d : run.waiting) {
    storage::Json one = {
        {"campaign", d.campaign},
        {"file",
         (storage::own_folder(out_folder, d.campaign).lexically_relative(out_folder) / d.file)
             .generic_string()}};
    if (!d.replaces.empty()) one["replaces"] = d.replaces;
    waiting.push_back(std::move(one));
  }
  out.add(",\n \"drafts\": " + waiting.dump());
  if (!run.history_error.empty())
    out.add(",\n \"history_error\": " + storage::dump_line(run.history_error));
  out.add(",\n \"notes\": " +
          storage::Json(run.notes).dump(-1, ' ', false, storage::Json::error_handler_t::replace) +
          "\n}\n");
}

}  // namespace

std::size_t RunResult::failed() const {
  return static_cast<std::size_t>(
      std::count_if(campaigns.begin(), campaigns.end(),
                    [](const CampaignState& c) { return c.status == evaluation::Status::failed; }));
}

std::size_t RunResult::lost_parts() const {
  return static_cast<std::size_t>(
      std::count_if(vanished.begin(), vanished.end(),
                    [](const Vanished& v) { return !config::is_campaign_id(v.id); }));
}

std::string reason_in(const std::string& text, const config::TerminalWords& words) {
  std::string out;
  for (std::size_t from = 0; from <= text.size();) {
    const std::size_t to = std::min(text.find("; ", from), text.size());
    out += (from == 0 ? "" : "; ") + one_reason(text.substr(from, to - from), words);
    from = to + 2;
  }
  return out;
}

std::string first_error(const CampaignState& c, const config::TerminalWords& words) {
  if (c.errors.empty()) return c.reason;
  const std::size_t more = c.errors.size() - 1;
  return where(c.errors.front()) +
         (more == 0 ? "" : " " + words("more", {{"count", std::to_string(more)}}));
}

Expected<void> write_summary(const RunResult& run, const fs::path& out, const std::string& version,
                             const config::TerminalWords& words, const WorklistPages& worklist) {
  const std::vector<std::string> names{"summary.txt", "summary.json"};
  storage::remove_leftovers(out);
  storage::Spool text = storage::Spool::at(storage::temporary_path(out, names[0]));
  storage::Spool json = storage::Spool::at(storage::temporary_path(out, names[1]));
  Lists lists(out / state_folder, words);
  for (const CampaignState& c : run.campaigns) {
    const auto added = process::is_stop_requested() ? fail("interrupted") : lists.add(c, out);
    if (added) continue;
    storage::remove_temporaries(out, names);
    return fail("cannot write the summary in " + out.string() + ": " + added.error().message);
  }
  for (const Vanished& v : run.vanished) lists.add(v);
  write_text(text, run, lists, version, worklist);
  write_json(json, run, lists, version, out, worklist);
  auto written = text.flush();
  if (written) written = json.flush();
  if (written) written = storage::rename_temporaries(out, names);
  if (written) return written;
  storage::remove_temporaries(out, names);
  return fail("cannot write the summary in " + out.string() + ": " + written.error().message);
}

}  // namespace nonio::batch
