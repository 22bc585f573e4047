// SPDX-License-Identifier: Apache-2.0
#include "summary.h"

#include <algorithm>

#include "json_values.h"

namespace nonio::host {

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

/// One list of the summary, as text for a person and as lines of JSON for a program. It grows entry
/// by entry, so that the findings of all campaigns are never in memory together.
struct List {
  const char* name;
  std::size_t count = 0;
  std::string text{}, json{};

  void add(const std::string& line, const Json& entry) {
    text += "  " + line + "\n";
    json += (count == 0 ? "\n  " : ",\n  ") +
            entry.dump(-1, ' ', false, Json::error_handler_t::replace);
    ++count;
  }
};

Json entry_json(const CampaignState& c, const std::string& reason) {
  Json json = {{"id", c.id}, {"folder", c.folder}, {"status", c.status}, {"reason", reason}};
  if (!c.errors.empty()) {
    Json errors = Json::array();
    for (const Error& e : c.errors) errors.push_back(to_json(e));
    json["errors"] = std::move(errors);
  }
  return json;
}

struct Lists {
  List done{"done"}, unchanged{"unchanged"}, attention{"attention"}, failed{"failed"},
      fresh{"new_findings"};
  std::string fresh_text;  // of those that ask for attention

  void add(const CampaignState& c, const std::filesystem::path& out) {
    if (c.status == "failed")
      return failed.add(c.id + ": " + first_error(c), entry_json(c, first_error(c)));
    const bool is_done = c.action == Action::done;
    (is_done ? done : unchanged)
        .add(is_done ? c.id + ": " + c.reason : c.id, entry_json(c, c.reason));
    const auto record = read_record(out / c.id);
    if (!record) return;
    if (c.status == "attention") {
      std::string words;
      for (const KnownFinding& f : record->findings)
        if (f.attention)
          words += (words.empty() ? "" : "; ") +
                   (f.measurement.empty() ? "" : f.measurement + ": ") + f.title;
      if (words.empty()) words = "see the notes in its results.json";
      attention.add(c.id + ": " + words, entry_json(c, words));
    }
    if (!is_done) return;
    for (const KnownFinding& f : record->findings)
      if (std::none_of(record->previous.begin(), record->previous.end(),
                       [&](const KnownFinding& p) { return p.same(f); }))
        add_fresh(c, f);
  }

 private:
  void add_fresh(const CampaignState& c, const KnownFinding& f) {
    const std::string line =
        c.id + (f.measurement.empty() ? "" : ", " + f.measurement) + ": " + f.title;
    fresh.add(line, {{"campaign", c.id},
                     {"measurement", f.measurement},
                     {"id", f.id},
                     {"severity", f.attention ? "attention" : "info"},
                     {"title", f.title}});
    if (f.attention) fresh_text += "  " + line + "\n";
  }
};

std::string text_of(const Night& night, const Lists& lists, const std::string& version) {
  const auto n = [](std::size_t count) { return std::to_string(count); };
  std::string text = "Nonio " + version + ": " + n(night.campaigns.size()) +
                     " campaigns: " + n(lists.done.count) + " done, " + n(lists.unchanged.count) +
                     " unchanged, " + n(lists.failed.count) + " failed; " +
                     n(lists.attention.count) + " ask for attention\n";
  // What somebody must act on comes first.
  const auto section = [&](const char* heading, const std::string& body) {
    if (!body.empty()) text += std::string("\n") + heading + "\n" + body;
  };
  section("FAILED", lists.failed.text);
  section("ATTENTION", lists.attention.text);
  section("NEW SINCE THE LAST RUN", lists.fresh_text);
  section("DONE, AND WHY", lists.done.text);
  section("UNCHANGED", lists.unchanged.text);
  std::string notes;
  for (const std::string& note : night.notes) notes += "  " + note + "\n";
  section("NOTES", notes);
  return text;
}

std::string json_of(const Night& night, const Lists& lists, const std::string& version) {
  Json counts = {{"campaigns", night.campaigns.size()}};
  std::string body;
  for (const List* l :
       {&lists.done, &lists.unchanged, &lists.attention, &lists.failed, &lists.fresh}) {
    if (l != &lists.fresh) counts[l->name] = l->count;
    body += std::string(",\n \"") + l->name + "\": [" + l->json + (l->count == 0 ? "]" : "\n ]");
  }
  return "{\n \"schema\": \"nonio-summary/1\",\n \"nonio\": " + Json(version).dump() +
         ",\n \"counts\": " + counts.dump() + body + ",\n \"notes\": " +
         Json(night.notes).dump(-1, ' ', false, Json::error_handler_t::replace) + "\n}\n";
}

}  // namespace

bool Night::any_failed() const {
  return std::any_of(campaigns.begin(), campaigns.end(),
                     [](const CampaignState& c) { return c.status == "failed"; });
}

Summary summary(const Night& night, const std::filesystem::path& out, const std::string& version) {
  Lists lists;
  for (const CampaignState& c : night.campaigns) lists.add(c, out);
  return {text_of(night, lists, version), json_of(night, lists, version)};
}

}  // namespace nonio::host
