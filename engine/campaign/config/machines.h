// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "campaign/config/manifest.h"

/// The machines of a site: SITE/machines/<asset>.toml contains data that campaigns do not measure.
namespace nonio::config {

inline constexpr const char* machines_folder = "machines";

/// The table and backlash value in the control for one axis, from one day on.
struct ControlState {
  std::string since{};  ///< day of loading or of the backup, YYYY-MM-DD
  /// Table files relative to the site, separated by commas; empty without a table, nullopt if not
  /// stated.
  std::optional<std::string> table{};
  std::optional<double> backlash{};  ///< m or rad; 0 if inactive, nullopt if not stated
  std::string source = "stated";     ///< "stated" (by a person), "backup" or "nonio"
  std::string sha256{};              ///< SHA-256 of the table files; empty if not stated
  std::string files{};               ///< key of the table's files in RecordFile::tables
  std::string key{};                 ///< key of this state: axes.X or axes.X.state
  std::uint64_t line_of_table = 0, line_of_since = 0;

  /// A loaded state applies only to later days, because the time of day is not known; a state from
  /// a backup applies to the day of the backup too.
  bool counts_on(const std::string& day) const {
    return source == "backup" ? day >= since : day > since;
  }
};

struct RecordedAxis {
  bool rotary = false;
  std::string name{};  ///< name in the control; empty if it equals the name in the record
  /// Settings by the names of option `axes` of the controllers: number, reference_mm, from_mm,
  /// to_mm, resolution_um, largest_um, slope_um_per_m, and those of rotary axes.
  std::map<std::string, double> settings{};
  std::vector<ControlState> states{};  ///< all states, sorted by day
  ControlState present{};  ///< state in the keys of axes.X; also in `states` if it has a day

  /// Returns null if the state on this day is not known.
  const ControlState* state_on(const std::string& day) const;
};

struct MachineRecord {
  std::string file;
  std::string asset, maker, model, serial, control, control_version;
  std::vector<std::string> taken{};  ///< table numbers that are already in use: "0", "100-227"
  std::map<std::string, RecordedAxis> axes{};
  KeyLines lines{};
};

/// Returns the SHA-256 of the files of a table, independent of their names and order.
std::string table_sha256(const std::vector<Artifact>& files);

/// Returns all errors of the file at once, each with its line. `asset`: name of the file without
/// .toml.
Checked<MachineRecord> parse_machine(std::string_view text, const std::string& file,
                                     const std::string& asset);

/// A file of SITE/machines. If a record has errors, the campaigns of its machine fail; if its
/// machine is not known, all campaigns that name no asset and have no other record.
struct RecordFile {
  std::string asset;
  std::string bytes;   ///< empty if the file cannot be read
  std::string sha256;  ///< digest of the file and of the table files that it names
  Checked<MachineRecord> record;
  std::map<std::string, std::vector<Artifact>> tables{};
  std::string maker{}, serial{};  ///< from the last valid version, if the record has errors
};
using MachineRecords = std::vector<RecordFile>;

/// Returns the records sorted by asset; empty if the site has no folder of records. An error if the
/// folder cannot be read.
Expected<MachineRecords> read_machines(const std::filesystem::path& site);

/// Names the machine in `Inputs` by its asset, otherwise by maker and serial number; empty if
/// neither is stated.
std::string machine_input(const Machine& machine);
inline constexpr std::string_view machine_prefix = "machine ";
/// Returns the digests of the records of the machine with the name `input` (`machine_input`).
/// Without such records, returns those of records with errors whose machine is not known, unless
/// `input` states an asset; otherwise `absent`.
std::string machine_digest(const MachineRecords& records, std::string_view input);

/// Returns null without a record of the machine. The record may have errors and may then belong to
/// another machine. An error if two records have the maker and serial number of the machine.
Expected<const RecordFile*> record_of(const MachineRecords& records, const Machine& machine);

std::vector<Error> contradictions(const Manifest& manifest, const MachineRecord& record);

/// Returns the options with which a controller writes tables. For each axis in option `axes`, the
/// record overrides site.toml, and the campaign overrides both; axes that the campaign lacks are
/// left out. A record that names another control is ignored. An error if the campaign contradicts
/// the record.
Checked<Settings> settle_table_options(const Info& output, const RawOptions& site,
                                       const Manifest& manifest, const MachineRecord* record);

/// Name under which a record with its tables is attached to signed files.
inline constexpr const char* machine_record_name = "machine-record.json";
std::string packed(const RecordFile& record);
Expected<RecordFile> unpacked_record(std::string_view json);

}  // namespace nonio::config
