// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "nonio/sdk/campaign.h"
#include "nonio/sdk/control.h"
#include "nonio/sdk/error.h"
#include "nonio/sdk/observations.h"
#include "nonio/sdk/results.h"
#include "nonio/sdk/settings.h"
#include "nonio/sdk/templates.h"
#include "nonio/sdk/units.h"

/// A plugin is a shared library with one exported symbol. It registers objects of the six types
/// below, whose functions are pure: they depend only on their arguments. Only the host uses disk,
/// clock, log, locale, threads, processes and configuration.
///
///     NONIO_PLUGIN(registry) { registry.add(nonio::Analysis{...}); }
namespace nonio {

struct HistorySoFar;

/// An option of a plugin, or a key that a method adds to [[measurement]]. The host checks type,
/// range and choices, and sets the default.
struct Option {
  std::string name;
  Setting default_value;  ///< value if the option is not stated; determines the type of the option
  std::string unit;
  std::string help;                    ///< one sentence
  std::vector<std::string> choices{};  ///< allowed values; any value if empty
  /// Allowed range of a number, ends included. For a text that a method declares, `max` limits its
  /// length in bytes.
  std::optional<double> min{}, max{};

  // For keys that a method declares: whether the key must be stated.
  bool required = false;
  /// Message if the key is missing, such as "the plane of the circle, \"XY\"".
  std::string missing{};
  std::string expected{};   ///< message if the value is invalid: "expected a length above 0"
  std::string forbidden{};  ///< characters that a text must not contain
};

inline Option one_of(std::vector<std::string> choices, Option o) {
  o.choices = std::move(choices);
  return o;
}
inline Option at_least(double min, Option o) {
  o.min = min;
  return o;
}
inline Option within(double min, double max, Option o) {
  o.max = max;
  return at_least(min, std::move(o));
}

struct Info {
  std::string name;
  std::string version;
  std::string summary;  ///< one sentence, for `nonio plugin list`
  std::vector<Option> options{};
  /// For an analysis or output: whether it runs only if `[run]` lists it or the campaign contains
  /// the table `[options.<name>]`.
  bool opt_in = false;
};

struct Method;

struct ReadInput {
  std::string_view bytes;
  const Campaign& campaign;
  const Measurement& measurement;
  const Settings& options;
  /// Optional. To be called with the offset before which the bytes are no longer needed, so that a
  /// file of a gigabyte is not in memory together with its readings.
  std::function<void(std::size_t)> done_with{};
  /// The method of the measurement; null if no plugin with this method is loaded.
  const Method* method = nullptr;
};

/// Converts a file to observations.
struct Reader {
  Info info;
  /// Whether the first bytes of a file match the format.
  bool (*recognises)(std::string_view head) = nullptr;
  bool (*reads)(std::string_view measurement_kind) = nullptr;
  Expected<Observations> (*read)(const ReadInput&) = nullptr;
  /// Whether the reader also reads the columns that a method declares (`ReadInput::method`), for
  /// any kind.
  bool reads_columns = false;
  /// Optional: returns at most `most` rows of a table as text, starting with the column names, for
  /// a person who assigns the columns (option `columns`).
  Expected<std::vector<std::vector<std::string>>> (*first_rows)(std::string_view bytes,
                                                                std::size_t most) = nullptr;
};

/// The readings of a file in the columns that a method declares. Values are SI, and NaN if a field
/// is blank. A direction is +1 or -1, or 0 if it is blank.
struct Readings {
  /// Keys are `Method::Column::name`.
  std::map<std::string, std::vector<double>, std::less<>> columns;
  std::vector<std::uint32_t> source_line;  ///< line of the file for each reading, 1-based

  std::size_t size() const { return source_line.size(); }
  const std::vector<double>* column(std::string_view name) const {
    const auto found = columns.find(name);
    return found == columns.end() ? nullptr : &found->second;
  }
};

struct MethodInput {
  const Campaign& campaign;
  const Measurement& measurement;
  const Readings& readings;
};

struct SimulationInput {
  const Campaign& campaign;
  const Measurement& measurement;
  /// Observations that `observe` must return for the simulated readings.
  const Observations& observations;
};

/// A measuring method: its keys of [[measurement]], the columns of its files, and the conversion of
/// readings to observations. The functions in sdk/method.h apply it.
struct Method {
  struct Column {
    /// Use of the column in observations if the method has no function `observe`.
    enum class Role {
      none,      ///< only for the method's own `observe`
      position,  ///< commanded position of the measurement's axis
      deviation,
      run,        ///< an integer from 1
      direction,  ///< direction of approach, + or -
      time,
      material,
      air,
      pressure,
      humidity,
    };
    std::string name;  ///< without unit: `target` of quantity length is `target_mm` in a file
    Quantity quantity = Quantity::number;
    Role role = Role::none;
    std::string help;
    bool required = true;  ///< if false, the column may be missing and its fields may be blank
  };
  /// `name` is the `kind` of [[measurement]]. `options` are the keys that the method adds to the
  /// common ones. The host copies the keys `axis`, `lateral`, `from` and `to` to the members of
  /// `Measurement` with these names.
  Info info;
  /// Optional: the kind of measurement, such as "axis", to which the observations are equivalent,
  /// so that all analyses, checks, tables and histories of that kind apply.
  std::string observed_as{};
  /// For a method whose `observed_as` is empty.
  Measurement::Motion motion = Measurement::Motion::targets;
  /// If empty, the files are read by readers for this method.
  std::vector<Column> columns{};
  /// Optional: converts readings to observations. Without it, the roles of the columns determine
  /// the observations (`observe` in sdk/method.h).
  Expected<Observations> (*observe)(const MethodInput&) = nullptr;
  /// Required with `observe`: the inverse conversion, for `nonio simulate` and `nonio plugin
  /// check`.
  Expected<Readings> (*simulate)(const SimulationInput&) = nullptr;
};

/// Reason why an effect is no candidate for these readings, with the readings that cause it. The
/// text is "unseen.<id>"; `id` is empty if the effect does not concern this axis.
struct WhyNot {
  std::string id;
  std::vector<std::uint32_t> rows{};
};

/// A physical cause of deviations, with one column for each linear parameter. Rows in which the
/// axis did not move are 0 (`readings_of` in sdk/axis_readings.h returns the inputs of a column).
struct Effect {
  using Columns = std::vector<std::vector<double>>;
  struct Parameter {
    std::string name;
    std::string help;
    Quantity quantity = Quantity::number;
    Quantity rotary = quantity;
  };
  /// A nonlinear parameter that is searched: a period, a time constant, an instant, a number of
  /// knots.
  struct Shape {
    Parameter parameter;
    /// Returns the values to be tested, ascending, SI: one value if it is known (a period in the
    /// manifest), no value if the readings do not identify the parameter.
    std::function<std::vector<double>(const Observations&, const Axis&)> grid;
    bool continuous = true;  ///< whether the best value may be between grid values
    /// Default value, such as a fixed point in the middle of the measured range. Unlike other grid
    /// values, it requires no evidence from the readings.
    std::optional<double> usual{};
  };
  Info info;                      ///< name: the kind without the axis, such as "backlash"
  std::vector<Parameter> linear;  ///< for a curve: one parameter for all columns
  std::vector<Shape> shapes;
  /// Whether the effect is a smooth curve; its first shape is then the number of columns.
  bool curve = false;
  bool compensable = false;  ///< whether a table of the control can compensate it
  /// Effect for the same error in the frame of a part that was turned on the table, if there is one.
  std::string of_part{};
  std::function<bool(const Observations&, const Axis&)> applies;
  /// Returns columns with one entry per reading, in the unit of the deviation divided by that of
  /// the parameter.
  std::function<Expected<Columns>(const Observations&, const Axis&,
                                  const std::vector<double>& shape)>
      columns;
  /// For an effect in space: returns the possible instances in these readings, such as "EYX"
  /// (straightness), "XY" (squareness) or a line. The Axis passed to the other functions then
  /// contains only this name, and the columns are the sensed deviation (`Observations::sense_of`).
  /// Without this function, the effect exists once per axis, its columns are the error along the
  /// axis, and the engine computes the component along the direction of sensing.
  std::function<std::vector<std::string>(const Observations&)> instances{};
  /// Whether the effect is an unknown of the setup, such as the orientation of a mirror. It is part
  /// of every model to which it applies, and never a candidate.
  bool is_nuisance = false;
  /// Whether the effect is a curve that describes the residual without a cause ("a reversal for
  /// each target"). It is never a candidate, but is offered if no effect explains the residual. In
  /// a model with other effects it describes only the remainder.
  bool description = false;
  /// Whether its instances are recorded channels (`Observations::channels`). It is the only kind of
  /// effect in displacements over time, and is also used in axis tests with recorded channels.
  bool of_channels = false;
  /// Optional: the reason why the effect is no candidate for these readings.
  std::function<WhyNot(const Observations&, const Axis&)> why_not{};
};

struct AnalysisInput {
  const Campaign& campaign;
  const Measurement& measurement;
  const Observations& observations;
  const Settings& options;
  /// One entry for each measurement, in the order of the manifest; empty if its file could not be
  /// read. The analysis lists the ids of other measurements that it uses in Evaluation::uses.
  const std::vector<Observations>* all = nullptr;
  /// Table format of the machine's control; null if its plugin is not loaded.
  const ControlTable* control = nullptr;
};

struct CampaignInput {
  const Campaign& campaign;
  /// One entry for each measurement, in the order of the manifest; empty if its file could not be
  /// read.
  const std::vector<Observations>& observations;
  const Settings& options;
};

struct Analysis {
  Info info;
  bool (*applies)(const Campaign&, const Measurement&) = nullptr;
  Expected<Evaluation> (*analyse)(const AnalysisInput&) = nullptr;
  /// Replaces `applies` and `analyse`: called once for the whole campaign (a plan needs no
  /// measurement).
  Expected<Evaluation> (*analyse_campaign)(const CampaignInput&) = nullptr;
  /// Whether the analysis states which values the history follows (`Value::followed`). Otherwise
  /// the history follows each value whose uncertainty is in the budget, as "<plugin>:<value>" of
  /// the measurement's axis.
  bool states_followed = false;
};

struct OutputInput {
  const Campaign& campaign;
  /// One entry for each measurement, in the order of the manifest; empty if its file could not be
  /// read.
  const std::vector<Observations>& observations;
  const Results& results;
  const Settings& options;
  const Templates& templates;
  const Issue* issue = nullptr;  ///< for a certificate; null while missing requirements are checked
  /// The history of the machine (sdk/history.h), if `Output::wants_history` returns true; null
  /// while it is not yet computed.
  const HistorySoFar* history = nullptr;
};

/// Writes documents from results. Runs after the tables of all controllers are written, whose
/// predictions are in `results.outputs`.
struct Output {
  /// Requirements of a document that is issued under a number and does not change afterwards.
  struct Certificate {
    /// Returns the keys of all missing data. If nothing is missing, `write` is called for a draft
    /// (Issue::is_draft), and every page of its PDF must state that it is a draft. After a person
    /// has approved it, the host assigns a number and calls `write` again; the same data are never
    /// issued twice.
    std::vector<std::string> (*missing_requirements)(const OutputInput&) = nullptr;
  };
  /// Purpose by which the program finds the output for a document of this kind.
  enum class Role { other, report, model_page, sheet_of_stops };
  Info info;
  bool (*applies)(const Campaign&) = nullptr;
  Expected<OutputResult> (*write)(const OutputInput&) = nullptr;
  /// Optional: called once per run, before any campaign, to load what all documents have in common
  /// (fonts). It must not change the result of `write`.
  void (*prepare)(const Templates&) = nullptr;
  /// Optional: errors in the templates and words that this output uses.
  std::vector<Error> (*check_templates)(const Templates&) = nullptr;
  /// std::nullopt if the document is not issued under a number.
  std::optional<Certificate> certificate{};
  /// Optional: whether the document contains the machine's history with these options; it is then
  /// written again when the history changes.
  bool (*wants_history)(const Settings&) = nullptr;
  Role role = Role::other;
};

struct ControllerInput {
  const Campaign& campaign;
  /// One entry for each measurement, in the order of the manifest; empty if its file could not be
  /// read.
  const std::vector<Observations>& observations;
  const Results& results;
  const Settings& options;
  /// The measured readings, if `observations` contains the predictions of the campaign's model
  /// instead (manifest, compensate = "model"); otherwise null.
  const std::vector<Observations>* measured = nullptr;
};

/// Writes and parses the tables of one control. `[run] outputs` lists it among the outputs, so no
/// output may have the same name.
struct Controller {
  /// If there is an option `axes` of tables, the host adds the known values of each axis of the
  /// machine: number, reference_mm, from_mm, to_mm, resolution_um, largest_um, slope_um_per_m, and
  /// the same for rotary axes (_deg, _arcsec, slope_arcsec_per_deg).
  Info info;
  ControlTable table;
  bool (*applies)(const Campaign&) = nullptr;
  Expected<OutputResult> (*write)(const ControllerInput&) = nullptr;
  /// Returns the tables in these files as the control applies them.
  Expected<std::vector<LoadedTable>> (*parse)(const TableInput&) = nullptr;
  /// Optional: replaces the present table of this axis in the files of the backup, keeps all other
  /// bytes, and returns only files that changed. Error: the replacement would change another axis.
  Expected<std::vector<Artifact>> (*merge)(const MergeInput&) = nullptr;
};

class Registry {
 public:
  virtual void add(Method) = 0;
  virtual void add(Reader) = 0;
  virtual void add(Effect) = 0;
  virtual void add(Analysis) = 0;
  virtual void add(Output) = 0;
  virtual void add(Controller) = 0;

 protected:
  ~Registry() = default;
};

#define NONIO_SDK_VERSION 23

#define NONIO_STRING_(x) #x
#define NONIO_STRING(x) NONIO_STRING_(x)
#if defined(__clang__)
#define NONIO_COMPILER "clang " NONIO_STRING(__clang_major__)
#elif defined(__GNUC__)
#define NONIO_COMPILER "gcc " NONIO_STRING(__GNUC__)
#else
#define NONIO_COMPILER "unknown"
#endif
#if defined(__GLIBCXX__)
#define NONIO_STDLIB \
  "libstdc++ abi " NONIO_STRING(__GXX_ABI_VERSION) " cxx11 " NONIO_STRING(_GLIBCXX_USE_CXX11_ABI)
#else
#define NONIO_STDLIB "other"
#endif
#if defined(_GLIBCXX_DEBUG)
#define NONIO_DEBUG "debug containers"
#else
#define NONIO_DEBUG "plain containers"
#endif

/// Properties of the build that must be equal in host and plugin.
#define NONIO_ABI_TAG                                                                \
  "nonio-sdk " NONIO_STRING(NONIO_SDK_VERSION) "; " NONIO_COMPILER "; " NONIO_STDLIB \
                                               "; " NONIO_DEBUG

/// Type of the exported symbol `nonio_plugin`. It is a plain struct, because the host reads the tag
/// before it calls any function of the plugin.
struct PluginEntry {
  char abi_tag[160];
  void (*add_to)(Registry&);
};

}  // namespace nonio

/// Defines the entry of a library, and the function that registers its plugins.
#define NONIO_PLUGIN_LIBRARY(registry)                                                     \
  static void nonio_plugin_library(nonio::Registry& registry);                             \
  extern "C" __attribute__((visibility("default"))) const nonio::PluginEntry nonio_plugin; \
  const nonio::PluginEntry nonio_plugin = {NONIO_ABI_TAG, &nonio_plugin_library};          \
  static void nonio_plugin_library(nonio::Registry& registry)

/// Begins the function that registers plugins. Nonio's own plugins of one kind form one library:
/// each has its own namespace, and the entry of the library calls the functions of all
/// (plugins/CMakeLists.txt).
#ifdef NONIO_BUILT_IN
#define NONIO_PLUGIN(registry) void nonio_plugin_of_library(nonio::Registry& registry)
#else
#define NONIO_PLUGIN(registry) NONIO_PLUGIN_LIBRARY(registry)
#endif
