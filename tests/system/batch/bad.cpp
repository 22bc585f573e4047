// SPDX-License-Identifier: Apache-2.0
// An analysis, an output and a reader that misbehave in the way that the option `how` names.
#include <chrono>
#include <csignal>
#include <cstdlib>
#include <limits>
#include <stdexcept>
#include <thread>
#include <vector>

#include "nonio/sdk/plugin.h"

namespace {

using namespace nonio;

void leak() {
  for (std::vector<char*> kept; kept.size() < 10'000;) {  // 10 GB
    auto* block = new char[1'000'000];
    for (int i = 0; i < 1'000'000; i += 4096) block[i] = 1;
    kept.push_back(block);
  }
}

void misbehave(const std::string& how) {
  if (how == "segfault") std::raise(SIGSEGV);
  if (how == "abort") std::abort();
  if (how == "exit") std::_Exit(0);
  if (how == "loop")
    for (volatile bool on = true; on;) std::this_thread::sleep_for(std::chrono::milliseconds(10));
  if (how == "throw") throw std::runtime_error("thrown on purpose");
  if (how == "throw-int") throw 7;
  if (how == "leak") leak();
}

Expected<Evaluation> analyse(const AnalysisInput& in) {
  const std::string how = in.options.text("how");
  misbehave(how);
  Evaluation e;
  if (how == "nan")
    e.values.push_back({"A", std::numeric_limits<double>::quiet_NaN(), Quantity::deviation});
  if (how == "error") return fail("an error on purpose");
  return e;
}

Expected<OutputResult> write(const OutputInput& in) {
  const std::string how = in.options.text("how");
  misbehave(how);
  OutputResult result;
  if (how == "escape") result.artifacts.push_back({"../escaped.txt", "x"});
  if (how == "absolute") result.artifacts.push_back({"/tmp/escaped.txt", "x"});
  if (how == "overwrite") result.artifacts.push_back({"results.json", "x"});
  if (how == "twice") result.artifacts = {{"a.txt", "1"}, {"a.txt", "2"}};
  return result;
}

/// Two readings of an axis, and what a reader may get wrong that others index by or divide by.
Expected<Observations> read(const ReadInput& in) {
  const std::string how = in.options.text("how");
  Observations o;
  o.measurement = in.measurement.id;
  o.axes = {{in.measurement.axis, false, {0.0, 0.1}, {1, 1}}};
  o.lines = {{in.measurement.id, {1.0, 0.0, 0.0}}};
  o.deviation = {0.0, 1e-6};
  o.run = {1, 1};
  if (how == "line") o.line = {0, 4000000};
  if (how == "no-lines") o.lines.clear();
  if (how == "u-zero") o.u = {1e-6, 0.0};
  if (how == "u-nan") o.u = {1e-6, std::numeric_limits<double>::quiet_NaN()};
  if (how == "approach") o.axes.front().approach = {1, 7};
  if (how == "sense") o.lines.front().sense[0] = std::numeric_limits<double>::infinity();
  return o;
}

/// Misbehaves when it is asked, in a campaign "<kind>-asked-<how>".
bool asked(const Campaign& campaign, const std::string& kind) {
  const std::string prefix = kind + "-asked-";
  if (campaign.id.starts_with(prefix)) misbehave(campaign.id.substr(prefix.size()));
  return true;
}

bool recognises(std::string_view head) {
  const std::string_view asked_to = "# asked to ";
  if (head.starts_with(asked_to))
    misbehave(std::string(head.substr(asked_to.size(), head.find('\n') - asked_to.size())));
  return false;
}

const std::vector<Option> options = {{"how", std::string("well"), "", "What to do wrong"}};

}  // namespace

NONIO_PLUGIN(registry) {
  registry.add(Reader{{"bad-reader", "1", "Misreads", options},
                      recognises,
                      [](std::string_view kind) { return kind == "axis"; },
                      read});
  registry.add(Analysis{{"bad-analysis", "1", "Misbehaves", options},
                        [](const Campaign& c, const Measurement&) { return asked(c, "analysis"); },
                        analyse});
  registry.add(Output{{"bad-output", "1", "Misbehaves", options},
                      [](const Campaign& c) { return asked(c, "output"); },
                      write,
                      nullptr});
}
