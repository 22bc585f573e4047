// SPDX-License-Identifier: Apache-2.0
#include "nonio/math/rigid_body.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>

#include "combinations.h"
#include "functional.h"
#include "rigid_fit.h"

namespace nonio::math {

namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::RowVectorXd;
using Eigen::VectorXd;

// largest relative change of a result by undetermined combinations that is treated as no change
constexpr double changes_nothing = 1e-6;
constexpr double shows_nothing = 1e-9;  // norm of a row of V below which a term affects no reading
constexpr double same_share = 1e-6;
constexpr std::size_t places_of_curve = 21;

std::string name_of(const RigidTerm& term) {
  return term.kind == RigidTerm::Kind::squareness ? term.error
                                                  : term.error + "." + std::to_string(term.degree);
}

void find_combinations(const RigidFit& f, RigidSolution& out) {
  std::set<std::string> seen;
  for (Index c = 0; c < f.solved.V.rows(); ++c)
    if (f.solved.V.row(c).norm() > shows_nothing)
      seen.insert(f.terms[static_cast<std::size_t>(c)].error);
  for (const RigidTerm& term : f.terms)
    if (!seen.contains(term.error) && (out.unseen.empty() || out.unseen.back() != term.error))
      out.unseen.push_back(term.error);
  for (const OpenCombination& open : open_combinations(f.solved.V, same_share)) {
    if (!seen.contains(f.terms[open.front().first].error)) continue;
    Combination combination;
    for (const auto& [k, size] : open) combination.emplace_back(name_of(f.terms[k]), size);
    out.combinations.push_back(std::move(combination));
  }
}

/// Terms of the least identifiable direction above 0.3 of the largest, relative to it, descending.
Combination weakest_of(const RigidFit& f) {
  Combination out;
  if (f.solved.rank == 0) return out;
  const VectorXd v = f.solved.V.col(f.solved.V.cols() - 1);
  Index largest = 0;
  const double most = v.cwiseAbs().maxCoeff(&largest);
  std::vector<std::pair<double, std::size_t>> order;
  for (Index k = 0; k < v.size(); ++k)
    if (std::fabs(v[k]) > 0.3 * most)
      order.emplace_back(-std::fabs(v[k]), static_cast<std::size_t>(k));
  std::sort(order.begin(), order.end());
  for (const auto& [size, k] : order) out.emplace_back(name_of(f.terms[k]), v[at(k)] / v[largest]);
  return out;
}

class Results {
 public:
  Results(const RigidFit& f, const RigidBox& box, const ReadingModel* model) : f_(f), box_(box) {
    const MatrixXd& V = f.solved.V;
    const VectorXd variance = f.solved.sigma.head(f.solved.rank).cwiseAbs2().cwiseInverse();
    e_.x = f.solved.x;
    e_.covariance = product_transposed(scaled_columns(V, variance), V);
    e_.model = model;
    if (model == nullptr) return;
    e_.of_readings = f.solved.map;
    // The model contains the inputs of stated values; the repetition is that of the readings alone.
    for (std::size_t i = 0; i < f.table.stated.size(); ++i)
      if (const double u = f.table.stated[i]; u > 0.0) {
        const VectorXd by = u * f.solved.map.col(at(i));
        e_.covariance -= by * by.transpose();
      }
    e_.dof = [this](const RowVectorXd& J) { return dof_of(J); };
  }
  const Estimator& estimator() const { return e_; }

  bool told(const RowVectorXd& row) const {
    const double size = row.norm();
    return !(size > 0.0) ||
           orthogonal_part(f_.solved.V, VectorXd(row.transpose())).norm() < changes_nothing * size;
  }

  /// Positioning is relative to the start of the travel.
  RowVectorXd row_of(const std::string& error, const Corner& place) const {
    RowVectorXd row = RowVectorXd::Zero(at(f_.terms.size()));
    for (std::size_t k = 0; k < f_.terms.size(); ++k) {
      const RigidTerm& term = f_.terms[k];
      if (term.error != error) continue;
      row[at(k)] = term.scale * shape_of(term, box_, place);
      if (term.kind == RigidTerm::Kind::positioning)
        row[at(k)] -= term.scale * shape_of(term, box_, box_.low);
    }
    return row;
  }

  MatrixXd error_rows(const Corner& place) const {
    MatrixXd rows(3, at(f_.terms.size()));
    for (std::size_t k = 0; k < f_.terms.size(); ++k) {
      const Corner e = error_of_term(f_.terms[k], box_, place);
      for (std::size_t c = 0; c < 3; ++c) rows(at(c), at(k)) = f_.terms[k].scale * e[c];
    }
    return rows;
  }

 private:
  /// Returns the effective degrees of freedom over the groups (Welch-Satterthwaite).
  double dof_of(const RowVectorXd& J) const {
    std::vector<double> share(f_.scatter.s.size(), 0.0);
    for (Index i = 0; i < J.size(); ++i) {
      const std::size_t g = f_.table.group[static_cast<std::size_t>(i)];
      if (g == share.size()) continue;  // a stated value
      share[g] += J[i] * J[i] * f_.scatter.s[g] * f_.scatter.s[g];
    }
    double sum = 0.0, fourth = 0.0;
    for (std::size_t g = 0; g < share.size(); ++g) {
      sum += share[g];
      if (share[g] > 0.0) fourth += share[g] * share[g] / std::max(f_.scatter.dof[g], 1e-3);
    }
    return fourth > 0.0 ? sum * sum / fourth : std::numeric_limits<double>::infinity();
  }

  const RigidFit& f_;
  const RigidBox& box_;
  Estimator e_;
};

void put_curve(const Results& r, const RigidBox& box, const RigidTerm& term, RigidSolution& out) {
  RigidCurve curve{term.error, term.axis, {}, {}, {}, {}};
  for (std::size_t i = 0; i < places_of_curve; ++i) {
    Corner place = box.low;
    place[term.axis] +=
        box.length(term.axis) * static_cast<double>(i) / static_cast<double>(places_of_curve - 1);
    const RowVectorXd row = r.row_of(term.error, place);
    if (!r.told(row)) return out.withheld.push_back(term.error);
    curve.position.push_back(place[term.axis]);
    curve.value.push_back(r.estimator().value(row));
    curve.u.push_back(r.estimator().u(row));
    curve.shares.push_back(r.estimator().shares(row));
  }
  out.curves.push_back(std::move(curve));
}

void put_results(const RigidFit& f, const RigidBox& box, const RigidWish& wish,
                 const ReadingModel* model, RigidSolution& out) {
  const Results r(f, box, model);
  std::string last;
  for (std::size_t k = 0; k < f.terms.size(); ++k) {
    const RigidTerm& term = f.terms[k];
    if (term.error == last) continue;
    last = term.error;
    if (term.kind != RigidTerm::Kind::squareness) {
      put_curve(r, box, term, out);
      continue;
    }
    RowVectorXd row = RowVectorXd::Zero(at(f.terms.size()));
    row[at(k)] = term.scale;
    if (!r.told(row))
      out.withheld.push_back(term.error);
    else
      out.squareness.emplace_back(
          term.error,
          RigidValue{r.estimator().value(row), r.estimator().u(row), r.estimator().shares(row)});
  }
  const MatrixXd zero = r.error_rows(box.low);
  for (const Corner& place : lattice(box.low, box.high, wish.parts)) {
    const MatrixXd rows = r.error_rows(place) - zero;
    for (Index c = 0; c < 3; ++c)
      if (!r.told(rows.row(c))) return;
  }
  out.map = map_of(
      r.estimator(), [&](const Corner& place) { return r.error_rows(place); }, box.low, box.high,
      wish.parts);
}

/// Each polynomial of an axis needs at least two positions of the readings.
std::size_t allowed_degree(const std::vector<RigidLine>& lines, const RigidBox& box) {
  std::size_t least = most_degree;
  for (std::size_t k = 0; k < 3; ++k) {
    if (!(box.length(k) > 0.0)) continue;
    std::set<long> seen;
    for (const RigidLine& line : lines)
      for (const RigidReading& r : line.readings)
        if (line.kind != RigidLine::Kind::stated) seen.insert(std::lround(1e4 * box.part(k, r.at)));
    least = std::min(least, seen.size() / 2);
  }
  return std::max(least, least_degree);
}

}  // namespace

Expected<RigidSolution> solve_rigid_body(const std::vector<RigidLine>& lines, const RigidWish& wish,
                                         const ReadingModel* model) {
  const RigidBox box{wish.low, wish.high};
  const auto& known = rigid_errors();
  for (const std::string& name : wish.errors)
    if (std::find(known.begin(), known.end(), name) == known.end())
      return fail("expected an error such as EXX, EYX or C0Y, found \"" + name + "\"");
  const std::size_t highest = allowed_degree(lines, box);
  RigidFit best =
      fit_rigid_body(lines, box, wish.errors, wish.degree > 0 ? wish.degree : least_degree);
  for (std::size_t d = least_degree + 1; wish.degree == 0 && d <= highest; ++d)
    if (RigidFit next = fit_rigid_body(lines, box, wish.errors, d); next.price < best.price)
      best = std::move(next);
  if (best.solved.rank + best.solved.set_up >= best.table.value.size())
    return fail(std::to_string(best.table.value.size()) + " readings cannot determine " +
                std::to_string(best.solved.rank + best.solved.set_up) + " unknowns");
  RigidSolution out;
  for (const RigidTerm& term : best.terms) out.degree = std::max(out.degree, term.degree);
  out.unknowns = best.terms.size();
  out.rank = static_cast<std::size_t>(best.solved.rank);
  out.readings =
      static_cast<std::size_t>(std::count(best.table.stated.begin(), best.table.stated.end(), 0.0));
  for (Index k = 0; k < best.solved.sigma.size(); ++k)
    out.singular.push_back(best.solved.sigma[0] > 0.0 ? best.solved.sigma[k] / best.solved.sigma[0]
                                                      : 0.0);
  out.scatter = best.scatter.s;
  out.dof = best.scatter.dof;
  for (std::size_t g = 0; g < out.scatter.size(); ++g)
    if (!(out.dof[g] > 0.5)) out.scatter[g] = 0.0;
  find_combinations(best, out);
  out.weakest = weakest_of(best);
  put_results(best, box, wish, model, out);
  return out;
}

}  // namespace nonio::math
