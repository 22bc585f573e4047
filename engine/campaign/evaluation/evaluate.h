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

/// A file of a certificate as it was issued, signature included.
struct IssuedFile {
  std::string output, name, bytes;  ///< of which output plugin
  std::string no_time_stamp{};      ///< why it has none although one was wanted
};

/// What a campaign has been issued under its number, or is to get.
struct Certificate {
  std::string output;  ///< the plugin that makes it
  Issue issue{};
  std::string templates_sha256{};
  bool issued = false;              ///< already: what follows is what was signed then
  bool draft = false;               ///< without number: waits until a person releases it
  std::vector<IssuedFile> files{};  ///< those of `output` first
  std::string results{};            ///< results.json as it is attached
  std::string released{};           ///< JSON: by whom, and why findings are accepted
};

/// The history of the machine that a document shows: of which campaigns, in which state.
struct ShownHistory {
  std::string sha256;  ///< of all that it is made from; empty: it was not known yet
  std::vector<std::pair<std::string, std::string>> campaigns{};  ///< id, digest of their results
};

/// What a table adds along one axis, at its points; no points: nothing. SI.
struct AxisCorrection {
  std::vector<double> position{}, plus{}, minus{};
  std::optional<double> backlash{};  ///< m or rad, where it is known
};

/// Mean errors of one measurement of an axis, the compensation that was active, and what was written
/// for the control. SI.
struct ControlTables {
  std::string measurement, axis, state;  ///< as-found, as-left
  bool rotary = false;
  std::vector<double> position{}, plus{}, minus{};  ///< a direction that was not measured is empty
  double u = 0.0;                                   ///< standard, of a mean, of its scatter
  std::optional<AxisCorrection> active{};           ///< none: not known
  std::optional<AxisCorrection> written{};
  /// What the record of the machine states, by day.
  std::vector<std::pair<std::string, AxisCorrection>> recorded{};
};

struct Evaluated {
  Campaign campaign;
  Results results;
  reading::Inputs inputs;  ///< of the campaign's own files, manifest first
  Status status = Status::none;
  std::optional<Certificate> certificate{};
  bool retry = false;  ///< it failed for a reason that does not lie in its files
  std::vector<FollowedGroup> followed{};
  std::vector<ControlTables> control_tables{};
  std::string purpose{};                  ///< as the manifest states it
  std::optional<ShownHistory> history{};  ///< none: no document requests it
};

/// What has become of a campaign's wish to be issued under a number.
struct AssignedNumber {
  /// What was issued for the same data already, else a draft, else what has a new number.
  std::optional<Certificate> certificate{};
  std::vector<std::string> missing{};  ///< why there is none, also by day and register
  std::optional<Error> error{};        ///< the register could not be read: to be tried again
};

/// One campaign from its folder to its artifacts, without a number; writes nothing. For verbs: a
/// run does it in four steps (evaluation.h).
Evaluated evaluate(const std::filesystem::path& folder, const std::string& id,
                   const reading::Context& context, const reading::Stage& stage);

}  // namespace nonio::evaluation
