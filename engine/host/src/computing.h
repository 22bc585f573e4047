// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <vector>

#include "nonio/host/evaluate.h"
#include "prints.h"
#include "worker.h"

namespace nonio::host {

/// In the process with the plugins: evaluates the campaigns that the other side names, until it is
/// gone. It can open no file: the other side hands it those of the campaign.
void evaluate_for(int stream, const Context& context, SharedWords& stage, Prints& prints);

/// In the process that has files, register and signer, and no plugin code.
class Evaluator {
 public:
  /// `secrets`: files that are handed to nobody.
  Evaluator(int stream, std::vector<std::filesystem::path> secrets)
      : stream_(stream), secrets_(std::move(secrets)) {}

  /// As `evaluate`, done by the other side. Where it is gone, this process ends too: its parent
  /// knows why. An error: it says what no process of ours says.
  Expected<Evaluated> evaluate(const std::filesystem::path& folder, const std::string& id,
                               const Draw& draw, const Twins& twins);
  /// Whether the memory of the other side has grown noticeably.
  bool grown() const { return grown_; }

 private:
  bool hand_out(const std::filesystem::path& folder, const std::string& path) const;

  int stream_;
  std::vector<std::filesystem::path> secrets_;
  bool grown_ = false;
};

}  // namespace nonio::host
