// SPDX-License-Identifier: Apache-2.0
// How right and how fast the statistics of a history are: bench_history_statistics [TRIALS]
// [SERIES.csv]
//
// Rates over simulated histories of made-up machines (seed printed). With SERIES.csv: writes the
// series that were timed, and what was made of them, for a peer (bench/history_statistics.py).
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <functional>
#include <random>
#include <string>

#include "laboratory/statistics/forecast.h"
#include "laboratory/statistics/trend.h"

namespace {

namespace history = nonio::statistics;
using nonio::statistics::Series, nonio::statistics::Trend, nonio::statistics::Model;

constexpr unsigned seed = 20261126;
constexpr double u = 0.3, years = 0.5, next_in = 0.5;

/// What a machine is at each campaign, and one interval later.
using Truth = std::function<std::vector<double>(std::size_t, std::mt19937_64&)>;

struct Kind {
  const char* name;
  std::size_t campaigns;
  Truth truth;
  std::vector<nonio::statistics::Declared> declared{};
  bool slope = false;  ///< that of the last segment is known: 1 per year
};

double normal(std::mt19937_64& random) { return std::normal_distribution<double>()(random); }

Truth of_time(std::function<double(std::size_t, double)> f) {
  return [f](std::size_t n, std::mt19937_64&) {
    std::vector<double> out;
    for (std::size_t i = 0; i <= n; ++i) out.push_back(f(i, years * static_cast<double>(i)));
    return out;
  };
}

std::vector<double> walk(std::size_t n, std::mt19937_64& random, double q) {
  std::vector<double> out{0.0};
  for (std::size_t i = 1; i <= n; ++i)
    out.push_back(out.back() + std::sqrt(q * years) * normal(random));
  return out;
}

Series observed(const Kind& kind, const std::vector<double>& truth, std::mt19937_64& random) {
  Series s;
  s.seed = random();
  s.declared = kind.declared;
  for (std::size_t i = 0; i < kind.campaigns; ++i)
    s.points.push_back({years * static_cast<double>(i), truth[i] + u * normal(random), u});
  return s;
}

void run(const Kind& kind, int trials) {
  std::mt19937_64 random(seed);
  int news = 0, drifts = 0, walks = 0, state = 0, reading = 0, slope = 0;
  for (int i = 0; i < trials; ++i) {
    const auto truth = kind.truth(kind.campaigns, random);
    const Series s = observed(kind, truth, random);
    const auto t = nonio::statistics::trend_of(s);
    if (!t) std::exit(1);
    news += t->model == Model::step, drifts += t->model == Model::drift;
    walks += t->model == Model::walk;
    const auto f = nonio::statistics::forecast(s, *t, s.points.back().time + next_in, std::nullopt);
    const double is = truth.back(), read = is + u * normal(random);
    state += std::fabs(is - f.value) < 1.959964 * f.u;
    reading += std::fabs(read - f.value) < 1.959964 * f.u_reading;
    const auto& last = t->segments.back();
    slope += last.u_slope > 0.0 && std::fabs(last.slope - 1.0) < 1.959964 * last.u_slope;
  }
  const auto percent = [&](int n) { return 100.0 * n / trials; };
  std::printf("%-34s %3zu %6.2f %6.2f %6.2f %8.2f %8.2f", kind.name, kind.campaigns, percent(news),
              percent(drifts), percent(walks), percent(state), percent(reading));
  if (kind.slope) std::printf(" %8.2f", percent(slope));
  std::printf("\n");
  std::fflush(stdout);
}

void time_them(int count, const char* file) {
  std::mt19937_64 random(seed + 1);
  const Kind quiet{"", 12, of_time([](std::size_t, double) { return 0.0; })};
  std::vector<Series> all;
  for (int i = 0; i < count; ++i) all.push_back(observed(quiet, quiet.truth(12, random), random));
  std::vector<Trend> trends;
  const auto begin = std::chrono::steady_clock::now();
  for (const Series& s : all) trends.push_back(*nonio::statistics::trend_of(s));
  const std::chrono::duration<double> took = std::chrono::steady_clock::now() - begin;
  std::printf("%d series of 12 campaigns: %.3f s\n", count, took.count());
  if (file == nullptr) return;
  std::ofstream out(file);
  out.precision(17);
  for (std::size_t i = 0; i < all.size(); ++i) {
    for (const auto& p : all[i].points) out << p.time << ',' << p.value << ',' << p.u << ',';
    const Trend& t = trends[i];
    out << static_cast<int>(t.model) << ',' << t.chi2 << ','
        << (t.changes.empty() ? -1 : static_cast<int>(t.changes[0].after)) << '\n';
  }
}

}  // namespace

int main(int argc, char** argv) {
  const int trials = argc > 1 ? std::atoi(argv[1]) : 10000;
  if (trials < 1) return 2;
  std::printf("seed %u, %d histories each, half-yearly, u %g; in %%\n", seed, trials, u);
  std::printf("%-34s %3s %6s %6s %6s %8s %8s %8s\n", "", "n", "step", "drift", "walk", "state",
              "reading", "slope");
  const nonio::statistics::Declared event{5, nonio::statistics::Declared::Kind::event};
  for (const std::size_t n : {4U, 6U, 8U, 12U})
    run({"quiet", n, of_time([](std::size_t, double) { return 1.0; })}, trials);
  run({"wear, 1 a year", 8, of_time([](std::size_t, double t) { return t; }), {}, true}, trials);
  run({"wear, 1 a year", 12, of_time([](std::size_t, double t) { return t; }), {}, true}, trials);
  run({"repair of 2",
       10,
       of_time([](std::size_t i, double) { return i > 5 ? 2.0 : 0.0; }),
       {event}},
      trials);
  run({"wear and a repair of -2",
       10,
       of_time([](std::size_t i, double t) { return t - (i > 5 ? 2.0 : 0.0); }),
       {event},
       true},
      trials);
  for (const double k : {3.0, 4.0, 6.0})
    run({"step of 3, 4, 6 u, not declared", 10,
         of_time([k](std::size_t i, double) { return i > 5 ? k * u : 0.0; })},
        trials);
  run({"crash of 6 u and repair", 16,
       of_time([](std::size_t i, double) { return i > 5 && i < 11 ? 6 * u : 0.0; })},
      trials);
  for (const std::size_t n : {10U, 15U, 25U})
    run({"walk, q = 1 a year", n,
         [](std::size_t m, std::mt19937_64& random) { return walk(m, random, 1.0); }},
        trials);
  time_them(2000, argc > 2 ? argv[2] : nullptr);
}
