// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "campaign/config/keys/shared.h"

/// Declares [instrument], [[sensor]], [[square]] and [environment] of campaign.toml.
namespace nonio::config::declared {

inline constexpr Key instrument_keys[] = {
    {"maker", into<&Instrument::maker>, "Maker of the measuring instrument."},
    {"model", into<&Instrument::model>, "Model of the measuring instrument."},
    {"serial", into<&Instrument::serial>, "Serial number of the measuring instrument."},
    {"calibrated", day<&Instrument::calibrated>,
     "Day on which the measuring instrument was calibrated."},
    {"certificate", into<&Instrument::certificate>,
     "Number of the calibration certificate of the measuring instrument."},
    {"issuer", into<&Instrument::issuer>,
     "Laboratory that issued the calibration certificate of the measuring instrument."},
    {"valid_until", day<&Instrument::valid_until>,
     "Last day on which the calibration is valid. Default: two years after it. A certificate "
     "requires a valid calibration on the day of the measurement."},
    {"U_fixed_um", into<&Instrument::U_fixed>,
     "Expanded uncertainty (k = 2) of the instrument: the part that does not depend on the length.",
     um, some_um},
    {"U_per_m_um", into<&Instrument::U_per_length>,
     "Expanded uncertainty (k = 2) of the instrument: the part per metre of length.", um, some_um},
    {"U_arcsec", into<&Instrument::U_angle>,
     "Expanded uncertainty (k = 2) of the instrument for angles.", arcsec, some_arcsec},
    {"sphere_um", into<&Instrument::sphere>, "Range of the form error of the probed ball.", um,
     some_um},
    {"probe_um", into<&Instrument::probe>,
     "Range of the probe's contribution to a centre: form of its tip, pre-travel.", um, some_um},
    {"expansion_um_per_m_K", into<&Instrument::expansion>,
     "Coefficient of thermal expansion of a material measure (scale, step gauge). Without it the "
     "instrument is a laser, whose U_per_m_um includes the air.",
     um_per_m_K, an_expansion},
    {"temperature_range_K", into<&Instrument::temperature_range>,
     "Range of the reading error of the instrument's temperature.", K, some_K},
    {"expansion_range_um_per_m_K", into<&Instrument::expansion_range>,
     "Range of the instrument's coefficient of thermal expansion.", um_per_m_K, an_expansion_range},
};

inline constexpr Choice measured_by_sensor[] = {{"material"}, {"air"}, {"pressure"}, {"humidity"}};
inline constexpr Key sensor_keys[] = {
    {"measures", into<&Sensor::measures>,
     "What the sensor measures: temperature of the machine's material or of the air, pressure, "
     "humidity.",
     required, measured_by_sensor},
    {"maker", into<&Sensor::maker>, "Maker of the sensor."},
    {"model", into<&Sensor::model>, "Model of the sensor."},
    {"serial", into<&Sensor::serial>, "Serial number of the sensor."},
    {"calibrated", day<&Sensor::calibrated>, "Day on which the sensor was calibrated."},
    {"valid_until", day<&Sensor::valid_until>,
     "Last day on which the calibration is valid. Default: two years after it."},
    {"certificate", into<&Sensor::certificate>,
     "Number of the calibration certificate of the sensor."},
    {"issuer", into<&Sensor::issuer>, "Laboratory that issued the certificate."},
};

inline constexpr Key square_keys[] = {
    {"id", into<&Square::name>, "Name by which the measurements on its faces refer to the square.",
     missing("a name")},
    {"error_urad", into<&Square::error>,
     "Deviation of the angle between its faces from 90 degrees, as its certificate states it; "
     "positive: more than 90 degrees.",
     urad},
    {"U_urad", into<&Square::U>, "Expanded uncertainty of error_urad, k = 2.", urad,
     from(1e-6, "expected an uncertainty above 0")},
};

inline constexpr Key environment_keys[] = {
    {"misalignment_mm", into<&Environment::misalignment>,
     "Largest lateral distance between beam and axis over the travel.", mm,
     within(0.0, 1e4, "expected a number that is not negative, at most 10000 mm")},
    {"temperature_range_K", into<&Environment::temperature_range>,
     "Range of the reading error of the machine's temperature.", K, some_K},
    {"temperature_difference_K", into<&Environment::temperature_difference>,
     "Largest difference of the machine's temperature from 20 degC.", K, some_K},
    {"expansion_range_um_per_m_K", into<&Environment::expansion_range>,
     "Range of the coefficient of thermal expansion.", um_per_m_K, an_expansion_range},
    {"drift_um", into<&Environment::drift>, "Range of the drift test with the axis at rest.", um,
     some_um},
    {"drift_arcsec", into<&Environment::drift_angle>,
     "Range of the drift test with the rotary axis at rest.", arcsec, some_arcsec},
    {"warm_up", into<&Environment::warm_up>,
     "Warm-up of the machine before the test, for the certificate: \"30 min at half feed\"."},
    {"sensors", into<&Environment::sensors>,
     "Positions of the temperature sensors, for the certificate."},
    {"normalised", into<&Environment::normalised>,
     "Whether the readings were corrected to the reference temperature 20 degC with "
     "expansion_um_per_m_K of their axis before they came into the file, for the certificate. "
     "Default: as the file states; else the certificate states that it is not stated."},
    {"drift_minutes", into<&Environment::drift_time>,
     "Duration of the drift test; for a longer measurement the drift is scaled up.", minutes,
     above_0},
};

}  // namespace nonio::config::declared
