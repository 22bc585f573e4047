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

struct KnownFinding {
  std::string measurement, id, title;
  bool attention = false;
  std::string said{};  ///< title in the language of the site; empty for English
  const std::string& heading() const { return said.empty() ? title : said; }
  bool same(const KnownFinding& other) const {
    return measurement == other.measurement && id == other.id;
  }
};

struct RecordedFile {
  std::string name;
  std::uint64_t size = 0;
  std::string sha256;
};

struct RunLabel {
  std::uint64_t number = 0;
  std::string date;  ///< YYYY-MM-DD; empty in records of older versions
};

/// Run since which the history's data of a campaign have not changed.
struct IndexedSince {
  RunLabel run{};
  std::string version;  ///< version of the program that first wrote these data
  std::string sha256;
};

/// `run.json` of a campaign, without a time of day, so that equal runs write equal bytes.
struct Record {
  std::string folder;  ///< folder of the campaign, relative to the site
  std::uint64_t run = 0;
  std::string date;
  std::string reason;
  Status status = Status::none;
  bool retry = false;  ///< the failure has a cause outside of the campaign's files
  /// First of the successive failed runs; nullopt if the campaign did not fail.
  std::optional<RunLabel> failed_since{};
  reading::Inputs inputs;
  /// nullopt after a temporary failure
  std::optional<IndexedSince> indexed{};
  std::string certificate;  ///< empty without a certificate
  bool draft = false;       ///< the certificate is a draft that waits for approval
  std::vector<RecordedFile> files;
  /// nullopt if no document shows a history
  std::optional<ShownHistory> history{};
  std::vector<Error> errors;
  std::string language{};  ///< language of the site; empty for English
  /// Notes of results.json in `language`, in the order of that file; empty for English.
  std::vector<std::string> notes{};
  /// `previous`: findings of the previous run.
  std::vector<KnownFinding> findings, previous;
};

inline constexpr const char* record_name = "run.json";
inline constexpr const char* results_name = "results.json";
/// Old record while new results replace its files.
inline constexpr const char* record_before_name = ".run.json.before";
/// Folder with the last results of a campaign that failed for a temporary reason.
inline constexpr const char* last_good_name = "last-good";

std::string to_json(const Record& record);
/// The error does not state the reason, because the campaign is then evaluated again.
Expected<Record> read_record(const std::filesystem::path& campaign_output);

/// `run.json`, or the old record after an interruption (`whole` is false: files may be missing).
struct LastRecord {
  Record record;
  bool whole = true;
};
/// Returns nullopt without a readable record. An error if the disk cannot be read.
Expected<std::optional<LastRecord>> last_record(const std::filesystem::path& campaign_output);
Expected<std::optional<Record>> staged_record(const std::filesystem::path& campaign_output);

/// Returns each finding once, and a finding for each value that does not conform or is
/// indeterminate. Titles are in English and in `language`.
std::vector<KnownFinding> known_findings(const Results& results, const Templates& templates,
                                         const std::string& language = "en");

/// Returns all notes in the order of results.json.
std::vector<std::string> notes_in(const std::string& language, const Results& results,
                                  const Templates& templates);

/// Results of a campaign, in a folder or in a pack (platform/storage/packed_results.h).
/// Returns the files of `last-good`, then those that the record names, then the record. An error if
/// a name leads out of the folder or a pack has a file that the record does not name.
Expected<std::vector<RecordedFile>> results_files(const std::filesystem::path& folder);
/// Returns an error if size or digest differ from those of the record.
Expected<std::string> read_result(const std::filesystem::path& folder, const RecordedFile& file);

/// Copies results from a pack to the campaign's own folder, which then replaces the pack. A damaged
/// file is left out; a damaged file without another copy of its data is an error.
Expected<void> take_in(const std::filesystem::path& out, const std::string& id);
/// `to` must not contain results of the campaign. Results that are being stored are included.
Expected<void> copy_results(const std::filesystem::path& folder, const std::filesystem::path& to);

}  // namespace nonio::evaluation
