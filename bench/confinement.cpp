// SPDX-License-Identifier: Apache-2.0
// bench_confinement SITE PLUGINS TEMPLATES [ROUNDS]: runs over SITE with plugins confined and not
// confined, in turn: the cost of the confinement. Medians of CPU time (all processes) and wall time
// of a run, and of the pairs.
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <string>
#include <vector>

#include "batch/run.h"

namespace {

namespace fs = std::filesystem;

struct Cost {
  double wall, processor;
};

double seconds(const timeval& t) {
  return static_cast<double>(t.tv_sec) + 1e-6 * static_cast<double>(t.tv_usec);
}

/// One first night in a process of its own.
Cost run(nonio::batch::RunOptions options, bool confine) {
  fs::remove_all(options.out);
  options.confine = confine;
  const auto begin = std::chrono::steady_clock::now();
  const pid_t pid = ::fork();
  if (pid == 0) {
    const nonio::batch::RunEvents silent{[](const auto&) {}, [](auto, auto) {}, [](const auto&) {},
                                         [] {}};
    const auto done = nonio::batch::run_site(options, silent);
    std::_Exit(done.end == nonio::batch::RunResult::End::complete ? 0 : 1);
  }
  int status = 0;
  rusage usage{};
  ::wait4(pid, &status, 0, &usage);
  if (status != 0) {
    std::fputs("the night did not end well\n", stderr);
    std::exit(1);
  }
  const std::chrono::duration<double> wall = std::chrono::steady_clock::now() - begin;
  return {wall.count(), seconds(usage.ru_utime) + seconds(usage.ru_stime)};
}

double median(std::vector<double> all) {
  std::sort(all.begin(), all.end());
  return all[all.size() / 2];
}

}  // namespace

int main(int argc, char** argv) {
  if (argc < 4) return std::fputs("bench_confinement SITE PLUGINS TEMPLATES [ROUNDS]\n", stderr), 2;
  nonio::batch::RunOptions options;
  options.site = argv[1];
  options.own_plugins = argv[2];
  options.plugin_folders = {options.own_plugins};
  options.template_folders = {argv[3]};
  options.version = "bench";
  options.jobs = 1;
  options.out = fs::temp_directory_path() / ("nonio-bench-" + std::to_string(::getpid()));
  const int rounds = argc > 4 ? std::atoi(argv[4]) : 21;
  std::vector<double> wall[2], processor[2], ratio, wall_ratio;
  run(options, true);  // files are in memory then
  for (int i = 0; i < rounds; ++i) {
    Cost cost[2]{};
    for (const int confined : {i % 2, 1 - i % 2}) {
      cost[confined] = run(options, confined == 1);
      wall[confined].push_back(cost[confined].wall);
      processor[confined].push_back(cost[confined].processor);
    }
    ratio.push_back(cost[1].processor / cost[0].processor);
    wall_ratio.push_back(cost[1].wall / cost[0].wall);
  }
  fs::remove_all(options.out);
  for (const int confined : {0, 1})
    std::printf("%-12s CPU %.4f s, wall %.4f s (medians of %d nights)\n",
                confined == 1 ? "confined" : "not confined", median(processor[confined]),
                median(wall[confined]), rounds);
  std::printf("confined / not confined, median of the pairs: CPU %.4f, wall %.4f\n", median(ratio),
              median(wall_ratio));
}
