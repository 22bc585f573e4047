// SPDX-License-Identifier: Apache-2.0
// Two effects, a slope and a wave, and their faults.
#include <numbers>
#include <stdexcept>

#include "nonio/sdk/axis_readings.h"
#include "spoiled.h"

namespace {

using namespace nonio;
using spoiled::has;
using Columns = Effect::Columns;

bool moves(const Observations& o, const Axis& axis) {
  if (has("applies-to-anything")) return true;
  const auto r = readings_of(o, axis);
  return r && r->length > 0.0;
}

void spoil(Columns& columns, const Observations& o, const AxisReadings& r, const Axis& axis) {
  auto& c = columns.front();
  const auto each = [&](const auto& change) {
    for (std::size_t i = 0; i < c.size(); ++i) c[i] = change(c[i], i);
  };
  if (has("in-mm")) each([](double x, std::size_t) { return 1e3 * x; });
  if (has("in-um")) each([](double x, std::size_t) { return 1e6 * x; });
  if (has("turned")) each([](double x, std::size_t) { return -x; });
  if (has("halved")) each([](double x, std::size_t) { return 0.5 * x; });
  if (has("without-sign")) each([](double x, std::size_t) { return std::fabs(x); });
  if (has("squared")) each([](double x, std::size_t) { return x * x; });
  if (has("from-the-first-target")) each([&](double x, std::size_t) { return x - c.front(); });
  if (has("towards-plus-only"))
    each([&](double x, std::size_t i) { return o.axes.front().approach[i] > 0 ? x : 0.0; });
  if (has("with-direction"))
    each([&](double x, std::size_t i) { return x * o.axes.front().approach[i]; });
  if (has("cut-off")) each([](double x, std::size_t) { return std::round(x * 100.0) / 100.0; });
  if (has("by-commanded-position"))
    each([&](double, std::size_t i) { return o.axes.front().position[i]; });
  if (has("a-constant")) each([](double, std::size_t) { return 1.0; });
  if (has("zeros")) each([](double, std::size_t) { return 0.0; });
  if (has("a-nan") && c.size() > 3) c[3] = spoiled::nan;
  if (has("infinite") && c.size() > 3) c[2] = spoiled::inf;
  if (has("an-entry-too-few") && !c.empty()) c.pop_back();
  if (has("an-entry-too-many")) c.push_back(0.0);
  if (has("a-column-too-many")) columns.push_back(Columns::value_type(o.size(), 1.0));
  if (has("by-the-order"))
    each([](double x, std::size_t i) { return x + 1e-3 * static_cast<double>(i); });
  if (has("by-the-row-before")) {
    const auto before = c;
    each([&](double x, std::size_t i) { return i == 0 ? x : 0.5 * (x + before[i - 1]); });
  }
  if (has("while-still"))
    each([&](double, std::size_t i) {
      const double x = o.axis(axis.name)->position[i];
      return std::isfinite(x) ? x : 0.0;
    });
  if (has("divided-by-length"))
    each([&](double x, std::size_t) { return x * r.length / r.length; });
  each([extra = 1e-6 * spoiled::impurity() + 1e-6 * spoiled::counted()](double x, std::size_t i) {
    return i == 0 ? x + extra : x;
  });
}

Expected<Columns> slope(const Observations& o, const Axis& axis, const std::vector<double>&) {
  if (has("refuses-all")) return fail("expected something else");
  if (has("throws")) throw std::runtime_error("wrong on purpose");
  if (has("crashes-without-readings") && o.size() == 0) spoiled::crash();
  if (has("crashes-with-one-reading") && o.size() == 1) spoiled::crash();
  if (has("hangs-without-times") && o.time.empty() && o.size() > 1) spoiled::hang();
  const auto r = readings_of(o, axis);
  if (!r) return fail(r.error());
  auto columns = columns_of(o, axis, [](const AxisReadings& a, std::size_t i) { return a.p[i]; });
  if (columns && !columns->empty()) spoil(*columns, o, *r, axis);
  return columns;
}

Expected<Columns> wave(const Observations& o, const Axis& axis, const std::vector<double>& shape) {
  if (shape.size() != 1 || !(shape[0] > 0.0)) return fail("expected a period");
  double w = 2.0 * std::numbers::pi / shape[0];
  if (has("wave-of-half-the-period")) w *= 2.0;
  if (has("wave-without-two-pi")) w = 1.0 / shape[0];
  if (has("wave-in-degrees")) w = 360.0 / shape[0];
  const auto sine = [w](const AxisReadings& r, std::size_t i) { return std::sin(w * r.p[i]); };
  const auto cosine = [w](const AxisReadings& r, std::size_t i) { return std::cos(w * r.p[i]); };
  if (has("wave-of-two-sines")) return columns_of(o, axis, sine, sine);
  if (has("wave-of-cosine-and-sine")) return columns_of(o, axis, cosine, sine);
  return columns_of(o, axis, sine, cosine);
}

std::vector<double> periods() {
  std::vector<double> grid;
  if (has("grid-with-holes")) return {0.02, 0.035, 0.06};
  if (has("grid-with-a-twin")) return {0.06, 0.06, 0.061};
  if (has("grid-that-falls")) return {0.07, 0.068, 0.066};
  if (has("grid-with-a-nan")) return {0.06, spoiled::nan, 0.061};
  for (double p = 0.06; p < 0.08; p *= 1.01) grid.push_back(p);
  return grid;
}

Effect made(const char* name, std::vector<Effect::Parameter> linear,
            Expected<Columns> (*columns)(const Observations&, const Axis&,
                                         const std::vector<double>&)) {
  Effect e;
  e.info = spoiled::info(name);
  e.linear = std::move(linear);
  if (has("without-parameters")) e.linear.clear();
  e.applies = moves;
  e.columns = columns;
  if (has("without-columns")) e.columns = nullptr;
  if (has("without-applies")) e.applies = nullptr;
  return e;
}

}  // namespace

NONIO_PLUGIN(registry) {
  spoiled::at_registration();
  if (has("registers-nothing")) return;
  registry.add(made("spoiled", {{"a", "slope", Quantity::deviation_per_length}}, slope));
  if (spoiled::fault().starts_with("wave-") || spoiled::fault().starts_with("grid-") ||
      has("none")) {
    Effect e =
        made("spoiled-wave",
             {{"a", "sine", Quantity::deviation}, {"b", "cosine", Quantity::deviation}}, wave);
    e.applies = [](const Observations& o, const Axis& a) { return !a.rotary && moves(o, a); };
    e.shapes = {{{"P", "period", Quantity::length},
                 [](const Observations&, const Axis&) { return periods(); }}};
    registry.add(e);
  }
}
