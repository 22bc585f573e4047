// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "nonio/controllers/kit.h"

/// Files with the table of one axis each, and lists to be entered by hand for controls without a
/// table file: one point per line, text after '#'.
namespace nonio::controllers {

/// Whether point 1 is the one at the smallest or at the largest position.
enum class Numbered { upwards, downwards };

/// Returns "NAME-X.txt" with the columns point number, position and entry. With columns for both
/// directions, the entry towards minus follows (0 without direction tables).
std::vector<Artifact> list_file(const Sheet&, std::string_view name,
                                Columns columns = Columns::mean,
                                Numbered numbered = Numbered::upwards);

/// Inverse of `list_file`; the result is the table after it is entered in the control.
Expected<std::vector<LoadedTable>> parse_list(const TableInput&, const ControlTable&,
                                              std::string_view name,
                                              Columns columns = Columns::mean);

/// Parses files "NAME-X-..." with the table of one axis each. `take` adds a line to the table, or
/// returns false if it is not a point. A file without a point is ignored; an error if no file has
/// one. A rotary table from 0 to 360 deg with equal ends repeats.
using Take = std::function<Expected<bool>(std::string_view line, RawTable&)>;
Expected<std::vector<LoadedTable>> parse_files(const TableInput&, const ControlTable&,
                                               std::string_view name, const Take& take);
tl::unexpected<Error> no_point(std::string_view line);

/// Value of the line "PARAMETER = 0.008 mm", SI; none without such a line.
std::optional<double> parameter_in(std::string_view bytes, std::string_view parameter);

}  // namespace nonio::controllers
