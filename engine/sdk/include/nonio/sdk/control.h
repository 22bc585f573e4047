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

/// Declaration of the tables of a control and of their application. With e = actual - nominal and c
/// = the value that the control adds to a position, a table is correct if c = -e.
namespace nonio {

/// Format of the tables of one control. A unit is the SI value (m, rad) of 1 in the file; a step is
/// the smallest difference of two numbers in the file, m or rad. A limit of 0 means that the limit
/// is not known.
struct ControlTable {
  enum class Sign { error, correction };               ///< entries are +e, or -e
  enum class Entry { absolute, increment, position };  ///< position: nominal plus the value
  enum class Grid { even, listed };
  /// Position at which the entry must be 0. `free`: not prescribed (the compensation is 0 at the
  /// reference point nevertheless). `reference`: the reference point, at any position. `first`: the
  /// first point, which is the zero of the axis, from which the control counts its points.
  enum class Zero { free, reference, first };
  struct Scale {
    double linear = 1e-3, rotary = std::numbers::pi / 180.0;
    double of(bool is_rotary) const { return is_rotary ? rotary : linear; }
  };
  /// Source of a fact: the maker's manual or source code; a run of the control itself; a conclusion
  /// from these; general knowledge of the field.
  enum class Confidence { documented, run, inferred, unsure };
  struct Fact {
    /// Name of the property, such as "sign". If it is not documented, tables have a note
    /// <plugin>.<id>.
    std::string id;
    Confidence confidence = Confidence::documented;
    std::string description;  ///< one English sentence
  };

  std::string name;  ///< the maker's name of the format: "kw.ssfk"
  Sign sign = Sign::error;
  Entry entry = Entry::absolute;
  Grid grid = Grid::even;
  Zero zero = Zero::free;
  Scale position_unit{}, position_step{1e-7, std::numbers::pi / 180e3};
  Scale value_unit{}, value_step{1e-9, std::numbers::pi / 180e6};
  std::size_t points = 0;  ///< largest number of points of one table
  double largest = 0.0;    ///< largest absolute value of an entry, in file units
  /// Range of one increment, in steps.
  std::optional<std::pair<std::int64_t, std::int64_t>> increment{};
  bool rotary = true;          ///< whether tables of rotary axes are supported
  bool bidirectional = false;  ///< whether each direction may have its own table
  /// Whether one axis can be compensated by the position of another.
  bool straightness = false;
  bool squareness = false;
  /// Whether a table may depend on several axes, or one file may contain all errors.
  bool volumetric = false;
  bool runs_gcode = true;  ///< whether the control runs part programs in G-code
  /// The control's parameter for the backlash value; empty if these tables have none.
  std::string backlash;
  std::vector<Fact> facts{};
};

/// A table as its control applies it: c, which is added to the position of `output`. All values are
/// SI. `validate_table` (math/loaded_table.h) defines which tables are valid.
struct LoadedTable {
  enum class Outside { holds, zero, repeats, continues };
  std::string output;  ///< compensated axis, or its name in the file if the axis is not known
  std::vector<std::string> input;             ///< one or two axes whose positions select the value
  std::vector<std::vector<double>> position;  ///< grid positions of each input, ascending, m or rad
  /// c for motion toward plus at the grid points, m or rad; of two inputs, the last one varies
  /// fastest.
  std::vector<double> plus;
  std::vector<double> minus;  ///< c for motion toward minus, m or rad; equal to `plus` if empty
  Outside outside = Outside::holds;
  /// Backlash value that the file sets, m or rad; lost motion is positive.
  std::optional<double> backlash{};
  bool rotary = false;
};

/// The files of one table. The campaign's axes and their numbers in the options identify the axes
/// in the files.
struct TableInput {
  const std::vector<Artifact>& files;
  const Campaign& campaign;
  const Settings& options;
};

struct MergeInput {
  /// All files of the control's backup that contain tables.
  const std::vector<Artifact>& backup;
  const std::vector<Artifact>& table;  ///< files of this axis by `Controller::write`
  const std::string& axis;
  const Campaign& campaign;
  const Settings& options;
};

}  // namespace nonio
