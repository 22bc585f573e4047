// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "campaign/config/keys/shared.h"

/// Declares [machine] of campaign.toml with its axes.
namespace nonio::config::declared {

inline constexpr Choice structures[] = {{"gantry"}, {"single-column"}, {"bridge"}, {"other"}};
inline constexpr Choice sides[] = {{"master"}, {"slave"}};
inline constexpr Key axis_keys[] = {
    {"kind", text,
     "Linear or rotary axis. Default: from the name; A, B and C are rotary (ISO 841).", axis_kinds},
    {"travel", into<&Axis::travel>, "Ends of the travel; targets outside get a finding.", mm_or_deg,
     two_numbers},
    {"teeth", into<&Axis::teeth>, "Periods of the drive or scale per revolution.", if_rotary,
     from(1, above_0.wanted)},
    {"screw_pitch_mm", into<&Axis::screw_pitch>, "Period of the drive or scale.", mm, if_linear,
     Range{"expected a pitch above 0, at most 10000 mm", 0.0, 1e4, true}},
    {"fixed_point_mm", into<&Axis::fixed_point>,
     "Position at which screw or scale is fixed and does not move when it expands (the fixed "
     "bearing, the clamp). Default: determined from the readings.",
     mm, if_linear, within(-1e6, 1e6, "expected a position within 1000000 mm")},
    {"expansion_um_per_m_K", into<&Axis::expansion>,
     "Coefficient of thermal expansion of the scale or of the machine.", um_per_m_K, if_linear,
     an_expansion},
    {"slave", into<&Axis::slave>,
     "For a gantry axis: name of the control's axis that drives the second side; its table is made "
     "from the measurement with side = \"slave\".",
     if_linear},
    {"active_table", into<&Axis::active_table>,
     "The table that was active in the control during the measurement: its file below the "
     "campaign's folder, \"backup/x.ini\", further files of the same table separated by commas; or "
     "\"none\". The new table replaces it. Without it no table is written.",
     former("table_on")},
    {"active_backlash_mm", number_or_0<&Axis::active_backlash>,
     "Value of the control's backlash parameter during the measurement, or \"none\".", mm,
     if_linear, some_backlash, former("backlash_on_mm")},
    {"active_backlash_deg", number_or_0<&Axis::active_backlash>,
     "Value of the control's backlash parameter during the measurement, or \"none\".", deg,
     if_rotary, some_backlash, former("backlash_on_deg")},
    {"tolerance_um", into<&Axis::tolerance>,
     "Upper limits of results by their names, { A = 15.0, \"R+\" = 6.0 }.", um, if_linear,
     a_tolerance},
    {"tolerance_arcsec", into<&Axis::tolerance>,
     "Upper limits of results by their names, { A = 8.0, \"R+\" = 3.0 }.", arcsec, if_rotary,
     a_tolerance},
};

inline constexpr Key machine_keys[] = {
    {"asset", into<&Machine::asset>,
     "The customer's number of the machine; its record is machines/ASSET.toml of the site. "
     "Without it the record is found by maker and serial.",
     an_asset},
    {"maker", into<&Machine::maker>, "Maker of the machine."},
    {"model", into<&Machine::model>, "Model of the machine."},
    {"serial", into<&Machine::serial>, "Serial number of the machine."},
    {"description", into<&Machine::description>,
     "Description of the machine for the certificate: \"gantry milling machine\"."},
    {"condition", into<&Machine::condition>,
     "Condition of the machine for the certificate, if it matters."},
    {"control", into<&Machine::control>,
     "Output plugin that writes the tables of the machine's control. Default: tables for four "
     "controls are written.",
     Named::control},
    {"structure", into<&Machine::structure>,
     "Structure of the machine. The effect of angular errors of its carriages depends on it.",
     structures},
    {"axes", by_names<check_axis, &Machine::axes>,
     "The axes of the machine by their names, [machine.axes.X]. Their numbers in the control are "
     "in the record of the machine.",
     axis_keys, kind_by_name},
};

}  // namespace nonio::config::declared
