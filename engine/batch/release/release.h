// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "batch/state/run_result.h"

namespace nonio::batch {

struct ReleaseRequest {
  std::filesystem::path campaign;
  std::string by;  ///< printed name of the person; empty if `user` is stated
  /// Author or authoriser; empty for the default of the site: author if it requires two persons.
  std::string role;
  /// By finding_key or by id of the finding. FINDING=TEXT of a command is divided at the first "=",
  /// which may be in the finding, so several can begin alike.
  std::multimap<std::string, std::string> reasons;
  /// Output folder of the run; empty for that of the draft.
  std::filesystem::path out;
  /// Account in users.toml with its password, which prove the identity of the person. Without an
  /// account, `by` is an unverified statement.
  std::string user{}, password{};
};

struct Released {
  enum class State {
    refused,   ///< a condition of the approval is not met; nothing was changed
    lacking,   ///< findings in `without_reason` have severity warning and need a reason
    approved,  ///< approved by the author; an authoriser must approve too
    failed,    ///< not issued, the draft is kept
    issued
  } state = State::refused;
  std::string why;
  std::string by;  ///< name of the person, as stated or from users.toml
  std::optional<certificates::WaitingDraft> draft;
  std::vector<std::string> without_reason;  ///< keys of findings
  std::vector<std::string> notes;
  certificates::RegisterEntry entry;         ///< only in state `issued`
  std::vector<std::filesystem::path> files;  ///< files in the output folder of the run
};

/// Approves the draft of a run, and issues the certificate unless the role is author. An error if
/// data, plugins, templates or the program version have changed since the run. `base` states
/// plugins, templates and version.
Released release(const ReleaseRequest& request, const RunOptions& base, const RunEvents& events);

/// Returns the draft of the campaign `folder`, or the drafts of all campaigns of the site.
Expected<std::vector<certificates::WaitingDraft>> waiting_drafts(
    const std::filesystem::path& folder);

/// The path may be in a pack.
std::filesystem::path file_of(const certificates::WaitingDraft& draft);
/// Returns the reason why the draft cannot be approved, or an empty string. Possible reasons are a
/// missing file and changes since the run.
std::string why_stale(const certificates::WaitingDraft& draft);

}  // namespace nonio::batch
