// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <string>
#include <utility>
#include <vector>

#include "nonio/sdk/plugin.h"

/// A Digital Calibration Certificate (PTB's schema 3.3.0) as XML, to be signed by the host.
namespace nonio::dcc {

/// The same in each language, ISO 639-1; a name or a symbol has none ("").
using Text = std::vector<std::pair<std::string, std::string>>;

struct Statement {
  std::string ref_type;  ///< of the DCC practice; may be empty
  Text says;
};

/// What influenced a measurement: lowest and highest as read.
struct Condition {
  std::string ref_type, unit;  ///< D-SI
  Text name;
  std::string low, high;  ///< numbers, as printed
};

/// A statement of conformity in words.
struct Decided {
  Text name;       ///< "A, X: limit 12 um"
  Text says;       ///< "conforms"
  std::string is;  ///< pass, fail; empty where the rule leaves it open
};

/// What of one evaluation is stated in words.
struct Words {
  Text title, method;
  std::vector<Text> departures;  ///< from the method
  Text test;                     ///< how it was made
  std::vector<Condition> conditions;
  std::string status;  ///< beforeAdjustment, afterAdjustment, or empty
};

struct About {
  std::string number;                  ///< of the certificate
  std::vector<std::string> languages;  ///< ISO 639-1
  std::string location;           ///< where it was calibrated: "customer", as the schema states
  std::string software, release;  ///< who writes
  /// Values without U are left out, as they are on paper.
  bool only_with_U = false;
  std::map<std::string, Words> words{};           ///< by "plugin of measurement"
  std::map<std::string, Text> meaning{};          ///< of values and curves, by their names
  Text lowest{}, highest{}, equipment{}, item{};  ///< what else is stated about instrument and item
  Text uncertainty{};                             ///< how it was determined
  Text register_name{};                           ///< what the register's identity is called
  Text released{};                                ///< how it was released, where no person did
  std::vector<Statement> statements{};
  Text rule{};         ///< by which was decided
  std::string norm{};  ///< its name
  std::vector<Decided> decided{};
};

/// How an evaluation is called in a DCC, and where `nonio certificate verify` searches for it:
/// "iso230-2 of X".
std::string name_of(const Results::Analysed&);

/// What the schema requires must be there: laboratory, customer, item, dates, at least one result.
std::string write(const OutputInput&, const About&);

/// ISO 3166-1: "IT".
bool is_country(std::string_view);

}  // namespace nonio::dcc
