// SPDX-License-Identifier: Apache-2.0
// values.csv, and one file per analysis with points and curves, for spreadsheets.
#include "nonio/sdk/plugin.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <utility>

#include "nonio/sdk/fields.h"
#include "nonio/sdk/format.h"

namespace nonio::csv_output {
namespace {

std::string number(double si, Quantity quantity) {
  if (!std::isfinite(si)) return {};
  std::string text;
  append_shortest(text, printed(si, quantity));
  return text;
}

void add_row(std::string& out, const std::vector<std::string>& fields) {
  for (std::size_t i = 0; i < fields.size(); ++i) {
    if (i > 0) out += ',';
    out += fields[i];
  }
  out += '\n';
}

const char* words_of(Decision decision) {
  switch (decision) {
    case Decision::conforms:
      return "conforms";
    case Decision::does_not_conform:
      return "does not conform";
    case Decision::cannot_be_decided:
      break;
  }
  return "cannot be decided";
}

bool belongs(const Conformity& c, const Results::Analysed& a, std::string_view name) {
  return c.measurement == a.measurement && c.plugin == a.plugin && c.name == name;
}

std::vector<std::string> value_row(const Results& results, const Results::Analysed& a,
                                   const Value& v) {
  std::vector<std::string> row = {csv_text(a.measurement),
                                  csv_text(a.plugin),
                                  csv_text(v.name),
                                  number(v.value, v.quantity),
                                  csv_text(unit_of(v.quantity).symbol),
                                  v.U ? number(*v.U, v.quantity) : "",
                                  "",
                                  ""};
  for (const Conformity& c : results.conformity)
    if (belongs(c, a, v.name)) {
      row[6] = number(c.tolerance, c.quantity);
      row[7] = words_of(c.decision);
    }
  return row;
}

/// Tolerances without a value have rows, so that they are not overlooked.
void add_undecided(std::string& out, const Results& results) {
  for (const Conformity& c : results.conformity) {
    const bool has_value =
        std::any_of(results.analyses.begin(), results.analyses.end(), [&](const auto& a) {
          const auto& values = a.evaluation.values;
          return std::any_of(values.begin(), values.end(),
                             [&](const Value& v) { return belongs(c, a, v.name); });
        });
    if (!has_value)
      add_row(out, {csv_text(c.measurement), csv_text(c.plugin), csv_text(c.name), "",
                    csv_text(unit_of(c.quantity).symbol), "", number(c.tolerance, c.quantity),
                    words_of(c.decision)});
  }
}

std::string values_file(const Results& results) {
  std::string out = "measurement,plugin,name,value,unit,U,tolerance,decision\n";
  for (const Results::Analysed& a : results.analyses)
    for (const Value& v : a.evaluation.values) add_row(out, value_row(results, a, v));
  add_undecided(out, results);
  return out;
}

std::string table_file(const PointTable& points) {
  std::string out;
  std::vector<std::string> row;
  std::size_t rows = 0;
  for (const PointTable::Column& c : points.columns) {
    row.push_back(csv_text(c.name + std::string(unit_of(c.quantity).suffix)));
    rows = std::max(rows, c.values.size());
  }
  add_row(out, row);
  for (std::size_t i = 0; i < rows; ++i) {
    row.clear();
    for (const PointTable::Column& c : points.columns)
      row.push_back(i < c.values.size() ? number(c.values[i], c.quantity) : "");
    add_row(out, row);
  }
  return out;
}

std::string file_name(const std::string& kind, const Results::Analysed& a,
                      const std::vector<Artifact>& others) {
  const auto plain = [](std::string part) {
    for (char& c : part)
      if (std::string_view("/\\:*?\"<>| ").find(c) != std::string_view::npos ||
          static_cast<unsigned char>(c) < 0x20)
        c = '_';
    return part;
  };
  const std::string base =
      kind + (a.measurement.empty() ? "" : "-" + plain(a.measurement)) + "-" + plain(a.plugin);
  std::string name = base + ".csv";
  const auto taken = [&] {
    return std::any_of(others.begin(), others.end(),
                       [&](const Artifact& o) { return o.name == name; });
  };
  for (int k = 2; taken(); ++k) name = base + "-" + std::to_string(k) + ".csv";
  return name;
}

std::string series_file(const std::vector<Series>& all) {
  std::string out = "curve,over,position,position_unit,value,unit,U,k\n";
  for (const Series& s : all)
    for (std::size_t i = 0; i < s.position.size(); ++i)
      add_row(out, {csv_text(s.name), csv_text(s.over), number(s.position[i], s.position_quantity),
                    csv_text(unit_of(s.position_quantity).symbol), number(s.value[i], s.quantity),
                    csv_text(unit_of(s.quantity).symbol),
                    i < s.U.size() ? number(s.U[i], s.quantity) : "",
                    i < s.U.size() ? number(s.k, Quantity::ratio) : ""});
  return out;
}

Expected<OutputResult> write(const OutputInput& input) {
  OutputResult result;
  result.artifacts.push_back({"values.csv", values_file(input.results)});
  for (const Results::Analysed& a : input.results.analyses) {
    for (const auto& [kind, table] :
         {std::pair{"points", &a.evaluation.points}, {"rows", &a.evaluation.rows}})
      if (!table->columns.empty())
        result.artifacts.push_back({file_name(kind, a, result.artifacts), table_file(*table)});
    if (!a.evaluation.series.empty())
      result.artifacts.push_back(
          {file_name("curves", a, result.artifacts), series_file(a.evaluation.series)});
  }
  return result;
}

}  // namespace

NONIO_PLUGIN(registry) {
  Output output;
  output.info = {"csv", "1.0",
                 "Values, points by target and curves as CSV files, for spreadsheets."};
  output.applies = [](const Campaign&) { return true; };
  output.write = write;
  registry.add(std::move(output));
}

}  // namespace nonio::csv_output
