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

struct RegisterEntry {
  std::string number, campaign;
  std::string state;  ///< drawn, issued, amended or withdrawn
  std::string date;   ///< date of issue; if only drawn, the date of drawing
  std::string replaces, replaced_by;
  std::string reason;       ///< why the number was withdrawn, or is not issued yet
  std::uint64_t order = 0;  ///< position in the order of issue, from 1; 0 if not issued
  /// Names as stated. `released_by` is empty if the rules of the site approved the certificate,
  /// `withdrawn_by` if no name was stated.
  std::string released_by{}, withdrawn_by{};
  /// Accounts of the operating system, "user@host"; empty before version 2026-12.
  std::string released_account{}, withdrawn_account{};
  /// Account of users.toml whose password was given; if empty, `released_by` is unverified.
  std::string released_user{};
  /// Subject and SHA-256 of the signer's certificate; empty without a signed PDF, and before
  /// version 2026-12.
  std::string signer{}, signer_sha256{};
  bool in_force() const { return state == "issued"; }
};

struct Approval {
  std::string by, role;  ///< name of the person; `role` is author or authoriser
  std::string at{};      ///< UTC
  std::map<std::string, std::string> reasons;  ///< reasons for accepting findings, by `finding_key`
  std::string account{};  ///< account of the operating system; empty before version 2026-12
  std::string user{};     ///< account of users.toml whose password was given, or empty
};

/// A draft that waits for approval; its author may have approved it already.
struct WaitingDraft {
  std::string campaign, folder;  ///< id of the campaign, and its folder relative to the site
  std::string out;               ///< output folder of the run
  std::string file, sha256;      ///< name and SHA-256 of the PDF in the output folder
  std::string replaces;          ///< number that the certificate would replace, or empty
  reading::Inputs made_from;     ///< digests of data, plugins, templates and version
  std::vector<evaluation::KnownFinding> findings;
  std::optional<Approval> author{};  ///< approval by the author, if two persons are required
};

/// A draft as a person has read it, and the approval of this person.
struct Approved {
  const WaitingDraft& draft;
  const Approval& by;
};

/// Returns the key of a reason for a finding, for example "X: reversal.not-constant".
std::string finding_key(const evaluation::KnownFinding& finding);

struct Audit {
  std::string id;
  std::uint64_t entries = 0;
  std::uint64_t certificates = 0, files = 0;
  std::string last_at, last_sha256;  ///< of the last journal entry, to be stored elsewhere too
  std::vector<std::string> wrong;
};

/// The site's register of certificate numbers and of all issued files: an SQLite file, or a schema
/// of a server (register_place.h). Entries are never deleted. Several processes may use it at once;
/// each opens it itself, because it must not be inherited by fork. Changes are durable when a call
/// returns.
class Register {
 public:
  /// Creates the register if it is missing. If it is locked, waits up to `patience` seconds.
  static Expected<Register> open(const std::filesystem::path& site,
                                 const config::Numbering& numbering, double patience = 60.0);
  /// Opens the register even if it was damaged or restored to an older state.
  static Expected<Register> open_to_audit(const std::filesystem::path& site,
                                          const config::Numbering& numbering);
  /// Changes no entry, even if the tables are those of an older version.
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
  ~Register();

  Expected<std::vector<RegisterEntry>> all();
  /// Adds from the journal who approved and withdrew the entries, and the signer of their files.
  Expected<void> note_persons(std::vector<RegisterEntry>& entries);
  /// Returns a unique id, which a copy of the register keeps; empty before version 2 of the format.
  std::string id();
  /// Returns the number of each issued file, by the file's SHA-256.
  Expected<std::map<std::string, std::string>> issued_digests();
  /// Returns the last number that was issued for a campaign, in force or not.
  Expected<std::optional<RegisterEntry>> last_number(const std::string& campaign);
  /// Returns the last certificate of a campaign, if it is in force and was made from these data.
  Expected<std::optional<evaluation::Certificate>> find(const std::string& campaign,
                                                        const reading::Inputs& data);
  /// Returns the certificate that `find` returns, or else a number: one that was drawn for the
  /// campaign and never issued, or the next one. `today`: YYYY-MM-DD; an error if something was
  /// issued later.
  Expected<evaluation::Certificate> draw(const std::string& campaign, const reading::Inputs& data,
                                         const std::string& today);
  /// Issues a certificate that was drawn and signed, and removes the campaign's draft. If another
  /// process was faster with the same data, returns the certificate of that process or, with
  /// `approved`, an error that names the first approval.
  Expected<evaluation::Certificate> issue(const evaluation::Certificate& certificate,
                                          const std::string& campaign, const reading::Inputs& data,
                                          const Approved* approved = nullptr);
  /// Records why the number that was drawn for a campaign is not issued.
  Expected<void> note_failure(const std::string& campaign, const std::string& why);
  /// The next run then makes a new draft for the campaign. `by` may be empty.
  Expected<void> withdraw(const std::string& number, const std::string& why,
                          const std::string& by = {});
  /// Returns the files as they were issued; an error if the register's copy was changed.
  Expected<std::vector<evaluation::IssuedFile>> files(const std::string& number);

  Expected<std::vector<WaitingDraft>> all_drafts();
  /// Replaces an earlier draft. The author's approval is kept if the draft is unchanged.
  Expected<void> enter_draft(const WaitingDraft& draft);
  Expected<std::optional<WaitingDraft>> draft(const std::string& campaign);
  /// Enters the author's approval; an error if the draft was changed or approved after it was read.
  Expected<void> approve(const WaitingDraft& seen, const Approval& approval);
  /// Keeps the reasons of a second approval. Returns a message about the first approval.
  Expected<std::string> note_second(const std::string& number, const std::string& campaign,
                                    const Approval& second);
  /// Returns the approval of an issued number; nullopt if the rules issued it, or if it is not
  /// issued.
  Expected<std::optional<Approval>> approval_of(const std::string& number);

  Expected<Audit> audit();
  /// Returns an error if the journal is not a chain or, with `numbers`, contradicts the numbers.
  /// Nothing is issued from such a register.
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

/// Returns an error if the configured path is not inside the site.
Expected<std::filesystem::path> register_path(const std::filesystem::path& site,
                                              const config::Numbering& numbering);

}  // namespace nonio::certificates
