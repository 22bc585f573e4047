// SPDX-License-Identifier: Apache-2.0
#include "course_data.h"

#include <set>

namespace nonio::model {

namespace {

bool has_small_factors(std::size_t n) {
  for (const std::size_t factor : {2U, 3U, 5U})
    while (n > 1 && n % factor == 0) n /= factor;
  return n <= 1;
}

/// First row of each of `bins` equal bins and the end; the border next to each begin is moved to it.
std::vector<std::size_t> borders(std::size_t rows, std::size_t bins,
                                 const std::vector<std::size_t>& begins) {
  std::set<std::size_t> out;
  for (std::size_t b = 0; b <= bins; ++b) out.insert(b * rows / std::max<std::size_t>(bins, 1));
  for (const std::size_t begin : begins) {
    const std::size_t next = (begin * bins + rows / 2) / rows;
    if (next > 0 && next < bins) out.erase(next * rows / bins);
  }
  out.insert(begins.begin(), begins.end());
  return {out.begin(), out.end()};
}

}  // namespace

CourseData::CourseData(const Part& part) : part_(part) {
  const std::size_t n = part.table.size();
  std::vector<std::size_t> begins;
  for (std::size_t i = 1; i < n; ++i)
    if (part.table.line_of(i) != part.table.line_of(i - 1)) begins.push_back(i);
  for (std::size_t bins = std::min<std::size_t>(n, most_bins);; --bins) {
    first_ = borders(n, bins, begins);
    if (bins < 3 || has_small_factors(first_.size() - 2)) break;
  }
  lines_.push_back(0);
  for (const std::size_t begin : begins)
    lines_.push_back(std::lower_bound(first_.begin(), first_.end(), begin) - first_.begin());
  time_ = means(part.table.time);
  displacements_.resize(size(), static_cast<Index>(1 + part.companions.size()));
  displacements_.col(0) = means(part.table.deviation);
  for (std::size_t k = 0; k < part.companions.size(); ++k)
    displacements_.col(static_cast<Index>(k) + 1) = means(part.companions[k]);
}

void CourseData::centre(MatrixXd& rows, Index from) const {
  const Index end = from + rows.rows();
  for (std::size_t s = 0; s < lines_.size(); ++s) {
    const Index first = std::max(lines_[s], from),
                last = std::min(s + 1 < lines_.size() ? lines_[s + 1] : size(), end);
    if (last <= first) continue;
    auto own = rows.middleRows(first - from, last - first);
    own.rowwise() -= own.colwise().mean().eval();
  }
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
  for (const Effect::Parameter& p : term.effect->linear) out.push_back(quantity_of(p, term.axis));
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
