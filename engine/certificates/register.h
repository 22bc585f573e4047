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

/// A certificate number in a register.
struct RegisterEntry {
  std::string number, campaign;
  std::string state;  ///< state of the number: drawn, issued, amended, withdrawn
  std::string date;   ///< date of issue; for a number that is only drawn, the day on which it was
                      ///< drawn
  std::string replaces, replaced_by;
  std::string reason;       ///< why the number was withdrawn, or why it is not issued yet
  std::uint64_t order = 0;  ///< position in the order in which numbers were issued, counted from 1;
                            ///< 0: not issued
  /// Names of the persons who approved and withdrew the certificate, as stated. If `released_by` of
  /// an issued certificate is empty, the rules of the site approved it; if `withdrawn_by` of a
  /// withdrawn one is empty, no name was stated.
  std::string released_by{}, withdrawn_by{};
  /// Accounts in the operating system of the persons who approved and withdrew the certificate,
  /// "user@host"; empty before version 2026-12.
  std::string released_account{}, withdrawn_account{};
  /// Account of users.toml whose password was given for the approval; empty: the name of the person
  /// is unverified.
  std::string released_user{};
  /// Subject and SHA-256 of the signer's certificate; empty before version 2026-12.
  std::string signer{}, signer_sha256{};
  bool in_force() const { return state == "issued"; }
};

/// The approval of a draft by a person.
struct Approval {
  std::string by, role;                        ///< name of the person, and role: author or
                                               ///< authoriser
  std::string at{};                            ///< time of the approval, UTC
  std::map<std::string, std::string> reasons;  ///< reasons why findings are accepted, by
                                               ///< `finding_key`
  std::string account{};  ///< account of the operating system; empty before version 2026-12
  std::string user{};     ///< account of users.toml whose password was given; empty: none
};

/// A draft that a run has made and that waits for approval; its author may have approved it
/// already.
struct WaitingDraft {
  std::string campaign, folder;  ///< id of the campaign, and its folder relative to the site
  std::string out;               ///< output folder of the run
  std::string file, sha256;      ///< name of the PDF in the campaign's folder of the output folder,
                                 ///< and its SHA-256
  std::string replaces;          ///< number that the certificate would replace; empty: none
  reading::Inputs made_from;     ///< digests of the data, plugins, templates and version that the
                                 ///< draft was made from
  std::vector<evaluation::KnownFinding> findings;
  std::optional<Approval> author{};  ///< approval by the author, if two persons are required
};

/// A draft as the person has read it, and that person's approval.
struct Approved {
  const WaitingDraft& draft;
  const Approval& by;
};

/// Returns the key under which a reason for a finding is given, for example "X:
/// reversal.not-constant".
std::string finding_key(const evaluation::KnownFinding& finding);

/// Result of checking a register for changes and removals.
struct Audit {
  std::string id;             ///< id of the register
  std::uint64_t entries = 0;  ///< number of entries in the journal
  std::uint64_t certificates = 0, files = 0;
  std::string last_at, last_sha256;  ///< time and digest of the last entry, to be kept in another
                                     ///< place too
  std::vector<std::string> wrong;    ///< errors that the check found; empty: none
};

/// The site's register of certificate numbers and of all files issued under them: an SQLite file,
/// or a schema of a server (register_place.h). Entries are never deleted. Several processes may use
/// it at once; each opens it itself, and it must not be inherited by fork. Changes of a call are on
/// the disk when the call returns.
class Register {
 public:
  /// Opens the register and creates it if it is missing. If it is locked, waits up to `patience`
  /// seconds.
  static Expected<Register> open(const std::filesystem::path& site,
                                 const config::Numbering& numbering, double patience = 60.0);
  /// Opens the register even if it was damaged or restored to an older state.
  static Expected<Register> open_to_audit(const std::filesystem::path& site,
                                          const config::Numbering& numbering);
  /// Opens an existing register and changes no entry in it, even if its tables are those of an
  /// older version.
  static Expected<Register> open_to_read(const std::filesystem::path& site,
                                         const config::Numbering& numbering);
  /// Returns all numbers in the order in which they were drawn; empty if there is no register yet.
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
  /// Adds to the entries, from the journal, who approved and withdrew them, and the signer of their
  /// files.
  Expected<void> note_persons(std::vector<RegisterEntry>& entries);
  /// Returns the id of the register, which is unique; a copy has the id of its original. Empty for
  /// a register of an older version.
  std::string id();
  /// Returns the number of each issued file, by the file's SHA-256.
  Expected<std::map<std::string, std::string>> issued_digests();
  /// Returns the last number that was issued for a campaign, in force or not; none if none was
  /// issued.
  Expected<std::optional<RegisterEntry>> last_number(const std::string& campaign);
  /// Returns the last certificate of a campaign, if it is in force and was made from these data.
  Expected<std::optional<evaluation::Certificate>> find(const std::string& campaign,
                                                        const reading::Inputs& data);
  /// Returns the same as `find`, or a number: one that was drawn for the campaign and never issued,
  /// otherwise the next one. `today`: YYYY-MM-DD; an error if something was issued on a later day.
  Expected<evaluation::Certificate> draw(const std::string& campaign, const reading::Inputs& data,
                                         const std::string& today);
  /// Issues a certificate that was drawn and signed, and removes the campaign's draft. Returns the
  /// entry that is valid from now on: if another process was faster with the same data, the entry
  /// of that process. With `approved`, an error that names the first approval in that case.
  Expected<evaluation::Certificate> issue(const evaluation::Certificate& certificate,
                                          const std::string& campaign, const reading::Inputs& data,
                                          const Approved* approved = nullptr);
  /// Records why the number that was drawn for a campaign is not issued; does nothing if there is
  /// none.
  Expected<void> note_failure(const std::string& campaign, const std::string& why);
  /// Withdraws a number, so that the next run makes a new draft for the campaign. `by` may be
  /// empty.
  Expected<void> withdraw(const std::string& number, const std::string& why,
                          const std::string& by = {});
  /// Returns the files as they were issued; an error if the register's copy was changed.
  Expected<std::vector<evaluation::IssuedFile>> files(const std::string& number);

  Expected<std::vector<WaitingDraft>> all_drafts();
  /// Enters a draft and replaces an earlier one of the campaign. The author's approval is kept if
  /// the draft is unchanged.
  Expected<void> enter_draft(const WaitingDraft& draft);
  Expected<std::optional<WaitingDraft>> draft(const std::string& campaign);
  /// Enters the approval of a draft by its author; an error if the draft, or the data that an
  /// author approves, has changed since the author read it.
  Expected<void> approve(const WaitingDraft& seen, const Approval& approval);
  /// Enters a second approval of an approved certificate into the journal, so that its reasons are
  /// kept. Returns a message that names the first person.
  Expected<std::string> note_second(const std::string& number, const std::string& campaign,
                                    const Approval& second);
  /// Returns the approval of an issued number; none if it was issued by the rules, or not issued.
  Expected<std::optional<Approval>> approval_of(const std::string& number);

  Expected<Audit> audit();
  /// Does the fast part of the audit: an error if the journal is not a chain, or, with `numbers`,
  /// contradicts the numbers. Nothing is issued from such a register.
  Expected<void> check_journal(bool numbers);

 private:
  Register(std::unique_ptr<storage::Database> database, const RegisterPlace& place,
           std::string pattern);
  /// Ends the transaction, and writes the last journal entry to the identity file.
  Expected<void> end(storage::Database::Transaction& transaction);
  /// Returns an error if the waiting draft is not the one that was read.
  Expected<void> check_seen(const WaitingDraft& seen, const Approval& by);
  void add_second(const std::string& number, const std::string& campaign, const Approval& by);
  Expected<std::string> first_of(const std::string& number);
  Expected<std::string> next_number(const std::string& year);
  Expected<std::optional<evaluation::Certificate>> last(const std::string& campaign,
                                                        const reading::Inputs& data);
  Expected<evaluation::Certificate> load(std::int64_t id);
  reading::Inputs inputs_of(std::int64_t id);
  /// Returns the files; an error if they differ from what the journal states.
  Expected<std::vector<evaluation::IssuedFile>> files_of(std::int64_t id);
  Expected<void> note_replaced(std::int64_t id, Issue& issue);

  std::unique_ptr<storage::Database> database_;
  std::unique_ptr<RegisterPlace> place_;
  std::string pattern_;
};

/// Returns the path of the register file inside the site.
Expected<std::filesystem::path> register_path(const std::filesystem::path& site,
                                              const config::Numbering& numbering);

}  // namespace nonio::certificates
