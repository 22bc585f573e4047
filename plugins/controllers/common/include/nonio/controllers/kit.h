// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <numbers>
#include <string>
#include <string_view>
#include <vector>

#include "nonio/controllers/axes.h"
#include "nonio/controllers/axis_job.h"
#include "nonio/controllers/cross_job.h"
#include "nonio/controllers/text.h"
#include "nonio/math/loaded_table.h"
#include "nonio/sdk/plugin.h"

/// Framework of controller plugins. A plugin is a declaration (ControlTable), a format and a
/// parser; the steps from the readings to the numbers of a table, and from a table to its effect,
/// are common to all.
namespace nonio::controllers {

/// Prefix of the line "points in this table: 17" in text files, which serves to detect a truncated
/// text.
inline constexpr const char* points_said = "points in this table: ";

inline constexpr double full_turn = 2.0 * std::numbers::pi;  // rad

/// A table of one axis before it is formatted.
struct Sheet {
  const AxisJob& job;
  const ControlTable& table;  ///< the declaration, modified by the options
  const ControllerInput& input;
  bool directions = false;  ///< whether each direction has its own table
  Columns columns() const { return directions ? Columns::both : Columns::mean; }
  math::Grid grid{};       ///< if evenly spaced
  double reference = 0.0;  ///< position at which an entry (with two columns, their mean) is 0; SI
  std::vector<double> position;  ///< SI
  /// Values of the entries (+e or -e, minus the value at the reference), SI, not rounded; `minus`
  /// is empty without `directions`.
  std::vector<double> plus, minus;
  /// Entries in steps of the table. Absolute values are rounded and then converted to increments if
  /// required, so that the sums are within half a step.
  std::vector<std::int64_t> plus_steps, minus_steps;
  /// Whether the maker documents which value applies outside of the table.
  bool holds_documented = false;
  bool repeats = false;  ///< whether a table of a whole turn repeats, see Writer::turn_end
  /// For increments: initial value of `minus_steps`, minus relative to plus at the reference, in
  /// steps.
  std::int64_t minus_start() const;
  std::vector<std::string> warning{};

  double position_unit() const { return table.position_unit.of(job.rotary); }
  double value_unit() const { return table.value_unit.of(job.rotary); }
  double value_step() const { return table.value_step.of(job.rotary); }
  /// SI
  double backlash() const { return directions ? job.present_backlash() : job.backlash(); }
  /// Formats in units of the file, with as many decimals as its steps have.
  std::string at(std::size_t i) const;
  std::string entry(double si) const;
  /// Lines of every file: where the table is zero, the behavior of the control outside of the
  /// table, and, last, size and steepness.
  std::vector<std::string> zero_and_size() const;
  std::string outside_words() const;
  /// Values that the control adds at `position`, as the file states them.
  std::vector<double> held(const std::vector<double>& entries) const;
  /// Machine, axis, date, warnings, sign and reversal, for comments or a separate file.
  std::vector<std::string> words() const;
};

/// Compensation of the two directions of travel.
enum class Directions {
  /// A table of the mean; with option `directions`, one for each direction, and the backlash
  /// parameter remains active.
  by_option,
  /// As by_option, but with direction tables the parameter has no effect.
  by_option_without_backlash,
  always_without_backlash,  ///< always two columns, without a backlash parameter
};

/// End of a table over a whole revolution.
enum class TurnEnd {
  repeats,  ///< the control continues at its beginning
  closed,   ///< an entry at the end repeats the first one
};

/// For direction tables: which value is 0 at the reference.
enum class ZeroOf { mean, plus, minus };

/// The parts of a plugin except its Info; created for each run, because the options modify it.
struct Writer {
  std::string name;  ///< name of the plugin; start of file names and of note ids
  ControlTable table;
  std::vector<std::string_view> keys;  ///< keys of option `axes`, as in `axis_jobs`
  std::function<Expected<std::vector<Artifact>>(const Sheet&)> files;
  Expected<std::vector<LoadedTable>> (*parse)(const TableInput&) = nullptr;

  Directions directions = Directions::by_option;
  TurnEnd turn_end = TurnEnd::repeats;
  ZeroOf zero_of = ZeroOf::mean;
  /// Whether the backlash parameter has the unit of the entries; otherwise 6 decimals of mm or deg.
  bool backlash_in_steps = false;
  bool power_of_two = false;  ///< the step must be a power of two
  bool within_turn = false;   ///< entries of rotary axes outside of 0 to 360 deg have no effect
  double fixed_step = 0.0;    ///< step of a control whose points cannot be chosen, SI; otherwise 0
  /// Whether the maker states that the end value applies outside of the table; otherwise the file
  /// states that this is an assumption.
  bool holds_documented = false;
  /// Optional: the declaration for one axis, if its units depend on the axis.
  std::function<Expected<ControlTable>(const AxisJob&, ControlTable)> of_axis{};
  /// Optional: the required points; the default is the targets.
  std::function<std::vector<double>(const AxisJob&)> wanted{};
  /// An option that makes the step of the entries coarser, with its present and its largest value.
  struct Coarser {
    std::string option;
    std::int64_t now = 1, most = 1;
    std::string or_else;  ///< an alternative, as text
  } coarser{};
};

/// Options that follow from a declaration: step, directions, max_points, sign if it is not known,
/// and `axes` with these keys in its help.
std::vector<Option> table_options(const ControlTable&, std::string keys_of_axes,
                                  std::vector<Option> more = {});

/// Applies the options to the declaration. Error: the sign is neither known nor stated.
Expected<ControlTable> chosen(ControlTable, const Settings&);

/// Write the files of each axis, and predict the deviations after the control has read them.
/// `loaded` is set in jobs whose table was written.
Expected<std::vector<AxisJob>> write_axes(const ControllerInput&, const Writer&, OutputResult&);
Expected<OutputResult> write_tables(const ControllerInput&, const Writer&);

/// Entries in file units, one for each position. An increment is the change over the interval that
/// ends at its position, so that the first one is 0. The sums are 0 at the point `reference`
/// (figure in docs/howto-plugin.md).
struct RawTable {
  KnownAxis axis;
  std::vector<double> position;
  std::vector<double> plus, minus{};
  /// For increments: index of the point whose sum is 0, for Zero::first the first one.
  std::size_t reference = 0;
  /// For increments: sum of `minus` at that point, if a separate number states it (Fanuc 3627).
  double minus_start = 0.0;
  LoadedTable::Outside outside = LoadedTable::Outside::holds;
  std::optional<double> backlash{};  ///< SI
};

/// Converts the entries of a file to the table that the control applies.
Expected<LoadedTable> loaded(const ControlTable&, const RawTable&);

/// Adds a note for each property of the control that is not documented.
void note_facts(const Writer&, OutputResult&);

/// Whether a controller always runs if it applies, or only if the manifest names it.
enum class Offered { by_name, always };

Controller controller(Info, const ControlTable&,
                      Expected<OutputResult> (*write)(const ControllerInput&),
                      Expected<std::vector<LoadedTable>> (*parse)(const TableInput&),
                      Offered offered = Offered::by_name);

/// Adds the axes that only readings contain, because a parser requires all axes.
Campaign with_axes_of(const ControllerInput&, const std::vector<AxisJob>&);

}  // namespace nonio::controllers
