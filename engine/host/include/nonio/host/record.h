// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "nonio/host/evaluate.h"
#include "nonio/sdk/error.h"

namespace nonio::host {

/// A finding as the morning's reader knows it again the next day.
struct KnownFinding {
  std::string measurement, id, title;
  bool attention = false;
  bool same(const KnownFinding& other) const {
    return measurement == other.measurement && id == other.id;
  }
};

/// A file of a campaign's results as it was written.
struct RecordedFile {
  std::string name;
  std::uint64_t size = 0;
  std::string sha256;
};

/// `run.json` beside a campaign's results: from what they were made, when (which night) and why.
/// It holds no time, so that equal runs leave equal bytes.
struct Record {
  std::string folder;  ///< of the campaign, relative to the site
  std::uint64_t night = 0;
  std::string reason;
  std::string status;
  bool retry = false;  ///< it failed for a reason that does not lie in its content
  Inputs inputs;
  std::string certificate;  ///< its number; empty: none
  bool draft = false;       ///< of a certificate that waits for its release
  std::vector<RecordedFile> files;
  std::vector<Error> errors;
  std::vector<KnownFinding> findings, previous;  ///< previous: of the last night before this one
};

inline constexpr const char* record_name = "run.json";
inline constexpr const char* results_name = "results.json";

std::string to_json(const Record& record);
/// An error if the file is not a record; no distinction why, since it is then simply made anew.
Expected<Record> read_record(const std::filesystem::path& campaign_output);

}  // namespace nonio::host
