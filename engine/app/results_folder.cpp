// SPDX-License-Identifier: Apache-2.0
#include "results_folder.h"

#include "host/evaluation/evaluate.h"
#include "host/evaluation/record.h"
#include "host/storage/files.h"

namespace nonio::app {
namespace fs = std::filesystem;

Holds what_holds(const fs::path& folder) {
  std::error_code error;
  if (fs::exists(folder / host::config::manifest_name, error)) return Holds::campaign;
  if (fs::exists(folder / host::evaluation::results_name, error)) return Holds::results;
  if (fs::exists(folder / "summary.json", error)) return Holds::night;
  return Holds::nothing;
}

std::string holds_nothing(const fs::path& folder) {
  std::error_code error;
  if (!fs::is_directory(folder, error)) return "there is no folder " + folder.string();
  return folder.string() +
         " is neither a campaign (campaign.toml) nor what "
         "`nonio run` left of one (results.json)";
}

std::string id_of_campaign(const fs::path& folder) {
  std::string id;
  if (const auto text = host::storage::read_file(folder / host::config::manifest_name)) {
    const auto manifest = host::config::parse_manifest(*text, host::config::manifest_name);
    id = manifest ? manifest->campaign.id : host::config::extract_id(*text);
  }
  return id.empty() ? fs::absolute(folder).lexically_normal().filename().string() : id;
}

}  // namespace nonio::app
