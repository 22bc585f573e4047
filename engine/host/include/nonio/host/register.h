// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "nonio/host/evaluate.h"

namespace nonio::host {

class Database;

/// One number of a register.
struct RegisterEntry {
  std::string number, campaign;
  std::string state;  ///< drawn, issued, amended, withdrawn
  std::string date;   ///< of issue; of a number that is only drawn: the day on which it was drawn
  std::string replaces, replaced_by;
  std::string reason;       ///< why it was withdrawn; why it is not issued yet
  std::uint64_t order = 0;  ///< in which numbers were issued, from 1; 0: not issued
  bool in_force() const { return state == "issued"; }
};

/// The site's register of numbers and of everything that was issued under them, an SQLite file.
/// Entries are never deleted. Several processes may use it at once; each opens it itself, and none
/// carries it across a fork. What a call has changed is on disk when it returns.
class Register {
 public:
  static Expected<Register> open(const std::filesystem::path& site, const Numbering& numbering);
  /// All numbers in the order in which they were drawn; none if there is no register yet.
  static Expected<std::vector<RegisterEntry>> entries(const std::filesystem::path& site,
                                                      const Numbering& numbering);
  Register(Register&&) noexcept;
  Register& operator=(Register&&) noexcept;
  ~Register();

  /// What a campaign was issued last, if that is in force and was made from these data.
  Expected<std::optional<Certificate>> find(const std::string& campaign, const Inputs& data);
  /// As `find`, or else a number: one that was drawn for the campaign and never issued, or the next
  /// one. `today` is YYYY-MM-DD.
  Expected<Certificate> draw(const std::string& campaign, const Inputs& data,
                             const std::string& today);
  /// Issues what was drawn and signed. Gives what holds from now on: if somebody else was faster
  /// with the same data, what he has issued.
  Expected<Certificate> issue(const Certificate& certificate, const std::string& campaign,
                              const Inputs& data);
  /// Why the number that was drawn for a campaign is not issued; nothing if there is none.
  Expected<void> note_failure(const std::string& campaign, const std::string& why);
  /// From now on it is not in force: the next night issues the campaign's certificate anew.
  Expected<void> withdraw(const std::string& number, const std::string& why);
  Expected<std::vector<IssuedFile>> files(const std::string& number);

 private:
  Register(std::unique_ptr<Database> database, std::string pattern);
  Expected<std::string> next_number(const std::string& year);
  std::optional<Certificate> last(const std::string& campaign, const Inputs& data);
  Certificate load(std::int64_t id);
  Inputs inputs_of(std::int64_t id);
  std::vector<IssuedFile> files_of(std::int64_t id);
  void note_replaced(std::int64_t id, Issue& issue);

  std::unique_ptr<Database> database_;
  std::string pattern_;
};

/// Where the register is: inside the site.
Expected<std::filesystem::path> register_path(const std::filesystem::path& site,
                                              const Numbering& numbering);

/// `[certificate] numbering` with its places filled. An error if that cannot be a number: it names
/// files, and stands on paper.
Expected<std::string> number_text(const std::string& pattern, const std::string& year,
                                  std::uint64_t number);

}  // namespace nonio::host
