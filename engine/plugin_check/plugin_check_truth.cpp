// SPDX-License-Identifier: Apache-2.0
#include "plugin_check/plugin_check_truth.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <optional>

#include "campaign/config/formula.h"
#include "campaign/config/manifest.h"
#include "nonio/model/explain.h"
#include "nonio/sdk/fields.h"
#include "nonio/sdk/format.h"
#include "nonio/sdk/text.h"

namespace nonio::plugin_check::kit {

namespace {

struct TableRow {
  std::string where;
  std::map<std::string, std::string> fields;

  const std::string* find(const std::string& column) const {
    const auto at = fields.find(column);
    return at == fields.end() ? nullptr : &at->second;
  }
  std::string text(const std::string& column) const {
    const std::string* found = find(column);
    return found == nullptr ? "" : *found;
  }
};

const Artifact* file_of(const Source& source, const std::string& name) {
  for (const Artifact& f : source.files)
    if (f.name == name) return &f;
  return nullptr;
}

std::vector<TableRow> rows_of_table(const Source& source, const std::string& name) {
  std::vector<TableRow> rows;
  const Artifact* file = file_of(source, name);
  if (file == nullptr) return rows;
  std::vector<std::string> columns;
  std::string_view rest = without_mark(file->bytes);
  for (std::size_t line = 1; !rest.empty(); ++line) {
    const std::size_t end = std::min(rest.find('\n'), rest.size());
    std::string_view text = rest.substr(0, end);
    if (text.ends_with('\r')) text.remove_suffix(1);
    text = nonio::readers::trimmed(text);
    rest.remove_prefix(std::min(end + 1, rest.size()));
    if (text.empty() || text.front() == '#') continue;
    std::vector<std::string_view> fields;
    if (!nonio::readers::split(text, ',', fields)) continue;
    if (columns.empty()) {
      for (const std::string_view f : fields) columns.emplace_back(nonio::readers::trimmed(f));
      continue;
    }
    TableRow row{name + ":" + std::to_string(line), {}};
    for (std::size_t i = 0; i < std::min(fields.size(), columns.size()); ++i)
      if (const std::string_view f = nonio::readers::trimmed(fields[i]); !f.empty())
        row.fields[columns[i]] = std::string(f);
    rows.push_back(std::move(row));
  }
  return rows;
}

/// A number in a file, which is correct to half a unit of its last digit.
struct WrittenNumber {
  double value = 0.0, half = 0.0;
  bool holds(double found) const {
    return std::fabs(found - value) <= half * (1.0 + 1e-6) + 1e-9 * std::fabs(value);
  }
};

std::optional<WrittenNumber> written_number(const std::string& text) {
  WrittenNumber t;
  const char* const end = text.data() + text.size();
  const char* begin = text.data() + (text.starts_with('+') ? 1 : 0);
  const auto [stop, error] = std::from_chars(begin, end, t.value);
  if (error != std::errc() || stop != end || !std::isfinite(t.value)) return std::nullopt;
  const std::size_t point = text.find('.'), power = text.find_first_of("eE");
  const std::size_t digits = std::min(power, text.size());
  const double places = point == text.npos ? 0.0 : static_cast<double>(digits - point - 1);
  t.half = 0.5 * std::pow(10.0, -places);
  if (power != text.npos) t.half *= std::pow(10.0, std::atof(text.c_str() + power + 1));
  return t;
}

struct Compared {
  const char* column;
  double per_si;
  const double* (*of)(const Observations&);
};

const double* position_of(const Observations& o) {
  return o.axes.empty() ? nullptr : o.axes.front().position.data();
}
const double* deviation_of_readings(const Observations& o) { return o.deviation.data(); }
const double* time_of(const Observations& o) { return o.time.empty() ? nullptr : o.time.data(); }
const double* material_of(const Observations& o) {
  return o.material.empty() ? nullptr : o.material.data();
}
const double* air_of(const Observations& o) { return o.air.empty() ? nullptr : o.air.data(); }

constexpr Compared compared_columns[] = {
    {"target_mm", 1e3, position_of},
    {"target_deg", deg_per_rad, position_of},
    {"deviation_um", 1e6, deviation_of_readings},
    {"deviation_arcsec", arcsec_per_rad, deviation_of_readings},
    {"time_s", 1.0, time_of},
    {"material_degC", 1.0, material_of},
    {"air_degC", 1.0, air_of}};

std::string other_column(const TableRow& row, const Observations& o, std::size_t i) {
  if (const std::string* run = row.find("run"); run != nullptr)
    if (o.run.empty() || std::to_string(o.run[i]) != *run) return "run";
  if (const std::string* direction = row.find("direction"); direction != nullptr)
    if (o.axes.empty() || o.axes.front().approach.empty() ||
        (o.axes.front().approach[i] > 0 ? "+" : "-") != *direction)
      return "direction";
  for (const Compared& c : compared_columns) {
    const std::string* text = row.find(c.column);
    if (text == nullptr) continue;
    const double* column = c.of(o);
    const auto wanted = written_number(*text);
    if (column == nullptr || !wanted || !wanted->holds(column[i] * c.per_si)) return c.column;
  }
  return {};
}

std::string shown_row(const TableRow& row) {
  std::string out;
  for (const auto& [column, text] : row.fields)
    if (column != "measurement") out += (out.empty() ? "" : ", ") + column + " " + text;
  return out;
}

}  // namespace

std::string differs_from_truth(const Observations& o, const Measurement& m, const Source& source,
                               std::size_t& compared) {
  std::vector<char> used(o.size());
  std::size_t rows = 0;
  for (const TableRow& row : rows_of_table(source, "readings.csv")) {
    if (const std::string id = row.text("measurement"); !id.empty() && id != m.id) continue;
    ++rows, ++compared;
    std::string nearest;
    std::size_t i = 0;
    for (; i < o.size(); ++i) {
      if (used[i] != 0) continue;
      const std::string other = other_column(row, o, i);
      if (other.empty()) break;
      // `nearest` is the column in which a reading with the same run, direction and target differs.
      if (other != "run" && other != "direction" && !other.starts_with("target")) nearest = other;
    }
    if (i == o.size())
      return row.where + " has a reading that it does not find: " + shown_row(row) +
             (nearest.empty() ? "" : "; one in this place has another " + nearest);
    used[i] = 1;
  }
  if (rows > 0 && rows != o.size())
    return "it finds " + std::to_string(o.size()) + " readings, readings.csv has " +
           std::to_string(rows);
  return {};
}

Verdict truth(const Analysis& a, const Bench& bench) {
  std::size_t compared = 0;
  for (const Sample& s : bench.samples)
    for (const Source& source : bench.sources) {
      if (source.name != s.name) continue;
      for (const TableRow& row : rows_of_table(source, "expected/values.csv")) {
        if (row.text("plugin") != a.info.name) continue;
        bench.stage("sample " + s.name + ", expected/" + row.where);
        const auto measured =
            std::find_if(s.campaign.measurements.begin(), s.campaign.measurements.end(),
                         [&](const Measurement& m) { return m.id == row.text("measurement"); });
        const bool whole = measured == s.campaign.measurements.end();
        if (whole ? a.analyse_campaign == nullptr : a.analyse == nullptr) continue;
        const Settings options = settings_for(a.info, s);
        const auto e =
            whole ? a.analyse_campaign({s.campaign, s.observations, options})
                  : a.analyse({s.campaign, *measured, s.of(*measured), options, &s.observations});
        const std::string where = "sample " + s.name + ", " + row.where + ", " + row.text("name");
        if (!e) return failed(where + ": " + e.error().message);
        ++compared;
        const auto value = std::find_if(e->values.begin(), e->values.end(),
                                        [&](const Value& v) { return v.name == row.text("name"); });
        if (value == e->values.end()) return failed(where + ": it gives no such value");
        const Unit unit = unit_of(value->quantity);
        if (unit.symbol != row.text("unit"))
          return failed(where + ": it is in " + std::string(unit.symbol) + ", expected " +
                        row.text("unit"));
        const auto wanted = written_number(row.text("value"));
        if (!wanted || !wanted->holds(value->value * unit.per_si))
          return failed(where + ": it is " + short_text(value->value * unit.per_si, 9) +
                        ", expected " + row.text("value"));
      }
    }
  return compared > 0 ? passed()
                      : skipped(
                            "no case has a row of it in expected/values.csv: write down what "
                            "was calculated by hand");
}

namespace {

double length_of(const std::vector<double>& v) {
  double sum = 0.0;
  for (const double x : v) sum += x * x;
  return std::sqrt(sum);
}

std::string other_columns(const Effect& e, const Effect& formula, const Observations& o,
                          const Axis& axis) {
  for (const double share : {0.5, 0.0, 1.0}) {
    std::vector<double> shape;
    for (const auto& s : e.shapes) {
      const auto grid = s.grid(o, axis);
      if (grid.empty()) return {};
      shape.push_back(grid[static_cast<std::size_t>(share * static_cast<double>(grid.size() - 1))]);
    }
    const auto one = e.columns(o, axis, shape), two = formula.columns(o, axis, shape);
    if (!one) return one.error().message;
    if (!two) return "the formula: " + two.error().message;
    if (one->size() != two->size())
      return "it has " + std::to_string(one->size()) + " columns, the formula " +
             std::to_string(two->size());
    for (std::size_t k = 0; k < one->size(); ++k)
      for (std::size_t i = 0; i < o.size(); ++i)
        if (!(std::fabs((*one)[k][i] - (*two)[k][i]) <= 1e-7 * length_of((*two)[k])))
          return "its column " + std::to_string(k + 1) + " is " + short_text((*one)[k][i], 7) +
                 " for reading " + std::to_string(i + 1) + ", expected " +
                 short_text((*two)[k][i], 7) + " (SI)";
    if (e.shapes.empty()) break;
  }
  return {};
}

/// formulas.toml contains [[model.formula]] as in a manifest. The manifest itself must not contain
/// these formulas, because they predict an effect that already exists.
Expected<std::vector<Formula>> formulas_of(const Source& source,
                                           const std::vector<Method>& methods) {
  const Artifact* file = file_of(source, "formulas.toml");
  if (file == nullptr) return std::vector<Formula>();
  auto manifest = config::parse_manifest(source.manifest + "\n" + file->bytes,
                                         "campaign.toml, formulas.toml", methods);
  if (!manifest) return fail(manifest.error().front());
  return std::move(manifest->campaign.formulas);
}

Verdict same_as(const Formula& formula, const Effect& e, const Sample& s, const Bench& bench,
                std::size_t& compared) {
  for (const model::Part& part : model::parts_of(s.campaign, s.observations))
    for (const Axis& axis : part.axes) {
      if (axis.name != formula.axis || !e.applies(part.table, axis)) continue;
      bench.stage("sample " + s.name + ", " + formula.name);
      const auto said = config::formula_effect(formula, axis);
      if (!said) return failed("sample " + s.name + ": " + said.error().message);
      if (const std::string why = other_columns(e, *said, part.table, axis); !why.empty())
        return failed("sample " + s.name + ", axis " + axis.name + ": " + why);
      ++compared;
    }
  return passed();
}

}  // namespace

Verdict truth(const Effect& e, const Bench& bench) {
  std::size_t compared = 0;
  if (!e.columns || !e.applies) return failed("applies or columns is missing");
  for (const Sample& s : bench.samples)
    for (const Source& source : bench.sources) {
      const auto formulas =
          source.name == s.name ? formulas_of(source, bench.methods) : std::vector<Formula>();
      if (!formulas) return failed("sample " + s.name + ": " + formulas.error().message);
      for (const Formula& formula : *formulas) {
        if (formula.name != e.info.name) continue;
        Verdict v = same_as(formula, e, s, bench, compared);
        if (v.state != Verdict::State::passed) return v;
      }
    }
  return compared > 0 ? passed()
                      : skipped("no case has a formula called \"" + e.info.name +
                                "\" in formulas.toml: write the effect down as a formula");
}

namespace {

std::string other_entry(const TableRow& row, const LoadedTable& t, std::size_t i, bool plus) {
  const std::string* text = row.find(plus ? (t.rotary ? "plus_arcsec" : "plus_um")
                                          : (t.rotary ? "minus_arcsec" : "minus_um"));
  if (text == nullptr) return {};
  const auto wanted = written_number(*text);
  const std::vector<double>& entries = plus || t.minus.empty() ? t.plus : t.minus;
  const double found = entries[i] * (t.rotary ? arcsec_per_rad : 1e6);
  if (wanted && wanted->holds(found)) return {};
  return row.where + ": the control would add " + short_text(found, 6) + ", expected " + *text;
}

std::string other_point(const TableRow& row, const std::vector<LoadedTable>& tables) {
  const std::string* text = row.find("position_mm");
  if (text == nullptr) text = row.find("position_deg");
  const auto wanted = text == nullptr ? std::nullopt : written_number(*text);
  if (!wanted) return row.where + ": expected a number in position_mm or position_deg";
  for (const LoadedTable& t : tables) {
    if (t.output != row.text("axis") || t.position.size() != 1) continue;
    for (std::size_t i = 0; i < t.position.front().size(); ++i) {
      if (!wanted->holds(t.position.front()[i] * (t.rotary ? deg_per_rad : 1e3))) continue;
      std::string why = other_entry(row, t, i, true);
      return why.empty() ? other_entry(row, t, i, false) : why;
    }
  }
  return row.where + ": no point of axis " + row.text("axis") + " at " + *text;
}

}  // namespace

Verdict truth(const Controller& o, const Bench& bench) {
  std::size_t compared = 0;
  if (!o.parse) return failed("it cannot read its table back (Controller::parse)");
  for (const Sample& s : bench.samples)
    for (const Source& source : bench.sources) {
      const auto rows =
          source.name == s.name ? rows_of_table(source, "table.csv") : std::vector<TableRow>();
      std::map<std::string, std::vector<TableRow>> by_file;
      for (const TableRow& row : rows) by_file[row.text("file")].push_back(row);
      for (const auto& [name, points] : by_file) {
        const std::string where = "sample " + s.name + ", " + name + ": ";
        const Artifact* file = file_of(source, name);
        if (file == nullptr) return failed(where + "table.csv names it, and there is no such file");
        bench.stage(where);
        const auto tables = o.parse({{*file}, s.campaign, settings_for(o, s)});
        if (!tables) return failed(where + tables.error().message);
        std::size_t entries = 0;
        for (const LoadedTable& t : *tables)
          entries += t.position.size() == 1 ? t.position.front().size() : 0;
        for (const TableRow& row : points)
          if (const std::string why = other_point(row, *tables); !why.empty())
            return failed(where + why);
        if (entries != points.size())
          return failed(where + "it reads " + std::to_string(entries) + " points, expected " +
                        std::to_string(points.size()));
        compared += entries;
      }
    }
  return compared > 0 ? passed()
                      : skipped(
                            "no case has a table.csv: write down what the maker's manual states "
                            "that a file of its does");
}

}  // namespace nonio::plugin_check::kit
