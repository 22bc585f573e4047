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

/// Types and functions that the checks of all kinds of plugins share. Checks run in a child
/// process, so that a plugin that crashes or hangs does not end the program.
namespace nonio::plugin_check::kit {

/// A campaign as its folder contains it: the text of campaign.toml and the bytes of the other
/// files.
struct Source {
  std::string name, manifest;
  std::vector<Artifact> files;
};

/// A campaign that was read from a `Source`.
struct Sample {
  std::string name;
  Campaign campaign;
  config::RawOptions options;
  std::vector<Observations> observations;
  /// Results of the program's own plugins; none: not evaluated yet.
  std::optional<Results> results{};

  const Observations& of(const Measurement& m) const {
    return observations[static_cast<std::size_t>(&m - campaign.measurements.data())];
  }
};

/// Makes campaigns with every kind of measurement, whose errors are random numbers of this seed.
std::vector<Source> made_sources(std::uint64_t seed);
/// Returns the method of a measurement; null if `methods` does not contain it.
const Method* method_of(const Measurement& m, const std::vector<Method>& methods);
/// Reads a source; each file is read by the reader that its measurement names, otherwise the first
/// that recognizes it, otherwise one for the columns of its method. Axes without a stated
/// compensation are treated as uncompensated, because controllers require a statement. An error
/// names the sample and the file.
Expected<Sample> open_source(const Source& source, const std::vector<Reader>& readers,
                             const std::vector<Method>& methods);

/// The inputs of every check: a seed, samples, templates, and the plugins that read and evaluate
/// samples.
struct Bench {
  std::uint64_t seed = 1;
  std::vector<Source> sources;
  std::vector<Sample> samples;  ///< samples of all sources that could be read
  std::vector<Method> methods;  ///< methods of the plugin file, followed by those of the program
  std::vector<Reader> readers;
  std::vector<Effect> effects;
  std::vector<Analysis> analyses;
  Templates templates;
  reading::Context context;  ///< context with which models are fitted; it contains no site
  /// Called when everything is ready and only the plugin remains to be called; the check `pure`
  /// then changes the environment.
  std::function<void()> only_plugin{};
  /// receives the name of each step before it is tried, to report it after a crash
  reading::Stage stage;

  storage::Random random(std::uint64_t stream) const { return {seed, stream}; }
};

struct Verdict {
  enum class State { passed, failed, skipped } state = State::passed;
  std::string says{};
};
inline Verdict passed() { return {}; }
inline Verdict failed(std::string says) { return {Verdict::State::failed, std::move(says)}; }
/// Returns text that contains every bit of a number, for exact comparison.
inline std::string exact_text(double x) { return std::to_string(std::bit_cast<std::uint64_t>(x)); }
inline Verdict skipped(std::string says) { return {Verdict::State::skipped, std::move(says)}; }

template <class Plugin>
struct Check {
  const char* name;
  const char* law;  ///< sentence about what the check tests, for --help
  std::function<Verdict(const Plugin&, const Bench&)> run;
};

const std::vector<Check<Info>>& info_checks();
const std::vector<Check<Method>>& method_checks();
const std::vector<Check<Reader>>& reader_checks();
const std::vector<Check<Effect>>& effect_checks();
const std::vector<Check<Analysis>>& analysis_checks();
const std::vector<Check<Output>>& output_checks();
const std::vector<Check<Controller>>& controller_checks();
/// Returns the checks of written files, which controllers share with outputs.
std::vector<Check<Controller>> controller_checks_of_files();

/// Returns what is wrong with the declaration of an option; empty if it is correct. If
/// `may_be_absent`, an empty default means that the key is not written.
std::string wrong_option(const Option& option, bool may_be_absent);

/// Returns a passed verdict with a digest of what a plugin computes for all samples, or a skipped
/// one with the reason why there is no digest. Calls `Bench::only_plugin` before the plugin.
Verdict fingerprint(const Method& method, const Bench& bench);
Verdict fingerprint(const Reader& reader, const Bench& bench);
Verdict fingerprint(const Effect& effect, const Bench& bench);
Verdict fingerprint(const Analysis& analysis, const Bench& bench);
Verdict fingerprint(const Output& output, const Bench& bench);
Verdict fingerprint(const Controller& controller, const Bench& bench);

/// Returns the message of `check` about readings, results or files; empty if they are sound.
template <class What>
std::string unsound(const What& what) {
  const auto sound = check(what);
  return sound ? std::string() : sound.error().message;
}
/// Returns the row numbers 0 to n - 1 in random order.
std::vector<std::uint32_t> shuffled(std::size_t n, storage::Random& random);
/// Returns variants of `o` with unusual readings, each with its name: none, one, one target, one
/// direction, positions only, huge positions, missing times and temperatures.
std::vector<std::pair<std::string, Observations>> odd_tables(const Observations& o);
/// Returns the plugin's default options, overridden by those that the sample states.
Settings settings_for(const Info& info, const Sample& sample);
Settings settings_for(const Output& output, const Sample& sample);
/// Returns the options of a controller for a sample, including the numbers of the axes in order and
/// encoder counts, which some controllers require.
Settings settings_for(const Controller& controller, const Sample& sample);
/// Returns all results of the analyses and the model for a sample; computes them unless the sample
/// contains them.
Results results_of(const Sample& sample, const Bench& bench);

}  // namespace nonio::plugin_check::kit
