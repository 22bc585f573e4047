// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <dlfcn.h>
#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <functional>
#include <iostream>
#include <random>
#include <sstream>
#include <string>
#include <vector>

#include "nonio/math/compensation.h"
#include "nonio/math/drift.h"
#include "nonio/math/loaded_table.h"
#include "nonio/sdk/plugin.h"

/// Invented axes and the plugins as they were built.
namespace workshop {

using namespace nonio;

inline constexpr double um = 1e-6, mm = 1e-3;
inline constexpr double deg = 1.0 / deg_per_rad, arcsec = 1.0 / arcsec_per_rad;

struct OneController final : Registry {
  std::string name;
  Controller controller;
  void add(Method) override {}
  void add(Reader) override {}
  void add(Effect) override {}
  void add(Analysis) override {}
  void add(Output) override {}
  void add(Controller c) override {
    if (c.info.name == name) controller = std::move(c);
  }
};

/// NONIO_TEST_PLUGINS: a folder whose library takes the place of the one that was built
/// (tests/mutants).
inline Controller plugin(const std::string& name) {
  std::filesystem::path path = NONIO_CONTROLLERS;
  if (const char* folder = std::getenv("NONIO_TEST_PLUGINS"))
    if (const auto other = folder / path.filename(); exists(other)) path = other;
  void* library = dlopen(path.c_str(), RTLD_NOW | RTLD_LOCAL);
  if (library == nullptr) throw std::runtime_error(dlerror());
  const auto* entry = static_cast<const PluginEntry*>(dlsym(library, "nonio_plugin"));
  OneController registry;
  registry.name = name;
  entry->add_to(registry);
  if (registry.controller.info.name != name) throw std::runtime_error("no controller " + name);
  return registry.controller;
}

inline void print_seed(std::uint32_t seed) { std::cout << "seed " << seed << '\n'; }

inline Controller siemens_plugin() { return plugin("siemens-840d"); }
inline Controller heidenhain_plugin() { return plugin("heidenhain-tnc"); }
inline Controller fanuc_plugin() { return plugin("fanuc"); }
inline Controller linuxcnc_plugin() { return plugin("linuxcnc"); }

using Options = std::map<std::string, Setting>;

/// "X number=1 step_mm=50": a table X.
inline NumberTables tables_of(const std::vector<std::string>& texts) {
  NumberTables tables;
  for (const std::string& text : texts) {
    std::istringstream words(text);
    std::string axis, word;
    words >> axis;
    NumberTable& table = tables[axis];
    while (words >> word) {
      const std::size_t equals = word.find('=');
      table[word.substr(0, equals)] = std::stod(word.substr(equals + 1));
    }
  }
  return tables;
}

/// Defaults as declared, then the given ones; an undeclared or differently typed one is a mistake
/// of the test.
inline Settings settings(const Controller& output, const Options& given) {
  Settings s;
  for (const Option& o : output.info.options) s.values[o.name] = o.default_value;
  for (const auto& [name, value] : given) {
    EXPECT_EQ(s.values.count(name), 1U) << "undeclared option " << name;
    if (const auto* texts = std::get_if<std::vector<std::string>>(&value);
        texts != nullptr && std::holds_alternative<NumberTables>(s.values[name])) {
      s.values[name] = tables_of(*texts);
      continue;
    }
    EXPECT_EQ(s.values[name].index(), value.index()) << name;
    s.values[name] = value;
  }
  return s;
}

/// As the record of a machine would say it, for the axes whose entries do not: X is the first.
inline void state_numbers(Settings& s, const Controller& output, const std::vector<Axis>& axes) {
  if (!s.has("axes")) return;
  NumberTables tables = s.tables("axes");
  const bool joints = output.info.name == "linuxcnc";  // counts from 0
  for (std::size_t i = 0; i < axes.size(); ++i) {
    NumberTable& table = tables[axes[i].name];
    if (!table.contains("joint")) table.emplace("number", static_cast<double>(joints ? i : i + 1));
  }
  s.values["axes"] = tables;
}

/// What the control makes of these files, on a machine with these axes.
inline Expected<std::vector<LoadedTable>> read_back(
    const Controller& output, const std::vector<Artifact>& files, const Options& options = {},
    const std::vector<Axis>& axes = {{.name = "X"}, {.name = "Y"}, {.name = "Z"}}) {
  Campaign campaign;
  campaign.machine.axes = axes;
  Settings s = settings(output, options);
  state_numbers(s, output, axes);
  return output.parse({files, campaign, s});
}

/// What it adds to one axis by its own position.
inline Expected<math::Correction> control(const Controller& output,
                                          const std::vector<Artifact>& files,
                                          const Options& options = {},
                                          const std::string& axis = "X") {
  const auto tables = read_back(output, files, options);
  if (!tables) return tl::unexpected<Error>(tables.error());
  const auto correction = math::correction_of(*tables, axis);
  if (!correction) return fail("no table of " + axis);
  return *correction;
}

/// What it adds to `out` by the position of `in`.
inline Expected<math::Correction> control_cross(const Controller& output,
                                                const std::vector<Artifact>& files,
                                                const std::string& in, const std::string& out,
                                                const Options& options = {}) {
  const auto tables = read_back(output, files, options);
  if (!tables) return tl::unexpected<Error>(tables.error());
  for (const LoadedTable& t : *tables)
    if (t.input == std::vector{in} && t.output == out)
      return math::Correction([t](double x, int d) { return math::added(t, std::span(&x, 1), d); });
  return fail("no table of " + out + " by " + in);
}

using Curve = std::function<double(double)>;

/// One measured axis of a campaign. SI.
struct Measured {
  std::string axis = "X";
  std::string id = "X";
  bool rotary = false;
  std::vector<double> targets;
  Curve plus, minus;  ///< empty: not measured
  int runs = 1;
  double scatter = 0.0;
  std::uint32_t seed = 1;
};

struct Bench {
  Campaign campaign;
  std::vector<Observations> observations;
  Results results;
  Templates templates;
  bool numbered = true;       ///< the numbers of the axes in the control are stated
  bool active_stated = true;  ///< no table and no backlash value were active

  Bench() {
    campaign.id = "test";
    campaign.date = "2026-11-21";
    campaign.machine.maker = "Acme";
    campaign.machine.model = "M 1";
    campaign.machine.serial = "007";
  }
  explicit Bench(const Measured& m) : Bench() { add(m); }

  void add(const Measured& m) {
    if (campaign.machine.axis(m.axis) == nullptr) {
      Axis a;
      a.name = m.axis;
      a.rotary = m.rotary;
      if (active_stated) a.active_table = "", a.active_backlash = 0.0;
      campaign.machine.axes.push_back(a);
    }
    Measurement entry;
    entry.id = m.id;
    entry.kind = "axis";
    entry.axis = m.axis;
    campaign.measurements.push_back(entry);
    Observations o;
    o.measurement = m.id;
    o.angular = m.rotary;
    o.axes.push_back({m.axis, m.rotary, {}, {}});
    std::mt19937 random(m.seed);
    std::normal_distribution<double> scatter(0.0, 1.0);
    for (int run = 1; run <= m.runs; ++run)
      for (const int direction : {1, -1}) {
        const Curve& e = direction > 0 ? m.plus : m.minus;
        if (!e) continue;
        for (const double x : m.targets) {
          o.axes[0].position.push_back(x);
          o.axes[0].approach.push_back(static_cast<std::int8_t>(direction));
          o.deviation.push_back(e(x) + m.scatter * scatter(random));
          o.run.push_back(static_cast<std::uint32_t>(run));
        }
      }
    observations.push_back(std::move(o));
  }

  Expected<OutputResult> write(const Controller& output, const Options& options = {}) const {
    Settings s = settings(output, options);
    if (numbered) state_numbers(s, output, campaign.machine.axes);
    return output.write({campaign, observations, results, s});
  }
};

/// By drift and repetition alone: what no prediction of a bench without a budget is better than.
inline double U_of_mean_reversal(const Bench& b) {
  return math::drift_share(math::AxisTest::arrange(b.observations.at(0))).B_mean;
}

/// The same of tables for each direction, whose reversals are those of the targets.
inline double U_of_largest_reversal(const Bench& b) {
  return math::drift_share(math::AxisTest::arrange(b.observations.at(0))).B;
}

inline std::string file(const OutputResult& r, const std::string& name) {
  for (const Artifact& a : r.artifacts)
    if (a.name == name) return a.bytes;
  ADD_FAILURE() << "no file " << name;
  return {};
}

inline bool has_file(const OutputResult& r, const std::string& name) {
  for (const Artifact& a : r.artifacts)
    if (a.name == name) return true;
  return false;
}

inline const Finding* finding(const OutputResult& r, const std::string& id) {
  for (const Finding& f : r.findings)
    if (f.id == id) return &f;
  return nullptr;
}

inline const Prediction& prediction(const OutputResult& r, const std::string& name) {
  static const Prediction none;
  for (const Prediction& p : r.predictions)
    if (p.name == name) return p;
  ADD_FAILURE() << "no prediction of " << name;
  return none;
}

inline std::vector<double> even(double first, double step, int n) {
  std::vector<double> x;
  for (int i = 0; i < n; ++i) x.push_back(first + step * i);
  return x;
}

/// A smooth curve with a pitch error of its own: some sines and a slope.
inline Curve random_curve(std::mt19937& random, double length, double size) {
  std::uniform_real_distribution<double> u(-1.0, 1.0);
  std::vector<std::array<double, 3>> waves;
  for (int k = 1; k <= 3; ++k)
    waves.push_back({size * u(random) / k, k * 3.0 / length, 6 * u(random)});
  const double slope = size * u(random) / length, zero = size * u(random);
  return [=](double x) {
    double e = zero + slope * x;
    for (const auto& w : waves) e += w[0] * std::sin(w[1] * x + w[2]);
    return e;
  };
}

inline std::vector<std::string> lines(const std::string& text) {
  std::vector<std::string> out;
  for (std::size_t i = 0; i < text.size();) {
    const std::size_t end = std::min(text.find('\n', i), text.size());
    out.push_back(text.substr(i, end - i));
    i = end + 1;
  }
  return out;
}

inline bool contains(const std::string& text, const std::string& part) {
  return text.find(part) != std::string::npos;
}

inline math::ErrorCurve curve_of(const Bench& b, std::size_t i = 0) {
  return math::error_curve(math::AxisTest::arrange(b.observations[i]));
}

}  // namespace workshop
