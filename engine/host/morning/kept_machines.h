// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "host/morning/changes.h"
#include "host/morning/standing.h"

namespace nonio::host::morning {

/// What a night has found out of a machine, so that the next one looks only at those whose results
/// are others. Each part names what it was made from.
struct KeptMachine {
  std::string rows{};  ///< digest of what the store and the site say of it
  struct Series {
    Lesson lesson;
    Manner manner;      ///< of the trend
    SeriesTests tests;  ///< of that trend
  };
  std::vector<Series> series{};
  std::vector<std::string> fits{};  ///< keys
  std::string stood{};              ///< digest of all that goes into `standing`, but the date
  std::string date{};               ///< of the night
  Standing standing{};
  struct Page {
    std::string made_from{};
    std::uint64_t size = 0;
    std::int64_t changed = 0;  ///< nanoseconds
  };
  Page page{};
};

/// All of a site, in OUT/.nonio/machines. They change no result: what is not there, is damaged or of
/// another version is found out again.
struct KeptMachines {
  std::map<std::string, KeptMachine> machines{};
  struct Night {
    std::string made_from{};  ///< digest of its evaluations
    std::uint64_t asked = 0;
  };
  std::map<std::uint64_t, Night> nights{};
  std::size_t bytes = 0;  ///< that they took when they were read

  static KeptMachines in(const std::filesystem::path& out);
  /// Not being able to is no error.
  void keep_in(const std::filesystem::path& out) const;
};

/// The same bytes, the same values.
std::string bytes_of(const std::vector<reports::MorningLine>& lines);
std::string bytes_of(const reports::IntervalProposal& proposal);

}  // namespace nonio::host::morning
