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
  std::string output, name, bytes;  ///< `output`: the plugin that wrote it
  std::string no_time_stamp{};      ///< why it has no time stamp although one was requested
};

/// The certificate of a campaign: issued, a draft, or about to be issued.
struct Certificate {
  std::string output;  ///< the plugin that makes it
  Issue issue{};
  std::string templates_sha256{};
  bool issued = false;              ///< already issued: the members below are as they were signed
  bool draft = false;               ///< without a number until a person approves it
  std::vector<IssuedFile> files{};  ///< those of `output` first
  std::string results{};            ///< results.json as it is attached
  std::string released{};           ///< JSON: who approved it, and why findings are accepted
};

/// The history of the machine that a document shows: the campaigns and the digests of their
/// results.
struct ShownHistory {
  std::string sha256;  ///< digest of all data it is made from; empty: not known yet
  std::vector<std::pair<std::string, std::string>> campaigns{};  ///< id, digest of their results
};

/// The correction that a table adds along one axis at its points, in SI units. Without points it
/// adds nothing.
struct AxisCorrection {
  std::vector<double> position{}, plus{}, minus{};
  std::optional<double> backlash{};  ///< m or rad, where it is known
};

/// Mean errors of one measurement of an axis, the compensation that was active, and the table that
/// was written. SI units.
struct ControlTables {
  std::string measurement, axis, state;  ///< as-found, as-left
  bool rotary = false;
  std::vector<double> position{}, plus{}, minus{};  ///< a direction that was not measured is empty
  double u = 0.0;                                   ///< standard u of a mean by its scatter
  std::optional<AxisCorrection> active{};           ///< none: not known
  std::optional<AxisCorrection> written{};
  /// Corrections that the record of the machine states, by day.
  std::vector<std::pair<std::string, AxisCorrection>> recorded{};
};

struct Evaluated {
  Campaign campaign;
  Results results;
  reading::Inputs inputs;  ///< of the campaign's own files, manifest first
  Status status = Status::none;
  std::optional<Certificate> certificate{};
  bool retry = false;  ///< it failed for a reason outside of its files
  std::vector<FollowedGroup> followed{};
  std::vector<ControlTables> control_tables{};
  std::string purpose{};                  ///< as the manifest states it
  std::optional<ShownHistory> history{};  ///< none: no document requests it
};

/// Answer of the register to a request for a certificate number.
struct AssignedNumber {
  /// The certificate that was issued for the same data, otherwise the draft, otherwise one with a
  /// new number.
  std::optional<Certificate> certificate{};
  std::vector<std::string> missing{};  ///< why there is none (also dates, register)
  std::optional<Error> error{};        ///< the register could not be read; the next run tries again
};

/// Evaluates one campaign from its folder to its output files, without a number; writes nothing to
/// disk. Commands use it; a run calls the four steps of evaluation.h.
Evaluated evaluate(const std::filesystem::path& folder, const std::string& id,
                   const reading::Context& context, const reading::Stage& stage);

}  // namespace nonio::evaluation
