// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "campaign/evaluation/evaluate.h"
#include "campaign/evaluation/status.h"
#include "nonio/sdk/error.h"

namespace nonio::evaluation {

/// The parts of a finding by which the next run recognizes it.
struct KnownFinding {
  std::string measurement, id, title;
  bool attention = false;
  std::string said{};  ///< the title in the language of the site; empty: English
  const std::string& heading() const { return said.empty() ? title : said; }
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

/// Number and date of a run.
struct RunLabel {
  std::uint64_t number = 0;
  std::string date;  ///< date of the run, YYYY-MM-DD; empty if an older version wrote it
};

/// The run since which the history's data of a campaign have not changed
/// (laboratory/store/entry.h).
struct IndexedSince {
  RunLabel run{};
  std::string version;  ///< program version that first wrote these data
  std::string sha256;   ///< SHA-256 of the data that the history contains
};

/// `run.json`, stored with the results of a campaign: their inputs, their run and the reason for
/// the evaluation. It contains no time of day, so that equal runs write equal bytes.
struct Record {
  std::string folder;  ///< folder of the campaign, relative to the site
  std::uint64_t run = 0;
  std::string date;  ///< date of the run with number `run`, YYYY-MM-DD
  std::string reason;
  Status status = Status::none;
  bool retry = false;  ///< the campaign failed for a reason that is not part of its content
  /// First of the successive runs in which the campaign failed; none: the campaign did not fail.
  std::optional<RunLabel> failed_since{};
  reading::Inputs inputs;
  /// Run since which the campaign's data in the history are unchanged; none: the campaign failed
  /// temporarily.
  std::optional<IndexedSince> indexed{};
  std::string certificate;  ///< number of the certificate; empty: none
  bool draft = false;       ///< the certificate is a draft that waits for approval
  std::vector<RecordedFile> files;
  /// History that a document shows; none: no document shows one.
  std::optional<ShownHistory> history{};
  std::vector<Error> errors;
  std::string language{};  ///< language of the site, for `nonio show`; empty: English
  /// Findings of this run, and those of the run before it.
  std::vector<KnownFinding> findings, previous;
};

inline constexpr const char* record_name = "run.json";
inline constexpr const char* results_name = "results.json";
/// Name of the old record while new results replace its files.
inline constexpr const char* record_before_name = ".run.json.before";
/// Name of the folder with the last results of a campaign that failed for a temporary reason; it is
/// inside the campaign's folder of results.
inline constexpr const char* last_good_name = "last-good";

std::string to_json(const Record& record);
/// Reads the record in a folder of results. The error does not state why a file is not a record,
/// because the campaign is then evaluated again.
Expected<Record> read_record(const std::filesystem::path& campaign_output);

/// The record of the last results: `run.json`, or, if storing new results was interrupted, the old
/// record that was kept (then `whole` is false, and its files may be missing).
struct LastRecord {
  Record record;
  bool whole = true;
};
/// Reads the last record; none if there is no record that this version can read. An error if the
/// disk cannot be read.
Expected<std::optional<LastRecord>> last_record(const std::filesystem::path& campaign_output);
/// Reads the record of results that still have temporary names.
Expected<std::optional<Record>> staged_record(const std::filesystem::path& campaign_output);

/// Returns the findings of all analyses and outputs, and a finding for each value that does not
/// conform or is indeterminate. Each occurs once, with its title in English and, if `language` is
/// not "en", also in that language.
std::vector<KnownFinding> known_findings(const Results& results, const Templates& templates,
                                         const std::string& language = "en");

}  // namespace nonio::evaluation
