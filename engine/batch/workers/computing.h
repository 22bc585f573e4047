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

/// Evaluates campaigns on request of an `Evaluator` until `stream` ends. This process contains the
/// plugins and cannot open files; it receives descriptors of the files of the campaign.
void evaluate_for(int stream, const reading::Context& context, process::SharedStatus& stage,
                  Prints& prints);

/// Controls the process with the plugins from a process that has access to files, register and
/// signer, but contains no plugin code.
class Evaluator {
 public:
  /// `secrets` are never sent to the other process.
  Evaluator(int stream, std::vector<std::filesystem::path> secrets)
      : stream_(stream), secrets_(std::move(secrets)) {}

  struct Analysed {
    evaluation::Evaluated evaluated;  ///< empty if no number is required
    /// Data that are missing for a certificate; std::nullopt if no number is required.
    std::optional<std::vector<std::string>> missing;
  };

  /// Runs `read_campaign` and `analyse` in the other process. If it has ended, this process ends
  /// too, and its parent determines the reason. An error if the answer cannot be one of this
  /// program.
  Expected<Analysed> analyse(const std::filesystem::path& folder, const std::string& id,
                             const reading::Twins& twins,
                             const std::optional<HistorySoFar>& history);
  /// Runs `write_documents` in the other process. `assigned` is the number, if required.
  Expected<evaluation::Evaluated> write_documents(
      const std::string& id, std::optional<evaluation::AssignedNumber> assigned);
  /// Whether the memory of the process with the plugins has grown by more than 64 MiB.
  bool grown() const { return grown_; }

 private:
  bool hand_out(const std::filesystem::path& folder, const std::string& path) const;

  int stream_;
  std::vector<std::filesystem::path> secrets_;
  bool grown_ = false;
};

}  // namespace nonio::batch
