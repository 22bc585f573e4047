// SPDX-License-Identifier: Apache-2.0
#include "batch/commit/leftovers.h"

#include "batch/commit/store.h"
#include "batch/state/run_state.h"
#include "platform/process/stop.h"
#include "platform/storage/files.h"

namespace nonio::batch {
namespace fs = std::filesystem;

namespace {

Expected<void> tidy_below(const fs::path& out, bool hashed) {
  std::error_code error;
  for (fs::directory_iterator it(out, error), end; !error && it != end; it.increment(error)) {
    if (process::is_stop_requested()) return fail("interrupted");
    std::error_code ignored;
    if (!it->is_directory(ignored) || it->is_symlink(ignored)) continue;
    if (hashed && it->path().filename().string().size() != 2) continue;
    if (auto tidied = hashed ? tidy_below(it->path(), false) : tidy(it->path()); !tidied)
      return tidied;
  }
  if (error) return fail("cannot read the output folder " + out.string() + ": " + error.message());
  return {};
}

}  // namespace

void tidy_root(const fs::path& out) {
  storage::remove_leftovers(out);
  storage::remove_leftovers(out / state_folder);
}

Expected<void> tidy_all(const RunResult& run, const fs::path& out, bool resumed) {
  tidy_root(out);
  if (resumed) return tidy_below(out, storage::own_folder(out, "a") != out / "a");
  for (const CampaignState& c : run.campaigns) {
    if (process::is_stop_requested()) return fail("interrupted");
    if (c.action != CampaignState::Action::done || !c.is_campaign) continue;
    const fs::path folder = storage::own_folder(out, c.id);
    if (storage::results_folder(out, c.id) != folder) continue;
    if (auto tidied = tidy(folder); !tidied) return tidied;
  }
  return {};
}

}  // namespace nonio::batch
