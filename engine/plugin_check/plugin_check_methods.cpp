// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>

#include "nonio/sdk/format.h"
#include "nonio/sdk/method.h"
#include "platform/storage/digest.h"
#include "plugin_check/plugin_checks.h"

namespace nonio::plugin_check::kit {

namespace {

constexpr std::size_t odd_readings = 60;
const char* const no_columns = "it declares no columns: readers of their own read its files";
const char* const no_measurement =
    "no sample of its kind; put a campaign with one into cases/<name>/campaign.toml";

struct Measured {
  const Sample& sample;
  const Measurement& measurement;
  const Observations& observations;

  std::string where() const { return "sample " + sample.name + ", " + measurement.file; }
};

std::vector<Measured> measured_with(const Method& m, const Bench& bench) {
  std::vector<Measured> all;
  for (const Sample& s : bench.samples)
    for (const Measurement& one : s.campaign.measurements)
      if (method_name(one) == m.info.name && one.reader.empty()) all.push_back({s, one, s.of(one)});
  return all;
}

Verdict each_measured(const Method& m, const Bench& bench,
                      const std::function<std::string(const Measured&)>& law) {
  if (m.columns.empty()) return skipped(no_columns);
  const auto all = measured_with(m, bench);
  if (all.empty()) return skipped(no_measurement);
  for (const Measured& one : all) {
    bench.stage(one.where());
    if (const std::string why = law(one); !why.empty()) return failed(one.where() + ": " + why);
  }
  return passed();
}

Verdict method_kind(const Method& m, const Bench& bench) {
  if (m.observed_as.empty()) return skipped("it is a kind of its own");
  const bool known =
      m.observed_as != m.info.name &&
      std::any_of(bench.methods.begin(), bench.methods.end(), [&](const Method& one) {
        return one.info.name == m.observed_as && one.observed_as.empty();
      });
  return known ? passed()
               : failed("expected the name of another method in observed_as; found \"" +
                        m.observed_as + "\"");
}

Verdict method_keys(const Method& m, const Bench&) {
  if (m.info.options.empty()) return skipped("it declares no keys");
  for (const Option& o : m.info.options) {
    if (const std::string why = wrong_option(o, true); !why.empty())
      return failed("key " + o.name + " " + why);
    if (!o.required && !o.missing.empty())
      return failed("key " + o.name + " has a text for a missing key and is not required");
  }
  return passed();
}

Verdict method_columns(const Method& m, const Bench&) {
  if (m.columns.empty()) return skipped(no_columns);
  const auto sound = check(m);
  return sound ? passed() : failed(sound.error().message);
}

bool nearly_equal(double a, double b) {
  if (std::isnan(a) || std::isnan(b)) return std::isnan(a) && std::isnan(b);
  return std::fabs(a - b) <= 1e-9 * std::max({std::fabs(a), std::fabs(b), 1e-6});
}

std::vector<std::pair<const char*, double>> values_of_row(const Observations& o, std::size_t i) {
  std::vector<std::pair<const char*, double>> row{
      {"deviation", o.deviation[i]}, {"run", o.run_of(i)}, {"line", o.line_of(i)}};
  for (const auto& axis : o.axes) {
    row.emplace_back("position", axis.position[i]);
    row.emplace_back("approach", axis.approach.empty() ? 0.0 : axis.approach[i]);
  }
  for (const auto& [name, column] : {std::pair{"time", &o.time},
                                     {"material temperature", &o.material},
                                     {"air temperature", &o.air},
                                     {"pressure", &o.pressure},
                                     {"humidity", &o.humidity}})
    row.emplace_back(name, column->empty() ? std::nan("") : (*column)[i]);
  return row;
}

std::string difference_of(const Observations& wanted, const Observations& found) {
  if (found.size() != wanted.size())
    return std::to_string(found.size()) + " observations; expected " +
           std::to_string(wanted.size());
  if (found.angular != wanted.angular) return "a deviation of another quantity";
  if (found.axes.size() != wanted.axes.size()) return "a different number of axes";
  for (std::size_t i = 0; i < wanted.size(); ++i) {
    const auto one = values_of_row(wanted, i), two = values_of_row(found, i);
    for (std::size_t k = 0; k < one.size(); ++k)
      if (!nearly_equal(one[k].second, two[k].second))
        return std::string("observation ") + std::to_string(i + 1) + " has the " + one[k].first +
               " " + short_text(two[k].second, 9) + " (SI); expected " +
               short_text(one[k].second, 9);
  }
  return {};
}

std::string round_trip_of(const Method& m, const Measured& one, const Observations& truth) {
  const auto readings = simulate(m, {one.sample.campaign, one.measurement, truth});
  if (!readings) return "simulate: " + readings.error().message;
  const auto found = observe(m, {one.sample.campaign, one.measurement, *readings});
  if (!found) return "observe: " + found.error().message;
  return difference_of(truth, *found);
}

/// Simulated readings must give the original observations again, for the deviations of the sample
/// and for random deviations.
Verdict method_round_trip(const Method& m, const Bench& bench) {
  storage::Random random = bench.random(11);
  return each_measured(m, bench, [&](const Measured& one) -> std::string {
    if (const std::string why = round_trip_of(m, one, one.observations); !why.empty()) return why;
    Observations other = one.observations;
    for (double& d : other.deviation) d = 1e-5 * random.normal();
    const std::string why = round_trip_of(m, one, other);
    return why.empty() ? "" : "with other deviations: " + why;
  });
}

Readings with_odd_value(Readings readings, const Method& m, storage::Random& random) {
  static constexpr double odd[] = {0.0, -1.0, 1e-300, 1e300, -1e300, 4294967296.0, 0.5};
  const auto any = [&](std::size_t n) {
    return std::min(n - 1, static_cast<std::size_t>(random.uniform() * static_cast<double>(n)));
  };
  const Method::Column& column = m.columns[any(m.columns.size())];
  const auto values = readings.columns.find(column.name);
  if (!column.required && random.uniform() < 0.3) {
    readings.columns.erase(column.name);
  } else if (values != readings.columns.end() && readings.size() > 0) {
    double& value = values->second[any(readings.size())];
    const bool may_be_blank = !column.required || column.role == Method::Column::Role::deviation;
    value = may_be_blank && random.uniform() < 0.5 ? std::nan("") : odd[any(std::size(odd))];
  }
  return readings;
}

Readings first_rows(const Readings& readings, std::size_t n) {
  Readings out = readings;
  out.source_line.resize(n);
  for (auto& [name, values] : out.columns) values.resize(n);
  return out;
}

std::string hostile_readings(const Method& m, const Measured& one, const Readings& readings) {
  const MethodInput input{one.sample.campaign, one.measurement, readings};
  const auto o = m.observe ? m.observe(input) : observe(m, input);
  return o ? unsound(*o) : std::string();
}

Verdict method_hostile(const Method& m, const Bench& bench) {
  storage::Random random = bench.random(12);
  return each_measured(m, bench, [&](const Measured& one) -> std::string {
    const auto readings = simulate(m, {one.sample.campaign, one.measurement, one.observations});
    if (!readings) return "simulate: " + readings.error().message;
    for (const std::size_t n : {0, 1, 2})
      if (n <= readings->size())
        if (const std::string why = hostile_readings(m, one, first_rows(*readings, n));
            !why.empty())
          return "with " + std::to_string(n) + " rows: " + why;
    for (std::size_t k = 0; k < odd_readings; ++k) {
      Readings odd = with_odd_value(*readings, m, random);
      for (std::size_t more = 0; more < k % 4; ++more)
        odd = with_odd_value(std::move(odd), m, random);
      if (const std::string why = hostile_readings(m, one, odd); !why.empty())
        return "with damaged readings: " + why;
    }
    return {};
  });
}

}  // namespace

Verdict fingerprint(const Method& m, const Bench& bench) {
  const auto all = measured_with(m, bench);
  if (m.columns.empty() || all.empty())
    return skipped(m.columns.empty() ? no_columns : no_measurement);
  if (bench.only_plugin) bench.only_plugin();
  std::string text;
  for (const Measured& one : all) {
    bench.stage(one.where());
    const auto readings = simulate(m, {one.sample.campaign, one.measurement, one.observations});
    const auto o = readings ? observe(m, {one.sample.campaign, one.measurement, *readings})
                            : Expected<Observations>(fail(readings.error()));
    text += one.where() + (o ? std::string("\n") : ": " + o.error().message + "\n");
    if (readings)  // a wrong term in both functions cancels in the observations
      for (const auto& [name, column] : readings->columns)
        for (const double value : column) text += exact_text(value) + " ";
    for (std::size_t i = 0; o && i < o->size(); ++i)
      for (const auto& [name, value] : values_of_row(*o, i)) text += exact_text(value) + " ";
  }
  return {Verdict::State::passed, storage::sha256(text)};
}

const std::vector<Check<Method>>& method_checks() {
  static const std::vector<Check<Method>> checks = {
      {"observed-kind", "`observed_as` names a kind that another method declares.", method_kind},
      {"keys", "Keys of [[measurement]] have help and units, and can be checked.", method_keys},
      {"columns", "Names, quantities and roles of the columns are consistent.", method_columns},
      {"round-trip", "Observations, simulated as readings, are observed again.", method_round_trip},
      {"malformed", "Odd readings give an error or valid observations.", method_hostile}};
  return checks;
}

}  // namespace nonio::plugin_check::kit
