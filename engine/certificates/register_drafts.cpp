// SPDX-License-Identifier: Apache-2.0
//
// Stores drafts in the register until a person approves them; issued ones are removed.
#include "certificates/register.h"
#include "certificates/register_tables.h"

namespace nonio::certificates {

namespace {

storage::Json draft_json(const Approval& a) {
  storage::Json json = {
      {"by", a.by}, {"role", a.role}, {"at", a.at}, {"reasons", a.reasons}, {"account", a.account}};
  if (!a.user.empty()) json["user"] = a.user;
  return json;
}

storage::Json draft_json(const WaitingDraft& d) {
  storage::Json json = {{"folder", d.folder},
                        {"out", d.out},
                        {"file", d.file},
                        {"sha256", d.sha256},
                        {"replaces", d.replaces},
                        {"made_from", d.made_from},
                        {"findings", storage::Json::array()}};
  for (const evaluation::KnownFinding& f : d.findings) {
    storage::Json one = {{"measurement", f.measurement},
                         {"id", f.id},
                         {"title", f.title},
                         {"attention", f.attention}};
    if (!f.said.empty()) one["said"] = f.said;
    json["findings"].push_back(std::move(one));
  }
  if (d.author) json["author"] = draft_json(*d.author);
  return json;
}

/// Throws exceptions of nlohmann::json if `json` was not written by `draft_json`.
WaitingDraft draft_of(const std::string& campaign, const storage::Json& json) {
  WaitingDraft d;
  d.campaign = campaign;
  json.at("folder").get_to(d.folder);
  json.at("out").get_to(d.out);
  json.at("file").get_to(d.file);
  json.at("sha256").get_to(d.sha256);
  json.at("replaces").get_to(d.replaces);
  json.at("made_from").get_to(d.made_from);
  for (const storage::Json& f : json.at("findings"))
    d.findings.push_back(
        {f.at("measurement"), f.at("id"), f.at("title"), f.at("attention"), f.value("said", "")});
  if (json.contains("author")) {
    const storage::Json& a = json["author"];
    d.author = Approval{a.at("by"),      a.at("role"),           a.at("at"),
                        a.at("reasons"), a.value("account", ""), a.value("user", "")};
  }
  return d;
}

Expected<std::vector<WaitingDraft>> drafts_of(const std::vector<storage::Database::Row>& rows) {
  std::vector<WaitingDraft> drafts;
  for (const storage::Database::Row& row : rows) try {
      drafts.push_back(draft_of(row[0], storage::parse(row[1])));
    } catch (const storage::Json::exception&) {
      return fail("the register's draft of " + row[0] +
                  " cannot be read; expected a draft of `nonio run`: run with --force");
    }
  return drafts;
}

bool same_work(const WaitingDraft& a, const WaitingDraft& b) {
  const auto same = [](const evaluation::KnownFinding& x, const evaluation::KnownFinding& y) {
    return x.same(y) && x.title == y.title && x.attention == y.attention;
  };
  return a.made_from == b.made_from && a.replaces == b.replaces && a.sha256 == b.sha256 &&
         std::equal(a.findings.begin(), a.findings.end(), b.findings.begin(), b.findings.end(),
                    same);
}

}  // namespace

std::string finding_key(const evaluation::KnownFinding& finding) {
  return (finding.measurement.empty() ? "" : finding.measurement + ": ") + finding.id;
}

Expected<std::vector<WaitingDraft>> Register::all_drafts() {
  const auto rows = database_->rows("SELECT campaign, says FROM drafts ORDER BY campaign");
  if (auto well = database_->take_error(); !well) return fail(well.error());
  return drafts_of(rows);
}

Expected<std::optional<WaitingDraft>> Register::draft(const std::string& campaign) {
  const auto rows =
      database_->rows("SELECT campaign, says FROM drafts WHERE campaign = ?", {campaign});
  if (auto well = database_->take_error(); !well) return fail(well.error());
  NONIO_TRY(auto drafts, drafts_of(rows));
  if (drafts.empty()) return std::nullopt;
  return std::move(drafts.front());
}

namespace {

void put_draft(storage::Database& database, const WaitingDraft& draft) {
  database.rows(
      "INSERT INTO drafts VALUES(?, ?) ON CONFLICT(campaign) DO UPDATE SET says = excluded.says",
      {draft.campaign,
       draft_json(draft).dump(-1, ' ', false, storage::Json::error_handler_t::replace)});
}

}  // namespace

Expected<void> Register::enter_draft(const WaitingDraft& draft) {
  storage::Database::Transaction transaction(*database_);
  WaitingDraft now = draft;
  // A draft that cannot be read is replaced.
  if (const auto before = this->draft(draft.campaign);
      before && *before && same_work(**before, now))
    now.author = (*before)->author;
  put_draft(*database_, now);
  return transaction.end();
}

Expected<void> Register::check_seen(const WaitingDraft& seen, const Approval& by) {
  NONIO_TRY(const auto waiting, draft(seen.campaign));
  if (!waiting)
    return fail("the draft of " + seen.campaign +
                " no longer waits: it was issued, or made anew, since it was read");
  if (!same_work(*waiting, seen))
    return fail("the draft of " + seen.campaign +
                " has changed since it was read: read the new one, and approve that");
  const auto& now = waiting->author;
  if (now.has_value() == seen.author.has_value() &&
      (!now || (now->by == seen.author->by && now->at == seen.author->at)))
    return {};
  if (!now) return fail("the author's approval of " + seen.campaign + " no longer exists");
  add_second("", seen.campaign, by);
  return fail(now->by + " approved the draft of " + seen.campaign + " first, at " + now->at +
              "; this approval has no effect. The register keeps its reasons");
}

void Register::add_second(const std::string& number, const std::string& campaign,
                          const Approval& by) {
  storage::Json says = draft_json(by);
  if (by.at.empty()) says["at"] = utc_now();
  says["campaign"] = campaign;
  Journal(*database_).add("second", number, says);
}

Expected<void> Register::approve(const WaitingDraft& seen, const Approval& approval) {
  storage::Database::Transaction transaction(*database_);
  if (auto same = check_seen(seen, approval); !same) {
    // The record of the second approval is committed before the error is returned.
    if (auto ended = end(transaction); !ended) return ended;
    return same;
  }
  NONIO_TRY(auto waiting, draft(seen.campaign));
  WaitingDraft& now = *waiting;
  now.author = approval;
  now.author->at = utc_now();
  now.author->account = own_account();
  put_draft(*database_, now);
  storage::Json says = draft_json(*now.author);
  says["campaign"] = now.campaign;
  says["draft_sha256"] = now.sha256;
  Journal(*database_).add("approved", "", says);
  return end(transaction);
}

Expected<std::optional<Approval>> Register::approval_of(const std::string& number) {
  const auto issued = Journal(*database_).last_of("issued", number);
  if (auto well = database_->take_error(); !well) return fail(well.error());
  const storage::Json says = issued ? storage::parse_or_discard(issued->says) : storage::Json();
  if (!says.is_object() || !says.contains("released") || !says["released"].contains("released"))
    return std::nullopt;
  const storage::Json& one = says["released"]["released"];
  return Approval{
      one.value("by", ""),       one.value("role", ""),
      one.value("at", ""),       one.value("reasons", std::map<std::string, std::string>{}),
      says.value("account", ""), one.value("user", "")};
}

Expected<std::string> Register::first_of(const std::string& number) {
  NONIO_TRY(const auto first, approval_of(number));
  return number + " was issued first" +
         (first ? ", approved by " + first->by + " at " + first->at
                : std::string(" by the rules of the laboratory")) +
         "; this approval has no effect. The register keeps its reasons";
}

Expected<std::string> Register::note_second(const std::string& number, const std::string& campaign,
                                            const Approval& second) {
  storage::Database::Transaction transaction(*database_);
  add_second(number, campaign, second);
  if (auto ended = end(transaction); !ended) return fail(ended.error());
  return first_of(number);
}

}  // namespace nonio::certificates
