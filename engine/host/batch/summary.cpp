// SPDX-License-Identifier: Apache-2.0
#include "host/batch/summary.h"

#include <algorithm>

#include "host/batch/night_state.h"
#include "host/batch/runner.h"
#include "host/storage/files.h"
#include "host/storage/json_values.h"
#include "host/storage/spool.h"

namespace nonio::host::batch {
namespace fs = std::filesystem;

namespace {

using Action = CampaignState::Action;

std::string where(const Error& e) {
  std::string text = e.file;
  if (e.line != 0) text += ":" + std::to_string(e.line);
  if (!e.column.empty()) text += " (" + e.column + ")";
  return text.empty() ? e.message : text + ": " + e.message;
}

std::string first_error(const CampaignState& c) {
  if (c.errors.empty()) return c.reason;
  const std::size_t more = c.errors.size() - 1;
  return where(c.errors.front()) + (more == 0 ? "" : " (and " + std::to_string(more) + " more)");
}

/// One list of the summary, as text for a person and as lines of JSON for a program.
struct List {
  List(const char* list_name, const fs::path& folder)
      : name(list_name), text(storage::Spool::in(folder)), json(storage::Spool::in(folder)) {}
  const char* name;
  std::size_t count = 0;
  storage::Spool text, json;

  void add(const std::string& line, const storage::Json& entry) {
    text.add("  " + line + "\n");
    json.add((count == 0 ? "\n  " : ",\n  ") +
             entry.dump(-1, ' ', false, storage::Json::error_handler_t::replace));
    ++count;
  }
};

storage::Json entry_json(const CampaignState& c, const std::string& reason) {
  storage::Json json = {{"id", c.id},
                        {"folder", storage::path_text(c.folder)},
                        {"status", c.status},
                        {"reason", reason}};
  if (!c.errors.empty()) {
    storage::Json errors = storage::Json::array();
    for (const Error& e : c.errors) errors.push_back(storage::to_json(e));
    json["errors"] = std::move(errors);
  }
  return json;
}

std::string night_words(const evaluation::NightOf& night) {
  return "night " + std::to_string(night.number) + (night.date.empty() ? "" : " of " + night.date);
}

storage::Json night_json(const evaluation::NightOf& night) {
  return {{"night", night.number}, {"date", night.date}};
}

/// Which night this is, and whether campaigns are missing: first of all, so that nobody takes an
/// old summary for tonight's.
std::string night_line(const Night& night) {
  std::string line = night_words(night.night) + "; " + std::to_string(night.campaigns.size()) +
                     (night.campaigns.size() == 1 ? " campaign seen, " : " campaigns seen, ");
  line[0] = 'N';
  return line + (night.seen_before ? std::to_string(*night.seen_before) + " the night before\n"
                                   : "none before: it is the first night\n");
}

struct Lists {
  explicit Lists(const fs::path& folder)
      : done("done", folder),
        unchanged("unchanged", folder),
        attention("attention", folder),
        failed("failed", folder),
        vanished("vanished", folder),
        fresh("new_findings", folder),
        fresh_text(storage::Spool::in(folder)) {}
  List done, unchanged, attention, failed, vanished, fresh;
  storage::Spool fresh_text;  // of those that ask for attention

  void add(const Vanished& v) {
    vanished.add(v.id + ": " + v.why, {{"campaign", v.id},
                                       {"folder", v.folder},
                                       {"last_done_night", v.night},
                                       {"message", v.why}});
  }

  /// An error if what the campaign's record says cannot be read.
  Expected<void> add(const CampaignState& c, const fs::path& out) {
    if (c.status == "failed") {
      add_failed(c, out);
      return {};
    }
    const bool is_done = c.action == Action::done;
    (is_done ? done : unchanged)
        .add(is_done ? c.id + ": " + c.reason : c.id, entry_json(c, c.reason));
    if (!is_done && c.status == "ok") return {};
    const auto record = evaluation::read_record(storage::results_folder(out, c.id));
    if (!record) return fail(record.error());
    if (c.status == "attention") {
      std::string words;
      for (const evaluation::KnownFinding& f : record->findings)
        if (f.attention)
          words += (words.empty() ? "" : "; ") +
                   (f.measurement.empty() ? "" : f.measurement + ": ") + f.title;
      if (words.empty()) words = "see the notes in its results.json";
      attention.add(c.id + ": " + words, entry_json(c, words));
    }
    if (!is_done) return {};
    for (const evaluation::KnownFinding& f : record->findings)
      if (std::none_of(record->previous.begin(), record->previous.end(),
                       [&](const evaluation::KnownFinding& p) { return p.same(f); }))
        add_fresh(c, f);
    return {};
  }

 private:
  /// With how long it has been so, and where results are that still stand.
  void add_failed(const CampaignState& c, const fs::path& out) {
    std::string line = c.id + ": " + first_error(c);
    storage::Json entry = entry_json(c, first_error(c));
    const fs::path results = storage::results_folder(out, c.id);
    const auto record = evaluation::read_record(results);
    if (record && record->failed_since) {
      const evaluation::NightOf& since = *record->failed_since;
      entry["failed_since"] = night_json(since);
      if (since.number != record->night) line += "; failed since " + night_words(since);
    }
    const std::string folder =
        (results / evaluation::last_good_name).lexically_relative(out).generic_string();
    if (const auto good = evaluation::read_record(out / folder)) {
      const evaluation::NightOf night{good->night, good->date};
      entry["last_good"] = night_json(night);
      entry["last_good"]["status"] = good->status;
      entry["last_good"]["folder"] = folder;
      line += "; the last good result is that of " + night_words(night) + ", in " + folder;
    }
    failed.add(line, entry);
  }

  void add_fresh(const CampaignState& c, const evaluation::KnownFinding& f) {
    const std::string line =
        c.id + (f.measurement.empty() ? "" : ", " + f.measurement) + ": " + f.title;
    fresh.add(line, {{"campaign", c.id},
                     {"measurement", f.measurement},
                     {"id", f.id},
                     {"severity", f.attention ? "attention" : "info"},
                     {"title", f.title}});
    if (f.attention) fresh_text.add("  " + line + "\n");
  }
};

/// All numbers, as long as they fit a line.
std::string issued_line(const std::vector<certificates::RegisterEntry>& issued) {
  constexpr std::size_t most = 8;
  std::string line = "issued " + std::to_string(issued.size()) +
                     (issued.size() == 1 ? " certificate: " : " certificates: ");
  if (issued.size() > most)
    return line + issued.front().number + " .. " + issued.back().number + "\n";
  for (const certificates::RegisterEntry& e : issued)
    line += (&e == &issued.front() ? "" : ", ") + e.number + " (" + e.campaign +
            (e.replaces.empty() ? "" : ", replaces " + e.replaces) + ")";
  return line + "\n";
}

std::string waiting_line(const std::vector<certificates::WaitingDraft>& drafts) {
  constexpr std::size_t most = 8;
  std::string line = std::to_string(drafts.size()) +
                     (drafts.size() == 1 ? " draft waits" : " drafts wait") +
                     " for a release (nonio release): ";
  for (std::size_t i = 0; i < std::min(most, drafts.size()); ++i)
    line += (i == 0 ? "" : ", ") + drafts[i].campaign;
  return line + (drafts.size() > most ? ", ..." : "") + "\n";
}

void write_text(storage::Spool& out, const Night& night, Lists& lists, const std::string& version) {
  const auto n = [](std::size_t count) { return std::to_string(count); };
  out.add("Nonio " + version + ": " + n(night.campaigns.size()) +
          (night.campaigns.size() == 1 ? " campaign: " : " campaigns: ") + n(lists.done.count) +
          " done, " + n(lists.unchanged.count) + " unchanged, " + n(lists.failed.count) +
          " failed; " + (lists.vanished.count == 0 ? "" : n(lists.vanished.count) + " vanished; ") +
          n(lists.attention.count) + (lists.attention.count == 1 ? " asks" : " ask") +
          " for attention\n");
  out.add(night_line(night));
  if (!night.issued.empty()) out.add(issued_line(night.issued));
  if (!night.waiting.empty()) out.add(waiting_line(night.waiting));
  // What somebody must act on comes first.
  const auto section = [&](const char* heading, storage::Spool& body) {
    if (body.empty()) return;
    out.add(std::string("\n") + heading + "\n");
    out.add(body);
  };
  section("FAILED", lists.failed.text);
  section("VANISHED SINCE AN EARLIER NIGHT", lists.vanished.text);
  section("ATTENTION", lists.attention.text);
  section("NEW SINCE THE LAST RUN", lists.fresh_text);
  section("DONE, AND WHY", lists.done.text);
  section("UNCHANGED", lists.unchanged.text);
  if (!night.notes.empty()) out.add("\nNOTES\n");
  for (const std::string& note : night.notes) out.add("  " + note + "\n");
}

void write_json(storage::Spool& out, const Night& night, Lists& lists, const std::string& version,
                const fs::path& out_folder) {
  const std::initializer_list<List*> all{&lists.done,   &lists.unchanged, &lists.attention,
                                         &lists.failed, &lists.vanished,  &lists.fresh};
  storage::Json seen = {{"tonight", night.campaigns.size()}, {"night_before", nullptr}};
  if (night.seen_before) seen["night_before"] = *night.seen_before;
  storage::Json counts = {{"campaigns", night.campaigns.size()}};
  for (const List* l : all)
    if (l != &lists.fresh) counts[l->name] = l->count;
  out.add("{\n \"schema\": \"nonio-summary/1\",\n \"nonio\": " + storage::Json(version).dump() +
          ",\n \"night\": " + std::to_string(night.night.number) +
          ",\n \"date\": " + storage::Json(night.night.date).dump() +
          ",\n \"seen\": " + seen.dump() + ",\n \"counts\": " + counts.dump());
  for (List* l : all) {
    out.add(std::string(",\n \"") + l->name + "\": [");
    out.add(l->json);
    out.add(l->count == 0 ? "]" : "\n ]");
  }
  storage::Json issued = storage::Json::array();
  for (const certificates::RegisterEntry& e : night.issued) {
    storage::Json one = {{"number", e.number}, {"campaign", e.campaign}};
    if (!e.replaces.empty()) one["replaces"] = e.replaces;
    issued.push_back(std::move(one));
  }
  out.add(",\n \"issued\": " + issued.dump());
  storage::Json waiting = storage::Json::array();
  for (const certificates::WaitingDraft& d : night.waiting) {
    storage::Json one = {
        {"campaign", d.campaign},
        {"file",
         (storage::results_folder(out_folder, d.campaign).lexically_relative(out_folder) / d.file)
             .generic_string()}};
    if (!d.replaces.empty()) one["replaces"] = d.replaces;
    waiting.push_back(std::move(one));
  }
  out.add(",\n \"drafts\": " + waiting.dump());
  out.add(",\n \"notes\": " +
          storage::Json(night.notes).dump(-1, ' ', false, storage::Json::error_handler_t::replace) +
          "\n}\n");
}

}  // namespace

std::size_t Night::failed() const {
  return static_cast<std::size_t>(
      std::count_if(campaigns.begin(), campaigns.end(),
                    [](const CampaignState& c) { return c.status == "failed"; }));
}

Expected<void> write_summary(const Night& night, const fs::path& out, const std::string& version) {
  const std::vector<std::string> names{"summary.txt", "summary.json"};
  storage::remove_leftovers(out);
  storage::Spool text = storage::Spool::at(storage::temporary_path(out, names[0]));
  storage::Spool json = storage::Spool::at(storage::temporary_path(out, names[1]));
  Lists lists(out / state_folder);
  for (const CampaignState& c : night.campaigns) {
    const auto added = process::is_stop_requested() ? fail("interrupted") : lists.add(c, out);
    if (added) continue;
    storage::remove_temporaries(out, names);
    return fail("cannot write the summary in " + out.string() + ": " + added.error().message);
  }
  for (const Vanished& v : night.vanished) lists.add(v);
  write_text(text, night, lists, version);
  write_json(json, night, lists, version, out);
  auto written = text.flush();
  if (written) written = json.flush();
  if (written) written = storage::rename_temporaries(out, names);
  if (written) return written;
  storage::remove_temporaries(out, names);
  return fail("cannot write the summary in " + out.string() + ": " + written.error().message);
}

}  // namespace nonio::host::batch
