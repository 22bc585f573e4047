// SPDX-License-Identifier: Apache-2.0
// How long the history of an output folder takes: bench_history rebuild|update OUT [CAMPAIGN]...
#include <chrono>
#include <cstdio>
#include <string>
#include <vector>

#include "host/history/store.h"

int main(int argc, char** argv) {
  if (argc < 3) return 2;
  namespace history = nonio::host::history;
  const std::string what = argv[1];
  const std::vector<std::string> campaigns(argv + 3, argv + argc);
  const auto begin = std::chrono::steady_clock::now();
  const auto done = what == "rebuild" ? history::rebuild(argv[2], {}, [] {})
                                      : history::update(argv[2], false, campaigns, {}, [] {});
  const std::chrono::duration<double> took = std::chrono::steady_clock::now() - begin;
  if (!done) {
    std::fprintf(stderr, "%s\n", done.error().message.c_str());
    return 1;
  }
  std::printf("%s: %llu evaluations in %.2f s%s, %zu left out\n", what.c_str(),
              static_cast<unsigned long long>(done->evaluations), took.count(),
              done->rebuilt ? ", made again" : "", done->left_out.size());
  return done->left_out.empty() ? 0 : 1;
}
