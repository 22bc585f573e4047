// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "campaign/config/manifest.h"

/// The machines of a site: SITE/machines/<asset>.toml has the data that campaigns do not measure.
namespace nonio::config {

inline constexpr const char* machines_folder = "machines";

/// What was in the control for one axis, from one day on.
struct ControlState {
  std::string since{};                 ///< YYYY-MM-DD
  std::optional<std::string> table{};  ///< files below the site; empty: there was none
  std::optional<double> backlash{};    ///< m or rad; 0: there was none
  std::string source = "stated";       ///< stated by a person, backup, nonio
  std::string sha256{};                ///< of the files; empty: not stated
  std::string files{};                 ///< of the table: a name in RecordFile::tables
  std::string key{};                   ///< axes.X, or axes.X.state
  std::uint64_t line_of_table = 0, line_of_since = 0;

  /// What was loaded on a day applies to later days, because the time of the day is not known. What
  /// a backup of that day contains was in the control while the machine was measured.
  bool counts_on(const std::string& day) const {
    return source == "backup" ? day >= since : day > since;
  }
};

struct RecordedAxis {
  bool rotary = false;
  std::string name{};  ///< in the control, where it is called otherwise
  /// As option `axes` of the controls has them: number, reference_mm, from_mm, to_mm,
  /// resolution_um, largest_um, slope_um_per_m, and the same of rotary axes.
  std::map<std::string, double> settings{};
  std::vector<ControlState> states{};  ///< by day
  ControlState present{};              ///< as stated for the axis; in `states` if it has a day

  /// What was in the control on this day; null: not known.
  const ControlState* state_on(const std::string& day) const;
};

struct MachineRecord {
  std::string file;  ///< relative to the site
  std::string asset, maker, model, serial, control, control_version;
  std::vector<std::string> taken{};  ///< numbers in use, "0", "100-227"
  std::map<std::string, RecordedAxis> axes{};
  KeyLines lines{};
};

/// SHA-256 of the files of a table, whatever their names and their order.
std::string table_sha256(const std::vector<Artifact>& files);

/// All that is wrong with the file at once, each with its line. `asset`: what the file is called.
Checked<MachineRecord> parse_machine(std::string_view text, const std::string& file,
                                     const std::string& asset);

/// One file of the folder. One that is wrong fails the campaigns of its machine; if that is
/// not known, all campaigns that name no asset and for whose machine no other record exists.
struct RecordFile {
  std::string asset;   ///< the name of the file
  std::string bytes;   ///< empty where it cannot be read
  std::string sha256;  ///< of it and of the tables that it names
  Checked<MachineRecord> record;
  std::map<std::string, std::vector<Artifact>>
      tables{};                   ///< those that are or were in the control, by ControlState::files
  std::string maker{}, serial{};  ///< of a record that is wrong: as it was when it was right last
};
using MachineRecords = std::vector<RecordFile>;

/// The records of a site by asset; an error if the folder cannot be read.
Expected<MachineRecords> read_machines(const std::filesystem::path& site);

/// How a campaign's machine is called in `Inputs`: by its asset, else by maker and serial; empty
/// where neither is stated.
std::string machine_input(const Machine& machine);
/// Prefix of such a name in `Inputs`.
inline constexpr std::string_view machine_prefix = "machine ";
/// The record's digest, `absent` where there is none.
std::string machine_digest(const MachineRecords& records, std::string_view input);

/// The record of this machine; null: there is none. It may be wrong: then it is, or may be, that of
/// the machine. An error where two have its maker and serial.
Expected<const RecordFile*> record_of(const MachineRecords& records, const Machine& machine);

/// Contradictions between the manifest and the record of its machine, with both places.
std::vector<Error> contradictions(const Manifest& manifest, const MachineRecord& record);

/// What a table output works with: of each axis in option `axes` what site.toml states, over it
/// what the record of the machine does, over that the campaign. Entries of site.toml for axes that
/// the campaign has not are left out. Where the campaign contradicts the record, an error.
Checked<Settings> settle_table_options(const Info& output, const RawOptions& site,
                                       const Manifest& manifest, const MachineRecord* record);

/// A record with its tables in one text, which travels in what is signed, and back.
inline constexpr const char* machine_record_name = "machine-record.json";
std::string packed(const RecordFile& record);
Expected<RecordFile> unpacked_record(std::string_view json);

}  // namespace nonio::config
