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

/// The parts of a finding by which the next run recognises it.
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

/// A run, by its number and the date it was given.
struct RunLabel {
  std::uint64_t number = 0;
  std::string date;  ///< YYYY-MM-DD; empty: of a version that did not note it
};

/// Since when what the history keeps of a campaign (laboratory/store/entry.h) is as it is.
struct IndexedSince {
  RunLabel run{};
  std::string version;  ///< that evaluated it so first
  std::string sha256;   ///< of what is kept
};

/// `run.json`, stored with the results of a campaign: from what they were made, when (in which run)
/// and why. It holds no time, so that equal runs leave equal bytes.
struct Record {
  std::string folder;  ///< of the campaign, relative to the site
  std::uint64_t run = 0;
  std::string date;  ///< of that run
  std::string reason;
  Status status = Status::none;
  bool retry = false;  ///< it failed for a reason that does not lie in its content
  std::optional<RunLabel> failed_since{};  ///< the first of the runs in which it failed
  reading::Inputs inputs;
  std::optional<IndexedSince> indexed{};  ///< none: it failed for a reason that may pass
  std::string certificate;                ///< its number; empty: none
  bool draft = false;                     ///< of a certificate that waits for its release
  std::vector<RecordedFile> files;
  std::optional<ShownHistory> history{};  ///< that a document shows; none: no document requests it
  std::vector<Error> errors;
  std::string language{};                        ///< of the site, for `nonio show`; empty: English
  std::vector<KnownFinding> findings, previous;  ///< previous: of the last run before this one
};

inline constexpr const char* record_name = "run.json";
inline constexpr const char* results_name = "results.json";
/// The old record while new results take the place of its files.
inline constexpr const char* record_before_name = ".run.json.before";
/// The folder, in that of a campaign which failed for a reason that may pass, with its last
/// results.
inline constexpr const char* last_good_name = "last-good";

std::string to_json(const Record& record);
/// An error if the file is not a record; no distinction why, since it is then simply made anew.
Expected<Record> read_record(const std::filesystem::path& campaign_output);

/// The record of the last results: `run.json`, or, where storing others was cut short, the one that
/// was put aside for it (then `whole` is false: its files need not be there any more).
struct LastRecord {
  Record record;
  bool whole = true;
};
/// None if there is none, or none that this version reads; an error if the disk does not give it.
Expected<std::optional<LastRecord>> last_record(const std::filesystem::path& campaign_output);
/// Of results that are written under temporary names.
Expected<std::optional<Record>> staged_record(const std::filesystem::path& campaign_output);

/// The findings of all analyses and outputs, each once, with their English titles.
std::vector<KnownFinding> known_findings(const Results& results, const Templates& templates,
                                         const std::string& language = "en");

}  // namespace nonio::evaluation
