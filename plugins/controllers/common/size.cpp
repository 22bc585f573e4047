// SPDX-License-Identifier: Apache-2.0
#include "nonio/controllers/size.h"

#include <algorithm>
#include <cmath>
#include <span>

#include "nonio/controllers/text.h"
#include "nonio/math/loaded_table.h"
#include "nonio/sdk/format.h"

namespace nonio::controllers {
namespace {

/// A table that is 0 at a target cannot exceed E; one of more than twice E is not from this axis.
constexpr double times_explained = 2.0;

struct Explained {
  double E = 0.0, slope = 0.0;
};

Explained explained(const AxisJob& job) {
  Explained out;
  const auto take = [&](const math::ErrorCurve& curve) {
    out.E = std::max(out.E, math::before(curve).E());
    for (const auto* e : {&curve.plus, &curve.minus, &curve.mean})
      for (std::size_t i = 1; i < e->size(); ++i)
        out.slope = std::max(out.slope, std::fabs((*e)[i] - (*e)[i - 1]) /
                                            (curve.position[i] - curve.position[i - 1]));
  };
  take(job.curve);
  take(job.table_curve());
  if (job.measured) take(*job.measured);
  return out;
}

struct Limit {
  double value;
  std::string key;
};

Limit tighter(double of_readings, std::optional<double> of_maker, std::string key) {
  if (of_maker && *of_maker < of_readings) return {*of_maker, std::move(key)};
  return {of_readings, {}};
}

struct Limits {
  Limit largest, slope;
};

Limits limits_of(const AxisJob& job, double step, double shortest) {
  const Explained e = explained(job);
  const std::string largest = job.rotary ? "largest_arcsec" : "largest_um";
  const std::string slope = job.rotary ? "slope_arcsec_per_deg" : "slope_um_per_m";
  const auto in_si = [&](const std::string& key, Quantity q) {
    const auto v = job.setting(key);
    return v ? std::optional(*v / unit_of(q).per_si) : std::nullopt;
  };
  const double rounding = 2.0 * step;
  return {tighter(times_explained * e.E + std::fabs(job.present_backlash()) + rounding,
                  in_si(largest, deviation_of(job.rotary)), largest),
          tighter(times_explained * e.slope + (shortest > 0.0 ? rounding / shortest : 0.0),
                  in_si(slope, slope_of(job.rotary)), slope)};
}

void refuse(const AxisJob& job, const char* id, double found, double at, const Limit& limit,
            Quantity q, OutputResult& result) {
  result.findings.push_back(
      {id,
       true,
       {{"found", found, q},
        {"limit", limit.value, q},
        {"E", explained(job).E, deviation_of(job.rotary)},
        {"at", at, position_of(job.rotary)}},
       {{"axis", job.axis}, {"key", limit.key.empty() ? "E" : limit.key}},
       job.measurement,
       limit.key.empty()
           ? "The readings do not explain such a table: look at them, and at the axis, first."
           : "The machine's maker allows no more (" + limit.key +
                 "): repair or adjust the axis first; a table can only compensate the residual "
                 "error."});
}

}  // namespace

void TableSize::take(const std::vector<double>& position, const std::vector<double>& added) {
  for (std::size_t i = 0; i < std::min(position.size(), added.size()); ++i) {
    if (i == 0 && slope == 0.0) slope_from = position[0];
    if (i == 0 && largest == 0.0) largest_at = position[0];
    if (std::fabs(added[i]) > largest) largest = std::fabs(added[i]), largest_at = position[i];
    if (i == 0) continue;
    const double way = position[i] - position[i - 1];
    if (shortest == 0.0 || way < shortest) shortest = way;
    const double steep = std::fabs(added[i] - added[i - 1]) / way;
    if (steep > slope) slope = steep, slope_from = position[i - 1];
  }
}

TableSize size_of(const std::vector<LoadedTable>& tables, const std::string& axis,
                  const std::vector<double>& position) {
  TableSize size;
  for (const int direction : {1, -1}) {
    std::vector<double> sum(position.size(), 0.0);
    for (const LoadedTable& t : tables)
      if (t.output == axis && t.input.size() == 1 && t.input.front() == axis)
        for (std::size_t i = 0; i < sum.size(); ++i)
          sum[i] += math::added(t, std::span(&position[i], 1), direction);
    size.take(position, sum);
  }
  return size;
}

bool oversized(const AxisJob& job, const TableSize& size, double step, OutputResult& result) {
  const Limits limits = limits_of(job, step, size.shortest);
  const bool large = size.largest > limits.largest.value * (1.0 + 1e-9);
  const bool steep = size.slope > limits.slope.value * (1.0 + 1e-9);
  if (large)
    refuse(job, "table.refused-size", size.largest, size.largest_at, limits.largest,
           deviation_of(job.rotary), result);
  if (steep)
    refuse(job, "table.refused-slope", size.slope, size.slope_from, limits.slope,
           slope_of(job.rotary), result);
  return large || steep;
}

std::string size_words(const AxisJob& job, const TableSize& size) {
  const Unit slope = unit_of(slope_of(job.rotary));
  const auto limit = [&](const char* linear, const char* rotary, std::string_view unit) {
    const auto v = job.setting(job.rotary ? rotary : linear);
    return v ? " (maker's limit " + decimal(*v, 3) + " " + std::string(unit) + ")" : std::string();
  };
  return "largest entry " + deviation_words(job, size.largest) +
         limit("largest_um", "largest_arcsec", unit_of(deviation_of(job.rotary)).symbol) + " at " +
         with_unit(job, size.largest_at, 4) + ", steepest " +
         decimal(size.slope * slope.per_si, 3) + " " + std::string(slope.symbol) +
         limit("slope_um_per_m", "slope_arcsec_per_deg", slope.symbol) + " from " +
         with_unit(job, size.slope_from, 4) +
         (job.scale_known && job.curve.left_out == 0
              ? std::string("; E of the axis ") + (job.had_table ? "without any table " : "") +
                    deviation_words(job, explained(job).E)
              : std::string());
}

void note_zero(const AxisJob& job, double zero, OutputResult& result) {
  Remark note =
      remark(job, job.position_setting("reference") ? "table.zero-at" : "table.zero-taken");
  note.evidence = {{"reference", zero, position_of(job.rotary)}};
  result.notes.push_back(std::move(note));
}

void note_size(const AxisJob& job, const TableSize& size, OutputResult& result) {
  Remark note = remark(job, !job.scale_known ? "table.size-of-shape"
                            : job.had_table  ? "table.size-without-table"
                                             : "table.size");
  const Quantity q = deviation_of(job.rotary);
  note.evidence = {{"largest", size.largest, q}, {"slope", size.slope, slope_of(job.rotary)}};
  if (job.scale_known) note.evidence.push_back({"E", explained(job).E, q});
  result.notes.push_back(std::move(note));
}

}  // namespace nonio::controllers
