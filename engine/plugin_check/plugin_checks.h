// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <bit>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "campaign/evaluation/evaluate.h"
#include "campaign/loader/plugins.h"
#include "nonio/sdk/check.h"
#include "nonio/sdk/plugin.h"
#include "platform/storage/random.h"

/// What the checks of all kinds of plugins share. They run in a child process, so that a plugin may
/// crash or hang there.
namespace nonio::plugin_check::kit {

/// A campaign as it is stored in a folder.
struct Source {
  std::string name, manifest;
  std::vector<Artifact> files;
};

/// The same, read.
struct Sample {
  std::string name;
  Campaign campaign;
  config::RawOptions options;
  std::vector<Observations> observations;
  std::optional<Results> results{};  ///< of the program's own plugins, where they are known

  const Observations& of(const Measurement& m) const {
    return observations[static_cast<std::size_t>(&m - campaign.measurements.data())];
  }
};

/// Campaigns of every kind of measurement, made up by the seed.
std::vector<Source> made_sources(std::uint64_t seed);
/// The method of a measurement; null if it is not among them.
const Method* method_of(const Measurement& m, const std::vector<Method>& methods);
/// With the first reader that knows each file; an error that names the sample and the file.
Expected<Sample> open_source(const Source& source, const std::vector<Reader>& readers,
                             const std::vector<Method>& methods);

/// Where a check takes everything from.
struct Bench {
  std::uint64_t seed = 1;
  std::vector<Source> sources;
  std::vector<Sample> samples;  ///< of all sources that could be read
  std::vector<Method> methods;  ///< the file's own, then the program's
  std::vector<Reader> readers;
  std::vector<Effect> effects;
  std::vector<Analysis> analyses;
  Templates templates;
  reading::Context context;  ///< for the model: without a site
  /// What `pure` does once everything is ready and only the plugin is still to be called.
  std::function<void()> only_plugin{};
  reading::Stage stage;  ///< called with what is tried next, for the case that it does not return

  storage::Random random(std::uint64_t stream) const { return {seed, stream}; }
};

struct Verdict {
  enum class State { passed, failed, skipped } state = State::passed;
  std::string says{};
};
inline Verdict passed() { return {}; }
inline Verdict failed(std::string says) { return {Verdict::State::failed, std::move(says)}; }
/// All of a number, for comparing.
inline std::string exact_text(double x) { return std::to_string(std::bit_cast<std::uint64_t>(x)); }
inline Verdict skipped(std::string says) { return {Verdict::State::skipped, std::move(says)}; }

template <class Plugin>
struct Check {
  const char* name;
  const char* law;  ///< one sentence, for --help
  std::function<Verdict(const Plugin&, const Bench&)> run;
};

const std::vector<Check<Info>>& info_checks();
const std::vector<Check<Method>>& method_checks();
const std::vector<Check<Reader>>& reader_checks();
const std::vector<Check<Effect>>& effect_checks();
const std::vector<Check<Analysis>>& analysis_checks();
const std::vector<Check<Output>>& output_checks();
const std::vector<Check<Controller>>& controller_checks();
/// The laws that controllers share with outputs.
std::vector<Check<Controller>> controller_checks_of_files();

/// What is wrong with an option; empty if nothing. `may_be_absent`: an empty default stands for a
/// key that is not written.
std::string wrong_option(const Option& option, bool may_be_absent);

/// What a plugin makes of all samples, digested; an error states why there is nothing. Calls
/// `Bench::only_plugin` before the plugin.
Verdict fingerprint(const Method& method, const Bench& bench);
Verdict fingerprint(const Reader& reader, const Bench& bench);
Verdict fingerprint(const Effect& effect, const Bench& bench);
Verdict fingerprint(const Analysis& analysis, const Bench& bench);
Verdict fingerprint(const Output& output, const Bench& bench);
Verdict fingerprint(const Controller& controller, const Bench& bench);

/// Message of `check` about readings, results or files; empty if nothing.
template <class What>
std::string unsound(const What& what) {
  const auto sound = check(what);
  return sound ? std::string() : sound.error().message;
}
/// A rearrangement of n rows.
std::vector<std::uint32_t> shuffled(std::size_t n, storage::Random& random);
/// Readings that are not acceptable.
std::vector<std::pair<std::string, Observations>> odd_tables(const Observations& o);
/// The plugin's defaults, and the settings of the sample.
Settings settings_for(const Info& info, const Sample& sample);
Settings settings_for(const Output& output, const Sample& sample);
/// In addition to these, the numbers of the axes by their order.
Settings settings_for(const Controller& controller, const Sample& sample);
/// All results of the analyses and the model for a sample: kept ones, else they are computed.
Results results_of(const Sample& sample, const Bench& bench);

}  // namespace nonio::plugin_check::kit
