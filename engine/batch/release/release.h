// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "batch/state/run_result.h"

namespace nonio::batch {

/// Arguments of `nonio certificate approve`.
struct ReleaseRequest {
  std::filesystem::path campaign;  ///< its folder
  std::string by;                  ///< a person's name, as it is printed; empty with `user`
  std::string role;                ///< author, authoriser; empty: what the site requires
  std::map<std::string, std::string> reasons;  ///< by finding_key or by the finding's id
  std::filesystem::path out;                   ///< of the run; empty: where it was
  /// Of users.toml, whose name is taken then; the password shows that it is that person. Empty: `by`
  /// is a statement.
  std::string user{}, password{};
};

struct Released {
  enum class State {
    refused,   ///< `why` states what is wrong with the request
    lacking,   ///< findings of attention without a reason: `without_reason`
    approved,  ///< by the author; an authoriser is still wanted
    failed,    ///< not issued, as `why` states; the draft still waits
    issued
  } state = State::refused;
  std::string why;
  std::optional<certificates::WaitingDraft> draft;
  std::vector<std::string> without_reason;  ///< keys of findings
  std::vector<std::string> notes;
  certificates::RegisterEntry entry;         ///< of what was issued
  std::vector<std::filesystem::path> files;  ///< in the output folder of the run
};

/// Issues the draft of a run, exactly that: its data, plugins, templates and version
/// must be the same. `base` gives plugins, templates and version.
Released release(const ReleaseRequest& request, const RunOptions& base, const RunEvents& events);

/// The drafts of the site that `folder` is or belongs to; of a campaign's folder its own alone.
Expected<std::vector<certificates::WaitingDraft>> waiting_drafts(
    const std::filesystem::path& folder);

/// Why the draft that waits cannot be released as it is; empty if it can.
std::string why_stale(const certificates::WaitingDraft& draft);

}  // namespace nonio::batch
