// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <string_view>

#include "campaign/evaluation/evaluate.h"
#include "platform/storage/files.h"

namespace nonio::certificates {

/// Reads the files of one campaign, each once. A file that was changed after the evaluation is an
/// error.
class CampaignFiles {
 public:
  /// `folder` must outlive this object.
  explicit CampaignFiles(const std::filesystem::path& folder) : folder_(folder) {}

  /// `digest`: digest of the evaluated file. The bytes are valid during the lifetime of this
  /// object.
  Expected<std::string_view> bytes(const std::string& name, const std::string& digest);
  /// Returns the SHA-256 of the concatenated files of readings.
  Expected<std::string> readings_sha256(const reading::Inputs& inputs);

 private:
  struct Known {
    storage::ReadFile file;
    std::string sha256;
  };
  const std::filesystem::path& folder_;
  std::map<std::string, Known> known_;
};

/// Returns an empty text for a file of another campaign and for the record of the machine.
std::string file_of_input(const std::string& input);

}  // namespace nonio::certificates
