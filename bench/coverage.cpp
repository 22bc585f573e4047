// SPDX-License-Identifier: Apache-2.0
//
// How often U covers the truth (JCGM 101: propagation of distributions): campaigns whose readings
// come about from physical causes (bench/coverage/shop.h), evaluated by the plugins as they were
// built.
//
//     nonio_coverage [--trials N] [--seed S] [--only TEXT] [--check]
//
// Prints the share of results within U of the truth, with its 95 % interval. --check: status 1 if
// one is outside 94 to 96 % by more than its interval, and is none of the exceptions, each with its
// reason (bench/coverage/exceptions.cpp).
#include "coverage/coverage.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <stdexcept>
#include <thread>

namespace nonio::coverage {

void Tally::put(const std::string& name, double error, double U) {
  Sums& of = sums_[name];
  of.in += std::fabs(error) <= U ? 1.0 : 0.0;
  of.all += 1.0;
  of.worst = std::max(of.worst, std::fabs(error));
}

void Tally::end_of_campaign() {
  for (auto& [name, of] : sums_) {
    if (of.all == 0.0) continue;
    const double share = of.in / of.all;
    of.sum += share;
    of.squares += share * share;
    ++of.campaigns;
    of.in = of.all = 0.0;
  }
}

std::map<std::string, Tally::Share> Tally::shares() const {
  std::map<std::string, Share> out;
  for (const auto& [name, of] : sums_) {
    const double n = static_cast<double>(of.campaigns), mean = of.sum / n,
                 variance = std::max(0.0, of.squares / n - mean * mean);
    // Not below that of one trial in n: 100 % of them is no proof of 100 %.
    out[name] = {100.0 * mean, 196.0 * std::sqrt(std::max(variance, 1.0 / n) / n), of.worst,
                 of.campaigns};
  }
  return out;
}

Settings defaults(const Analysis& a) {
  Settings s;
  for (const Option& o : a.info.options) s.values[o.name] = o.default_value;
  return s;
}

Measurement named(const std::string& id, const std::string& kind, const std::string& axis) {
  Measurement m;
  m.id = id;
  m.kind = kind;
  m.axis = axis;
  return m;
}

Evaluation evaluated(const Analysis& analysis, const Campaign& c, std::size_t i,
                     const std::vector<Observations>& all, const Settings& settings) {
  auto e = analysis.analyse({c, c.measurements[i], all[i], settings, &all});
  if (!e) throw std::runtime_error(e.error().message);
  return *e;
}

}  // namespace nonio::coverage

namespace {

using namespace nonio::coverage;

struct Wish {
  int trials = 2000;
  unsigned seed = 20261122;
  std::string only;
  bool check = false, all = false;
};

/// One method in one scenario.
struct Job {
  const Method* method = nullptr;
  const Scenario* scenario = nullptr;
  std::map<std::string, Tally::Share> shares{}, exactly{};
};

std::map<std::string, Tally::Share> run(const Job& job, const Wish& wish, int trials, double size) {
  Tally tally;
  for (int t = 0; t < trials; ++t) {
    job.method->trial(*job.scenario, wish.seed + 7919U * static_cast<unsigned>(t), size, tally);
    tally.end_of_campaign();
  }
  return tally.shares();
}

std::vector<Job> jobs(const Wish& wish) {
  std::vector<Job> out;
  for (const auto* methods : {&axis_methods, &line_methods, &rotary_methods})
    for (const Method& m : *methods)
      for (const Scenario& s : scenarios())
        if ((std::string(m.name) + ", " + s.name).find(wish.only) != std::string::npos)
          out.push_back({&m, &s});
  return out;
}

void run_all(std::vector<Job>& all, const Wish& wish) {
  std::atomic<std::size_t> next{0};
  std::vector<std::thread> threads;
  for (unsigned i = 0; i < 2; ++i)
    threads.emplace_back([&] {
      for (std::size_t k = next++; k < all.size(); k = next++) {
        all[k].exactly = run(all[k], wish, 1, 1e-4);
        all[k].shares = run(all[k], wish, wish.trials / all[k].method->every, 1.0);
      }
    });
  for (std::thread& t : threads) t.join();
}

/// What a share is: within 94 to 96 %, as far as so many trials tell; or why it is not.
struct Verdict {
  bool good = true;
  std::string mark;
  const Exception* exception = nullptr;
};

Verdict judge(const Job& job, const std::string& name, const Tally::Share& share) {
  const bool low = share.percent + share.half<94.0, high = share.percent - share.half> 96.0;
  if (!low && !high) return {};
  for (const Exception& e : exceptions())
    if (e.holds(*job.method, *job.scenario, name) && (e.less || !low))
      return {true, std::string(1, e.letter), &e};
  return {false, low ? "TOO LOW" : "TOO HIGH", nullptr};
}

bool print(const Job& job, std::map<char, const Exception*>& used) {
  bool good = true;
  std::string line = std::string("| ") + job.method->name + " | " + job.scenario->name + " |";
  std::size_t trials = 0;
  for (const auto& [name, share] : job.shares) {
    const Verdict v = judge(job, name, share);
    char text[96];
    std::snprintf(text, sizeof text, "%s %s %.1f (%.1f)%s%s", line.back() == '|' ? "" : ",",
                  name.c_str(), share.percent, share.half, v.mark.empty() ? "" : " ",
                  v.mark.c_str());
    line += text;
    good = good && v.good;
    if (v.exception != nullptr) used[v.exception->letter] = v.exception;
    trials = std::max(trials, share.trials);
  }
  std::printf("%s |\n", line.c_str());
  for (const auto& [name, share] : job.exactly)
    if (share.worst > 1e-8) {
      std::printf("without errors the truth of %s is missed by %.3g\n", name.c_str(), share.worst);
      good = false;
    }
  return good;
}

}  // namespace

int main(int argc, char** argv) {
  Wish wish;
  for (int i = 1; i < argc; ++i) {
    if (std::strcmp(argv[i], "--check") == 0) wish.check = true;
    if (std::strcmp(argv[i], "--trials") == 0 && i + 1 < argc) wish.trials = std::atoi(argv[++i]);
    if (std::strcmp(argv[i], "--only") == 0 && i + 1 < argc) wish.only = argv[++i];
    if (std::strcmp(argv[i], "--seed") == 0 && i + 1 < argc)
      wish.seed = static_cast<unsigned>(std::atoi(argv[++i]));
  }
  std::printf(
      "Seed %u, %d campaigns each (least squares: a quarter). Share of results within U of the "
      "truth in %%, half width of its\n"
      "95 %% interval in parentheses; a letter: not in 94 to 96 %%, for the reason below.\n\n"
      "| method | scenario | within U |\n| --- | --- | --- |\n",
      wish.seed, wish.trials);
  std::vector<Job> all = jobs(wish);
  run_all(all, wish);
  bool good = !all.empty();
  std::map<char, const Exception*> used;
  for (const Job& job : all) good = print(job, used) && good;
  std::printf("\n");
  for (const auto& [letter, e] : used) std::printf("%c: %s\n", letter, e->reason);
  return wish.check && !good ? 1 : 0;
}
