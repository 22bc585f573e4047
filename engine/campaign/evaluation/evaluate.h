// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "campaign/evaluation/followed.h"
#include "campaign/evaluation/status.h"
#include "campaign/reading/context.h"
#include "nonio/sdk/results.h"

namespace nonio::evaluation {

/// A file of an issued certificate, including its signature.
struct IssuedFile {
  std::string output, name, bytes;  ///< `output` is the name of the plugin that wrote the file
  std::string no_time_stamp{};      ///< why a requested time stamp is missing; otherwise empty
};

/// The certificate of a campaign: issued, a draft, or about to be issued.
struct Certificate {
  std::string output;  ///< name of the plugin that makes the certificate
  Issue issue{};
  std::string templates_sha256{};
  bool issued = false;  ///< already issued: the members below are as they were signed
  bool draft = false;   ///< the certificate has no number until a person approves it
  /// Files of the certificate; those that `output` wrote come first.
  std::vector<IssuedFile> files{};
  std::string results{};   ///< results.json as it is attached to the certificate
  std::string released{};  ///< JSON: approver, and reasons for accepted findings
};

/// The history of the machine that a document shows: the campaigns and the digests of their
/// results.
struct ShownHistory {
  std::string sha256;  ///< digest of all data from which the history is made; empty: not known yet
  /// Id of each campaign and digest of its results.
  std::vector<std::pair<std::string, std::string>> campaigns{};
};

/// The correction that a table adds along one axis at its points, in SI units. Without points it
/// adds nothing.
struct AxisCorrection {
  std::vector<double> position{}, plus{}, minus{};
  std::optional<double> backlash{};  ///< backlash value, m or rad; none: not known
};

/// Mean errors of one measurement of an axis, the compensation that was active, and the table that
/// was written. SI units.
struct ControlTables {
  std::string measurement, axis, state;  ///< `state` is as-found or as-left
  bool rotary = false;
  /// Positions and mean errors, m or rad; empty for a direction that was not measured.
  std::vector<double> position{}, plus{}, minus{};
  double u = 0.0;  ///< standard uncertainty of a mean from the scatter, m or rad
  std::optional<AxisCorrection> active{};  ///< correction that was active; none: not known
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
  std::string purpose{};                  ///< reason for the campaign, as the manifest states it
  std::optional<ShownHistory> history{};  ///< history of the machine; none: no document shows it
};

/// Answer of the register to a request for a certificate number.
struct AssignedNumber {
  /// The certificate that was issued for the same data, otherwise the draft, otherwise one with a
  /// new number.
  std::optional<Certificate> certificate{};
  /// Data and conditions that are missing for a certificate number, including those about dates and
  /// the register.
  std::vector<std::string> missing{};
  std::optional<Error> error{};  ///< why the request failed; the next run tries again
};

/// Evaluates one campaign from its folder to its output files, without a certificate number, and
/// writes nothing to disk. Commands use this function; a run calls the four steps of evaluation.h.
Evaluated evaluate(const std::filesystem::path& folder, const std::string& id,
                   const reading::Context& context, const reading::Stage& stage);

}  // namespace nonio::evaluation
