// SPDX-License-Identifier: Apache-2.0
#include "certificates/register_check.h"

#include <algorithm>
#include <map>
#include <set>
#include <utility>

#include "campaign/evaluation/record.h"
#include "campaign/evaluation/results_json.h"
#include "certificates/certificate_list.h"
#include "certificates/content_check.h"
#include "certificates/register.h"
#include "certificates/register_place.h"
#include "certificates/register_tables.h"
#include "nonio/sign/verify.h"
#include "platform/storage/digest.h"

namespace nonio::certificates {

namespace fs = std::filesystem;

namespace {

using State = sign::Check::State;

struct StatedNumber {
  std::string number, register_id;
  bool by_register = true;  ///< false if the number may come from another source
};

/// Returns an empty number if the DCC has no identifier. Only the output `certificate` takes it
/// from a register.
StatedNumber stated_in_dcc(std::string_view xml) {
  constexpr std::string_view open = "<dcc:uniqueIdentifier>", close = "</dcc:uniqueIdentifier>";
  const std::size_t begin = xml.find(open);
  const std::size_t end = xml.find(close);
  if (begin == std::string_view::npos || end == std::string_view::npos || end < begin) return {};
  constexpr std::string_view numbered = ">Nonio certificate<";
  return {std::string(xml.substr(begin + open.size(), end - begin - open.size())),
          {},
          xml.find(numbered) != std::string_view::npos};
}

StatedNumber stated_in_pdf(const sign::Verified& v) {
  const pdf::Attachment* results = find_attachment(v, evaluation::results_name);
  if (results == nullptr) return {};
  const storage::Json json = storage::parse_once(results->bytes);
  if (!json.is_object() || !json.contains("certificate")) return {};
  const Issue issue = evaluation::certificate_of(json["certificate"]).issue;
  return {issue.number, issue.register_id, true};
}

std::string words_of(const RegisterEntry& e) {
  if (e.state == "withdrawn")
    return e.number + " was withdrawn: " + e.reason +
           (e.replaced_by.empty() ? "" : "; " + e.replaced_by + " replaces it");
  if (e.state == "amended") return e.number + " was replaced by " + e.replaced_by;
  if (e.state == "drawn") return e.number + " was drawn and never issued";
  return e.number + " of " + e.date + " is in force, and this is the file that was issued";
}

}  // namespace

std::string no_verdict(const RegisterRows& rows, const std::string& what) {
  return "no verdict on " + what + ", because the register cannot be read: " + rows.no_answer;
}

RegisterRows register_rows(const fs::path& site) {
  RegisterRows rows;
  if (site.empty()) return rows;
  rows.asked = true;
  const auto read = [&]() -> Expected<void> {
    NONIO_TRY(const auto numbering, numbering_of(site));
    NONIO_TRY(const auto place, register_place(site, numbering));
    NONIO_TRY(const auto there, has_register(place, storage::Database::usual_patience));
    rows.exists = there;
    if (!rows.exists) return {};
    NONIO_TRY(auto opened, Register::open_to_read(site, numbering));
    NONIO_TRY(auto entries, opened.all());
    NONIO_TRY(auto issued, opened.issued_digests());
    rows.entries = std::move(entries);
    rows.issued = std::move(issued);
    rows.id = opened.id();
    return {};
  };
  if (const auto done = read(); !done) rows.no_answer = done.error().message;
  return rows;
}

std::string issued_by(const RegisterRows& rows, std::string_view bytes) {
  if (rows.issued.empty()) return {};
  const auto found = rows.issued.find(storage::sha256(sign::issued_part(bytes)));
  return found == rows.issued.end()
             ? ""
             : "the register " + rows.id + " issued this file as " + found->second;
}

Expected<std::optional<sign::Check>> check_register(const sign::Verified& verified,
                                                    std::string_view bytes,
                                                    const RegisterRows& rows) {
  StatedNumber stated = bytes.starts_with("%PDF-") ? stated_in_pdf(verified) : stated_in_dcc(bytes);
  if (stated.number.empty()) return std::nullopt;
  sign::Check check{"register.state", State::fails, {}};
  const auto says = [&](State state, std::string words) {
    check.state = state;
    check.says = std::move(words);
    return check;
  };
  if (!rows.asked) {
    check.essential = false;
    return says(State::not_checked,
                "whether " + stated.number +
                    " was withdrawn or replaced: requires the register of its site (--site)");
  }
  if (!rows.no_answer.empty()) return fail(no_verdict(rows, stated.number));
  if (!rows.exists) {
    check.essential = stated.by_register;
    return says(State::not_checked, "the site has no register that states this " + stated.number);
  }
  const auto issued = rows.issued.find(storage::sha256(bytes));
  if (issued != rows.issued.end()) stated.number = issued->second;
  if (!stated.register_id.empty() && !rows.id.empty() && stated.register_id != rows.id)
    return says(State::fails, stated.number + " was issued by the register " + stated.register_id +
                                  "; that of this site is " + rows.id);
  const auto entry =
      std::find_if(rows.entries.begin(), rows.entries.end(),
                   [&](const RegisterEntry& e) { return e.number == stated.number; });
  if (entry == rows.entries.end()) {
    if (stated.by_register)
      return says(State::fails, "the register of this site never issued " + stated.number +
                                    ": was the site copied, or the register replaced?");
    check.essential = false;
    return says(State::not_checked, stated.number + " is not a number of this site's register");
  }
  if (issued == rows.issued.end())
    return says(State::fails, "the register of this site has issued another certificate as " +
                                  stated.number + ": was the site copied?");
  return says(entry->in_force() ? State::holds : State::fails, words_of(*entry));
}

//
// Checks that a register was not changed outside of this program. The journal is a chain of
// digests, which a changed or removed entry breaks. A chain that was written again as a whole is
// disclosed by the certificates: each contains, below its signature, the digest of the journal up
// to its own number.
namespace {

class Auditor {
 public:
  explicit Auditor(storage::Database& database)
      : database_(database), entries_(Journal(database).all()) {
    for (const Journal::Entry& e : entries_) last_[{e.number, e.what}] = &e;
  }

  /// Checks the chain of digests and, with `numbers`, the numbers, but not the files.
  std::vector<std::string> run_journal(bool numbers) {
    audit_.id = database_.first("SELECT id FROM site");
    check_chain();
    look_at_files_ = false;
    if (numbers) check_numbers();
    return std::move(audit_.wrong);
  }

  Audit run() {
    audit_.id = database_.first("SELECT id FROM site");
    audit_.entries = entries_.size();
    if (!entries_.empty()) {
      audit_.last_at = entries_.back().at;
      audit_.last_sha256 = entries_.back().sha256;
    }
    check_chain();
    check_numbers();
    return std::move(audit_);
  }

 private:
  void wrong(std::string what) { audit_.wrong.push_back(std::move(what)); }

  static std::string name_of(const Journal::Entry& e) {
    return "entry " + std::to_string(e.place) + " of the journal (" + e.what +
           (e.number.empty() ? "" : " " + e.number) + ", " + e.at + ")";
  }

  void check_chain() {
    std::string before;
    std::int64_t place = 0;
    for (const Journal::Entry& e : entries_) {
      if (e.place != place + 1)
        wrong("the journal has no entry " + std::to_string(place + 1) + ": it was taken out");
      else if (e.sha256 != Journal::digest(e, before))
        wrong(name_of(e) + " is not what was written");
      place = e.place;
      before = e.sha256;
    }
    if (entries_.empty() || entries_.front().what != "made")
      wrong("the journal does not begin with the making of the register");
    else if (storage::parse_or_discard(entries_.front().says).value("register", "") != audit_.id)
      wrong("the identity of the register is not the one with which it was made");
  }

  const Journal::Entry* noted(const char* what, const std::string& number) const {
    const auto found = last_.find({number, what});
    return found == last_.end() ? nullptr : found->second;
  }

  void check_numbers() {
    std::set<std::string> known;
    for (const storage::Database::Row& row : database_.rows(
             "SELECT id, number, campaign, state, reason FROM certificates ORDER BY id")) {
      known.insert(row[1]);
      check_number(integer(row[0]), row[1], row[2], row[3], row[4]);
    }
    for (const Journal::Entry& e : entries_)
      if (!e.number.empty() && known.insert(e.number).second)
        wrong("the number " + e.number + " was taken out: " + name_of(e) + " mentions it");
  }

  void check_number(std::int64_t id, const std::string& number, const std::string& campaign,
                    const std::string& state, const std::string& reason) {
    const auto says = [](const Journal::Entry& e) {
      storage::Json json = storage::parse_or_discard(e.says);
      return json.is_object() ? json : storage::Json::object();
    };
    const Journal::Entry* drawn = noted("drawn", number);
    if (drawn == nullptr) return wrong("the journal does not know the number " + number);
    if (says(*drawn).value("campaign", "") != campaign)
      wrong(number + " was drawn for another campaign than " + campaign);
    const Journal::Entry* issued = noted("issued", number);
    const Journal::Entry* withdrawn = noted("withdrawn", number);
    if ((state != "drawn") != (issued != nullptr) ||
        (state == "withdrawn") != (withdrawn != nullptr))
      wrong(number + " is " + state + ", and the journal states that it " +
            (withdrawn != nullptr ? "was withdrawn"
             : issued != nullptr  ? "was issued"
                                  : "was only drawn"));
    if (withdrawn != nullptr && says(*withdrawn).value("reason", "") != reason)
      wrong("the reason why " + number + " was withdrawn is not the one that was given");
    if (issued != nullptr && look_at_files_) check_issued(id, number, says(*issued), *drawn);
  }

  void check_issued(std::int64_t id, const std::string& number, const storage::Json& noted,
                    const Journal::Entry& drawn) {
    ++audit_.certificates;
    const storage::Json now = issued_json(database_, id);
    audit_.files += now.contains("files") ? now["files"].size() : 0;
    for (const auto& [key, value] : now.items())
      if (!noted.contains(key) || noted[key] != value)
        wrong(number + ": " + key + " is not what was issued");
    check_anchor(id, number, noted.contains("carried_over"), drawn);
  }

  /// The signed file states the journal entry with which its number was drawn.
  void check_anchor(std::int64_t id, const std::string& number, bool carried_over,
                    const Journal::Entry& drawn) {
    for (const storage::Database::Row& row :
         database_.rows("SELECT bytes FROM files WHERE certificate = ? ORDER BY place", {id})) {
      if (!row[0].starts_with("%PDF-")) continue;
      const auto attached = sign::unverified_attachments(row[0]);
      if (!attached) return wrong(number + ": " + attached.error().message);
      for (const pdf::Attachment& a : *attached) {
        if (a.name != evaluation::results_name) continue;
        const storage::Json results = storage::parse_or_discard(a.bytes);
        const storage::Json certificate = results.is_object() && results.contains("certificate")
                                              ? results["certificate"]
                                              : storage::Json::object();
        if (!certificate.contains("register")) {
          if (!carried_over) wrong(number + ": the signed file does not name the register");
          return;
        }
        const storage::Json& anchor = certificate["register"];
        if (anchor.value("id", "") != audit_.id ||
            anchor.value("entry", "") != std::to_string(drawn.place) ||
            anchor.value("sha256", "") != drawn.sha256)
          wrong(number + ": the signed file states another journal: the entries before " +
                name_of(drawn) + " was written anew");
        return;
      }
    }
  }

  storage::Database& database_;
  const std::vector<Journal::Entry> entries_;
  std::map<std::pair<std::string, std::string>, const Journal::Entry*> last_;
  Audit audit_;
  bool look_at_files_ = true;
};

}  // namespace

Expected<void> Register::check_journal(bool numbers) {
  if (!is_of_this_version(*database_)) return database_->take_error();
  storage::Database::Transaction transaction(*database_);
  const std::vector<std::string> wrong = Auditor(*database_).run_journal(numbers);
  if (auto ended = transaction.end(); !ended) return ended;
  if (wrong.empty()) return {};
  return fail("the register of certificates is not what was written: " + wrong.front() +
              (wrong.size() == 1 ? "" : ", and " + std::to_string(wrong.size() - 1) + " more") +
              ". Nothing is issued from it; `nonio certificate audit SITE` lists all. Restore it "
              "from the newest backup");
}

Expected<Audit> Register::audit() {
  // The lock prevents changes during the audit.
  storage::Database::Transaction transaction(*database_);
  Audit audit = Auditor(*database_).run();
  if (auto same = check_seen_state(*database_, *place_); !same)
    audit.wrong.push_back(same.error().message);
  if (auto ended = transaction.end(); !ended) return fail(ended.error());
  return audit;
}

}  // namespace nonio::certificates
