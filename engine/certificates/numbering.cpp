// SPDX-License-Identifier: Apache-2.0
#include "certificates/numbering.h"

#include <toml++/toml.h>

#include <algorithm>
#include <map>
#include <sstream>
#include <string_view>
#include <utility>
#include <vector>

#include "campaign/evaluation/results_json.h"
#include "campaign/reading/plausibility/plausibility.h"
#include "campaign/reading/plausibility/traceability.h"
#include "certificates/certificates.h"
#include "certificates/journal.h"
#include "certificates/recomputed.h"
#include "certificates/register_place.h"
#include "nonio/sdk/results.h"
#include "nonio/sdk/statement.h"
#include "nonio/sign/verify.h"
#include "platform/storage/digest.h"
#include "platform/storage/files.h"

namespace nonio::certificates {

namespace fs = std::filesystem;

namespace {

inline constexpr std::size_t most_changes = 40;

/// If only this key has changed, the file is reported as unchanged.
inline constexpr const char* amendment_key = "certificate.amendment";

using Keys = std::map<std::string, std::string>;

std::string toml_text(const toml::node& node) {
  if (const auto text = node.value_exact<std::string>()) return *text;
  std::ostringstream out;
  node.visit([&](const auto& value) { out << value; });
  return out.str();
}

void flatten(const toml::node& node, const std::string& place, Keys& out) {
  const auto below = [&](std::string_view key) {
    return place.empty() ? std::string(key) : place + "." + std::string(key);
  };
  if (const toml::table* table = node.as_table()) {
    for (const auto& [key, value] : *table) flatten(value, below(key.str()), out);
    return;
  }
  const toml::array* list = node.as_array();
  if (list == nullptr || list->empty() || !list->is_homogeneous(toml::node_type::table)) {
    out[place] = toml_text(node);
    return;
  }
  for (std::size_t i = 0; i < list->size(); ++i) {
    const toml::table& one = *list->get_as<toml::table>(i);
    std::string name = one["id"].value_or(std::to_string(i + 1));
    if (out.contains(below(name) + ".id")) name += "(" + std::to_string(i + 1) + ")";
    flatten(one, below(name), out);
  }
}

std::vector<std::string> lines_of(std::string_view text) {
  std::vector<std::string> lines;
  while (!text.empty()) {
    const std::size_t end = std::min(text.find('\n'), text.size());
    std::string_view line = text.substr(0, end);
    if (line.ends_with('\r')) line.remove_suffix(1);
    lines.emplace_back(line);
    text.remove_prefix(std::min(end + 1, text.size()));
  }
  return lines;
}

bool is_text(std::string_view bytes) {
  constexpr std::size_t longest_line = 500;
  std::size_t line = 0;
  for (const char c : bytes) {
    line = c == '\n' ? 0 : line + 1;
    if (c == '\0' || line > longest_line) return false;
  }
  return true;
}

class ChangeList {
 public:
  explicit ChangeList(FileChange& into) : into_(into) {}
  void add(Change change) {
    if (into_.changes.size() < most_changes)
      into_.changes.push_back(std::move(change));
    else
      ++into_.more;
  }

 private:
  FileChange& into_;
};

void compare_keys(const Keys& before, const Keys& after, FileChange& out) {
  ChangeList list(out);
  for (const auto& [key, value] : after) {
    const auto old = before.find(key);
    if (key == amendment_key || (old != before.end() && old->second == value)) continue;
    list.add({key, 0, old == before.end() ? std::nullopt : std::optional(old->second), value});
  }
  for (const auto& [key, value] : before)
    if (key != amendment_key && !after.contains(key)) list.add({key, 0, value, std::nullopt});
}

/// Between the equal lines at both ends, lines are compared one by one if the files have the same
/// number of lines; otherwise all removed and all new lines are listed.
void compare_lines(const std::vector<std::string>& a, const std::vector<std::string>& b,
                   FileChange& out) {
  ChangeList list(out);
  std::size_t begin = 0, end = 0;
  const std::size_t shorter = std::min(a.size(), b.size());
  while (begin < shorter && a[begin] == b[begin]) ++begin;
  while (end < shorter - begin && a[a.size() - 1 - end] == b[b.size() - 1 - end]) ++end;
  if (a.size() == b.size()) {
    for (std::size_t i = begin; i < a.size() - end; ++i)
      if (a[i] != b[i]) list.add({{}, i + 1, a[i], b[i]});
    return;
  }
  for (std::size_t i = begin; i < a.size() - end; ++i) list.add({{}, i + 1, a[i], std::nullopt});
  for (std::size_t i = begin; i < b.size() - end; ++i) list.add({{}, i + 1, std::nullopt, b[i]});
}

/// Returns keys with values, for example "machine.axes.X.tolerance_um.B" -> "3". Tables of a list
/// are named by their `id`, or without `id` by their position, counted from 1. Empty if the text is
/// not TOML.
std::map<std::string, std::string> flat_toml(std::string_view text) {
  Keys out;
  try {
    flatten(toml::parse(text), "", out);
  } catch (const toml::parse_error&) {
    out.clear();
  }
  return out;
}

/// Lists the differences between two versions of a file, at most `most_changes`: keys of a TOML
/// file, lines of a text, nothing for other files. If `before` or `after` is null, the file is new
/// or was removed.
FileChange change_of(const std::string& file, const std::string* before, const std::string* after) {
  FileChange change{file};
  if (before == nullptr || after == nullptr) return change;
  if (file.ends_with(".toml"))
    compare_keys(flat_toml(*before), flat_toml(*after), change);
  else if (is_text(*before) && is_text(*after))
    compare_lines(lines_of(*before), lines_of(*after), change);
  return change;
}

/// A certificate must not change with other campaigns or with the machine's record.
bool is_foreign(const std::string& input) {
  return input.starts_with(reading::shared_name("")) || input.starts_with(config::machine_prefix);
}

/// Returns the campaign's own files and the parts of site.toml that affect the results.
reading::Inputs data_of(const evaluation::Evaluated& evaluated, const reading::Context& context) {
  reading::Inputs data = evaluated.inputs;
  std::erase_if(data, [](const auto& one) { return is_foreign(one.first); });
  data.emplace_back(config::site_name, storage::sha256(context.site.evaluation));
  return data;
}

/// Returns a time in s. If the register is locked longer, the campaign is evaluated again later.
double short_wait(const config::Numbering& numbering) {
  constexpr double seconds = 5.0;
  return std::min(seconds, numbering.patience);
}

using Files = std::vector<std::pair<std::string, std::string>>;  // name and bytes of each file

const std::string* find_file(const Files& files, const std::string& name) {
  for (const auto& [known, bytes] : files)
    if (known == name) return &bytes;
  return nullptr;
}

/// Returns the manifest, the readings and the settings of the site from an issued certificate.
Expected<Files> attached_files(const std::vector<evaluation::IssuedFile>& issued) {
  Files files;
  for (const evaluation::IssuedFile& f : issued) {
    if (!f.bytes.starts_with("%PDF-")) continue;
    auto attached = sign::unverified_attachments(f.bytes);
    if (!attached) return fail(f.name + " in the register: " + attached.error().message);
    for (pdf::Attachment& a : *attached)
      if (a.relation == source_relation && a.name != templates_name &&
          a.name != config::machine_record_name)
        files.emplace_back(a.name == settings_name ? config::site_name : std::move(a.name),
                           std::move(a.bytes));
    break;
  }
  return files;
}

Expected<Files> current_files(const evaluation::Evaluated& evaluated,
                              const reading::Context& context, CampaignFiles& of_campaign) {
  Files files;
  for (const auto& [input, digest] : evaluated.inputs) {
    const std::string name = file_of_input(input);
    if (name.empty()) continue;
    NONIO_TRY(const auto bytes, of_campaign.bytes(name, digest));
    files.emplace_back(name, bytes);
  }
  if (!context.site.settings.empty()) files.emplace_back(config::site_name, context.site.settings);
  return files;
}

/// TOML files in which only comments or the reason for the amendment have changed are left out.
std::vector<FileChange> changes_of(const Files& then, const Files& now) {
  std::vector<FileChange> all;
  for (const auto& [name, bytes] : now) {
    const std::string* before = find_file(then, name);
    if (before != nullptr && *before == bytes) continue;
    FileChange change = change_of(name, before, &bytes);
    if (before != nullptr && name.ends_with(".toml") && change.changes.empty()) continue;
    all.push_back(std::move(change));
  }
  for (const auto& [name, bytes] : then)
    if (find_file(now, name) == nullptr) all.push_back(change_of(name, &bytes, nullptr));
  return all;
}

/// Replaces new files by those in the register, and removes the others that were to be signed.
void take_issued(evaluation::Evaluated& evaluated) {
  for (Results::Written& w : evaluated.results.outputs)
    for (const evaluation::IssuedFile& f : evaluated.certificate->files) {
      auto& artifacts = w.result.artifacts;
      const auto same = std::find_if(artifacts.begin(), artifacts.end(),
                                     [&](const Artifact& a) { return a.name == f.name; });
      if (w.plugin == f.output && same != artifacts.end()) *same = {f.name, f.bytes};
    }
  remove_unsigned(evaluated);
}

/// If two persons gave different reasons for the same finding, the certificate states both.
void put_reasons(const Releasing& releasing, Issue& issue) {
  for (const evaluation::KnownFinding& f : releasing.draft.findings) {
    if (!reading::is_expired_calibration(f.id)) continue;
    const auto& author = releasing.draft.author;
    for (const Approval* one : {author ? &*author : nullptr, &releasing.by}) {
      if (one == nullptr) continue;
      const auto given = one->reasons.find(finding_key(f));
      if (given == one->reasons.end()) continue;
      const bool known =
          std::any_of(issue.reasons.begin(), issue.reasons.end(), [&](const Issue::Reason& r) {
            return r.finding == f.id && r.text == given->second && r.by == one->by;
          });
      if (!known) issue.reasons.push_back({f.id, given->second, one->by});
    }
  }
}

}  // namespace

const config::AcceptedRule* rule_for(const config::Numbering& numbering,
                                     const evaluation::KnownFinding& finding) {
  if (finding.id.starts_with(reading::plausibility_prefix)) return nullptr;
  for (const config::AcceptedRule& rule : numbering.accepted) {
    const bool all_of_a_kind = rule.finding.ends_with(".*");
    if (all_of_a_kind ? finding.id.starts_with(rule.finding.substr(0, rule.finding.size() - 1))
                      : finding.id == rule.finding)
      return &rule;
  }
  return nullptr;
}

Expected<bool> Numbers::has_register() const {
  NONIO_TRY(const auto place, register_place(where_.site, context_.site.numbering));
  return certificates::has_register(place, short_wait(context_.site.numbering));
}

Expected<Register> Numbers::open() const {
  return Register::open(where_.site, context_.site.numbering, short_wait(context_.site.numbering));
}

namespace {

/// Whether a person has to decide, because no rule accepts a finding with severity warning.
bool any_unruled(const std::vector<evaluation::KnownFinding>& findings,
                 const config::Numbering& numbering) {
  return std::any_of(findings.begin(), findings.end(), [&](const evaluation::KnownFinding& f) {
    return f.attention && rule_for(numbering, f) == nullptr;
  });
}

/// Returns the inputs that must not change between a draft and its approval.
reading::Inputs made_from(const evaluation::Evaluated& evaluated, const reading::Context& context) {
  reading::Inputs all = data_of(evaluated, context);
  for (const auto& [name, digest] : evaluated.inputs)
    if (name.starts_with(config::machine_prefix)) all.emplace_back(name, digest);
  for (const auto& [name, digest] : reading::shared_inputs(context))
    if (name != config::site_name) all.emplace_back(name, digest);
  // Texts of the pages, such as the laboratory's name and accreditation.
  all.emplace_back(std::string(config::site_name) + " [laboratory], [certificate]",
                   storage::sha256(context.site.settings));
  return all;
}

}  // namespace

bool Numbers::may_issue(const evaluation::Evaluated& evaluated) const {
  if (releasing_ != nullptr) return true;
  const config::Numbering& numbering = context_.site.numbering;
  return numbering.automatic &&
         !any_unruled(evaluation::known_findings(evaluated.results, context_.templates), numbering);
}

void Numbers::hold_unreleased(evaluation::Evaluated& evaluated) const {
  if (evaluated.certificate || may_issue(evaluated)) return;
  for (Results::Written& w : evaluated.results.outputs) {
    std::string files;
    for (const Artifact& a : w.result.artifacts)
      if (a.sign) files += (files.empty() ? "" : ", ") + a.name;
    if (files.empty()) continue;
    std::erase_if(w.result.artifacts, [](const Artifact& a) { return a.sign; });
    note_finding(evaluated, w.plugin,
                 {.id = "signature.not-released",
                  .attention = true,
                  .texts = {{"file", files}, {"output", w.plugin}}});
  }
}

bool Numbers::held_up(const evaluation::Evaluated& evaluated) const {
  const auto& certificate = evaluated.certificate;
  return certificate && !certificate->issued && !certificate->draft && !may_issue(evaluated);
}

/// Returns an error if the approved draft was made from other inputs than `now`.
Expected<void> Numbers::check_release(const reading::Inputs& now) const {
  if (releasing_ == nullptr) return {};
  std::string other;
  for (const auto& one : now)
    if (std::find(releasing_->draft.made_from.begin(), releasing_->draft.made_from.end(), one) ==
        releasing_->draft.made_from.end())
      other += (other.empty() ? "" : ", ") + one.first;
  if (other.empty() && now.size() == releasing_->draft.made_from.size()) return {};
  return fail("not the draft any more that is to be released; changed since: " +
              (other.empty() ? "files that are gone" : other) +
              ". Run `nonio run` again, and check the new draft");
}

Expected<void> Numbers::amend(Register& opened, const RegisterEntry& before,
                              const evaluation::Evaluated& evaluated, CampaignFiles& files,
                              Issue& issue, std::vector<std::string>& missing) const {
  NONIO_TRY(const auto old_files, opened.files(before.number));
  NONIO_TRY(auto attached, attached_files(old_files));
  const Files then = std::move(attached);
  NONIO_TRY(const auto now, current_files(evaluated, context_, files));
  issue.replaces = before.number;
  issue.replaces_date = before.date;
  issue.changes = changes_of(then, now);
  const std::string& stated = evaluated.campaign.certificate.amendment;
  const std::string* manifest = find_file(then, config::manifest_name);
  const bool is_old =
      has_content(stated) && manifest != nullptr && flat_toml(*manifest)[amendment_key] == stated;
  issue.why = before.state == "withdrawn" ? before.reason : "";
  if (has_content(stated) && !is_old && stated != issue.why)
    issue.why += (issue.why.empty() ? "" : "; ") + stated;
  if (issue.why.empty())
    missing.push_back(
        std::string(amendment_key) + " (why " + before.number + " is replaced" +
        (is_old ? "; what it states was there for " + before.number + " already" : "") + ")");
  return {};
}

evaluation::AssignedNumber Numbers::assign(const evaluation::Evaluated& evaluated,
                                           CampaignFiles& files, std::vector<std::string> missing,
                                           bool as_draft) const {
  auto certificate = find_or_draw(evaluated, files, missing, as_draft);
  evaluation::AssignedNumber assigned;
  assigned.missing = std::move(missing);
  if (!certificate)
    assigned.error = certificate.error();
  else if (certificate->draft || !certificate->issue.number.empty())
    assigned.certificate = std::move(*certificate);
  return assigned;
}

Expected<evaluation::Certificate> Numbers::find_or_draw(const evaluation::Evaluated& evaluated,
                                                        CampaignFiles& files,
                                                        std::vector<std::string>& missing,
                                                        bool as_draft) const {
  for (std::string& key : reading::days_to_come(evaluated.campaign, where_.today))
    missing.push_back(std::move(key));
  if (!missing.empty()) {
    NONIO_TRY(const auto there, has_register());
    if (!there) return evaluation::Certificate{};
  }
  NONIO_TRY(auto opened, open());
  const std::string& campaign = evaluated.campaign.id;
  const reading::Inputs data = data_of(evaluated, context_);
  auto found = opened.find(campaign, data);
  if (!found) return fail(found.error());
  if (*found && releasing_ != nullptr) {
    const auto first = opened.note_second((*found)->issue.number, campaign, releasing_->by);
    return fail(first ? *first : first.error().message);
  }
  if (*found) return std::move(**found);
  if (auto same = check_release(made_from(evaluated, context_)); !same) return fail(same.error());
  NONIO_TRY(const auto before, opened.last_number(campaign));
  // Another run may have issued a certificate for the same data in the meantime.
  if (before) found = opened.find(campaign, data);
  if (!found) return fail(found.error());
  if (*found) return std::move(**found);
  evaluation::Certificate certificate;
  Issue& issue = certificate.issue;
  if (before)
    if (auto done = amend(opened, *before, evaluated, files, issue, missing); !done)
      return fail(done.error());
  if (!missing.empty()) return evaluation::Certificate{};
  if (!where_.can_sign) return fail(no_key);
  NONIO_TRY(auto readings, files.readings_sha256(evaluated.inputs));
  issue.readings_sha256 = readings;
  certificate.templates_sha256 = context_.template_texts.sha256;
  certificate.draft = as_draft || !may_issue(evaluated);
  if (certificate.draft) return certificate;
  auto drawn = opened.draw(campaign, data, where_.today);
  if (!drawn || drawn->issued) return drawn;
  if (drawn->issue.replaces != issue.replaces)
    return fail("another run has issued " + drawn->issue.replaces + " meanwhile");
  issue.number = drawn->issue.number;
  issue.date = drawn->issue.date;
  issue.register_id = drawn->issue.register_id;
  issue.register_entry = drawn->issue.register_entry;
  issue.register_sha256 = drawn->issue.register_sha256;
  if (releasing_ != nullptr) {
    issue.released_by = releasing_->by.by;
    if (releasing_->draft.author) issue.author = releasing_->draft.author->by;
    put_reasons(*releasing_, issue);
  }
  return certificate;
}

namespace {

storage::Json approval_json(const Approval& approval) {
  storage::Json json = {{"by", approval.by},
                        {"role", approval.role},
                        {"at", approval.at.empty() ? utc_now() : approval.at},
                        {"reasons", approval.reasons}};
  if (!approval.user.empty()) json["user"] = approval.user;
  return json;
}

}  // namespace

std::string Numbers::released_json(const std::vector<evaluation::KnownFinding>& findings) const {
  storage::Json json = storage::Json::object();
  storage::Json open = storage::Json::object(), rules = storage::Json::object();
  for (const evaluation::KnownFinding& f : findings) {
    open[finding_key(f)] = f.attention ? "attention" : "info";
    const config::AcceptedRule* rule = rule_for(context_.site.numbering, f);
    if (f.attention && rule != nullptr) rules[finding_key(f)] = rule->reason;
  }
  json["findings"] = std::move(open);
  if (releasing_ == nullptr) {
    json["rules"] = std::move(rules);
  } else {
    if (releasing_->draft.author) json["author"] = approval_json(*releasing_->draft.author);
    json["released"] = approval_json(releasing_->by);
  }
  return json.dump();
}

Expected<void> Numbers::enter_draft(const evaluation::Evaluated& evaluated,
                                    const std::string& folder) const {
  const evaluation::Certificate& certificate = *evaluated.certificate;
  WaitingDraft draft;
  draft.campaign = evaluated.campaign.id;
  draft.folder = folder;
  draft.out = where_.out.string();
  draft.replaces = certificate.issue.replaces;
  draft.made_from = made_from(evaluated, context_);
  draft.findings =
      evaluation::known_findings(evaluated.results, context_.templates, context_.site.language);
  for (const Results::Written& w : evaluated.results.outputs)
    if (w.plugin == certificate.output && !w.result.artifacts.empty()) {
      draft.file = w.result.artifacts.front().name;
      draft.sha256 = storage::sha256(w.result.artifacts.front().bytes);
    }
  if (draft.file.empty())
    return fail("output " + certificate.output + " makes no PDF that could be released");
  NONIO_TRY(auto opened, open());
  return opened.enter_draft(draft);
}

Expected<void> Numbers::issue_new(evaluation::Evaluated& evaluated) const {
  const auto findings = evaluation::known_findings(evaluated.results, context_.templates);
  if (releasing_ != nullptr) {
    const auto& seen = releasing_->draft.findings;
    for (const evaluation::KnownFinding& f : findings)
      if (f.attention && std::none_of(seen.begin(), seen.end(),
                                      [&](const evaluation::KnownFinding& k) { return k.same(f); }))
        return fail("the finding " + finding_key(f) +
                    " did not exist when the draft was made: run `nonio run` again");
  }
  evaluated.certificate->released = released_json(findings);
  NONIO_TRY(auto opened, open());
  std::optional<Approved> approved;
  if (releasing_ != nullptr) approved.emplace(Approved{releasing_->draft, releasing_->by});
  NONIO_TRY(auto issued,
            opened.issue(*evaluated.certificate, evaluated.campaign.id,
                         data_of(evaluated, context_), approved ? &*approved : nullptr));
  evaluated.certificate = std::move(issued);
  take_issued(evaluated);
  return {};
}

Expected<void> Numbers::issue(evaluation::Evaluated& evaluated, const std::string& folder) const {
  if (!evaluated.certificate || evaluated.status == evaluation::Status::failed) return {};
  if (evaluated.certificate->draft) return enter_draft(evaluated, folder);
  if (evaluated.certificate->issued) {
    take_issued(evaluated);
    note_differences(evaluated);
  } else if (auto done = issue_new(evaluated); !done) {
    return done;
  }
  for (const evaluation::IssuedFile& file : evaluated.certificate->files)
    note_time_stamp(evaluated, file);
  return {};
}

/// Adds a finding if this version would print other values than the issued certificate.
void Numbers::note_differences(evaluation::Evaluated& evaluated) const {
  auto outputs = std::exchange(evaluated.results.outputs, {});
  const auto same = same_values(evaluated.certificate->results,
                                evaluation::results_json(evaluated, context_, {}));
  evaluated.results.outputs = std::move(outputs);
  if (same) return;
  note_finding(
      evaluated, evaluated.certificate->output,
      {.id = "certificate.differs",
       .attention = true,
       .texts = {{"number", evaluated.certificate->issue.number}, {"why", same.error().message}}});
}

void Numbers::note_failure(const std::string& campaign, const std::string& why) const {
  if (!has_register().value_or(false)) return;
  auto opened = open();
  if (!opened) return;
  [[maybe_unused]] const auto noted = opened->note_failure(campaign, why);
}

}  // namespace nonio::certificates
