// SPDX-License-Identifier: Apache-2.0
#include "campaign_workbook.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <map>
#include <tuple>

#include "campaign/config/terminal_words.h"
#include "nonio/sdk/format.h"
#include "platform/storage/json_values.h"

namespace nonio::app {
using storage::Cell;
using storage::Chart;
using storage::Day;
using storage::Json;
using storage::Sheet;

namespace {

using Row = std::vector<Cell>;

/// Sheets of measurements must not use these names.
constexpr const char* fixed_names[] = {"Summary", "Charts", "Points", "Curves", "Budget"};

/// Number of points per curve that Excel accepts in a chart.
constexpr std::size_t most_chart_points = 32'000;

Cell number_cell(const Json& of, const char* key) {
  const auto found = of.find(key);
  if (found == of.end() || !found->is_number()) return {};
  return found->get<double>();
}

Cell text(const Json& of, const char* key) { return of.value(key, std::string()); }

Cell printed_cell(const std::vector<double>& values, std::size_t i, Quantity quantity) {
  if (i >= values.size() || !std::isfinite(values[i])) return {};
  return printed(values[i], quantity);
}

std::string column_name(const std::string& name, const std::string& unit) {
  return unit.empty() ? name : name + " (" + unit + ")";
}

std::string title_of(const Json& analysis) {
  std::string title = analysis.value("measurement", "");
  for (const char* key : {"plugin", "part"})
    if (const std::string more = analysis.value(key, ""); !more.empty())
      title += (title.empty() ? "" : ", ") + more;
  return title;
}

void add_heading(Sheet& sheet, Row row) {
  sheet.headings.push_back(sheet.rows.size());
  sheet.rows.push_back(std::move(row));
}

class Composer {
 public:
  explicit Composer(const Shown& shown)
      : shown_(shown),
        say_(shown.templates, shown.language),
        results_(storage::parse(shown.text)) {}

  storage::Workbook compose() {
    const Json& campaign = results_.at("campaign");
    book_.title = campaign.at("id").get<std::string>();
    book_.date = campaign.value("date", "");
    Sheet summary = summary_sheet(campaign), points{"Points"}, curves{"Curves"}, budget{"Budget"};
    for (const char* taken : fixed_names) book_.sheets.push_back({taken});
    readings();
    for (const Json& analysis : results_.at("analyses")) {
      add_points(points, analysis);
      add_curves(curves, analysis);
      add_budget(budget, analysis);
    }
    Sheet charts{"Charts"};
    charts.charts = std::move(charts_);
    std::vector<Sheet> all;
    all.push_back(std::move(summary));
    for (Sheet* sheet : {&charts, &points, &curves, &budget})
      if (!sheet->rows.empty() || !sheet->charts.empty()) all.push_back(std::move(*sheet));
    std::move(book_.sheets.begin() + std::size(fixed_names), book_.sheets.end(),
              std::back_inserter(all));
    book_.sheets = std::move(all);
    return std::move(book_);
  }

 private:
  Sheet summary_sheet(const Json& campaign) {
    Sheet sheet{"Summary"};
    const std::string status = results_.at("status");
    add_heading(sheet, {std::string("Campaign"), book_.title});
    const auto add = [&](const char* name, Cell cell) {
      const auto* written = std::get_if<std::string>(&cell);
      if (written == nullptr || !written->empty())
        sheet.rows.push_back({std::string(name), std::move(cell)});
    };
    add("Status", say_.of("status", status));
    for (const auto& [name, key] :
         {std::pair{"Customer", "customer"}, {"Location", "site"}, {"Operator", "operator"}})
      add(name, text(campaign, key));
    if (campaign.contains("date")) add("Date", Day{campaign.at("date")});
    things(add, campaign, "machine", "Machine");
    things(add, campaign, "instrument", "Instrument");
    if (const Json issued = results_.value("certificate", Json::object());
        !issued.value("number", "").empty())
      add("Certificate", text(issued, "number"));
    add("Nonio", text(results_, "nonio"));
    for (const Json& error : results_.at("errors")) {
      Error e{error.value("message", ""), error.value("file", ""),
              error.value("line", std::uint64_t{0})};
      e.column = error.value("column", "");
      add("Error", text_of(e));
    }
    sheet.rows.emplace_back();
    values(sheet);
    findings(sheet);
    return sheet;
  }

  template <class Add>
  static void things(const Add& add, const Json& campaign, const char* key,
                     const std::string& name) {
    const Json thing = campaign.value(key, Json::object());
    std::string called;
    for (const char* part : {"maker", "model"})
      if (const std::string more = thing.value(part, ""); !more.empty())
        called += (called.empty() ? "" : " ") + more;
    add(name.c_str(), called);
    add((name + ", serial number").c_str(), text(thing, "serial"));
    if (thing.contains("calibrated"))
      add((name + ", calibrated").c_str(), Day{thing["calibrated"]});
  }

  void values(Sheet& sheet) {
    add_heading(sheet,
                {std::string("Measurement"), std::string("Analysis"), std::string("Result"),
                 std::string("Value"), std::string("U"), std::string("Unit"), std::string("k"),
                 std::string("Tolerance"), std::string("Decision"), std::string("Repeatability")});
    for (const Json& a : results_.at("analyses"))
      for (const auto& [name, v] : a.at("values").items())
        sheet.rows.push_back({text(a, "measurement"), analysis_name(a), name,
                              number_cell(v, "value"), number_cell(v, "U"), text(v, "unit"),
                              number_cell(v, "k"), number_cell(v, "tolerance"), decision(v),
                              number_cell(v, "repeatability")});
    for (const Json& c : results_.value("conformity", Json::array()))
      if (!has_value(c))
        sheet.rows.push_back({text(c, "measurement"), text(c, "plugin"), text(c, "name"), Cell(),
                              Cell(), text(c, "unit"), Cell(), number_cell(c, "tolerance"),
                              decision(c)});
  }

  static Cell analysis_name(const Json& a) {
    const std::string part = a.value("part", "");
    return a.at("plugin").get<std::string>() + (part.empty() ? "" : ", " + part);
  }

  Cell decision(const Json& of) const {
    const std::string decided = of.value("decision", "");
    return decided.empty() ? Cell() : Cell(say_.of("decision", decided));
  }

  bool has_value(const Json& conformity) const {
    const auto& all = results_.at("analyses");
    return std::any_of(all.begin(), all.end(), [&](const Json& a) {
      return a.value("measurement", "") == conformity.value("measurement", "") &&
             a.at("plugin") == conformity.at("plugin") &&
             a.at("values").contains(conformity.at("name").get<std::string>());
    });
  }

  void findings(Sheet& sheet) {
    std::vector<Row> rows;
    const auto add = [&](const Json& of) {
      for (const Json& json : of.value("findings", Json::array())) {
        const Finding f = finding_of(json);
        const auto words_of = [&](const char* part) {
          return finding_text(shown_.templates, shown_.language, f, part);
        };
        const std::string where =
            f.measurement.empty() ? of.value("measurement", "") : f.measurement;
        rows.push_back({where, analysis_name(of),
                        say_.of("severity", f.attention ? "attention" : "info"), words_of("title"),
                        words_of("says"), words_of("advice")});
      }
    };
    for (const Json& a : results_.at("analyses")) add(a);
    for (const Json& t : results_.value("tables", Json::array())) add(t);
    if (rows.empty()) return;
    sheet.rows.emplace_back();
    add_heading(sheet,
                {std::string("Measurement"), std::string("Analysis"), std::string("Severity"),
                 std::string("Finding"), std::string("Evidence"), std::string("Advice")});
    std::move(rows.begin(), rows.end(), std::back_inserter(sheet.rows));
  }

  /// The columns are those of a file of readings, so that Nonio can read the sheets again.
  void readings() {
    for (const Observations& o : shown_.observations) {
      if (o.measurement.empty() || (o.size() == 0 && o.channels.empty())) continue;
      if (o.size() > 0) {
        Sheet sheet{storage::sheet_name(book_, "Readings " + o.measurement)};
        names_[o.measurement] = sheet.name;
        fill(sheet, o);
        book_.sheets.push_back(std::move(sheet));
      }
      if (o.channels.empty()) continue;
      Sheet sheet{storage::sheet_name(book_, "Channels " + o.measurement)};
      add_heading(sheet, {std::string("channel"), std::string("unit"), std::string("time_s"),
                          std::string("value")});
      sheet.frozen = 1;
      for (const auto& c : o.channels)
        for (std::size_t i = 0; i < c.value.size(); ++i)
          sheet.rows.push_back(
              {c.name, c.unit, printed_cell(c.time, i, Quantity::time), c.value[i]});
      book_.sheets.push_back(std::move(sheet));
    }
  }

  static std::string direction(const std::vector<std::int8_t>& approach, std::size_t i) {
    return i >= approach.size() || approach[i] == 0 ? "" : approach[i] > 0 ? "+" : "-";
  }

  static bool is_of_one_axis(const Observations& o) {
    return o.axes.size() == 1 && o.lines.size() <= 1 && o.sense.empty();
  }

  static void fill(Sheet& sheet, const Observations& o) {
    const Quantity deviation = deviation_of(o.angular);
    Row head;
    const auto name = [&](const std::string& column, Quantity q) {
      head.push_back(column + std::string(unit_of(q).suffix));
    };
    const bool one = is_of_one_axis(o);
    if (!one) head.push_back(std::string("line"));
    head.push_back(std::string("run"));
    for (const auto& axis : o.axes) {
      if (one) head.push_back(std::string("direction"));
      name(one ? "target" : axis.axis, position_of(axis.rotary));
      if (!one && !axis.approach.empty()) head.push_back(axis.axis + "_dir");
    }
    const bool in_space = !one && std::any_of(o.lines.begin(), o.lines.end(), [](const auto& line) {
      return line.sense != std::array<double, 3>{};
    });
    if (in_space)
      for (const char* component : {"nx", "ny", "nz"}) head.push_back(std::string(component));
    name("deviation", deviation);
    const std::array<std::tuple<const char*, const std::vector<double>*, Quantity>, 5> recorded{
        {{"time", &o.time, Quantity::time},
         {"material", &o.material, Quantity::temperature},
         {"air", &o.air, Quantity::temperature},
         {"pressure_hpa", &o.pressure, Quantity::number},
         {"humidity_pct", &o.humidity, Quantity::number}}};
    for (const auto& [column, values, quantity] : recorded)
      if (!values->empty()) name(column, quantity);
    add_heading(sheet, std::move(head));
    sheet.frozen = 1;
    for (std::size_t i = 0; i < o.size(); ++i) {
      Row row;
      if (!one) row.push_back(o.lines.empty() ? std::string() : o.lines[o.line_of(i)].name);
      row.push_back(static_cast<double>(o.run_of(i)));
      for (const auto& axis : o.axes) {
        if (one) row.push_back(direction(axis.approach, i));
        row.push_back(printed_cell(axis.position, i, position_of(axis.rotary)));
        if (!one && !axis.approach.empty()) row.push_back(direction(axis.approach, i));
      }
      if (in_space)
        for (const double component : o.sense_of(i))
          row.push_back(printed(component, Quantity::number));
      row.push_back(printed(o.deviation[i], deviation));
      for (const auto& [column, values, quantity] : recorded)
        if (!values->empty()) row.push_back(printed_cell(*values, i, quantity));
      sheet.rows.push_back(std::move(row));
    }
  }

  void add_points(Sheet& sheet, const Json& analysis) {
    for (const auto& [rows, units] : {std::pair{"points", "point_units"}, {"rows", "row_units"}}) {
      if (!analysis.contains(units)) continue;
      const Json& columns = analysis.at(units);
      if (!sheet.rows.empty()) sheet.rows.emplace_back();
      add_heading(sheet, {title_of(analysis)});
      Row head;
      for (const auto& [name, unit] : columns.items()) head.push_back(column_name(name, unit));
      add_heading(sheet, std::move(head));
      const std::size_t first = sheet.rows.size();
      for (const Json& point : analysis.at(rows)) {
        Row row;
        for (const auto& [name, unit] : columns.items())
          row.push_back(number_cell(point, name.c_str()));
        sheet.rows.push_back(std::move(row));
      }
      if (const Json U = analysis.value("point_U", Json::object());
          !U.empty() && rows == std::string("points")) {
        Row row;
        for (const auto& [name, unit] : columns.items())
          row.push_back(number_cell(U, name.c_str()));
        if (std::holds_alternative<std::monostate>(row.front()))
          row.front() = std::string("U (k = 2), at most");
        sheet.rows.push_back(std::move(row));
      }
      if (rows == std::string("points")) add_means(analysis, first);
    }
  }

  /// Adds a chart of the mean deviations over the targets, unless the analysis lacks a direction.
  void add_means(const Json& analysis, std::size_t first) {
    const Json& units = analysis.at("point_units");
    const std::size_t count = analysis.at("points").size();
    if (count == 0 || !units.contains("target") || !units.contains("mean+") ||
        !units.contains("mean-"))
      return;
    const auto column_of = [&](const std::string& name) {
      std::size_t k = 0;
      for (const auto& [key, unit] : units.items()) {
        if (key == name) return k;
        ++k;
      }
      return k;
    };
    const std::string measurement = analysis.value("measurement", "");
    Chart chart{title_of(analysis),
                column_name("Target", units.at("target")),
                column_name("Deviation", units.at("mean+")),
                {}};
    for (const char* name : {"mean+", "mean-"}) {
      const auto& points = analysis.at("points");
      if (std::none_of(points.begin(), points.end(),
                       [&](const Json& point) { return point.contains(name); }))
        continue;
      Chart::Curve curve{name,  "Points",         column_of("target"), column_of(name),
                         first, first + count - 1};
      const Json U = analysis.value("point_U", Json::object());
      if (U.contains(name)) curve.U = U.at(name).get<double>();
      chart.curves.push_back(std::move(curve));
    }
    add_readings(chart, measurement);
    charts_.push_back(std::move(chart));
  }

  void add_readings(Chart& chart, const std::string& measurement) const {
    const auto found = std::find_if(shown_.observations.begin(), shown_.observations.end(),
                                    [&](const Observations& o) {
                                      return o.measurement == measurement && is_of_one_axis(o) &&
                                             o.size() > 0 && o.size() <= most_chart_points;
                                    });
    if (found == shown_.observations.end()) return;
    Chart::Curve curve{"readings", names_.at(measurement), 2, 3, 1, found->size()};
    curve.line = false;
    chart.curves.push_back(std::move(curve));
  }

  void add_curves(Sheet& sheet, const Json& analysis) {
    const Json series = analysis.value("series", Json::object());
    if (series.empty()) return;
    if (sheet.rows.empty()) {
      add_heading(sheet, {std::string("Measurement"), std::string("Analysis"), std::string("Curve"),
                          std::string("Over"), std::string("Position"), std::string("Unit"),
                          std::string("Value"), std::string("U"), std::string("Unit"),
                          std::string("k"), std::string("Repeatability")});
      sheet.frozen = 1;
    }
    std::vector<Chart> charts;
    for (const auto& [name, s] : series.items()) {
      const std::size_t first = sheet.rows.size(), count = s.at("position").size();
      const auto at = [&, &curve = s](const char* key, std::size_t i) {
        const auto list = curve.find(key);
        return list == curve.end() || i >= list->size() || !(*list)[i].is_number()
                   ? Cell()
                   : Cell((*list)[i].get<double>());
      };
      for (std::size_t i = 0; i < count; ++i)
        sheet.rows.push_back({text(analysis, "measurement"), analysis_name(analysis), name,
                              text(s, "over"), at("position", i), text(s, "position_unit"),
                              at("value", i), at("U", i), text(s, "unit"), number_cell(s, "k"),
                              at("repeatability", i)});
      if (count < 2 || count > most_chart_points) continue;
      add_curve(charts, title_of(analysis), name, s, {first, first + count - 1});
    }
    std::move(charts.begin(), charts.end(), std::back_inserter(charts_));
  }

  static void add_curve(std::vector<Chart>& charts, const std::string& title,
                        const std::string& name, const Json& s,
                        std::pair<std::size_t, std::size_t> rows) {
    const std::string over = column_name(s.at("over"), s.at("position_unit")),
                      value = column_name("Value", s.at("unit"));
    auto chart = std::find_if(charts.begin(), charts.end(), [&](const Chart& c) {
      return c.position_name == over && c.value_name == value;
    });
    if (chart == charts.end()) chart = charts.insert(chart, Chart{title, over, value, {}});
    chart->curves.push_back({name, "Curves", 4, 6, rows.first, rows.second});
  }

  void add_budget(Sheet& sheet, const Json& analysis) {
    if (!analysis.contains("budget")) return;
    const Json& budget = analysis.at("budget");
    const Json& results = budget.at("results");
    if (!sheet.rows.empty()) sheet.rows.emplace_back();
    add_heading(sheet, {title_of(analysis), std::string("longest reading (mm)"),
                        number_cell(budget, "length_mm")});
    Row head{std::string("Contribution"),
             std::string("u of a reading"),
             std::string("Unit"),
             std::string("With length"),
             std::string("Distribution"),
             std::string("Correlation"),
             std::string("Degrees of freedom"),
             std::string("Source")};
    const std::size_t fixed = head.size();
    for (const auto& [name, r] : results.items())
      head.push_back(column_name("u in " + name, r.at("unit")));
    add_heading(sheet, std::move(head));
    for (const Json& c : budget.at("contributions")) {
      const std::string id = c.at("id"),
                        named = words(shown_.templates, shown_.language, "budget.item." + id);
      Row row{named.empty() ? id : named,
              number_cell(c, "u"),
              text(c, "unit"),
              std::string(c.value("with_length", false) ? "yes" : "no"),
              text(c, "distribution"),
              text(c, "correlation"),
              number_cell(c, "dof"),
              text(c, "source")};
      for (const auto& [name, r] : results.items())
        row.push_back(number_cell(r.at("u"), id.c_str()));
      sheet.rows.push_back(std::move(row));
    }
    for (const auto& [name, key] : {std::pair{"Coverage factor k", "k"},
                                    {"Effective degrees of freedom", "dof"},
                                    {"U", "U"}}) {
      Row row(fixed);
      row.front() = std::string(name);
      for (const auto& [result, r] : results.items())
        row.push_back(number_cell(
            key == std::string("U") ? analysis.at("values").value(result, Json::object()) : r,
            key));
      sheet.rows.push_back(std::move(row));
    }
  }

  const Shown& shown_;
  config::TerminalWords say_;
  Json results_;
  storage::Workbook book_{};
  std::map<std::string, std::string> names_{};
  std::vector<Chart> charts_{};
};

}  // namespace

Expected<storage::Workbook> workbook_of(const Shown& shown) {
  try {
    return Composer(shown).compose();
  } catch (const Json::exception& e) {
    return fail(std::string("expected results of a campaign (nonio-results/1): ") + e.what());
  }
}

}  // namespace nonio::app
