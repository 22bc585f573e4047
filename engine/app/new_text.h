// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "nonio/sdk/campaign.h"

namespace nonio::app {

struct NewAxis {
  Axis axis;
  std::string file;
  std::string bytes;  ///< content; empty if example readings are made
  bool example() const { return bytes.empty(); }
};

struct NewCampaign {
  std::string id, customer, operator_name, date, maker, machine, serial, asset, control, instrument;
  std::vector<NewAxis> axes;
  /// Reader of all files; empty if it is chosen by the content of each file.
  std::string reader{};
  std::vector<std::string> columns{};  ///< entries of the reader option `columns`
  bool example() const;
};

struct NewSite {
  std::string laboratory, address, country;
};

struct NewMachine {
  std::string asset, maker, model, serial, control;
  std::vector<Axis> axes;
};

/// Returns the TOML record of a machine. Keys without a value are written as comments.
std::string machine_text(const NewMachine& machine);
std::string site_text(const NewSite& site);
std::string campaign_text(const NewCampaign& campaign);

/// Replaces a commented example in the TOML text by a value, for example of the key
/// "instrument.serial". The value is quoted if the example is. Returns false if the text contains
/// no such example.
bool set_offered(std::string& text, const std::string& key, const std::string& value);

/// Returns synthetic readings as CSV, marked as examples: 5 runs in both directions over the
/// travel. They differ between campaigns and axes, because equal readings of two campaigns are a
/// finding.
std::string example_readings(const Axis& axis, const std::string& campaign);

/// Returns the nearest valid id of a campaign, for example "rossi-fp12" for "Rossi FP12".
std::string valid_id(const std::string& name);

}  // namespace nonio::app
