// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "nonio/controllers/kit.h"

/// Tables of one axis a file; and tables that have no file: a list to be typed in, a point a line,
/// words behind '#'.
namespace nonio::controllers {

/// "NAME-X.txt": number of the point, its position, the entry, and that towards minus where there
/// are columns of both directions (0 without a table for each direction).
std::vector<Artifact> list_file(const Sheet&, std::string_view name,
                                Columns columns = Columns::mean);

/// Such lists read back, as the control takes them once they are typed in.
Expected<std::vector<LoadedTable>> parse_list(const TableInput&, const ControlTable&,
                                              std::string_view name,
                                              Columns columns = Columns::mean);

/// Files that hold a table of one axis each, "NAME-X-...": `take` puts a line into the table, or
/// states false where it is none of its points. A file without a point is passed over; none with
/// one is an error. A rotary table from 0 to 360 deg with equal ends repeats itself.
using Take = std::function<Expected<bool>(std::string_view line, RawTable&)>;
Expected<std::vector<LoadedTable>> parse_files(const TableInput&, const ControlTable&,
                                               std::string_view name, const Take& take);
/// That the line is not a point as it should be.
tl::unexpected<Error> no_point(std::string_view line);

/// The line "PARAMETER = 0.008 mm" in the text that goes with a table; SI.
std::optional<double> parameter_in(std::string_view bytes, std::string_view parameter);

}  // namespace nonio::controllers
