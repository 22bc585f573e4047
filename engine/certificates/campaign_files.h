// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <string_view>

#include "campaign/evaluation/evaluate.h"
#include "platform/storage/files.h"

namespace nonio::certificates {

/// Reads the files of one campaign for numbering and signing; each is read and hashed once, at its
/// first use. Returns an error if a file is not the one that was evaluated, because the process
/// with the plugins has read it through descriptors of its own.
class CampaignFiles {
 public:
  /// `folder` must outlive this object.
  explicit CampaignFiles(const std::filesystem::path& folder) : folder_(folder) {}

  /// Returns the bytes of the file `name`, as the manifest names it; an error if its digest is not
  /// `digest`, that of the evaluated file. The bytes are valid during the lifetime of this object.
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

/// Returns the name of the campaign's file that an input denotes; empty if the input is a file of
/// another campaign or the record of the machine.
std::string file_of_input(const std::string& input);

}  // namespace nonio::certificates
