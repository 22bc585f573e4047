// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "batch/state/run_result.h"
#include "campaign/config/machines.h"
#include "campaign/config/site_logs.h"

namespace nonio::batch {

/// Inventory of the files of a site except campaigns: site.toml, the logs (events.toml,
/// acknowledged.toml, forgotten.toml), machine records and templates. OUT/.nonio/site contains a
/// copy of each file from the last complete run, so that a missing, unreadable, empty or truncated
/// file is detected and can be restored.
class SiteParts {
 public:
  /// Compares the site with the inventory in `out` without writing. Without an inventory no file is
  /// lost. An error if the inventory or a folder of the site cannot be read.
  static Expected<SiteParts> compare(const std::filesystem::path& site,
                                     const std::filesystem::path& out);

  /// Returns the files that were lost unintentionally, by their path in the site. A folder replaces
  /// its files if all of them, at least two, are missing. A damaged or missing inventory is also
  /// returned, with an empty `folder`.
  const std::vector<Vanished>& lost() const { return lost_; }
  /// Names lost files without which no result can be trusted: site.toml and templates. Empty if
  /// they exist.
  std::string refusal() const;
  /// Marks lost records as invalid, so that the campaigns of their machines fail. The last copy of
  /// a record identifies its machine.
  void complete(config::MachineRecords& records) const;
  /// Stores copies of new and changed valid files, and writes the inventory, in which lost files
  /// remain with the date of the last run that found them valid.
  Expected<void> keep(const evaluation::RunLabel& run) const;

 private:
  struct Part {
    std::string sha256;  ///< of the copy
    /// Date of the last run that found the file valid, YYYY-MM-DD; empty for this run.
    std::string last_seen;
    std::string why;  ///< reason why the file is lost; empty for a valid file
  };

  Expected<void> read_inventory();
  Expected<void> read_copies();
  Expected<void> look_at_all();
  void look(const std::string& path);
  void leave_out_removed(const std::vector<config::Forgotten>& forgotten);
  void note_lost();
  std::string why_of(const std::string& path) const;
  Expected<void> put_inventory(const evaluation::RunLabel& run,
                               const std::map<std::string, Part>& parts) const;

  std::filesystem::path site_{}, out_{};
  std::string date_{}, damaged_{};
  std::uint64_t run_ = 0;
  std::map<std::string, Part> parts_{};  ///< by path in the site
  std::map<std::string, std::string> renewed_{};
  std::vector<std::string> removed_{};
  std::vector<Vanished> lost_{};
};

}  // namespace nonio::batch
