// SPDX-License-Identifier: Apache-2.0
#include "certificates/campaign_files.h"

#include "platform/storage/digest.h"

namespace nonio::certificates {

Expected<std::string_view> CampaignFiles::bytes(const std::string& name,
                                                const std::string& digest) {
  auto found = known_.find(name);
  if (found == known_.end()) {
    NONIO_TRY(const auto path, storage::path_inside(folder_, name));
    NONIO_TRY(auto file, storage::ReadFile::open(path));
    std::string sha = storage::sha256(file.bytes());
    found = known_.emplace(name, Known{std::move(file), std::move(sha)}).first;
  }
  if (found->second.sha256 != digest)
    return fail(name + " was changed while the campaign was evaluated");
  return found->second.file.bytes();
}

Expected<std::string> CampaignFiles::readings_sha256(const reading::Inputs& inputs) {
  storage::RunningDigest all;
  for (const auto& [input, digest] : inputs) {
    if (!input.starts_with(reading::input_name(""))) continue;
    NONIO_TRY(const auto part, bytes(file_of_input(input), digest));
    all.add(part);
  }
  return all.hex();
}

std::string file_of_input(const std::string& input) {
  const std::string prefix = reading::input_name("");
  if (input.starts_with(prefix)) return input.substr(prefix.size());
  return input == config::manifest_name ? input : "";
}

}  // namespace nonio::certificates
