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
  std::filesystem::path campaign;  ///< folder of the campaign
  std::string by;                  ///< name of the person as printed on the certificate; empty if
                                   ///< `user` is given
  std::string role;                ///< role of the person: author or authoriser; empty: author if
                                   ///< site.toml requires two persons, otherwise authoriser
  std::map<std::string, std::string> reasons;  ///< reasons why findings are accepted, by
                                               ///< finding_key or by the finding's id
  std::filesystem::path out;                   ///< output folder of the run; empty: the folder
                                               ///< stated in the draft
  /// Name of a user in users.toml, whose printed name is used; the password proves the identity.
  /// Empty: `by` is an unverified statement.
  std::string user{}, password{};
};

struct Released {
  enum class State {
    refused,   ///< a condition for approval is not met, as `why` states; nothing was changed
    lacking,   ///< the findings listed in `without_reason` have severity warning and need a reason
    approved,  ///< approved by the author; an authoriser is still required
    failed,    ///< not issued, as `why` states; the draft is kept
    issued
  } state = State::refused;
  std::string why;
  std::optional<certificates::WaitingDraft> draft;
  std::vector<std::string> without_reason;  ///< keys of the findings that still need a reason
  std::vector<std::string> notes;
  certificates::RegisterEntry entry;         ///< register entry of the certificate; only in state
                                             ///< `issued`
  std::vector<std::filesystem::path> files;  ///< written files in the output folder of the run
};

/// Approves the draft of a run, and issues the certificate unless the person approves as author. A
/// certificate is issued only if the data, plugins, templates and program version are unchanged
/// since the run. `base` provides the plugins, the templates and the version.
Released release(const ReleaseRequest& request, const RunOptions& base, const RunEvents& events);

/// Returns the drafts of the site that contains `folder`; for a campaign's folder, only the draft
/// of this campaign.
Expected<std::vector<certificates::WaitingDraft>> waiting_drafts(
    const std::filesystem::path& folder);

/// Returns the path of the draft's file, in a folder or in a pack.
std::filesystem::path file_of(const certificates::WaitingDraft& draft);
/// Returns why the draft cannot be approved: its file is missing or has changed since the run.
/// Returns an empty text if it can be approved.
std::string why_stale(const certificates::WaitingDraft& draft);

}  // namespace nonio::batch
