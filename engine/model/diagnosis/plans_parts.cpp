// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <cmath>

#include "nonio/sdk/space_readings.h"
#include "plans.h"

namespace nonio::model {

namespace {

using Vector = std::array<double, 3>;

// Cost of one more part: docs/dev/constants.md, M57.
constexpr double set_up = 1800.0, per_feature = 60.0;  // s

/// Another position of a part: turned by 90 deg about `middle` if `turned`, then moved by `by`.
struct Move {
  bool turned = false;
  Vector middle{}, by{};
  Vector direction(const Vector& v) const { return turned ? Vector{-v[1], v[0], v[2]} : v; }
  Vector place(const Vector& p) const {
    Vector from{};
    for (std::size_t k = 0; k < 3; ++k) from[k] = p[k] - middle[k];
    Vector out = direction(from);
    for (std::size_t k = 0; k < 3; ++k) out[k] += middle[k] + by[k];
    return out;
  }
};

struct Box {
  Vector low{INFINITY, INFINITY, INFINITY}, high{-INFINITY, -INFINITY, -INFINITY};
};

class OneMorePart {
 public:
  explicit OneMorePart(const Part& part) : part_(part), o_(part.table) {
    for (const auto& line : o_.lines)
      if (body_.empty()) body_ = line.body;
    for (std::size_t i = 0; i < o_.size() && !body_.empty(); ++i)
      if (o_.lines[o_.line_of(i)].body == body_) rows_.push_back(i);
    for (const auto& axis : o_.axes) at_[coordinate_of(axis.axis)] = &axis.position;
    for (const std::size_t i : rows_)
      for (std::size_t k = 0; k < 3; ++k) {
        box_.low[k] = std::min(box_.low[k], at(i)[k]);
        box_.high[k] = std::max(box_.high[k], at(i)[k]);
      }
  }

  std::vector<Further> all() const {
    std::vector<Further> out;
    if (rows_.empty() || at_[0] == nullptr || at_[1] == nullptr) return out;
    Further sizes{"known-size", "", o_, 0.0};
    for (auto& line : sizes.table.lines) line.body_size_known = true;
    if (std::any_of(o_.lines.begin(), o_.lines.end(),
                    [](const auto& l) { return !l.body.empty() && !l.body_size_known; }))
      out.push_back(std::move(sizes));
    Move turn{true, {}, {}};
    for (std::size_t k = 0; k < 3; ++k) turn.middle[k] = (box_.low[k] + box_.high[k]) / 2.0;
    out.push_back(moved("turned-part", "", turn));
    for (std::size_t k = 0; k < 2; ++k)
      if (const double way = room(k); way != 0.0) {
        Move move;
        move.by[k] = way;
        out.push_back(moved("moved-part", {letter_of(k)}, move));
      }
    return out;
  }

 private:
  Vector at(std::size_t row) const {
    Vector p{};
    for (std::size_t k = 0; k < 3; ++k)
      if (at_[k] != nullptr) p[k] = (*at_[k])[row];
    return p;
  }

  /// Half the length of the part along coordinate k, in the direction that the stated travel
  /// allows; 0 if it allows neither.
  double room(std::size_t k) const {
    const double half = (box_.high[k] - box_.low[k]) / 2.0;
    for (const Axis& axis : part_.axes) {
      if (coordinate_of(axis.name) != k || !axis.travel) continue;
      if (box_.high[k] + half <= axis.travel->second) return half;
      return box_.low[k] - half >= axis.travel->first ? -half : 0.0;
    }
    return half;
  }

  Further moved(const char* id, std::string of, const Move& move) const {
    Further f{id, std::move(of), o_};
    f.again = rows_;
    f.body = body_;
    Observations& o = f.table;
    std::vector<std::uint32_t> line_of(o_.lines.size(), 0);
    for (std::size_t l = 0; l < o_.lines.size(); ++l) {
      if (o_.lines[l].body != body_) continue;
      line_of[l] = static_cast<std::uint32_t>(o.lines.size());
      auto line = o_.lines[l];
      line.name += further_body, line.body += further_body;
      line.sense = move.direction(line.sense);
      line.body_turned += move.turned ? std::acos(0.0) : 0.0;
      o.lines.push_back(std::move(line));
    }
    if (o.line.empty()) o.line.assign(o.size(), 0);
    for (const std::size_t i : rows_) {
      const Vector p = move.place(at(i));
      for (auto& axis : o.axes) {
        axis.position.push_back(p[coordinate_of(axis.axis)]);
        if (!axis.approach.empty()) axis.approach.push_back(axis.approach[i]);
      }
      if (!o.sense.empty()) o.sense.push_back(move.direction(o_.sense[i]));
      o.line.push_back(line_of[o_.line_of(i)]);
      if (!o.run.empty()) o.run.push_back(o_.run[i]);
      o.deviation.push_back(0.0);
    }
    fill_measured(o);
    f.duration = set_up + per_feature * static_cast<double>(rows_.size()) / 2.0;
    return f;
  }

  const Part& part_;
  const Observations& o_;
  std::string body_;
  std::vector<std::size_t> rows_;
  std::array<const std::vector<double>*, 3> at_{};
  Box box_;
};

}  // namespace

std::vector<Further> further_parts(const Part& part) { return OneMorePart(part).all(); }

void add_set_up_of_part(Further& further, const std::vector<Term>& model) {
  for (const Term& term : model) {
    const std::string& name = term.axis.name;
    if (term.effect->is_nuisance && term.effect->instances) {
      const auto left = term.effect->instances(further.table);
      if (std::find(left.begin(), left.end(), name) == left.end())
        further.settled.push_back(term.name());
    }
    const bool of_body =
        !further.again.empty() && (name == further.body || name.starts_with(further.body + " "));
    if (!term.effect->is_nuisance || !of_body) continue;
    further.set_up.push_back(term);
    further.set_up.back().axis.name.insert(further.body.size(), further_body);
  }
}

MatrixXd as_error_of_part(const Part& part, const Further& further, MatrixXd columns) {
  const auto known = static_cast<Index>(part.table.size());
  for (Index i = known; i < columns.rows(); ++i) {
    const auto copy = static_cast<std::size_t>(i - known);
    if (copy < further.again.size())
      columns.row(i) = columns.row(static_cast<Index>(further.again[copy]));
    else
      columns.row(i).setZero();
  }
  return columns;
}

bool is_of_parts_alike(const Part& part) {
  const auto& lines = part.table.lines;
  return part.kind == Part::Kind::space && !in_bodies(part.table) &&
         std::any_of(lines.begin(), lines.end(), [](const auto& l) { return !l.body.empty(); });
}

}  // namespace nonio::model
