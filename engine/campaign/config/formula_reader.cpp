// SPDX-License-Identifier: Apache-2.0
#include "campaign/config/formula_reader.h"

#include <set>

#include "campaign/config/formula.h"
#include "campaign/config/formula_units.h"
#include "platform/storage/nearest.h"

namespace nonio::config {

Formula::Parameter read_parameter(TableReader& reader) {
  Formula::Parameter p;
  p.name = reader.text("name");
  p.quantity = quantity_of(reader.text("unit")).value_or(Quantity::number);
  const double si = 1.0 / unit_of(p.quantity).per_si;
  const auto start = reader.number("start", si);
  p.range = reader.span("range", si);
  if (reader.raw().contains("start") != reader.raw().contains("range"))
    reader.error(start ? "start" : "range", "expected start and range together, or neither");
  p.start = start.value_or(p.start);
  if (start && p.range && !(p.start >= p.range->first && p.start <= p.range->second))
    reader.error("start", "expected a value within the range");
  reader.finish();
  return p;
}

namespace {

Formula read_formula(TableReader& reader) {
  Formula f;
  f.name = reader.text("name");
  f.axis = reader.text("axis");
  f.expression = reader.text("expression");
  f.line = reader.line_of("expression");
  for (TableReader& parameter : reader.tables("parameters"))
    f.parameters.push_back(read_parameter(parameter));
  reader.finish();
  return f;
}

}  // namespace

std::vector<Formula> read_formulas(TableReader& table, const Machine& machine) {
  std::vector<Formula> formulas;
  std::vector<std::string> axes;
  for (const Axis& axis : machine.axes) axes.push_back(axis.name);
  std::set<std::string> names;
  for (TableReader& reader : table.tables("formula")) {
    const std::size_t before = reader.errors();
    Formula formula = read_formula(reader);
    const Axis* axis = machine.axis(formula.axis);
    if (axis == nullptr && !formula.axis.empty())
      reader.error("axis", "the machine has no axis \"" + formula.axis + "\"" +
                               storage::suggestion(formula.axis, axes));
    if (!formula.name.empty() && !names.insert(formula.name).second)
      reader.error("name", "\"" + formula.name + "\" is given twice");
    if (reader.errors() == before) {
      const auto effect = formula_effect(formula, *axis);
      if (!effect) reader.error("expression", effect.error().message);
    }
    formulas.push_back(std::move(formula));
  }
  return formulas;
}

}  // namespace nonio::config
