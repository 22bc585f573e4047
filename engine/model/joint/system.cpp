// SPDX-License-Identifier: Apache-2.0
#include "joint/system.h"

#include <cmath>
#include <limits>
#include <set>

#include "fit/weights.h"

namespace nonio::model {

namespace {

constexpr double no_gain = std::numeric_limits<double>::quiet_NaN();
/// Smallest share of a column that must be independent of the others.
constexpr double least_independent = 1e-6;

/// `left`: scalar products after an elimination; `before`: squared lengths before the elimination.
bool is_independent(const MatrixXd& left, const VectorXd& before) {
  if (left.rows() == 0) return true;
  const VectorXd unit = before.cwiseMax(1e-300).cwiseSqrt().cwiseInverse();
  const Eigen::LLT<MatrixXd> llt(math::scaled_columns(math::scaled_rows(unit, left), unit));
  return llt.info() == Eigen::Success &&
         llt.matrixLLT().diagonal().minCoeff() > std::sqrt(least_independent);
}

VectorXd quadratic(const MatrixXd& s, const MatrixXd& right) {
  if (s.rows() == 0) return VectorXd::Zero(right.cols());
  const Eigen::LLT<MatrixXd> llt(s);
  return right.cwiseProduct(math::solutions(llt, right)).colwise().sum().transpose();
}

MatrixXd inverse_of(const MatrixXd& s) {
  if (s.rows() == 0) return s;
  return math::solutions(Eigen::LLT<MatrixXd>(s), MatrixXd::Identity(s.rows(), s.rows()));
}

}  // namespace

RankedInverse ranked_inverse(const MatrixXd& left, const VectorXd& before) {
  if (is_independent(left, before)) return {inverse_of(left), left.rows()};
  const VectorXd unit = before.cwiseMax(1e-300).cwiseSqrt().cwiseInverse();
  const auto [values, vectors] =
      math::spectrum(math::scaled_columns(math::scaled_rows(unit, left), unit));
  RankedInverse out{MatrixXd::Zero(left.rows(), left.rows()), 0};
  for (Index k = 0; k < values.size(); ++k) {
    if (!(values(k) > least_independent)) continue;
    const VectorXd v = unit.cwiseProduct(vectors.col(k));
    out.inverse += v * v.transpose() / values(k);
    ++out.rank;
  }
  return out;
}

namespace {}  // namespace

double JointSystem::readings() const {
  double n = 0.0;
  for (const MemberReadings& m : r_.members) n += m.readings;
  return n;
}

std::size_t JointSystem::effects() const {
  std::set<std::string> names;
  for (const JointBlock& b : r_.blocks) names.insert(b.effect);
  return names.size();
}

double JointSystem::price_of(const JointBlock& block) const {
  return block.cost - evidence_of_weight(block.weight) +
         static_cast<double>(block.searched) * std::log(readings()) +
         2.0 * std::log(static_cast<double>(std::max<std::size_t>(effects(), 2)));
}

Index JointSystem::shared_columns(const std::vector<Choice>& choices) const {
  Index n = 0;
  for (const Choice& c : choices)
    n += r_.blocks[c.block].count * (c.holds == Holds::own ? 0 : c.holds == Holds::shared ? 1 : 2);
  return n;
}

std::vector<JointSystem::Place> JointSystem::places(const std::vector<Choice>& choices,
                                                    std::size_t member) const {
  std::vector<Place> out;
  Index shared = 0, own = 0;
  for (const Choice& c : choices) {
    const Index count = r_.blocks[c.block].count, first = r_.members[member].first[c.block];
    if (c.holds == Holds::own) {
      out.push_back({false, own, first, count, r_.members[member].rank[c.block]});
      if (first >= 0) own += count;
      continue;
    }
    const bool second = c.holds == Holds::changed && member >= c.after;
    out.push_back({true, shared + (second ? count : 0), first, count, count});
    shared += c.holds == Holds::changed ? 2 * count : count;
  }
  return out;
}

JointSystem::Split JointSystem::split(const std::vector<Choice>& choices,
                                      std::size_t member) const {
  const MatrixXd& x = r_.members[member].x;
  Split out{MatrixXd(x.rows(), 0), MatrixXd(x.rows(), 0), {}, 0};
  for (const Place& p : places(choices, member)) {
    if (p.column < 0) continue;
    if (!p.shared) out.rank += p.rank;
    MatrixXd& to = p.shared ? out.shared : out.own;
    to.conservativeResize(Eigen::NoChange, to.cols() + p.count);
    to.rightCols(p.count) = x.middleCols(p.column, p.count);
    for (Index k = 0; p.shared && k < p.count; ++k) out.at.push_back(p.at + k);
  }
  return out;
}

JointSystem::Solution JointSystem::solve(const std::vector<Choice>& choices) const {
  return solve(choices, nullptr);
}

JointSystem::Solution JointSystem::solve_with_estimated_noise(
    const std::vector<Choice>& choices) const {
  std::vector<Information> members;
  Solution out = solve(choices, &members);
  if (!out.sound || out.covariance.size() == 0) return out;
  const MatrixXd c = out.covariance;
  MatrixXd more = MatrixXd::Zero(c.rows(), c.cols());
  for (std::size_t m = 0; m < members.size(); ++m) {
    const auto& [a, at] = members[m];
    const MatrixXd left = a - math::quadratic_form(c(at, at), a);
    for (std::size_t i = 0; i < at.size(); ++i)
      for (std::size_t k = 0; k < at.size(); ++k)
        more(at[i], at[k]) +=
            4.0 / r_.members[m].dof * left(static_cast<Index>(i), static_cast<Index>(k));
  }
  out.covariance += math::quadratic_form(more, c);
  return out;
}

JointSystem::Solution JointSystem::solve(const std::vector<Choice>& choices,
                                         std::vector<Information>* members) const {
  Solution out;
  const Index n = shared_columns(choices);
  MatrixXd s = MatrixXd::Zero(n, n);
  VectorXd right = VectorXd::Zero(n), before = VectorXd::Zero(n);
  std::vector<MatrixXd> inverse(r_.members.size()), with(r_.members.size());
  std::vector<VectorXd> alone(r_.members.size());
  for (std::size_t m = 0; m < r_.members.size(); ++m) {
    const VectorXd& y = r_.members[m].y;
    const Split part = split(choices, m);
    const MatrixXd oo = math::transposed_product(part.own, part.own);
    auto [own_inverse, rank] = ranked_inverse(oo, oo.diagonal());
    if (rank < part.rank) out.sound = false;
    if (!out.sound) return out;
    inverse[m] = std::move(own_inverse);
    with[m] = math::transposed_product(part.own, part.shared);
    const VectorXd oy = math::transposed_times(part.own, y);
    alone[m] = math::times(inverse[m], oy);
    out.squares += y.squaredNorm() - oy.dot(alone[m]);
    const MatrixXd gg = math::transposed_product(part.shared, part.shared);
    const MatrixXd left = gg - math::quadratic_form(inverse[m], with[m]);
    const VectorXd gy =
        math::transposed_times(part.shared, y) - math::transposed_times(with[m], alone[m]);
    for (std::size_t i = 0; i < part.at.size(); ++i) {
      right(part.at[i]) += gy(static_cast<Index>(i));
      before(part.at[i]) += gg(static_cast<Index>(i), static_cast<Index>(i));
      for (std::size_t k = 0; k < part.at.size(); ++k)
        s(part.at[i], part.at[k]) += left(static_cast<Index>(i), static_cast<Index>(k));
    }
    out.parameters += rank;
    out.price += static_cast<double>(rank) * std::log(r_.members[m].readings);
    if (members != nullptr) members->push_back({left, part.at});
  }
  out.sound = is_independent(s, before);
  if (!out.sound) return out;
  out.covariance = inverse_of(s);
  out.shared = math::times(out.covariance, right);
  out.squares = std::max(out.squares - right.dot(out.shared), 0.0);
  out.parameters += n;
  out.price += static_cast<double>(n) * std::log(readings());
  for (const Choice& c : choices) {
    out.price += price_of(r_.blocks[c.block]);
    if (c.holds == Holds::changed)
      out.price += 2.0 * std::log(static_cast<double>(r_.members.size() - 1));
  }
  for (std::size_t m = 0; m < r_.members.size(); ++m) {
    const Split part = split(choices, m);
    const std::vector<Index>& at = part.at;
    const MatrixXd k = math::product(inverse[m], with[m]);
    out.own.push_back(math::residual(alone[m], k, out.shared(at)));
    out.own_covariance.push_back(inverse[m] +
                                 math::quadratic_form(out.covariance(at, at), k.transpose()));
  }
  return out;
}

std::pair<VectorXd, MatrixXd> JointSystem::values(const std::vector<Choice>& choices,
                                                  const Solution& s, std::size_t choice,
                                                  std::size_t group) const {
  const Choice& c = choices[choice];
  if (c.holds == Holds::own) {
    const Place p = places(choices, group)[choice];
    if (p.column < 0) return {};
    return {s.own[group].segment(p.at, p.count),
            s.own_covariance[group].block(p.at, p.at, p.count, p.count)};
  }
  Index at = 0;
  for (std::size_t i = 0; i < choice; ++i) at += shared_columns({choices[i]});
  const Index count = r_.blocks[c.block].count;
  at += static_cast<Index>(group) * count;
  return {s.shared.segment(at, count), s.covariance.block(at, at, count, count)};
}

std::vector<VectorXd> JointSystem::residuals(const std::vector<Choice>& choices,
                                             const Solution& s) const {
  std::vector<VectorXd> out;
  for (std::size_t m = 0; m < r_.members.size(); ++m) {
    const Split part = split(choices, m);
    out.push_back(math::residual(math::residual(r_.members[m].y, part.own, s.own[m]), part.shared,
                                 s.shared(part.at)));
  }
  return out;
}

JointSystem::Gains JointSystem::gains(const std::vector<Choice>& choices,
                                      const std::vector<MatrixXd>& y) const {
  struct Sums {
    MatrixXd bb, ba, right, of_own, right_of_own;
    VectorXd before, own;
    bool any = false, own_possible = true;
  };
  const Index n = shared_columns(choices), columns = y.front().cols();
  const auto blocks = r_.blocks.size();
  MatrixXd s = MatrixXd::Zero(n, n), right = MatrixXd::Zero(n, columns);
  std::vector<Sums> sums(blocks);
  Gains out;
  out.own_parameters.assign(blocks, 0), out.own_price.assign(blocks, 0.0);
  for (std::size_t b = 0; b < blocks; ++b) {
    const Index k = r_.blocks[b].count;
    sums[b] = {MatrixXd::Zero(k, k),   MatrixXd::Zero(k, n),       MatrixXd::Zero(k, columns),
               MatrixXd::Zero(n, n),   MatrixXd::Zero(n, columns), VectorXd::Zero(k),
               VectorXd::Zero(columns)};
  }
  for (std::size_t m = 0; m < r_.members.size(); ++m) {
    const MemberReadings& member = r_.members[m];
    const Split part = split(choices, m);
    const Index o = part.own.cols(), a = part.shared.cols();
    // shared columns and readings, without the own columns
    MatrixXd all(member.y.size(), a + columns);
    all << part.shared, y[m];
    const MatrixXd oo = math::transposed_product(part.own, part.own);
    const MatrixXd inverse = ranked_inverse(oo, oo.diagonal()).inverse;
    if (o > 0)
      all -=
          math::product(part.own, math::product(inverse, math::transposed_product(part.own, all)));
    const MatrixXd with = math::transposed_product(member.x, all);
    const MatrixXd with_own = math::transposed_product(member.x, part.own);
    const MatrixXd aa = math::transposed_product(part.shared, all);
    const auto put = [&](const MatrixXd& from, MatrixXd& to) {
      for (std::size_t i = 0; i < part.at.size(); ++i)
        to.col(part.at[i]) += from.col(static_cast<Index>(i));
    };
    for (std::size_t i = 0; i < part.at.size(); ++i) {
      right.row(part.at[i]) += aa.row(static_cast<Index>(i)).rightCols(columns);
      for (std::size_t k = 0; k < part.at.size(); ++k)
        s(part.at[i], part.at[k]) += aa(static_cast<Index>(i), static_cast<Index>(k));
    }
    for (std::size_t b = 0; b < blocks; ++b) {
      if (member.first[b] < 0) continue;
      const Index k = r_.blocks[b].count, at = member.first[b];
      const MatrixXd bo = with_own.middleRows(at, k);
      const MatrixXd bb = member.own[b] - math::quadratic_form(inverse, bo.transpose());
      const MatrixXd ba = with.block(at, 0, k, a), by = with.block(at, a, k, columns);
      Sums& sum = sums[b];
      sum.any = true;
      sum.bb += bb, sum.right += by, sum.before += member.own[b].diagonal();
      put(ba, sum.ba);
      const auto [inner, rank] = ranked_inverse(bb, member.own[b].diagonal());
      if (rank < member.rank[b]) sum.own_possible = false;
      if (!sum.own_possible) continue;
      const MatrixXd weighted = math::product(inner, by);
      sum.own += by.cwiseProduct(weighted).colwise().sum().transpose();
      out.own_parameters[b] += rank;
      out.own_price[b] += static_cast<double>(rank) * std::log(member.readings);
      if (a == 0) continue;
      const MatrixXd e = math::quadratic_form(inner, ba),
                     r = math::transposed_product(ba, weighted);
      for (std::size_t i = 0; i < part.at.size(); ++i) {
        sum.right_of_own.row(part.at[i]) += r.row(static_cast<Index>(i));
        for (std::size_t j = 0; j < part.at.size(); ++j)
          sum.of_own(part.at[i], part.at[j]) += e(static_cast<Index>(i), static_cast<Index>(j));
      }
    }
  }
  const VectorXd base = quadratic(s, right);
  const MatrixXd s_inverse = inverse_of(s);
  out.shared = MatrixXd::Constant(static_cast<Index>(blocks), columns, no_gain);
  out.own = out.shared;
  for (std::size_t b = 0; b < blocks; ++b) {
    const Sums& sum = sums[b];
    if (!sum.any) continue;
    const auto row = static_cast<Index>(b);
    const MatrixXd through = math::product(sum.ba, s_inverse);
    const MatrixXd bb = sum.bb - math::product_transposed(through, sum.ba);
    if (is_independent(bb, sum.before))
      out.shared.row(row) = quadratic(bb, sum.right - math::product(through, right)).transpose();
    const MatrixXd left = s - sum.of_own;
    if (sum.own_possible && out.own_parameters[b] > 0 && is_independent(left, s.diagonal()))
      out.own.row(row) = (sum.own + quadratic(left, right - sum.right_of_own) - base).transpose();
  }
  return out;
}

/// Normal deviate of a chi-squared variate (Wilson and Hilferty).
static double deviate_of(double squares, double dof) {
  const double variance = 2.0 / (9.0 * dof);
  return (std::cbrt(squares / dof) - 1.0 + variance) / std::sqrt(variance);
}

JointSystem::Single JointSystem::single(const std::vector<MatrixXd>& y) const {
  Single out{VectorXd::Constant(y.front().cols(), -std::numeric_limits<double>::infinity())};
  for (std::size_t m = 0; m < r_.members.size(); ++m) {
    const MemberReadings& member = r_.members[m];
    const MatrixXd with = math::transposed_product(member.x, y[m]);
    for (std::size_t b = 0; b < r_.blocks.size(); ++b) {
      const Index at = member.first[b];
      if (at < 0) continue;
      const auto [inner, rank] = ranked_inverse(member.own[b], member.own[b].diagonal());
      if (rank < member.rank[b] || rank == 0) continue;
      const MatrixXd by = with.middleRows(at, r_.blocks[b].count);
      const MatrixXd falls = by.cwiseProduct(math::product(inner, by)).colwise().sum();
      for (Index c = 0; c < falls.cols(); ++c) {
        const double z = deviate_of(falls(c), static_cast<double>(rank));
        if (!(z > out.deviate(c))) continue;
        out.deviate(c) = z;
        if (c == 0) out.block = b, out.member = m, out.fall = falls(c);
      }
    }
  }
  return out;
}

}  // namespace nonio::model
