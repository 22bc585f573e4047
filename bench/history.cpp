// SPDX-License-Identifier: Apache-2.0
// What the history of an output folder costs: bench_history rebuild|update OUT [CAMPAIGN]..., bench_history morning OUT TEMPLATES,
// bench_history server OUT URL (the store is on that server from now on, in schema bench).
#include <sys/resource.h>

#include <chrono>
#include <cstdio>
#include <string>
#include <vector>

#include "batch/close/worklist_update.h"
#include "campaign/config/template_files.h"
#include "laboratory/store/place.h"
#include "laboratory/store/store.h"

namespace {

namespace history = nonio::store;

int complain(const nonio::Error& error) {
  std::fprintf(stderr, "%s\n", error.message.c_str());
  return 1;
}

/// Wall clock, and processor time of this process and those that it has waited for.
class Clock {
 public:
  std::string text() const {
    const std::chrono::duration<double> took = std::chrono::steady_clock::now() - begin_;
    char out[64];
    std::snprintf(out, sizeof out, "%.2f s, %.2f s of CPU", took.count(), used() - used_);
    return out;
  }

 private:
  static double used() {
    double seconds = 0.0;
    for (const int who : {RUSAGE_SELF, RUSAGE_CHILDREN}) {
      struct rusage of {};
      ::getrusage(who, &of);
      for (const timeval& t : {of.ru_utime, of.ru_stime})
        seconds += static_cast<double>(t.tv_sec) + 1e-6 * static_cast<double>(t.tv_usec);
    }
    return seconds;
  }

  std::chrono::steady_clock::time_point begin_ = std::chrono::steady_clock::now();
  double used_ = used();
};

int update(const std::string& what, const char* out, const std::vector<std::string>& campaigns) {
  const Clock clock;
  const auto done = nonio::store::update(out, what == "rebuild", campaigns, {}, [] {});
  const std::string took = clock.text();
  if (!done) return complain(done.error());
  std::printf("%s: %llu evaluations in %s%s, %zu left out\n", what.c_str(),
              static_cast<unsigned long long>(done->evaluations), took.c_str(),
              done->rebuilt ? ", made again" : "", done->left_out.size());
  return done->left_out.empty() ? 0 : 1;
}

/// The worklist, as at the end of a run.
int morning(const char* out, const char* templates) {
  nonio::reading::Context context;
  auto read = nonio::config::read_templates({templates});
  if (!read) return complain(read.error());
  context.templates = std::move(*read);
  nonio::batch::RunOptions options;
  options.out = out;
  nonio::assessment::LastRun last_run;
  last_run.run = 2, last_run.date = "2026-03-20", last_run.campaigns = 100'000;
  const Clock clock;
  const auto made = nonio::batch::make_worklist(options, context, last_run);
  const std::string took = clock.text();
  if (!made) return complain(made.error());
  std::printf("morning: %s, %zu characters of lines\n", took.c_str(), made->json.size());
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc < 3) return 2;
  const std::string what = argv[1];
  if (what == "server")
    return argc == 4 &&
                   nonio::store::note_place(argv[2], nonio::storage::Server{argv[3], "bench", {}})
               ? 0
               : 2;
  if (what == "morning") return argc == 4 ? morning(argv[2], argv[3]) : 2;
  return update(what, argv[2], {argv + 3, argv + argc});
}
