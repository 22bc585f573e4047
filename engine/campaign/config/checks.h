// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "campaign/config/bind.h"
#include "campaign/config/causes.h"
#include "campaign/config/machines.h"
#include "campaign/config/manifest.h"
#include "campaign/config/site_logs.h"

/// Conditions that involve several keys. Functions named check_... complete a table after its keys
/// were read; a third argument is the struct that the outer table fills. Functions named read_...
/// read one key into a member.
namespace nonio::config {

void read_options(TableReader&, const Key&, RawOptions&);

void check_campaign(TableReader&, Manifest&);
void restore_axis_order(TableReader&, Machine&);
void check_axis(TableReader&, Axis&);
void check_instrument(TableReader&, Instrument&);
void check_square(TableReader&, Square&, Manifest&);
void check_parameter(TableReader&, Formula::Parameter&);
void check_own_formula(TableReader&, Formula&, Manifest&);
void check_accepted(TableReader&, AcceptedFinding&);
void read_measurements(TableReader&, const Key&, std::vector<Measurement>&, Manifest&);
void read_tolerances(TableReader&, const Key&, std::vector<Tolerance>&);

void check_numbering(TableReader&, SiteFile&);
void check_signer(TableReader&, SignerRule&);
void check_signing(TableReader&, Signing&);
void check_mail(TableReader&, Mail&);
void check_webhook(TableReader&, Webhook&);
void check_alias(TableReader&, Alias&, SiteFile&);
void check_due(TableReader&, DueRule&, SiteFile&);
void check_database(TableReader&, DatabaseChoice&);

void read_as_written(TableReader&, const Key&, std::map<std::string, double>& settings);
void check_state(TableReader&, ControlState&);
void check_recorded_axis(TableReader&, RecordedAxis&);

/// Whether an earlier element has the same name as the last one.
template <class T>
bool given_before(const std::vector<T>& all, std::string T::*name) {
  for (std::size_t i = 0; i + 1 < all.size(); ++i)
    if (all[i].*name == all.back().*name) return true;
  return false;
}

/// The causes in one file. `places`: file and line of each cause in all files so far, by its name.
struct Causes {
  std::vector<Cause> all{};
  std::map<std::string, std::string>* places = nullptr;
  bool of_site = false;  ///< whether the formulas have to be tried, as those of a site
};
void check_cause(TableReader&, Cause&, Causes&);

struct Entries {
  std::vector<Event> events;
  std::vector<Acknowledgement> acknowledged;
  std::vector<Withdrawal> withdrawn;
  std::vector<Forgotten> forgotten;
};
template <class Entry>
void check_entry(TableReader&, Entry&);

}  // namespace nonio::config
