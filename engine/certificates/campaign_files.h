// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <string_view>

#include "campaign/evaluation/evaluate.h"
#include "platform/storage/files.h"

namespace nonio::certificates {

/// The files of one campaign for numbering and signing: each is read and hashed once, at its first
/// use. They are those that were evaluated, or there is an error: the process with the plugins has
/// read them through descriptors of its own.
class CampaignFiles {
 public:
  /// `folder` must outlive it.
  explicit CampaignFiles(const std::filesystem::path& folder) : folder_(folder) {}

  /// `name` as the manifest has it, `digest` as it was evaluated. Valid as long as this object.
  Expected<std::string_view> bytes(const std::string& name, const std::string& digest);
  /// SHA-256 of the files of readings, one behind the other.
  Expected<std::string> readings_sha256(const reading::Inputs& inputs);

 private:
  struct Known {
    storage::ReadFile file;
    std::string sha256;
  };
  const std::filesystem::path& folder_;
  std::map<std::string, Known> known_;
};

/// The name of the file of the campaign's folder behind an input; empty where it is none: what
/// another campaign has, or the record of the machine.
std::string file_of_input(const std::string& input);

}  // namespace nonio::certificates
