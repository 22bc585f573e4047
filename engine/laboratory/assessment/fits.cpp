// SPDX-License-Identifier: Apache-2.0
#include "laboratory/assessment/fits.h"

#include <algorithm>

#include "platform/storage/digest.h"

namespace nonio::storage {

NONIO_MEMBERS(statistics::Common, a, b)
NONIO_MEMBERS(statistics::Point, a, b, c, d)
NONIO_MEMBERS(statistics::Declared, a, b)
NONIO_MEMBERS(statistics::Series, a, b, c, d, e, f, g, h)
NONIO_MEMBERS(statistics::Segment, a, b, c, d, e, f, g, h)
NONIO_MEMBERS(statistics::Change, a, b, c, d, e, f)
NONIO_MEMBERS(statistics::Trend, a, b, c, d, e, f, g, h, i, j, k)

}  // namespace nonio::storage

namespace nonio::assessment {
namespace kernel = nonio::statistics;

namespace {

std::string key_of(char what, const kernel::Series& s) {
  return storage::sha256(storage::pack(what, s));
}

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
  std::map<std::string, std::string> all;
  Fits fits;
  if (storage::unpack(kept, all))
    for (auto& [key, bytes] : all) fits.kept_.emplace(key, Kept{std::move(bytes), false});
  return fits;
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
    if (kernel::Trend trend; storage::unpack(kept->bytes, trend) && fits_in(trend, series))
      return trend;
  ++computed_;
  const auto trend = kernel::trend_of(series);
  kernel::Trend out = trend ? *trend : kernel::Trend{};
  kept_[key] = {storage::pack(out), true};
  return out;
}

std::optional<kernel::Slope> Fits::slope(const kernel::Series& series) {
  const std::string key = key_of('s', series);
  if (const Kept* kept = find(key)) {
    std::optional<kernel::Slope> slope;
    if (storage::unpack(kept->bytes, slope)) return slope;
  }
  ++computed_;
  const auto slope = kernel::slope_with_steps(series);
  kept_[key] = {storage::pack(slope), true};
  return slope;
}

bool Fits::is_new() const {
  return computed_ > 0 || std::any_of(kept_.begin(), kept_.end(),
                                      [](const auto& kept) { return !kept.second.used; });
}

std::string Fits::kept() const {
  std::map<std::string, std::string> all;
  for (const auto& [key, kept] : kept_)
    if (kept.used) all.emplace(key, kept.bytes);
  return storage::pack(all);
}

}  // namespace nonio::assessment
