// SPDX-License-Identifier: Apache-2.0
#include "places.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <optional>
#include <set>
#include <tuple>

#include "nonio/math/rotary.h"

namespace nonio::rotary_chain {
namespace {

bool has_all(const Observations& o, const Chain& chain) {
  if (o.size() == 0 || o.angular) return false;
  for (const char* linear : {"X", "Y", "Z"})
    if (o.axis(linear) == nullptr) return false;
  return std::all_of(chain.axes.begin(), chain.axes.end(),
                     [&](const auto& axis) { return o.axis(axis) != nullptr; });
}

struct Place {
  math::ChainReading mean;
  double when = std::numeric_limits<double>::infinity();
};

class Collector {
 public:
  Collector(const Observations& o, const Chain& chain) : o_(o) {
    for (const std::string& axis : chain.axes) angles_.push_back(o.axis(axis));
    for (const char* linear : {"X", "Y", "Z"}) at_.push_back(o.axis(linear));
    timed_ = o.time.size() == o.size() &&
             std::all_of(o.time.begin(), o.time.end(), [](double t) { return std::isfinite(t); });
  }

  /// Ordered by time or, without times, by run and position. Returns a finding if a position is
  /// repeated in one run and direction.
  tl::expected<std::vector<Place>, Finding> places(std::size_t ball, std::size_t tool) {
    for (std::size_t i = 0; i < o_.size(); ++i) {
      if (o_.line_of(i) != 0) continue;  // each of the three lines contains the whole position
      math::ChainReading r;
      for (const auto* column : angles_) r.angle.push_back(column->position[i]);
      for (std::size_t k = 0; k < 3; ++k) r.at[k] = at_[k]->position[i];
      r.ball = ball, r.tool = tool;
      if (auto bad = seen_before(i, r)) return tl::unexpected(std::move(*bad));
      add(i, r);
    }
    std::vector<Place> out;
    for (auto& [key, place] : places_) out.push_back(std::move(place));
    std::sort(out.begin(), out.end(), [](const Place& a, const Place& b) {
      return std::tie(a.when, a.mean.angle) < std::tie(b.when, b.mean.angle);
    });
    return out;
  }

 private:
  std::vector<long long> key_of(const math::ChainReading& r) const {
    std::vector<long long> key;
    for (const double a : r.angle) key.push_back(math::place_in_turn(a));
    return key;
  }
  std::optional<Finding> seen_before(std::size_t i, const math::ChainReading& r) {
    const bool finite =
        std::all_of(r.angle.begin(), r.angle.end(), [](double a) { return std::fabs(a) < 1e6; });
    const auto& approach = o_.axes.front().approach;
    if (finite && seen_.emplace(o_.run_of(i), approach.empty() ? 0 : approach[i], r.angle).second)
      return std::nullopt;
    Finding repeated{.id = "rotary.repeated-angles", .attention = true};
    repeated.evidence = {{"angle", finite ? r.angle.front() : 0.0, Quantity::angle},
                         {"run", static_cast<double>(o_.run_of(i)), Quantity::count},
                         {"line", static_cast<double>(o_.source_line_of(i)), Quantity::count}};
    return repeated;
  }
  void add(std::size_t i, const math::ChainReading& r) {
    Place& place = places_[key_of(r)];
    if (place.mean.angle.empty()) place.mean = r, place.mean.weight = 0.0;
    place.mean.angle = std::min(place.mean.angle, r.angle);
    place.mean.weight += 1.0;
    for (std::size_t k = 0; k < 3; ++k)
      place.mean.at[k] += (r.at[k] - place.mean.at[k]) / place.mean.weight;
    // Without times, run and position give the order, because the row order has no meaning.
    place.when = std::min(place.when, timed_ ? o_.time[i] : static_cast<double>(o_.run_of(i)));
  }

  const Observations& o_;
  std::vector<const Observations::AxisColumn*> angles_, at_;
  bool timed_ = false;
  std::set<std::tuple<std::uint32_t, int, std::vector<double>>> seen_;
  std::map<std::vector<long long>, Place> places_;
};

std::size_t tool_of(const Measurement& m, Places& out) {
  for (std::size_t t = 0; t < out.tools.size(); ++t)
    if (out.tools[t]->tool_offset == m.tool_offset) return t;
  out.tools.push_back(&m);
  return out.tools.size() - 1;
}

double mean_square(const Observations& o, double& n) {
  double sum = 0.0;
  for (const double u : o.u)
    if (std::isfinite(u) && u > 0.0) sum += u * u, n += 1.0;
  return sum;
}

}  // namespace

bool same_state(const Measurement& a, const Measurement& b) {
  return state_of(a) == state_of(b) && a.adjustment == b.adjustment;
}

Places places_of(const AnalysisInput& in, const Chain& chain) {
  Places out;
  const auto& all = in.campaign.measurements;
  const auto same = in.options.texts("same_reference");
  const auto named = [&](const std::string& id) {
    return std::find(same.begin(), same.end(), id) != same.end();
  };
  double square = 0.0, n = 0.0;
  for (std::size_t i = 0; in.all != nullptr && i < std::min(all.size(), in.all->size()); ++i) {
    const Measurement& m = all[i];
    const Observations& o = (*in.all)[i];
    if (m.kind != "ball-centres" || !same_state(m, in.measurement) || o.size() == 0) continue;
    if (!has_all(o, chain)) {
      out.left_out.push_back(m.id);
      continue;
    }
    if (!out.used.empty() && !(named(m.id) && named(out.used.front()))) {
      out.findings.push_back({.id = "rotary-chain.reference-unknown",
                              .attention = true,
                              .texts = {{"one", out.used.front()}, {"other", m.id}}});
      continue;
    }
    const std::size_t tool = chain.tables < chain.axes.size() ? tool_of(m, out) : 0;
    auto places = Collector(o, chain).places(out.used.size(), tool);
    if (!places) {
      places.error().measurement = m.id;
      out.findings.push_back(std::move(places.error()));
      out.sound = false;
      return out;
    }
    for (Place& place : *places) out.readings.push_back(std::move(place.mean));
    square += mean_square(o, n);
    out.used.push_back(m.id);
    out.tables.push_back(&o);
  }
  out.stated_u = n > 0.0 ? std::sqrt(square / n) : 0.0;
  out.order = {chain.tables, chain.axes.size() - chain.tables,
               std::max<std::size_t>(1, out.used.size()),
               std::max<std::size_t>(1, out.tools.size())};
  return out;
}

}  // namespace nonio::rotary_chain
