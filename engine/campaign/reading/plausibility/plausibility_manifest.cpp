// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <optional>

#include "campaign/reading/plausibility/plausibility.h"
#include "campaign/reading/plausibility/traceability.h"
#include "nonio/sdk/format.h"

namespace nonio::reading {
namespace {

constexpr double micrometre = 1e-6, arc_second = 1.0 / arcsec_per_rad;

/// Usual range of a stated value, inferred (docs/dev/wrong-inputs.md); 0 is never reported.
struct Statement {
  std::string key;
  std::optional<double> value;
  double least, most;
  Quantity quantity;
};

void axis_statements(const Axis& a, std::vector<Statement>& all) {
  const std::string key = "machine.axes." + a.name + ".";
  constexpr double mm = 1e-3, degree = 1.0 / deg_per_rad;
  all.push_back({key + "expansion_um_per_m_K", a.expansion, 3e-6, 3e-5, Quantity::expansion});
  // A new table contains this value: in um instead of mm, the value would move a motor by
  // millimeters.
  if (a.rotary)
    all.push_back({key + "active_backlash_deg", a.active_backlash, -0.5 * degree, 0.5 * degree,
                   Quantity::angle});
  else
    all.push_back(
        {key + "active_backlash_mm", a.active_backlash, -1 * mm, 1 * mm, Quantity::length});
  // A tolerance that is too large is otherwise not noticed, because everything conforms.
  for (const auto& [name, tolerance] : a.tolerance)
    if (a.rotary)
      all.push_back({key + "tolerance_arcsec." + name, tolerance, 0.1 * arc_second,
                     600 * arc_second, Quantity::angular_deviation});
    else
      all.push_back({key + "tolerance_um." + name, tolerance, 0.1 * micrometre, 1000 * micrometre,
                     Quantity::deviation});
}

void tolerance_statements(const Measurement& m, std::vector<Statement>& all) {
  for (const Tolerance& t : m.tolerances) {
    const bool angle = t.quantity == Quantity::angular_deviation;
    const double unit = angle ? arc_second : micrometre;
    all.push_back({"measurement." + m.id + "." + tolerance_key(t.quantity) + "." + t.result,
                   t.limit, 0.1 * unit, (angle ? 600.0 : 1000.0) * unit, t.quantity});
  }
}

void test_statements(const Campaign& c, const Measurement& m, std::vector<Statement>& all) {
  const std::string key = "measurement." + m.id + ".";
  const Axis* axis = c.machine.axis(m.axis);
  const bool rotary = axis != nullptr && axis->rotary;
  constexpr double mm = 1e-3, degree = 1.0 / deg_per_rad, minute = 60.0;
  all.push_back({key + "dwell_s", m.dwell, 0.05, 600, Quantity::time});
  if (rotary) {
    all.push_back(
        {key + "over_travel_deg", m.over_travel, 1e-3 * degree, 90 * degree, Quantity::angle});
  } else {
    all.push_back({key + "over_travel_mm", m.over_travel, 0.01 * mm, 500 * mm, Quantity::length});
  }
  if (!m.feed) return;
  const double feed = *m.feed * minute * (rotary ? deg_per_rad : 1e3);
  all.push_back({key + (rotary ? "feed_deg_per_min" : "feed_mm_per_min"), feed, 1.0,
                 rotary ? 720000.0 : 200000.0, Quantity::number});
}

std::vector<Statement> statements(const Campaign& c) {
  const Instrument& i = c.instrument;
  const Environment& e = c.environment;
  constexpr double finest = 1e-3 * micrometre, finest_angle = 1e-3 * arc_second;
  std::vector<Statement> all{
      {"instrument.U_fixed_um", i.U_fixed, finest, 200 * micrometre, Quantity::deviation},
      {"instrument.U_per_m_um", i.U_per_length, 1e-8, 5e-5, Quantity::deviation_per_length},
      {"instrument.U_arcsec", i.U_angle, finest_angle, 60 * arc_second,
       Quantity::angular_deviation},
      {"instrument.sphere_um", i.sphere, finest, 50 * micrometre, Quantity::deviation},
      {"instrument.probe_um", i.probe, finest, 100 * micrometre, Quantity::deviation},
      {"instrument.expansion_um_per_m_K", i.expansion, 1e-9, 3e-5, Quantity::expansion},
      {"instrument.temperature_range_K", i.temperature_range, 1e-3, 10,
       Quantity::temperature_difference},
      {"instrument.expansion_range_um_per_m_K", i.expansion_range, 1e-9, 6e-6, Quantity::expansion},
      {"environment.misalignment_mm", e.misalignment, 1e-6, 0.05, Quantity::length},
      {"environment.temperature_range_K", e.temperature_range, 0.01, 10,
       Quantity::temperature_difference},
      {"environment.temperature_difference_K", e.temperature_difference, 1e-3, 15,
       Quantity::temperature_difference},
      {"environment.expansion_range_um_per_m_K", e.expansion_range, 1e-9, 6e-6,
       Quantity::expansion},
      {"environment.drift_um", e.drift, finest, 200 * micrometre, Quantity::deviation},
      {"environment.drift_arcsec", e.drift_angle, finest_angle, 120 * arc_second,
       Quantity::angular_deviation}};
  constexpr double minutes = 60.0;
  all.push_back(
      {"environment.drift_minutes", e.drift_time, 1 * minutes, 10080 * minutes, Quantity::time});
  for (const Axis& a : c.machine.axes) axis_statements(a, all);
  for (const Measurement& m : c.measurements) {
    tolerance_statements(m, all);
    test_statements(c, m, all);
  }
  return all;
}

void implausible_places(const Campaign& c, std::vector<Finding>& out) {
  for (const Measurement& m : c.measurements)
    for (const auto* places : {&m.at, &m.from, &m.to})
      for (const auto& [name, place] : *places) {
        const Axis* axis = c.machine.axis(name);
        if (axis == nullptr || !axis->travel || axis->rotary) continue;
        const auto [from, to] = *axis->travel;
        const double spare = 0.02 * (to - from);
        if (place >= from - spare && place <= to + spare) continue;
        out.push_back({.id = "plausibility.place-outside-travel",
                       .attention = true,
                       .evidence = {{"place", place, Quantity::length},
                                    {"from", from, Quantity::length},
                                    {"to", to, Quantity::length}},
                       .texts = {{"axis", name}, {"of", m.id}}});
      }
}

std::string short_name(std::string_view text) {
  const std::size_t folder = text.find_last_of('/');
  if (folder != text.npos) text.remove_prefix(folder + 1);
  std::string name(text.substr(0, text.find_first_of(". ")));
  for (char& c : name) c = c >= 'A' && c <= 'Z' ? static_cast<char>(c + 32) : c;
  return name;
}

void push_name(std::string where, std::string found, std::string expected,
               std::vector<Finding>& out) {
  out.push_back({.id = "plausibility.name-of-another",
                 .attention = true,
                 .texts = {{"where", std::move(where)},
                           {"found", std::move(found)},
                           {"expected", std::move(expected)}}});
}

/// Reports two measurements whose files have each other's name, or the master side of a gantry with
/// the name of the slave.
void exchanged_names(const Campaign& c, std::vector<Finding>& out) {
  const auto called = [](const Measurement& m, const std::string& file) {
    return file == short_name(m.id) || file == short_name(m.axis);
  };
  for (std::size_t i = 0; i < c.measurements.size(); ++i) {
    const Measurement& m = c.measurements[i];
    const std::string file = short_name(m.file);
    for (std::size_t k = i + 1; k < c.measurements.size(); ++k) {
      const Measurement& other = c.measurements[k];
      const std::string its = short_name(other.file);
      if (file != its && m.lateral.empty() && other.lateral.empty() && called(m, its) &&
          called(other, file) && !called(m, file) && !called(other, its))
        push_name(m.file, short_name(m.file), m.id, out);
    }
    const Axis* axis = c.machine.axis(m.axis);
    if (m.side != "master" || axis == nullptr || axis->slave.empty()) continue;
    const std::string slave = short_name(axis->slave);
    if (short_name(m.id) == slave)
      push_name("measurement." + m.id + ".id", m.id, axis->name, out);
    else if (file == slave)
      push_name(m.file, axis->slave, axis->name, out);
  }
}

}  // namespace

std::vector<Finding> implausible_campaign(const config::Manifest& manifest,
                                          const std::string& today) {
  std::vector<Finding> out;
  const Campaign& c = manifest.campaign;
  for (const std::string& axis : manifest.undeclared_axes) {
    std::string known;
    for (const Axis& a : c.machine.axes)
      if (std::find(manifest.undeclared_axes.begin(), manifest.undeclared_axes.end(), a.name) ==
          manifest.undeclared_axes.end())
        known += (known.empty() ? "" : ", ") + a.name;
    out.push_back({.id = "plausibility.unknown-axis",
                   .attention = true,
                   .texts = {{"axis", axis}, {"known", known}}});
  }
  for (const auto& [key, day] :
       {std::pair{"campaign.date", &c.date}, {"campaign.end_date", &c.end_date}})
    if (!today.empty() && *day > today)
      out.push_back({.id = "plausibility.day-to-come",
                     .attention = true,
                     .texts = {{"key", key}, {"day", *day}, {"today", today}}});
  for (Finding& f : traceability_findings(c))
    if (f.id == "traceability.calibrated-later") {
      f.id = "plausibility.calibrated-later";
      out.push_back(std::move(f));
    } else if (is_expired_calibration(f.id)) {
      out.push_back(std::move(f));
    }
  for (const Statement& s : statements(c))
    if (s.value && *s.value != 0.0 && (*s.value < s.least || *s.value > s.most))
      out.push_back({.id = "plausibility.unusual-statement",
                     .attention = true,
                     .evidence = {{"value", *s.value, s.quantity},
                                  {"least", s.least, s.quantity},
                                  {"most", s.most, s.quantity}},
                     .texts = {{"key", s.key}}});
  implausible_places(c, out);
  exchanged_names(c, out);
  implausible_pitch(c, out);
  return out;
}

}  // namespace nonio::reading
