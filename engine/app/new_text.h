// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "nonio/sdk/campaign.h"

/// The files that `nonio new` writes, as texts.
namespace nonio::app {

struct NewAxis {
  Axis axis;
  std::string file;   ///< in the campaign's folder
  std::string bytes;  ///< of the file; empty: example readings
  bool example() const { return bytes.empty(); }
};

struct NewCampaign {
  std::string id, customer, operator_name, date, maker, machine, serial, asset, control, instrument;
  std::vector<NewAxis> axes;
  std::string reader{};                ///< of all files, by `columns`; empty: by their content
  std::vector<std::string> columns{};  ///< names of columns as a person stated them
  bool example() const;
};

struct NewSite {
  std::string laboratory, address, country;
};

struct NewMachine {
  std::string asset, maker, model, serial, control;
  std::vector<Axis> axes;
};

/// The record of a machine; keys without a known value are comments.
std::string machine_text(const NewMachine& machine);
std::string site_text(const NewSite& site);
std::string campaign_text(const NewCampaign& campaign);

/// Writes a value in place of the example that a text offers for a key as a comment:
/// "instrument.serial". A key with a quoted example gets a quoted value. False if the text offers
/// no such key.
bool set_offered(std::string& text, const std::string& key, const std::string& value);

/// CSV of invented readings, marked as such: 5 runs, both directions, over the travel. They differ
/// for each campaign and axis, because equal readings of two campaigns are a finding.
std::string example_readings(const Axis& axis, const std::string& campaign);

/// The nearest id that a campaign may have: "Rossi FP12" gives "rossi-fp12".
std::string valid_id(const std::string& name);

}  // namespace nonio::app
