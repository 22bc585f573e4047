// SPDX-License-Identifier: Apache-2.0
#include "batch/commit/refused.h"

#include "batch/commit/store.h"
#include "platform/storage/disk.h"
#include "platform/storage/files.h"

namespace nonio::batch {
using Action = CampaignState::Action;

void store_refused(const RunOptions& options, const reading::Context& context, const RunState& run,
                   const RunEvents& events, std::vector<CampaignState>& campaigns) {
  const storage::Disk disk(options.out);
  const CampaignState* before = nullptr;
  for (CampaignState& c : campaigns) {
    if (c.action != Action::todo || c.status != evaluation::Status::failed) continue;
    const auto record = evaluation::read_record(storage::results_folder(options.out, c.id));
    const bool stays = c.is_campaign && record && record->status != evaluation::Status::failed;
    std::vector<Error> errors = c.errors;
    if (stays)
      errors.front().message +=
          "; the results of run " + std::to_string(record->run) + " stay as they are";
    if (c.is_campaign && !stays && (before == nullptr || before->id != c.id)) {
      evaluation::Evaluated evaluated;
      evaluated.campaign.id = c.id;
      evaluated.status = evaluation::Status::failed;
      evaluated.results.errors = errors;
      if (const auto stored =
              store(options.out, evaluated, context, {c.folder, run.of(), c.reason, true}, disk);
          !stored)
        errors.push_back(stored.error());
    }
    c.errors = std::move(errors);
    before = &c;
    c.action = Action::done;
    events.finished(c);
  }
}

}  // namespace nonio::batch
