// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "campaign/evaluation/followed.h"
#include "campaign/evaluation/status.h"
#include "campaign/reading/context.h"
#include "nonio/sdk/results.h"

namespace nonio::evaluation {

struct IssuedFile {
  std::string output, name, bytes;  ///< `output`: name of the plugin that wrote the file
  std::string no_time_stamp{};      ///< why a requested time stamp is missing; otherwise empty
};

struct Certificate {
  std::string output;
  Issue issue{};
  std::string templates_sha256{};
  bool issued = false;  ///< whether the members below are those of an issued certificate
  bool draft = false;
  /// Files that `output` wrote come first.
  std::vector<IssuedFile> files{};
  std::string results{};   ///< results.json as attached to the certificate
  std::string released{};  ///< JSON with the approver and the reasons for accepted findings
};

struct ShownHistory {
  std::string sha256;  ///< digest of all data of the history; empty if not known
  /// Id of each campaign and digest of its results.
  std::vector<std::pair<std::string, std::string>> campaigns{};
};

/// Correction along one axis by tables, in SI units. Without points, no table exists.
struct AxisCorrection {
  std::vector<double> position{}, plus{}, minus{};
  std::optional<double> backlash{};  ///< m or rad; nullopt if not known
};

/// Mean errors of one measured axis, and its active and new compensation. SI units.
struct ControlTables {
  std::string measurement, axis, state;  ///< `state`: "as-found" or "as-left"
  bool rotary = false;
  /// Positions and mean errors, m or rad. A direction that was not measured has no values.
  std::vector<double> position{}, plus{}, minus{};
  double u = 0.0;  ///< standard uncertainty of a mean from the scatter, m or rad
  std::optional<AxisCorrection> active{};  ///< nullopt if not known
  std::optional<AxisCorrection> written{};
  /// Corrections that the record of the machine states, each with its first day.
  std::vector<std::pair<std::string, AxisCorrection>> recorded{};
};

struct Evaluated {
  Campaign campaign;
  Results results;
  reading::Inputs inputs;  ///< digests of the campaign's files and machine record, manifest first
  Status status = Status::none;
  std::optional<Certificate> certificate{};
  bool retry = false;  ///< the campaign failed for a reason outside of its files
  std::vector<FollowedGroup> followed{};
  std::vector<ControlTables> control_tables{};
  std::string purpose{};
  std::optional<ShownHistory> history{};  ///< nullopt if no document shows a history
};

struct AssignedNumber {
  /// The certificate that was issued for the same data, otherwise the draft or a new number.
  std::optional<Certificate> certificate{};
  /// Data and conditions that are missing for a number.
  std::vector<std::string> missing{};
  std::optional<Error> error{};  ///< failure of the request, which the next run repeats
};

/// Evaluates one campaign without a certificate number, and writes nothing to disk.
Evaluated evaluate(const std::filesystem::path& folder, const std::string& id,
                   const reading::Context& context, const reading::Stage& stage);

}  // namespace nonio::evaluation
