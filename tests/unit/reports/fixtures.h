// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <dlfcn.h>
#include <gtest/gtest.h>
#include <toml++/toml.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <map>
#include <numbers>
#include <random>
#include <sstream>
#include <string>

#include "nonio/sdk/plugin.h"

/// Campaigns made up for the report's tests, evaluated by the real analyses.
namespace nonio::fixtures {

inline void flatten(const toml::table& table, const std::string& prefix, Settings& out) {
  for (const auto& [key, node] : table) {
    const std::string name = prefix + std::string(key.str());
    if (const auto* child = node.as_table()) {
      flatten(*child, name + ".", out);
    } else if (const auto* list = node.as_array()) {
      std::vector<std::string> texts;
      for (const auto& element : *list) texts.push_back(element.value_or<std::string>(""));
      out.values[name] = texts;
    } else if (node.is_string()) {
      out.values[name] = *node.value<std::string>();
    } else if (node.is_integer()) {
      out.values[name] = *node.value<std::int64_t>();
    } else if (node.is_boolean()) {
      out.values[name] = *node.value<bool>();
    } else {
      out.values[name] = node.value_or(0.0);
    }
  }
}

/// The templates of a folder, as the engine reads them.
inline Templates parse_templates(const std::filesystem::path& folder) {
  namespace fs = std::filesystem;
  Templates templates;
  const auto options = fs::directory_options::follow_directory_symlink;
  for (const auto& entry : fs::recursive_directory_iterator(folder, options)) {
    if (!entry.is_regular_file()) continue;
    const fs::path name = entry.path().lexically_relative(folder);
    std::string bytes(entry.file_size(), '\0');
    std::ifstream(entry.path(), std::ios::binary)
        .read(bytes.data(), static_cast<std::streamsize>(bytes.size()));
    if (name.extension() == ".toml") {
      Settings settings;
      flatten(toml::parse(bytes), "", settings);
      templates.tables[fs::path(name).replace_extension().generic_string()] = std::move(settings);
    } else {
      templates.files[name.generic_string()] = std::move(bytes);
    }
  }
  return templates;
}

/// The same, read once by a program.
inline const Templates& read_templates(const std::filesystem::path& folder) {
  static std::map<std::filesystem::path, Templates> read;
  const auto [place, is_new] = read.try_emplace(folder);
  if (is_new) place->second = parse_templates(folder);
  return place->second;
}

struct Plugins final : Registry {
  std::vector<Analysis> analyses;
  std::vector<Output> outputs;
  void add(Method) override {}
  void add(Reader) override {}
  void add(Effect) override {}
  void add(Analysis a) override {
    if (a.info.name == wanted_) analyses.push_back(std::move(a));
  }
  void add(Output o) override {
    if (o.info.name == wanted_) outputs.push_back(std::move(o));
  }
  void add(Controller) override {}

  /// The analysis or output of this name, from the libraries of a folder.
  bool load(const std::string& folder, const std::string& name) {
    wanted_ = name;
    const std::size_t before = analyses.size() + outputs.size();
    for (const char* library : {"/analyses.so", "/outputs.so"}) {
      void* opened = dlopen((folder + library).c_str(), RTLD_NOW | RTLD_LOCAL);
      if (opened == nullptr) ADD_FAILURE() << dlerror();
      const auto* entry = opened != nullptr
                              ? static_cast<const PluginEntry*>(dlsym(opened, "nonio_plugin"))
                              : nullptr;
      if (entry == nullptr) return false;
      entry->add_to(*this);
    }
    return analyses.size() + outputs.size() == before + 1;
  }

 private:
  std::string wanted_;
};

inline Settings defaults(const Info& info) {
  Settings settings;
  for (const Option& option : info.options) settings.values[option.name] = option.default_value;
  return settings;
}

/// How an axis behaves: um or arcsec over the share (0 to 1) of the travel.
struct Behaviour {
  bool rotary = false;
  double length = 2.0;  ///< m or rad
  int targets = 21, runs = 5;
  double slope = 8, wave = 3, reversal = -4, reversal_wave = 0, s_plus = 0.9, s_minus = 0.4;
  double drift = 0;  ///< from run to run
  bool plus = true, minus = true;
  unsigned seed = 7;
};

inline Observations observe(const std::string& id, const std::string& axis, const Behaviour& b) {
  Observations o;
  o.measurement = id;
  o.angular = b.rotary;
  o.axes.push_back({axis, b.rotary, {}, {}});
  o.lines.push_back({id, {1, 0, 0}});
  std::mt19937 random(b.seed);
  const auto noise =
      [&] {  // a sum of uniforms: the same everywhere, other than normal_distribution
        double sum = -6;
        for (int i = 0; i < 12; ++i) sum += static_cast<double>(random()) / 4294967296.0;
        return sum;
      };
  const double unit = 1.0 / unit_of(deviation_of(b.rotary)).per_si;
  for (int run = 1; run <= b.runs; ++run)
    for (const int direction : {1, -1})
      for (int k = 0; k < b.targets; ++k) {
        if ((direction > 0 && !b.plus) || (direction < 0 && !b.minus)) continue;
        const int i = direction > 0 ? k : b.targets - 1 - k;
        const double share = b.targets > 1 ? static_cast<double>(i) / (b.targets - 1) : 0;
        const double jitter = i == 0 || i == b.targets - 1 ? 0 : std::fmod(i * 0.37, 1.0) - 0.5;
        const double turn = 2 * std::numbers::pi * share;
        const double B = b.reversal + b.reversal_wave * std::sin(turn);
        const double deviation = b.slope * share + b.wave * std::sin(2.3 * turn) +
                                 direction * B / 2 + b.drift * (run - 1) +
                                 (direction > 0 ? b.s_plus : b.s_minus) * noise();
        const double position = b.length * (share + jitter * 0.3 / b.targets);
        o.axes[0].position.push_back(std::round(position * 1e4) / 1e4);
        o.axes[0].approach.push_back(static_cast<std::int8_t>(direction));
        o.deviation.push_back(deviation * unit);
        o.u.push_back(0);
        o.run.push_back(static_cast<std::uint32_t>(run));
        o.material.push_back(20.1 + 0.02 * run);
      }
  return o;
}

struct Case {
  Campaign campaign;
  std::vector<Observations> observations;
  Results results;

  void add(const std::string& axis, const Behaviour& b) {
    campaign.machine.axes.push_back({axis, b.rotary});
    Measurement m;
    m.id = axis;
    m.kind = "axis";
    m.axis = axis;
    m.file = axis + ".csv";
    campaign.measurements.push_back(m);
    observations.push_back(observe(axis, axis, b));
  }

  void analyse(const Plugins& plugins) {
    for (std::size_t i = 0; i < observations.size(); ++i)
      for (const Analysis& a : plugins.analyses) {
        const Settings options = defaults(a.info);
        auto e = a.analyse({campaign, campaign.measurements[i], observations[i], options});
        if (!e) {
          results.errors.push_back(e.error());
          continue;
        }
        results.analyses.push_back(
            {a.info.name, a.info.version, campaign.measurements[i].id, std::move(*e)});
      }
  }
};

inline Case simple_case() {
  Case c;
  c.campaign.id = "2026-11-03-rossi-fp12";
  c.campaign.customer = "Officine Rossi S.r.l.";
  c.campaign.site = "Torino";
  c.campaign.operator_name = "M. Bianchi";
  c.campaign.date = "2026-11-03";
  c.campaign.machine = {"Fonderie Po", "FP 12", "0417", "", "", "gantry", "siemens-840d", {}};
  c.campaign.instrument.maker = "Lasertec";
  c.campaign.instrument.model = "LX 80";
  c.campaign.instrument.serial = "55821";
  c.campaign.instrument.calibrated = "2026-02-01";
  c.campaign.instrument.certificate = "LAT 123 / 2026-045";
  c.campaign.instrument.U_fixed = 0.2e-6;
  c.campaign.instrument.U_per_length = 0.5e-6;
  c.campaign.instrument.U_angle = 1e-6;
  return c;
}

/// Compares a result with a limit, as the host does.
inline void decide(Case& c, const std::string& plugin, const std::string& name, double tolerance,
                   Decision decision, const std::string& reason = "") {
  c.results.conformity.push_back({c.campaign.measurements.front().id,
                                  c.campaign.measurements.front().axis, plugin, name, tolerance,
                                  Quantity::deviation, decision, reason});
}

}  // namespace nonio::fixtures
