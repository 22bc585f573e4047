// SPDX-License-Identifier: Apache-2.0
#include "formula_reader.h"

#include <cmath>
#include <set>

#include "nonio/host/formula.h"
#include "nonio/host/nearest.h"

namespace nonio::host {

namespace {

constexpr std::size_t most_parameters = 12;

Formula::Parameter read_parameter(TableReader& reader) {
  Formula::Parameter p;
  p.name = reader.text("name", true);
  const std::string unit = reader.text("unit");
  const auto quantity = quantity_of(unit);
  if (!quantity && unit.empty())
    reader.error("unit", "is missing: wanted one of " + known_units());
  else if (!quantity)
    reader.error("unit", "wanted one of " + known_units() + "; found \"" + unit + "\"");
  p.quantity = quantity.value_or(Quantity::number);
  const double si = 1.0 / unit_of(p.quantity).per_si;
  const auto start = reader.number("start", si);
  const auto range = reader.numbers("range");
  if (start.has_value() != range.has_value()) {
    reader.error(start ? "start" : "range", "wanted start and range together, or neither");
  } else if (range) {
    p.start = *start;
    if (range->size() != 2 || !((*range)[0] < (*range)[1]) || !std::isfinite((*range)[0]) ||
        !std::isfinite((*range)[1]))
      reader.error("range", "wanted two numbers, the smaller one first");
    else
      p.range = {(*range)[0] * si, (*range)[1] * si};
    if (p.range && !(p.start >= p.range->first && p.start <= p.range->second))
      reader.error("start", "wanted a value within the range");
  }
  reader.finish();
  return p;
}

Formula read_formula(TableReader& reader, const std::string& file, std::vector<Error>& errors) {
  Formula f;
  f.name = reader.text("name", true);
  if (f.name.find_first_not_of("abcdefghijklmnopqrstuvwxyz0123456789-") != std::string::npos ||
      f.name.size() > 40)
    reader.error("name", "wanted up to 40 of a-z 0-9 -; found \"" + f.name + "\"");
  f.axis = reader.text("axis", true);
  f.expression = reader.text("expression", true);
  f.line = reader.line_of("expression");
  const toml::array* list = reader.tables("parameters");
  if (list == nullptr || list->empty()) {
    reader.error("parameters", "is missing: [{ name = \"a\", unit = \"um\" }], one at least");
  } else if (list->size() > most_parameters) {
    reader.error("parameters", "wanted " + std::to_string(most_parameters) +
                                   " parameters at most, found " + std::to_string(list->size()));
  } else {
    for (const toml::node& node : *list) {
      TableReader parameter(*node.as_table(), reader.place("parameters"), file, errors);
      f.parameters.push_back(read_parameter(parameter));
    }
  }
  reader.finish();
  return f;
}

}  // namespace

std::vector<Formula> read_formulas(TableReader& table, const Machine& machine,
                                   const std::string& file, std::vector<Error>& errors) {
  std::vector<Formula> formulas;
  const toml::array* list = table.tables("formula");
  if (list == nullptr) return formulas;
  std::vector<std::string> axes;
  for (const Axis& axis : machine.axes) axes.push_back(axis.name);
  std::set<std::string> names;
  for (const toml::node& node : *list) {
    const std::size_t before = errors.size();
    TableReader reader(*node.as_table(), table.place("formula"), file, errors);
    Formula formula = read_formula(reader, file, errors);
    const Axis* axis = machine.axis(formula.axis);
    if (axis == nullptr && !formula.axis.empty())
      reader.error("axis", "the machine has no axis \"" + formula.axis + "\"" +
                               suggestion(formula.axis, axes));
    if (!formula.name.empty() && !names.insert(formula.name).second)
      reader.error("name", "\"" + formula.name + "\" is there twice");
    if (errors.size() == before) {
      const auto effect = formula_effect(formula, *axis);
      if (!effect) reader.error("expression", effect.error().message);
    }
    formulas.push_back(std::move(formula));
  }
  return formulas;
}

}  // namespace nonio::host
