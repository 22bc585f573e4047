// SPDX-License-Identifier: Apache-2.0
#include "campaign/config/formula_reader.h"

#include "campaign/config/checks.h"
#include "campaign/config/formula.h"
#include "platform/storage/nearest.h"

namespace nonio::config {

void check_parameter(TableReader& reader, Formula::Parameter& p) {
  const double si = 1.0 / unit_of(p.quantity).per_si;
  p.start *= si;
  if (p.range) p.range = {p.range->first * si, p.range->second * si};
  const bool start = reader.raw().contains("start");
  if (start != reader.raw().contains("range"))
    reader.error(start ? "start" : "range", "expected start and range together, or neither");
  if (!reader.has_errors() && start && p.range &&
      !(p.start >= p.range->first && p.start <= p.range->second))
    reader.error("start", "expected a value within the range");
}

void check_formula(TableReader& reader, std::vector<Formula>& all, const Machine& machine) {
  Formula& formula = all.back();
  formula.line = reader.line_of("expression");
  std::vector<std::string> axes;
  for (const Axis& axis : machine.axes) axes.push_back(axis.name);
  const Axis* axis = machine.axis(formula.axis);
  if (axis == nullptr && !formula.axis.empty())
    reader.error("axis", "the machine has no axis \"" + formula.axis + "\"" +
                             storage::suggestion(formula.axis, axes));
  if (!formula.name.empty() && given_before(all, &Formula::name))
    reader.error("name", "\"" + formula.name + "\" is given twice");
  if (reader.has_errors()) return;
  if (const auto effect = formula_effect(formula, *axis); !effect)
    reader.error("expression", effect.error().message);
}

}  // namespace nonio::config
