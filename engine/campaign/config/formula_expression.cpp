// SPDX-License-Identifier: Apache-2.0
#include "campaign/config/formula_expression.h"

#include <muParser.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <limits>

#include "platform/storage/nearest.h"

namespace nonio::config {

namespace {

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

}  // namespace

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

}  // namespace nonio::config
