// SPDX-License-Identifier: Apache-2.0
#include "campaign/config/formula.h"

#include <muParser.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <limits>
#include <memory>

#include "campaign/config/formula_units.h"
#include "nonio/sdk/axis_readings.h"
#include "nonio/sdk/format.h"
#include "nonio/sdk/splitmix64.h"
#include "platform/storage/nearest.h"

namespace nonio::config {

namespace {

/// Exponents of length, time and temperature in a unit; all 0 for an angle.
using Dimension = std::array<int, 3>;

/// The slots of an expression contain the values of variables, units and parameters in SI units.
class Expression {
 public:
  enum Variable : std::size_t {
    p,
    theta,
    d,
    t,
    K,
    run,
    // A parameter of the formula may have one of the following names, which then denotes it.
    length,
    duration,
    runs,
    pitch,
    teeth,
    air,
    pressure,
    humidity,
    variables
  };

  /// `known`: the expression was parsed before, and only the names that occur in it are declared.
  static Expected<Expression> parse(const Formula& formula, const Axis& axis, bool known = false);
  Expression(Expression&&) noexcept;
  Expression& operator=(Expression&&) noexcept;
  ~Expression();

  /// Returns a copy of the slots. After `parse`, the units have their values in SI units, `length`,
  /// `duration`, `runs`, `pitch` and `teeth` are 1, and all others are 0.
  std::vector<double> slots() const;
  static std::size_t parameter_slot(std::size_t k);
  /// Converts slots to units in which the unit of dimension `k` (0: length, 1: time, 2:
  /// temperature) is smaller by a factor of 2^bits.
  std::vector<double> in_finer_units(std::vector<double> slots, std::size_t k, int bits) const;
  /// Evaluates the expression; NaN or infinity if it has no finite value.
  double value(const std::vector<double>& slots);
  /// Returns the slots that `value()` without an argument uses, to be changed in place.
  std::vector<double>& in_place();
  double value();
  bool uses(const std::string& name) const;

 private:
  struct Parser;
  Expression();
  std::unique_ptr<Parser> parser_;
};

struct Name {
  const char* name;
  double si;
  Dimension dimension;
};

constexpr Dimension no_dimension{0, 0, 0}, distance{1, 0, 0}, duration{0, 1, 0},
    temperature{0, 0, 1};

/// Names and dimensions of the variables, in the order of Expression::Variable. On a rotary axis,
/// all variables of dimension `distance` (p, theta, length, pitch) have no dimension, as angles.
constexpr std::array<Name, Expression::variables> readings{{{"p", 0.0, distance},
                                                            {"theta", 0.0, distance},
                                                            {"d", 0.0, no_dimension},
                                                            {"t", 0.0, duration},
                                                            {"K", 0.0, temperature},
                                                            {"run", 0.0, no_dimension},
                                                            {"length", 1.0, distance},
                                                            {"duration", 1.0, duration},
                                                            {"runs", 1.0, no_dimension},
                                                            {"pitch", 1.0, distance},
                                                            {"teeth", 1.0, no_dimension},
                                                            {"air", 0.0, temperature},
                                                            {"pressure", 0.0, no_dimension},
                                                            {"humidity", 0.0, no_dimension}}};
constexpr std::array<Name, 9> units{{{"m", 1.0, distance},
                                     {"mm", 1e-3, distance},
                                     {"um", 1e-6, distance},
                                     {"s", 1.0, duration},
                                     {"h", 3600.0, duration},
                                     {"kelvin", 1.0, temperature},
                                     {"rad", 1.0, no_dimension},
                                     {"deg", 1.0 / deg_per_rad, no_dimension},
                                     {"arcsec", 1.0 / arcsec_per_rad, no_dimension}}};

constexpr std::size_t most_characters = 400;

/// Returns an error for text that no formula needs, even if the parser would accept it: over 400
/// characters, quotes, #, {, characters outside ASCII, assignments, several results; otherwise "".
std::string forbidden(const std::string& text) {
  if (text.size() > most_characters)
    return "expected " + std::to_string(most_characters) + " characters at most, found " +
           std::to_string(text.size());
  int depth = 0;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const char c = text[i];
    const std::string at = " at position " + std::to_string(i + 1);
    if (c < 0x20 || c > 0x7e || std::string_view("\"'#$@\\`{}[];~").find(c) != std::string::npos)
      return "a character that formulas do not have" + at;
    depth += c == '(' ? 1 : c == ')' ? -1 : 0;
    if (c == ',' && depth <= 0)
      return "a comma outside of a function" + at + ": one value is expected";
    const bool pair =
        i + 1 < text.size() && text[i + 1] == '=' && (c == '=' || c == '<' || c == '>' || c == '!');
    if (pair)
      ++i;
    else if (c == '=')
      return "an assignment" + at + ": = is not allowed, == compares";
  }
  return {};
}

std::vector<std::string> names_of(const mu::Parser& parser) {
  std::vector<std::string> names;
  for (const auto& [name, place] : parser.GetVar()) names.push_back(name);
  for (const auto& [name, function] : parser.GetFunDef()) names.push_back(name);
  return names;
}

std::string words_of(const mu::ParserError& e, const mu::Parser& parser) {
  const std::string at = " at position " + std::to_string(e.GetPos() + 1);
  if (e.GetCode() == mu::ecUNASSIGNABLE_TOKEN)
    return "unknown name \"" + e.GetToken() + "\"" + at +
           storage::suggestion(e.GetToken(), names_of(parser));
  if (e.GetCode() == mu::ecUNEXPECTED_EOF) return "the expression ends too early";
  if (e.GetCode() == mu::ecMISSING_PARENS) return "a parenthesis is not closed";
  return "not understood" + (e.GetPos() < 0 ? "" : at) +
         (e.GetToken().empty() ? "" : ", at \"" + e.GetToken() + "\"");
}

Dimension dimension_of(Quantity quantity) {
  switch (quantity) {
    case Quantity::length:
    case Quantity::deviation:
      return distance;
    case Quantity::time:
      return duration;
    case Quantity::temperature:
    case Quantity::temperature_difference:
      return temperature;
    case Quantity::expansion:
    case Quantity::angular_expansion:
      return {0, 0, -1};
    case Quantity::deviation_per_time:
      return {1, -1, 0};
    case Quantity::deviation_per_kelvin:
      return {1, 0, -1};
    case Quantity::angle_per_kelvin:
      return {0, 0, -1};
    case Quantity::angle_per_time:
    case Quantity::growth:
    case Quantity::angular_growth:
      return {0, -1, 0};
    default:
      return no_dimension;
  }
}

/// The parser stores the addresses of the elements of `slots`, so these must not move.
struct Expression::Parser {
  mu::Parser parser;
  std::vector<double> slots;
  std::vector<Dimension> dimensions;
};

Expression::Expression() : parser_(std::make_unique<Parser>()) {}
Expression::Expression(Expression&&) noexcept = default;
Expression& Expression::operator=(Expression&&) noexcept = default;
Expression::~Expression() = default;

Expected<Expression> Expression::parse(const Formula& formula, const Axis& axis, bool known) {
  if (const std::string why = forbidden(formula.expression); !why.empty()) return fail(why);
  Expression made;
  Parser& own = *made.parser_;
  std::vector<std::string> names;
  const auto add = [&](std::string name, double si, const Dimension& dimension) {
    names.push_back(std::move(name));
    own.slots.push_back(si);
    own.dimensions.push_back(dimension);
  };
  const auto is_parameter = [&](const std::string& name) {
    return std::any_of(formula.parameters.begin(), formula.parameters.end(),
                       [&](const Formula::Parameter& p) { return p.name == name; });
  };
  for (std::size_t k = 0; k < readings.size(); ++k) {
    const Name& v = readings[k];
    add(k >= Expression::length && is_parameter(v.name) ? "" : v.name, v.si,
        axis.rotary && v.dimension == distance ? no_dimension : v.dimension);
  }
  for (const Name& u : units) add(u.name, u.si, u.dimension);
  for (const Formula::Parameter& p : formula.parameters) {
    if (std::find(names.begin(), names.end(), p.name) != names.end())
      return fail("parameter \"" + p.name + "\": the name is taken");
    add(p.name, 0.0, dimension_of(p.quantity));
  }
  try {
    for (std::size_t k = 0; k < names.size(); ++k)
      if (!names[k].empty() && (!known || formula.expression.find(names[k]) != std::string::npos))
        own.parser.DefineVar(names[k], &own.slots[k]);
  } catch (const mu::ParserError&) {
    return fail(
        "the name of a parameter is not valid: expected letters, digits and _, not the name of a "
        "function");
  }
  try {
    own.parser.SetExpr(formula.expression);
    own.parser.Eval();
    if (own.parser.GetNumResults() != 1) return fail("expected one value");
  } catch (const mu::ParserError& e) {
    return fail(words_of(e, own.parser));
  } catch (const std::exception& e) {
    return fail(std::string("not understood: ") + e.what());
  }
  return made;
}

std::vector<double> Expression::slots() const { return parser_->slots; }

std::size_t Expression::parameter_slot(std::size_t k) { return variables + units.size() + k; }

std::vector<double> Expression::in_finer_units(std::vector<double> slots, std::size_t k,
                                               int bits) const {
  for (std::size_t i = 0; i < slots.size(); ++i)
    slots[i] = std::ldexp(slots[i], bits * parser_->dimensions[i][k]);
  return slots;
}

double Expression::value(const std::vector<double>& slots) {
  std::copy(slots.begin(), slots.end(), parser_->slots.begin());
  return value();
}

std::vector<double>& Expression::in_place() { return parser_->slots; }

double Expression::value() {
  try {
    return parser_->parser.Eval();
  } catch (const mu::ParserError&) {
    return std::numeric_limits<double>::quiet_NaN();
  }
}

bool Expression::uses(const std::string& name) const {
  const std::string& text = parser_->parser.GetExpr();
  const auto in_a_name = [&](std::size_t i) {
    return i < text.size() && (std::isalnum(static_cast<unsigned char>(text[i])) || text[i] == '_');
  };
  std::size_t at = text.find(name);
  while (at != text.npos && (in_a_name(at - 1) || in_a_name(at + name.size())))
    at = text.find(name, at + 1);
  return at != text.npos;
}

std::string symbol_of(Quantity q) { return std::string(FormulaUnit{q, {}}.symbol()); }

/// Returns the value 1 of a parameter in its printed unit, converted to SI units.
double amount(const Formula::Parameter& p) { return 1.0 / unit_of(p.quantity).per_si; }

/// Checks at 64 points, most of them random, that the expression is finite, linear in its linear
/// parameters, and has the unit of a deviation, and that each parameter occurs in it.
class Trial {
 public:
  Trial(const Formula& formula, const Axis& axis, Expression& expression)
      : formula_(formula), axis_(axis), expression_(expression), point_(expression.slots()) {}

  std::string run() {
    largest_.assign(formula_.parameters.size(), 0.0);
    for (const auto& p : formula_.parameters)
      if (!expression_.uses(p.name)) return "parameter \"" + p.name + "\" is not in the expression";
    for (int n = 0; n < points; ++n) {
      draw(n);
      if (auto why = wrong_here(); !why.empty()) return why;
    }
    for (std::size_t k = 0; k < largest_.size(); ++k)
      if (!formula_.parameters[k].range && largest_[k] == 0.0)
        return "parameter \"" + formula_.parameters[k].name + "\" changes nothing";
    return {};
  }

 private:
  static constexpr int points = 64;
  static constexpr double near = 1e-9;

  bool linear(std::size_t k) const { return !formula_.parameters[k].range; }

  /// Point 0 is the middle of the travel at time 0, with the lowest value of each shape.
  void draw(int n) {
    const auto between = [&](double low, double high) {
      return low + (high - low) * numbers_.uniform();
    };
    const auto sized = [&](double low, double high) {
      return low * std::pow(high / low, numbers_.uniform());
    };
    const auto sign = [&] { return numbers_.uniform() < 0.5 ? -1.0 : 1.0; };
    using E = Expression;
    point_[E::p] = n == 0 ? 0.0 : sign() * sized(1e-3, 1.0);
    point_[E::theta] = n == 0 ? 0.0 : sign() * sized(1e-3, 6.0);
    point_[E::d] = n % 2 == 0 ? 1.0 : -1.0;
    point_[E::t] = n == 0 ? 0.0 : sized(1.0, 1e4);
    point_[E::K] = n == 0 ? 0.0 : sign() * sized(0.01, 3.0);
    point_[E::run] = 1.0 + n % 5;
    point_[E::length] = n == 0 ? 1.0 : sized(0.1, 4.0);
    point_[E::duration] = n == 0 ? 1e4 : sized(1e3, 1e5);
    point_[E::runs] = 1.0 + n % 7;
    point_[E::pitch] = n == 0 ? 0.01 : sized(1e-3, 0.1);
    point_[E::teeth] = n == 0 ? 90.0 : 36.0 + n;
    point_[E::air] = n == 0 ? 0.0 : sign() * sized(0.01, 3.0);
    point_[E::pressure] = n == 0 ? 0.0 : sign() * sized(0.1, 20.0);
    point_[E::humidity] = n == 0 ? 0.0 : sign() * sized(0.1, 20.0);
    for (std::size_t k = 0; k < formula_.parameters.size(); ++k) {
      const auto& p = formula_.parameters[k];
      double& slot = point_[E::parameter_slot(k)];
      if (linear(k))
        slot = amount(p) * sign() * between(0.5, 2.0);
      else
        slot = n == 0   ? p.range->first
               : n == 1 ? p.range->second
               : n == 2 ? p.start
                        : between(p.range->first, p.range->second);
    }
  }

  /// Returns the point with linear parameter `k` times `factor` and all other linear parameters 0.
  std::vector<double> only(std::size_t k, double factor) const {
    std::vector<double> point = point_;
    for (std::size_t other = 0; other < formula_.parameters.size(); ++other)
      if (linear(other)) point[Expression::parameter_slot(other)] *= other == k ? factor : 0.0;
    return point;
  }

  std::string wrong_here() {
    const double all = expression_.value(point_);
    if (!std::isfinite(all)) return "no finite value at " + place();
    const double nothing = expression_.value(only(formula_.parameters.size(), 0.0));
    double sum = 0.0, size = std::abs(all);
    for (std::size_t k = 0; k < formula_.parameters.size(); ++k) {
      if (!linear(k)) continue;
      const double one = expression_.value(only(k, 1.0));
      const double other = expression_.value(only(k, -2.0));
      if (!std::isfinite(one) || !std::isfinite(other))
        return "no finite value where a linear parameter is 0: one in a denominator needs start "
               "and range";
      largest_[k] = std::max(largest_[k], std::abs(one));
      sum += one;
      size += std::abs(one);
      if (!(std::abs(other + 2.0 * one - 3.0 * nothing) <=
            near * (std::abs(one) + std::abs(other))))
        return "parameter \"" + formula_.parameters[k].name +
               "\" does not enter linearly: give it start and range";
      if (auto why = wrong_unit(k, one); !why.empty()) return why;
    }
    if (!(std::abs(nothing) <= near * size))
      return "with all linear parameters 0 the value is not 0: every term needs a parameter";
    if (!(std::abs(all - sum) <= near * size))
      return "two linear parameters are multiplied: give one of them start and range";
    return {};
  }

  /// Returns an error unless the term of parameter k scales with the unit of length as a deviation
  /// does (an angle does not), and does not depend on the units of time and temperature.
  std::string wrong_unit(std::size_t k, double one) {
    constexpr std::array<const char*, 3> names{"length", "time", "temperature"};
    constexpr int bits = 10;
    for (std::size_t unit = 0; unit < names.size(); ++unit) {
      const int wanted = unit == 0 && !axis_.rotary ? 1 : 0;
      const double scaled = expression_.value(expression_.in_finer_units(only(k, 1.0), unit, bits));
      if (std::abs(scaled - std::ldexp(one, bits * wanted)) <= near * std::abs(scaled)) continue;
      const auto& p = formula_.parameters[k];
      const double power = std::log2(scaled / one) / bits;
      std::string words =
          "the term of parameter \"" + p.name + "\" (" + symbol_of(p.quantity) + ") ";
      if (std::isfinite(power) && std::abs(power - std::round(power)) < 1e-6)
        return words + "has the unit " + names[unit] + "^" + std::to_string(std::lround(power)) +
               " where a deviation has " + names[unit] + "^" + std::to_string(wanted) +
               ": give the parameter another unit (" + known_units() +
               ") or divide by a fixed value, as p/(100*mm)";
      return words + "depends on the unit of " + names[unit] +
             ": it adds unlike quantities or takes sin, exp, ... of one; a fixed value is "
             "written with its unit, as p/(10*mm)";
    }
    return {};
  }

  std::string place() const {
    using E = Expression;
    std::string text;
    const auto add = [&](const std::string& name, Quantity q, double si) {
      if (!expression_.uses(name)) return;
      text += (text.empty() ? "" : ", ") + name + " = " + short_text(printed(si, q)) + " " +
              symbol_of(q);
    };
    const Quantity position = position_of(axis_.rotary);
    add("p", position, point_[E::p]);
    add("theta", position, point_[E::theta]);
    add("t", Quantity::time, point_[E::t]);
    add("K", Quantity::temperature_difference, point_[E::K]);
    for (std::size_t k = 0; k < formula_.parameters.size(); ++k)
      add(formula_.parameters[k].name, formula_.parameters[k].quantity,
          point_[E::parameter_slot(k)]);
    return text;
  }

  const Formula& formula_;
  const Axis& axis_;
  Expression& expression_;
  std::vector<double> point_;
  std::vector<double> largest_;
  SplitMix64 numbers_{1};
};

std::vector<double> search(const Formula::Parameter& p, int count) {
  const auto [low, high] = *p.range;
  const bool ratios = low > 0.0 && high > 4.0 * low;
  std::vector<double> grid{p.start};
  for (int k = 0; k < count; ++k) {
    const double part = k / (count - 1.0);
    grid.push_back(ratios ? low * std::pow(high / low, part) : low + (high - low) * part);
  }
  std::sort(grid.begin(), grid.end());
  grid.erase(std::unique(grid.begin(), grid.end()), grid.end());
  return grid;
}

/// Returns nullopt unless every reading has a value.
std::optional<double> mean_of_all(const Observations& o, const std::vector<double>& column) {
  double sum = 0.0;
  for (const double x : column) sum += x;
  if (column.size() != o.size() || column.empty() || !std::isfinite(sum)) return std::nullopt;
  return sum / static_cast<double>(column.size());
}

/// Optional quantities that an expression uses.
struct Wants {
  bool K, pitch, teeth, air, pressure, humidity;

  explicit Wants(const Expression& e)
      : K(e.uses("K")),
        pitch(e.uses("pitch")),
        teeth(e.uses("teeth")),
        air(e.uses("air")),
        pressure(e.uses("pressure")),
        humidity(e.uses("humidity")) {}

  bool met(const Observations& o, const Axis& axis, const AxisReadings& r) const {
    return (!K || r.temperature) && (!pitch || axis.screw_pitch) && (!teeth || axis.teeth) &&
           (!air || mean_of_all(o, o.air)) && (!pressure || mean_of_all(o, o.pressure)) &&
           (!humidity || mean_of_all(o, o.humidity));
  }
};

/// The last expression is kept, because parsing takes as long as 200 readings.
Expected<Expression>& understood(const std::shared_ptr<const Formula>& formula, const Axis& axis) {
  struct Last {
    std::shared_ptr<const Formula> formula;
    bool rotary = false;
    Expected<Expression> expression = fail("");
  };
  thread_local Last last;
  if (last.formula != formula || last.rotary != axis.rotary)
    last = {formula, axis.rotary, Expression::parse(*formula, axis, true)};
  return last.expression;
}

Expected<Effect::Columns> columns(const std::shared_ptr<const Formula>& one, const Observations& o,
                                  const Axis& axis, const std::vector<double>& shape) {
  const Formula& formula = *one;
  Expected<Expression>& expression = understood(one, axis);
  if (!expression) return fail("formula " + formula.name + ": " + expression.error().message);
  NONIO_TRY(const auto r, readings_of(o, axis));
  std::vector<double>& slots = expression->in_place();
  std::vector<std::size_t> linear;
  std::size_t shapes = 0;
  for (std::size_t k = 0; k < formula.parameters.size(); ++k) {
    if (!formula.parameters[k].range)
      linear.push_back(k);
    else if (shapes++ < shape.size())
      slots[Expression::parameter_slot(k)] = shape[shapes - 1];
  }
  if (shapes != shape.size())
    return fail("formula " + formula.name + ": expected " + std::to_string(shapes) +
                " shape parameters, found " + std::to_string(shape.size()));
  // Numbers in a file are labels: runs 6 to 10 are the first to the fifth.
  std::vector<std::uint32_t> runs(o.run.begin(), o.run.end());
  std::sort(runs.begin(), runs.end());
  runs.erase(std::unique(runs.begin(), runs.end()), runs.end());
  const auto place_of = [&](std::uint32_t run) {
    return 1.0 +
           static_cast<double>(std::lower_bound(runs.begin(), runs.end(), run) - runs.begin());
  };
  const auto air = mean_of_all(o, o.air), pressure = mean_of_all(o, o.pressure),
             humidity = mean_of_all(o, o.humidity);
  Effect::Columns out(linear.size(), std::vector<double>(o.size(), 0.0));
  for (std::size_t i = 0; i < o.size(); ++i) {
    if (!r.moved[i]) continue;
    const std::array<double, Expression::variables> row{
        r.p[i],
        r.theta[i],
        r.d[i],
        r.t[i],
        r.K[i],
        o.run.empty() ? 1.0 : place_of(o.run[i]),
        r.length,
        r.duration,
        static_cast<double>(std::max<std::size_t>(1, runs.size())),
        axis.screw_pitch.value_or(0.0),
        static_cast<double>(axis.teeth.value_or(0)),
        air ? o.air[i] - *air : 0.0,
        pressure ? o.pressure[i] - *pressure : 0.0,
        humidity ? o.humidity[i] - *humidity : 0.0};
    std::copy(row.begin(), row.end(), slots.begin());
    for (std::size_t k = 0; k < linear.size(); ++k) {
      const double unit = amount(formula.parameters[linear[k]]);
      slots[Expression::parameter_slot(linear[k])] = unit;
      const double value = expression->value() / unit;
      slots[Expression::parameter_slot(linear[k])] = 0.0;
      if (!std::isfinite(value)) {
        Error e{"formula " + formula.name + " has no finite value for this reading"};
        if (i < o.source_line.size()) e.line = o.source_line[i];
        return fail(std::move(e));
      }
      out[k][i] = value;
    }
  }
  return out;
}

}  // namespace

Expected<Effect> formula_effect(const Formula& formula, const Axis& axis, bool tried, int most) {
  constexpr std::size_t most_linear = 8, most_shapes = 3;
  const auto wrong = [&](const std::string& why) {
    return fail(Error{"formula " + formula.name + ": " + why, {}, formula.line});
  };
  auto expression = Expression::parse(formula, axis, tried);
  if (!expression) return wrong(expression.error().message);
  Effect e;
  e.info = {formula.name, "formula", formula.expression, {}};
  const auto searched = std::count_if(formula.parameters.begin(), formula.parameters.end(),
                                      [](const auto& p) { return p.range.has_value(); });
  // With several shapes, fewer values of each are tried; the search refines between these values.
  const int values = searched < 2 ? most : searched == 2 ? most * 5 / 16 : most / 9;
  for (const Formula::Parameter& p : formula.parameters) {
    const Effect::Parameter parameter{p.name, "of the formula", p.quantity};
    if (!p.range)
      e.linear.push_back(parameter);
    else
      e.shapes.push_back(
          {parameter, [p, values](const Observations&, const Axis&) { return search(p, values); },
           true});
  }
  if (e.linear.empty()) return wrong("expected a linear parameter, one without start and range");
  if (e.linear.size() > most_linear || e.shapes.size() > most_shapes)
    return wrong("too many parameters: at most " + std::to_string(most_linear) +
                 " linear ones and " + std::to_string(most_shapes) + " with a range");
  if (!tried)
    if (const std::string why = Trial(formula, axis, *expression).run(); !why.empty())
      return wrong(why);
  e.applies = [name = formula.axis, rotary = axis.rotary, wants = Wants(*expression)](
                  const Observations& o, const Axis& a) {
    if (name.empty() ? a.rotary != rotary : a.name != name) return false;
    const auto r = readings_of(o, a);
    return r && wants.met(o, a, *r);
  };
  e.columns = [formula = std::make_shared<const Formula>(formula)](
                  const Observations& o, const Axis& a, const std::vector<double>& shape) {
    return columns(formula, o, a, shape);
  };
  return e;
}

}  // namespace nonio::config
