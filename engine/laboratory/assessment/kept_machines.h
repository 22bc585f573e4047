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

/// Assessment of one machine, which the next run uses again if the digests are unchanged.
struct KeptMachine {
  std::string rows{};  ///< digest of the data of the machine in store and site
  struct Series {
    Lesson lesson;
    Manner manner;
    SeriesTests tests;
  };
  std::vector<Series> series{};
  std::string digest{};  ///< digest of the inputs of `standing` except the date
  std::string date{};    ///< date of the run of `standing`
  Standing standing{};
  struct Page {
    std::string made_from{};
    std::uint64_t size = 0;
    std::int64_t changed = 0;  ///< modification time of the file, ns
  };
  Page page{};
};

/// Cache of assessments and trends in OUT/.nonio/machines.sqlite. It changes no result: entries
/// that are missing, damaged or of another version are computed again, and errors of the file are
/// ignored.
class KeptMachines {
 public:
  struct RunResult {
    std::string made_from{};  ///< digest of the evaluations of the run
    std::uint64_t asked = 0;
  };

  explicit KeptMachines(std::filesystem::path out);

  std::map<std::string, KeptMachine> machines();
  std::map<std::uint64_t, RunResult> runs();
  std::string trends_of(const std::string& machine);

  /// Entries that are written in one transaction.
  struct Changes {
    struct Of {
      std::string machine;
      const KeptMachine* kept = nullptr;    ///< null if unchanged or not to be stored
      std::optional<std::string> trends{};  ///< bytes of `Fits::kept`; std::nullopt if unchanged
    };
    std::vector<Of> machines;
    std::set<std::string> gone;
    /// All runs if any has changed.
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
  bool has_machines_ = false;
};

/// Equal values give equal bytes.
std::string bytes_of(const std::vector<reports::WorkItem>& lines);
std::string bytes_of(const reports::IntervalProposal& proposal);

}  // namespace nonio::assessment
