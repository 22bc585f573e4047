// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "campaign/evaluation/record.h"
#include "nonio/sdk/error.h"

/// The history of a laboratory: results.json of all campaigns as rows of a database, which can be
/// rebuilt from these files.
namespace nonio::store {

/// State of a result that a compensation table predicts.
inline constexpr const char* predicted_state = "predicted";

/// Standard uncertainty that results with the same source have in common.
struct CommonPart {
  std::string source;
  double u = 0.0;
};

/// A result; values and uncertainties are in the unit of results.json.
struct ResultRow {
  std::string measurement, axis, quantity;
  /// "followed", the analysis, or for a prediction the controller plugin.
  std::string source;
  std::string unit;
  std::string state;  ///< as-found, as-left, check or predicted
  double value = 0.0;
  std::optional<double> u_repeat{};       ///< standard uncertainty without the common parts
  std::optional<double> expanded{}, k{};  ///< expanded uncertainty U and its k
  std::vector<CommonPart> common{};
  std::optional<double> tolerance{};
  std::string decision{};
  std::string conditions{};  ///< JSON; must agree between comparable results
  /// Missing manifest keys, separated by commas, whose contributions `u_repeat` lacks.
  std::string not_stated{};
};

/// Covariance of the results `first` .. `first + count - 1`: upper triangle row by row.
struct CovarianceRow {
  std::uint64_t first = 0, count = 0;
  std::vector<double> upper;
  /// Member `other_targets` of results.json for the comparison with campaigns that have other
  /// targets.
  std::string other_targets{};
};

struct FindingRow {
  std::string measurement, source, id, severity;
};

/// A limit that applies to no value.
struct LimitRow {
  std::string measurement, axis, quantity, unit;
  double tolerance = 0.0;
};

/// Mean deviations of a measurement with the active, written and recorded tables of the control.
struct ControlTableRow {
  std::string measurement, axis;
  std::string state;  ///< member `control_tables` of results.json
};

struct MachineAsStated {
  std::string asset, maker, model, serial;
};

struct InstrumentAsStated {
  std::string maker, model, serial, calibrated, certificate, valid_until;
};

struct CertificateRow {
  std::string number, day, replaces, campaign_sha256;
};

struct Entry {
  std::string campaign, campaign_sha256, day, customer, purpose, status, message;
  std::string place, control;
  MachineAsStated machine;
  InstrumentAsStated instrument;
  std::vector<ResultRow> results;  ///< results with a covariance first
  std::vector<CovarianceRow> covariance;
  std::vector<FindingRow> findings;
  std::vector<LimitRow> without_value;
  std::vector<ControlTableRow> control_tables;
  std::optional<CertificateRow> certificate;  ///< issued certificate; not part of the digest
};

/// Makes an entry from results.json and the digests of the inputs. An error if the bytes are not a
/// valid results.json, if a text contains a character 0, or if the campaign is not `id`.
Expected<Entry> entry_of(std::string_view results, const reading::Inputs& inputs,
                         const std::string& id);

/// Returns the SHA-256 of the digests of manifest and readings.
std::string campaign_sha256(const reading::Inputs& inputs);
/// Returns the SHA-256 of an entry without its certificate.
std::string digest_of(const Entry& entry);

}  // namespace nonio::store
