// SPDX-License-Identifier: Apache-2.0
#include "campaign/reading/plausibility/traceability.h"

#include <charconv>

namespace nonio::reading {
namespace {

struct Calibrated {
  std::string key;  ///< "instrument" or "sensor pressure"
  const std::string &serial, &calibrated, &valid_until;
};

std::vector<Calibrated> all_of(const Campaign& c) {
  std::vector<Calibrated> all{
      {"instrument", c.instrument.serial, c.instrument.calibrated, c.instrument.valid_until}};
  for (const Sensor& s : c.sensors)
    all.push_back({"sensor " + s.measures, s.serial, s.calibrated, s.valid_until});
  return all;
}

/// Days are texts YYYY-MM-DD.
std::string later(const std::string& day, int years) {
  int year = 0;
  std::from_chars(day.data(), day.data() + 4, year);
  std::string text = std::to_string(year + years);
  text.insert(0, text.size() < 4 ? 4 - text.size() : 0, '0');
  return text + day.substr(4);
}

Finding finding(const char* id, std::vector<std::pair<std::string, std::string>> texts) {
  Finding f{.id = id, .attention = true};
  f.texts = std::move(texts);
  return f;
}

void calibration(const Calibrated& one, const std::string& first, const std::string& last,
                 std::vector<Finding>& findings) {
  if (one.calibrated.empty()) return;
  const std::string name = one.key + (one.serial.empty() ? "" : " " + one.serial);
  if (one.calibrated > first)
    findings.push_back(
        finding("traceability.calibrated-later",
                {{"instrument", name}, {"calibrated", one.calibrated}, {"measured", first}}));
  if (!one.valid_until.empty() && one.valid_until < last)
    findings.push_back(
        finding("traceability.calibration-expired",
                {{"instrument", name}, {"valid_until", one.valid_until}, {"measured", last}}));
  if (one.valid_until.empty() && later(one.calibrated, unstated_validity) < last)
    findings.push_back(finding("traceability.calibrated-long-ago",
                               {{"instrument", name},
                                {"calibrated", one.calibrated},
                                {"measured", last},
                                {"years", std::to_string(unstated_validity)}}));
}

}  // namespace

std::string last_valid_day(const std::string& calibrated, const std::string& valid_until) {
  return !valid_until.empty() || calibrated.empty() ? valid_until
                                                    : later(calibrated, unstated_validity);
}

bool is_expired_calibration(std::string_view id) {
  return id == "traceability.calibration-expired" || id == "traceability.calibrated-long-ago";
}

std::vector<Finding> traceability_findings(const Campaign& c) {
  std::vector<Finding> findings;
  if (c.date.empty()) return findings;
  const std::string& last = c.end_date.empty() ? c.date : c.end_date;
  for (const Calibrated& one : all_of(c)) calibration(one, c.date, last, findings);
  if (c.received > c.date)
    findings.push_back(
        finding("traceability.received-later", {{"received", c.received}, {"measured", c.date}}));
  return findings;
}

std::vector<std::string> days_to_come(const Campaign& c, const std::string& today) {
  std::vector<std::string> keys;
  const auto look = [&](const std::string& key, const std::string& day) {
    if (day > today)
      keys.push_back(key + " (" + day + " is still to come; today is " + today + ")");
  };
  look("campaign.date", c.date);
  look("campaign.end_date", c.end_date);
  look("campaign.received", c.received);
  for (const Calibrated& one : all_of(c)) look(one.key + ".calibrated", one.calibrated);
  return keys;
}

}  // namespace nonio::reading
