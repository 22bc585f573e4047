// SPDX-License-Identifier: Apache-2.0
// An effect that crashes, or never ends, as soon as it is fitted; a reader that never ends.
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

#ifdef NONIO_TEST_HANGS
bool is_own(std::string_view head) { return head.starts_with("HANGS"); }
bool reads_axis(std::string_view kind) { return kind == "axis"; }
Expected<Observations> never_read(const ReadInput&) {
  for (volatile bool on = true; on;) std::this_thread::sleep_for(std::chrono::milliseconds(10));
  return Observations{};
}
#endif

}  // namespace

NONIO_PLUGIN(registry) {
#ifdef NONIO_TEST_HANGS
  const char* const name = "hanging";
  Reader reader;
  reader.info = {"hanging-reader", "1.0.0", "Never ends"};
  reader.recognises = is_own;
  reader.reads = reads_axis;
  reader.read = never_read;
  registry.add(std::move(reader));
#else
  const char* const name = "crashing";
#endif
  registry.add(Effect{.info = {name, "1.0.0", "Misbehaves"},
                      .linear = {{"m", "m", Quantity::deviation, Quantity::angular_deviation}},
                      .shapes = {},
                      .applies = applies,
                      .columns = misbehave});
}
