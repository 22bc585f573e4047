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

/// Inventory of the files of a site apart from its campaigns: site.toml, entries of people
/// (events.toml, acknowledged.toml, forgotten.toml), records of the machines, and the site's own
/// templates. The output folder contains a copy of each file as the last complete run read it
/// (OUT/.nonio/site), so that a missing, unreadable, emptied or cut file is detected and can be
/// restored.
class SiteParts {
 public:
  /// Compares the site with the inventory in `out`; without an inventory, no file is reported as
  /// lost. Nothing is written. An error if the inventory or the folder of templates cannot be read.
  static Expected<SiteParts> compare(const std::filesystem::path& site,
                                     const std::filesystem::path& out);

  /// Returns the files that are lost and were not removed on purpose; `id` and `folder` are the
  /// path below the site. If all files of a folder are missing, at least two of them, the folder is
  /// returned instead. A damaged or missing inventory is also returned, with an empty `folder`.
  const std::vector<Vanished>& lost() const { return lost_; }
  /// Names lost files without which no result, table or certificate can be trusted: site.toml and
  /// templates. Empty if none is lost.
  std::string refusal() const;
  /// Marks lost records as invalid in `records`, so that the campaigns of their machines fail. The
  /// machine of a lost record is identified by the last copy of the record.
  void complete(config::MachineRecords& records) const;
  /// Writes the files that this run found valid as the new inventory.
  Expected<void> keep(const evaluation::RunLabel& run) const;

 private:
  struct Part {
    std::string sha256;     ///< SHA-256 of the copy
    std::string last_seen;  ///< day of the last run that found the file valid, YYYY-MM-DD
    std::string why;        ///< what is wrong with the file now; empty: nothing
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
  std::string date_{}, damaged_{};  ///< date of the inventory, YYYY-MM-DD, and why the inventory
                                    ///< cannot be read (empty: it is valid)
  std::uint64_t run_ = 0;
  std::map<std::string, Part> parts_{};           ///< files of the inventory, by path below the
                                                  ///< site
  std::map<std::string, std::string> renewed_{};  ///< new bytes of files that differ from their
                                                  ///< copies
  std::vector<std::string> removed_{};            ///< files that were removed on purpose
  std::vector<Vanished> lost_{};
};

}  // namespace nonio::batch
