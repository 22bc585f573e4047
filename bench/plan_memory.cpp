// SPDX-License-Identifier: Apache-2.0
// The memory that the plan of a run takes for so many campaigns:
//   bench_plan_memory COUNT SHARDS FOLDER [LENGTH]
// The survey is simulated: names, one file of readings each, no results of earlier runs. The rest is what `nonio run plan`
// does: the campaigns in order, those that share readings, the lists in FOLDER/.nonio/plan. Prints the peak of the memory
// (VmHWM) after each step. LENGTH: characters of an id, 8 if it is not given; a folder has 6 more.
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <numeric>
#include <string>
#include <vector>

#include "batch/state/run_plan.h"
#include "batch/survey/earlier_results.h"
#include "batch/survey/survey.h"
#include "platform/storage/digest.h"

using namespace nonio;
using batch::CampaignState;

namespace {

/// Bytes; 0 if the system does not say.
double peak() {
  std::ifstream status("/proc/self/status");
  for (std::string line; std::getline(status, line);)
    if (line.starts_with("VmHWM:")) return std::strtod(line.c_str() + 6, nullptr) * 1024.0;
  return 0.0;
}

void tell(const char* step, double before, std::size_t count) {
  static const auto begin = std::chrono::steady_clock::now();
  const std::chrono::duration<double> spent = std::chrono::steady_clock::now() - begin;
  std::printf("%-34s peak %7.1f MB, %5.1f bytes a campaign, after %.1f s\n", step, peak() / 1e6,
              (peak() - before) / static_cast<double>(count), spent.count());
  std::fflush(stdout);
}

std::string padded(std::size_t n, std::size_t digits) {
  std::string text = std::to_string(n);
  return text.insert(0, digits - std::min(digits, text.size()), '0');
}

}  // namespace

int main(int argc, char** argv) {
  if (argc < 4 || argc > 5) {
    std::fprintf(stderr, "usage: bench_plan_memory COUNT SHARDS FOLDER [LENGTH]\n");
    return 2;
  }
  const std::size_t count = std::strtoull(argv[1], nullptr, 10);
  const std::size_t digits = argc == 5 ? std::strtoull(argv[4], nullptr, 10) - 1 : 7;
  const double before = peak();
  tell("nothing", before, count);
  std::vector<std::string> walked;
  for (std::size_t i = 0; i < count; ++i)  // as bench/scale.py makes them
    walked.emplace_back(padded(i / 1000, 5) + "/c" + padded(i, digits));
  tell("folders found", before, count);
  std::vector<CampaignState> campaigns;
  campaigns.reserve(walked.size());
  for (const std::string& folder : walked) {
    campaigns.emplace_back();
    campaigns.back().folder = folder;
  }
  std::vector<std::string>().swap(walked);
  {
    std::vector<std::uint32_t> which(count);
    std::iota(which.begin(), which.end(), std::uint32_t{0});
    for (const std::uint32_t i : which) {
      CampaignState& c = campaigns[i];
      // Not in the order of the folders.
      c.id = "c" + padded((i * 7919ULL + 13) % count, digits);
      c.reason = "no earlier result";
      const std::uint64_t digest = storage::short_digest(storage::sha256(c.folder));
      c.readings = {digest};
    }
  }
  tell("campaigns looked at", before, count);
  {
    const batch::ClaimedIds claimed(campaigns);
    if (claimed.contains("x")) return 1;
  }
  batch::set_in_order(campaigns);
  tell("in order, shared readings found", before, count);
  batch::RunPlan plan;
  plan.run = {1, "2026-01-01"};
  plan.shards.resize(std::strtoull(argv[2], nullptr, 10));
  if (const auto written = batch::write_plan(argv[3], plan, campaigns); !written) {
    std::fprintf(stderr, "%s\n", written.error().message.c_str());
    return 1;
  }
  tell("lists written", before, count);
  std::printf("%llu campaigns in %zu shards\n", static_cast<unsigned long long>(plan.to_do),
              plan.shards.size());
}
