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

std::string attention_words(const CampaignState& c) {
  std::string text;
  for (const KnownFinding& f : c.attention)
    text +=
        (text.empty() ? "" : "; ") + (f.measurement.empty() ? "" : f.measurement + ": ") + f.title;
  return text.empty() ? "see its notes" : text;
}

/// The campaigns of one heading, each with what stands beside it.
struct Section {
  const char* name;
  std::vector<std::pair<const CampaignState*, std::string>> entries;
};

std::vector<Section> sections(const Night& night) {
  Section done{"done", {}}, unchanged{"unchanged", {}}, attention{"attention", {}},
      failed{"failed", {}};
  for (const CampaignState& c : night.campaigns) {
    if (c.status == "failed") {
      failed.entries.emplace_back(&c, first_error(c));
      continue;
    }
    (c.action == Action::done ? done : unchanged).entries.emplace_back(&c, c.reason);
    if (c.status == "attention") attention.entries.emplace_back(&c, attention_words(c));
  }
  return {std::move(done), std::move(unchanged), std::move(attention), std::move(failed)};
}

Json entry_json(const CampaignState& c, const std::string& reason) {
  Json json = {{"id", c.id}, {"folder", c.folder}, {"status", c.status}, {"reason", reason}};
  if (!c.errors.empty()) {
    Json errors = Json::array();
    for (const Error& e : c.errors) errors.push_back(to_json(e));
    json["errors"] = std::move(errors);
  }
  return json;
}

Json finding_json(const CampaignState& c, const KnownFinding& f) {
  return {{"campaign", c.id},
          {"measurement", f.measurement},
          {"id", f.id},
          {"severity", f.attention ? "attention" : "info"},
          {"title", f.title}};
}

}  // namespace

bool Night::any_failed() const {
  return std::any_of(campaigns.begin(), campaigns.end(),
                     [](const CampaignState& c) { return c.status == "failed"; });
}

std::string summary_json(const Night& night, const std::string& version) {
  Json json = {{"schema", "nonio-summary/1"}, {"nonio", version}};
  Json counts = {{"campaigns", night.campaigns.size()}};
  Json lists = Json::object();
  for (const Section& s : sections(night)) {
    counts[s.name] = s.entries.size();
    Json list = Json::array();
    for (const auto& [c, reason] : s.entries) list.push_back(entry_json(*c, reason));
    lists[s.name] = std::move(list);
  }
  json["counts"] = std::move(counts);
  for (auto& [name, list] : lists.items()) json[name] = std::move(list);
  Json fresh = Json::array();
  for (const CampaignState& c : night.campaigns)
    for (const KnownFinding& f : c.new_findings) fresh.push_back(finding_json(c, f));
  json["new_findings"] = std::move(fresh);
  if (!night.notes.empty()) json["notes"] = night.notes;
  return dump(json);
}

std::string summary_text(const Night& night, const std::string& version) {
  const std::vector<Section> all = sections(night);
  std::string text =
      "Nonio " + version + ": " + std::to_string(night.campaigns.size()) + " campaigns: ";
  for (const Section& s : all) {
    if (s.name == std::string("attention")) continue;
    text += std::to_string(s.entries.size()) + " " + s.name +
            (s.name == std::string("failed") ? "" : ", ");
  }
  text += "; " + std::to_string(all[2].entries.size()) + " ask for attention\n";
  // What somebody must act on comes first.
  for (const std::size_t k : {std::size_t{3}, std::size_t{2}}) {
    if (all[k].entries.empty()) continue;
    text += k == 3 ? "\nFAILED\n" : "\nATTENTION\n";
    for (const auto& [c, words_of] : all[k].entries) text += "  " + c->id + ": " + words_of + "\n";
  }
  std::string fresh;
  for (const CampaignState& c : night.campaigns)
    for (const KnownFinding& f : c.new_findings)
      if (f.attention)
        fresh += "  " + c.id + (f.measurement.empty() ? "" : ", " + f.measurement) + ": " +
                 f.title + "\n";
  if (!fresh.empty()) text += "\nNEW SINCE THE LAST RUN\n" + fresh;
  for (const std::size_t k : {std::size_t{0}, std::size_t{1}}) {
    if (all[k].entries.empty()) continue;
    text += k == 0 ? "\nDONE\n" : "\nUNCHANGED\n";
    for (const auto& [c, reason] : all[k].entries)
      text += "  " + c->id + (k == 0 ? ": " + reason : "") + "\n";
  }
  if (!night.notes.empty()) text += "\nNOTES\n";
  for (const std::string& note : night.notes) text += "  " + note + "\n";
  return text;
}

}  // namespace nonio::host
