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

/// A controller plugin is a declaration (ControlTable), a format and a parser; the steps from the
/// readings to the numbers of a table, and from a table to its effect, are here.
namespace nonio::controllers {

/// "points in this table: 17", among the words: text without an end shows then where it was cut.
inline constexpr const char* points_said = "points in this table: ";

inline constexpr double full_turn = 2.0 * std::numbers::pi;  // rad

/// A table of one axis before it is text.
struct Sheet {
  const AxisJob& job;
  const ControlTable& table;  ///< as declared, with what the options change
  const ControllerInput& input;
  bool directions = false;  ///< there is a table for each direction
  Columns columns() const { return directions ? Columns::both : Columns::mean; }
  math::Grid grid{};             ///< where evenly spaced
  double reference = 0.0;        ///< where an entry is 0; of two columns, their mean; SI
  std::vector<double> position;  ///< SI
  /// What an entry states (+e or -e, less what it is at the reference), SI, not yet rounded;
  /// `minus` is empty unless there are `directions`.
  std::vector<double> plus, minus;
  /// The same in steps of the table: rounded as absolute values, then differences of these where
  /// the entries are increments. So their sum is never off by more than half a step.
  std::vector<std::int64_t> plus_steps, minus_steps;
  bool holds_documented = false;  ///< see Writer
  /// Of increments: what `minus_steps` begin with, minus less plus at the reference, in steps.
  std::int64_t minus_start() const;
  std::vector<std::string> warning{};

  double position_unit() const { return table.position_unit.of(job.rotary); }
  double value_unit() const { return table.value_unit.of(job.rotary); }
  double value_step() const { return table.value_step.of(job.rotary); }
  /// For the backlash parameter; SI.
  double backlash() const { return directions ? job.present_backlash() : job.backlash(); }
  /// In units of the file, with as many decimals as its steps have: the position of a point, and
  /// an entry.
  std::string at(std::size_t i) const;
  std::string entry(double si) const;
  /// Where the table is zero, what the control does outside of it, and how large and steep it is:
  /// lines that every file has; the last one is the size.
  std::vector<std::string> zero_and_size() const;
  /// What the control does outside of the table.
  std::string outside_words() const;
  /// Machine, axis, date, warnings, sign and reversal, for comments or a file of their own.
  std::vector<std::string> words() const;
};

/// How a control takes the two directions of travel.
enum class Directions {
  by_option,                   ///< a table of the mean; of each direction where option `directions`
                               ///< states that, and the backlash parameter goes on to count
  by_option_without_backlash,  ///< the same, but with direction tables the parameter has no effect
  always_without_backlash,     ///< two columns in any case, no backlash parameter with them
};

/// How a table of a whole turn ends.
enum class TurnEnd {
  repeats,  ///< the control goes on at its beginning
  closed,   ///< an entry at the end repeats the first one
};

/// Of tables for each direction: which of them is 0 at the reference.
enum class ZeroOf { mean, plus, minus };

/// The parts of a plugin other than its Info; made for each run, as its options require.
struct Writer {
  std::string name;  ///< of the plugin: files begin with it, ids of notes too
  ControlTable table;
  std::vector<std::string_view> keys;  ///< of option `axes`, as `axis_jobs` takes them
  std::function<Expected<std::vector<Artifact>>(const Sheet&)> files;
  Expected<std::vector<LoadedTable>> (*parse)(const TableInput&) = nullptr;

  Directions directions = Directions::by_option;
  TurnEnd turn_end = TurnEnd::repeats;
  ZeroOf zero_of = ZeroOf::mean;
  bool power_of_two = false;  ///< the step of linear axes
  double fixed_step = 0.0;    ///< of a control whose points cannot be chosen
  /// Whether the maker states that the value of an end applies outside of the table; else the file
  /// calls it an assumption.
  bool holds_documented = false;
  /// The declaration for one axis, where its units are of the axis.
  std::function<Expected<ControlTable>(const AxisJob&, ControlTable)> of_axis{};
  /// Where the points are required; else at the targets.
  std::function<std::vector<double>(const AxisJob&)> wanted{};
  /// An option that makes a step of the table coarser, its present and its largest value.
  struct Coarser {
    std::string option;
    std::int64_t now = 1, most = 1;
    std::string or_else;  ///< another way out, in words
  } coarser{};
};

/// The options that follow from a declaration: step, directions, max_points, sign where it is not
/// known, `axes` with these keys in its help.
std::vector<Option> table_options(const ControlTable&, std::string keys_of_axes,
                                  std::vector<Option> more = {});

/// As declared, with what the options state. An error where the sign is not known and not stated.
Expected<ControlTable> chosen(ControlTable, const Settings&);

/// A sheet of each axis, its files, and what is left when the control has read them back. The jobs
/// that were written have `loaded`.
Expected<std::vector<AxisJob>> write_axes(const ControllerInput&, const Writer&, OutputResult&);
Expected<OutputResult> write_tables(const ControllerInput&, const Writer&);

/// Entries as a file has them, in its units; one for each position. An increment is the change over
/// the interval that ends at its position, so that of the first position is 0: there is no interval
/// before it. The sums are 0 at the point `reference` (docs/howto-plugin.md has a drawing).
struct RawTable {
  KnownAxis axis;
  std::vector<double> position;
  std::vector<double> plus, minus{};
  std::size_t reference = 0;  ///< of increments: the point whose sum is 0; Zero::first: the first
  /// Of increments: the sum of `minus` at that point, where a number of its own states it (Fanuc
  /// 3627).
  double minus_start = 0.0;
  LoadedTable::Outside outside = LoadedTable::Outside::holds;
  std::optional<double> backlash{};  ///< SI
};

/// What the control makes of such entries, as its plugin declares them.
Expected<LoadedTable> loaded(const ControlTable&, const RawTable&);

/// Notes of all that is not documented.
void note_facts(const Writer&, OutputResult&);

/// Whether a controller is among all that apply, or only where the manifest names it.
enum class Offered { by_name, always };

/// A controller of pitch tables.
Controller controller(Info, const ControlTable&,
                      Expected<OutputResult> (*write)(const ControllerInput&),
                      Expected<std::vector<LoadedTable>> (*parse)(const TableInput&),
                      Offered offered = Offered::by_name);

/// The axes of the manifest, and those that are only in readings, as a parser needs them.
Campaign with_axes_of(const ControllerInput&, const std::vector<AxisJob>&);

}  // namespace nonio::controllers
