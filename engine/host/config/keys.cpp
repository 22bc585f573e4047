// SPDX-License-Identifier: Apache-2.0
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
     .help = "Whether the axis moves along a line or turns; without it by its name: A, B and C "
             "turn (ISO 841).",
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
     .help = "Periods of the drive or scale in a revolution.",
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
     .help = "Where screw or scale is held, so that it does not move when it grows (the fixed "
             "bearing, the clamp); without it the readings are asked.",
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
     .help = "Of a gantry axis: name of the control's axis that drives the second side; its table "
             "is made of the measurement with side = \"slave\".",
     .only = if_linear},
    {.name = "table_on",
     .holds = text,
     .help =
         "The table that was on in the control while this axis was measured: its file below the "
         "campaign's folder, \"backup/x.ini\", with others of one table behind commas; or "
         "\"none\". The new table takes its place. Not said, nothing is taken to have been on."},
    {.name = "backlash_on_mm",
     .holds = number_or_none,
     .help =
         "What the control's backlash parameter held while this axis was measured, or \"none\".",
     .unit = "mm",
     .only = if_linear,
     .wanted = some_backlash,
     .least = -most_backlash,
     .most = most_backlash},
    {.name = "backlash_on_deg",
     .holds = number_or_none,
     .help =
         "What the control's backlash parameter held while this axis was measured, or \"none\".",
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
     .help = "The machine's own number in the house; its record is machines/<asset>.toml of the "
             "site. Without it the record is found by maker and serial.",
     .wanted = an_asset,
     .text = asset_rule},
    {.name = "maker", .holds = text, .help = "Maker of the machine."},
    {.name = "model", .holds = text, .help = "Model of the machine."},
    {.name = "serial", .holds = text, .help = "Serial number of the machine."},
    {.name = "description",
     .holds = text,
     .help = "What the machine is, for the certificate: \"gantry milling machine\"."},
    {.name = "condition",
     .holds = text,
     .help = "State of the machine, for the certificate, where it matters."},
    {.name = "control",
     .holds = text,
     .help = "Output plugin that writes the tables of the machine's control; without it tables "
             "for all controls are written.",
     .named = Named::control},
    {.name = "structure",
     .holds = text,
     .help = "How the machine is built; on it depends what the angles of its carriages do.",
     .choices = structures},
    {.name = "axes",
     .holds = named_tables,
     .help = "The axes of the machine by their names, [machine.axes.X]. How the control counts "
             "them stands in the record of the machine.",
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
    {.name = "site", .holds = text, .help = "Where the machine stands."},
    {.name = "operator", .holds = text, .help = "Who measured."},
    {.name = "customer_address",
     .holds = text,
     .help = "Address or contact of the customer, for the certificate."},
    {.name = "date", .holds = date, .help = "Day of the measurements, or the first of them."},
    {.name = "end_date",
     .holds = date,
     .help = "Last day of the measurements, if there were several."},
    {.name = "received", .holds = date, .help = "Day on which the item came, for the certificate."},
    {.name = "purpose",
     .holds = text,
     .help = "Why the machine was measured. A check is a series of its own in the machine's "
             "history; the others are told apart in it.",
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
     .help = "Last day on which that calibration holds; without it two years from its day. A "
             "certificate needs it to hold on the day of the measurement."},
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
     .help = "Expanded uncertainty (k = 2) of the instrument: the part for each metre of length.",
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
     .help = "Range of the form of the ball that is probed.",
     .unit = "um",
     .wanted = some_um,
     .least = 0.0,
     .most = most_um},
    {.name = "probe_um",
     .holds = number,
     .help = "Range of what the probe adds to a centre: form of its tip, pre-travel.",
     .unit = "um",
     .wanted = some_um,
     .least = 0.0,
     .most = most_um},
    {.name = "expansion_um_per_m_K",
     .holds = number,
     .help = "Coefficient of thermal expansion of an instrument that has a length of its own: a "
             "scale, a step gauge. Without it: a laser, whose U_per_m_um has the air in it.",
     .unit = "um/(m K)",
     .wanted = an_expansion,
     .least = least_expansion,
     .most = most_expansion},
    {.name = "temperature_range_K",
     .holds = number,
     .help = "Range in which the reading of that instrument's temperature lies.",
     .unit = "K",
     .wanted = some_K,
     .least = 0.0,
     .most = most_K},
    {.name = "expansion_range_um_per_m_K",
     .holds = number,
     .help = "Range in which that instrument's coefficient of thermal expansion lies.",
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
     .help = "Last day on which that calibration holds; without it two years from its day."},
    {.name = "certificate",
     .holds = text,
     .help = "Number of the calibration certificate of the sensor."},
    {.name = "issuer", .holds = text, .help = "Laboratory that issued that certificate."},
};

constexpr Key environment_keys[] = {
    {.name = "misalignment_mm",
     .holds = number,
     .help = "Largest distance of beam and axis over the travel.",
     .unit = "mm",
     .wanted = "expected a number that is not negative, at most 10000 mm",
     .least = 0.0,
     .most = 1e4},
    {.name = "temperature_range_K",
     .holds = number,
     .help = "Range in which the reading of the machine's temperature lies.",
     .unit = "K",
     .wanted = some_K,
     .least = 0.0,
     .most = most_K},
    {.name = "temperature_difference_K",
     .holds = number,
     .help = "Largest distance of the machine's temperature from 20 degC.",
     .unit = "K",
     .wanted = some_K,
     .least = 0.0,
     .most = most_K},
    {.name = "expansion_range_um_per_m_K",
     .holds = number,
     .help = "Range in which the coefficient of thermal expansion lies.",
     .unit = "um/(m K)",
     .wanted = an_expansion_range,
     .least = 0.0,
     .most = most_expansion_range},
    {.name = "drift_um",
     .holds = number,
     .help = "Range of the drift test, axis at rest.",
     .unit = "um",
     .wanted = some_um,
     .least = 0.0,
     .most = most_um},
    {.name = "drift_arcsec",
     .holds = number,
     .help = "Range of the drift test of a rotary axis, at rest.",
     .unit = "arcsec",
     .wanted = some_arcsec,
     .least = 0.0,
     .most = most_arcsec},
    {.name = "warm_up",
     .holds = text,
     .help = "What the machine did before the test, for the certificate: \"30 min at half feed\"."},
    {.name = "sensors",
     .holds = text,
     .help = "Where the sensors of temperature were, for the certificate."},
    {.name = "drift_minutes",
     .holds = number,
     .help = "How long the drift test took; of a measurement that took longer, the drift counts "
             "so much more.",
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
     .help = "Name of the measurement, unique in the campaign. Without `state`, what follows its "
             "first space is the state of the machine.",
     .required = true,
     .wanted = "expected up to 60 characters without / and \\, not starting with a point",
     .text = {.not_letters = "/\\\n\t", .not_first = ". ", .longest = 60}},
    {.name = "kind",
     .holds = text,
     .help = "What was measured; the kind says which columns the file has.",
     .required = true,
     .choices = measurement_kinds},
    {.name = "file",
     .holds = text,
     .help = "File of the readings, below the campaign's folder.",
     .required = true},
    {.name = "reader",
     .holds = text,
     .help = "Reader plugin for the file; without it one is chosen by the file's content.",
     .named = Named::reader},
    {.name = "axis",
     .holds = text,
     .help = "The axis that moves, or the rotary axis whose balls were measured.",
     .needed = {"kind", of_one_axis},
     .missing = "which axis of the machine was measured"},
    {.name = "lateral",
     .holds = text,
     .help = "The axis in whose direction a straightness is sensed.",
     .needed = {"kind", straightness},
     .missing = "the axis in whose direction the deviation was measured"},
    {.name = "adjustment",
     .holds = text,
     .help = "Which of two tests was made before and which after the machine was adjusted, for "
             "the certificate.",
     .choices = adjustments},
    {.name = "order",
     .holds = text,
     .help = "In which order the readings of a file without times were taken: there and back run "
             "by run (pendulum), as its rows stand, or nobody knows: then nothing is concluded "
             "from time.",
     .only = {"kind", axis_runs},
     .choices = listed_orders},
    {.name = "side",
     .holds = text,
     .help = "Of a gantry axis with a scale on each side: on which one this line lies. Each side "
             "has a table of its own.",
     .only = {"kind", axis_runs},
     .choices = sides},
    {.name = "state",
     .holds = text,
     .help =
         "State of the machine in which it was measured. Diagonals, straightness lines and runs "
         "of one state are evaluated together; \"\": it holds for every state.",
     .wanted = "expected up to 60 characters without / and \\, not starting with a point",
     .text = {.not_letters = "/\\\n\t", .not_first = ". ", .longest = 60}},
    {.name = "about",
     .holds = text,
     .help = "The direction about which the axis turns while it moves (yaw of X: Z), right-handed "
             "positive.",
     .required = true,
     .only = {"kind", angle},
     .choices = linear_axes},
    {.name = "exclude",
     .holds = wholes,
     .help = "Lines of the file whose readings do not count for any analysis; each is noted in "
             "the results.",
     .wanted = "expected line numbers of the file, whole and from 1",
     .least = 1.0,
     .most = 4e9},
    {.name = "exclude_reason",
     .holds = text,
     .help = "Why the lines of exclude do not count; without it there is no certificate."},
    {.name = "from",
     .holds = number_table,
     .help = "Axis positions at the begin of a diagonal, { X = 0, Y = 0 }.",
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
     .help = "Where the axes that stood still were, { Y = 500 }: on which line this axis was "
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
     .help = "Rest at a target before it is read, for the certificate.",
     .unit = "s",
     .wanted = not_negative,
     .least = 0.0},
    {.name = "over_travel_mm",
     .holds = number,
     .help = "How far a linear axis went beyond the last target, for the certificate.",
     .unit = "mm",
     .wanted = not_negative,
     .least = 0.0},
    {.name = "over_travel_deg",
     .holds = number,
     .help = "How far a rotary axis went beyond the last target, for the certificate.",
     .unit = "deg",
     .wanted = not_negative,
     .least = 0.0},
    {.name = "tool_offset",
     .holds = number_table,
     .help = "Offset from the tool's reference to the place that was measured, { Z = -120 }, for "
             "the certificate.",
     .unit = "mm"},
    {.name = "workpiece_offset",
     .holds = number_table,
     .help = "Offset from the work-piece's reference to the place that was measured, { X = 40 }, "
             "for the certificate.",
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
     .help = "Value in the parameter's unit with which the search begins; it stands beside "
             "range."},
    {.name = "range",
     .holds = span,
     .help = "Where to search, two values in the parameter's unit; without start and range the "
             "parameter must enter linearly and is fitted.",
     .wanted = two_numbers},
};

constexpr Key formula_keys[] = {
    {.name = "name",
     .holds = text,
     .help = "Name of the effect, up to 40 of a-z 0-9 -; [model] effects has it as name:axis.",
     .required = true,
     .wanted = "expected up to 40 of a-z 0-9 -; found \"{}\"",
     .text = {.letters = "a-z0-9-", .longest = 40}},
    {.name = "axis",
     .holds = text,
     .help = "The axis whose deviation the formula is.",
     .required = true},
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
     .help = "What tables take: the means of the readings, or what the model's compensable "
             "effects say, so that drift and noise stay out.",
     .otherwise = "readings",
     .choices = compensated},
    {.name = "formula",
     .holds = tables,
     .help = "An effect of your own, as a formula.",
     .keys = formula_keys},
};

constexpr Key run_keys[] = {
    {.name = "analyses",
     .holds = texts,
     .help = "Analyses that are made; without it all that apply, but those on request only.",
     .named = Named::analysis},
    {.name = "outputs",
     .holds = texts,
     .help = "Outputs that are written; without it all that apply, but those on request only.",
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
                                   "zh. Without it en.",
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
                              .help = "Where the calibration was made.",
                              .otherwise = "customer",
                              .choices = locations};
constexpr Key procedure_key = {.name = "procedure",
                               .holds = text,
                               .help = "The laboratory's own procedure, beside the standards."};
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
                                   .help = "The rule by which results conform to a tolerance.",
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
     .help =
         "Additions to the method, deviations from it, exclusions, beside those that the program "
         "finds by itself."},
    {.name = "nothing_else_by",
     .holds = text,
     .help =
         "The person who states that, beyond what the certificate says, nothing was added to the "
         "method, changed in it or left out of it. Without it no such statement is printed."},
    {.name = "conditions",
     .holds = text,
     .help =
         "Conditions that influence the results; expected where no readings have temperatures."},
    {.name = "opinions",
     .holds = text,
     .help = "Opinions and interpretations; the certificate marks them as such."},
    {.name = "amendment", .holds = text, .help = "Why an earlier certificate is replaced."},
    {.name = "customer_data",
     .holds = texts,
     .help = "Keys of this file whose values the customer stated, [\"machine.serial\"]; the "
             "certificate marks them."},
};

constexpr Choice releases[] = {{"by-hand", "a person, with nonio release"},
                               {"automatic", "the night, by the rules of may_stand"}};

constexpr Key standing_keys[] = {
    {.name = "finding",
     .holds = text,
     .help = "Id of a finding, \"plan.few-runs\"; with \".*\" at its end all of a kind.",
     .required = true,
     .missing = "expected the id of a finding",
     .wanted = "expected the id of a finding, or of a kind, \"tolerance.*\"; found \"{}\"",
     .text = {.letters = "a-zA-Z0-9.*+_-"}},
    {.name = "reason",
     .holds = text,
     .help = "Why a certificate may be issued although it is there; kept in the register.",
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
     .help = "How certificates are numbered; with {year} the sequence begins anew with each year.",
     .otherwise = "{year}-{number:4}"},
    {.name = "register",
     .holds = text,
     .help = "File inside the site that keeps all numbers and what was issued under them; it "
             "belongs into the backup.",
     .otherwise = "certificates.sqlite"},
    {.name = "register_seconds",
     .holds = number,
     .help = "How long a night waits, with the campaigns that need a number, for a register that "
             "another process keeps locked; what waits in vain is done again in the next night.",
     .unit = "s",
     .otherwise = "60",
     .wanted = "expected a number from 0 to 86400",
     .least = 0.0,
     .most = 86400.0},
    {.name = "release",
     .holds = text,
     .help = "Who releases a certificate: a person, or the night itself where no finding asks for "
             "attention but those of may_stand.",
     .otherwise = "by-hand",
     .choices = releases},
    {.name = "may_stand",
     .holds = tables,
     .help = "Findings that ask for attention and do not hold up an automatic release, each with "
             "the reason; [] for none.",
     .keys = standing_keys},
    {.name = "two_persons",
     .holds = flag,
     .help = "A certificate is approved by its author and released by an authoriser who is another "
             "person.",
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
constexpr Key run_key = {.name = "run",
                         .holds = table,
                         .help = "Which analyses are made and which outputs written.",
                         .keys = run_keys};
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
     .help = "Why a table may be written from these readings all the same.",
     .required = true,
     .missing = "expected why a table may be written although the finding is there"},
};

constexpr Key tables_keys[] = {
    {.name = "may_stand",
     .holds = tables,
     .help = "Findings that make readings implausible and do not hold up the controller tables, "
             "each with the reason.",
     .keys = table_standing_keys},
};

constexpr Key campaign_file_keys[] = {
    required_format(),
    {.name = "campaign",
     .holds = table,
     .help = "Who had what measured, where and when.",
     .required = true,
     .missing = "[campaign] with at least an id",
     .keys = campaign_keys},
    {.name = "machine",
     .holds = table,
     .help = "The machine that was measured.",
     .keys = machine_keys},
    {.name = "instrument",
     .holds = table,
     .help = "The measuring instrument.",
     .keys = instrument_keys},
    {.name = "sensor",
     .holds = tables,
     .help = "A sensor of temperature, pressure or humidity: an instrument of its own, with a "
             "calibration of its own.",
     .keys = sensor_keys},
    {.name = "environment",
     .holds = table,
     .help = "What the uncertainty budget needs beside the instrument: full ranges of what "
             "disturbs the measurement (ISO/TR 230-9).",
     .keys = environment_keys},
    {.name = "certificate",
     .holds = table,
     .help = "What this campaign's certificate says.",
     .keys = certificate_of_campaign},
    run_key,
    {.name = "measurement",
     .holds = tables,
     .help = "A file of readings. One at least; none where [run] names analyses and outputs: a "
             "campaign that only plans.",
     .keys = measurement_keys},
    {.name = "model",
     .holds = table,
     .help = "The error model of the machine as it stands.",
     .keys = model_keys},
    {.name = "tables",
     .holds = table,
     .help = "What is said of controller tables from implausible readings.",
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
     .help = "The part b of a + b L, for each metre of length.",
     .unit = "um",
     .wanted = not_negative,
     .least = 0.0},
    {.name = "arcsec",
     .holds = number,
     .help = "That of angles: rotary axes, squareness, directions.",
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
     .help = "Number of the accreditation; only for a laboratory that has one."},
    {.name = "authoriser", .holds = text, .help = "Who authorises certificates."},
    {.name = "contact", .holds = text, .help = "How to reach the laboratory."},
    {.name = "cmc",
     .holds = table,
     .help = "The smallest expanded uncertainty (k = 2) that the accreditation covers, a + b L: no "
             "result gets a smaller one.",
     .keys = cmc_keys},
};

constexpr Key limits_keys[] = {
    {.name = "seconds",
     .holds = number,
     .help = "Time that one campaign may take.",
     .unit = "s",
     .otherwise = "600",
     .wanted = "expected a number above 0 and at most 1000000",
     .least = 0.0,
     .most = 1e6,
     .above = true},
    {.name = "memory_MB",
     .holds = number,
     .help = "Memory that one campaign may take.",
     .unit = "MB",
     .otherwise = "4096",
     .wanted = "expected 64 or more, and at most 1000000000",
     .least = 64.0,
     .most = 1e9},
    {.name = "disk_seconds",
     .holds = number,
     .help =
         "Time that a folder or file of the site may give no sign of life while the night looks "
         "what there is to do; after that it is a failed one.",
     .unit = "s",
     .otherwise = "60",
     .wanted = "expected a number above 0 and at most 1000000",
     .least = 0.0,
     .most = 1e6,
     .above = true},
    {.name = "vanished",
     .holds = whole,
     .help = "So many campaigns may be gone that the night before has seen; with more of them the "
             "night's exit status is 1. What is meant to be gone is said with `nonio forget`.",
     .otherwise = "0"},
};

constexpr Key alias_keys[] = {
    {.name = "name",
     .holds = text,
     .help = "How a machine is called in campaigns: an asset, or maker and serial with a space "
             "between them.",
     .required = true},
    {.name = "asset",
     .holds = text,
     .help = "The machine that it is, as `nonio query` calls it.",
     .required = true},
    {.name = "why", .holds = text, .help = "How this is known.", .required = true},
};

constexpr Choice result_folders[] = {{"flat", "OUT/<id>"}, {"hashed", "OUT/ab/<id>"}};

constexpr Key results_keys[] = {
    {.name = "folders",
     .holds = text,
     .help =
         "How the results lie in the output folder: each campaign in OUT/<id>, or in OUT/ab/<id>, "
         "ab the first two digits of the SHA-256 of the id, for sites of a million.",
     .otherwise = "flat",
     .choices = result_folders},
};

constexpr Choice fail_or_sign[] = {{"fail"}, {"sign"}};

constexpr Key signing_keys[] = {
    {.name = "pkcs12",
     .holds = text,
     .help = "The key as a file, relative to the site; or else pkcs11."},
    {.name = "pkcs11",
     .holds = text,
     .help = "The key on a token, \"pkcs11:token=lab;object=calib\"; or else pkcs12."},
    {.name = "module", .holds = text, .help = "PKCS#11 library of the token."},
    {.name = "certificates",
     .holds = text,
     .help = "PEM file with what lies between the certificate and the root."},
    {.name = "password_file",
     .holds = text,
     .help = "File that holds the password; or else password_env or password_credential."},
    {.name = "password_env",
     .holds = text,
     .help = "Variable of the environment that holds the password."},
    {.name = "password_credential",
     .holds = text,
     .help = "Credential of systemd that holds the password."},
    {.name = "trust",
     .holds = text,
     .help = "PEM file with roots, for time stamps and for `nonio verify`."},
    {.name = "revocation",
     .holds = text,
     .help = "PEM file with revocation lists, for `nonio verify`."},
    {.name = "signer",
     .holds = text,
     .help = "Whom `nonio verify` expects: subject, or SHA-256 of the certificate."},
    {.name = "time_stamp",
     .holds = text,
     .help = "Address of a time-stamp server, http://...",
     .wanted = "expected http://..., found \"{}\" (a time stamp is signed; it needs no https)",
     .text = {.begins = "http://"}},
    {.name = "time_stamp_missing",
     .holds = text,
     .help = "What happens if the time-stamp server does not answer: the campaign fails, or the "
             "certificate is signed without time stamp and the summary says so.",
     .otherwise = "fail",
     .choices = fail_or_sign},
    {.name = "time_stamp_seconds",
     .holds = whole,
     .help = "How long to wait for the time-stamp server.",
     .unit = "s",
     .otherwise = "10",
     .wanted = "expected 1 to 300",
     .least = 1,
     .most = 300},
};

constexpr Key site_file_keys[] = {
    format_key,
    {.name = "laboratory",
     .holds = table,
     .help = "The laboratory that measures.",
     .keys = laboratory_keys},
    {.name = "limits",
     .holds = table,
     .help = "What one campaign may take of the computer.",
     .keys = limits_keys},
    {.name = "results",
     .holds = table,
     .help = "How results lie in the output folder.",
     .keys = results_keys},
    run_key,
    options_key,
    {.name = "alias",
     .holds = tables,
     .help = "Two names of one machine, [[alias]]: its campaigns are one history.",
     .keys = alias_keys},
    {.name = "signing",
     .holds = table,
     .help = "The key that signs certificates, and time stamps.",
     .keys = signing_keys},
    {.name = "certificate",
     .holds = table,
     .help = "What certificates say and how they are numbered.",
     .keys = certificate_of_site},
    {.name = "database", .holds = anything, .help = "Without effect in this version."},
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
    {.name = "start_c", .holds = number, .help = "At the begin.", .unit = "degC"},
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
     .help = "Id of the measurement that is taken so.",
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
     .help = "Part of the step by which a target is shifted at most.",
     .unit = "%",
     .wanted = from_0,
     .least = 0.0},
    {.name = "order",
     .holds = text,
     .help = "Each run upwards and then downwards, or all in one direction.",
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
     .help = "Rest at a target.",
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
     .help = "Course of the temperature.",
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
    {.name = "cycle", .holds = tables, .help = "How a measurement is taken.", .keys = cycle_keys},
    {.name = "effect", .holds = tables, .help = "A known effect.", .keys = effect_keys},
};

constexpr Words a_limit = "expected a limit above 0";
constexpr Words a_position = "expected a position of at most 1000000 in size";
constexpr Words taken_numbers = "expected numbers or ranges of them, [\"0\", \"100-227\"]";

constexpr Key recorded_axis_keys[] = {
    {.name = "kind",
     .holds = text,
     .help = "Whether the axis moves along a line or turns; without it by its name: A, B and C "
             "turn (ISO 841).",
     .choices = axis_kinds},
    {.name = "number",
     .holds = whole,
     .help = "The axis' number as the control counts: n of AXn, controlled axis, joint, motor.",
     .wanted = "expected a whole number from 0 to 99",
     .least = 0,
     .most = 99},
    {.name = "name", .holds = text, .help = "What the control calls the axis, where it is not so."},
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
     .help = "Smallest step that the control counts.",
     .unit = "um",
     .only = if_linear,
     .wanted = a_limit,
     .least = 0.0,
     .above = true},
    {.name = "resolution_arcsec",
     .holds = number,
     .help = "Smallest step that the control counts.",
     .unit = "arcsec",
     .only = if_rotary,
     .wanted = a_limit,
     .least = 0.0,
     .above = true},
    {.name = "gear",
     .holds = text,
     .help = "Ratio between motor and screw or table, \"2:1\"; for people."},
    {.name = "largest_um",
     .holds = number,
     .help = "Largest entry of a table that the machine's maker allows.",
     .unit = "um",
     .only = if_linear,
     .wanted = a_limit,
     .least = 0.0,
     .above = true},
    {.name = "largest_arcsec",
     .holds = number,
     .help = "Largest entry of a table that the machine's maker allows.",
     .unit = "arcsec",
     .only = if_rotary,
     .wanted = a_limit,
     .least = 0.0,
     .above = true},
    {.name = "slope_um_per_m",
     .holds = number,
     .help = "Largest slope of a table that the machine's maker allows.",
     .unit = "um/m",
     .only = if_linear,
     .wanted = a_limit,
     .least = 0.0,
     .above = true},
    {.name = "slope_arcsec_per_deg",
     .holds = number,
     .help = "Largest slope of a table that the machine's maker allows.",
     .unit = "arcsec/deg",
     .only = if_rotary,
     .wanted = a_limit,
     .least = 0.0,
     .above = true},
    {.name = "table",
     .holds = text,
     .help = "The table that is in the control: its file below the site, with others of one table "
             "behind commas; or \"none\"."},
    {.name = "backlash_mm",
     .holds = number_or_none,
     .help = "What the control's backlash parameter holds, or \"none\".",
     .unit = "mm",
     .only = if_linear,
     .wanted = some_backlash,
     .least = -most_backlash,
     .most = most_backlash},
    {.name = "backlash_deg",
     .holds = number_or_none,
     .help = "What the control's backlash parameter holds, or \"none\".",
     .unit = "deg",
     .only = if_rotary,
     .wanted = some_backlash,
     .least = -most_backlash,
     .most = most_backlash},
    {.name = "since",
     .holds = date,
     .help = "The day on which table and backlash came into the control. They count for "
             "measurements of later days only."},
};

constexpr Key machine_file_keys[] = {
    required_format(),
    {.name = "asset",
     .holds = text,
     .help = "The machine's own number in the house; the file is called so.",
     .required = true,
     .missing = "the name of this file without .toml",
     .wanted = an_asset,
     .text = asset_rule},
    {.name = "maker", .holds = text, .help = "Maker of the machine."},
    {.name = "model", .holds = text, .help = "Model of the machine."},
    {.name = "serial", .holds = text, .help = "Serial number of the machine."},
    {.name = "control",
     .holds = text,
     .help = "Output plugin that writes the tables of the machine's control. The axes' numbers are "
             "for this control only.",
     .named = Named::control},
    {.name = "control_version", .holds = text, .help = "Version of the control's software."},
    {.name = "taken",
     .holds = texts,
     .help = "Numbers that are in use in the control: of CEC tables, of Fanuc's points. New tables "
             "take others.",
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
    "The machine as `nonio query` calls it: its asset, or maker and serial with a space between "
    "them.";
constexpr Key written_by = {.name = "by", .holds = text, .help = "Who says so.", .required = true};

constexpr Choice event_kinds[] = {{"crash"},      {"repair"},   {"compensation"}, {"moved"},
                                  {"instrument"}, {"software"}, {"other"}};

constexpr Key event_keys[] = {
    {.name = "date", .holds = date, .help = "Day on which it happened.", .required = true},
    {.name = "machine", .holds = text, .help = an_asset_or_serial, .required = true},
    {.name = "axis",
     .holds = text,
     .help = "The axis that it concerns, as the control calls it; without it the whole machine."},
    {.name = "kind",
     .holds = text,
     .help = "What happened: crash, repair, compensation (a table came into the control), moved "
             "(set up anew), instrument (another one from now on), software, other.",
     .required = true,
     .choices = event_kinds},
    {.name = "text", .holds = text, .help = "In the words of who was there.", .required = true},
    {.name = "by", .holds = text, .help = "Who says so."},
};

constexpr Key acknowledged_keys[] = {
    {.name = "date", .holds = date, .help = "Day on which it was said.", .required = true},
    {.name = "finding",
     .holds = text,
     .help = "Id of the finding, or kind of the line of the morning.",
     .required = true},
    {.name = "machine", .holds = text, .help = an_asset_or_serial, .required = true},
    {.name = "axis", .holds = text, .help = "The axis; without it all of them."},
    {.name = "quantity", .holds = text, .help = "The quantity, such as B_mean; without it all."},
    {.name = "until",
     .holds = date,
     .help = "Last day on which it is known; then it is new again.",
     .required = true},
    {.name = "value",
     .holds = number,
     .help = "Value of the quantity on that day, in its unit: it is new again where it moves by "
             "more than U."},
    {.name = "U",
     .holds = number,
     .help = "Expanded uncertainty (k = 2) of that value.",
     .wanted = not_negative,
     .least = 0.0},
    written_by,
    {.name = "why", .holds = text, .help = "Why it may stand until then.", .required = true},
};

constexpr Key forgotten_keys[] = {
    {.name = "date", .holds = date, .help = "Day on which it was said.", .required = true},
    {.name = "campaign",
     .holds = text,
     .help = "Id of a campaign that is meant to be gone.",
     .required = true,
     .wanted = "expected a-z 0-9 . _ - and no more than 100, not starting with a point; found "
               "\"{}\"",
     .text = campaign_id_rule},
    written_by,
    {.name = "why", .holds = text, .help = "Why it is gone.", .required = true},
};

constexpr Key events_file_keys[] = {
    format_key,
    {.name = "event",
     .holds = tables,
     .help = "What happened to a machine, [[event]].",
     .keys = event_keys},
};
constexpr Key acknowledged_file_keys[] = {
    format_key,
    {.name = "acknowledged",
     .holds = tables,
     .help = "What somebody knows and lets stand, [[acknowledged]].",
     .keys = acknowledged_keys},
};
constexpr Key forgotten_file_keys[] = {
    format_key,
    {.name = "forgotten",
     .holds = tables,
     .help = "Campaigns that are meant to be gone, [[forgotten]].",
     .keys = forgotten_keys},
};

constexpr Key events_toml = {.name = "events.toml",
                             .holds = table,
                             .help = "What happened to the machines of a site.",
                             .keys = events_file_keys};
constexpr Key acknowledged_toml = {.name = "acknowledged.toml",
                                   .holds = table,
                                   .help = "What is known of the machines of a site, until when.",
                                   .keys = acknowledged_file_keys};
constexpr Key forgotten_toml = {.name = "forgotten.toml",
                                .holds = table,
                                .help = "Campaigns of a site that are meant to be gone.",
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
                           .help = "What holds for all campaigns of a site.",
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
