// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "batch/workers/worker.h"
#include "campaign/evaluation/evaluate.h"
#include "nonio/sdk/history.h"
#include "platform/process/prints.h"

namespace nonio::batch {

/// In the process with the plugins: evaluates the campaigns that the other side names, until the
/// connection ends. It can open no file: the other side hands it those of the campaign.
void evaluate_for(int stream, const reading::Context& context, process::SharedStatus& stage,
                  Prints& prints);

/// In the process that has files, register and signer, and no plugin code.
class Evaluator {
 public:
  /// `secrets`: files that are not handed over.
  Evaluator(int stream, std::vector<std::filesystem::path> secrets)
      : stream_(stream), secrets_(std::move(secrets)) {}

  /// What the other side has made of a campaign before its number is known.
  struct Analysed {
    evaluation::Evaluated evaluated;                  ///< only where a number is required
    std::optional<std::vector<std::string>> missing;  ///< for a number; none: none is required
  };

  /// `read_campaign` and `analyse`, done by the other side. If that has ended, this process ends
  /// too: its parent knows why. An error: it states what no process of ours reports.
  Expected<Analysed> analyse(const std::filesystem::path& folder, const std::string& id,
                             const reading::Twins& twins,
                             const std::optional<HistorySoFar>& history);
  /// `write_documents` of the same campaign. `assigned`: where a number was wanted.
  Expected<evaluation::Evaluated> write_documents(
      const std::string& id, std::optional<evaluation::AssignedNumber> assigned);
  /// Whether the memory of the other side has grown noticeably.
  bool grown() const { return grown_; }

 private:
  bool hand_out(const std::filesystem::path& folder, const std::string& path) const;

  int stream_;
  std::vector<std::filesystem::path> secrets_;
  bool grown_ = false;
};

}  // namespace nonio::batch
