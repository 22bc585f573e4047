// SPDX-License-Identifier: Apache-2.0
//
// How often U covers the truth (JCGM 101: propagation of distributions): campaigns whose readings
// come about from physical causes (bench/coverage/shop.h), evaluated by the plugins as they were built.
//
//     nonio_coverage [--trials N] [--seed S] [--only TEXT] [--check]
//
// Prints the share of results within U of the truth, with its 95 % interval. --check: status 1 if a
// share that should lie in 94 to 96 % does not.
#include <dlfcn.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <stdexcept>

#include "coverage/coverage.h"

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

Analysis load(const char* path) {
  struct Taker final : Registry {
    Analysis analysis;
    void add(Reader) override {}
    void add(Effect) override {}
    void add(Analysis a) override { analysis = std::move(a); }
    void add(Output) override {}
  } taker;
  void* library = dlopen(path, RTLD_NOW | RTLD_LOCAL);
  if (library == nullptr) throw std::runtime_error(dlerror());
  static_cast<const PluginEntry*>(dlsym(library, "nonio_plugin"))->add_to(taker);
  return taker.analysis;
}

Settings defaults(const Analysis& a) {
  Settings s;
  for (const Option& o : a.info.options) s.values[o.name] = o.otherwise;
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
  bool check = false;
};

Tally run(const Method& m, const Scenario& s, const Wish& wish, int trials, double size) {
  Tally tally;
  for (int t = 0; t < trials; ++t) {
    m.trial(s, wish.seed + 7919U * static_cast<unsigned>(t), size, tally);
    tally.end_of_campaign();
  }
  return tally;
}

bool print(const Method& m, const Scenario& s, const Tally& tally) {
  bool good = true;
  std::string line = std::string("| ") + m.name + " | " + s.name + " |";
  for (const auto& [name, share] : tally.shares()) {
    char text[80];
    const bool low = share.percent + share.half < 94.0, high = share.percent - share.half > 96.0;
    std::snprintf(text, sizeof text, " %s %.1f+-%.1f%s", name.c_str(), share.percent, share.half,
                  low ? " LOW" : high ? " high" : "");
    line += text;
    good = good && !low && !high;
  }
  std::printf("%s |\n", line.c_str());
  std::fflush(stdout);
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
  std::printf("seed %u, %d campaigns each\n", wish.seed, wish.trials);
  bool good = true;
  for (const auto* methods : {&axis_methods, &line_methods, &rotary_methods})
    for (const Method& m : *methods) {
      for (const auto& [name, share] : run(m, scenarios().front(), wish, 1, 1e-3).shares())
        if (share.worst > 3e-9) std::printf("%s, without errors: %s %.3g\n", m.name, name.c_str(), share.worst);
      for (const Scenario& s : scenarios())
        if ((std::string(m.name) + ", " + s.name).find(wish.only) != std::string::npos)
          good = print(m, s, run(m, s, wish, wish.trials, 1.0)) && good;
    }
  return wish.check && !good ? 1 : 0;
}
