// SPDX-License-Identifier: Apache-2.0
// Long: one table, a row a key; a page that shows all of a file is what its reader looks for.
#include "host/config/keys.h"

#include <algorithm>
#include <array>

#include "host/config/formula_units.h"

namespace nonio::host::config {

/// Apart from the rest: `text`, `date` and the like are words that others use too.
namespace declared {

using enum Key::Holds;
using Words = std::string_view;

constexpr Words not_negative = "expected a number that is not negative";
constexpr Words above_0 = "expected a number above 0";
// Beyond these nobody measures: a slip of the unit or of the keyboard.
constexpr Words some_um = "expected a number that is not negative, at most 10000 um";
constexpr Words some_arcsec = "expected a number that is not negative, at most 36000 arcsec";
constexpr Words some_K = "expected a number that is not negative, a difference of at most 60 K";
constexpr Words an_expansion = "expected um/(m K) from -5 to 200, 11.5 for steel";
constexpr Words an_expansion_range = "expected a number that is not negative, at most 100 um/(m K)";
constexpr double most_um = 1e4, most_arcsec = 36000.0, most_K = 60.0, most_mm = 1e6;
constexpr double least_expansion = -5.0, most_expansion = 200.0, most_expansion_range = 100.0;
constexpr Words two_numbers =
    "expected two numbers, the smaller one first, none beyond 1000000 in size";

constexpr Choice structures[] = {{"gantry"}, {"single-column"}, {"bridge"}, {"other"}};
constexpr Choice axis_kinds[] = {{"linear"}, {"rotary"}};
constexpr Words linear[] = {"linear"}, rotary[] = {"rotary"};
constexpr When if_linear{"kind", linear}, if_rotary{"kind", rotary};

constexpr Choice sides[] = {{"master"}, {"slave"}};
constexpr Words axis_runs[] = {"axis"};

constexpr Words some_backlash = "expected a number from -10 to 10, or \"none\"";
constexpr double most_backlash = 10.0;
constexpr Words an_asset =
    "expected up to 100 characters without / and \\, not starting with a point; found \"{}\"";

constexpr Key axis_keys[] = {
    {.name = "kind",
     .holds = text,
     .help = "Linear or rotary axis. Default: from the name; A, B and C are rotary (ISO 841).",
     .choices = axis_kinds},
    {.name = "travel",
     .holds = span,
     .help = "Ends of the travel; targets outside get a finding.",
     .unit = "mm or deg",
     .wanted = two_numbers,
     .least = -most_mm,
     .most = most_mm},
    {.name = "teeth",
     .holds = whole,
     .help = "Periods of the drive or scale per revolution.",
     .only = if_rotary,
     .wanted = above_0,
     .least = 1},
    {.name = "screw_pitch_mm",
     .holds = number,
     .help = "Period of the drive or scale.",
     .unit = "mm",
     .only = if_linear,
     .wanted = "expected a pitch above 0, at most 10000 mm",
     .least = 0.0,
     .most = 1e4,
     .above = true},
    {.name = "fixed_point_mm",
     .holds = number,
     .help = "Position at which screw or scale is fixed and does not move when it expands (the "
             "fixed bearing, the clamp). Default: determined from the readings.",
     .unit = "mm",
     .only = if_linear,
     .wanted = "expected a position within 1000000 mm",
     .least = -most_mm,
     .most = most_mm},
    {.name = "expansion_um_per_m_K",
     .holds = number,
     .help = "Coefficient of thermal expansion of the scale or of the machine.",
     .unit = "um/(m K)",
     .only = if_linear,
     .wanted = an_expansion,
     .least = least_expansion,
     .most = most_expansion},
    {.name = "slave",
     .holds = text,
     .help = "For a gantry axis: name of the control's axis that drives the second side; its "
             "table is made from the measurement with side = \"slave\".",
     .only = if_linear},
    {.name = "table_on",
     .holds = text,
     .help = "The table that was active in the control during the measurement: its file below the "
             "campaign's folder, \"backup/x.ini\", further files of the same table separated by "
             "commas; or \"none\". The new table replaces it. Default: no table was active."},
    {.name = "backlash_on_mm",
     .holds = number_or_none,
     .help = "Value of the control's backlash parameter during the measurement, or \"none\".",
     .unit = "mm",
     .only = if_linear,
     .wanted = some_backlash,
     .least = -most_backlash,
     .most = most_backlash},
    {.name = "backlash_on_deg",
     .holds = number_or_none,
     .help = "Value of the control's backlash parameter during the measurement, or \"none\".",
     .unit = "deg",
     .only = if_rotary,
     .wanted = some_backlash,
     .least = -most_backlash,
     .most = most_backlash},
    {.name = "tolerance_um",
     .holds = number_table,
     .help = "Upper limits of results by their names, { A = 15.0, \"R+\" = 6.0 }.",
     .unit = "um",
     .only = if_linear,
     .wanted = "expected a tolerance above 0",
     .least = 0.0,
     .above = true},
    {.name = "tolerance_arcsec",
     .holds = number_table,
     .help = "Upper limits of results by their names, { A = 8.0, \"R+\" = 3.0 }.",
     .unit = "arcsec",
     .only = if_rotary,
     .wanted = "expected a tolerance above 0",
     .least = 0.0,
     .above = true},
};

constexpr Key machine_keys[] = {
    {.name = "asset",
     .holds = text,
     .help = "The customer's number of the machine; its record is machines/<asset>.toml of the "
             "site. Without it the record is found by maker and serial.",
     .wanted = an_asset,
     .text = asset_rule},
    {.name = "maker", .holds = text, .help = "Maker of the machine."},
    {.name = "model", .holds = text, .help = "Model of the machine."},
    {.name = "serial", .holds = text, .help = "Serial number of the machine."},
    {.name = "description",
     .holds = text,
     .help = "Description of the machine for the certificate: \"gantry milling machine\"."},
    {.name = "condition",
     .holds = text,
     .help = "Condition of the machine for the certificate, if it matters."},
    {.name = "control",
     .holds = text,
     .help = "Output plugin that writes the tables of the machine's control. Default: tables "
             "for four controls are written.",
     .named = Named::control},
    {.name = "structure",
     .holds = text,
     .help = "Structure of the machine. The effect of angular errors of its carriages depends "
             "on it.",
     .choices = structures},
    {.name = "axes",
     .holds = named_tables,
     .help = "The axes of the machine by their names, [machine.axes.X]. Their numbers in the "
             "control are in the record of the machine.",
     .keys = axis_keys,
     .initials = "ABC",
     .by_name = "kind",
     .named_so = "rotary"},
};

constexpr Choice purposes[] = {{"periodic"}, {"acceptance"}, {"after-repair"}, {"check"}};

constexpr Key campaign_keys[] = {
    {.name = "id",
     .holds = text,
     .help = "Name of the campaign, unique in the site: a-z 0-9 . _ -, at most 100.",
     .required = true,
     .wanted = "expected a-z 0-9 . _ - and no more than 100, not starting with a point; found "
               "\"{}\"",
     .text = campaign_id_rule},
    {.name = "customer", .holds = text, .help = "Name of the customer."},
    {.name = "site", .holds = text, .help = "Location of the machine."},
    {.name = "operator", .holds = text, .help = "Name of the operator."},
    {.name = "customer_address",
     .holds = text,
     .help = "Address or contact of the customer, for the certificate."},
    {.name = "date", .holds = date, .help = "Day of the measurements, or the first of them."},
    {.name = "end_date",
     .holds = date,
     .help = "Last day of the measurements, if there was more than one."},
    {.name = "received",
     .holds = date,
     .help = "Day on which the item was received, for the "
             "certificate."},
    {.name = "purpose",
     .holds = text,
     .help = "Reason for the measurements. Checks are a series of their own in the machine's "
             "history; the other reasons are shown in it.",
     .otherwise = "periodic",
     .choices = purposes},
};

constexpr Key instrument_keys[] = {
    {.name = "maker", .holds = text, .help = "Maker of the measuring instrument."},
    {.name = "model", .holds = text, .help = "Model of the measuring instrument."},
    {.name = "serial", .holds = text, .help = "Serial number of the measuring instrument."},
    {.name = "calibrated",
     .holds = date,
     .help = "Day on which the measuring instrument was calibrated."},
    {.name = "certificate",
     .holds = text,
     .help = "Number of the calibration certificate of the measuring instrument."},
    {.name = "issuer",
     .holds = text,
     .help = "Laboratory that issued the calibration certificate of the measuring instrument."},
    {.name = "valid_until",
     .holds = date,
     .help = "Last day on which the calibration is valid. Default: two years after it. A "
             "certificate requires a valid calibration on the day of the measurement."},
    {.name = "U_fixed_um",
     .holds = number,
     .help = "Expanded uncertainty (k = 2) of the instrument: the part that does not depend on "
             "the length.",
     .unit = "um",
     .wanted = some_um,
     .least = 0.0,
     .most = most_um},
    {.name = "U_per_m_um",
     .holds = number,
     .help = "Expanded uncertainty (k = 2) of the instrument: the part per metre of length.",
     .unit = "um",
     .wanted = some_um,
     .least = 0.0,
     .most = most_um},
    {.name = "U_arcsec",
     .holds = number,
     .help = "Expanded uncertainty (k = 2) of the instrument for angles.",
     .unit = "arcsec",
     .wanted = some_arcsec,
     .least = 0.0,
     .most = most_arcsec},
    {.name = "sphere_um",
     .holds = number,
     .help = "Range of the form error of the probed ball.",
     .unit = "um",
     .wanted = some_um,
     .least = 0.0,
     .most = most_um},
    {.name = "probe_um",
     .holds = number,
     .help = "Range of the probe's contribution to a centre: form of its tip, pre-travel.",
     .unit = "um",
     .wanted = some_um,
     .least = 0.0,
     .most = most_um},
    {.name = "expansion_um_per_m_K",
     .holds = number,
     .help = "Coefficient of thermal expansion of a material measure (scale, step gauge). "
             "Without it the instrument is a laser, whose U_per_m_um includes the air.",
     .unit = "um/(m K)",
     .wanted = an_expansion,
     .least = least_expansion,
     .most = most_expansion},
    {.name = "temperature_range_K",
     .holds = number,
     .help = "Range of the reading error of the instrument's temperature.",
     .unit = "K",
     .wanted = some_K,
     .least = 0.0,
     .most = most_K},
    {.name = "expansion_range_um_per_m_K",
     .holds = number,
     .help = "Range of the instrument's coefficient of thermal expansion.",
     .unit = "um/(m K)",
     .wanted = an_expansion_range,
     .least = 0.0,
     .most = most_expansion_range},
};

constexpr Choice measured_by_sensor[] = {{"material"}, {"air"}, {"pressure"}, {"humidity"}};

constexpr Key sensor_keys[] = {
    {.name = "measures",
     .holds = text,
     .help = "What the sensor measures: temperature of the machine's material or of the air, "
             "pressure, humidity.",
     .required = true,
     .choices = measured_by_sensor},
    {.name = "maker", .holds = text, .help = "Maker of the sensor."},
    {.name = "model", .holds = text, .help = "Model of the sensor."},
    {.name = "serial", .holds = text, .help = "Serial number of the sensor."},
    {.name = "calibrated", .holds = date, .help = "Day on which the sensor was calibrated."},
    {.name = "valid_until",
     .holds = date,
     .help = "Last day on which the calibration is valid. Default: two years after it."},
    {.name = "certificate",
     .holds = text,
     .help = "Number of the calibration certificate of the sensor."},
    {.name = "issuer", .holds = text, .help = "Laboratory that issued the certificate."},
};

constexpr Key square_keys[] = {
    {.name = "id",
     .holds = text,
     .help = "Name by which the measurements on its faces refer to the square.",
     .required = true,
     .missing = "a name"},
    {.name = "error_urad",
     .holds = number,
     .help = "Deviation of the angle between its faces from 90 degrees, as its certificate states "
             "it; positive: more than 90 degrees.",
     .unit = "urad"},
    {.name = "U_urad",
     .holds = number,
     .help = "Expanded uncertainty of error_urad, k = 2.",
     .unit = "urad",
     .wanted = "expected an uncertainty above 0",
     .least = 1e-6},
};

constexpr Key environment_keys[] = {
    {.name = "misalignment_mm",
     .holds = number,
     .help = "Largest lateral distance between beam and axis over the travel.",
     .unit = "mm",
     .wanted = "expected a number that is not negative, at most 10000 mm",
     .least = 0.0,
     .most = 1e4},
    {.name = "temperature_range_K",
     .holds = number,
     .help = "Range of the reading error of the machine's temperature.",
     .unit = "K",
     .wanted = some_K,
     .least = 0.0,
     .most = most_K},
    {.name = "temperature_difference_K",
     .holds = number,
     .help = "Largest difference of the machine's temperature from 20 degC.",
     .unit = "K",
     .wanted = some_K,
     .least = 0.0,
     .most = most_K},
    {.name = "expansion_range_um_per_m_K",
     .holds = number,
     .help = "Range of the coefficient of thermal expansion.",
     .unit = "um/(m K)",
     .wanted = an_expansion_range,
     .least = 0.0,
     .most = most_expansion_range},
    {.name = "drift_um",
     .holds = number,
     .help = "Range of the drift test with the axis at rest.",
     .unit = "um",
     .wanted = some_um,
     .least = 0.0,
     .most = most_um},
    {.name = "drift_arcsec",
     .holds = number,
     .help = "Range of the drift test with the rotary axis at rest.",
     .unit = "arcsec",
     .wanted = some_arcsec,
     .least = 0.0,
     .most = most_arcsec},
    {.name = "warm_up",
     .holds = text,
     .help = "Warm-up of the machine before the test, for the certificate: \"30 min at half "
             "feed\"."},
    {.name = "sensors",
     .holds = text,
     .help = "Positions of the temperature sensors, for the certificate."},
    {.name = "drift_minutes",
     .holds = number,
     .help = "Duration of the drift test; for a longer measurement the drift is scaled up.",
     .unit = "min",
     .wanted = "expected a number above 0",
     .least = 0.0,
     .above = true},
};

constexpr Choice measurement_kinds[] = {{"axis"},         {"straightness"},  {"angle"},
                                        {"diagonal"},     {"step-diagonal"}, {"ball-centres"},
                                        {"observations"}, {"ballbar"}};
constexpr Choice on_or_off[] = {{"on"}, {"off"}};
constexpr Choice adjustments[] = {{"before"}, {"after"}};
constexpr Choice listed_orders[] = {{"pendulum"}, {"as-listed"}, {"unknown"}};
constexpr Choice linear_axes[] = {{"X"}, {"Y"}, {"Z"}};
constexpr Words of_one_axis[] = {"axis", "straightness", "angle", "ball-centres"};
constexpr Words straightness[] = {"straightness"}, angle[] = {"angle"};
constexpr Words diagonals[] = {"diagonal", "step-diagonal"};
constexpr Words an_end = "the axis positions of that end, { X = 0, Y = 0 }";

constexpr Key measurement_keys[] = {
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
     .help = "The axis that moves, or the rotary axis with the measured balls.",
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

constexpr auto unit_choices = [] {
  std::array<Choice, formula_units.size()> choices{};
  for (std::size_t i = 0; i < choices.size(); ++i)
    choices[i] = {formula_units[i].symbol(), formula_units[i].words};
  return choices;
}();

constexpr Key parameter_keys[] = {
    {.name = "name",
     .holds = text,
     .help = "Name of the parameter in the expression.",
     .required = true},
    {.name = "unit",
     .holds = text,
     .help = "Unit of the parameter.",
     .required = true,
     .missing = "expected one of {}",
     .choices = unit_choices},
    {.name = "start",
     .holds = number,
     .help = "Start value of the search, in the parameter's unit; required with range."},
    {.name = "range",
     .holds = span,
     .help = "Range of the search, two values in the parameter's unit. Without start and range "
             "the parameter must enter linearly and is fitted.",
     .wanted = two_numbers},
};

constexpr Key formula_keys[] = {
    {.name = "name",
     .holds = text,
     .help = "Name of the effect, up to 40 of a-z 0-9 -; [model] effects lists it as name:axis.",
     .required = true,
     .wanted = "expected up to 40 of a-z 0-9 -; found \"{}\"",
     .text = {.letters = "a-z0-9-", .longest = 40}},
    {.name = "axis", .holds = text, .help = "The axis of the deviation.", .required = true},
    {.name = "expression",
     .holds = text,
     .help = "The deviation as a formula, \"a*sin(2*_pi*p/P)\".",
     .required = true},
    {.name = "parameters",
     .holds = tables,
     .help = "The parameters of the expression, 12 at most.",
     .required = true,
     .missing = "[{ name = \"a\", unit = \"um\" }], one at least",
     .wanted = "expected 12 parameters at most, found {}",
     .longest_list = 12,
     .keys = parameter_keys},
};

constexpr Choice compensated[] = {{"readings"}, {"model"}};

constexpr Key model_keys[] = {
    {.name = "effects",
     .holds = texts,
     .help = "Effects of the machine's error model, \"kind:axis\"; `nonio model add` and `drop` "
             "edit the list.",
     .named = Named::effect},
    {.name = "compensate",
     .holds = text,
     .help = "Basis of tables: the means of the readings, or the compensable effects of the "
             "model, without drift and noise.",
     .otherwise = "readings",
     .choices = compensated},
    {.name = "formula",
     .holds = tables,
     .help = "Your own effect, as a formula.",
     .keys = formula_keys},
};

constexpr Key run_keys[] = {
    {.name = "analyses",
     .holds = texts,
     .help = "Analyses of the campaign. Default: all that apply, except those on request.",
     .named = Named::analysis},
    {.name = "outputs",
     .holds = texts,
     .help = "Outputs of the campaign. Default: all that apply, except those on request.",
     .named = Named::output},
};

constexpr Choice locations[] = {
    {"laboratory"}, {"customer"}, {"laboratoryBranch"}, {"customerBranch"}, {"other"}};
constexpr Choice decision_rules[] = {{"iso14253-1", "in between undecided"},
                                     {"ilac-g8-simple", "simple acceptance"},
                                     {"ilac-g8-guarded", "guard band w = U"}};

constexpr TextRule language = {.letters = "a-z", .shortest = 2, .longest = 2};
constexpr Key languages_key = {.name = "languages",
                               .holds = texts,
                               .help =
                                   "One or two languages of the certificate: de, en, es, it, "
                                   "zh. Default: en.",
                               .wanted = "expected one or two languages, [\"it\", \"en\"]",
                               .text = language,
                               .longest_list = 2,
                               .distinct = true};
constexpr Key template_key = {
    .name = "template",
    .holds = text,
    .help = "Template of the certificate: a file in templates/, without .toml.",
    .otherwise = "certificate",
    .wanted = "expected the name of a file in templates/, without .toml",
    .text = {.letters = "a-z0-9_-"}};
constexpr Key location_key = {.name = "location",
                              .holds = text,
                              .help = "Place of the calibration.",
                              .otherwise = "customer",
                              .choices = locations};
constexpr Key procedure_key = {.name = "procedure",
                               .holds = text,
                               .help =
                                   "The laboratory's own procedure, in addition to the "
                                   "standards."};
constexpr Key title_key = {
    .name = "title",
    .holds = translations,
    .help =
        "Title of the certificate: a text, or texts by language, { it = \"...\", en = "
        "\"...\" }.",
    .wanted = "expected a text, or texts by language, { it = \"...\", en = \"...\" }",
    .text = language};
constexpr Key decision_rule_key = {.name = "decision_rule",
                                   .holds = text,
                                   .help = "The decision rule for conformity with a tolerance.",
                                   .otherwise = "iso14253-1",
                                   .choices = decision_rules};

constexpr Key certificate_of_campaign[] = {
    languages_key,
    template_key,
    location_key,
    procedure_key,
    title_key,
    decision_rule_key,
    {.name = "deviations",
     .holds = text,
     .help = "Additions to the method, deviations from it and exclusions, in addition to those "
             "that the program finds."},
    {.name = "nothing_else_by",
     .holds = text,
     .help = "The person who states that, apart from the departures listed in the certificate, the "
             "method was followed. Without it no such statement is printed."},
    {.name = "conditions",
     .holds = text,
     .help = "Conditions that influence the results; required if no readings have temperatures."},
    {.name = "opinions",
     .holds = text,
     .help = "Opinions and interpretations; the certificate marks them as such."},
    {.name = "amendment",
     .holds = text,
     .help = "Reason why an earlier certificate is "
             "replaced."},
    {.name = "customer_data",
     .holds = texts,
     .help = "Keys of this file with values stated by the customer, [\"machine.serial\"]; the "
             "certificate marks them."},
};

constexpr Choice releases[] = {{"by-hand", "a person, with nonio release"},
                               {"automatic", "the night, by the rules of may_stand"}};

constexpr Key standing_keys[] = {
    {.name = "finding",
     .holds = text,
     .help = "Id of a finding, \"plan.few-runs\"; with \".*\" at its end a group of findings.",
     .required = true,
     .missing = "expected the id of a finding",
     .wanted = "expected the id of a finding, or of a kind, \"tolerance.*\"; found \"{}\"",
     .text = {.letters = "a-zA-Z0-9.*+_-"}},
    {.name = "reason",
     .holds = text,
     .help = "Reason why a certificate may be issued in spite of the finding; kept in the "
             "register.",
     .required = true,
     .missing = "expected why a certificate may be issued although the finding is there"},
};

constexpr Key certificate_of_site[] = {
    languages_key,
    template_key,
    location_key,
    procedure_key,
    title_key,
    decision_rule_key,
    {.name = "numbering",
     .holds = text,
     .help = "Format of the certificate numbers; with {year} the sequence restarts each year.",
     .otherwise = "{year}-{number:4}"},
    {.name = "register",
     .holds = text,
     .help = "File inside the site with all numbers and issued files; include it in the backup.",
     .otherwise = "certificates.sqlite"},
    {.name = "register_seconds",
     .holds = number,
     .help = "Waiting time for a register that another process has locked. Campaigns that "
             "still need a number are evaluated again in the next night.",
     .unit = "s",
     .otherwise = "60",
     .wanted = "expected a number from 0 to 86400",
     .least = 0.0,
     .most = 86400.0},
    {.name = "release",
     .holds = text,
     .help = "Release of certificates: by a person, or by the nightly run if every finding "
             "with severity attention is listed in may_stand.",
     .otherwise = "by-hand",
     .choices = releases},
    {.name = "may_stand",
     .holds = tables,
     .help = "Findings with severity attention that do not prevent an automatic release, each "
             "with the reason; [] for none.",
     .keys = standing_keys},
    {.name = "two_persons",
     .holds = flag,
     .help = "The author approves a certificate, and another person releases it.",
     .otherwise = "false"},
};

constexpr Key format_key = {.name = "format",
                            .holds = whole,
                            .help = "Version of this format.",
                            .wanted =
                                "expected 1, found {}: this file is for another version of "
                                "nonio",
                            .least = 1,
                            .most = 1};
constexpr Key required_format() {
  Key key = format_key;
  key.required = true;
  key.missing = "expected format = 1 as the first line";
  return key;
}
constexpr Key run_key = {
    .name = "run", .holds = table, .help = "Selected analyses and outputs.", .keys = run_keys};
constexpr Key options_key = {.name = "options",
                             .holds = options,
                             .help =
                                 "Options of plugins, [options.iso230-2]; `nonio plugins` "
                                 "lists them."};

constexpr Key table_standing_keys[] = {
    {.name = "finding",
     .holds = text,
     .help = "Id of a finding that makes readings implausible, "
             "\"plausibility.passes-identical\".",
     .required = true,
     .missing = "expected the id of a finding",
     .wanted = "expected the id of a finding, \"plausibility.passes-identical\"; found \"{}\"",
     .text = {.letters = "a-z.-", .begins = "plausibility."}},
    {.name = "reason",
     .holds = text,
     .help = "Reason why tables may be written from these readings.",
     .required = true,
     .missing = "expected why a table may be written although the finding is there"},
};

constexpr Key tables_keys[] = {
    {.name = "may_stand",
     .holds = tables,
     .help = "Findings plausibility.* that do not prevent controller tables, each with the "
             "reason.",
     .keys = table_standing_keys},
};

constexpr Key campaign_file_keys[] = {
    required_format(),
    {.name = "campaign",
     .holds = table,
     .help = "Customer, place, operator and date.",
     .required = true,
     .missing = "[campaign] with at least an id",
     .keys = campaign_keys},
    {.name = "machine", .holds = table, .help = "The measured machine.", .keys = machine_keys},
    {.name = "instrument",
     .holds = table,
     .help = "The measuring instrument.",
     .keys = instrument_keys},
    {.name = "sensor",
     .holds = tables,
     .help = "A sensor of temperature, pressure or humidity: a separate instrument with its "
             "own calibration.",
     .keys = sensor_keys},
    {.name = "square",
     .holds = tables,
     .help = "A square against whose faces two axes were read.",
     .keys = square_keys},
    {.name = "environment",
     .holds = table,
     .help = "Contributions to the uncertainty other than the instrument, as full ranges "
             "(ISO/TR 230-9).",
     .keys = environment_keys},
    {.name = "certificate",
     .holds = table,
     .help = "Settings and texts of this campaign's certificate.",
     .keys = certificate_of_campaign},
    run_key,
    {.name = "measurement",
     .holds = tables,
     .help = "A file of readings. At least one, unless [run] names analyses and outputs (a "
             "campaign that only plans).",
     .keys = measurement_keys},
    {.name = "model",
     .holds = table,
     .help = "The error model of the machine as it stands.",
     .keys = model_keys},
    {.name = "tables",
     .holds = table,
     .help = "Controller tables from implausible readings.",
     .keys = tables_keys},
    options_key,
};

constexpr Key cmc_keys[] = {
    {.name = "fixed_um",
     .holds = number,
     .help = "The part a of a + b L.",
     .unit = "um",
     .wanted = not_negative,
     .least = 0.0},
    {.name = "per_m_um",
     .holds = number,
     .help = "The part b of a + b L, per metre of length.",
     .unit = "um",
     .wanted = not_negative,
     .least = 0.0},
    {.name = "arcsec",
     .holds = number,
     .help = "The smallest uncertainty of angles: rotary axes, squareness, directions.",
     .unit = "arcsec",
     .wanted = not_negative,
     .least = 0.0},
};

constexpr Key laboratory_keys[] = {
    {.name = "name", .holds = text, .help = "Name of the laboratory."},
    {.name = "address", .holds = text, .help = "Address of the laboratory."},
    {.name = "country", .holds = text, .help = "Country of the laboratory, two letters: \"IT\"."},
    {.name = "accreditation",
     .holds = text,
     .help = "Number of the accreditation; for accredited laboratories only."},
    {.name = "authoriser",
     .holds = text,
     .help = "Name of the person who authorises "
             "certificates."},
    {.name = "contact", .holds = text, .help = "Contact of the laboratory."},
    {.name = "cmc",
     .holds = table,
     .help = "The smallest expanded uncertainty (k = 2) that the accreditation covers, a + b L: no "
             "result gets a smaller one.",
     .keys = cmc_keys},
};

constexpr Key limits_keys[] = {
    {.name = "seconds",
     .holds = number,
     .help = "Time limit for one campaign.",
     .unit = "s",
     .otherwise = "600",
     .wanted = "expected a number above 0 and at most 1000000",
     .least = 0.0,
     .most = 1e6,
     .above = true},
    {.name = "memory_MB",
     .holds = number,
     .help = "Memory limit for one campaign.",
     .unit = "MB",
     .otherwise = "4096",
     .wanted = "expected 64 or more, and at most 1000000000",
     .least = 64.0,
     .most = 1e9},
    {.name = "disk_seconds",
     .holds = number,
     .help = "Time without a response after which a folder or file of the site counts as failed "
             "during the survey.",
     .unit = "s",
     .otherwise = "60",
     .wanted = "expected a number above 0 and at most 1000000",
     .least = 0.0,
     .most = 1e6,
     .above = true},
    {.name = "vanished",
     .holds = whole,
     .help = "Number of campaigns of the night before that may be missing; with more of them the "
             "exit status is 1. Record campaigns removed on purpose with `nonio forget`.",
     .otherwise = "0"},
};

constexpr Key alias_keys[] = {
    {.name = "name",
     .holds = text,
     .help = "Name of a machine in campaigns: an asset, or maker and serial with a space between "
             "them.",
     .required = true},
    {.name = "asset",
     .holds = text,
     .help = "The same machine as `nonio query` names it.",
     .required = true},
    {.name = "why", .holds = text, .help = "Evidence for it.", .required = true},
};

constexpr Key database_keys[] = {
    {.name = "url",
     .holds = text,
     .help = "The PostgreSQL database that keeps the history in place of OUT/history.sqlite, "
             "postgresql://user@host/name?sslmode=verify-full, as libpq reads it; without a "
             "password.",
     .required = true,
     .wanted = "expected postgresql://user@host/name",
     .may_be_secret = true,
     .text = {.begins = "postgresql://"}},
    {.name = "password_file",
     .holds = text,
     .help = "File with the password, for its owner alone (chmod 600). Default: as libpq finds it: "
             "service, ~/.pgpass, PGPASSFILE, PGPASSWORD."},
    {.name = "schema",
     .holds = text,
     .help = "Schema of this site's tables; each site of a database has its own.",
     .otherwise = "nonio",
     .wanted = "expected 1 to 63 characters of a-z, 0-9 and _, not starting with a digit, found "
               "\"{}\"",
     .text = {.letters = "a-z0-9_", .not_first = "0123456789", .longest = 63}},
};

constexpr Key due_keys[] = {
    {.name = "machine",
     .holds = text,
     .help = "The machine for which it holds, as `nonio query` calls it; without it for all that "
             "no other says."},
    {.name = "months",
     .holds = whole,
     .help = "From the last campaign to the next.",
     .required = true,
     .wanted = "expected 1 to 240 months",
     .least = 1,
     .most = 240},
};

constexpr Choice result_folders[] = {{"flat", "OUT/<id>"}, {"hashed", "OUT/ab/<id>"}};

constexpr Key results_keys[] = {
    {.name = "folders",
     .holds = text,
     .help = "Layout of the output folder: each campaign in OUT/<id>, or in OUT/ab/<id>, where ab "
             "are the first two digits of the SHA-256 of the id; for sites with a million "
             "campaigns.",
     .otherwise = "flat",
     .choices = result_folders},
};

constexpr Choice fail_or_sign[] = {{"fail"}, {"sign"}};

constexpr Key signing_keys[] = {
    {.name = "pkcs12",
     .holds = text,
     .help = "The key as a file, relative to the site; alternative to pkcs11."},
    {.name = "pkcs11",
     .holds = text,
     .help = "The key on a token, \"pkcs11:token=lab;object=calib\"; alternative to pkcs12."},
    {.name = "module", .holds = text, .help = "PKCS#11 library of the token."},
    {.name = "certificates", .holds = text, .help = "PEM file with the intermediate certificates."},
    {.name = "password_file",
     .holds = text,
     .help = "File with the password; alternative to password_env and password_credential."},
    {.name = "password_env", .holds = text, .help = "Environment variable with the password."},
    {.name = "password_credential",
     .holds = text,
     .help = "Credential of systemd with the password."},
    {.name = "trust",
     .holds = text,
     .help = "PEM file with roots, for time stamps and for `nonio verify`."},
    {.name = "revocation",
     .holds = text,
     .help = "PEM file with revocation lists, for `nonio verify`."},
    {.name = "signer",
     .holds = text,
     .help = "Signer that `nonio verify` expects: subject, or SHA-256 of the certificate."},
    {.name = "time_stamp",
     .holds = text,
     .help = "Address of a time-stamp server, http://...",
     .wanted = "expected http://..., found \"{}\" (a time stamp is signed; it needs no https)",
     .text = {.begins = "http://"}},
    {.name = "time_stamp_missing",
     .holds = text,
     .help = "Behaviour if the time-stamp server does not answer: the campaign fails, or the "
             "certificate is signed without time stamp, and the summary says so.",
     .otherwise = "fail",
     .choices = fail_or_sign},
    {.name = "time_stamp_seconds",
     .holds = whole,
     .help = "Time limit for the time-stamp server.",
     .unit = "s",
     .otherwise = "10",
     .wanted = "expected 1 to 300",
     .least = 1,
     .most = 300},
};

constexpr TextRule address_rule{
    .not_letters = " \t\r\n,;<>\"\\", .not_first = "-.@", .longest = 250};
constexpr Words address_wanted = "expected an address, found \"{}\"";

constexpr Choice mail_reasons[] = {
    {"lost"}, {"out", "what is lost or out of tolerance"}, {"decision", "whatever is new"}};
constexpr Choice mail_tls[] = {
    {"starttls", "port 587"}, {"tls", "port 465"}, {"none", "port 25, no password"}};

constexpr Key mail_keys[] = {
    {.name = "to",
     .holds = texts,
     .help = "Addresses that get it.",
     .required = true,
     .wanted = "expected addresses without spaces, commas and brackets",
     .text = address_rule,
     .longest_list = 50,
     .distinct = true},
    {.name = "from",
     .holds = text,
     .help = "Address of the sender.",
     .required = true,
     .wanted = address_wanted,
     .text = address_rule},
    {.name = "on",
     .holds = text,
     .help = "From what on a night writes: a campaign is lost or failed; or a machine is out of "
             "tolerance; or any line asks for a decision.",
     .otherwise = "decision",
     .choices = mail_reasons},
    {.name = "sendmail",
     .holds = text,
     .help = "Program that takes the mail, with its whole path; alternative to smtp.",
     .wanted = "expected a path that begins with /, found \"{}\"",
     .text = {.begins = "/"}},
    {.name = "smtp",
     .holds = text,
     .help = "Name of the mail server; alternative to sendmail.",
     .wanted = "expected the name of a server, found \"{}\"",
     .text = {.letters = "a-zA-Z0-9.:_-", .not_first = "-.", .longest = 250}},
    {.name = "tls",
     .holds = text,
     .help = "Encryption of the way to the server: begun with STARTTLS, from the first byte, or "
             "none.",
     .otherwise = "starttls",
     .choices = mail_tls},
    {.name = "port",
     .holds = whole,
     .help = "Port of the server; by tls 587, 465 or 25.",
     .wanted = "expected 1 to 65535",
     .least = 1,
     .most = 65535},
    {.name = "trust",
     .holds = text,
     .help = "PEM file with the roots that the server's certificate must come from; without it "
             "those of the system."},
    {.name = "user",
     .holds = text,
     .help = "Name at the server; without it the mail is sent without a login."},
    {.name = "password_file",
     .holds = text,
     .help = "File with the password; alternative to password_env and password_credential."},
    {.name = "password_env", .holds = text, .help = "Environment variable with the password."},
    {.name = "password_credential",
     .holds = text,
     .help = "Credential of systemd with the password."},
};

constexpr Choice terminal_languages[] = {{"de"}, {"en"}, {"it"}};

constexpr Key site_file_keys[] = {
    format_key,
    {.name = "language",
     .holds = text,
     .help = "Language of the terminal and of summary.txt. JSON, --help and error messages are "
             "English.",
     .otherwise = "en",
     .choices = terminal_languages},
    {.name = "laboratory",
     .holds = table,
     .help = "The calibration laboratory.",
     .keys = laboratory_keys},
    {.name = "limits", .holds = table, .help = "Limits for one campaign.", .keys = limits_keys},
    {.name = "results",
     .holds = table,
     .help = "Layout of the output folder.",
     .keys = results_keys},
    run_key,
    options_key,
    {.name = "alias",
     .holds = tables,
     .help = "Two names of one machine, [[alias]]: its campaigns form one history.",
     .keys = alias_keys},
    {.name = "due",
     .holds = tables,
     .help = "When machines are measured again, [[due]].",
     .keys = due_keys},
    {.name = "signing",
     .holds = table,
     .help = "Key and time stamps for signed certificates.",
     .keys = signing_keys},
    {.name = "mail",
     .holds = table,
     .help = "Mail of the nightly run, only when something asks for it.",
     .keys = mail_keys},
    {.name = "certificate",
     .holds = table,
     .help = "Content and numbering of certificates.",
     .keys = certificate_of_site},
    {.name = "database",
     .holds = table,
     .help = "A PostgreSQL server for the history.",
     .keys = database_keys},
};

constexpr Words from_0 = "expected a number from 0";
constexpr When linear_cycle{cycle_axis, linear}, rotary_cycle{cycle_axis, rotary};

constexpr Key misreading_keys[] = {
    {.name = "fraction",
     .holds = number,
     .help = "Share of the readings that are misread.",
     .wanted = from_0,
     .least = 0.0},
    {.name = "size", .holds = numbers, .help = "Range of a misreading, times the noise."},
};

constexpr Key temperature_keys[] = {
    {.name = "start_c", .holds = number, .help = "Temperature at the start.", .unit = "degC"},
    {.name = "drift_K_per_h", .holds = number, .help = "Drift.", .unit = "K/h"},
    {.name = "swing_K", .holds = number, .help = "Amplitude of the swing.", .unit = "K"},
    {.name = "period_s",
     .holds = number,
     .help = "Period of the swing.",
     .unit = "s",
     .wanted = above_0,
     .least = 0.0,
     .above = true},
};

constexpr Choice orders[] = {{"pendulum"}, {"unidirectional"}};
constexpr Choice directions[] = {{"+"}, {"-"}};

/// A key of a linear axis' cycle, and that of a rotary one.
constexpr Key of_axis(Key key, std::string_view unit) {
  key.unit = unit;
  key.only = unit.starts_with("mm") || unit == "um" ? linear_cycle : rotary_cycle;
  return key;
}
constexpr Key feed(std::string_view name) {
  return {.name = name,
          .holds = number,
          .help = "Feed to the next target.",
          .wanted = above_0,
          .least = 0.0,
          .above = true};
}
constexpr Key noise(std::string_view name) {
  return {.name = name,
          .holds = number,
          .help = "Standard deviation of a reading.",
          .wanted = from_0,
          .least = 0.0};
}

constexpr Key cycle_keys[] = {
    {.name = "measurement",
     .holds = text,
     .help = "Id of the simulated measurement.",
     .required = true},
    of_axis({.name = "targets_mm", .holds = numbers, .help = "Targets, ascending."}, "mm"),
    of_axis({.name = "targets_deg", .holds = numbers, .help = "Targets, ascending."}, "deg"),
    of_axis({.name = "from_mm", .holds = number, .help = "First target."}, "mm"),
    of_axis({.name = "from_deg", .holds = number, .help = "First target."}, "deg"),
    of_axis({.name = "to_mm", .holds = number, .help = "End of the targets."}, "mm"),
    of_axis({.name = "to_deg", .holds = number, .help = "End of the targets."}, "deg"),
    of_axis({.name = "step_mm", .holds = number, .help = "Distance of targets."}, "mm"),
    of_axis({.name = "step_deg", .holds = number, .help = "Distance of targets."}, "deg"),
    {.name = "random_offset_pct",
     .holds = number,
     .help = "Largest shift of a target, as a part of the step.",
     .unit = "%",
     .wanted = from_0,
     .least = 0.0},
    {.name = "order",
     .holds = text,
     .help = "Each run upwards and then downwards, or all runs in one direction.",
     .choices = orders},
    {.name = "direction",
     .holds = text,
     .help = "Direction of unidirectional runs.",
     .choices = directions},
    {.name = "runs",
     .holds = whole,
     .help = "Number of runs.",
     .wanted = "expected 1 to 100000",
     .least = 1,
     .most = 100000},
    of_axis(feed("feed_mm_per_min"), "mm/min"),
    of_axis(feed("feed_deg_per_min"), "deg/min"),
    {.name = "dwell_s",
     .holds = number,
     .help = "Dwell at a target.",
     .unit = "s",
     .wanted = from_0,
     .least = 0.0},
    {.name = "pause_s",
     .holds = number,
     .help = "Pause before each further run.",
     .unit = "s",
     .wanted = from_0,
     .least = 0.0},
    {.name = "times", .holds = flag, .help = "Whether the file has times."},
    of_axis(noise("noise_um"), "um"),
    of_axis(noise("noise_arcsec"), "arcsec"),
    {.name = "misreadings", .holds = table, .help = "Misreadings.", .keys = misreading_keys},
    {.name = "temperature",
     .holds = table,
     .help = "Temperature over time.",
     .keys = temperature_keys},
};

constexpr Key simulation_keys[] = {
    {.name = "seed", .holds = whole, .help = "The same seed gives the same readings."},
    {.name = "formula",
     .holds = tables,
     .help = "A hidden effect, as a formula.",
     .keys = formula_keys},
};

/// The others are parameters of the effect that it names.
constexpr Key effect_keys[] = {
    {.name = "name", .holds = text, .help = "The effect, \"kind:axis\".", .required = true},
};

constexpr Key specification_keys[] = {
    {.name = "simulation",
     .holds = table,
     .help = "Seed and hidden formulas.",
     .required = true,
     .missing = "[simulation] with a seed",
     .keys = simulation_keys},
    {.name = "cycle", .holds = tables, .help = "Test cycle of a measurement.", .keys = cycle_keys},
    {.name = "effect", .holds = tables, .help = "A known effect.", .keys = effect_keys},
};

constexpr Words a_limit = "expected a limit above 0";
constexpr Words a_position = "expected a position of at most 1000000 in size";
constexpr Words taken_numbers = "expected numbers or ranges of them, [\"0\", \"100-227\"]";

constexpr Key recorded_axis_keys[] = {
    {.name = "kind",
     .holds = text,
     .help = "Linear or rotary axis. Default: from the name; A, B and C are rotary (ISO 841).",
     .choices = axis_kinds},
    {.name = "number",
     .holds = whole,
     .help = "Number of the axis in the control: n of AXn, controlled axis, joint, motor.",
     .wanted = "expected a whole number from 0 to 99",
     .least = 0,
     .most = 99},
    {.name = "name", .holds = text, .help = "Name of the axis in the control, if different."},
    {.name = "reference_mm",
     .holds = number,
     .help = "Position of the reference point.",
     .unit = "mm",
     .only = if_linear,
     .wanted = a_position,
     .least = -most_mm,
     .most = most_mm},
    {.name = "reference_deg",
     .holds = number,
     .help = "Position of the reference point.",
     .unit = "deg",
     .only = if_rotary,
     .wanted = a_position,
     .least = -most_mm,
     .most = most_mm},
    {.name = "travel",
     .holds = span,
     .help = "Ends of the travel.",
     .unit = "mm or deg",
     .wanted = two_numbers,
     .least = -most_mm,
     .most = most_mm},
    {.name = "resolution_um",
     .holds = number,
     .help = "Smallest increment of the control.",
     .unit = "um",
     .only = if_linear,
     .wanted = a_limit,
     .least = 0.0,
     .above = true},
    {.name = "resolution_arcsec",
     .holds = number,
     .help = "Smallest increment of the control.",
     .unit = "arcsec",
     .only = if_rotary,
     .wanted = a_limit,
     .least = 0.0,
     .above = true},
    {.name = "gear",
     .holds = text,
     .help = "Ratio between motor and screw or table, \"2:1\" (information only)."},
    {.name = "largest_um",
     .holds = number,
     .help = "Largest entry of a table according to the machine's maker.",
     .unit = "um",
     .only = if_linear,
     .wanted = a_limit,
     .least = 0.0,
     .above = true},
    {.name = "largest_arcsec",
     .holds = number,
     .help = "Largest entry of a table according to the machine's maker.",
     .unit = "arcsec",
     .only = if_rotary,
     .wanted = a_limit,
     .least = 0.0,
     .above = true},
    {.name = "slope_um_per_m",
     .holds = number,
     .help = "Largest slope of a table according to the machine's maker.",
     .unit = "um/m",
     .only = if_linear,
     .wanted = a_limit,
     .least = 0.0,
     .above = true},
    {.name = "slope_arcsec_per_deg",
     .holds = number,
     .help = "Largest slope of a table according to the machine's maker.",
     .unit = "arcsec/deg",
     .only = if_rotary,
     .wanted = a_limit,
     .least = 0.0,
     .above = true},
    {.name = "table",
     .holds = text,
     .help = "The table in the control: its file below the site, further files of the same "
             "table separated by commas; or \"none\"."},
    {.name = "backlash_mm",
     .holds = number_or_none,
     .help = "Value of the control's backlash parameter, or \"none\".",
     .unit = "mm",
     .only = if_linear,
     .wanted = some_backlash,
     .least = -most_backlash,
     .most = most_backlash},
    {.name = "backlash_deg",
     .holds = number_or_none,
     .help = "Value of the control's backlash parameter, or \"none\".",
     .unit = "deg",
     .only = if_rotary,
     .wanted = some_backlash,
     .least = -most_backlash,
     .most = most_backlash},
    {.name = "since",
     .holds = date,
     .help = "The day on which table and backlash value were loaded. They apply only to "
             "measurements of later days."},
};

constexpr Key machine_file_keys[] = {
    required_format(),
    {.name = "asset",
     .holds = text,
     .help = "The customer's number of the machine, equal to the name of the file.",
     .required = true,
     .missing = "the name of this file without .toml",
     .wanted = an_asset,
     .text = asset_rule},
    {.name = "maker", .holds = text, .help = "Maker of the machine."},
    {.name = "model", .holds = text, .help = "Model of the machine."},
    {.name = "serial", .holds = text, .help = "Serial number of the machine."},
    {.name = "control",
     .holds = text,
     .help = "Output plugin that writes the tables of the machine's control. The numbers of "
             "the axes refer to this control.",
     .named = Named::control},
    {.name = "control_version", .holds = text, .help = "Version of the control's software."},
    {.name = "taken",
     .holds = texts,
     .help = "Numbers in use in the control, of CEC tables or FANUC's points. New tables use "
             "others.",
     .wanted = taken_numbers,
     .text = {.letters = "0-9-", .not_first = "-", .shortest = 1, .longest = 13}},
    {.name = "axes",
     .holds = named_tables,
     .help = "The axes of the machine by their names, [axes.X].",
     .keys = recorded_axis_keys,
     .initials = "ABC",
     .by_name = "kind",
     .named_so = "rotary"},
};

constexpr Words an_asset_or_serial =
    "The machine as `nonio query` names it: its asset, or maker and serial with a space between "
    "them.";
constexpr Key written_by = {
    .name = "by", .holds = text, .help = "Name of the author of this entry.", .required = true};

constexpr Choice event_kinds[] = {{"crash"},      {"repair"},   {"compensation"}, {"moved"},
                                  {"instrument"}, {"software"}, {"other"}};

constexpr Key event_keys[] = {
    {.name = "date", .holds = date, .help = "Day on which it happened.", .required = true},
    {.name = "machine", .holds = text, .help = an_asset_or_serial, .required = true},
    {.name = "axis",
     .holds = text,
     .help = "The axis concerned, as the control names it. Default: the whole machine."},
    {.name = "kind",
     .holds = text,
     .help = "Kind of event: crash, repair, compensation (a table was loaded into the control), "
             "moved (set up again), instrument (another one from now on), software, other.",
     .required = true,
     .choices = event_kinds},
    {.name = "text",
     .holds = text,
     .help = "Description in the words of a witness.",
     .required = true},
    {.name = "by", .holds = text, .help = "Name of the author of this entry."},
};

constexpr Key acknowledged_keys[] = {
    {.name = "date", .holds = date, .help = "Day of the entry.", .required = true},
    {.name = "finding",
     .holds = text,
     .help = "Id of the finding, or kind of a line of the daily list.",
     .required = true},
    {.name = "machine", .holds = text, .help = an_asset_or_serial, .required = true},
    {.name = "axis", .holds = text, .help = "The axis. Default: all axes."},
    {.name = "quantity", .holds = text, .help = "The quantity, such as B_mean. Default: all."},
    {.name = "until",
     .holds = date,
     .help = "Last day on which the finding counts as known; then it is new again.",
     .required = true},
    {.name = "value",
     .holds = number,
     .help = "Value of the quantity on that day, in its unit: the finding is new again if the "
             "value changes by more than U."},
    {.name = "U",
     .holds = number,
     .help = "Expanded uncertainty (k = 2) of that value.",
     .wanted = not_negative,
     .least = 0.0},
    written_by,
    {.name = "why",
     .holds = text,
     .help = "Reason why it is accepted until then.",
     .required = true},
};

constexpr Key withdrawn_keys[] = {
    {.name = "date", .holds = date, .help = "Day of the entry.", .required = true},
    {.name = "finding",
     .holds = text,
     .help = "As the acknowledgement above that is withdrawn has it.",
     .required = true},
    {.name = "machine", .holds = text, .help = "As the acknowledgement has it.", .required = true},
    {.name = "axis", .holds = text, .help = "As the acknowledgement has it."},
    {.name = "quantity", .holds = text, .help = "As the acknowledgement has it."},
    written_by,
    {.name = "why", .holds = text, .help = "Reason why it does not count any more."},
};

constexpr Key forgotten_keys[] = {
    {.name = "date", .holds = date, .help = "Day of the entry.", .required = true},
    {.name = "campaign",
     .holds = text,
     .help = "Id of a campaign that was removed on purpose.",
     .required = true,
     .wanted = "expected a-z 0-9 . _ - and no more than 100, not starting with a point; found "
               "\"{}\"",
     .text = campaign_id_rule},
    written_by,
    {.name = "why", .holds = text, .help = "Reason for the removal.", .required = true},
};

constexpr Key events_file_keys[] = {
    format_key,
    {.name = "event",
     .holds = tables,
     .help = "Events of a machine, [[event]].",
     .keys = event_keys},
};
constexpr Key acknowledged_file_keys[] = {
    format_key,
    {.name = "acknowledged",
     .holds = tables,
     .help = "Findings that a person knows and accepts, [[acknowledged]].",
     .keys = acknowledged_keys},
    {.name = "withdrawn",
     .holds = tables,
     .help = "Acknowledgements above that do not count any more, [[withdrawn]].",
     .keys = withdrawn_keys},
};
constexpr Key forgotten_file_keys[] = {
    format_key,
    {.name = "forgotten",
     .holds = tables,
     .help = "Campaigns that were removed on purpose, [[forgotten]].",
     .keys = forgotten_keys},
};

constexpr Key events_toml = {.name = "events.toml",
                             .holds = table,
                             .help = "Events of the machines of a site.",
                             .keys = events_file_keys};
constexpr Key acknowledged_toml = {
    .name = "acknowledged.toml",
    .holds = table,
    .help = "Known findings of the machines of a site, and until when.",
    .keys = acknowledged_file_keys};
constexpr Key forgotten_toml = {.name = "forgotten.toml",
                                .holds = table,
                                .help = "Campaigns of a site that were removed on purpose.",
                                .keys = forgotten_file_keys};

constexpr Key machine_toml = {.name = "machine.toml",
                              .holds = table,
                              .help = "Record of a machine, machines/<asset>.toml of a site.",
                              .keys = machine_file_keys};
constexpr Key campaign_toml = {.name = "campaign.toml",
                               .holds = table,
                               .help = "Manifest of a campaign of machine-tool calibration.",
                               .keys = campaign_file_keys};
constexpr Key site_toml = {.name = "site.toml",
                           .holds = table,
                           .help = "Settings for all campaigns of a site.",
                           .keys = site_file_keys};
constexpr Key specification_toml = {.name = "specification",
                                    .holds = table,
                                    .help = "Specification of a simulated campaign.",
                                    .keys = specification_keys};

}  // namespace declared

namespace {

/// Letters of a class as in a pattern: "a-z0-9_-".
bool has_letter(std::string_view letters, char c) {
  for (std::size_t i = 0; i < letters.size(); ++i) {
    const bool range = i + 2 < letters.size() && letters[i + 1] == '-';
    if (range ? c >= letters[i] && c <= letters[i + 2] : c == letters[i]) return true;
    if (range) i += 2;
  }
  return false;
}

}  // namespace

const Key& campaign_file() { return declared::campaign_toml; }
const Key& site_file() { return declared::site_toml; }
const Key& machine_file() { return declared::machine_toml; }
const Key& events_file() { return declared::events_toml; }
const Key& acknowledged_file() { return declared::acknowledged_toml; }
const Key& forgotten_file() { return declared::forgotten_toml; }
const Key& specification_file() { return declared::specification_toml; }

bool obeys(std::string_view text, const TextRule& rule) {
  if (text.empty()) return true;
  const bool letters = std::all_of(text.begin(), text.end(), [&](char c) {
    return rule.letters.empty() || has_letter(rule.letters, c);
  });
  return letters && text.find_first_of(rule.not_letters) == std::string_view::npos &&
         rule.not_first.find(text.front()) == std::string_view::npos &&
         text.size() >= rule.shortest && (rule.longest == 0 || text.size() <= rule.longest) &&
         std::find(rule.except.begin(), rule.except.end(), text) == rule.except.end() &&
         text.starts_with(rule.begins);
}

bool in_range(double value, const Key& key) {
  if (key.least && (key.above ? !(value > *key.least) : !(value >= *key.least))) return false;
  return !key.most || value <= *key.most;
}

const Key* find_key(std::span<const Key> keys, std::string_view name) {
  const auto found =
      std::find_if(keys.begin(), keys.end(), [&](const Key& key) { return key.name == name; });
  return found == keys.end() ? nullptr : &*found;
}

bool rotary_by_name(std::string_view axis) {
  const Key& axes = *find_key(declared::machine_keys, "axes");
  return !axis.empty() && axes.initials.find(axis.front()) != std::string_view::npos;
}

}  // namespace nonio::host::config
