// SPDX-License-Identifier: Apache-2.0
#include "campaign/evaluation/control_tables.h"

#include <algorithm>
#include <cmath>

#include "campaign/tables/control_state.h"
#include "nonio/math/compensation.h"
#include "nonio/math/loaded_table.h"
#include "nonio/sdk/format.h"

namespace nonio::evaluation {

AxisCorrection correction_of(const std::vector<LoadedTable>& tables, const std::string& axis) {
  AxisCorrection out;
  const auto own = tables::own_tables(tables, axis);
  for (const LoadedTable& t : own) {
    out.position.insert(out.position.end(), t.position.front().begin(), t.position.front().end());
    if (t.backlash) out.backlash = t.backlash;
  }
  std::sort(out.position.begin(), out.position.end());
  out.position.erase(std::unique(out.position.begin(), out.position.end()), out.position.end());
  for (const double x : out.position) {
    double plus = 0.0, minus = 0.0;
    for (const LoadedTable& t : own) {
      plus += math::added(t, std::span(&x, 1), 1);
      minus += math::added(t, std::span(&x, 1), -1);
    }
    out.plus.push_back(plus), out.minus.push_back(minus);
  }
  return out;
}

namespace {

/// Measurements with more targets are not stored, to limit the size of results.json.
constexpr std::size_t most_targets = 500;

double u_of_mean(const math::AxisTest& test) {
  double squares = 0.0, n = 0.0, means = 0.0;
  for (std::size_t i = 0; i < test.targets.size(); ++i)
    for (const auto& readings : {test.plus(i), test.minus(i)}) {
      if (readings.empty()) continue;
      double mean = 0.0;
      for (const auto& r : readings) mean += r.deviation / static_cast<double>(readings.size());
      for (const auto& r : readings) squares += (r.deviation - mean) * (r.deviation - mean);
      n += static_cast<double>(readings.size()), means += 1.0;
    }
  return n > means ? std::sqrt(squares / (n - means) / (n / means)) : 0.0;
}

class OfCampaign {
 public:
  OfCampaign(const reading::ReadCampaign& read, const Results& results,
             const WantedController& wanted)
      : read_(read), results_(results), wanted_(wanted) {}

  std::optional<ControlTables> of(std::size_t index, std::vector<Remark>& notes) const {
    const Campaign& campaign = read_.manifest->campaign;
    const Measurement& m = campaign.measurements[index];
    if (m.kind != "axis" || read_.observations[index].size() == 0) return std::nullopt;
    const auto test = math::AxisTest::arrange(read_.observations[index]);
    const auto curve = math::error_curve(test);
    if (curve.position.size() < 3) return std::nullopt;
    if (curve.position.size() > most_targets) {
      notes.push_back({"table.not-recorded",
                       {{"targets", static_cast<double>(curve.position.size()), Quantity::count},
                        {"most", static_cast<double>(most_targets), Quantity::count}},
                       {{"axis", control_axis(campaign.machine, m)}},
                       m.id});
      return std::nullopt;
    }
    ControlTables out{.measurement = m.id,
                      .axis = control_axis(campaign.machine, m),
                      .state = m.adjustment == "after" ? "as-left" : "as-found"};
    out.rotary = test.rotary;
    out.position = curve.position, out.plus = curve.plus, out.minus = curve.minus;
    out.u = u_of_mean(test);
    out.active = active(campaign.machine.axis(out.axis), m);
    out.written = written(out.axis, m);
    add_recorded(out);
    return out;
  }

 private:
  std::vector<LoadedTable> tables_of(const std::vector<Artifact>& files) const {
    const auto tables =
        tables::tables_in(*wanted_.controller, files, read_.manifest->campaign, wanted_.options);
    return tables ? *tables : std::vector<LoadedTable>{};
  }

  std::optional<AxisCorrection> active(const Axis* axis, const Measurement& m) const {
    if (m.compensation == "off") return AxisCorrection{};
    if (axis == nullptr || !axis->active_table) return std::nullopt;
    AxisCorrection out;
    if (const auto files = read_.active_tables.find(axis->name); files != read_.active_tables.end())
      out = correction_of(tables_of(files->second), axis->name);
    if (axis->active_backlash) out.backlash = axis->active_backlash;
    return out;
  }

  /// Returns nullopt without a written table, or if the axis was measured more than once, because
  /// it is then not known which table is loaded.
  std::optional<AxisCorrection> written(const std::string& axis, const Measurement& m) const {
    const Campaign& campaign = read_.manifest->campaign;
    const auto many = std::count_if(
        campaign.measurements.begin(), campaign.measurements.end(), [&](const Measurement& o) {
          return o.kind == "axis" && control_axis(campaign.machine, o) == axis;
        });
    if (many != 1 || m.kind != "axis") return std::nullopt;
    for (const Results::Written& w : results_.outputs) {
      if (w.plugin != wanted_.controller->info.name || w.result.artifacts.empty()) continue;
      AxisCorrection out = correction_of(tables_of(w.result.artifacts), axis);
      if (!out.position.empty()) return out;
    }
    return std::nullopt;
  }

  void add_recorded(ControlTables& out) const {
    if (!read_.machine) return;
    const auto axis = read_.machine->axes.find(out.axis);
    if (axis == read_.machine->axes.end()) return;
    for (const config::ControlState& s : axis->second.states) {
      const auto files = read_.state_files.find(s.files);
      if (s.files.empty() || files == read_.state_files.end()) continue;
      AxisCorrection correction = correction_of(tables_of(files->second), out.axis);
      if (!correction.position.empty()) out.recorded.push_back({s.since, std::move(correction)});
    }
  }

  const reading::ReadCampaign& read_;
  const Results& results_;
  const WantedController& wanted_;
};

void put_numbers(JsonWriter& json, const std::string& name, const std::vector<double>& values,
                 Quantity q) {
  json.list(name + std::string(unit_of(q).suffix), values,
            [&](const double v) { json.value(printed(v, q)); });
}

void put_correction(JsonWriter& json, const AxisCorrection& c, bool rotary) {
  put_numbers(json, "position", c.position, position_of(rotary));
  put_numbers(json, "plus", c.plus, deviation_of(rotary));
  if (c.minus != c.plus) put_numbers(json, "minus", c.minus, deviation_of(rotary));
  if (c.backlash)
    json.member("backlash" + std::string(unit_of(deviation_of(rotary)).suffix),
                printed(*c.backlash, deviation_of(rotary)));
}

}  // namespace

std::vector<ControlTables> control_tables(const reading::ReadCampaign& read, const Results& results,
                                          const std::vector<WantedController>& controllers,
                                          std::vector<Remark>& notes) {
  std::vector<ControlTables> out;
  const std::string& control = read.manifest->campaign.machine.control;
  for (const WantedController& wanted : controllers) {
    if (control.empty() || wanted.controller->info.name != control) continue;
    const OfCampaign of(read, results, wanted);
    for (std::size_t i = 0; i < read.observations.size(); ++i)
      if (auto one = of.of(i, notes)) out.push_back(std::move(*one));
  }
  return out;
}

void put_control_tables(JsonWriter& json, const std::vector<ControlTables>& all) {
  if (all.empty()) return;
  json.key("control_tables");
  json.begin_array();
  for (const ControlTables& t : all) {
    json.begin_object();
    json.member("measurement", t.measurement);
    json.member("axis", t.axis);
    json.member("state", t.state);
    put_numbers(json, "position", t.position, position_of(t.rotary));
    put_numbers(json, "plus", t.plus, deviation_of(t.rotary));
    put_numbers(json, "minus", t.minus, deviation_of(t.rotary));
    json.member("u" + std::string(unit_of(deviation_of(t.rotary)).suffix),
                printed(t.u, deviation_of(t.rotary)));
    for (const auto& [name, table] : {std::pair{"active", &t.active}, {"written", &t.written}}) {
      if (!*table) continue;
      json.key(name);
      json.begin_object();
      put_correction(json, **table, t.rotary);
      json.end_object();
    }
    if (!t.recorded.empty()) {
      json.key("recorded");
      json.begin_array();
      for (const auto& [since, table] : t.recorded) {
        json.begin_object();
        json.member("since", since);
        put_correction(json, table, t.rotary);
        json.end_object();
      }
      json.end_array();
    }
    json.end_object();
  }
  json.end_array();
}

}  // namespace nonio::evaluation
