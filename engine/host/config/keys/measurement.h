// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "host/config/keys/shared.h"

/// [[measurement]] of campaign.toml.
namespace nonio::host::config::declared {

inline constexpr Words axis_runs[] = {"axis"};
inline constexpr Choice measurement_kinds[] = {
    {"axis"},         {"straightness"}, {"angle"},        {"diagonal"}, {"step-diagonal"},
    {"ball-centres"}, {"rtcp"},         {"observations"}, {"circle"},   {"thermal"},
    {"spindle"},      {"lengths"},      {"artefact"},     {"artefact-certificate"},
    {"ballbar"}};
inline constexpr Choice on_or_off[] = {{"on"}, {"off"}};
inline constexpr Choice adjustments[] = {{"before"}, {"after"}};
inline constexpr Choice listed_orders[] = {{"pendulum"}, {"as-listed"}, {"unknown"}};
inline constexpr Choice planes[] = {{"XY"}, {"YZ"}, {"ZX"}};
inline constexpr Choice linear_axes[] = {{"X"}, {"Y"}, {"Z"}};
inline constexpr Words of_one_axis[] = {"axis", "straightness", "angle", "ball-centres", "rtcp"};
inline constexpr Words straightness[] = {"straightness"}, angle[] = {"angle"},
                       circle[] = {"circle"}, nest[] = {"thermal", "spindle"},
                       artefacts[] = {"artefact", "artefact-certificate"};
inline constexpr Words diagonals[] = {"diagonal", "step-diagonal"};
inline constexpr Words an_end = "the axis positions of that end, { X = 0, Y = 0 }";
inline constexpr Key measurement_keys[] = {
    {.name = "id",
     .holds = text,
     .help = "Name of the measurement, unique in the campaign. Without `state`, the text after "
             "its first space is the state of the machine.",
     .required = true,
     .wanted = "expected up to 60 characters without / and \\, not starting with a point",
     .text = {.not_letters = "/\\\n\t", .not_first = ". ", .longest = 60}},
    {.name = "kind",
     .holds = text,
     .help = "Kind of the measurement; it determines the columns of the file.",
     .required = true,
     .choices = measurement_kinds},
    {.name = "file",
     .holds = text,
     .help = "File of the readings, below the campaign's folder.",
     .required = true},
    {.name = "reader",
     .holds = text,
     .help = "Reader plugin for the file. Default: chosen by the content.",
     .named = Named::reader},
    {.name = "axis",
     .holds = text,
     .help = "The axis that moves, or the rotary axis with the measured balls; of kind thermal the "
             "linear "
             "axis that is exercised, else none.",
     .needed = {"kind", of_one_axis},
     .missing = "which axis of the machine was measured"},
    {.name = "lateral",
     .holds = text,
     .help = "The axis in whose direction a straightness deviation is sensed.",
     .needed = {"kind", straightness},
     .missing = "the axis in whose direction the deviation was measured"},
    {.name = "adjustment",
     .holds = text,
     .help = "Whether the test was made before or after the adjustment of the machine, for the "
             "certificate.",
     .choices = adjustments},
    {.name = "order",
     .holds = text,
     .help = "Order of the readings in a file without times: forward and back, run by run "
             "(pendulum), in the order of the rows (as-listed), or unknown: then nothing is "
             "concluded from time.",
     .only = {"kind", axis_runs},
     .choices = listed_orders},
    {.name = "side",
     .holds = text,
     .help = "For a gantry axis with a scale on each side: the side of this line. Each side "
             "has its own table.",
     .only = {"kind", axis_runs},
     .choices = sides},
    {.name = "state",
     .holds = text,
     .help =
         "State of the machine during the measurement. Diagonals, straightness lines and runs of "
         "one state are evaluated together; \"\" belongs to every state.",
     .wanted = "expected up to 60 characters without / and \\, not starting with a point",
     .text = {.not_letters = "/\\\n\t", .not_first = ". ", .longest = 60}},
    {.name = "about",
     .holds = text,
     .help = "The axis of the rotation (yaw of X: Z), right-handed positive.",
     .required = true,
     .only = {"kind", angle},
     .choices = linear_axes},
    {.name = "foot_mm",
     .holds = number,
     .help = "Length of the foot or mirror base of a level or autocollimator that was moved by its "
             "own length along the line: the angles then give the straightness.",
     .unit = "mm",
     .only = {"kind", angle},
     .wanted = "expected a length above 0",
     .least = 0.001},
    {.name = "sensor_distance_mm",
     .holds = number,
     .help = "Distance along the spindle between the sensors 1 and 2 of a nest (x1_um and x2_um, "
             "y1_um and y2_um): their difference then gives the tilt.",
     .unit = "mm",
     .only = {"kind", nest},
     .wanted = "expected a distance from 1 to 10000 mm",
     .least = 1.0,
     .most = 1e4},
    {.name = "reversal_of",
     .holds = text,
     .help = "The measurement of the same line before the straightedge was turned over: both give "
             "the straightness of the motion without that of the straightedge.",
     .only = {"kind", straightness}},
    {.name = "square",
     .holds = text,
     .help = "The [[square]] on whose face the deviation was read: two lines, each axis towards "
             "the other, give the squareness.",
     .only = {"kind", straightness}},
    {.name = "square_turned",
     .holds = flag,
     .help = "Whether the square had been turned over about one of its faces: its own error then "
             "drops out of the mean.",
     .only = {"kind", straightness}},
    {.name = "artefact",
     .holds = text,
     .help = "Name of the artefact whose balls were probed, or whose certificate this is; the "
             "same in every placement.",
     .only = {"kind", artefacts},
     .needed = {"kind", artefacts},
     .missing = "a name of the artefact, \"plate\"",
     .wanted = "expected up to 60 characters without / and \\",
     .text = {.not_letters = "/\\\n\t", .longest = 60}},
    {.name = "exclude",
     .holds = wholes,
     .help = "Lines of the file whose readings are excluded from all analyses; the results "
             "list each of them.",
     .wanted = "expected line numbers of the file, whole and from 1",
     .least = 1.0,
     .most = 4e9},
    {.name = "exclude_reason",
     .holds = text,
     .help = "Reason why the lines of exclude are excluded; without it no certificate is "
             "issued."},
    {.name = "from",
     .holds = number_table,
     .help = "Axis positions at the start of a diagonal, { X = 0, Y = 0 }.",
     .unit = "mm",
     .needed = {"kind", diagonals},
     .missing = an_end},
    {.name = "to",
     .holds = number_table,
     .help = "Axis positions at the end of a diagonal, { X = 12000, Y = 9000 }.",
     .unit = "mm",
     .needed = {"kind", diagonals},
     .missing = an_end},
    {.name = "plane",
     .holds = text,
     .help = "Plane of a circle. Angles and counter-clockwise motion go from its first axis to its "
             "second: XY is G17, ZX is G18, YZ is G19.",
     .only = {"kind", circle},
     .needed = {"kind", circle},
     .missing = "the plane of the circle, \"XY\"",
     .choices = planes},
    {.name = "radius_mm",
     .holds = number,
     .help = "Commanded radius of a circle.",
     .unit = "mm",
     .only = {"kind", circle},
     .needed = {"kind", circle},
     .missing = "the commanded radius of the circle",
     .wanted = "expected a radius from 1 to 10000 mm",
     .least = 1.0,
     .most = 1e4},
    {.name = "centre",
     .holds = number_table,
     .help = "Commanded axis positions at the centre of a circle, { X = 400, Y = 300 }.",
     .unit = "mm",
     .only = {"kind", circle},
     .needed = {"kind", circle},
     .missing = "the axis positions at the centre of the circle, { X = 400, Y = 300 }"},
    {.name = "at",
     .holds = number_table,
     .help = "Positions of the axes at rest, { Y = 500 }: the line on which this axis was "
             "measured.",
     .unit = "mm"},
    {.name = "feed_mm_per_min",
     .holds = number,
     .help = "Feed between the targets of a linear axis or along a line, for the certificate.",
     .unit = "mm/min",
     .wanted = above_0,
     .least = 0.0,
     .above = true},
    {.name = "feed_deg_per_min",
     .holds = number,
     .help = "Feed between the targets of a rotary axis, for the certificate.",
     .unit = "deg/min",
     .wanted = above_0,
     .least = 0.0,
     .above = true},
    {.name = "dwell_s",
     .holds = number,
     .help = "Dwell at a target before the reading, for the certificate.",
     .unit = "s",
     .wanted = not_negative,
     .least = 0.0},
    {.name = "over_travel_mm",
     .holds = number,
     .help = "Travel of a linear axis beyond the last target, for the certificate.",
     .unit = "mm",
     .wanted = not_negative,
     .least = 0.0},
    {.name = "over_travel_deg",
     .holds = number,
     .help = "Travel of a rotary axis beyond the last target, for the certificate.",
     .unit = "deg",
     .wanted = not_negative,
     .least = 0.0},
    {.name = "tool_offset",
     .holds = number_table,
     .help = "Offset from the tool's reference to the measured point, { Z = -120 }, for the "
             "certificate.",
     .unit = "mm"},
    {.name = "workpiece_offset",
     .holds = number_table,
     .help = "Offset from the workpiece's reference to the measured point, { X = 40 }, for the "
             "certificate.",
     .unit = "mm"},
    {.name = "compensation",
     .holds = text,
     .help = "Whether the control's compensation (tables and backlash) was on or off during the "
             "test, for the certificate.",
     .choices = on_or_off},
};

}  // namespace nonio::host::config::declared
