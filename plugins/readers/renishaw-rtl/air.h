// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace nonio::renishaw {

/// Air as the file's environment gives it.
struct Air {
  double temperature = 0.0;  ///< degC
  double pressure = 0.0;     ///< Pa
  double humidity = 0.0;     ///< %
};

/// Half the wavelength of the laser in air, m.
///
///   lambda_vac / 2n,  lambda_vac = 632.990577 nm (the value that explains two files to 0.1 ppm)
///   (n-1)_s 1e8 = 8342.54 + 2406147/(130 - s^2) + 15998/(38.9 - s^2), s = 1/lambda_vac, 1/um
///   (n-1)_tp    = p (n-1)_s / 96095.43 (1 + 1e-8 (0.601 - 0.00972 t) p) / (1 + 0.0036610 t)
///   n           = 1 + (n-1)_tp - f (3.7345 - 0.0401 s^2) 1e-10, f: pressure of water vapour, Pa
///
/// Birch and Downs, Metrologia 30 (1993) 155 and 31 (1994) 315; f from the relative humidity by
/// Magnus' formula, 611.2 Pa exp(17.62 t / (243.12 + t)).
double half_wavelength(const Air& air);

}  // namespace nonio::renishaw
