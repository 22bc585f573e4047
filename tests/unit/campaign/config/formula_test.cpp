// SPDX-License-Identifier: Apache-2.0
#include "campaign/config/formula.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>

#include "campaign/config/manifest.h"
#include "campaign/reading/formula_copy.h"
#include "methods.h"
#include "nonio/sdk/axis_readings.h"

namespace nonio::formula_test {

namespace {

constexpr double pi = std::numbers::pi;
using P = Formula::Parameter;

const Axis x{.name = "X"}, c{.name = "C", .rotary = true};
const P a{"a", Quantity::deviation}, b{"b", Quantity::deviation};

P ranged(const char* name, Quantity q, double start, double low, double high) {
  return {name, q, start, std::pair{low, high}};
}

Formula formula(std::string expression, std::vector<P> parameters, const Axis& axis = x) {
  return {"mine", axis.name, std::move(expression), std::move(parameters), 7};
}

/// Three runs there and back over 11 uneven targets of 1 m (or 1 rad), 10 s a reading.
Observations readings(const Axis& axis) {
  Observations o;
  o.axes = {{axis.name, axis.rotary, {}, {}}};
  o.lines = {{"1", {}}};
  for (int i = 0; i < 66; ++i) {
    const int step = i % 22, target = step < 11 ? step : 21 - step;
    o.axes[0].position.push_back(0.1 * target + (target % 10 == 0 ? 0.0 : 0.01 * std::sin(target)));
    o.axes[0].approach.push_back(step < 11 ? 1 : -1);
    o.run.push_back(static_cast<std::uint32_t>(1 + i / 22));
    o.time.push_back(10.0 * i);
    o.material.push_back(20.0 + 0.01 * i);
    o.source_line.push_back(static_cast<std::uint32_t>(i + 2));
    o.deviation.push_back(0.0);
  }
  return o;
}

std::string complaint(const Formula& f, const Axis& axis = x) {
  const auto e = config::formula_effect(f, axis);
  if (e) return "accepted";
  EXPECT_EQ(e.error().line, f.line);
  return e.error().message;
}

#define EXPECT_SAYS(text, part) \
  EXPECT_NE((text).find(part), std::string::npos) << "  said: " << (text)

Effect one_column(const char* name, double (*value)(const AxisReadings&, std::size_t, double),
                  std::vector<double> grid = {}) {
  Effect e;
  e.info.name = name;
  e.linear = {{"a", "", Quantity::number}};
  if (!grid.empty())
    e.shapes = {{{"s", "", Quantity::time}, [grid](const auto&, const auto&) { return grid; }}};
  e.applies = [](const Observations&, const Axis&) { return true; };
  e.columns = [value](const Observations& o, const Axis& axis, const std::vector<double>& shape) {
    return columns_of(o, axis, [&](const AxisReadings& r, std::size_t i) {
      return value(r, i, shape.empty() ? 0.0 : shape[0]);
    });
  };
  return e;
}

}  // namespace

TEST(Formula, ColumnsAreTheTermsOfTheLinearParameters) {
  const auto e = config::formula_effect(
      formula("a*p/(100*mm) + b*d*exp(-t/tau)", {a, b, ranged("tau", Quantity::time, 60, 20, 600)}),
      x);
  ASSERT_TRUE(e) << e.error().message;
  ASSERT_EQ(e->linear.size(), 2u);
  ASSERT_EQ(e->shapes.size(), 1u);
  EXPECT_EQ(e->linear[1].name, "b");
  EXPECT_EQ(e->shapes[0].parameter.quantity, Quantity::time);
  const Observations o = readings(x);
  ASSERT_TRUE(e->applies(o, x));
  const auto columns = e->columns(o, x, {100.0});
  ASSERT_TRUE(columns) << columns.error().message;
  const auto r = readings_of(o, x);
  for (std::size_t i = 0; i < o.size(); ++i) {
    EXPECT_NEAR((*columns)[0][i], r->p[i] / 0.1, 1e-12);
    EXPECT_NEAR((*columns)[1][i], r->d[i] * std::exp(-r->t[i] / 100.0), 1e-12);
  }
}

TEST(Formula, RunsAreCountedWhateverTheirNumbers) {
  const auto e = config::formula_effect(formula("a*run + b*runs", {a, b}), x);
  ASSERT_TRUE(e) << e.error().message;
  Observations o = readings(x);
  const auto before = e->columns(o, x, {});
  for (std::uint32_t& run : o.run) run = 5 + 2 * run;
  const auto after = e->columns(o, x, {});
  ASSERT_TRUE(before && after);
  EXPECT_EQ(*after, *before);
  EXPECT_EQ((*before)[0].back(), 3.0);
  EXPECT_EQ((*before)[1].front(), 3.0);
}

TEST(Formula, RowsOfAnotherAxisAreZero) {
  const auto e = config::formula_effect(formula("a*cos(theta/(1*m))", {a}), x);
  ASSERT_TRUE(e) << e.error().message;
  Observations o = readings(x);
  o.axes[0].approach[5] = 0;
  const auto columns = e->columns(o, x, {});
  ASSERT_TRUE(columns);
  EXPECT_EQ((*columns)[0][5], 0.0);
  EXPECT_NEAR((*columns)[0][6], std::cos(o.axes[0].position[6]), 1e-14);
  EXPECT_FALSE(e->applies(o, c));
}

TEST(Formula, ParametersComeInTheirUnits) {
  // 1 um/m is 1e-6 whatever the expression's own units; an angle is an angle.
  const auto slope =
      config::formula_effect(formula("a*p", {{"a", Quantity::deviation_per_length}}), x);
  ASSERT_TRUE(slope) << slope.error().message;
  EXPECT_NEAR((*slope->columns(readings(x), x, {}))[0][0], -0.5, 1e-12);
  const auto turn = config::formula_effect(
      formula("a*sin(2*theta) + b*sin(theta/(0.5*rad))",
              {{"a", Quantity::angular_deviation}, {"b", Quantity::angular_deviation}}, c),
      c);
  ASSERT_TRUE(turn) << turn.error().message;
  const auto columns = *turn->columns(readings(c), c, {});
  EXPECT_NEAR(columns[0][10], std::sin(2.0), 1e-12);
  EXPECT_NEAR(columns[1][10], std::sin(2.0), 1e-12);
}

TEST(Formula, TheSearchCoversTheRangeAndTheStart) {
  const auto e = config::formula_effect(
      formula("a*sin(2*_pi*p/P)", {a, ranged("P", Quantity::length, 0.0123, 0.005, 0.05)}), x);
  ASSERT_TRUE(e) << e.error().message;
  const auto grid = e->shapes[0].grid(readings(x), x);
  EXPECT_NEAR(grid.front(), 0.005, 1e-15);
  EXPECT_NEAR(grid.back(), 0.05, 1e-12);
  EXPECT_EQ(std::count(grid.begin(), grid.end(), 0.0123), 1);
  EXPECT_TRUE(std::is_sorted(grid.begin(), grid.end()));
}

TEST(Formula, UnitsAreChecked) {
  EXPECT_SAYS(complaint(formula("a*p*p", {a})), "length^3");
  EXPECT_SAYS(complaint(formula("a*p", {{"a", Quantity::ratio}})), "accepted");
  EXPECT_SAYS(complaint(formula("a*t", {a})), "time^1");
  EXPECT_SAYS(complaint(formula("a*sin(p)", {a})), "depends on the unit of length");
  EXPECT_SAYS(complaint(formula("a*exp(-t/60)", {a})), "depends on the unit of time");
  EXPECT_SAYS(complaint(formula("a*exp(-t/(60*s))", {a})), "accepted");
  EXPECT_SAYS(complaint(formula("a*K", {a})), "temperature^1");
  EXPECT_SAYS(complaint(formula("a*p*K", {{"a", Quantity::expansion}})), "accepted");
  EXPECT_SAYS(complaint(formula("t > 100 ? a : 0", {a})), "unit of time");
  EXPECT_SAYS(complaint(formula("t > 100*s ? a : 0", {a})), "accepted");
  EXPECT_SAYS(complaint(formula("a*run", {a})), "accepted");
  // An angle has no unit of length; a deviation of a rotary axis is an angle.
  EXPECT_SAYS(complaint(formula("a*sin(theta)", {a}, c), c),
              "length^1 where a deviation has length^0");
  EXPECT_SAYS(complaint(formula("a*p", {{"a", Quantity::deviation_per_angle}}, c), c), "accepted");
}

TEST(Formula, WhatCannotBeUnderstoodIsNamed) {
  EXPECT_SAYS(complaint(formula("a*sin(thta)", {a})),
              "unknown name \"thta\" at position 7 (nearest: \"theta\")");
  EXPECT_SAYS(complaint(formula("a*(p", {a})), "parenthesis");
  EXPECT_SAYS(complaint(formula("a*", {a})), "ends too early");
  EXPECT_SAYS(complaint(formula("a**p", {a})), "position 3");
  EXPECT_SAYS(complaint(formula("", {a})), "formula mine");
  EXPECT_SAYS(complaint(formula("a = 3", {a})), "assignment at position 3");
  EXPECT_SAYS(complaint(formula("a, a", {a})), "comma");
  EXPECT_SAYS(complaint(formula("(a, a)", {a})), "formula mine");
  EXPECT_SAYS(complaint(formula("a*\"text\"", {a})), "position 3");
  EXPECT_SAYS(complaint(formula("a*p\xC2\xB2", {a})), "position 4");
  EXPECT_SAYS(complaint(formula(std::string(500, '('), {a})), "400 characters");
  EXPECT_SAYS(complaint(formula("a*mm", {{"mm", Quantity::length}})), "name is taken");
  EXPECT_SAYS(complaint(formula("sin*a", {a, {"sin", Quantity::number}})), "formula mine");
  EXPECT_SAYS(complaint(formula("a*p", {a, {"2b", Quantity::number}})), "not valid");
}

TEST(Formula, WhatIsNotLinearNeedsARange) {
  EXPECT_SAYS(complaint(formula("a + b*b/(1*um)", {a, b})), "\"b\" does not enter linearly");
  EXPECT_SAYS(complaint(formula("a*p/P", {a, {"P", Quantity::length}})), "needs start and range");
  EXPECT_SAYS(complaint(formula("a*b/(1*um)", {a, b})), "multiplied");
  EXPECT_SAYS(complaint(formula("a + 3*um", {a})), "every term needs a parameter");
  EXPECT_SAYS(complaint(formula("a", {a, b})), "\"b\" is not in the expression");
  EXPECT_SAYS(complaint(formula("a + 0*b", {a, b})), "\"b\" changes nothing");
  EXPECT_SAYS(complaint(formula("p*P/P", {ranged("P", Quantity::length, 1, 1, 2)})),
              "expected a linear parameter");
}

TEST(Formula, ValuesThatAreNotFiniteAreRefused) {
  EXPECT_SAYS(complaint(formula("a*log(p/(1*m))", {a})), "no finite value at p = ");
  EXPECT_SAYS(complaint(formula("a*s/t", {a})), "no finite value at t = 0.00 s");
  EXPECT_SAYS(complaint(formula("a*t/tau", {a, ranged("tau", Quantity::time, 1, 0, 5)})),
              "tau = 0");
  // Only these readings show it.
  const auto e =
      config::formula_effect(formula("a/(1 - floor(t/(600*s)) * (1 - floor(t/(660*s))))", {a}), x);
  ASSERT_FALSE(e);
  const auto rare = config::formula_effect(formula("a*m/(p-0.5*m)", {a}), x);
  ASSERT_TRUE(rare) << rare.error().message;
  const auto columns = rare->columns(readings(x), x, {});
  ASSERT_FALSE(columns);
  EXPECT_EQ(columns.error().line, 12u);  // the reading at 1 m
}

TEST(Formula, TooManyParameters) {
  std::string sum;
  std::vector<P> many;
  for (int k = 0; k < 9; ++k) {
    many.push_back({"a" + std::to_string(k), Quantity::deviation});
    sum += (k == 0 ? "" : "+") + many.back().name;
  }
  EXPECT_SAYS(complaint(formula(sum, many)), "too many parameters");
}

TEST(Formula, KNeedsAMeasuredTemperature) {
  const auto e = config::formula_effect(formula("a*p*K", {{"a", Quantity::expansion}}), x);
  ASSERT_TRUE(e);
  Observations o = readings(x);
  EXPECT_TRUE(e->applies(o, x));
  o.material.clear();
  EXPECT_FALSE(e->applies(o, x));
}

TEST(Formula, ACopyIsNamed) {
  const Observations o = readings(x);
  const std::vector<Effect> catalogue{
      one_column("scale", [](const AxisReadings& r, std::size_t i, double) { return r.p[i]; }),
      one_column("backlash", [](const AxisReadings& r, std::size_t i, double) { return r.d[i]; }),
      one_column("warm-up",
                 [](const AxisReadings& r, std::size_t i, double tau) {
                   return r.p[i] * std::exp(-r.t[i] / tau);
                 },
                 {20.0, 60.0, 180.0, 540.0})};
  const auto copy = [&](const std::string& text, std::vector<P> parameters) {
    const auto e = config::formula_effect(formula(text, std::move(parameters)), x);
    EXPECT_TRUE(e) << e.error().message;
    const auto name = reading::copy_of(o, x, *e, catalogue);
    EXPECT_TRUE(name) << name.error().message;
    return *name;
  };
  EXPECT_EQ(copy("a*theta", {{"a", Quantity::ratio}}), "scale");
  EXPECT_EQ(copy("a*(theta - p)/(1*mm)", {a}), "zero");
  EXPECT_EQ(copy("a*theta/m + b", {a, b}), "scale");
  EXPECT_EQ(copy("d > 0 ? a : 0", {a}), "backlash");
  EXPECT_EQ(copy("a*(p/m)^2", {a}), "");
  EXPECT_EQ(copy("a*d*p/m", {a}), "");
  // A fixed time constant between those of the grid, and a searched one.
  EXPECT_EQ(copy("a*p/m*exp(-t/(100*s))", {a}), "warm-up");
  EXPECT_EQ(copy("a*p/m*exp(-t/q)", {a, ranged("q", Quantity::time, 100, 10, 1000)}), "warm-up");
  EXPECT_EQ(copy("a*p/m*exp(-(t/(100*s))^2)", {a}), "");
}

TEST(Formula, AnyBytesGiveAnEffectOrAnError) {
  const unsigned seed = std::random_device{}();
  SCOPED_TRACE("seed " + std::to_string(seed));
  std::mt19937 random(seed);
  const std::vector<std::string> pieces{
      "a",      "b",  "p",  "theta", "d",    "t",    "K",    "run",  "P",      "+",     "-",
      "*",      "/",  "^",  "(",     ")",    ",",    "?",    ":",    "<",      ">",     "==",
      "!=",     "<=", "&&", "||",    "sin(", "exp(", "min(", "sum(", "atan2(", "1e308", "0x1F",
      "1e-400", ".",  "3",  "_pi",   "mm",   "s",    " ",    "=",    "!",      "if(",   "rint("};
  const Observations o = readings(x);
  int accepted = 0;
  for (int n = 0; n < 20000; ++n) {
    std::string text;
    const auto length = random() % 30;
    for (unsigned k = 0; k < length; ++k)
      text += n % 4 == 0 ? std::string(1, static_cast<char>(random() % 256))
                         : pieces[random() % pieces.size()];
    if (n % 3 == 0) text = "a*(" + text + ")+b*P/m";
    const auto e = config::formula_effect(
        formula(text, {a, b, ranged("P", Quantity::length, 0.02, 0.01, 0.03)}), x);
    if (!e) {
      EXPECT_FALSE(e.error().message.empty());
      continue;
    }
    ++accepted;
    const auto columns = e->columns(o, x, {0.015});
    if (!columns) continue;
    for (const auto& column : *columns)
      for (const double v : column) EXPECT_TRUE(std::isfinite(v)) << text;
  }
  EXPECT_GT(accepted, 0);
}

TEST(Formula, ComesFromTheManifest) {
  const std::string head =
      "format = 1\n[campaign]\nid = \"a\"\n[[measurement]]\nid = \"X\"\nkind = \"axis\"\naxis = "
      "\"X\"\n"
      "file = \"x.csv\"\n[model]\neffects = [\"scale:X\"]\n[[model.formula]]\n";
  const auto parse = [&](const std::string& rest) {
    return config::parse_manifest(head + rest, "c.toml", own_methods());
  };
  const auto good = parse(
      "name = \"sag\"\naxis = \"X\"\nexpression = \"a*sin(_pi*p/P)\"\n"
      "parameters = [{ name = \"a\", unit = \"um\" },\n"
      "  { name = \"P\", unit = \"mm\", start = 800, range = [500, 1000] }]\n");
  ASSERT_TRUE(good) << good.error()[0].message;
  ASSERT_EQ(good->campaign.formulas.size(), 1u);
  const Formula& f = good->campaign.formulas[0];
  EXPECT_EQ(f.line, 14u);
  EXPECT_EQ(f.parameters[1].quantity, Quantity::length);
  EXPECT_NEAR(f.parameters[1].range->second, 1.0, 1e-12);
  EXPECT_EQ(good->campaign.model, std::vector<std::string>{"scale:X"});

  const auto said = [&](const std::string& rest) {
    const auto m = parse(rest);
    if (m) return std::string("accepted");
    std::string all;
    for (const Error& e : m.error())
      all += e.file + ":" + std::to_string(e.line) + ": " + e.message + "\n";
    return all;
  };
  const std::string named = "name = \"n\"\naxis = \"X\"\n";
  EXPECT_SAYS(
      said(named + "expression = \"a*pp/m\"\nparameters = [{ name = \"a\", unit = \"um\" }]\n"),
      "c.toml:14: model.formula.expression: formula n: unknown name \"pp\"");
  EXPECT_SAYS(
      said(named + "expression = \"a\"\nparameters = [{ name = \"a\", unit = \"micron\" }]\n"),
      "c.toml:15: model.formula.parameters.unit: expected one of um (deviation)");
  EXPECT_SAYS(said(named + "expression = \"a\"\nparameters = [{ name = \"a\" }]\n"),
              "unit: is missing");
  EXPECT_SAYS(
      said(named +
           "expression = \"a\"\nparameters = [{ name = \"a\", unit = \"um\", start = 1 }]\n"),
      "start and range together");
  EXPECT_SAYS(said(named + "expression = \"a\"\nparameters = [{ name = \"a\", unit = \"um\", start "
                           "= 1, range = [2, 3] }]\n"),
              "within the range");
  EXPECT_SAYS(said(named + "expression = \"a\"\n"), "parameters: is missing");
  EXPECT_SAYS(said(named + "expresion = \"a\"\nparameters = [{ name = \"a\", unit = \"um\" }]\n"),
              "unknown key model.formula.expresion");
  EXPECT_SAYS(said("name = \"n\"\naxis = \"Q\"\nexpression = \"a\"\nparameters = [{ name = \"a\", "
                   "unit = \"um\" }]\n"),
              "no axis \"Q\"");
}

}  // namespace nonio::formula_test
