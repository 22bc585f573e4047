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
#include "nonio/sdk/units.h"

/// A plugin is a shared library with one exported symbol. It registers values of the six kinds
/// below: pure functions from a value to a value or an error. The host owns disk, clock, log,
/// locale, threads, processes and configuration.
///
///     NONIO_PLUGIN(registry) { registry.add(nonio::Analysis{...}); }
namespace nonio {

struct HistorySoFar;

/// One option of a plugin, or one key that a method adds to [[measurement]]. The host checks kind,
/// range and choices and fills in the default.
struct Option {
  std::string name;
  Setting default_value;               ///< it also fixes the kind
  std::string unit;                    ///< "" if none
  std::string help;                    ///< one sentence
  std::vector<std::string> choices{};  ///< of a text option: what is allowed; empty: anything
  /// Of a number: the allowed range, ends included. Of a text that a method declares, `max` limits
  /// its bytes.
  std::optional<double> min{}, max{};

  // Of a key that a method declares.
  bool required = false;
  std::string missing{};    ///< reported where it is missing: "the plane of the circle, \"XY\""
  std::string expected{};   ///< reported of a wrong value: "expected a length above 0"
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
/// Both ends included.
inline Option within(double min, double max, Option o) {
  o.max = max;
  return at_least(min, std::move(o));
}

struct Info {
  std::string name;
  std::string version;
  std::string summary;  ///< one sentence, for `nonio plugin list`
  std::vector<Option> options{};
  /// Of an analysis or output: not among "all that apply", only where `[run]` names it or the
  /// campaign has its `[options.<name>]`.
  bool opt_in = false;
};

struct Method;

struct ReadInput {
  std::string_view bytes;  ///< the whole file
  const Campaign& campaign;
  const Measurement& measurement;
  const Settings& options;
  /// To be called repeatedly with the offset up to which the bytes are not needed any more, so that
  /// a file of a gigabyte does not stay in memory together with its readings. May be empty.
  std::function<void(std::size_t)> done_with{};
  /// The method of the measurement; null where none is loaded.
  const Method* method = nullptr;
};

/// bytes -> observations
struct Reader {
  Info info;
  /// Whether the first bytes of a file look like this reader's format.
  bool (*recognises)(std::string_view head) = nullptr;
  /// Whether it can read a measurement of this kind.
  bool (*reads)(std::string_view measurement_kind) = nullptr;
  Expected<Observations> (*read)(const ReadInput&) = nullptr;
  /// Whether it also reads the columns that a method declares (`ReadInput::method`), of any kind.
  bool reads_columns = false;
  /// Optional: the first rows of a table as text, the names of its columns first, for a person who
  /// states what they are (option `columns`). At most `most` rows.
  Expected<std::vector<std::vector<std::string>>> (*first_rows)(std::string_view bytes,
                                                                std::size_t most) = nullptr;
};

/// The content of a file of readings, by the columns that a method declares. SI; NaN where a value
/// is blank; a direction is +1, -1, or 0 where it is blank.
struct Readings {
  std::map<std::string, std::vector<double>, std::less<>> columns;  ///< by `Method::Column::name`
  std::vector<std::uint32_t> source_line;                           ///< line of the file, 1-based

  std::size_t size() const { return source_line.size(); }
  /// Null if the file does not have it.
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
  const Observations& observations;  ///< what `observe` has to make of the readings
};

/// A measuring method: what [[measurement]] and a file of readings contain, and which observations
/// the readings are. sdk/method.h has the functions that apply it.
struct Method {
  struct Column {
    /// What the default of `observe` makes of it.
    enum class Role {
      none,      ///< only `observe` of the method uses it
      position,  ///< of the measurement's axis
      deviation,
      run,        ///< a whole number from 1
      direction,  ///< + or -
      time,
      material,
      air,
      pressure,
      humidity,
    };
    std::string name;  ///< in a file with the unit: `target` of quantity length is `target_mm`
    Quantity quantity = Quantity::number;
    Role role = Role::none;
    std::string help;      ///< one sentence
    bool required = true;  ///< else a file may leave it out, and fields may be blank
  };
  /// name: the `kind` of [[measurement]]. options: the keys that it adds there, next to those of all
  /// methods. The host fills `Measurement::axis`, `lateral`, `from` and `to` from keys of that name.
  Info info;
  /// Optional: the kind whose observations these are, "axis". What applies to that kind (analyses,
  /// checks, tables, history) then applies to this one. Empty: a kind of its own.
  std::string observed_as{};
  /// Of a kind of its own.
  Measurement::Motion motion = Measurement::Motion::targets;
  std::vector<Column> columns{};  ///< none: readers of their own read its files
  /// Optional: readings -> observations. Without it, the roles of the columns determine them
  /// (`observe` in sdk/method.h).
  Expected<Observations> (*observe)(const MethodInput&) = nullptr;
  /// Optional, required with `observe`: observations -> the readings that give them, for `nonio
  /// simulate` and `nonio plugin check`.
  Expected<Readings> (*simulate)(const SimulationInput&) = nullptr;
};

/// Why an effect is no candidate for these readings: a name of words ("unseen.<id>"), empty if it
/// does not concern this axis at all; and the rows of the table that prevent it.
struct WhyNot {
  std::string id;
  std::vector<std::uint32_t> rows{};
};

/// One physical cause of deviation: observations -> one column for each linear parameter. Rows in
/// which the axis did not move are 0 (`readings_of` in sdk/axis_readings.h gives what a column
/// needs).
struct Effect {
  using Columns = std::vector<std::vector<double>>;
  struct Parameter {
    std::string name;
    std::string help;
    Quantity quantity = Quantity::number;
    Quantity rotary = quantity;  ///< the same on a rotary axis
  };
  /// A parameter that is searched: a period, a time constant, an instant, a number of knots.
  struct Shape {
    Parameter parameter;
    /// Where to look, ascending, in SI; one value if it is known (a period in the manifest). Empty
    /// if these readings cannot show the effect.
    std::function<std::vector<double>(const Observations&, const Axis&)> grid;
    bool continuous = true;  ///< the best value may be between those of the grid
    /// The default where the readings do not contradict it (a fixed point in the middle): it needs
    /// no evidence, unlike every other value of the grid.
    std::optional<double> usual{};
  };
  Info info;                      ///< name: the kind without the axis, "backlash"
  std::vector<Parameter> linear;  ///< of a curve: one, which stands for all of its columns
  std::vector<Shape> shapes;
  bool curve = false;        ///< smooth: as many columns as its first shape requests
  bool compensable = false;  ///< a table in the controller can take it away
  std::function<bool(const Observations&, const Axis&)> applies;
  /// Columns of length observations.size(), of unit 1/unit of the parameter times the deviation's.
  std::function<Expected<Columns>(const Observations&, const Axis&,
                                  const std::vector<double>& shape)>
      columns;
  /// Of an effect in space: what it can be of in these readings, "EYX" (straightness), "XY"
  /// (squareness) or a line. The Axis that comes in has this name and nothing else, and the columns
  /// are the deviation as it is sensed (`Observations::sense_of`). Without it: of each axis, the
  /// columns are the error along the axis, and the engine takes its component where readings are
  /// sensed in another direction.
  std::function<std::vector<std::string>(const Observations&)> instances{};
  /// An unknown of the set-up (the orientation of a mirror): in every model that it applies to,
  /// never a candidate.
  bool is_nuisance = false;
  /// A curve that describes the remainder without a cause ("a reversal for each target"): never a
  /// candidate, offered where no effect explains. With other effects: what they leave of it.
  bool description = false;
  /// Its instances are channels of a measurement over time (`Observations::channels`): it explains
  /// displacements over time and nothing else. Other effects do not.
  bool of_channels = false;
  /// Optional: why it does not apply, where it does not.
  std::function<WhyNot(const Observations&, const Axis&)> why_not{};
};

struct AnalysisInput {
  const Campaign& campaign;
  const Measurement& measurement;
  const Observations& observations;
  const Settings& options;
  /// One entry for each measurement of the campaign, in its order; empty where nothing could read
  /// it. For methods that need more than one: their ids are in Evaluation::uses.
  const std::vector<Observations>* all = nullptr;
  /// What the machine's control takes, as its plugin declares it; null where none of that name is
  /// loaded.
  const ControlTable* control = nullptr;
};

struct CampaignInput {
  const Campaign& campaign;
  /// One entry for each measurement, in their order; empty where nothing could read it.
  const std::vector<Observations>& observations;
  const Settings& options;
};

/// observations -> results
struct Analysis {
  Info info;
  bool (*applies)(const Campaign&, const Measurement&) = nullptr;
  Expected<Evaluation> (*analyse)(const AnalysisInput&) = nullptr;
  /// In place of these two: once, of the campaign as a whole (a plan needs no measurement).
  Expected<Evaluation> (*analyse_campaign)(const CampaignInput&) = nullptr;
  /// Whether its values state what of them is followed over the years (`Value::followed`). If not,
  /// each value whose uncertainty is in the budget is followed, as "<plugin>:<value>" of the
  /// measurement's axis.
  bool states_followed = false;
};

struct OutputInput {
  const Campaign& campaign;
  /// One entry for each measurement of the campaign, in its order; empty where nothing could read
  /// it.
  const std::vector<Observations>& observations;
  const Results& results;
  const Settings& options;
  const Templates& templates;
  const Issue* issue = nullptr;  ///< of a certificate; null in the check for missing data
  /// The machine over its campaigns (sdk/history.h), if `Output::wants_history` is set; null while
  /// it is not known yet.
  const HistorySoFar* history = nullptr;
};

/// results -> documents. It is written after the tables of all controllers, and sees in
/// `results.outputs` what they predict.
struct Output {
  /// Of what is issued under a number, once and for good.
  struct Certificate {
    /// Everything that is missing for it, as keys to fill. When nothing is, `write` is called for a
    /// draft (Issue::is_draft): every page of its PDF has to state that it is one. When a person
    /// has released it, the host draws a number and calls `write` again; the same data are never
    /// issued anew.
    std::vector<std::string> (*missing_requirements)(const OutputInput&) = nullptr;
  };
  /// What the program writes with it where it has a document of this kind to show or to print.
  enum class Role { other, report, model_page, sheet_of_stops };
  Info info;
  bool (*applies)(const Campaign&) = nullptr;
  Expected<OutputResult> (*write)(const OutputInput&) = nullptr;
  /// Optional: called once in a run, before any campaign, to pay for what all documents share
  /// (fonts). It must not change what `write` gives.
  void (*prepare)(const Templates&) = nullptr;
  /// Optional: what is wrong with the templates and words that this output uses.
  std::vector<Error> (*check_templates)(const Templates&) = nullptr;
  std::optional<Certificate> certificate{};  ///< none: it is written without a number
  /// Optional: whether it shows the machine's history with these options. It is then written again
  /// when that history is another one.
  bool (*wants_history)(const Settings&) = nullptr;
  Role role = Role::other;
};

struct ControllerInput {
  const Campaign& campaign;
  /// One entry for each measurement of the campaign, in its order; empty where nothing could read
  /// it.
  const std::vector<Observations>& observations;
  const Results& results;
  const Settings& options;
  /// The readings themselves, where `observations` is what the campaign's model predicts of them
  /// (manifest, compensate = "model"); else null.
  const std::vector<Observations>* measured = nullptr;
};

/// readings and results -> the tables of one control, and back. `[run] outputs` names it among the
/// outputs: no output has the same name.
struct Controller {
  /// Where it has an option `axes` of tables, the host puts into it what the record of the machine
  /// states about each axis: number, reference_mm, from_mm, to_mm, resolution_um, largest_um,
  /// slope_um_per_m, and the same of rotary axes (_deg, _arcsec, slope_arcsec_per_deg). What of it
  /// the control does not need is passed over.
  Info info;
  ControlTable table;  ///< what the control takes
  bool (*applies)(const Campaign&) = nullptr;
  Expected<OutputResult> (*write)(const ControllerInput&) = nullptr;
  /// What the control makes of files that are in it.
  Expected<std::vector<LoadedTable>> (*parse)(const TableInput&) = nullptr;
  /// Optional: the files of the backup with the table of this axis in place of its present one, all
  /// else byte for byte as it was. Only files that changed are given. An error where it would touch
  /// another axis.
  Expected<std::vector<Artifact>> (*merge)(const MergeInput&) = nullptr;
};

/// What the host gives to a plugin's registration function.
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

/// The version of this interface: its only definition.
#define NONIO_SDK_VERSION 18

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

/// Everything that must agree before a plugin may be called.
#define NONIO_ABI_TAG                                                                \
  "nonio-sdk " NONIO_STRING(NONIO_SDK_VERSION) "; " NONIO_COMPILER "; " NONIO_STDLIB \
                                               "; " NONIO_DEBUG

/// The one exported symbol, `nonio_plugin`. Plain: the host reads the tag before it calls anything.
struct PluginEntry {
  char abi_tag[160];
  void (*add_to)(Registry&);
};

}  // namespace nonio

/// The entry of a library, and what it registers.
#define NONIO_PLUGIN_LIBRARY(registry)                                                     \
  static void nonio_plugin_library(nonio::Registry& registry);                             \
  extern "C" __attribute__((visibility("default"))) const nonio::PluginEntry nonio_plugin; \
  const nonio::PluginEntry nonio_plugin = {NONIO_ABI_TAG, &nonio_plugin_library};          \
  static void nonio_plugin_library(nonio::Registry& registry)

/// What a plugin registers. Nonio's own plugins of one kind are one library: each has a namespace
/// of its own, and the entry of the library calls the functions of all (plugins/CMakeLists.txt).
#ifdef NONIO_BUILT_IN
#define NONIO_PLUGIN(registry) void nonio_plugin_of_library(nonio::Registry& registry)
#else
#define NONIO_PLUGIN(registry) NONIO_PLUGIN_LIBRARY(registry)
#endif
