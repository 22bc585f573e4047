// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "laboratory/assessment/changes.h"
#include "laboratory/assessment/standing.h"
#include "platform/storage/database.h"

namespace nonio::assessment {

/// What a run has computed for a machine, so that the next one assesses only machines with other
/// results. Each part names what it was made from.
struct KeptMachine {
  std::string rows{};  ///< digest of what the store and the site state about it
  struct Series {
    Lesson lesson;
    Manner manner;      ///< of the trend
    SeriesTests tests;  ///< of that trend
  };
  std::vector<Series> series{};
  std::string digest{};  ///< of all that goes into `standing`, but the date
  std::string date{};    ///< of the run
  Standing standing{};
  struct Page {
    std::string made_from{};
    std::uint64_t size = 0;
    std::int64_t changed = 0;  ///< nanoseconds
  };
  Page page{};
};

/// All of a site, in OUT/.nonio/machines.sqlite: of each machine what was found out, and its
/// trends. They change no result: what is missing, is damaged or of another version is found out
/// again. Trouble with the file is no error.
class KeptMachines {
 public:
  struct RunResult {
    std::string made_from{};  ///< digest of its evaluations
    std::uint64_t asked = 0;
  };

  explicit KeptMachines(std::filesystem::path out);

  std::map<std::string, KeptMachine> machines();
  std::map<std::uint64_t, RunResult> runs();
  /// What `Fits::kept` returned for the machine.
  std::string trends_of(const std::string& machine);

  /// What a run adds. All of it comes into the file, or nothing.
  struct Changes {
    struct Of {
      std::string machine;
      const KeptMachine* kept = nullptr;    ///< null: as it was, or nothing
      std::optional<std::string> trends{};  ///< none: as they were
    };
    std::vector<Of> machines;
    std::set<std::string> gone;  ///< machines
    /// All of them, where any is another.
    std::optional<std::map<std::uint64_t, RunResult>> runs{};
  };
  void keep(const Changes& changes);

 private:
  void open();
  bool is_readable();
  void make_anew();
  Expected<void> put(const Changes& changes);

  std::filesystem::path out_;
  std::optional<storage::Database> file_;
  bool has_machines_ = false;  ///< of this version
};

/// The same bytes, the same values.
std::string bytes_of(const std::vector<reports::WorkItem>& lines);
std::string bytes_of(const reports::IntervalProposal& proposal);

}  // namespace nonio::assessment
