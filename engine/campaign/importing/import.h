// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "campaign/config/manifest.h"
#include "campaign/loader/plugins.h"

namespace nonio::importing {

/// The rule by which the names of files state what was measured.
struct ImportRule {
  std::string pattern;   ///< form of the names: "{machine}_{axis}_{date}.rtl"
  std::string campaign;  ///< pattern of the id; empty: date and placeholders except axis and id
  std::string kind = "axis";         ///< kind of every measurement
  std::string reader;                ///< reader of every file; empty: chosen by the content
  std::vector<std::string> exclude;  ///< a file is skipped if its path contains one of these
  std::string axis;                  ///< axis of every file; empty: the text at {axis} in the name
  /// Texts accepted at {axis}, and the axis of the machine that each of them names; empty: names of
  /// axes are accepted.
  std::map<std::string, std::string, std::less<>> axes;
  std::string manifest;  ///< TOML text that every campaign.toml also contains
};

using Places = std::map<std::string, std::string, std::less<>>;

/// Read a rule: a pattern alone, or a TOML file with `pattern`, `campaign`, `kind`, `reader`,
/// `exclude`, `axis` and the tables [axes] and [manifest].
config::Checked<ImportRule> import_rule_of_pattern(const std::string& pattern);
config::Checked<ImportRule> parse_import_rule(std::string_view text, const std::string& file);

/// Returns the ways in which the pattern matches a path, at most two. A pattern without "/" applies
/// to the name of the file only.
std::vector<Places> readings_of_name(const ImportRule& rule, const std::string& path);

struct ImportedFile {
  std::string file;  ///< path of the file below the imported folder
  std::string name;  ///< name of the file in the campaign
  std::string measurement, axis, reader;
  std::uint64_t readings = 0, missing = 0;
  std::vector<std::string> lacks;  ///< what must be stated or corrected first
  std::string same_as;             ///< another file with the same readings; empty: none
  std::vector<std::string>
      assumed;  ///< what was derived from the name or the rule, not stated literally
};

struct ImportedCampaign {
  std::string id;
  std::vector<ImportedFile> files;
  std::vector<std::string> lacks;  ///< what must be stated about the campaign as a whole
  bool written = false;
  std::string asset{}, maker{}, serial{};  ///< asset, maker and serial number of its machine
  /// The campaign was imported before: its folder contains these files, and its manifest a
  /// measurement for each of them.
  bool there = false;

  bool whole() const;
};

struct ImportReport {
  struct Passed {
    std::string file, why;
  };
  std::vector<ImportedCampaign> campaigns;
  std::vector<Passed> duplicates, unmatched, excluded;
};

struct ImportRequest {
  std::filesystem::path folder, out;
  ImportRule rule;
  /// Asset, maker and serial number of the machine of all campaigns; empty: not stated.
  std::string asset{}, maker{}, serial{};
  /// Whether campaigns with missing data are also written; comments in them state what is missing.
  bool partial = false;
  bool dry_run = false;
};

/// Makes campaigns from a folder of files. Each campaign's folder is new and appears completely;
/// existing files are not changed, and a campaign that was imported completely is skipped.
Expected<ImportReport> import_folder(const ImportRequest& request, const loader::Plugins& plugins);

}  // namespace nonio::importing
