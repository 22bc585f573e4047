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
  std::string pattern;               ///< "{machine}_{axis}_{date}.rtl"
  std::string campaign;              ///< id of the campaign, with places; empty: see campaign_of
  std::string kind = "axis";         ///< of every measurement
  std::string reader;                ///< empty: by content
  std::vector<std::string> exclude;  ///< a file is skipped if its path contains one of these
  std::string axis;                  ///< of every file; empty: the text at {axis}
  /// Texts accepted at {axis}, and the axis of the machine that each stands for; empty: names of
  /// axes.
  std::map<std::string, std::string, std::less<>> axes;
  std::string manifest;  ///< TOML: further content of every campaign.toml
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
  std::string file;  ///< below the folder
  std::string name;  ///< in the campaign
  std::string measurement, axis, reader;
  std::uint64_t readings = 0, missing = 0;
  std::vector<std::string> lacks;  ///< what must be stated or corrected first
  std::string same_as;             ///< a file with the same readings
  std::vector<std::string>
      assumed;  ///< what was derived from the name or the rule, not stated literally
};

struct ImportedCampaign {
  std::string id;
  std::vector<ImportedFile> files;
  std::vector<std::string> lacks;  ///< of the campaign as a whole
  bool written = false;
  std::string asset{}, maker{}, serial{};  ///< of its machine
  /// Imported before: its folder contains these files, and its manifest a measurement for each.
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
  std::string asset{}, maker{}, serial{};  ///< of the machine of all campaigns; empty: not stated
  bool partial = false;  ///< write campaigns that lack something too, with what is to be filled
  bool dry_run = false;
};

/// Makes campaigns from a folder of files. Each campaign's folder is new and appears completely;
/// existing files are not changed, and a campaign that was imported completely is skipped.
Expected<ImportReport> import_folder(const ImportRequest& request, const loader::Plugins& plugins);

}  // namespace nonio::importing
