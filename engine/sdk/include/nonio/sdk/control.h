// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <numbers>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "nonio/sdk/campaign.h"
#include "nonio/sdk/error.h"
#include "nonio/sdk/results.h"
#include "nonio/sdk/settings.h"

/// What a controller plugin reports of its tables, and what a control makes of them. With e =
/// actual - nominal, and c = what the control adds to a position, a table is right if c = -e.
namespace nonio {

/// The tables of one control. A unit is the m (rad) that 1 in the file stands for; a step is the
/// smallest difference of two numbers in it. 0: no such limit is known.
struct ControlTable {
  enum class Sign { error, correction };               ///< entries are +e, or -e
  enum class Entry { absolute, increment, position };  ///< position: nominal plus the entry
  enum class Grid { even, listed };
  /// Where an entry has to be 0: nowhere (it is 0 at the reference point nevertheless); at the
  /// reference point, at any position; at the first point, the zero of the axis, from which the
  /// control counts its points.
  enum class Zero { free, reference, first };
  struct Scale {
    double linear = 1e-3, rotary = std::numbers::pi / 180.0;
    double of(bool is_rotary) const { return is_rotary ? rotary : linear; }
  };
  /// How well something is known: of the maker's manual or source code, of a run of the control
  /// itself; following from that; general knowledge of the trade.
  enum class Confidence { documented, run, inferred, unsure };
  struct Fact {
    std::string id;  ///< "sign"; where it is not documented, tables come with a note <plugin>.<id>
    Confidence confidence = Confidence::documented;
    std::string description;  ///< one sentence, English
  };

  std::string name;  ///< as the maker calls it: "kw.ssfk"
  Sign sign = Sign::error;
  Entry entry = Entry::absolute;
  Grid grid = Grid::even;
  Zero zero = Zero::free;
  Scale position_unit{}, position_step{1e-7, std::numbers::pi / 180e3};
  Scale value_unit{}, value_step{1e-9, std::numbers::pi / 180e6};
  std::size_t points = 0;  ///< of one table
  double largest = 0.0;    ///< size of an entry, in file units
  std::optional<std::pair<std::int64_t, std::int64_t>> increment{};  ///< range of one, in steps
  bool rotary = true;          ///< takes tables of rotary axes
  bool bidirectional = false;  ///< takes tables for each direction
  bool straightness = false;   ///< an axis by the position of another
  bool squareness = false;
  bool volumetric = false;  ///< by the positions of several axes at once, or all errors in one file
  bool runs_gcode = true;   ///< takes part programs in G-code
  std::string backlash;     ///< the parameter of lost motion; empty: none with these tables
  std::vector<Fact> facts{};
};

/// A table as its control reads it: c, what it adds to the position of `output`. SI. Range: what
/// `validate_table` (math/loaded_table.h) accepts.
struct LoadedTable {
  enum class Outside { holds, zero, repeats, continues };
  std::string output;                         ///< axis; as the file names it if it is not known
  std::vector<std::string> input;             ///< by the positions of these; one, or two
  std::vector<std::vector<double>> position;  ///< of each input, ascending
  std::vector<double> plus;                   ///< c; of two inputs the last one runs fastest
  std::vector<double> minus;                  ///< moving towards minus; empty: as `plus`
  Outside outside = Outside::holds;
  std::optional<double> backlash{};  ///< what the file sets: m or rad, lost motion is positive
  bool rotary = false;               ///< of the output axis
};

/// The files of one table, and what is known of the machine: its axes, with their numbers in the
/// options, state what the files' names mean.
struct TableInput {
  const std::vector<Artifact>& files;
  const Campaign& campaign;
  const Settings& options;
};

/// A control's backup, and the files of a new table: what `Controller::merge` puts together.
struct MergeInput {
  const std::vector<Artifact>& backup;  ///< as it was saved, all files that hold tables
  const std::vector<Artifact>& table;   ///< of this axis, as `Controller::write` made them
  const std::string& axis;
  const Campaign& campaign;
  const Settings& options;
};

}  // namespace nonio
