// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "nonio/sdk/campaign.h"

/// Makes the texts of the files that `nonio new` writes.
namespace nonio::app {

struct NewAxis {
  Axis axis;
  std::string file;   ///< name of the file in the campaign's folder
  std::string bytes;  ///< content of the file; empty: example readings are made
  bool example() const { return bytes.empty(); }
};

struct NewCampaign {
  std::string id, customer, operator_name, date, maker, machine, serial, asset, control, instrument;
  std::vector<NewAxis> axes;
  std::string reader{};                ///< reader of all files, determined by `columns`; empty: the
                                       ///< reader is chosen by the content of each file
  std::vector<std::string> columns{};  ///< entries of option `columns`, as given with --column
  bool example() const;
};

struct NewSite {
  std::string laboratory, address, country;
};

struct NewMachine {
  std::string asset, maker, model, serial, control;
  std::vector<Axis> axes;
};

/// Returns the record of a machine; keys without a known value are comments.
std::string machine_text(const NewMachine& machine);
std::string site_text(const NewSite& site);
std::string campaign_text(const NewCampaign& campaign);

/// Replaces the example that a text offers for a key as a comment, such as "instrument.serial", by
/// a value. A key with a quoted example gets a quoted value. Returns false if the text offers no
/// such key.
bool set_offered(std::string& text, const std::string& key, const std::string& value);

/// Returns invented readings as CSV, marked as examples: 5 runs in both directions over the travel.
/// They differ for each campaign and axis, because equal readings of two campaigns are a finding.
std::string example_readings(const Axis& axis, const std::string& campaign);

/// Returns the nearest valid id of a campaign: "Rossi FP12" gives "rossi-fp12".
std::string valid_id(const std::string& name);

}  // namespace nonio::app
