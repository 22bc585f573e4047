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
  std::string since{};  ///< day on which the state was loaded or found in a backup, YYYY-MM-DD
  /// Table files, relative to the site and separated by commas; empty: no table was active; none:
  /// not stated.
  std::optional<std::string> table{};
  std::optional<double> backlash{};  ///< backlash value, m or rad; 0: not active; none: not stated
  std::string source = "stated";     ///< origin: stated (by a person), backup, answer or nonio
  std::string sha256{};              ///< SHA-256 of the table files; empty: not stated
  std::string files{};               ///< key of the table's files in RecordFile::tables
  std::string key{};                 ///< key of this state in the record: axes.X or axes.X.state
  std::uint64_t line_of_table = 0, line_of_since = 0;

  /// Whether the state was in the control on its day, by a backup or the answer of a person; if
  /// not, it was loaded on that day.
  bool was_in_control() const { return source == "backup" || source == "answer"; }
  /// Whether the state applies on a day. A state loaded on a day applies to later days only,
  /// because the time of day is not known.
  bool counts_on(const std::string& day) const {
    return was_in_control() ? day >= since : day > since;
  }
};

struct RecordedAxis {
  bool rotary = false;
  std::string name{};  ///< name of the axis in the control; empty: its name in the record
  /// Settings under the names of option `axes` of the controllers: number, reference_mm, from_mm,
  /// to_mm, resolution_um, largest_um, slope_um_per_m, and the corresponding ones of rotary axes.
  std::map<std::string, double> settings{};
  std::vector<ControlState> states{};  ///< all states of the control for this axis, sorted by day
  ControlState present{};  ///< state in the keys of axes.X; also in `states` if it has a day

  /// Returns the state of the control on this day; null if it is not known.
  const ControlState* state_on(const std::string& day) const;
};

struct MachineRecord {
  std::string file;  ///< path of the record, relative to the site
  std::string asset, maker, model, serial, control, control_version;
  std::vector<std::string> taken{};  ///< table numbers that are already in use: "0", "100-227"
  std::map<std::string, RecordedAxis> axes{};
  KeyLines lines{};
};

/// Returns the SHA-256 of the files of a table, independent of their names and order.
std::string table_sha256(const std::vector<Artifact>& files);

/// Parses a record. Returns all errors of the file at once, each with its line. `asset` is the name
/// of the file without .toml.
Checked<MachineRecord> parse_machine(std::string_view text, const std::string& file,
                                     const std::string& asset);

/// A file of SITE/machines. If a record has errors, the campaigns of its machine fail. If its
/// machine is not known, all campaigns fail that name no asset and have no other record.
struct RecordFile {
  std::string asset;   ///< asset of the machine; the name of the file without .toml
  std::string bytes;   ///< content of the file; empty if it cannot be read
  std::string sha256;  ///< digest of the file and of the table files that it names
  Checked<MachineRecord> record;
  std::map<std::string, std::vector<Artifact>>
      tables{};  ///< table files that are or were in the control, by ControlState::files
  std::string maker{}, serial{};  ///< from the last valid version, if the record has errors
};
using MachineRecords = std::vector<RecordFile>;

/// Reads the records of a site, sorted by asset; none if it has no folder of records, an error if
/// the folder cannot be read.
Expected<MachineRecords> read_machines(const std::filesystem::path& site);

/// Returns the name of a campaign's machine in `Inputs`: by its asset, otherwise by maker and
/// serial number; empty if neither is stated.
std::string machine_input(const Machine& machine);
/// Prefix of the names that `machine_input` returns.
inline constexpr std::string_view machine_prefix = "machine ";
/// Returns the digest of the records of the machine for which `machine_input` returns `input`. If
/// there are none and `input` states no asset, it is made from the records with errors whose
/// machine is not known; if there are none of these either, it is `absent`.
std::string machine_digest(const MachineRecords& records, std::string_view input);

/// Returns the record of a machine; null if there is none. It may be a record with errors that
/// belongs, or may belong, to the machine. An error if two records have its maker and serial
/// number.
Expected<const RecordFile*> record_of(const MachineRecords& records, const Machine& machine);

/// Returns contradictions between a manifest and the record of its machine, with file and line of
/// both.
std::vector<Error> contradictions(const Manifest& manifest, const MachineRecord& record);

/// Returns the options with which a controller writes tables. For each axis in option `axes`, the
/// record of the machine overrides site.toml, and the campaign overrides both; axes of site.toml
/// and of the record that the campaign lacks are left out. A record that names another control is
/// ignored. An error if the campaign contradicts the record.
Checked<Settings> settle_table_options(const Info& output, const RawOptions& site,
                                       const Manifest& manifest, const MachineRecord* record);

/// Name under which a record is attached to signed files. `packed` converts a record with its
/// tables into the text that is attached, and `unpacked_record` converts this text back.
inline constexpr const char* machine_record_name = "machine-record.json";
std::string packed(const RecordFile& record);
Expected<RecordFile> unpacked_record(std::string_view json);

}  // namespace nonio::config
