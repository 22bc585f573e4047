// SPDX-License-Identifier: Apache-2.0
#include "laboratory/assessment/fits.h"

#include <algorithm>
#include <vector>

#include "laboratory/assessment/bytes.h"
#include "platform/storage/digest.h"

namespace nonio::assessment {
namespace kernel = nonio::statistics;

namespace {

constexpr std::size_t key_size = 64;

/// Everything that affects a trend.
std::string key_of(char what, const kernel::Series& s) {
  ByteWriter w;
  w.put(what);
  w.each(s.points, [&](const kernel::Point& p) {
    w.put(p.time), w.put(p.value), w.put(p.u);
    w.each(p.common, [&](const kernel::Common& c) { w.put(c.source), w.put(c.u); });
  });
  w.each(s.declared, [&](const kernel::Declared& d) { w.put(d.after), w.put(d.kind); });
  w.put(s.steps.has_value());
  if (s.steps) w.each(*s.steps, [&](std::size_t after) { w.put(after); });
  w.put(s.seed), w.put(s.excess), w.put(s.spread), w.put(s.drift_below), w.put(s.own_slope);
  return storage::sha256(w.take());
}

std::string bytes_of(const kernel::Trend& t) {
  ByteWriter w;
  w.put(t.model);
  w.each(t.segments, [&](const kernel::Segment& s) { w.put(s); });
  w.each(t.changes, [&](const kernel::Change& c) {
    w.put(c.after), w.put(c.size), w.put(c.u), w.put(c.p), w.put(c.cause), w.put(c.declared);
  });
  w.put(t.chi2), w.put(t.dof), w.put(t.smallest_change), w.put(t.line_or_step);
  w.each(t.coefficients, [&](double x) { w.put(x); });
  w.each(t.covariance, [&](double x) { w.put(x); });
  w.put(t.drifts), w.put(t.walk);
  return w.take();
}

std::optional<kernel::Trend> trend_in(std::string_view bytes) {
  ByteReader r(bytes);
  kernel::Trend t;
  t.model = r.get<kernel::Model>();
  r.each([&] { t.segments.push_back(r.get<kernel::Segment>()); });
  r.each([&] {
    kernel::Change c;
    c.after = r.get<std::size_t>();
    c.size = r.get<double>(), c.u = r.get<double>(), c.p = r.get<double>();
    c.cause = r.get<kernel::Change::Cause>();
    c.declared = r.perhaps<std::size_t>();
    t.changes.push_back(c);
  });
  t.chi2 = r.get<double>(), t.dof = r.get<double>();
  t.smallest_change = r.perhaps<double>();
  t.line_or_step = r.get<bool>();
  r.each([&] { t.coefficients.push_back(r.get<double>()); });
  r.each([&] { t.covariance.push_back(r.get<double>()); });
  t.drifts = r.get<bool>(), t.walk = r.get<double>();
  return r.well() && r.at_end() ? std::optional(std::move(t)) : std::nullopt;
}

/// Whether it can be one of that series.
bool fits_in(const kernel::Trend& t, const kernel::Series& s) {
  const std::size_t n = s.points.size();
  const bool segments =
      std::all_of(t.segments.begin(), t.segments.end(),
                  [&](const kernel::Segment& g) { return g.from <= g.to && g.to < n; });
  const bool changes =
      std::all_of(t.changes.begin(), t.changes.end(), [&](const kernel::Change& c) {
        return c.after + 1 < n && (!c.declared || *c.declared < s.declared.size());
      });
  return segments && changes &&
         t.covariance.size() == t.coefficients.size() * t.coefficients.size();
}

}  // namespace

Fits Fits::of(std::string_view kept) {
  Fits fits;
  ByteReader r(kept);
  while (r.well() && !r.at_end()) {
    std::string key(r.text(key_size));
    std::string bytes;
    r(bytes);
    fits.kept_.emplace(std::move(key), Kept{std::move(bytes), false});
  }
  return r.well() ? std::move(fits) : Fits();
}

Fits::Kept* Fits::find(const std::string& key) {
  const auto found = kept_.find(key);
  if (found == kept_.end()) return nullptr;
  found->second.used = true;
  return &found->second;
}

kernel::Trend Fits::trend(const kernel::Series& series) {
  const std::string key = key_of('t', series);
  if (const Kept* kept = find(key))
    if (auto trend = trend_in(kept->bytes); trend && fits_in(*trend, series))
      return std::move(*trend);
  ++computed_;
  const auto trend = kernel::trend_of(series);
  kernel::Trend out = trend ? *trend : kernel::Trend{};
  kept_[key] = {bytes_of(out), true};
  return out;
}

std::optional<kernel::Slope> Fits::slope(const kernel::Series& series) {
  const std::string key = key_of('s', series);
  if (const Kept* kept = find(key)) {
    ByteReader r(kept->bytes);
    const auto slope = r.perhaps<kernel::Slope>();
    if (r.well() && r.at_end()) return slope;
  }
  ++computed_;
  const auto slope = kernel::slope_beside_steps(series);
  ByteWriter w;
  w.put(slope);
  kept_[key] = {w.take(), true};
  return slope;
}

bool Fits::is_new() const {
  return computed_ > 0 || std::any_of(kept_.begin(), kept_.end(),
                                      [](const auto& kept) { return !kept.second.used; });
}

std::string Fits::kept() const {
  ByteWriter w;
  for (const auto& [key, kept] : kept_) {
    if (!kept.used) continue;
    w.put_raw(key);
    w.put(kept.bytes);
  }
  return w.take();
}

}  // namespace nonio::assessment
