// SPDX-License-Identifier: Apache-2.0
#include "results_folder.h"

#include "campaign/evaluation/evaluate.h"
#include "campaign/evaluation/record.h"
#include "platform/storage/files.h"
#include "platform/storage/packed_results.h"

namespace nonio::app {
namespace fs = std::filesystem;

Holds what_holds(const fs::path& folder) {
  std::error_code error;
  if (fs::exists(folder / config::manifest_name, error)) return Holds::campaign;
  if (storage::is_there(folder / evaluation::results_name).value_or(false)) return Holds::results;
  if (fs::exists(folder / "summary.json", error)) return Holds::run;
  return Holds::nothing;
}

fs::path results_at(const fs::path& folder) {
  if (what_holds(folder) != Holds::nothing) return folder;
  fs::path path = fs::absolute(folder).lexically_normal();
  if (!path.has_filename()) path = path.parent_path();
  const fs::path above = path.parent_path();
  for (const fs::path& out : {above, above.parent_path()}) {
    const std::string id = path.filename().string();
    if (storage::own_folder(out, id) != path) continue;
    if (fs::path place = storage::results_folder(out, id); place != path) return place;
  }
  return folder;
}

std::string holds_nothing(const fs::path& folder) {
  std::error_code error;
  if (!fs::is_directory(folder, error)) return "there is no folder " + folder.string();
  return folder.string() +
         " is neither a campaign (campaign.toml) nor what `nonio run` left of one (results.json)";
}

std::string id_of_campaign(const fs::path& folder) {
  std::string id;
  if (const auto text = storage::read_file(folder / config::manifest_name)) {
    const auto manifest = config::parse_without_methods(*text, config::manifest_name);
    id = manifest ? manifest->campaign.id : config::extract_id(*text);
  }
  return id.empty() ? fs::absolute(folder).lexically_normal().filename().string() : id;
}

}  // namespace nonio::app
