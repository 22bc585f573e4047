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

/// The inventory of a site besides its campaigns: site.toml, what people have entered (events.toml,
/// acknowledged.toml, forgotten.toml), the records of the machines, the site's own templates. The
/// output folder contains a copy of each file as the last complete run has read it
/// (OUT/.nonio/site), so that a file that is missing, unreadable, emptied or cut is recognised, and
/// can be restored.
class SiteParts {
 public:
  /// Compares the site with the inventory in `out`; without an inventory nothing is lost. Nothing is
  /// written. An error if the inventory or the folder of templates cannot be read.
  static Expected<SiteParts> compare(const std::filesystem::path& site,
                                     const std::filesystem::path& out);

  /// What is lost and was not removed on purpose, by path: `id` and `folder` are the path below the
  /// site. If none of the files of a folder is left, the folder.
  const std::vector<Vanished>& lost() const { return lost_; }
  /// Without these no result, table or certificate can be trusted: site.toml and templates. Says
  /// which; empty: none of them is lost.
  std::string refusal() const;
  /// A record that is lost fails the campaigns of its machine, which its last copy names.
  void complete(config::MachineRecords& records) const;
  /// Becomes the inventory, with what was found good by this run.
  Expected<void> keep(const evaluation::RunLabel& run) const;

 private:
  struct Part {
    std::string sha256;     ///< of the copy
    std::string last_seen;  ///< YYYY-MM-DD; of what is wrong: of the last run that found it good
    std::string why;        ///< what is wrong with it now; empty: nothing
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
  std::string date_{}, damaged_{};  ///< of the inventory; why it cannot be read
  std::uint64_t run_ = 0;
  std::map<std::string, Part> parts_{};           ///< by path below the site
  std::map<std::string, std::string> renewed_{};  ///< bytes of those that differ from their copies
  std::vector<std::string> removed_{};            ///< on purpose
  std::vector<Vanished> lost_{};
};

}  // namespace nonio::batch
