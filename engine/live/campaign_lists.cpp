// SPDX-License-Identifier: Apache-2.0
#include "live/campaign_lists.h"

#include <algorithm>
#include <set>

#include "campaign/config/machines.h"
#include "campaign/reading/plausibility/traceability.h"

namespace nonio::live {
namespace fs = std::filesystem;
using storage::Json;

namespace {

Json values_with(const ListedCampaign& c, std::initializer_list<const char*> beginnings) {
  Json out = Json::object();
  for (const auto& value : c.values)
    if (std::any_of(beginnings.begin(), beginnings.end(),
                    [&](const char* beginning) { return value.first.starts_with(beginning); }))
      out[value.first] = value.second;
  return out;
}

std::string value_of(const ListedCampaign& c, const std::string& key) {
  const auto found = c.values.find(key);
  return found == c.values.end() ? std::string() : found->second;
}

std::string joined(std::initializer_list<std::string> texts) {
  std::string out;
  for (const std::string& one : texts)
    if (!one.empty()) out += (out.empty() ? "" : " ") + one;
  return out;
}

std::string instrument_of(const ListedCampaign& c) {
  return joined({value_of(c, "instrument.maker"), value_of(c, "instrument.model"),
                 value_of(c, "instrument.serial")});
}

struct Instrument {
  Json json;
  std::string calibrated{};
  std::size_t campaigns = 0;
};

void take_machine(const ListedCampaign& c, CampaignLists::Machine& m) {
  if (m.campaigns++ > 0) return;
  m.words = c.words;
  m.json = {{"machine", c.machine},   {"maker", value_of(c, "machine.maker")},
            {"model", c.model},       {"serial", value_of(c, "machine.serial")},
            {"customer", c.customer}, {"day", c.day},
            {"state", c.state},       {"verdict", c.verdict}};
}

/// Keeps the newest calibration and at most 20 campaigns, the newest first.
void take_instrument(const ListedCampaign& c, const std::string& name, Instrument& i) {
  constexpr std::size_t most = 20;
  const std::string calibrated = value_of(c, "instrument.calibrated");
  if (i.campaigns == 0) i.json = {{"name", name}, {"calibrated", ""}, {"campaigns", Json::array()}};
  if (calibrated > i.calibrated) {
    i.calibrated = calibrated;
    i.json["calibrated"] = calibrated;
    i.json["certificate"] = value_of(c, "instrument.certificate");
    i.json["until"] = reading::last_valid_day(calibrated, value_of(c, "instrument.valid_until"));
  }
  if (i.campaigns++ < most)
    i.json["campaigns"].push_back(
        {{"folder", c.folder}, {"id", c.id}, {"day", c.day}, {"machine", c.machine}});
}

class Records {
 public:
  void take(const ListedCampaign& c, const std::string& instrument) {
    if (is_new(customer_, c.customer))
      customers.push_back({{"name", c.customer}, {"values", values_with(c, {"campaign."})}});
    if (is_new(machine_, c.machine))
      machines.push_back(
          {{"name", c.machine}, {"values", values_with(c, {"campaign.", "machine."})}});
    if (is_new(instrument_, instrument))
      instruments.push_back({{"name", instrument},
                             {"values", values_with(c, {"instrument.", "environment.",
                                                        "certificate.", "campaign.operator"})}});
    if (!c.columns.empty() && columns_.insert(c.columns).second) columns.push_back(c.columns);
  }
  void take(const config::MachineRecord& r) {
    if (!is_new(machine_, r.asset)) return;
    machines.push_back({{"name", r.asset},
                        {"values",
                         {{"machine.asset", r.asset},
                          {"machine.maker", r.maker},
                          {"machine.model", r.model},
                          {"machine.serial", r.serial},
                          {"machine.control", r.control}}}});
  }

  Json customers = Json::array(), machines = Json::array(), instruments = Json::array(),
       columns = Json::array();

 private:
  static bool is_new(std::set<std::string>& seen, const std::string& name) {
    return !name.empty() && seen.insert(name).second;
  }
  std::set<std::string> customer_{}, machine_{}, instrument_{};
  std::set<std::vector<std::string>> columns_{};
};

}  // namespace

std::string stamp_of_records(const fs::path& site) {
  std::string stamp;
  std::error_code error;
  for (fs::directory_iterator it(site / "machines", error), end; !error && it != end;
       it.increment(error))
    stamp += it->path().filename().string() + file_stamp(it->path());
  return stamp;
}

CampaignLists campaign_lists(const CampaignIndex& index, const fs::path& site) {
  CampaignLists out;
  // The version is read before the campaigns, so that a change in between is detected.
  out.version = index.version();
  out.stamp = stamp_of_records(site);
  std::map<std::string, Instrument> instruments;
  Records records;
  index.each([&](const ListedCampaign& c) {
    const std::string instrument = instrument_of(c);
    if (!c.machine.empty()) take_machine(c, out.machines[c.machine]);
    if (!instrument.empty()) take_instrument(c, instrument, instruments[instrument]);
    records.take(c, instrument);
  });
  if (const auto files = config::read_machines(site))
    for (const config::RecordFile& file : *files)
      if (file.record) records.take(*file.record);
  Json all = Json::array();
  for (auto& [name, i] : instruments) {
    i.json["number"] = i.campaigns;
    all.push_back(std::move(i.json));
  }
  out.instruments =
      json_answer(200, {{"schema", "nonio-live-instruments/1"}, {"instruments", std::move(all)}});
  out.records = json_answer(200, {{"schema", "nonio-live-records/1"},
                                  {"customers", std::move(records.customers)},
                                  {"machines", std::move(records.machines)},
                                  {"instruments", std::move(records.instruments)},
                                  {"columns", std::move(records.columns)}});
  return out;
}

}  // namespace nonio::live
