// SPDX-License-Identifier: Apache-2.0
// How well `explain` finds what the second generator (tests/support/hidden) has hidden:
//   bench_hidden KIND COUNT SEED
//                [--size PERCENT]
//                [--verbose] [--plugins FOLDER]
//                [--write FOLDER] [--right PERCENT] [--wrong PERCENT]
//                [--thermal PERCENT]: of linear axes with a thermal test, whose screw has so many %
//                of the time constant of the runs'
//                [--ar RHO] [--run-zero SIZE] [--walk SIZE] [--rough TIMES] [--digit SIZE]
// KIND is a name of hidden::Kind, with dashes. Sizes are in units of the noise and make it dependent
// (hidden::Unrest).
// Campaigns of seeds SEED .. SEED+COUNT-1. Follows `missing` as `nonio model explain --auto` does. Fails
// if fewer are right, or more named wrongly, than --right and --wrong say.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <filesystem>
#include <map>
#include <numeric>
#include <optional>
#include <string>
#include <utility>

#include "campaign/loader/plugins.h"
#include "hidden/generator.h"
#include "nonio/math/distributions.h"
#include "nonio/model/explain.h"
#include "nonio/sdk/format.h"
#include "tally.h"

namespace fs = std::filesystem;
using namespace nonio;
using bench::print, bench::Tally, bench::whole;
using hidden::Hidden;
using hidden::Kind;
using model::Verdict;

namespace {

constexpr int most_steps = 8;

struct Arguments {
  Kind kind = Kind::one;
  std::uint64_t count = 0, seed = 0;
  bool verbose = false;
  std::uint64_t size = 100;  ///< smallest: % of the printed smallest size
  fs::path plugins{}, write{};
  std::uint64_t least_right = 0, most_wrong = 100;  // %
  std::uint64_t thermal = 0;                        // %; 0: no test
  hidden::Unrest unrest{};
};

/// The number of the noise that an option names.
double* unrest_of(Arguments& a, const std::string& option) {
  const std::map<std::string, double*> all = {{"--ar", &a.unrest.correlation},
                                              {"--run-zero", &a.unrest.run_zero},
                                              {"--walk", &a.unrest.walk},
                                              {"--rough", &a.unrest.rough},
                                              {"--digit", &a.unrest.digit}};
  const auto at = all.find(option);
  return at == all.end() ? nullptr : at->second;
}

struct Step {
  model::Explanation said;
  double cpu = 0.0;                  ///< s
  std::vector<std::string> aliases;  ///< of the effect that the verdict names
};

struct LoopEnd {
  std::vector<Step> steps;         ///< never empty if `error` is
  std::vector<std::string> added;  ///< in order
  bool offered = true;             ///< the catalogue has all that is hidden, for these readings
  bool tested = false, stated = false;  ///< a thermal test gives a time constant; a term takes it
  std::string error;
};

double cpu_seconds() {
  std::timespec t{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
  return static_cast<double>(t.tv_sec) + 1e-9 * static_cast<double>(t.tv_nsec);
}

bool holds(const std::vector<std::string>& names, const std::string& name) {
  return std::find(names.begin(), names.end(), name) != names.end();
}

Expected<Step> step(const model::Part& part, const Machine& machine,
                    const std::vector<std::string>& names, const std::vector<Effect>& effects) {
  const auto terms = model::terms_of(part, machine, names, effects);
  if (!terms) return fail(terms.error());
  const auto all = model::catalogue(part, effects);
  const double before = cpu_seconds();
  auto said = model::explain(part, *terms, all);
  if (!said) return fail(said.error());
  Step done{std::move(*said), cpu_seconds() - before, {}};
  for (const model::Candidate& c : done.said.candidates)
    if (c.term.name() == done.said.verdict.effect) done.aliases = c.aliases;
  return done;
}

/// `thermal`: of the time constant, %; 0: no test.
std::vector<model::Part> parts_with(const Hidden& h, std::uint64_t thermal) {
  Campaign campaign = h.campaign;
  std::vector<Observations> read{h.table};
  if (thermal > 0 && !h.scenario.rotary) {
    Measurement m;
    m.id = "X-thermal", m.kind = "thermal", m.axis = "X";
    campaign.measurements.push_back(m);
    read.push_back(hidden::thermal_test(h.scenario, 0.01 * static_cast<double>(thermal)));
  }
  return model::parts_of(campaign, read);
}

LoopEnd follow(const Hidden& h, const std::vector<Effect>& effects, std::uint64_t thermal) {
  LoopEnd f;
  const auto parts = parts_with(h, thermal);
  if (parts.size() != 1) {
    f.error = "not one part";
    return f;
  }
  const auto offered = model::catalogue(parts[0], effects);
  f.tested = !parts[0].time_constants.empty() &&
             parts[0].time_constants[0].state == model::TimeConstant::State::known;
  for (const model::Term& term : offered) f.stated = f.stated || term.stated;
  for (const std::string& name : h.truth.hidden)
    f.offered = f.offered && std::any_of(offered.begin(), offered.end(),
                                         [&](const auto& term) { return term.name() == name; });
  std::vector<std::string> names = h.truth.model;
  while (f.added.size() <= most_steps) {
    auto next = step(parts[0], h.campaign.machine, names, effects);
    if (!next) {
      f.error = next.error().message;
      break;
    }
    f.steps.push_back(std::move(*next));
    const Verdict& verdict = f.steps.back().said.verdict;
    if (verdict.kind != Verdict::Kind::missing || holds(names, verdict.effect)) break;
    names.push_back(verdict.effect);
    f.added.push_back(verdict.effect);
  }
  return f;
}

const char* to_text(Verdict::Kind kind) {
  switch (kind) {
    case Verdict::Kind::missing:
      return "missing";
    case Verdict::Kind::nothing:
      return "nothing";
    case Verdict::Kind::unknown:
      return "unknown";
    case Verdict::Kind::unrepeatable:
      break;
  }
  return "unrepeatable";
}

/// Each hidden effect found by its name, or within the alias group that was said, and nothing else.
bool all_and_nothing_else(const Hidden& h, const LoopEnd& f) {
  std::vector<std::string> open = h.truth.hidden;
  for (std::size_t k = 0; k < f.added.size(); ++k) {
    const auto same = std::find(open.begin(), open.end(), f.added[k]);
    const auto alias = std::find_if(open.begin(), open.end(), [&](const std::string& name) {
      return holds(f.steps[k].aliases, name);
    });
    if (same != open.end())
      open.erase(same);
    else if (alias != open.end())
      open.erase(alias);
    else
      return false;
  }
  return open.empty();
}

/// Standard deviation of the noise that was drawn, of sound readings.
double drawn_noise(const Hidden& h) {
  std::vector<char> sound(h.table.size(), 1);
  for (const std::size_t row : h.misread) sound[row] = 0;
  double n = 0.0, mean = 0.0, square = 0.0;
  for (int pass = 0; pass < 2; ++pass)
    for (std::size_t i = 0; i < h.table.size(); ++i) {
      if (!sound[i]) continue;
      double e = h.table.deviation[i];
      for (const auto& cause : h.causes) e -= cause[i];
      if (pass == 0)
        n += 1.0, mean += e;
      else
        square += (e - mean / n) * (e - mean / n);
    }
  return std::sqrt(square / (n - 1.0));
}

/// The place named first; of what is unrepeatable only the verdict counts.
bool place_is_right(const Hidden& h, const model::Explanation& said) {
  if (h.truth.verdict == "unrepeatable") return true;
  if (said.fails.empty() || !holds(h.truth.places, to_text(said.fails.front().where))) return false;
  if (!h.truth.at || !said.fails.front().at) return true;
  const double reach = 0.5 * h.scenario.length / static_cast<double>(h.scenario.targets);
  return std::fabs(*said.fails.front().at - *h.truth.at) < reach;
}

struct Score {
  Tally certain,
      described;  ///< names said to be certain that are hidden; descriptions to the floor
  Tally answered, right, asked, kind, floor, wrong_name, place, alias, ends, noise, above_floor,
      values;
  Tally tested, stated, kept;  ///< thermal tests; terms that take it; fits that keep it
  Tally without_u;             ///< values whose u is not printed
  std::map<std::string, Tally> of_effect, of_value;
  std::map<std::string, Tally> named_of;                ///< outside: `missing`, by cause
  std::map<std::string, std::uint64_t> certain_beside;  ///< certain, and not hidden
  std::map<std::string, std::uint64_t> other_words;     ///< complete: verdicts but `nothing`
  double false_alarms = 0.0;
  double above_floor_expected = 0.0;  ///< sum of chances, of those in `above_floor`
  std::vector<double> cpu;            ///< of each explanation, s
  std::vector<double> cpu_of_210;     ///< of those with 200 to 220 readings
  std::uint64_t readings = 0, with_rate = 0;
  std::vector<std::uint64_t> failed;
};

void score_values(Score& score, const Hidden& h, const model::Fit& fit) {
  for (const hidden::TrueValue& truth : h.truth.values)
    for (const model::Parameter& p : fit.parameters) {
      if (p.effect != truth.effect || p.name != truth.name) continue;
      score.without_u.add(!std::isfinite(p.u));
      if (!std::isfinite(p.u)) continue;
      const bool in = std::fabs(p.value - truth.value) <= 2.0 * p.u;
      score.values.add(in);
      score.of_value[truth.effect.substr(0, truth.effect.find(':')) + " " + p.name].add(in);
    }
}

/// Chance that a model that holds all there is leaves an rms of at most `ratio` floors: its sum of
/// squares is that of the repeats, with f degrees of freedom, and an independent one with the rest
/// of the redundancy; their ratio is F distributed.
std::optional<double> chance_above_floor(const model::Comparison& c, double ratio) {
  double n = 0.0;
  for (const double w : c.fit.weight) n += w;
  const double f = c.floor->dof, rest = static_cast<double>(c.fit.redundancy) - f;
  if (!(rest >= 1.0)) return {};
  return 1.0 - math::f_upper((ratio * ratio * n - f) / rest, rest, f);
}

void score_fit(Score& score, const Hidden& h, const model::Comparison& c) {
  constexpr double near = 1.05;
  const double ratio = c.fit.s / drawn_noise(h);
  score.noise.add(ratio > 0.95 && ratio < 1.05);
  if (c.floor)
    if (const auto chance = chance_above_floor(c, near)) {
      score.above_floor.add(c.fit.rms <= near * c.floor->s);
      score.above_floor_expected += *chance;
    }
  if (c.floor) score.floor.add(std::fabs(c.floor->s - h.scenario.noise) <= 2.0 * c.floor->u);
  score_values(score, h, c.fit);
}

bool of_one(Kind kind) {
  return kind == Kind::one || kind == Kind::wave_under_curve || kind == Kind::grouped ||
         kind == Kind::fixed_end || kind == Kind::blank_temperatures || kind == Kind::day_wave ||
         kind == Kind::short_misread || kind == Kind::smallest;
}

bool is_complete(Kind kind) { return kind == Kind::complete || kind == Kind::short_complete; }

/// Whether the campaign was explained as it had to be.
bool judge(Score& score, const Hidden& h, const LoopEnd& f) {
  score.answered.add(f.error.empty());
  if (f.steps.empty()) return false;
  const model::Explanation &first = f.steps.front().said, &last = f.steps.back().said;
  const bool named = first.verdict.kind == Verdict::Kind::missing;
  bool right = false, wrong = named;
  for (const std::string& name : first.certain) {
    const bool there = holds(h.truth.hidden, name);
    score.certain.add(there);
    if (!there) ++score.certain_beside[name.substr(0, name.find(':'))];
  }
  if (!first.descriptions.empty() && first.comparison.floor)
    score.described.add(first.descriptions.back().rms <= 1.1 * first.comparison.floor->s);
  if (!is_complete(h.scenario.kind) && h.scenario.kind != Kind::outside) {
    const bool by_name = named && holds(h.truth.hidden, first.verdict.effect);
    const bool by_alias = named && std::any_of(h.truth.hidden.begin(), h.truth.hidden.end(),
                                               [&](const std::string& name) {
                                                 return holds(f.steps[0].aliases, name);
                                               });
    const bool all = all_and_nothing_else(h, f);
    right = of_one(h.scenario.kind) ? by_name || by_alias : all;
    // What the catalogue cannot offer for so few targets is asked for.
    const bool asked = !f.offered && first.verdict.kind == Verdict::Kind::unknown;
    if (h.scenario.kind == Kind::short_misread) {
      if (!f.offered) score.asked.add(asked);
      right = right || asked;
    }
    if (h.scenario.kind == Kind::beside)
      right = by_name || by_alias || holds(first.certain, h.truth.hidden.front());
    wrong = named && !by_name && !by_alias;
    score.alias.add(!by_name && by_alias);
    score.place.add(all);
    score.ends.add(last.verdict.kind == Verdict::Kind::nothing);
    for (const std::string& name : h.truth.hidden)
      score.of_effect[name.substr(0, name.find(':'))].add(
          of_one(h.scenario.kind) ? right : holds(f.added, name));
    std::vector<std::string> exact = f.added, wanted = h.truth.hidden;
    std::sort(exact.begin(), exact.end());
    std::sort(wanted.begin(), wanted.end());
    if (exact == wanted) score_fit(score, h, last.comparison);
  } else {
    right = to_text(first.verdict.kind) == h.truth.verdict;
    if (is_complete(h.scenario.kind)) {
      score_fit(score, h, first.comparison);
      // True words on what the runs show.
      const bool unsteady = h.scenario.unrest.run_zero > 0.0 || h.scenario.unrest.walk > 0.0;
      if (unsteady && first.verdict.kind == Verdict::Kind::unknown && !first.fails.empty() &&
          (first.fails.front().where == model::Where{model::Factor::run} ||
           first.fails.front().where == model::Where{model::Factor::time}))
        right = true;
      if (!right)
        ++score.other_words[std::string(to_text(first.verdict.kind)) + " " +
                            (named                 ? first.verdict.effect
                             : first.fails.empty() ? std::string()
                                                   : to_text(first.fails.front().where))];
      for (const std::string& name : h.truth.model)
        score.of_effect[name.substr(0, name.find(':'))].add(right);
    } else {
      const std::string cause = hidden::to_text(h.scenario.hidden.front().source);
      const bool listed = std::any_of(
          first.fails.begin(), first.fails.end(),
          [&](const model::Place& place) { return holds(h.truth.places, to_text(place.where)); });
      score.kind.add(right);
      if (h.truth.verdict == "unknown") score.place.add(right && listed);
      score.named_of[cause].add(named);
      right = right && place_is_right(h, first);
      score.of_effect[cause].add(right);
    }
  }
  score.right.add(right);
  score.wrong_name.add(wrong);
  return right;
}

/// What became of the time constant of a thermal test.
void score_thermal(Score& score, const LoopEnd& f) {
  score.tested.add(f.tested), score.stated.add(f.stated);
  if (!f.stated || f.steps.empty()) return;
  for (const model::Term& term : f.steps.back().said.comparison.fit.terms)
    if (term.stated) score.kept.add(model::has_stated(term));
}

std::string joined(const std::vector<std::string>& words) {
  std::string text;
  for (const std::string& w : words) text += (text.empty() ? "" : " ") + w;
  return text.empty() ? "-" : text;
}

void tell(const Hidden& h, const LoopEnd& f, std::uint64_t seed) {
  const hidden::Scenario& s = h.scenario;
  std::printf("seed %llu: %s, %zu%s targets, %u runs, %s%s%s, %zu misread\n",
              static_cast<unsigned long long>(seed), s.rotary ? "rotary" : "linear", s.targets,
              s.even ? " even" : "", s.runs, s.timed ? "times" : "no times",
              s.temperatures ? ", temperatures" : "", s.pitch_known ? ", period known" : "",
              h.misread.size());
  for (const auto* pieces : {&s.model, &s.hidden})
    for (const hidden::Piece& p : *pieces)
      std::printf("    %s %s (%s), %.1f\n", pieces == &s.model ? "model " : "hidden",
                  hidden::to_text(p.source), hidden::kind_of(p.source).c_str(), p.size);
  for (const Step& step : f.steps) {
    const model::Explanation& e = step.said;
    std::printf("  said %s %s; rms %.2f, floor %.2f, drawn %.2f of the noise\n",
                to_text(e.verdict.kind), e.verdict.effect.c_str(), e.comparison.fit.rms / s.noise,
                e.comparison.floor ? e.comparison.floor->s / s.noise : NAN,
                drawn_noise(h) / s.noise);
    std::printf("    together: %s\n", joined(e.together).c_str());
    for (std::size_t k = 0; k < std::min<std::size_t>(3, e.candidates.size()); ++k)
      std::printf("    %-20s score %8.1f p %.2g rms %.2f aliases %s\n",
                  e.candidates[k].term.name().c_str(), e.candidates[k].score, e.candidates[k].p,
                  e.candidates[k].rms / s.noise, joined(e.candidates[k].aliases).c_str());
    std::printf("    certain: %s\n", joined(e.certain).c_str());
    for (std::size_t k = 0; k < std::min<std::size_t>(3, e.fails.size()); ++k)
      std::printf("    left in %-24s share %.2f p %.2g\n", to_text(e.fails[k].where).c_str(),
                  e.fails[k].share, e.fails[k].p);
  }
  if (!f.error.empty()) std::printf("  error: %s\n", f.error.c_str());
}

void print_score(const Score& s, Kind kind) {
  print("answered without an error", s.answered);
  if (of_one(kind)) print("named first, or its alias group", s.right);
  print("  no effect for so few targets: asked", s.asked);
  if (!is_complete(kind) && kind != Kind::outside) {
    print("  of these by an alias group", s.alias);
    print("all found and nothing else", s.place);
    print("first verdict: missing, with a wrong name", s.wrong_name);
    print("ends with: nothing", s.ends);
  }
  if (kind == Kind::beside) print("named, by verdict or as certain", s.right);
  if (is_complete(kind)) {
    print("verdict: nothing; a zero that moves: or that it does", s.right);
    print("first verdict: missing, which is wrong", s.wrong_name);
  }
  for (const auto& [words, count] : s.other_words)
    std::printf("    %-40s %llu\n", words.c_str(), static_cast<unsigned long long>(count));
  if (kind == Kind::outside) {
    print("right verdict", s.kind);
    print("right verdict, and the right place named first", s.right);
    print("unknown, and the right place named anywhere", s.place);
    print("first verdict: missing, which is wrong", s.wrong_name);
  }
  print("certain names that are hidden", s.certain);
  for (const auto& [name, count] : s.certain_beside)
    std::printf("    not hidden: %-20s %llu\n", name.c_str(),
                static_cast<unsigned long long>(count));
  print("descriptions leave at most 1.1 floors", s.described);
  print("s within 5 % of the noise that was drawn", s.noise);
  print("rms at most 1.05 times the floor of the repeats", s.above_floor);
  if (s.above_floor.of > 0)
    std::printf("    of right models that is expected (F distribution) %12.2f %%\n",
                100.0 * s.above_floor_expected / static_cast<double>(s.above_floor.of));
  print("floor of the repeats within 2 u of the true noise", s.floor);
  if (s.tested.of > 0) {
    print("thermal test gives a time constant", s.tested);
    print("an effect takes it", s.stated);
    print("fits with such an effect that keep it", s.kept);
  }
  if (s.without_u.yes > 0) print("values whose u not printed", s.without_u);
  print("true value within 2 u", s.values);
  for (const auto& [name, tally] : s.of_value) print("    " + name, tally);
  std::printf(" by effect or cause\n");
  for (const auto& [name, tally] : s.of_effect) print("    " + name, tally);
  if (kind == Kind::outside) std::printf(" said to be missing, by cause\n");
  for (const auto& [name, tally] : s.named_of) print("    " + name, tally);
  std::vector<double> cpu = s.cpu;
  std::sort(cpu.begin(), cpu.end());
  if (!cpu.empty()) {
    const double n = static_cast<double>(cpu.size());
    std::printf(
        "  %zu explanations, %.0f readings in the mean, CPU each: mean %.1f ms, 95 %% below %.1f "
        "ms, "
        "at most %.1f ms\n",
        cpu.size(), static_cast<double>(s.readings) / n,
        1e3 * std::accumulate(cpu.begin(), cpu.end(), 0.0) / n, 1e3 * cpu[cpu.size() * 95 / 100],
        1e3 * cpu.back());
  }
  if (!s.cpu_of_210.empty())
    std::printf("  %zu of 200 to 220 readings: at most %.1f ms\n", s.cpu_of_210.size(),
                1e3 * *std::max_element(s.cpu_of_210.begin(), s.cpu_of_210.end()));
  if (s.with_rate > 0)
    std::printf("  printed false-alarm rate in the mean: %.4f\n",
                s.false_alarms / static_cast<double>(s.with_rate));
  if (!s.failed.empty()) {
    std::printf("  failed seeds:");
    for (const std::uint64_t seed : s.failed)
      std::printf(" %llu", static_cast<unsigned long long>(seed));
    std::printf("\n");
  }
}

/// The same campaign with its hidden effect of the size that `explain` prints as the smallest that
/// it would find, seeing the noise alone; without it where it is no candidate.
hidden::Scenario as_small_as_printed(hidden::Scenario s, const std::vector<Effect>& effects,
                                     std::uint64_t percent) {
  const std::vector<hidden::Piece> wanted = std::exchange(s.hidden, {});
  const Hidden empty = hidden::generate(s);
  const auto parts = model::parts_of(empty.campaign, {empty.table});
  const auto said = step(parts[0], empty.campaign.machine, {}, effects);
  if (!said) return s;
  for (const model::Candidate& c : said->said.candidates)
    if (c.visible && c.term.effect->info.name == hidden::kind_of(wanted[0].source)) {
      s.hidden = wanted;
      s.hidden[0].size = 0.01 * static_cast<double>(percent) * c.minimal_detectable / s.noise;
    }
  return s;
}

std::optional<Arguments> arguments(const std::vector<std::string>& words) {
  const std::map<std::string, Kind> kinds = {{"one", Kind::one},
                                             {"several", Kind::several},
                                             {"complete", Kind::complete},
                                             {"outside", Kind::outside},
                                             {"wave-under-curve", Kind::wave_under_curve},
                                             {"screw-and-curve", Kind::screw_and_curve},
                                             {"grouped", Kind::grouped},
                                             {"beside", Kind::beside},
                                             {"fixed-end", Kind::fixed_end},
                                             {"blank-temperatures", Kind::blank_temperatures},
                                             {"day-wave", Kind::day_wave},
                                             {"short-misread", Kind::short_misread},
                                             {"short-complete", Kind::short_complete},
                                             {"smallest", Kind::smallest}};
  if (words.size() < 3 || kinds.count(words[0]) == 0) return {};
  const auto count = whole(words[1]), seed = whole(words[2]);
  if (!count || !seed) return {};
  Arguments a;
  a.kind = kinds.at(words[0]), a.count = *count, a.seed = *seed;
  std::error_code error;
  a.plugins = fs::read_symlink("/proc/self/exe", error).parent_path() / NONIO_PLUGINS_FROM_PROGRAM;
  for (std::size_t i = 3; i < words.size(); ++i) {
    if (words[i] == "--verbose")
      a.verbose = true;
    else if (words[i] == "--plugins" && i + 1 < words.size())
      a.plugins = words[++i];
    else if (words[i] == "--write" && i + 1 < words.size())
      a.write = words[++i];
    else if (words[i] == "--thermal" && i + 1 < words.size() && whole(words[i + 1]))
      a.thermal = *whole(words[++i]);
    else if (words[i] == "--size" && i + 1 < words.size() && whole(words[i + 1]))
      a.size = *whole(words[++i]);
    else if ((words[i] == "--right" || words[i] == "--wrong") && i + 1 < words.size()) {
      const auto percent = whole(words[i + 1]);
      if (!percent) return {};
      (words[i] == "--right" ? a.least_right : a.most_wrong) = *percent;
      ++i;
    } else if (double* size = unrest_of(a, words[i]); size != nullptr && i + 1 < words.size()) {
      *size = std::strtod(words[++i].c_str(), nullptr);
    } else
      return {};
  }
  return a;
}

}  // namespace

int main(int argc, char** argv) {
  const auto a = arguments({argv + 1, argv + argc});
  if (!a) {
    std::fprintf(stderr,
                 "bench_hidden one|several|complete|outside|wave-under-curve|screw-and-curve|\n    "
                 "         grouped|beside|fixed-end|blank-temperatures|day-wave|short-misread|\n"
                 "             short-complete|smallest COUNT SEED\n"
                 "             [--verbose] [--plugins FOLDER] [--write FOLDER] [--right PERCENT] "
                 "[--wrong PERCENT]\n"
                 "             [--thermal PERCENT]\n"
                 "             [--ar RHO] [--run-zero SIZE] [--walk SIZE] [--rough TIMES] "
                 "[--digit SIZE]\n");
    return 2;
  }
  loader::Plugins plugins;
  plugins.load({a->plugins.lexically_normal()});
  if (plugins.effects().empty()) {
    std::fprintf(stderr, "bench_hidden: no effect in %s\n", a->plugins.c_str());
    return 2;
  }
  Score score;
  for (std::uint64_t seed = a->seed; seed < a->seed + a->count; ++seed) {
    hidden::Scenario scenario = hidden::random_scenario(a->kind, seed);
    scenario.unrest = a->unrest;
    if (a->kind == Kind::smallest)
      scenario = as_small_as_printed(std::move(scenario), plugins.effects(), a->size);
    if (a->kind == Kind::smallest && scenario.hidden.empty()) continue;
    const Hidden h = hidden::generate(scenario);
    if (!a->write.empty()) {
      const fs::path folder = a->write / h.campaign.id;
      if (const auto done = hidden::write(h, folder, folder.string() + ".truth.json"); !done) {
        std::fprintf(stderr, "bench_hidden: %s\n", done.error().message.c_str());
        return 1;
      }
    }
    const LoopEnd f = follow(h, plugins.effects(), a->thermal);
    if (a->thermal > 0 && !scenario.rotary) score_thermal(score, f);
    const bool right = judge(score, h, f);
    for (const Step& s : f.steps) {
      score.cpu.push_back(s.cpu);
      if (h.table.size() >= 200 && h.table.size() <= 220) score.cpu_of_210.push_back(s.cpu);
      score.readings += h.table.size();
      if (s.said.verdict.trials == 0) continue;
      score.false_alarms += s.said.verdict.false_alarms, ++score.with_rate;
    }
    if (!right) score.failed.push_back(seed);
    if (!right && a->verbose) tell(h, f, seed);
  }
  std::printf("seeds %llu .. %llu (Wilson 95 %%)\n", static_cast<unsigned long long>(a->seed),
              static_cast<unsigned long long>(a->seed + a->count - 1));
  print_score(score, a->kind);
  const bool good = 100 * score.right.yes >= a->least_right * score.right.of &&
                    100 * score.wrong_name.yes <= a->most_wrong * score.wrong_name.of;
  if (!good)
    std::printf("wanted: at least %llu %% right, at most %llu %% with a wrong name\n",
                static_cast<unsigned long long>(a->least_right),
                static_cast<unsigned long long>(a->most_wrong));
  return good ? 0 : 1;
}
