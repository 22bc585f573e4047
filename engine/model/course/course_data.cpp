// SPDX-License-Identifier: Apache-2.0
#include "course_data.h"

#include <algorithm>
#include <cmath>

namespace nonio::model {

namespace {

/// Returns the largest number up to `n` with no prime factors except 2, 3 and 5.
std::size_t smooth(std::size_t n) {
  for (; n > 1; --n) {
    std::size_t rest = n;
    for (const std::size_t factor : {2U, 3U, 5U})
      while (rest % factor == 0) rest /= factor;
    if (rest == 1) break;
  }
  return n;
}

}  // namespace

CourseData::CourseData(const Part& part) : part_(part) {
  const std::size_t n = part.table.size();
  const std::size_t bins = n < 3 ? n : smooth(std::min<std::size_t>(n, most_bins) - 1) + 1;
  for (std::size_t b = 0; b <= bins; ++b) first_.push_back(b * n / std::max<std::size_t>(bins, 1));
  time_ = means(part.table.time);
  displacements_.resize(size(), static_cast<Index>(1 + part.companions.size()));
  displacements_.col(0) = means(part.table.deviation);
  for (std::size_t k = 0; k < part.companions.size(); ++k)
    displacements_.col(static_cast<Index>(k) + 1) = means(part.companions[k]);
}

VectorXd CourseData::means(const std::vector<double>& column) const {
  VectorXd out(size());
  for (Index b = 0; b < size(); ++b) {
    const std::size_t from = first_[static_cast<std::size_t>(b)],
                      to = first_[static_cast<std::size_t>(b) + 1];
    double sum = 0.0;
    for (std::size_t i = from; i < to; ++i) sum += column[i];
    out(b) = sum / static_cast<double>(to - from);
  }
  return out;
}

MatrixXd CourseData::means(const Effect::Columns& columns) const {
  MatrixXd out(size(), static_cast<Index>(columns.size()));
  for (std::size_t k = 0; k < columns.size(); ++k)
    out.col(static_cast<Index>(k)) = means(columns[k]);
  return out;
}

double successive(const VectorXd& residual) {
  const Index n = residual.size();
  if (n < 3) return 0.0;
  const VectorXd r = residual.array() - residual.mean();
  const double squares = r.squaredNorm();
  return squares > 0.0 ? r.head(n - 1).dot(r.tail(n - 1)) / squares : 0.0;
}

std::vector<Quantity> quantities_of(const Term& term) {
  std::vector<Quantity> out;
  for (const Effect::Parameter& p : term.effect->linear) out.push_back(p.quantity);
  return out;
}

const std::vector<CourseColumns>& CourseData::on_grid(const Term& term) const {
  const auto [place, first] = grids_.try_emplace({term.name(), term.shape});
  if (!first) return place->second;
  for (std::vector<double>& shape : shapes_of(part_.table, term)) {
    const auto columns = term.effect->columns(part_.table, term.axis, shape);
    if (!columns || columns->empty()) continue;
    place->second.push_back({std::move(shape), means(*columns)});
  }
  return place->second;
}

}  // namespace nonio::model
