// SPDX-License-Identifier: Apache-2.0
#include "verdict.h"

#include <algorithm>
#include <cmath>

#include "compare.h"
#include "places.h"
#include "plans.h"
#include "scatter.h"

namespace nonio::model {

namespace {

constexpr double least_left = 0.25;  // of the noise: smaller structure is not worth a verdict
constexpr double serious_p = 0.005;
// What is left in the same place, of what the candidate says: beyond, the candidate is not it.
constexpr double unexplained_share = 0.04;

/// Whether two places share a factor.
bool same_factor(const std::string& a, const std::string& b) {
  const auto factors = [](const std::string& where) {
    std::vector<std::string> out;
    const std::size_t x = where.find(" x ");
    out.push_back(where.substr(0, x));
    if (x != std::string::npos) out.push_back(where.substr(x + 3));
    for (std::string& f : out) {
      if (f == "run") f = "time";
      if (f == "screw-phase" || f == "angle") f = "position";
    }
    return out;
  };
  const auto of_a = factors(a), of_b = factors(b);
  return std::any_of(of_a.begin(), of_a.end(), [&](const std::string& f) {
    return std::find(of_b.begin(), of_b.end(), f) != of_b.end();
  });
}

class Judge {
 public:
  Judge(const Finding& finding, Explanation& out) : f_(finding), out_(out) {}

  void run() {
    Verdict& v = out_.verdict;
    count_false_alarms(v);
    v.suspects_share =
        static_cast<double>(f_.suspects.size()) / static_cast<double>(f_.part.table.size());
    for (const Place& place : f_.of_model.places)
      if (place.p < place_p) out_.fails.push_back(place);
    std::vector<Place> serious = this->serious(f_.of_best.places);
    const bool walks = !out_.together.empty() && zero_walks();
    if (contradictory()) {
      v.kind = Verdict::Kind::unrepeatable;
      return;
    }
    if (!out_.together.empty() && !walks && !in_doubt(out_.together.front(), serious)) {
      v.kind = Verdict::Kind::missing;
      v.effect = out_.together.front();
    }
    if (v.kind == Verdict::Kind::missing) {
      lift(v.effect);
      out_.plans = plans_for(f_.part, f_.of_model.fit.terms, out_.candidates.front(), f_.terms,
                             f_.of_best.fit.s);
    } else if (walks || !serious.empty()) {
      v.kind = Verdict::Kind::unknown;
      if (auto seats = seats_in(f_.part, f_.repeats, f_.of_model); !seats.empty())
        out_.fails = std::move(seats);
      else if (!serious.empty())
        out_.fails = std::move(serious);
    }
  }

 private:
  /// Whether the model beside a zero that walks is better evidence than the best set of effects.
  bool zero_walks() const {
    MatrixXd model(static_cast<Index>(f_.part.table.size()), 0);
    for (const Term& term : f_.of_model.fit.terms) {
      const auto columns = columns_of(f_.part.table, term, term.shape);
      if (!columns) return false;
      model.conservativeResize(Eigen::NoChange, model.cols() + columns->cols());
      model.rightCols(columns->cols()) = *columns;
    }
    const double price = f_.start.price + std::log(f_.bench->readings()) +
                         2.0 * std::log(static_cast<double>(f_.terms.size()));
    return criterion_of_walk(f_.part.table, f_.bench->root_weight(), model) + price <
           f_.best.criterion;
  }

  /// Whether something else is left in the places where this effect works: then it may be no more
  /// than the nearest thing in the catalogue.
  bool in_doubt(const std::string& name, const std::vector<Place>& serious) const {
    for (std::size_t t = 0; t < f_.of_best.fit.terms.size(); ++t) {
      if (f_.of_best.fit.terms[t].name() != name) continue;
      const VectorXd part = Eigen::Map<const VectorXd>(
          f_.of_best.fit.part[t].data(), static_cast<Index>(f_.of_best.fit.part[t].size()));
      const VectorXd centred = part.array() - part.mean();
      // What it alone can say: effects that cancel each other may both be large.
      const double rms2 =
          (f_.bench->without(f_.best, f_.index_of(name)).squares - f_.best.squares) /
          f_.bench->readings();
      const auto works_in = factors_of(f_.part, f_.repeats, f_.bench->root_weight(),
                                       f_.bench->root_weight().cwiseProduct(centred));
      for (const Place& place : serious)
        for (const std::string& where : works_in)
          if (same_factor(place.where, where) && place.rms * place.rms > unexplained_share * rms2)
            return true;
    }
    return false;
  }

  /// Structure smaller than this is not worth a verdict.
  double least_serious() const {
    return least_left * (f_.of_best.floor ? f_.of_best.floor->s : f_.of_best.fit.s);
  }

  std::vector<Place> serious(const std::vector<Place>& places) const {
    std::vector<Place> out;
    for (const Place& place : places)
      if (place.p < serious_p && place.rms > least_serious()) out.push_back(place);
    return out;
  }

  /// Noise alone, as large as that of a reading: what repeats leave, else what the best explanation
  /// leaves (with root weights).
  VectorXd noise() const {
    const Saturated left = saturate(f_.repeats, f_.of_best.fit.residual, f_.weight);
    if (!(left.dof >= 8.0)) return f_.residual(f_.best);
    return f_.bench->root_weight().cwiseProduct(
               Eigen::Map<const VectorXd>(left.e.data(), static_cast<Index>(left.e.size()))) *
           std::sqrt(f_.bench->readings() / left.dof);
  }

  void count_false_alarms(Verdict& v) const {
    const Shuffles shuffles =
        shuffled(*f_.bench, f_.best, noise(), f_.part.table, f_.repeats.pass, f_.seed);
    const std::vector<char> named = named_in(*f_.bench, f_.best, shuffles, f_.chance);
    const PlaceTests tests(f_.part, f_.repeats, f_.bench->root_weight(), f_.bench->basis(f_.best),
                           f_.dof(f_.best));
    double alarms = 0.0;
    for (std::size_t i = 0; i < named.size(); ++i) {
      const VectorXd one = shuffles.noise.col(static_cast<Index>(i));
      if (named[i] != 0 || !serious(tests(one, f_.of_best.floor, least_serious())).empty())
        ++alarms;
    }
    v.trials = named.size();
    v.false_alarms = alarms / static_cast<double>(named.size());
  }

  bool contradictory() {
    if (const auto run = wild_run(f_.part.table, f_.repeats, f_.of_best.fit.residual, f_.weight)) {
      out_.fails.insert(out_.fails.begin(), *run);
      return true;
    }
    return out_.verdict.suspects_share > most_suspects ||
           two_valued(f_.repeats, f_.of_best.fit.residual, f_.weight);
  }

  /// The verdict's effect leads the list, also where one with more evidence is in doubt.
  void lift(const std::string& name) {
    auto& c = out_.candidates;
    const auto at =
        std::find_if(c.begin(), c.end(), [&](const Candidate& k) { return k.term.name() == name; });
    std::rotate(c.begin(), at, at + 1);
    c.front().score = std::max(c.front().score, c.size() > 1 ? c[1].score : c.front().score);
  }

  const Finding& f_;
  Explanation& out_;
};

}  // namespace

void judge(const Finding& finding, Explanation& out) { Judge(finding, out).run(); }

}  // namespace nonio::model
