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

/// Runs in the process with the plugins: evaluates the campaigns requested by the `Evaluator` at
/// the other end of `stream`, until the connection ends. The process cannot open files, and
/// receives descriptors of the campaign's files from the `Evaluator`.
void evaluate_for(int stream, const reading::Context& context, process::SharedStatus& stage,
                  Prints& prints);

/// Controls the process with the plugins. Used in the process that has access to files, register
/// and signer, and no plugin code.
class Evaluator {
 public:
  /// `secrets`: files that are never sent to the other process.
  Evaluator(int stream, std::vector<std::filesystem::path> secrets)
      : stream_(stream), secrets_(std::move(secrets)) {}

  /// Results of the analysis, before the campaign has a number.
  struct Analysed {
    evaluation::Evaluated evaluated;                  ///< results of the analysis; empty if no
                                                      ///< number is required
    std::optional<std::vector<std::string>> missing;  ///< data that are missing for a certificate
                                                      ///< number; none: no number is required
  };

  /// Calls `read_campaign` and `analyse` in the other process. If that process has ended, this
  /// process ends too, and the parent process determines the reason. An error if the answer cannot
  /// come from a process of this program.
  Expected<Analysed> analyse(const std::filesystem::path& folder, const std::string& id,
                             const reading::Twins& twins,
                             const std::optional<HistorySoFar>& history);
  /// Calls `write_documents` for the same campaign in the other process. `assigned`: the number, if
  /// one was required.
  Expected<evaluation::Evaluated> write_documents(
      const std::string& id, std::optional<evaluation::AssignedNumber> assigned);
  /// Returns whether the memory of the process with the plugins has grown by more than 64 MiB since
  /// its start.
  bool grown() const { return grown_; }

 private:
  bool hand_out(const std::filesystem::path& folder, const std::string& path) const;

  int stream_;
  std::vector<std::filesystem::path> secrets_;
  bool grown_ = false;
};

}  // namespace nonio::batch
