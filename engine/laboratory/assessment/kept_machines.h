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

/// Results of a run for one machine, so that the next run assesses only machines with new data. The
/// digests determine which results are still valid.
struct KeptMachine {
  std::string rows{};  ///< digest of the machine's data in the store and the site
  struct Series {
    Lesson lesson;
    Manner manner;      ///< parameters with which the trend was fitted
    SeriesTests tests;  ///< tests of the changes of this trend
  };
  std::vector<Series> series{};
  std::string digest{};  ///< digest of everything that `standing` depends on, except the date
  std::string date{};    ///< date of the run that made `standing`
  Standing standing{};
  struct Page {
    std::string made_from{};
    std::uint64_t size = 0;
    std::int64_t changed = 0;  ///< time of the last change of the page's file, ns
  };
  Page page{};
};

/// Cache in OUT/.nonio/machines.sqlite: results and trends of each machine of a site. It changes no
/// result: entries that are missing, damaged or of another version are computed again. Errors of
/// the file are ignored.
class KeptMachines {
 public:
  struct RunResult {
    std::string made_from{};  ///< digest of the run's evaluations
    std::uint64_t asked = 0;
  };

  explicit KeptMachines(std::filesystem::path out);

  std::map<std::string, KeptMachine> machines();
  std::map<std::uint64_t, RunResult> runs();
  /// Returns the bytes of `Fits::kept` that were stored for the machine.
  std::string trends_of(const std::string& machine);

  /// Entries to be written. All of them are written in one transaction, or none.
  struct Changes {
    struct Of {
      std::string machine;
      const KeptMachine* kept = nullptr;    ///< data to be stored; null: they are unchanged or must
                                            ///< not be stored
      std::optional<std::string> trends{};  ///< trends to be stored, as returned by `Fits::kept`;
                                            ///< none: they are unchanged
    };
    std::vector<Of> machines;
    std::set<std::string> gone;  ///< machines that no longer exist
    /// All runs, if any of them changed; otherwise none.
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
  bool has_machines_ = false;  ///< whether the file contains machines of this version
};

/// Returns the value as bytes; equal values give equal bytes.
std::string bytes_of(const std::vector<reports::WorkItem>& lines);
std::string bytes_of(const reports::IntervalProposal& proposal);

}  // namespace nonio::assessment
