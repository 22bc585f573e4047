// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "campaign/config/keys/shared.h"

/// Declares the keys of [[measurement]] that all methods share. Each method declares further keys.
namespace nonio::config::declared {

inline constexpr Choice on_or_off[] = {{"on"}, {"off"}};
inline constexpr Choice adjustments[] = {{"before"}, {"after"}};
inline constexpr Choice roles_of_channel[] = {{"air"}, {"structure"}, {"source"}, {"coolant"}};
inline constexpr Key channel_keys[] = {
    {"name", into<&Measurement::Channel::name>,
     "Its column in the file, without the unit: \"t4\" of t4_c.", required},
    {"place", into<&Measurement::Channel::place>, "Where the sensor is: \"front bearing\"."},
    {"role", into<&Measurement::Channel::role>,
     "What it measures. Only temperatures of the structure make it bend by their difference.",
     roles_of_channel},
};
inline constexpr Key measurement_keys[] = {
    {"id", into<&Measurement::id>,
     "Name of the measurement, unique in the campaign. Without `state`, the text after its first "
     "space is the state of the machine.",
     required,
     spelled({.not_letters = "/\\\n\t", .not_first = ". ", .longest = 60},
             "expected up to 60 characters without / and \\, not starting with a point")},
    {"kind", into<&Measurement::kind>,
     "Kind of the measurement: the name of its method, which determines the columns of the file "
     "and further keys.",
     required, Named::method},
    {"file", into<&Measurement::file>, "File of the readings, below the campaign's folder.",
     required},
    {"reader", into<&Measurement::reader>,
     "Reader plugin for the file. Default: chosen by the content.", Named::reader},
    {"adjustment", into<&Measurement::adjustment>,
     "Whether the test was made before or after the adjustment of the machine, for the "
     "certificate.",
     adjustments},
    {"state", into<&Measurement::state>,
     "State of the machine during the measurement. Diagonals, straightness lines and runs of one "
     "state are evaluated together; \"\" belongs to every state.",
     spelled({.not_letters = "/\\\n\t", .not_first = ". ", .longest = 60},
             "expected up to 60 characters without / and \\, not starting with a point")},
    {"tolerance_um", by<read_tolerances, number_table, &Measurement::tolerances>,
     "Upper limits of this measurement's results that are lengths, by their names: { G_ccw = 10.0, "
     "G_cw = 10.0 }. They hold in place of those of the axis.",
     um, a_tolerance},
    {"tolerance_urad", by<read_tolerances, number_table, &Measurement::tolerances>,
     "The same for results that are small angles (squareness): { C0Y = 20.0 }.", urad, a_tolerance},
    {"tolerance_arcsec", by<read_tolerances, number_table, &Measurement::tolerances>,
     "The same for results of a rotary axis: { A = 8.0 }.", arcsec, a_tolerance},
    {"tolerance_um_per_m", by<read_tolerances, number_table, &Measurement::tolerances>,
     "The same for results that are lengths per length: { scale_mismatch = 15.0 }.", um_per_m,
     a_tolerance},
    {"exclude", into<&Measurement::exclude>,
     "Lines of the file whose readings are excluded from all analyses; the results list each of "
     "them.",
     within(1.0, 4e9, "expected line numbers of the file, whole and from 1")},
    {"exclude_reason", into<&Measurement::exclude_reason>,
     "Reason why the lines of exclude are excluded; without it no certificate is issued."},
    {"channel", nested<&Measurement::channels>,
     "What is known of a channel that was recorded next to the deviations.", channel_keys},
    {"at", into<&Measurement::at>,
     "Positions of the axes at rest, { Y = 500 }: the line on which this axis was measured.", mm},
    {"feed_mm_per_min", into<&Measurement::feed>,
     "Feed between the targets of a linear axis or along a line, for the certificate.", mm_per_min,
     above_0},
    {"feed_deg_per_min", into<&Measurement::feed>,
     "Feed between the targets of a rotary axis, for the certificate.", deg_per_min, above_0},
    {"dwell_s", into<&Measurement::dwell>,
     "Dwell at a target before the reading, for the certificate.", seconds, not_negative},
    {"over_travel_mm", into<&Measurement::over_travel>,
     "Travel of a linear axis beyond the last target, for the certificate.", mm, not_negative},
    {"over_travel_deg", into<&Measurement::over_travel>,
     "Travel of a rotary axis beyond the last target, for the certificate.", deg, not_negative},
    {"tool_offset", into<&Measurement::tool_offset>,
     "Offset from the tool's reference to the measured point, { Z = -120 }, for the certificate.",
     mm},
    {"workpiece_offset", into<&Measurement::workpiece_offset>,
     "Offset from the workpiece's reference to the measured point, { X = 40 }, for the "
     "certificate.",
     mm},
    {"compensation", into<&Measurement::compensation>,
     "Whether the control's compensation (tables and backlash) was on or off during the test. With "
     "off, active_table and the active backlash value of the axis do not apply to this "
     "measurement.",
     on_or_off},
};

}  // namespace nonio::config::declared
