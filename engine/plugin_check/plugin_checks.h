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

/// Types and functions for the checks of all kinds of plugins. Checks run in a child process, so
/// that a plugin that crashes or hangs does not end the program.
namespace nonio::plugin_check::kit {

/// The files of a campaign folder: the text of campaign.toml and the bytes of the other files.
struct Source {
  std::string name, manifest;
  std::vector<Artifact> files;
};

struct Sample {
  std::string name;
  Campaign campaign;
  config::RawOptions options;
  std::vector<Observations> observations;
  /// Results of the program's own plugins; std::nullopt if the sample was not evaluated yet.
  std::optional<Results> results{};

  const Observations& of(const Measurement& m) const {
    return observations[static_cast<std::size_t>(&m - campaign.measurements.data())];
  }
};

/// Generates campaigns with every kind of measurement; `seed` determines their errors.
std::vector<Source> made_sources(std::uint64_t seed);
/// Returns null if `methods` does not contain the method.
const Method* method_of(const Measurement& m, const std::vector<Method>& methods);
/// Each file is read by the reader that its measurement names, otherwise by the first that
/// recognizes it, otherwise by one for the columns of its method. Axes without a stated
/// compensation are treated as uncompensated, because controllers require a statement. An error
/// names the sample and the file.
Expected<Sample> open_source(const Source& source, const std::vector<Reader>& readers,
                             const std::vector<Method>& methods);

struct Bench {
  std::uint64_t seed = 1;
  std::vector<Source> sources;
  std::vector<Sample> samples;  ///< samples of all sources that could be read
  std::vector<Method> methods;
  std::vector<Reader> readers;
  std::vector<Effect> effects;
  std::vector<Analysis> analyses;
  Templates templates;
  reading::Context context;  ///< context of model fits; it contains no site
  /// Called immediately before the plugin is called, so that the check `pure` can change the
  /// environment.
  std::function<void()> only_plugin{};
  /// Receives the name of each step in advance, for the report after a crash.
  reading::Stage stage;

  storage::Random random(std::uint64_t stream) const { return {seed, stream}; }
};

struct Verdict {
  enum class State { passed, failed, skipped } state = State::passed;
  std::string says{};
};
inline Verdict passed() { return {}; }
inline Verdict failed(std::string says) { return {Verdict::State::failed, std::move(says)}; }
/// The text contains every bit of the number, for exact comparison.
inline std::string exact_text(double x) { return std::to_string(std::bit_cast<std::uint64_t>(x)); }
inline Verdict skipped(std::string says) { return {Verdict::State::skipped, std::move(says)}; }

template <class Plugin>
struct Check {
  const char* name;
  const char* law;  ///< property that the check tests, a sentence for --help
  std::function<Verdict(const Plugin&, const Bench&)> run;
};

const std::vector<Check<Info>>& info_checks();
const std::vector<Check<Method>>& method_checks();
const std::vector<Check<Reader>>& reader_checks();
const std::vector<Check<Effect>>& effect_checks();
const std::vector<Check<Analysis>>& analysis_checks();
const std::vector<Check<Output>>& output_checks();
const std::vector<Check<Controller>>& controller_checks();
/// Checks of written files, which controllers and outputs have in common.
std::vector<Check<Controller>> controller_checks_of_files();

/// Returns what is wrong with the declaration of an option; empty if it is correct. With
/// `may_be_absent`, an empty default means that the key is not written.
std::string wrong_option(const Option& option, bool may_be_absent);

/// Returns a passed verdict with a digest of the plugin's results for all samples, or a skipped one
/// with a reason. Calls `Bench::only_plugin` before the plugin.
Verdict fingerprint(const Method& method, const Bench& bench);
Verdict fingerprint(const Reader& reader, const Bench& bench);
Verdict fingerprint(const Effect& effect, const Bench& bench);
Verdict fingerprint(const Analysis& analysis, const Bench& bench);
Verdict fingerprint(const Output& output, const Bench& bench);
Verdict fingerprint(const Controller& controller, const Bench& bench);

template <class What>
std::string unsound(const What& what) {
  const auto sound = check(what);
  return sound ? std::string() : sound.error().message;
}
std::vector<std::uint32_t> shuffled(std::size_t n, storage::Random& random);
/// Returns named variants of `o` with unusual readings: none, one, one target, one direction,
/// positions only, huge positions, missing times and temperatures.
std::vector<std::pair<std::string, Observations>> odd_tables(const Observations& o);
/// The plugin's default options, replaced by those that the sample states.
Settings settings_for(const Info& info, const Sample& sample);
Settings settings_for(const Output& output, const Sample& sample);
/// The settings also state numbers of the axes and encoder counts, which some controllers require.
Settings settings_for(const Controller& controller, const Sample& sample);
/// Returns the results of all analyses and models; computes them unless the sample contains them.
Results results_of(const Sample& sample, const Bench& bench);

}  // namespace nonio::plugin_check::kit
