// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "campaign/evaluation/record.h"
#include "nonio/sdk/error.h"

/// The laboratory's memory: what results.json of all campaigns show, as rows of a database that can
/// be made again from them.
namespace nonio::store {

/// State of a result that is none yet: what a table promises (its controller is the source).
inline constexpr const char* predicted_state = "predicted";

/// Standard uncertainty that other results with the same source share.
struct CommonPart {
  std::string source;
  double u = 0.0;
};

/// One number of a campaign, in the unit in which results.json has it.
struct ResultRow {
  std::string measurement, axis, quantity;
  std::string source;  ///< "followed", or the analysis
  std::string unit;
  std::string state;  ///< as-found, as-left, check; predicted
  double value = 0.0;
  std::optional<double> u_repeat{};       ///< standard, of what is new in each campaign
  std::optional<double> expanded{}, k{};  ///< U
  std::vector<CommonPart> common{};
  std::optional<double> tolerance{};
  std::string decision{};
  std::string conditions{};  ///< JSON: what must be alike to be joined
  std::string not_stated{};  ///< keys, with commas: `u_repeat` lacks what they would give
};

/// Of results `first` .. `first + count - 1`: the upper triangle, row by row.
struct CovarianceRow {
  std::uint64_t first = 0, count = 0;
  std::vector<double> upper;
  /// JSON, as results.json has it: what a comparison with campaigns that have other targets needs.
  std::string other_targets{};
};

struct FindingRow {
  std::string measurement, source, id, severity;
};

/// A limit with which no value could be compared.
struct LimitRow {
  std::string measurement, axis, quantity, unit;
  double tolerance = 0.0;
};

/// What a measurement of an axis states of the control's tables.
struct ControlTableRow {
  std::string measurement, axis;
  std::string state;  ///< JSON: the member of `control_tables` of results.json
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

/// What the history keeps of one evaluation of one campaign.
struct Entry {
  std::string campaign, campaign_sha256, day, customer, purpose, status, message;
  std::string place, control;  ///< of the machine, as this evaluation knew them
  MachineAsStated machine;
  InstrumentAsStated instrument;
  std::vector<ResultRow> results;  ///< those with a covariance first
  std::vector<CovarianceRow> covariance;
  std::vector<FindingRow> findings;
  std::vector<LimitRow> without_value;
  std::vector<ControlTableRow> control_tables;
  std::optional<CertificateRow> certificate;  ///< issued, no draft; not part of the digest
};

/// From the bytes of results.json and the digests of what it was made from. An error if it is no
/// such file, is cut short, holds what is not a number, or is of another campaign than `id`.
Expected<Entry> entry_of(std::string_view results, const reading::Inputs& inputs,
                         const std::string& id);

/// SHA-256 over the digests of the campaign's own files: manifest and readings.
std::string campaign_sha256(const reading::Inputs& inputs);
/// SHA-256 over everything in an entry but its certificate.
std::string digest_of(const Entry& entry);

}  // namespace nonio::store
