// SPDX-License-Identifier: Apache-2.0
// bench_campaign SITE OUT PLUGINS TEMPLATES [ROUNDS]: CPU time of each stage of a campaign, all in this process: the
// same calls as in `nonio run`, without its processes and channels. Also for profilers: callgrind cannot follow the
// processes of a run, which are not allowed to open files. Prints one line per stage: microseconds per campaign, share,
// name.
#include <unistd.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "batch/commit/store.h"
#include "batch/state/wire.h"
#include "campaign/evaluation/evaluation.h"
#include "platform/process/child.h"
#include "platform/storage/disk.h"

namespace {

namespace fs = std::filesystem;
using namespace nonio;

double now() {
  timespec t{};
  ::clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
  return static_cast<double>(t.tv_sec) + 1e-9 * static_cast<double>(t.tv_nsec);
}

/// CPU time goes to the stage that was named last.
class Clock {
 public:
  void begin(const std::string& stage) {
    const double at = now();
    if (!stage_.empty()) spent_[stage_] += at - since_;
    stage_ = stage.substr(0, stage.find_first_of(",("));
    since_ = now();
  }
  const std::map<std::string, double>& spent() const { return spent_; }

 private:
  std::map<std::string, double> spent_;
  std::string stage_;
  double since_ = 0.0;
};

std::vector<fs::path> campaigns_in(const fs::path& site) {
  std::vector<fs::path> out;
  for (const auto& entry : fs::recursive_directory_iterator(site))
    if (entry.path().filename() == config::manifest_name) out.push_back(entry.path().parent_path());
  std::sort(out.begin(), out.end());
  return out;
}

/// To the worker, as between two processes.
evaluation::Evaluated sent(const evaluation::Evaluated& evaluated) {
  evaluation::Evaluated received;
  if (!storage::unpack(storage::pack(evaluated), received)) std::abort();
  return received;
}

/// One campaign to its staged files; false if something is wrong with it.
bool do_one(const fs::path& folder, const fs::path& out, const reading::Context& context,
            Clock& clock, std::vector<batch::Staged>& staged) {
  const reading::Stage tell = [&](const std::string& words) { clock.begin(words); };
  auto read = reading::read_campaign(folder, context, tell);
  if (!read.manifest) return false;
  const std::string id = read.manifest->campaign.id;
  clock.begin("between the stages");
  auto analysed = evaluation::analyse(std::move(read), id, context, tell, {});
  const auto evaluated =
      evaluation::write_documents(std::move(analysed), nullptr, context, tell, nullptr);
  clock.begin("results to the worker as bytes");
  const auto received = sent(evaluated);
  clock.begin("results.json and run.json with SHA-256 and temporary files");
  if (!batch::stage(out, received, context, {folder.string(), {1, ""}, "new", false})) return false;
  clock.begin("between the stages");
  staged.push_back({id, 0});
  return evaluated.status != evaluation::Status::failed;
}

void print(const Clock& clock, double campaigns) {
  double all = 0.0;
  std::vector<std::pair<double, std::string>> lines;
  for (const auto& [name, seconds] : clock.spent()) {
    all += seconds;
    lines.emplace_back(seconds, name);
  }
  std::sort(lines.rbegin(), lines.rend());
  for (const auto& [seconds, name] : lines)
    std::printf("%8.1f us %5.1f %%  %s\n", 1e6 * seconds / campaigns, 100.0 * seconds / all,
                name.c_str());
  std::printf("%8.1f us          all of a campaign, in one process\n", 1e6 * all / campaigns);
}

}  // namespace

int main(int argc, char** argv) {
  if (argc < 5)
    return std::fputs("bench_campaign SITE OUT PLUGINS TEMPLATES [ROUNDS]\n", stderr), 2;
  const auto campaigns = campaigns_in(argv[1]);
  const fs::path out = argv[2];
  const int rounds = argc > 5 ? std::atoi(argv[5]) : 1;
  if (campaigns.empty()) return std::fputs("no campaign\n", stderr), 2;
  auto place = reading::open_workplace(campaigns.front(), {argv[3]}, {argv[4]}, "bench");
  if (!place) return std::fprintf(stderr, "%s\n", place.error().message.c_str()), 2;
  const reading::Context& context = (*place)->context;
  for (const Output& output : context.plugins->outputs())
    if (output.prepare != nullptr) output.prepare(context.templates);
  fs::create_directories(out);
  const storage::Disk disk(out);
  process::keep_freed_memory();
  constexpr std::size_t batch = 64;  // as the committer's
  Clock clock;
  clock.begin("between the stages");
  for (int round = 0; round < rounds; ++round)
    for (std::size_t i = 0; i < campaigns.size();) {
      std::vector<batch::Staged> staged;
      for (const std::size_t end = std::min(i + batch, campaigns.size()); i < end; ++i)
        if (!do_one(campaigns[i], out, context, clock, staged))
          return std::fprintf(stderr, "%s failed\n", campaigns[i].c_str()), 1;
      clock.begin("flush and read back and rename");
      for (const auto& done : batch::commit(out, staged, 1, disk))
        if (!done) return std::fprintf(stderr, "%s\n", done.error().message.c_str()), 1;
      clock.begin("between the stages");
    }
  clock.begin("");
  print(clock, static_cast<double>(campaigns.size()) * rounds);
}
