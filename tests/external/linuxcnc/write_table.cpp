// SPDX-License-Identifier: Apache-2.0
//
// write_table PLUGIN TYPE < targets > table
// Lines "target_mm deviation+_um deviation-_um" in; what the plugin writes for such an axis out.
#include <dlfcn.h>

#include <fstream>
#include <iostream>
#include <string>

#include "nonio/sdk/plugin.h"

namespace {

struct OneController final : nonio::Registry {
  nonio::Controller controller;
  void add(nonio::Method) override {}
  void add(nonio::Reader) override {}
  void add(nonio::Effect) override {}
  void add(nonio::Analysis) override {}
  void add(nonio::Output) override {}
  void add(nonio::Controller c) override {
    if (c.info.name == "linuxcnc") controller = std::move(c);
  }
};

nonio::Observations measured(std::istream& in) {
  nonio::Observations o;
  o.measurement = "X";
  o.axes.push_back({"X", false, {}, {}});
  double target = 0.0, plus = 0.0, minus = 0.0;
  const auto add = [&](double deviation, int direction) {
    o.axes[0].position.push_back(target * 1e-3);
    o.axes[0].approach.push_back(static_cast<std::int8_t>(direction));
    o.deviation.push_back(deviation * 1e-6);
    o.run.push_back(1);
  };
  while (in >> target >> plus >> minus) {
    add(plus, +1);
    add(minus, -1);
  }
  return o;
}

int complain(const std::string& words) {
  std::cerr << "write_table: " << words << '\n';
  return 1;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 3) return complain("wanted PLUGIN TYPE");
  void* library = dlopen(argv[1], RTLD_NOW);
  if (library == nullptr) return complain(dlerror());
  const auto* entry = static_cast<const nonio::PluginEntry*>(dlsym(library, "nonio_plugin"));
  if (entry == nullptr) return complain(dlerror());
  OneController registry;
  entry->add_to(registry);

  nonio::Campaign campaign;
  nonio::Axis axis;
  axis.name = "X";
  axis.active_table = "", axis.active_backlash = 0.0;  // none, as stated
  campaign.machine.axes.push_back(axis);
  nonio::Measurement measurement;
  measurement.id = measurement.axis = "X";
  measurement.kind = "axis";
  campaign.measurements.push_back(measurement);
  nonio::Settings options;
  for (const auto& o : registry.controller.info.options) options.values[o.name] = o.default_value;
  options.values["type"] = std::int64_t{std::string(argv[2]) == "1" ? 1 : 0};
  const std::vector<nonio::Observations> observations{measured(std::cin)};
  const auto result = registry.controller.write({campaign, observations, {}, options});
  if (!result) return complain(result.error().message);
  for (const auto& artifact : result->artifacts)
    if (artifact.name == "linuxcnc-X.comp") {
      std::cout << artifact.bytes;
      return 0;
    }
  return complain("the plugin wrote no linuxcnc-X.comp");
}
