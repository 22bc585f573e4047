// SPDX-License-Identifier: Apache-2.0
#include "laboratory/assessment/tables_kept.h"

#include <algorithm>
#include <cmath>
#include <set>

#include "laboratory/assessment/days.h"
#include "laboratory/assessment/describe.h"
#include "laboratory/statistics/difference.h"
#include "nonio/sdk/withheld.h"

namespace nonio::assessment {

using store::StoredResult;

namespace {

constexpr double scatter_allowed = 2.0;  // multiple of s in the uncertainty of the prediction
constexpr double not_good_below = 0.01;  // significance level for all results of a table together

class OfAxis {
 public:
  OfAxis(const AssessedMachine& m, const std::string& axis) : m_(m), axis_(axis) {}

  std::optional<reports::TableKept> kept() {
    const auto left = last_left();
    if (!left || !one_measurement(*left)) return std::nullopt;
    const auto found = last_promised(*left);
    if (!found) return std::nullopt;
    const auto s = scatter(*left);
    if (!s || has_failed(*left)) return std::nullopt;
    return worst(*found, *left, *s);
  }

 private:
  const std::string& day(std::size_t campaign) const { return m_.stored.campaigns[campaign].day; }

  /// Returns the last campaign with as-left results; campaigns are sorted by date.
  std::optional<std::size_t> last_left() const {
    std::optional<std::size_t> out;
    for (const StoredResult& r : m_.stored.results)
      if (r.axis == axis_ && r.state == "as-left" && !r.followed)
        out = std::max(out.value_or(0), r.campaign);
    return out;
  }

  bool one_measurement(std::size_t campaign) const {
    std::set<std::string> left;
    for (const StoredResult& r : m_.stored.results)
      if (r.axis == axis_ && r.campaign == campaign && r.state == "as-left" && !r.followed)
        left.insert(r.measurement);
    return left.size() == 1;
  }

  /// Returns the last campaign with a prediction, at most `longest_until_left` days before `left`;
  /// std::nullopt if it has predictions of several measurements.
  std::optional<std::size_t> last_promised(std::size_t left) const {
    std::optional<std::size_t> out;
    std::set<std::string> measurements;
    for (const StoredResult& p : m_.stored.predicted) {
      if (p.axis != axis_ || p.campaign > left) continue;
      if (!out || p.campaign > *out) out = p.campaign, measurements.clear();
      measurements.insert(p.measurement);
    }
    if (!out || measurements.size() != 1) return std::nullopt;
    const auto from = day_number(day(*out)), to = day_number(day(left));
    if (!from || !to || *to - *from > longest_until_left) return std::nullopt;
    return out;
  }

  std::optional<double> scatter(std::size_t campaign) const {
    for (const StoredResult& r : m_.stored.results)
      if (r.followed && r.axis == axis_ && r.campaign == campaign && r.state == "as-left" &&
          r.quantity == "ln_s")
        return std::exp(r.value);
    return std::nullopt;
  }

  const StoredResult* result(std::size_t campaign, const std::string& quantity,
                             const std::string& state, const std::string& source) const {
    for (const StoredResult& r : m_.stored.results)
      if (!r.followed && r.axis == axis_ && r.campaign == campaign && r.quantity == quantity &&
          r.state == state && (source.empty() || r.source == source) && r.u_repeat)
        return &r;
    return nullptr;
  }

  static nonio::statistics::Point point(const StoredResult& r) {
    nonio::statistics::Point p{0.0, r.value, *r.u_repeat};
    for (const store::CommonPart& c : r.common) p.common.push_back({c.source, c.u});
    return p;
  }

  /// Whether a comparison of the states found that the compensation of the axis failed, which a
  /// value that happens to be near its prediction would contradict.
  bool has_failed(std::size_t campaign) const {
    const auto& asked = m_.stored.asked;
    if (campaign >= asked.size()) return false;
    return std::any_of(asked[campaign].begin(), asked[campaign].end(), [&](const auto& f) {
      return is_failed_compensation(f.id) &&
             std::any_of(m_.stored.results.begin(), m_.stored.results.end(), [&](const auto& r) {
               return r.campaign == campaign && r.axis == axis_ && r.measurement == f.measurement;
             });
    });
  }

  std::optional<reports::TableKept> worst(std::size_t found_in, std::size_t left_in,
                                          double s) const {
    std::optional<reports::TableKept> out;
    double most = 0.0, p = 1.0;
    std::size_t asked = 0;
    std::set<std::string> seen;
    for (const StoredResult& promised : m_.stored.predicted) {
      if (promised.axis != axis_ || promised.campaign != found_in ||
          !seen.insert(promised.quantity).second)
        continue;
      const StoredResult* found = result(found_in, promised.quantity, "as-found", "");
      if (found == nullptr) continue;
      const StoredResult* left = result(left_in, promised.quantity, "as-left", found->source);
      if (left == nullptr || left->conditions != found->conditions) continue;
      const auto check = nonio::statistics::check_table(
          point(*found), point(*left), promised.value - found->value, scatter_allowed * s);
      if (!check) continue;
      ++asked;
      const double zeta =
          check->from_predicted.zeta();  // negative for a result better than predicted
      if (zeta > 0.0) p = std::min(p, check->from_predicted.p);
      if (out && zeta <= most) continue;
      most = zeta;
      const Quantity q = quantity_of_unit(left->unit);
      out = {axis_, promised.quantity, m_.stored.campaigns[left_in].id, day(left_in)};
      out->unit = q;
      out->found = si(found->value, q), out->promised = si(promised.value, q);
      out->left = si(left->value, q);
    }
    if (out) out->good = !(p * static_cast<double>(asked) < not_good_below);
    return out;
  }

  const AssessedMachine& m_;
  const std::string& axis_;
};

}  // namespace

std::vector<reports::TableKept> tables_kept(const AssessedMachine& machine) {
  std::set<std::string> axes;
  for (const StoredResult& p : machine.stored.predicted) axes.insert(p.axis);
  std::vector<reports::TableKept> out;
  for (const std::string& axis : axes)
    if (auto kept = OfAxis(machine, axis).kept()) out.push_back(std::move(*kept));
  return out;
}

}  // namespace nonio::assessment
