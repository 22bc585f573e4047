// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "campaign/evaluation/evaluate.h"
#include "campaign/evaluation/record.h"
#include "platform/storage/database.h"

namespace nonio::certificates {

struct RegisterPlace;

/// One number of a register.
struct RegisterEntry {
  std::string number, campaign;
  std::string state;  ///< drawn, issued, amended, withdrawn
  std::string date;   ///< of issue; of a number that is only drawn: the day on which it was drawn
  std::string replaces, replaced_by;
  std::string reason;       ///< why it was withdrawn; why it is not issued yet
  std::uint64_t order = 0;  ///< in which numbers were issued, from 1; 0: not issued
  /// Who released it and who withdrew it, as they stated. Empty: the rules; not stated.
  std::string released_by{}, withdrawn_by{};
  /// Under which accounts of the operating system, "user@host"; empty before version 2026-12.
  std::string released_account{}, withdrawn_account{};
  /// Account of users.toml whose password was given; empty: the name is a statement.
  std::string released_user{};
  /// Of the certificate with which it was signed; empty before version 2026-12.
  std::string signer{}, signer_sha256{};
  bool in_force() const { return state == "issued"; }
};

/// A person's word on a draft.
struct Approval {
  std::string by, role;                        ///< role: author, authoriser
  std::string at{};                            ///< UTC
  std::map<std::string, std::string> reasons;  ///< why a finding is accepted, by `finding_key`
  std::string account{};  ///< of the operating system; empty before version 2026-12
  std::string user{};     ///< of users.toml, whose password was given; empty: none was
};

/// What a run has made for a campaign and no person has released yet.
struct WaitingDraft {
  std::string campaign, folder;  ///< the folder relative to the site
  std::string out;               ///< the output folder of the run
  std::string file, sha256;      ///< the PDF in OUT/campaign
  std::string replaces;          ///< the number that it would replace; may be empty
  reading::Inputs made_from;     ///< its data, and plugins, templates, version
  std::vector<evaluation::KnownFinding> findings;
  std::optional<Approval> author{};  ///< who has approved it, where two persons are required
};

/// What a person approves, as he has read it.
struct Approved {
  const WaitingDraft& draft;
  const Approval& by;
};

/// "X: reversal.not-constant": how a finding is called where a reason for it is given.
std::string finding_key(const evaluation::KnownFinding& finding);

/// Whether nothing was changed in a register or taken out of it.
struct Audit {
  std::string id;             ///< identity of the register
  std::uint64_t entries = 0;  ///< of its journal
  std::uint64_t certificates = 0, files = 0;
  std::string last_at, last_sha256;  ///< of the last entry: worth keeping elsewhere
  std::vector<std::string> wrong;    ///< empty: all is as it was written
};

/// The site's register of numbers and of everything that was issued under them: an SQLite file, or a
/// schema of a server (register_place.h).
/// Entries are never deleted. Several processes may use it at once; each opens it itself, and none
/// carries it across a fork. What a call has changed is on disk when it returns.
class Register {
 public:
  /// Made if it is missing. Whoever finds it locked waits up to `patience` seconds.
  static Expected<Register> open(const std::filesystem::path& site,
                                 const config::Numbering& numbering, double patience = 60.0);
  /// The same, whatever was done to it.
  static Expected<Register> open_to_audit(const std::filesystem::path& site,
                                          const config::Numbering& numbering);
  /// Nothing is written, not even where an older version has made it.
  static Expected<Register> open_to_read(const std::filesystem::path& site,
                                         const config::Numbering& numbering);
  /// All numbers in the order in which they were drawn; none if there is no register yet.
  static Expected<std::vector<RegisterEntry>> entries(const std::filesystem::path& site,
                                                      const config::Numbering& numbering,
                                                      double patience = 60.0);
  static Expected<std::vector<WaitingDraft>> drafts(const std::filesystem::path& site,
                                                    const config::Numbering& numbering,
                                                    double patience = 60.0);
  Register(Register&&) noexcept;
  Register& operator=(Register&&) noexcept;
  ~Register();

  Expected<std::vector<RegisterEntry>> all();
  /// Who released and withdrew them, as the journal has it.
  Expected<void> note_persons(std::vector<RegisterEntry>& entries);
  /// No two registers have the same; a copy has that of the one it was copied from.
  std::string id();
  /// The number of every file that was issued, by its SHA-256.
  Expected<std::map<std::string, std::string>> issued_digests();
  /// The number that a campaign was issued last, in force or not.
  Expected<std::optional<RegisterEntry>> last_number(const std::string& campaign);
  /// What a campaign was issued last, if that is in force and was made from these data.
  Expected<std::optional<evaluation::Certificate>> find(const std::string& campaign,
                                                        const reading::Inputs& data);
  /// As `find`, or else a number: one that was drawn for the campaign and never issued, or the next
  /// one. `today` is YYYY-MM-DD; an error if something was issued on a later day.
  Expected<evaluation::Certificate> draw(const std::string& campaign, const reading::Inputs& data,
                                         const std::string& today);
  /// Issues what was drawn and signed. Returns the entry that is valid from now on: if another
  /// process was faster with the same data, the entry of that process; if both are approvals by
  /// persons, an error that names the first one. The campaign's draft is removed with it.
  Expected<evaluation::Certificate> issue(const evaluation::Certificate& certificate,
                                          const std::string& campaign, const reading::Inputs& data,
                                          const Approved* approved = nullptr);
  /// Why the number that was drawn for a campaign is not issued; nothing if there is none.
  Expected<void> note_failure(const std::string& campaign, const std::string& why);
  /// From now on it is not in force: the next run makes a draft for the campaign anew. `by` may
  /// be empty.
  Expected<void> withdraw(const std::string& number, const std::string& why,
                          const std::string& by = {});
  /// As they were issued; an error if the register's copy is not what was issued.
  Expected<std::vector<evaluation::IssuedFile>> files(const std::string& number);

  Expected<std::vector<WaitingDraft>> all_drafts();
  /// In place of an earlier one of the campaign. What its author stated stays if it is the same.
  Expected<void> enter_draft(const WaitingDraft& draft);
  Expected<std::optional<WaitingDraft>> draft(const std::string& campaign);
  /// The approval of the draft by its author, who has seen it; an error if the draft, or what an
  /// author states about it, has changed since.
  Expected<void> approve(const WaitingDraft& seen, const Approval& approval);
  /// For whoever approves what another person has approved already: enters the second approval into
  /// the journal, so that its reasons are kept, and states who was first.
  Expected<std::string> note_second(const std::string& number, const std::string& campaign,
                                    const Approval& second);
  /// Whose approval a number was issued with; none by the rules.
  Expected<std::optional<Approval>> approval_of(const std::string& number);

  Expected<Audit> audit();
  /// The part of it that costs little: an error if the journal is not a chain, or does not fit the
  /// numbers where these are looked at too. Nothing is issued from such a register.
  Expected<void> check_journal(bool numbers);

 private:
  Register(std::unique_ptr<storage::Database> database, const RegisterPlace& place,
           std::string pattern);
  /// Ends it, and writes the last journal entry to the identity file.
  Expected<void> end(storage::Database::Transaction& transaction);
  /// Compare and set: the draft that waits is the one that was read.
  Expected<void> check_seen(const WaitingDraft& seen, const Approval& by);
  void add_second(const std::string& number, const std::string& campaign, const Approval& by);
  Expected<std::string> first_of(const std::string& number);
  Expected<std::string> next_number(const std::string& year);
  Expected<std::optional<evaluation::Certificate>> last(const std::string& campaign,
                                                        const reading::Inputs& data);
  Expected<evaluation::Certificate> load(std::int64_t id);
  reading::Inputs inputs_of(std::int64_t id);
  /// An error if they are not what the journal states was issued.
  Expected<std::vector<evaluation::IssuedFile>> files_of(std::int64_t id);
  Expected<void> note_replaced(std::int64_t id, Issue& issue);

  std::unique_ptr<storage::Database> database_;
  std::unique_ptr<RegisterPlace> place_;
  std::string pattern_;
};

/// Where the register is: inside the site.
Expected<std::filesystem::path> register_path(const std::filesystem::path& site,
                                              const config::Numbering& numbering);

}  // namespace nonio::certificates
