// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <string>
#include <utility>
#include <vector>

#include "nonio/sdk/plugin.h"

/// A Digital Calibration Certificate (PTB's schema 3.3.0) as XML, to be signed by the host.
namespace nonio::dcc {

/// One text in each language, ISO 639-1; a name or a symbol has the language "".
using Text = std::vector<std::pair<std::string, std::string>>;

struct Statement {
  std::string ref_type;  ///< refType of the DCC practice; may be empty
  Text says;
};

/// Lowest and highest reading of an influence quantity.
struct Condition {
  std::string ref_type, unit;  ///< refType, and unit in D-SI
  Text name;
  std::string low, high;  ///< as printed
};

struct Decided {
  Text name;       ///< the requirement: "A, X: limit 12 um"
  Text says;       ///< the result: "conforms"
  std::string is;  ///< pass, fail; empty if indeterminate
};

/// Texts about one evaluation.
struct Words {
  Text title, method;
  std::vector<Text> departures;  ///< deviations from the method
  Text test;                     ///< description of the test
  std::vector<Condition> conditions;
  std::string status;  ///< beforeAdjustment, afterAdjustment, or empty
};

struct About {
  std::string number;
  std::vector<std::string> languages;  ///< ISO 639-1
  std::string location;                ///< place of calibration: "customer", as in the schema
  std::string software, release;       ///< name and version of the program
  /// Whether values without U are omitted, as in the printed certificate.
  bool only_with_U = false;
  std::string not_reported{};             ///< analysis that is not on the printed pages either
  std::map<std::string, Words> words{};   ///< keys are "plugin of measurement"
  std::map<std::string, Text> meaning{};  ///< meaning of values and curves, by name
  Text lowest{}, highest{}, equipment{}, item{};  ///< further statements about instrument and item
  Text uncertainty{};                             ///< how the uncertainty was determined
  Text register_name{};                           ///< name of the register's identity
  Text released{};                                ///< how it was approved, if no person did
  std::vector<Statement> statements{};
  Text rule{};
  std::string norm{};  ///< standard of the decision rule
  std::vector<Decided> decided{};
};

/// Name of an evaluation in a DCC, by which `nonio certificate verify` finds it: "iso230-2 of X".
std::string name_of(const Results::Analysed&);

/// Returns the XML. The input must contain what the schema requires: laboratory, customer, item,
/// dates, at least one result.
std::string write(const OutputInput&, const About&);

/// ISO 3166-1, such as "IT".
bool is_country(std::string_view);

}  // namespace nonio::dcc
