// SPDX-License-Identifier: Apache-2.0
#include "check.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>
#include <tuple>

#include "nonio/math/distributions.h"

namespace nonio::rtcp {
namespace {

constexpr double surely = 1e-3;  // significance level of residuals above the stated sigma

Finding finding(const char* id, std::vector<Number> evidence,
                std::vector<std::pair<std::string, std::string>> texts = {}) {
  return {.id = id, .attention = true, .evidence = std::move(evidence), .texts = std::move(texts)};
}

const char* name_of(math::RtcpRefusal refusal) {
  switch (refusal) {
    case math::RtcpRefusal::none_go_round:
      return "rtcp.none-go-round";
    case math::RtcpRefusal::not_a_circle:
      return "rtcp.not-a-circle";
    case math::RtcpRefusal::disagree:
      break;
  }
  return "rtcp.places-disagree";
}

class Check {
 public:
  Check(const Campaign& c, const Observations& o, std::string axis, const Environment& e,
        const Wish& wish)
      : campaign_(c), o_(o), axis_(std::move(axis)), environment_(e), wish_(wish) {}

  Checked done() {
    if (!wish_.head) {
      refuse(finding("rtcp.carries-needed", {}, {{"axis", axis_}}));
    } else if (columns() && fitted() && with_sigma()) {
      out_.given = true;
      name();
      budget();
      tell_wide();
      report_not_identifiable();
    }
    return std::move(out_);
  }

 private:
  bool refuse(Finding f) {
    out_.findings.push_back(std::move(f));
    return false;
  }

  bool columns() {
    const auto *x = o_.axis("X"), *y = o_.axis("Y"), *z = o_.axis("Z");
    if (o_.axes.empty() || !o_.axes.front().rotary || x == nullptr || y == nullptr || z == nullptr)
      return refuse(finding("rtcp.none-go-round", {{"lines", 0.0, Quantity::count}}));
    probe_ = std::all_of(o_.lines.begin(), o_.lines.end(), [](const auto& line) {
      return line.name.ends_with(" found x") || line.name.ends_with(" found y") ||
             line.name.ends_with(" found z");
    });
    // Sorted by line name and time, because the order of the rows has no meaning.
    std::vector<std::size_t> rank(o_.lines.size());
    for (const auto& line : o_.lines) names_.push_back(line.name);
    std::sort(names_.begin(), names_.end());
    for (std::size_t l = 0; l < rank.size(); ++l)
      rank[l] = static_cast<std::size_t>(std::find(names_.begin(), names_.end(), o_.lines[l].name) -
                                         names_.begin());
    const std::vector<double> when = math::reading_times(o_);
    std::vector<std::size_t> order(o_.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    const auto key = [&](std::size_t i) {
      const std::size_t line = rank[o_.line_of(i)];
      return std::tuple(probe_ ? static_cast<std::size_t>(names_[line].back() - 'x') : line,
                        probe_ ? line : 0, when[i], o_.axes[0].position[i], o_.deviation[i]);
    };
    std::sort(order.begin(), order.end(),
              [&](std::size_t a, std::size_t b) { return key(a) < key(b); });
    for (const std::size_t i : order) {
      if (!std::isfinite(o_.axes[0].position[i])) continue;
      out_.row.push_back(i);
      out_.readings.push_back({o_.axes[0].position[i],
                               {x->position[i], y->position[i], z->position[i]},
                               o_.sense_of(i),
                               o_.deviation[i],
                               rank[o_.line_of(i)],
                               probe_});
    }
    return true;
  }

  bool fitted() {
    auto fit = math::fit_rtcp(out_.readings, {*wish_.head, wish_.U_ball.has_value()});
    if (!fit)
      return refuse(finding(name_of(fit.error()),
                            {{"lines", static_cast<double>(o_.lines.size()), Quantity::count},
                             {"limit", math::rtcp_circle, Quantity::deviation}}));
    out_.fit = std::move(*fit);
    return true;
  }

  bool with_sigma() {
    const math::RtcpFit& fit = out_.fit;
    const auto dof = static_cast<double>(fit.dof);
    if (wish_.sigma) {
      const double ratio = fit.s / *wish_.sigma;
      if (fit.dof == 0 || !math::significant(math::f_upper(ratio * ratio, dof, 1e9), surely)) {
        out_.sigma = *wish_.sigma;
        return true;
      }
      out_.findings.push_back(finding(
          "rtcp.scatter",
          {{"s", fit.s, Quantity::deviation}, {"sigma", *wish_.sigma, Quantity::deviation}}));
    }
    if (fit.dof < 2)
      return refuse(finding(
          "rtcp.too-few", {{"readings", static_cast<double>(out_.readings.size()), Quantity::count},
                           {"dof", dof, Quantity::count}}));
    out_.sigma = fit.s;
    out_.dof = dof;
    return true;
  }

  void name() {
    for (std::size_t k = 0; k < 2; ++k) {
      out_.names[k] = std::string("centre_error_") + "xyz"[out_.fit.across[k]];
      out_.names[2 + k] = std::string("direction_error_") + "ijk"[out_.fit.across[k]];
    }
  }

  /// Squareness and scale errors (within +-bound) of the linear axes that follow the ball. They are
  /// zero at the axis point stored in the control.
  math::ReadingModel::Input linear_axes(double bound) const {
    const double u = bound / std::numbers::sqrt3;
    const math::Vector3& middle = out_.fit.point;
    math::ReadingModel::Input input;
    double widest = 0.0;
    for (const auto& [of, by] :
         {std::pair{0U, 1U}, {0U, 2U}, {1U, 2U}, {0U, 0U}, {1U, 1U}, {2U, 2U}}) {
      std::vector<double> row;
      for (const auto& r : out_.readings) {
        row.push_back(u * r.sense[of] * (r.at[by] - middle[by]));
        widest = std::max(widest, std::fabs(r.at[by] - middle[by]));
      }
      input.patterns.push_back(std::move(row));
    }
    input.is = {.id = "linear-axes",
                .u = u * widest,
                .with_length = true,
                .distribution = Distribution::rectangular,
                .correlation = Correlation::device,
                .source = "options.rtcp.linear_axes_urad"};
    input.of_line.assign(out_.model.lines.size(), u);
    return input;
  }

  math::ReadingModel::Input ball_place(double U) const {
    math::ReadingModel::Input input;
    for (std::size_t b = 0; b < out_.fit.place.size(); ++b)
      for (std::size_t k = 0; k < 3; ++k) {
        std::vector<double> row(out_.readings.size(), 0.0);
        for (std::size_t i = 0; i < row.size(); ++i)
          if (out_.fit.ball[out_.readings[i].line] == b) row[i] = U / 2.0 * out_.fit.by_ball[k][i];
        input.patterns.push_back(std::move(row));
      }
    input.is = {.id = "ball-place",
                .u = U / 2.0,
                .distribution = Distribution::normal,
                .correlation = Correlation::device,
                .source = "options.rtcp.ball_um"};
    input.of_line.assign(out_.model.lines.size(), U / 2.0);
    return input;
  }

  void budget() {
    std::vector<math::BudgetLine> lines;
    std::size_t last = o_.lines.size();
    for (std::size_t i = 0; i < out_.readings.size(); ++i) {
      const auto& r = out_.readings[i];
      const std::size_t group =
          probe_ ? static_cast<std::size_t>(names_[r.line].back() - 'x') : r.line;
      if (group != last) {
        lines.emplace_back();
        lines.back().kind =
            probe_ ? math::BudgetLine::Kind::coordinate : math::BudgetLine::Kind::lateral;
        lines.back().group = group;
        if (probe_) {
          const std::string axis(1, "XYZ"[group]);
          const double whole = 1.0;
          math::put_expansion(lines.back(), campaign_, {&axis, 1}, {&whole, 1});
        }
        last = group;
      }
      lines.back().length.push_back(probe_ ? r.at[group] - out_.fit.point[group] : 0.0);
    }
    out_.model = math::reading_model(campaign_, environment_, std::move(lines));
    if (wish_.linear_axes)
      out_.model.inputs.push_back(linear_axes(*wish_.linear_axes));
    else
      out_.model.missing.emplace_back("options.rtcp.linear_axes_urad");
    if (wish_.U_ball) out_.model.inputs.push_back(ball_place(*wish_.U_ball));
    if (std::isfinite(out_.dof) && !out_.fit.residual_by.empty())
      out_.model.see_residuals(out_.fit.residual_by, out_.dof);
  }

  void tell_wide() {
    const auto u = whole_u(out_);
    for (std::size_t k = 0; k < 4; ++k) {
      const double limit = k < 2 ? wish_.tolerance : wish_.tolerance_direction;
      if (!out_.fit.identifiable[k] || 2.0 * u[k] <= limit) continue;
      out_.wide[k] = 2.0 * u[k];
      const Quantity q = k < 2 ? Quantity::deviation : Quantity::small_angle;
      out_.findings.push_back(finding("rtcp.too-uncertain",
                                      {{"U", 2.0 * u[k], q}, {"tolerance", limit, q}},
                                      {{"name", out_.names[k]}}));
    }
  }

  void report_not_identifiable() {
    std::string by_ball, by_direction;
    for (std::size_t k = 0; k < 4; ++k) {
      if (out_.fit.identifiable[k]) continue;
      std::string& list = out_.fit.identifiable_with_ball[k] ? by_ball : by_direction;
      list += (list.empty() ? "" : ", ") + out_.names[k];
    }
    std::string lines;
    for (const std::string& line : names_) lines += (lines.empty() ? "" : ", ") + line;
    if (!by_ball.empty())
      out_.findings.push_back(finding("rtcp.not-identifiable-ball", {}, {{"names", by_ball}}));
    if (!by_direction.empty())
      out_.findings.push_back(
          finding("rtcp.not-identifiable", {}, {{"names", by_direction}, {"lines", lines}}));
  }

  const Campaign& campaign_;
  const Observations& o_;
  std::string axis_;
  const Environment& environment_;
  const Wish& wish_;
  Checked out_;
  bool probe_ = false;
  std::vector<std::string> names_;
};

}  // namespace

double Checked::u_repetition(std::size_t value) const {
  double square = 0.0;
  for (const double by : fit.by[value]) square += by * by;
  return sigma * std::sqrt(square);
}

std::array<double, 4> whole_u(const Checked& c) {
  const math::BudgetOf budget(c.model, c.sigma, c.dof, Quantity::deviation);
  std::array<double, 4> out{};
  for (std::size_t k = 0; k < 4; ++k)
    if (c.fit.identifiable[k])
      out[k] = budget.expand(c.u_repetition(k), c.model.shares(c.fit.by[k])).u;
  return out;
}

Checked check(const Campaign& c, const Observations& o, const std::string& axis,
              const Environment& e, const Wish& wish) {
  return Check(c, o, axis, e, wish).done();
}

}  // namespace nonio::rtcp
