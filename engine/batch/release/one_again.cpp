// SPDX-License-Identifier: Apache-2.0
#include "batch/release/one_again.h"

#include "platform/storage/files.h"

namespace nonio::batch {
namespace fs = std::filesystem;
using Action = CampaignState::Action;

Expected<std::string> leave_only(const RunOptions& options, const RunState& state, RunResult& run) {
  std::error_code error;
  std::string below = fs::path(options.only).lexically_normal().generic_string();
  while (below.ends_with('/')) below.pop_back();
  const std::string from_here = fs::weakly_canonical(options.only, error)
                                    .lexically_relative(fs::weakly_canonical(options.site, error))
                                    .generic_string();
  std::size_t found = 0;
  std::string one;
  for (CampaignState& c : run.campaigns) {
    const std::string folder = fs::path(c.folder).generic_string();
    const bool is_one =
        c.is_campaign && (c.id == options.only || folder == below || folder == from_here);
    if (is_one) ++found, one = c.id;
    if (is_one && c.action != Action::todo) {
      c.action = Action::todo;
      c.status = evaluation::Status::none;
      c.errors = {};
      c.reason = "--only";
    }
    if (is_one || c.action != Action::todo) continue;
    const auto record = evaluation::read_record(storage::results_folder(options.out, c.id));
    const bool last_run = record && record->run == state.number;
    c.action = last_run ? Action::done : Action::unchanged;
    c.status = record ? record->status : evaluation::Status::none;
    c.errors = record ? record->errors : std::vector<Error>{};
    c.reason = last_run ? record->reason : "nothing changed";
  }
  if (found == 1) return one;
  return fail("--only: there is " + std::string(found == 0 ? "no" : "more than one") +
              " campaign with the folder or id \"" + options.only + "\" in this site");
}

void leave_out_new(const RunState& state, std::vector<CampaignState>& campaigns) {
  if (!state.reopened) return;
  std::erase_if(campaigns, [](const CampaignState& c) {
    return c.action != Action::todo && c.status == evaluation::Status::none;
  });
}

}  // namespace nonio::batch
