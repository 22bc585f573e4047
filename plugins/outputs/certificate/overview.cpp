// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <utility>

#include "certificate.h"
#include "nonio/reports/number.h"
#include "nonio/sdk/format.h"

namespace nonio::certificate {

using namespace reports;
using Curve = Plot::Curve;

namespace {

const Conformity* limit_of(const OutputInput& in, const pages::Measured& m, const char* name) {
  for (const Results::Analysed* a : m.analyses)
    if (const Conformity* c = pages::conformity_of(in, *a, name)) return c;
  return nullptr;
}

struct Span {
  double low = INFINITY, high = -INFINITY;
  void add(double v) {
    if (std::isfinite(v)) low = std::min(low, v), high = std::max(high, v);
  }
};

/// Range of the points to which a limit applies, in printed units: mean and ± R/2 of both
/// directions with `scatter` (A), means only without (E).
Span span_of(const pages::Measured& m, bool scatter) {
  Span span;
  for (const Results::Analysed* a : m.analyses) {
    const PointTable& points = a->evaluation.points;
    for (const auto& [mean_name, R_name] : {std::pair("mean+", "R+"), std::pair("mean-", "R-")}) {
      const auto *mean = points.column(mean_name), *R = points.column(R_name);
      if (mean == nullptr || R == nullptr) continue;
      const double per_si = unit_of(mean->quantity).per_si;
      for (std::size_t i = 0; i < mean->values.size(); ++i) {
        const double half = scatter ? R->values[i] / 2.0 : 0.0;
        span.add((mean->values[i] - half) * per_si);
        span.add((mean->values[i] + half) * per_si);
      }
    }
  }
  return span;
}

bool add_limit(const Source& source, const pages::Measured& m, Plot& plot) {
  for (const char* name : {"A", "E"}) {
    const Conformity* limit = limit_of(source.in, m, name);
    const Span span = span_of(m, name[0] == 'A');
    if (limit == nullptr || !(span.low <= span.high) || plot.curves.empty()) continue;
    Span across;
    for (const Curve& c : plot.curves)
      for (const double x : c.x) across.add(x);
    const double half = limit->tolerance * unit_of(limit->quantity).per_si / 2.0;
    const double middle = (span.low + span.high) / 2.0;
    for (const double side : {-half, half}) {
      Curve line;
      line.x = {across.low, across.high};
      line.y = {middle + side, middle + side};
      line.colour = source.look.style.failed;
      line.width = 1.0;
      line.dash = Dash::dash_dot;
      if (side > 0)
        line.legend = source.words.get("overview.limit", {{"name", name}}) + " = " +
                      pages::plain_number(source, limit->tolerance, limit->quantity) + " " +
                      unit_text(limit->quantity);
      plot.curves.push_back(std::move(line));
    }
    return true;
  }
  return false;
}

void lay_under(const Source& source, const pages::Measured& before, Plot& plot) {
  for (const Results::Analysed* a : before.analyses) {
    const PointTable& points = a->evaluation.points;
    const auto* target = points.column("target");
    bool named = false;
    for (const char* name : {"mean+", "mean-"}) {
      const auto* mean = points.column(name);
      if (target == nullptr || mean == nullptr) continue;
      Curve c;
      for (std::size_t i = 0; i < mean->values.size(); ++i) {
        c.x.push_back(target->values[i] * unit_of(target->quantity).per_si);
        c.y.push_back(mean->values[i] * unit_of(mean->quantity).per_si);
      }
      c.colour = source.look.style.muted;
      c.width = 1.0;
      c.dash = name[4] == '+' ? Dash::solid : Dash::dashed;
      c.marker = name[4] == '+' ? Marker::up : Marker::down;
      c.marker_size = 1.6;
      if (!std::exchange(named, true)) c.legend = source.words.get("adjustment.before");
      plot.curves.insert(plot.curves.begin(), std::move(c));
    }
    if (named) return;
  }
}

const pages::Measured* as_found(const std::vector<pages::Measured>& all,
                                const pages::Measured& after) {
  if (after.measurement.adjustment != "after") return nullptr;
  for (const pages::Measured& m : all)
    if (m.measurement.adjustment == "before" && m.measurement.axis == after.measurement.axis &&
        m.measurement.kind == after.measurement.kind)
      return &m;
  return nullptr;
}

bool looks_alike(const Curve& a, const Curve& b) {
  return a.kind == b.kind && a.colour == b.colour && a.dash == b.dash && a.marker == b.marker;
}

Plot common_legend(std::vector<Plot>& plots) {
  Plot common;
  common.only_legend = true;
  const auto known = [&](const Curve& c) {
    return std::find_if(common.curves.begin(), common.curves.end(),
                        [&](const Curve& k) { return k.legend == c.legend; });
  };
  const auto is_own = [](const Curve& c) { return c.legend.empty() || c.dash == Dash::dash_dot; };
  for (Plot& plot : plots) {
    if (!plot.scales || std::any_of(plot.curves.begin(), plot.curves.end(), [&](const Curve& c) {
          return !is_own(c) && known(c) != common.curves.end() && !looks_alike(*known(c), c);
        }))
      continue;
    for (Curve& c : plot.curves) {
      if (is_own(c)) continue;
      if (known(c) == common.curves.end()) {
        common.curves.push_back(c);
        common.curves.back().x.clear(), common.curves.back().y.clear();
      }
      c.legend.clear();
    }
  }
  return common;
}

}  // namespace

void add_overview(const Source& source, Blocks& blocks) {
  constexpr std::size_t most = 6;
  const std::vector<pages::Measured> all = pages::measured(source.in);
  std::vector<Plot> plots;
  bool limits = false;
  const auto is_overlaid = [&](const pages::Measured& m) {
    return std::any_of(all.begin(), all.end(),
                       [&](const pages::Measured& o) { return as_found(all, o) == &m; });
  };
  for (const pages::Measured& m : all) {
    if (!is_printed(m) || is_overlaid(m) || plots.size() == most) continue;
    auto plot = pages::readings_plot(source, m);
    if (!plot) continue;
    if (plot->scales) {
      plot->title = pages::heading_of(source, m);
    } else {
      plot->x_title.clear();
      for (Curve& c : plot->curves) c.legend.clear();
    }
    if (const pages::Measured* before = as_found(all, m)) lay_under(source, *before, *plot);
    limits |= add_limit(source, m, *plot);
    plots.push_back(std::move(*plot));
  }
  if (plots.empty()) return;
  const std::size_t per_row = std::min<std::size_t>(plots.size(), plots.size() == 4 ? 2 : 3);
  const double height = plots.size() > 3 ? 92 : plots.size() == 1 ? 134 : 104;
  blocks.push_back({Spacer{3}});
  if (plots.size() > 1) blocks.push_back({common_legend(plots), "overview"});
  for (std::size_t i = 0; i < plots.size(); i += per_row) {
    Columns row;
    for (std::size_t k = i; k < std::min(i + per_row, plots.size()); ++k) {
      plots[k].height = height;
      row.parts.push_back({{std::move(plots[k]), "overview"}});
    }
    while (row.parts.size() < per_row) row.parts.emplace_back();
    blocks.push_back({std::move(row), "overview"});
  }
  if (limits)
    blocks.push_back(
        {Paragraph{source.words.get("overview.caption"), Paragraph::Look::muted}, "overview"});
}

}  // namespace nonio::certificate
