// SPDX-License-Identifier: Apache-2.0
// How long the history of an output folder takes: bench_history rebuild|update OUT [CAMPAIGN]..., bench_history morning OUT TEMPLATES.
#include <chrono>
#include <cstdio>
#include <string>
#include <vector>

#include "host/batch/morning_update.h"
#include "host/config/template_files.h"
#include "host/history/store.h"

namespace {

namespace history = nonio::host::history;

int complain(const nonio::Error& error) {
  std::fprintf(stderr, "%s\n", error.message.c_str());
  return 1;
}

int update(const std::string& what, const char* out, const std::vector<std::string>& campaigns) {
  const auto begin = std::chrono::steady_clock::now();
  const auto done = what == "rebuild" ? history::rebuild(out, {}, [] {})
                                      : history::update(out, false, campaigns, {}, [] {});
  const std::chrono::duration<double> took = std::chrono::steady_clock::now() - begin;
  if (!done) return complain(done.error());
  std::printf("%s: %llu evaluations in %.2f s%s, %zu left out\n", what.c_str(),
              static_cast<unsigned long long>(done->evaluations), took.count(),
              done->rebuilt ? ", made again" : "", done->left_out.size());
  return done->left_out.empty() ? 0 : 1;
}

/// As the end of a night makes it.
int morning(const char* out, const char* templates) {
  nonio::host::reading::Context context;
  auto read = nonio::host::config::read_templates({templates}, context.templates_sha256);
  if (!read) return complain(read.error());
  context.templates = std::move(*read);
  nonio::host::batch::RunOptions options;
  options.out = out;
  nonio::host::morning::Tonight tonight;
  tonight.night = 2, tonight.date = "2026-03-20", tonight.campaigns = 100'000;
  const auto begin = std::chrono::steady_clock::now();
  const auto made = nonio::host::batch::make_morning(options, context, tonight);
  const std::chrono::duration<double> took = std::chrono::steady_clock::now() - begin;
  if (!made) return complain(made.error());
  std::printf("morning: %.2f s, %zu characters of lines\n", took.count(), made->json.size());
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc < 3) return 2;
  const std::string what = argv[1];
  if (what == "morning") return argc == 4 ? morning(argv[2], argv[3]) : 2;
  return update(what, argv[2], {argv + 3, argv + argc});
}
