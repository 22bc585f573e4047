// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "campaign/config/manifest.h"
#include "campaign/config/terminal_words.h"
#include "campaign/loader/plugins.h"

namespace nonio::importing {

struct ImportRule {
  std::string pattern;   ///< file names, for example "{machine}_{axis}_{date}.rtl"
  std::string campaign;  ///< pattern of the id; if empty, date and placeholders except axis and id
  std::string kind = "axis";
  std::string reader;  ///< reader of every file; if empty, the content determines the reader
  /// Files are skipped if their paths contain one of these texts.
  std::vector<std::string> exclude;
  std::string axis;  ///< axis of every file; if empty, the text at {axis}
  /// Axis of the machine for each text at {axis}; if empty, the texts are names of axes.
  std::map<std::string, std::string, std::less<>> axes;
  std::string manifest;  ///< TOML text that every campaign.toml also contains
};

using Places = std::map<std::string, std::string, std::less<>>;

/// Returns a rule with default values for everything except the pattern.
config::Checked<ImportRule> import_rule_of_pattern(const std::string& pattern);
/// Parses a TOML file with `pattern`, `campaign`, `kind`, `reader`, `exclude`, `axis` and the
/// tables [axes] and [manifest].
config::Checked<ImportRule> parse_import_rule(std::string_view text, const std::string& file);

/// Returns at most two matches of the pattern. Without "/", only the file name is matched.
std::vector<Places> readings_of_name(const ImportRule& rule, const std::string& path);

struct ImportedFile {
  std::string file;
  std::string name;  ///< name in the campaign
  std::string measurement, axis, reader;
  std::uint64_t readings = 0, missing = 0;
  std::vector<std::string> lacks;  ///< what must be stated or corrected first
  std::string same_as;             ///< other file with the same readings; empty without such a file
  std::vector<std::string> assumed;  ///< data derived from the name or the rule
};

struct ImportedCampaign {
  std::string id;
  std::vector<ImportedFile> files;
  std::vector<std::string> lacks;  ///< what must be stated for the whole campaign
  bool written = false;
  std::string asset{}, maker{}, serial{};
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
  const config::TerminalWords& say;
  /// For the machine of all campaigns; empty if not stated.
  std::string asset{}, maker{}, serial{};
  /// Whether incomplete campaigns are also written.
  bool partial = false;
  bool dry_run = false;
};

/// Each new folder appears completely. Existing files are not changed, and campaigns that were
/// imported before are skipped.
Expected<ImportReport> import_folder(const ImportRequest& request, const loader::Plugins& plugins);

}  // namespace nonio::importing
