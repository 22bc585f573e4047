// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "nonio/controllers/kit.h"

/// Files with the table of one axis each; and lists for controls without a table file, to be
/// entered by hand, one point per line, text after '#'.
namespace nonio::controllers {

/// Returns the list "NAME-X.txt" with columns: point number, position, entry. With columns for both
/// directions, the entry towards minus follows (0 if there are no direction tables).
std::vector<Artifact> list_file(const Sheet&, std::string_view name,
                                Columns columns = Columns::mean);

/// Parses lists that `list_file` has written, as the control applies them once they are entered.
Expected<std::vector<LoadedTable>> parse_list(const TableInput&, const ControlTable&,
                                              std::string_view name,
                                              Columns columns = Columns::mean);

/// Parses files that contain the table of one axis each, "NAME-X-...". `take` adds a line to the
/// table, or returns false if it is not a point. A file without a point is ignored; error if no
/// file has one. A rotary table from 0 to 360 deg with equal ends repeats.
using Take = std::function<Expected<bool>(std::string_view line, RawTable&)>;
Expected<std::vector<LoadedTable>> parse_files(const TableInput&, const ControlTable&,
                                               std::string_view name, const Take& take);
/// Returns the error that a line is not a valid point.
tl::unexpected<Error> no_point(std::string_view line);

/// Returns the value of the line "PARAMETER = 0.008 mm" in the text of a table, SI; nothing if
/// there is none.
std::optional<double> parameter_in(std::string_view bytes, std::string_view parameter);

}  // namespace nonio::controllers
