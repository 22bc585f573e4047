// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace CLI {
class App;
}

namespace nonio::app {

/// `nonio simulate SPEC --out CAMPAIGN`
class SimulateVerb {
 public:
  CLI::App* add_to(CLI::App& cli);
  int run(const std::vector<std::filesystem::path>& plugin_folders, bool json, bool quiet) const;

 private:
  std::string specification_, out_, truth_;
};

}  // namespace nonio::app
