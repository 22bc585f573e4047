// SPDX-License-Identifier: Apache-2.0
#include "verdict.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <numbers>
#include <numeric>
#include <random>

#include "data/noise.h"
#include "fit/compare.h"
#include "fit/places.h"
#include "nonio/math/distributions.h"
#include "nonio/sdk/axis_readings.h"
#include "passes.h"
#include "plans.h"
#include "scatter.h"

namespace nonio::model {

namespace {

// Largest structure at the places of a significant effect, as a share of the mean square of the
// contribution of the effect: docs/dev/constants.md, M7.
constexpr double certain_share = 0.06;
// Far above chance, because residuals are not independent noise: docs/dev/constants.md, M8.
constexpr double certain_evidence = 50.0;
// Largest share of the evidence from one target, or from one pass: docs/dev/constants.md, M9.
constexpr double most_of_one_target = 0.3;
constexpr double most_of_one_pass = 0.5;
// Effects of the printed smallest size would otherwise be rejected: docs/dev/constants.md, M29.
constexpr double least_against_zero = 30.0;
// Largest share of the RMS that a named effect leaves as the first addition, so that the printed
// RMS falls: docs/dev/constants.md, M51.
constexpr double falls_to = 0.999;
// Two effects with a correlation below minus this value cancel: docs/dev/constants.md, M10.
constexpr double cancels_beyond = 0.95;

class Judge {
 public:
  Judge(const Finding& finding, double rms_of_model, Explanation& out)
      : f_(finding), rms_of_model_(rms_of_model), out_(out) {}

  void run() {
    Verdict& v = out_.verdict;
    count_false_alarms(v);
    v.false_alarms = std::max(v.false_alarms, passes_.alarms());
    v.suspects_share =
        static_cast<double>(f_.suspects.size()) / static_cast<double>(f_.part.table.size());
    for (const Place& place : f_.of_model.places)
      if (place.p < place_p) out_.fails.push_back(place);
    for (const std::string& name : passes_.of_any_order()) std::erase(out_.together, name);
    std::stable_partition(out_.together.begin(), out_.together.end(),
                          [&](const std::string& name) { return lowers(name); });
    const double least = least_serious(f_.of_best.floor);
    // If the search treated zeros of passes as noise, the tests of effects and places do so, too.
    const bool searched = f_.noise.zero == Noise::Zero::of_pass;
    std::vector<Place> left = Judge::serious(f_.of_best.places, least);
    // A place that is not significant if zeros of passes scatter does not decide the verdict, but
    // can still make an effect doubtful.
    std::vector<Place> serious =
        passes_.scatter()
            ? Judge::serious(passes_.places(f_.of_best.fit.residual, f_.of_best.floor, least),
                             least)
            : left;
    if (searched) left = serious;
    const Noise::Zero zero = unsteady_zero();
    const bool walks = zero != Noise::Zero::steady;
    if (contradictory(zero)) {
      v.kind = Verdict::Kind::unrepeatable;
      return;
    }
    const bool scatter_found = passes_.scatter() && !searched;
    // If zeros of passes explain the effects as well, there is no evidence of a cause.
    if (scatter_found && !walks &&
        std::none_of(out_.together.begin(), out_.together.end(),
                     [&](const std::string& name) { return passes_.shows(name); }))
      out_.together.clear();
    find_one_growth();
    find_cancelling();
    list_certain(left, walks);
    if (auto place = of_targets(); place && serious.empty()) serious.push_back(std::move(*place));
    const bool of_passes =
        scatter_found && !out_.together.empty() && !passes_.shows(out_.together.front());
    if (!out_.together.empty() && !walks && !of_passes && !of_one_pass(out_.together.front()) &&
        !cancels(out_.together.front()) && !with_cancelling(out_.together.front()) &&
        !in_doubt(out_.together.front(), left, unexplained_share) &&
        lowers(out_.together.front()) &&
        std::none_of(out_.together.begin(), out_.together.end(),
                     [&](const std::string& name) { return is_single(name); })) {
      v.kind = Verdict::Kind::missing;
      v.effect = out_.together.front();
    }
    if (v.kind == Verdict::Kind::missing) {
      out_.explains_all = serious.empty() && !lacks_fit();
      lift(v.effect);
    } else if (walks || !out_.together.empty() || !serious.empty() || !out_.cancelling.empty() ||
               lacks_fit()) {
      v.kind = Verdict::Kind::unknown;
      if (!out_.cancelling.empty()) plan_for_cancelling();
      if (auto seats = seats_in(f_.part, f_.repeats, f_.of_model); !seats.empty())
        out_.fails = std::move(seats);
      else if (!serious.empty() || !left.empty())
        out_.fails = serious.empty() ? left : std::move(serious);
      if (zero == Noise::Zero::of_run) tell_runs();
    } else if (below_scatter()) {
      v.kind = Verdict::Kind::unknown;
      v.below_scatter = true;
    }
  }

 private:
  /// Whether cells differ from the best explanation significantly and by more than `least_serious`,
  /// compared with the scatter of their repeats. Terms that the passes of a side share are tested
  /// as places instead. False if the floor has fewer than 8 degrees of freedom.
  bool lacks_fit() const {
    if (!f_.of_best.floor || !(f_.of_best.floor->dof >= 8.0)) return false;
    const std::vector<double> weight = with_scatter(f_.weight, f_.noise);
    const std::vector<double>& e = f_.of_best.fit.residual;
    const Saturated all = saturate(f_.repeats, e, weight);
    Repeats passes = f_.repeats;
    passes.cell = passes.pass;
    passes.cells = passes.passes;
    const Saturated within = saturate(passes, e, weight);
    const double s2 = f_.of_best.floor->s * f_.of_best.floor->s;
    // Correct for the number of independent squares if adjacent readings are correlated.
    const double of_dof = f_.of_best.floor->dof / all.dof;
    const double excess = within.squares - all.squares;
    const double dof = degrees_of_cells(f_.repeats, f_.weight);
    if (!(dof * of_dof >= 1.0)) return false;
    const double F = math::test_ratio(excess / dof, s2);
    return math::f_upper(F, dof * of_dof, f_.of_best.floor->dof) < lacks_fit_p &&
           std::sqrt(std::max(excess - dof * s2, 0.0) / static_cast<double>(e.size())) >
               least_serious(f_.of_best.floor);
  }

  /// Whether residuals are significantly smaller than the noise floor; false if the floor is not
  /// above the last digit of the readings.
  bool below_scatter() const {
    const Fit& fit = f_.of_best.fit;
    if (!f_.of_best.floor || fit.redundancy == 0 || f_.of_best.floor->s <= f_.noise.digit)
      return false;
    const auto redundancy = static_cast<double>(fit.redundancy);
    const NoiseFloor& floor = *f_.of_best.floor;
    // correlation increases the uncertainty of the floor
    const double dof = 0.5 * std::pow(floor.s / floor.u, 2);
    return math::f_upper(std::pow(math::test_ratio(floor.s, fit.s), 2), dof, redundancy) <
           lacks_fit_p;
  }

  /// Without effects: whether targets differ significantly once a possible outlier is omitted.
  std::optional<Place> of_targets() const {
    if (!out_.together.empty()) return std::nullopt;
    auto place =
        next_to_a_misread_target(f_.part.table, f_.repeats, f_.of_best.fit.residual, f_.weight);
    if (!place || !(place->p < serious_p)) return std::nullopt;
    return place;
  }

  /// A random zero, if it explains the readings better than the best set of effects, alone or in
  /// place of the first effect. Otherwise, or without effects, with zeros of passes as noise, or
  /// with less evidence than `least_against_zero`, `steady`.
  Noise::Zero unsteady_zero() const {
    if (out_.together.empty() || f_.noise.zero != Noise::Zero::steady) return Noise::Zero::steady;
    // A circle takes seconds, too short for a random walk of the zero; what its effects leave, such
    // as reversal spikes, is smooth in its order.
    if (is_circle_without_times(f_.part.table)) return Noise::Zero::steady;
    const Noise::Zero instead = better_zero(f_.of_model.fit.terms, f_.start);
    if (instead != Noise::Zero::steady) return instead;
    const std::string& name = out_.together.front();
    std::vector<Term> terms = f_.of_best.fit.terms;
    std::erase_if(terms, [&](const Term& t) { return t.name() == name; });
    return better_zero(terms, f_.bench->without(f_.best, f_.index_of(name)));
  }

  Noise::Zero better_zero(const std::vector<Term>& terms, const Workbench::State& state) const {
    const Unsteady with_terms = f_.walk_with(terms);
    const double own = f_.best.criterion - state.price - f_.price_of_zero();
    const double evidence = state.criterion - f_.best.criterion;
    if (evidence < least_against_zero) return Noise::Zero::steady;
    if (with_terms.of_run < std::min(with_terms.walks, own + as_good_as(evidence)))
      return Noise::Zero::of_run;
    return with_terms.walks < own ? Noise::Zero::walks : Noise::Zero::steady;
  }

  /// Margin by which the criterion with zeros of runs may be larger if they are still preferred. It
  /// is small for a small effect, which possible zeros must not replace; a large effect would leave
  /// much larger residuals with them.
  static double as_good_as(double evidence) {
    // docs/dev/constants.md, M30.
    constexpr double share = 0.1;
    return std::clamp(share * evidence, 0.0, alias_evidence);
  }

  /// Whether the effect has evidence even if the zero is random (a random walk, or one zero of each
  /// run).
  bool walk_with(const std::string& name) const {
    std::vector<Term> terms = f_.of_model.fit.terms;
    const double without = f_.walk_with(terms).least();
    double price = 0.0;
    for (std::size_t t = 0; t < f_.of_best.fit.terms.size(); ++t)
      if (f_.of_best.fit.terms[t].name() == name) {
        const Workbench::Block& block = f_.bench->blocks()[f_.best.blocks[t]];
        price = f_.bench->price(block);
        terms.push_back(f_.of_best.fit.terms[t]);
      }
    return without - f_.walk_with(terms).least() - price > certain_evidence;
  }

  /// Whether a place in `serious` shares a factor with the effect and has more than `share` of the
  /// mean square of the effect, which may then be only the most similar one in the catalog.
  bool in_doubt(const std::string& name, const std::vector<Place>& serious, double share) const {
    for (std::size_t t = 0; t < f_.of_best.fit.terms.size(); ++t) {
      if (f_.of_best.fit.terms[t].name() != name) continue;
      // Effects that cancel each other may both be large, so the contribution alone is used.
      const double rms2 =
          (f_.bench->without(f_.best, f_.index_of(name)).squares - f_.best.squares) /
          f_.bench->readings();
      const auto works_in = places_of(f_.of_best.fit.part[t]);
      for (const Place& place : serious)
        for (const Where& where : works_in)
          if (same_factor(place.where, where) && place.rms * place.rms > share * rms2) return true;
    }
    return false;
  }

  const Candidate& candidate(const std::string& name) const {
    return *std::find_if(out_.candidates.begin(), out_.candidates.end(),
                         [&](const Candidate& c) { return c.term.name() == name; });
  }

  bool lowers(const std::string& name) const {
    return candidate(name).rms < falls_to * rms_of_model_;
  }

  const std::vector<double>* part_of(const std::string& name) const {
    const Fit& fit = f_.of_best.fit;
    for (std::size_t t = 0; t < fit.terms.size(); ++t)
      if (fit.terms[t].name() == name) return &fit.part[t];
    return nullptr;
  }

  /// Returns the correlation of the predictions of two effects, without the zeros of lines.
  double correlation(const std::string& one, const std::string& other) const {
    const auto *a = part_of(one), *b = part_of(other);
    if (a == nullptr || b == nullptr) return 0.0;
    const VectorXd& root = f_.bench->root_weight();
    MatrixXd both(root.size(), 2);
    both.col(0) = root.cwiseProduct(Eigen::Map<const VectorXd>(a->data(), root.size()));
    both.col(1) = root.cwiseProduct(Eigen::Map<const VectorXd>(b->data(), root.size()));
    take_out_zeros(f_.part.table, root, both);
    const double size = both.col(0).norm() * both.col(1).norm();
    return size > 0.0 ? both.col(0).dot(both.col(1)) / size : 0.0;
  }

  /// An effect that does not vary between the readings of a target is visible in every run, so it
  /// is not a member of a canceling pair.
  bool in_time(const std::string& name) const {
    const std::size_t e = f_.index_of(name);
    return std::none_of(f_.best.blocks.begin(), f_.best.blocks.end(), [&](std::size_t b) {
      return f_.bench->effect_of(b) == e && f_.bench->blocks()[b].of_position;
    });
  }

  void find_cancelling() {
    const auto& names = out_.together;
    for (std::size_t i = 0; i < names.size(); ++i)
      for (std::size_t k = i + 1; k < names.size(); ++k)
        if (in_time(names[i]) && in_time(names[k]) &&
            correlation(names[i], names[k]) < -cancels_beyond)
          out_.cancelling.emplace_back(names[i], names[k]);
  }

  bool cancels(const std::string& name) const {
    return std::any_of(out_.cancelling.begin(), out_.cancelling.end(),
                       [&](const auto& pair) { return pair.first == name || pair.second == name; });
  }

  const Parameter* parameter_of(const std::string& name) const {
    for (const Parameter& p : f_.of_best.fit.parameters)
      if (p.effect == name) return &p;
    return nullptr;
  }

  /// The first column is that of a growth, (p - fixed) times the second one, that of a drift; null
  /// if it is not.
  static std::optional<double> fixed_point(const MatrixXd& columns, const std::vector<double>& p,
                                           double length) {
    double low = std::numeric_limits<double>::infinity(), high = -low;
    for (Index i = 0; i < columns.rows(); ++i) {
      if (columns(i, 1) == 0.0) continue;
      const double at = p[static_cast<std::size_t>(i)] - columns(i, 0) / columns(i, 1);
      low = std::min(low, at), high = std::max(high, at);
    }
    if (!(high - low < 1e-6 * length)) return std::nullopt;
    return low;
  }

  /// A growth about a point and a drift of the zero are one growth about another fixed point. If
  /// a bearing can be at this point, the growth is named first, as the cause of the drift.
  void find_one_growth() {
    // docs/dev/constants.md, M21.
    // largest distance of the fixed point from the middle, as a fraction of the measured stretch
    constexpr double farthest = 0.8;
    auto& names = out_.together;
    if (f_.part.kind != Part::Kind::axis || f_.part.axes.front().rotary) return;
    const auto term = [&](const std::string& name) { return f_.terms[f_.index_of(name)]; };
    const auto of = [&](Quantity quantity) {
      return std::find_if(names.begin(), names.end(), [&](const std::string& name) {
        const Effect& e = *term(name).effect;
        return e.linear.size() == 1 && e.shapes.empty() && e.linear.front().quantity == quantity;
      });
    };
    const auto growth = of(Quantity::growth), drift = of(Quantity::deviation_per_time);
    if (growth == names.end() || drift == names.end()) return;
    const Parameter *g = parameter_of(*growth), *z = parameter_of(*drift);
    const auto read = readings_of(f_.part.table, f_.part.axes.front());
    if (g == nullptr || z == nullptr || !read || !(std::fabs(g->value) > 0.0)) return;
    const auto columns = f_.columns_of({term(*growth), term(*drift)});
    if (!columns) return;
    const auto fixed = fixed_point(*columns, read->p, read->length);
    if (!fixed) return;
    const double from = *fixed - z->value / g->value;
    if (std::fabs(from) > farthest * read->length) return;
    out_.one_growth = {*growth, *drift, read->middle + from};
    if (drift < growth) std::iter_swap(drift, growth);
  }

  /// Whether the joint prediction of a canceling pair varies with a factor of this effect, and is
  /// not negligible compared with this effect.
  bool with_cancelling(const std::string& name) const {
    const auto* own = part_of(name);
    if (own == nullptr) return false;
    const auto works_in = places_of(*own);
    const double rms2 = (f_.bench->without(f_.best, f_.index_of(name)).squares - f_.best.squares) /
                        f_.bench->readings();
    for (const auto& pair : out_.cancelling) {
      std::vector<double> sum = *part_of(pair.first);
      const std::vector<double>& other = *part_of(pair.second);
      double mean = 0.0, squares = 0.0;
      for (std::size_t i = 0; i < sum.size(); ++i) mean += sum[i] += other[i];
      mean /= static_cast<double>(sum.size());
      for (const double x : sum) squares += (x - mean) * (x - mean);
      if (squares / static_cast<double>(sum.size()) < unexplained_share * rms2) continue;
      for (const Where& place : places_of(sum))
        for (const Where& where : works_in)
          if (same_factor(place, where)) return true;
    }
    return false;
  }

  /// Plans a further run that neither effect of the pair alone could explain, with any shapes.
  void plan_for_cancelling() {
    const auto& [one, other] = out_.cancelling.front();
    std::vector<Term> pair;
    std::vector<double> value;
    for (const Term& term : f_.of_best.fit.terms)
      if (term.name() == one || term.name() == other) pair.push_back(term);
    for (const Parameter& p : f_.of_best.fit.parameters)
      if (!p.shape && (p.effect == one || p.effect == other)) value.push_back(p.value);
    out_.plans = plans_for_pair(f_.part, f_.of_model.fit.terms, pair, value, f_.of_best.fit.s);
  }

  /// Effects with very large evidence, no alias, no canceling effect and no residual of their size
  /// at their places, which neither one target or pass nor random zeros can explain.
  void list_certain(const std::vector<Place>& serious, bool walks) {
    for (const std::string& name : out_.together) {
      const Candidate& c = candidate(name);
      if (c.within < certain_evidence || !c.aliases.empty() || cancels(name)) continue;
      if (in_doubt(name, serious, certain_share)) continue;
      if (of_one_target(name) || of_one_pass(name) || (walks && !walk_with(name)) ||
          (passes_.scatter() && f_.noise.zero == Noise::Zero::steady && !passes_.shows(name)))
        continue;
      out_.certain.push_back(name);
    }
  }

  /// Whether most evidence is from one target, so that the effect is a property of that target.
  bool of_one_target(const std::string& name) const {
    return share_of_one(f_.bench->without(f_.best, f_.index_of(name)), f_.best, f_.repeats.target,
                        f_.repeats.targets) > most_of_one_target;
  }

  /// An effect that explains no more than a free value or reversal of one target, or a free slope
  /// of one run, is not a cause. The library itself contains zeros and reversals of single runs.
  bool is_single(const std::string& name) const {
    const std::size_t e = f_.index_of(name);
    if (!f_.terms[e].library) return false;
    const Workbench::State rest = f_.bench->without(f_.best, e);
    const auto targets = static_cast<Index>(f_.repeats.targets);
    std::map<std::uint32_t, Index> column;  // column of the slope of each run
    for (const std::uint32_t run : f_.part.table.run)
      column.try_emplace(run, 2 * targets + static_cast<Index>(column.size()));
    const std::vector<double>& along = f_.part.along;
    const double middle = std::accumulate(along.begin(), along.end(), 0.0) /
                          std::max(static_cast<double>(along.size()), 1.0);
    MatrixXd free = MatrixXd::Zero(static_cast<Index>(f_.part.table.size()),
                                   2 * targets + static_cast<Index>(column.size()));
    for (Index i = 0; i < free.rows(); ++i) {
      const auto row = static_cast<std::size_t>(i);
      const auto at = static_cast<Index>(f_.repeats.target[row]);
      free(i, at) = 1.0;
      free(i, targets + at) = f_.part.way[row];
      if (!column.empty()) free(i, column[f_.part.table.run[row]]) = along[row] - middle;
    }
    free = f_.bench->white()(free);
    f_.bench->white().take_out_zeros(free);
    const MatrixXd own = math::orthogonal_part(f_.bench->basis(rest), free);
    const VectorXd with_left = math::transposed_times(own, f_.residual(rest));
    double most = 0.0;
    for (Index k = 0; k < free.cols(); ++k)
      if (const double squares = own.col(k).squaredNorm();
          squares > 1e-6 * free.col(k).squaredNorm())
        most = std::max(most, with_left(k) * with_left(k) / squares);
    // The cost of one parameter, one name, and the choice among these targets and runs.
    const double n = f_.bench->readings();
    const double price = f_.price_of_zero() + 2.0 * std::log(static_cast<double>(free.cols()));
    return n * std::log(std::max(rest.squares - most, 1e-300) / n) + rest.price + price <
           f_.best.criterion + alias_evidence;
  }

  /// Whether one pass contributes most of an effect's evidence, if passes have own zeros: within the
  /// best set, where another effect may take most of it over, and alone.
  bool of_one_pass(const std::string& name) const {
    if (f_.noise.zero != Noise::Zero::of_pass) return false;
    const std::size_t e = f_.index_of(name);
    const auto mostly = [&](const Workbench::State& without, const Workbench::State& with) {
      return share_of_one(without, with, f_.repeats.pass, f_.repeats.passes) > most_of_one_pass;
    };
    return mostly(f_.bench->without(f_.best, e), f_.best) &&
           mostly(f_.start, f_.bench->with(f_.start, f_.bench->gains(f_.start, e), e));
  }

  /// Returns the largest share of an effect's evidence that one group of readings contributes.
  double share_of_one(const Workbench::State& others, const Workbench::State& all,
                      const std::vector<std::uint32_t>& group, std::size_t groups) const {
    const VectorXd without = f_.residual(others);
    const VectorXd explained = without - f_.residual(all);
    std::vector<double> share(groups, 0.0);
    for (Index i = 0; i < without.size(); ++i)
      share[group[static_cast<std::size_t>(i)]] += explained(i) * without(i);
    return *std::max_element(share.begin(), share.end()) / explained.dot(without);
  }

  std::vector<Where> places_of(const std::vector<double>& says) const {
    const VectorXd part = Eigen::Map<const VectorXd>(says.data(), static_cast<Index>(says.size()));
    const VectorXd centred = part.array() - part.mean();
    if (!factors_) factors_.emplace(f_.part, f_.repeats, f_.bench->white());
    return (*factors_)(f_.bench->white()(centred));
  }

  /// Returns the RMS below which structure does not change the verdict, m or rad.
  double least_serious(const std::optional<NoiseFloor>& floor) const {
    return least_left * (floor ? floor->s : f_.of_best.fit.s);
  }

  static std::vector<Place> serious(const std::vector<Place>& places, double least) {
    std::vector<Place> out;
    for (const Place& place : places)
      if (place.p < serious_p && place.rms > least) out.push_back(place);
    return out;
  }

  /// Draws noise floors of campaigns with this noise: chi-square, approximated by the cube of a
  /// normal variate (Wilson and Hilferty 1931).
  std::vector<std::optional<NoiseFloor>> floors(std::size_t campaigns) const {
    std::vector<std::optional<NoiseFloor>> out(campaigns, f_.of_best.floor);
    if (!f_.of_best.floor) return out;
    const double spread = 2.0 / (9.0 * f_.of_best.floor->dof);
    std::mt19937_64 random(f_.seed + 1);
    const auto uniform = [&] { return (static_cast<double>(random() >> 11) + 0.5) * 0x1p-53; };
    for (auto& floor : out) {
      const double size = std::sqrt(-2.0 * std::log(uniform()));
      // method of Box and Muller
      const double z = size * std::cos(2.0 * std::numbers::pi * uniform());
      floor->s *= std::pow(std::max(1.0 - spread + z * std::sqrt(spread), 0.0), 1.5);
    }
    return out;
  }

  /// Residuals of repeats, scaled to the floor; with too few, those of the best explanation.
  VectorXd noise() const {
    const Saturated left =
        saturate(f_.repeats, f_.of_best.fit.residual, with_scatter(f_.weight, f_.noise));
    if (!(left.dof >= 8.0) || !(left.squares > 0.0)) return f_.residual(f_.best);
    const VectorXd e = f_.bench->white()(
        Eigen::Map<const VectorXd>(left.e.data(), static_cast<Index>(left.e.size())));
    return e * (f_.of_best.floor->s * std::sqrt(f_.bench->readings() / e.squaredNorm()));
  }

  VectorXd noise_of_passes() const {
    const std::vector<double> e = passes_.noise();
    return f_.bench->white()(Eigen::Map<const VectorXd>(e.data(), static_cast<Index>(e.size())));
  }

  /// Determines the rate of false alarms, if zeros of passes scatter, by flipping whole passes.
  void count_with_passes(Verdict& v) const {
    constexpr std::size_t draws = 200;  // docs/dev/constants.md, M14
    const std::vector<double> e = passes_.noise();
    std::mt19937_64 random(f_.seed);
    const auto floor = floors(draws);
    std::vector<double> drawn(e.size()), sign(f_.repeats.passes);
    double alarms = 0.0;
    for (std::size_t k = 0; k < draws; ++k) {
      for (double& s : sign) s = (random() >> 63) != 0 ? 1.0 : -1.0;
      for (std::size_t i = 0; i < e.size(); ++i) drawn[i] = sign[f_.repeats.pass[i]] * e[i];
      if (!serious(passes_.places(drawn, floor[k], least_serious(floor[k])),
                   least_serious(floor[k]))
               .empty())
        ++alarms;
    }
    v.trials = draws;
    v.false_alarms = alarms / static_cast<double>(draws);
  }

  void count_false_alarms(Verdict& v) const {
    if (passes_.scatter()) return count_with_passes(v);
    const SignFlips shuffles =
        passes_.drawn_again()
            ? shuffled(*f_.bench, f_.best, noise_of_passes(), f_.repeats.pass, f_.seed, whole_pass)
            : shuffled(*f_.bench, f_.best, noise(), f_.repeats.pass, f_.seed);
    const std::vector<char> named = named_in(*f_.bench, f_.best, shuffles, f_.chance);
    const PlaceTests tests(f_.part, f_.repeats, f_.bench->white(), f_.bench->basis(f_.best),
                           f_.dof(f_.best));
    const auto floor = floors(named.size());
    double alarms = 0.0;
    for (std::size_t i = 0; i < named.size(); ++i) {
      const VectorXd one = shuffles.noise.col(static_cast<Index>(i));
      const double least = least_serious(floor[i]);
      if (named[i] != 0 || !serious(tests(one, floor[i], least), least).empty()) ++alarms;
    }
    v.trials = named.size();
    v.false_alarms = alarms / static_cast<double>(named.size());
  }

  /// Zeros of runs cause the residuals, even if waves in time describe them with fewer columns.
  void tell_runs() {
    const auto is_run = [](const Place& place) { return place.where == Where{Factor::run}; };
    auto& told = out_.fails;
    auto at = std::find_if(told.begin(), told.end(), is_run);
    if (at == told.end()) {
      const auto& all = f_.of_model.places;
      const auto seen = std::find_if(all.begin(), all.end(), is_run);
      if (seen == all.end()) return;
      at = told.insert(told.end(), *seen);
    }
    std::rotate(told.begin(), at, at + 1);
  }

  /// Residuals of the best explanation, without random zeros of runs or passes.
  std::vector<double> without_zeros(Noise::Zero zero) const {
    std::vector<double> e = f_.of_best.fit.residual;
    const bool of_pass = f_.noise.zero == Noise::Zero::of_pass;
    if (zero != Noise::Zero::of_run && !of_pass) return e;
    const std::vector<std::uint32_t>& group = of_pass ? f_.repeats.pass : f_.part.table.run;
    std::map<std::uint32_t, std::pair<double, double>> sum;
    for (std::size_t i = 0; i < e.size(); ++i)
      sum[group[i]].first += f_.weight[i] * e[i], sum[group[i]].second += f_.weight[i];
    for (std::size_t i = 0; i < e.size(); ++i)
      if (const auto& [of_group, n] = sum[group[i]]; n > 0.0) e[i] -= of_group / n;
    return e;
  }

  bool contradictory(Noise::Zero zero) {
    if (const auto run =
            wild_run(f_.part.table, f_.repeats, f_.of_best.fit.residual, f_.weight, f_.noise)) {
      out_.fails.insert(out_.fails.begin(), *run);
      return true;
    }
    return too_many(f_.suspects.size(), f_.part.table.size()) ||
           two_valued(f_.repeats, without_zeros(zero), f_.weight, f_.noise.digit);
  }

  /// Moves a candidate to the front, even if a doubtful candidate has more evidence.
  void lift(const std::string& name) {
    auto& c = out_.candidates;
    const auto at =
        std::find_if(c.begin(), c.end(), [&](const Candidate& k) { return k.term.name() == name; });
    std::rotate(c.begin(), at, at + 1);
    c.front().score = std::max(c.front().score, c.size() > 1 ? c[1].score : c.front().score);
  }

  const Finding& f_;
  const double rms_of_model_;
  Explanation& out_;
  PassZeros passes_{f_};
  mutable std::optional<FactorsOf> factors_{};
};

}  // namespace

void judge(const Finding& finding, double rms_of_model, Explanation& out) {
  Judge(finding, rms_of_model, out).run();
}

}  // namespace nonio::model
