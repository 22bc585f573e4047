// SPDX-License-Identifier: Apache-2.0
#include "campaign/modelling/readings_csv.h"

#include <algorithm>
#include <cmath>

#include "nonio/sdk/fields.h"
#include "nonio/sdk/format.h"

namespace nonio::modelling {

namespace {

struct Columns {
  std::string name;
  std::vector<Quantity> units{};

  void add(Quantity q) {
    if (std::find(units.begin(), units.end(), q) == units.end()) units.push_back(q);
  }
  void put_names(std::string& out) const {
    for (const Quantity q : units) out += "," + name + std::string(unit_of(q).suffix);
  }
  void put(std::string& out, double value, Quantity q) const {
    for (const Quantity one : units) {
      out += ',';
      const double shown = rounded_to_places(printed(value, q), 6);
      if (one == q && std::isfinite(shown)) append_shortest(out, shown);
    }
  }
};

bool is_over_time(const PartModel& part) { return part.part.kind == model::Part::Kind::course; }

}  // namespace

std::string readings_csv(const std::vector<Compared>& all) {
  Columns target{"target"}, reading{"reading"}, model{"model"}, residual{"residual"};
  const Columns time{"time", {Quantity::time}};
  for (const auto& [part, comparison] : all) {
    if (!is_over_time(part)) target.add(part.position());
    for (Columns* c : {&reading, &model, &residual}) c->add(part.deviation());
  }
  std::string out = "part,measurement,file_line";
  target.put_names(out);
  out += ",run,direction";
  for (const auto& columns : {time, reading, model, residual}) columns.put_names(out);
  out += ",weight\n";
  for (const auto& [part, comparison] : all) {
    const Observations& o = part.part.table;
    const std::vector<double> measured = part.measured();
    const model::Fit& fit = comparison.fit;
    for (std::size_t i = 0; i < o.size(); ++i) {
      out += csv_text(part.part.name) + "," +
             csv_text(part.part.measurements[part.part.measurement[i]]) + ",";
      if (i < o.source_line.size()) out += std::to_string(o.source_line[i]);
      target.put(out, is_over_time(part) ? std::nan("") : part.part.along[i], part.position());
      out += ',';
      if (i < o.run.size()) out += std::to_string(o.run[i]);
      out += part.part.way[i] > 0 ? ",+" : part.part.way[i] < 0 ? ",-" : ",";
      time.put(out, i < o.time.size() ? o.time[i] : std::nan(""), Quantity::time);
      reading.put(out, measured[i], part.deviation());
      model.put(out, measured[i] - fit.residual[i], part.deviation());
      residual.put(out, fit.residual[i], part.deviation());
      out += ',';
      append_shortest(out, rounded_by_digits(fit.weight[i]));
      out += '\n';
    }
  }
  return out;
}

}  // namespace nonio::modelling
