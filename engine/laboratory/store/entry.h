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

/// State of a result that a compensation table predicts; its source is the controller plugin.
inline constexpr const char* predicted_state = "predicted";

/// Standard uncertainty that all results with the same source have in common.
struct CommonPart {
  std::string source;
  double u = 0.0;
};

/// One result of a campaign, in the unit of results.json.
struct ResultRow {
  std::string measurement, axis, quantity;
  /// origin of the result: "followed", the name of the analysis, or for a prediction the name of
  /// the controller plugin
  std::string source;
  std::string unit;
  std::string state;  ///< state of the machine: as-found, as-left, check, predicted
  double value = 0.0;
  std::optional<double> u_repeat{};       ///< standard uncertainty without the common parts
  std::optional<double> expanded{}, k{};  ///< expanded uncertainty U and its k
  std::vector<CommonPart> common{};
  std::optional<double> tolerance{};
  std::string decision{};
  std::string conditions{};  ///< JSON: conditions that must agree for results to be joined
  std::string not_stated{};  ///< manifest keys, separated by commas, that are missing: `u_repeat`
                             ///< lacks their contributions
};

/// Covariance of results `first` .. `first + count - 1`: the upper triangle, row by row.
struct CovarianceRow {
  std::uint64_t first = 0, count = 0;
  std::vector<double> upper;
  /// Member `other_targets` of results.json as JSON: the data for the comparison with campaigns
  /// that have other targets; empty: none.
  std::string other_targets{};
};

struct FindingRow {
  std::string measurement, source, id, severity;
};

/// A limit that no value could be compared with.
struct LimitRow {
  std::string measurement, axis, quantity, unit;
  double tolerance = 0.0;
};

/// Mean errors of one measurement of an axis, with the tables of the control that were active,
/// written and recorded.
struct ControlTableRow {
  std::string measurement, axis;
  std::string state;  ///< JSON: the member `control_tables` of results.json
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

/// One evaluation of one campaign, as stored in the history.
struct Entry {
  std::string campaign, campaign_sha256, day, customer, purpose, status, message;
  std::string place, control;  ///< location and control of the machine, as stated in this
                               ///< evaluation
  MachineAsStated machine;
  InstrumentAsStated instrument;
  std::vector<ResultRow> results;  ///< results with a covariance first
  std::vector<CovarianceRow> covariance;
  std::vector<FindingRow> findings;
  std::vector<LimitRow> without_value;
  std::vector<ControlTableRow> control_tables;
  std::optional<CertificateRow> certificate;  ///< issued certificate; none for a draft; not part of
                                              ///< the digest
};

/// Makes the entry from the bytes of results.json and the digests of the inputs. An error if the
/// bytes are not a complete results.json, contain a value that is not a number or a text with a
/// character 0, or belong to another campaign than `id`.
Expected<Entry> entry_of(std::string_view results, const reading::Inputs& inputs,
                         const std::string& id);

/// Returns the SHA-256 over the digests of the campaign's own files: manifest and readings.
std::string campaign_sha256(const reading::Inputs& inputs);
/// Returns the SHA-256 over everything in an entry except its certificate.
std::string digest_of(const Entry& entry);

}  // namespace nonio::store
