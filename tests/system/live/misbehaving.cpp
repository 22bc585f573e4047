// SPDX-License-Identifier: Apache-2.0
// An effect that crashes, or never ends, as soon as it is fitted.
#include <chrono>
#include <csignal>
#include <thread>

#include "nonio/sdk/plugin.h"

namespace {

using namespace nonio;

bool applies(const Observations& o, const Axis& axis) { return o.axis(axis.name) != nullptr; }

Expected<Effect::Columns> misbehave(const Observations&, const Axis&, const std::vector<double>&) {
#ifdef NONIO_TEST_HANGS
  for (volatile bool on = true; on;) std::this_thread::sleep_for(std::chrono::milliseconds(10));
#else
  std::raise(SIGSEGV);
#endif
  return Effect::Columns{};
}

}  // namespace

NONIO_PLUGIN(registry) {
#ifdef NONIO_TEST_HANGS
  const char* const name = "hanging";
#else
  const char* const name = "crashing";
#endif
  registry.add(Effect{.info = {name, "1.0.0", "Misbehaves"},
                      .linear = {{"m", "m", Quantity::deviation, Quantity::angular_deviation}},
                      .shapes = {},
                      .applies = applies,
                      .columns = misbehave});
}
