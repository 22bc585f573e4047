// SPDX-License-Identifier: Apache-2.0
#include "later_campaigns.h"

#include <algorithm>
#include <tuple>

#include "campaign/config/machines.h"
#include "campaign/config/site_files.h"
#include "platform/storage/files.h"

namespace nonio::app {
namespace fs = std::filesystem;

namespace {

/// Compares the records of the machines, otherwise the asset, or maker and serial number.
bool is_same_machine(const config::MachineRecords& records, const Machine& a, const Machine& b) {
  const auto of_a = config::record_of(records, a), of_b = config::record_of(records, b);
  if (of_a && of_b && *of_a != nullptr && *of_a == *of_b) return true;
  const std::string name = config::machine_input(a);
  return !name.empty() && name == config::machine_input(b);
}

bool has_readings(const Campaign& campaign, const std::string& axis, const fs::path& folder) {
  std::error_code error;
  return std::any_of(campaign.measurements.begin(), campaign.measurements.end(),
                     [&](const Measurement& m) {
                       return m.kind == "axis" && control_axis(campaign.machine, m) == axis &&
                              fs::is_regular_file(folder / m.file, error);
                     });
}

}  // namespace

std::vector<LaterCampaign> later_campaigns(const OpenCampaign& open, const std::string& axis) {
  const Campaign& mine = open.campaign();
  std::vector<LaterCampaign> found;
  std::error_code error;
  const fs::path own = fs::canonical(open.folder, error);
  if (error || mine.date.empty()) return found;
  const auto look = [&](const fs::path& folder) {
    if (folder == own) return;
    const auto text = storage::read_small_file(folder / config::manifest_name);
    if (!text) return;
    const auto read =
        config::parse_manifest(*text, config::manifest_name, open.place->plugins.methods());
    if (!read) return;
    const std::string& date = read->campaign.date;
    if (!(date > mine.date || (date == mine.date && read->purpose == "check")) ||
        !is_same_machine(open.place->context.machines, mine.machine, read->campaign.machine) ||
        !has_readings(read->campaign, axis, folder))
      return;
    found.push_back({folder, read->campaign.id, date, read->purpose});
  };
  const fs::path site = fs::canonical(config::site_of(own), error);
  if (error || site == own) {
    for (const auto& entry : fs::directory_iterator(own.parent_path(), error)) look(entry.path());
  } else {
    fs::recursive_directory_iterator it(site, fs::directory_options::skip_permission_denied, error);
    for (; !error && it != fs::recursive_directory_iterator(); it.increment(error)) {
      if (it->path().filename().string().starts_with('.')) it.disable_recursion_pending();
      if (it->path().filename() == config::manifest_name) look(it->path().parent_path());
    }
  }
  std::sort(found.begin(), found.end(), [](const LaterCampaign& a, const LaterCampaign& b) {
    return std::tie(a.date, a.id) < std::tie(b.date, b.id);
  });
  return found;
}

}  // namespace nonio::app
