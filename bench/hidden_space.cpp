// SPDX-License-Identifier: Apache-2.0
// How well `explain` finds what is hidden on a machine with several axes
// (tests/support/hidden/space.cpp):
//   bench_hidden_space STORY|all COUNT SEED [--verbose] [--right PERCENT]
// Campaigns of seeds SEED .. SEED+COUNT-1 of each story; one error of 3 times the noise is not in
// the model. Fails if fewer are named first, or in the alias group that is said, than --right says.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <ctime>
#include <filesystem>
#include <map>
#include <optional>
#include <string>

#include "campaign/loader/plugins.h"
#include "hidden/space.h"
#include "nonio/model/explain.h"
#include "tally.h"

namespace fs = std::filesystem;
using namespace nonio;
using bench::print, bench::Tally, bench::whole;
using hidden::SpaceHidden;
using hidden::Story;
using model::Verdict;

namespace {

constexpr double times_the_noise = 3.0;

struct Score {
  Tally found, by_alias, nothing_else, complete;
  std::map<std::string, Tally> of_effect;
  double cpu = 0.0, most_cpu = 0.0, readings = 0.0;
};

bool holds(const std::vector<std::string>& names, const std::string& name) {
  return std::find(names.begin(), names.end(), name) != names.end();
}

Expected<model::Explanation> explained(const model::Part& part, const SpaceHidden& h,
                                       const std::vector<std::string>& names,
                                       const std::vector<Effect>& effects, Score& score) {
  const auto terms = model::terms_of(part, h.campaign.machine, names, effects);
  if (!terms) return fail(terms.error());
  std::timespec a{}, b{};
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &a);
  auto said = model::explain(part, *terms, model::catalogue(part, effects));
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &b);
  const double cpu =
      static_cast<double>(b.tv_sec - a.tv_sec) + 1e-9 * static_cast<double>(b.tv_nsec - a.tv_nsec);
  score.cpu += cpu;
  score.most_cpu = std::max(score.most_cpu, cpu);
  score.readings += static_cast<double>(part.table.size());
  return said;
}

void tell(const SpaceHidden& h, std::uint64_t seed, const model::Explanation& e) {
  std::printf("%s seed %llu: hidden %s; said %s %s; rms %.2f, floor %.2f of the noise, %zu rows\n",
              to_text(h.story), static_cast<unsigned long long>(seed), h.effect.c_str(),
              std::string(e.verdict.kind == Verdict::Kind::missing   ? "missing"
                          : e.verdict.kind == Verdict::Kind::nothing ? "nothing"
                          : e.verdict.kind == Verdict::Kind::unknown ? "unknown"
                                                                     : "unrepeatable")
                  .c_str(),
              e.verdict.effect.c_str(), e.comparison.fit.rms / h.noise,
              e.comparison.floor ? e.comparison.floor->s / h.noise : NAN,
              e.comparison.fit.residual.size());
  std::printf("    together:");
  for (const std::string& name : e.together) std::printf(" %s", name.c_str());
  std::printf("\n");
  for (std::size_t k = 0; k < std::min<std::size_t>(4, e.candidates.size()); ++k) {
    const model::Candidate& c = e.candidates[k];
    std::printf("    %-20s score %8.1f p %.2g rms %.2f aliases", c.term.name().c_str(), c.score,
                c.p, c.rms / h.noise);
    for (const std::string& alias : c.aliases) std::printf(" %s", alias.c_str());
    std::printf("\n");
  }
  for (std::size_t k = 0; k < std::min<std::size_t>(3, e.fails.size()); ++k)
    std::printf("    left in %s %s share %.2f p %.2g\n", to_text(e.fails[k].where).c_str(),
                e.fails[k].line.c_str(), e.fails[k].share, e.fails[k].p);
}

void run(Story story, std::uint64_t seed, const std::vector<Effect>& effects, bool verbose,
         Score& score) {
  const SpaceHidden h = hidden::hide_in_space(story, seed, times_the_noise);
  const auto parts = model::parts_of(h.campaign, h.read);
  if (parts.size() != 1) {
    std::printf("%s seed %llu: %zu parts\n", to_text(story), static_cast<unsigned long long>(seed),
                parts.size());
    return score.found.add(false);
  }
  const auto first = explained(parts[0], h, h.model, effects, score);
  if (!first) {
    std::printf("%s seed %llu: %s\n", to_text(story), static_cast<unsigned long long>(seed),
                first.error().message.c_str());
    return score.found.add(false);
  }
  bool named = false, alias = false;
  if (first->verdict.kind == Verdict::Kind::missing) {
    named = first->verdict.effect == h.effect;
    for (const model::Candidate& c : first->candidates)
      if (c.term.name() == first->verdict.effect) alias = holds(c.aliases, h.effect);
  }
  score.found.add(named || alias);
  score.by_alias.add(!named && alias);
  score.of_effect[h.effect].add(named || alias);
  score.nothing_else.add(first->together == std::vector<std::string>{h.effect});
  if (!named && !alias && verbose) tell(h, seed, *first);
  std::vector<std::string> whole = h.model;
  whole.push_back(h.effect);
  const auto complete = explained(parts[0], h, whole, effects, score);
  if (!complete) {
    std::printf("%s seed %llu: %s\n", to_text(story), static_cast<unsigned long long>(seed),
                complete.error().message.c_str());
    return score.complete.add(false);
  }
  score.complete.add(complete->verdict.kind == Verdict::Kind::nothing);
  if (complete->verdict.kind != Verdict::Kind::nothing && verbose) {
    std::printf("  complete model: ");
    tell(h, seed, *complete);
  }
}

constexpr Story stories[] = {Story::gantry, Story::third, Story::single_column, Story::straightedge,
                             Story::volume, Story::steps, Story::table,         Story::swivel};

}  // namespace

int main(int argc, char** argv) {
  const std::vector<std::string> words(argv + 1, argv + argc);
  std::vector<Story> asked;
  for (const Story story : stories)
    if (!words.empty() && (words[0] == "all" || words[0] == to_text(story))) asked.push_back(story);
  const auto count = words.size() > 2 ? whole(words[1]) : std::nullopt;
  const auto seed = words.size() > 2 ? whole(words[2]) : std::nullopt;
  bool verbose = false;
  std::uint64_t right = 0;
  for (std::size_t i = 3; i < words.size(); ++i) {
    if (words[i] == "--verbose") verbose = true;
    if (words[i] == "--right" && i + 1 < words.size()) right = whole(words[++i]).value_or(0);
  }
  if (asked.empty() || !count || !seed) {
    std::fprintf(stderr, "bench_hidden_space STORY|all COUNT SEED [--verbose] [--right PERCENT]\n");
    return 2;
  }
  std::error_code error;
  loader::Plugins plugins;
  plugins.load(
      {(fs::read_symlink("/proc/self/exe", error).parent_path() / NONIO_PLUGINS_FROM_PROGRAM)
           .lexically_normal()});
  bool good = true;
  std::printf("seeds %llu .. %llu of each story (Wilson 95 %%)\n",
              static_cast<unsigned long long>(*seed),
              static_cast<unsigned long long>(*seed + *count - 1));
  for (const Story story : asked) {
    Score score;
    for (std::uint64_t k = *seed; k < *seed + *count; ++k)
      run(story, k, plugins.effects(), verbose, score);
    std::printf("%s\n", to_text(story));
    print("named first, or its alias group", score.found);
    print("  of these by an alias group", score.by_alias);
    print("nothing else beside it", score.nothing_else);
    print("complete model: nothing", score.complete);
    for (const auto& [name, tally] : score.of_effect) print("    " + name, tally);
    const double n = 2.0 * static_cast<double>(*count);
    std::printf("  CPU each %.0f ms in the mean, at most %.0f ms; %.0f readings\n",
                1e3 * score.cpu / n, 1e3 * score.most_cpu, score.readings / n);
    good = good && 100 * score.found.yes >= right * score.found.of;
  }
  if (!good)
    std::printf("wanted: at least %llu %% of each story\n", static_cast<unsigned long long>(right));
  return good ? 0 : 1;
}
