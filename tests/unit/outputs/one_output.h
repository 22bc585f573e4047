// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <gtest/gtest.h>

#include <string>
#include <utility>
#include <vector>

#include "nonio/sdk/plugin.h"

extern "C" const nonio::PluginEntry nonio_plugin;

namespace nonio {

/// The one output of the plugin that is linked into this program.
inline Output the_output() {
  struct Taker final : Registry {
    Output output;
    void add(Method) override { ADD_FAILURE() << "a method"; }
    void add(Reader) override { ADD_FAILURE() << "a reader"; }
    void add(Effect) override { ADD_FAILURE() << "an effect"; }
    void add(Analysis) override { ADD_FAILURE() << "an analysis"; }
    void add(Output o) override { output = std::move(o); }
    void add(Controller) override { ADD_FAILURE() << "a controller"; }
  } taker;
  nonio_plugin.add_to(taker);
  return taker.output;
}

inline Expected<OutputResult> written(const Campaign& campaign,
                                      const std::vector<Observations>& observations,
                                      const Results& results, const Settings& options = {}) {
  const Templates templates;
  return the_output().write({campaign, observations, results, options, templates});
}

}  // namespace nonio
