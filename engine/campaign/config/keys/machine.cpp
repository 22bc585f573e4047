// SPDX-License-Identifier: Apache-2.0
#include "campaign/config/keys/shared.h"

namespace nonio::config {
namespace declared {

constexpr Range a_limit = above(0.0, "expected a limit above 0");
constexpr Range a_position = within(-1e6, 1e6, "expected a position of at most 1000000 in size");
/// Stores numbers in the settings of the axis, in the unit and under the name of the key; a travel
/// under from_mm and to_mm, or from_deg and to_deg. Controllers receive them in option `axes`.
template <Key::Holds holds>
constexpr Key::Into as_written = by<read_as_written, holds, &RecordedAxis::settings>;
constexpr Choice state_sources[] = {{"stated"}, {"backup"}, {"nonio"}};
template <auto... to>
constexpr Key table_in_control = {"table", into<to..., &ControlState::table>,
                                  "The table in the control: its file below the site, further "
                                  "files of the same table separated by commas; or \"none\"."};
constexpr Key state_keys[] = {
    {"since", day<&ControlState::since>,
     "The day on which table and backlash value were loaded; they apply to measurements of later "
     "days. With source = \"backup\": the first day on which they are known to have been in the "
     "control.",
     required},
    table_in_control<>,
    {"backlash_mm", number_or_0<&ControlState::backlash>,
     "Value of the control's backlash parameter of a linear axis, or \"none\".", mm, some_backlash},
    {"backlash_deg", number_or_0<&ControlState::backlash>,
     "Value of the control's backlash parameter of a rotary axis, or \"none\".", deg,
     some_backlash},
    {"source", into<&ControlState::source>,
     "How the state is known: stated by a person, read from a backup, written by Nonio.",
     otherwise("stated"), state_sources},
    {"sha256", into<&ControlState::sha256>,
     "Digest of the files of the table; if they change, the record is refused."},
    {"grid", span, "First and last position of the table (information only).", mm_or_deg,
     two_numbers},
    {"points", whole, "Number of positions of the table (information only)."},
    {"reference", number, "Position at which the table is zero (information only).", mm_or_deg,
     a_position},
};
constexpr Key recorded_axis_keys[] = {
    {"kind", text,
     "Linear or rotary axis. Default: from the name; A, B and C are rotary (ISO 841).", axis_kinds},
    {"number", as_written<whole>,
     "Number of the axis in the control: n of AXn, controlled axis, joint, motor.",
     within(0, 99, "expected a whole number from 0 to 99")},
    {"name", into<&RecordedAxis::name>, "Name of the axis in the control, if different."},
    {"reference_mm", as_written<number>, "Position of the reference point.", Unit{"mm"}, if_linear,
     a_position},
    {"reference_deg", as_written<number>, "Position of the reference point.", Unit{"deg"},
     if_rotary, a_position},
    {"travel", as_written<span>, "Ends of the travel.", mm_or_deg, two_numbers},
    {"resolution_um", as_written<number>, "Smallest increment of the control.", Unit{"um"},
     if_linear, a_limit},
    {"resolution_arcsec", as_written<number>, "Smallest increment of the control.", Unit{"arcsec"},
     if_rotary, a_limit},
    {"gear", text, "Ratio between motor and screw or table, \"2:1\" (information only)."},
    {"largest_um", as_written<number>, "Largest entry of a table according to the machine's maker.",
     Unit{"um"}, if_linear, a_limit},
    {"largest_arcsec", as_written<number>,
     "Largest entry of a table according to the machine's maker.", Unit{"arcsec"}, if_rotary,
     a_limit},
    {"slope_um_per_m", as_written<number>,
     "Largest slope of a table according to the machine's maker.", Unit{"um/m"}, if_linear,
     a_limit},
    {"slope_arcsec_per_deg", as_written<number>,
     "Largest slope of a table according to the machine's maker.", Unit{"arcsec/deg"}, if_rotary,
     a_limit},
    table_in_control<&RecordedAxis::present>,
    {"backlash_mm", number_or_0<&RecordedAxis::present, &ControlState::backlash>,
     "Value of the control's backlash parameter, or \"none\".", mm, if_linear, some_backlash},
    {"backlash_deg", number_or_0<&RecordedAxis::present, &ControlState::backlash>,
     "Value of the control's backlash parameter, or \"none\".", deg, if_rotary, some_backlash},
    {"since", day<&RecordedAxis::present, &ControlState::since>,
     "The day on which table and backlash value were loaded. They apply only to measurements of "
     "later days."},
    {"state", checked<check_state, &RecordedAxis::states>,
     "Table and backlash value from one day on, [[axes.X.state]]: the history of the control. "
     "`nonio table insert --loaded` adds to it. Each campaign is evaluated with the last state "
     "before its day.",
     state_keys},
};

constexpr Key machine_file_keys[] = {
    required_format,
    {"asset", into<&MachineRecord::asset>,
     "The customer's number of the machine, equal to the name of the file.",
     missing("the name of this file without .toml"), an_asset},
    {"maker", into<&MachineRecord::maker>, "Maker of the machine."},
    {"model", into<&MachineRecord::model>, "Model of the machine."},
    {"serial", into<&MachineRecord::serial>, "Serial number of the machine."},
    {"control", into<&MachineRecord::control>,
     "Output plugin that writes the tables of the machine's control. The numbers of the axes refer "
     "to this control.",
     Named::control},
    {"control_version", into<&MachineRecord::control_version>,
     "Version of the control's software."},
    {"taken", into<&MachineRecord::taken>,
     "Numbers in use in the control, of CEC tables or FANUC's points. New tables use others.",
     spelled({.letters = "0-9-", .not_first = "-", .shortest = 1, .longest = 13},
             "expected numbers or ranges of them, [\"0\", \"100-227\"]")},
    {"axes", checked<check_recorded_axis, &MachineRecord::axes>,
     "The axes of the machine by their names, [axes.X].", recorded_axis_keys, kind_by_name},
};

constexpr Key machine_toml = {"machine.toml", file<MachineRecord>,
                              "Record of a machine, machines/<asset>.toml of a site.",
                              machine_file_keys};

}  // namespace declared

const Key& machine_file() { return declared::machine_toml; }

}  // namespace nonio::config
