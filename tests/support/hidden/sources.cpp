// SPDX-License-Identifier: Apache-2.0
// Deviation = actual - target. Every cause is simulated from its mechanism; numbers drawn here are
// proportions, the size comes with `amplitude`.
#include <algorithm>
#include <cmath>

#include "cycle.h"

namespace nonio::hidden {
namespace {

using Values = std::vector<double>;

template <class F>
Values each(const Cycle& c, F of_row) {
  Values values(c.size());
  for (std::size_t i = 0; i < c.size(); ++i) values[i] = of_row(i);
  return values;
}

/// Laser out of line by phi reads cos(phi) of the way; a wrong pitch errs in both senses.
Values wrong_scale(const Cycle& c, Random& random, double amplitude) {
  const double slope = 2.0 * amplitude / c.length;
  const double phi = std::sqrt(2.0 * slope), sign = random.sign();
  const double low = c.targets.front();
  return each(c, [&](std::size_t i) {
    const double way = c.position[i] - low;
    return sign < 0.0 ? way * std::cos(phi) - way : way * slope;
  });
}

/// Pitch error of each short piece is random and smooth (the grinding machine's own slow errors);
/// what is read is its sum. The straight part is set to zero, as the controller's scale would.
Values ground_pitch(const Cycle& c, Random& random, double amplitude) {
  constexpr std::size_t cells = 1200, width = cells / 4;
  Values pitch(cells + 3 * width);
  for (double& e : pitch) e = random.normal();
  for (int pass = 0; pass < 3; ++pass) {
    Values smooth(pitch.size() - width);
    for (std::size_t i = 0; i < smooth.size(); ++i)
      for (std::size_t k = 0; k < width; ++k) smooth[i] += pitch[i + k] / width;
    pitch = std::move(smooth);
  }
  Values sum(cells + 1, 0.0);
  for (std::size_t i = 0; i < cells; ++i) sum[i + 1] = sum[i] + pitch[i];
  Values s = each(c, [&](std::size_t i) {
    const double x = (c.p[i] / c.length + 0.5) * cells;
    const auto k = std::min(static_cast<std::size_t>(std::max(0.0, x)), cells - 1);
    return sum[k] + (x - static_cast<double>(k)) * (sum[k + 1] - sum[k]);
  });
  double mean_s = 0.0, mean_p = 0.0, sp = 0.0, pp = 0.0;
  const double n = static_cast<double>(c.size());
  for (std::size_t i = 0; i < c.size(); ++i) mean_s += s[i] / n, mean_p += c.p[i] / n;
  for (std::size_t i = 0; i < c.size(); ++i)
    sp += (s[i] - mean_s) * (c.p[i] - mean_p), pp += (c.p[i] - mean_p) * (c.p[i] - mean_p);
  for (std::size_t i = 0; i < c.size(); ++i) s[i] -= mean_s + sp / pp * (c.p[i] - mean_p);
  const double size = amplitude / rms_about_mean(s);
  for (double& v : s) v *= size;
  return s;
}

/// Once per period; the phase itself sways a little, which gives a small second harmonic.
Values meshing(const Cycle& c, double period, Random& random, double amplitude) {
  const double phase = random.uniform(0.0, 2.0 * pi), sway = random.uniform(0.01, 0.04);
  return each(c, [&](std::size_t i) {
    const double phi = 2.0 * pi * c.position[i] / period + phase;
    return amplitude * std::sin(phi + sway * std::sin(phi));
  });
}

/// Friction builds up over a short way after a reversal (Dahl) until the nut touches its flank, so
/// that play and wind-up both lag. Either sign: a control may overcompensate.
Values trailing_nut(const Cycle& c, double play_share, Random& random, double amplitude) {
  const double way = 0.02 * c.length / random.uniform(6.0, 12.0);
  const double sign = random.flag(0.8) ? -1.0 : 1.0;
  return each(c, [&](std::size_t i) {
    const double friction = 1.0 - 2.0 * std::exp(-c.since_turn[i] / way);
    return sign * c.d[i] * amplitude * (play_share + (1.0 - play_share) * friction);
  });
}

/// Friction over the stiffness of the free length of the screw; the controller's backlash value
/// takes out what is lost at the middle.
Values screw_wind_up(const Cycle& c, Random& random, double amplitude) {
  const double fixed_end = random.sign(), rise = random.uniform(-0.02, 0.02);
  return each(c, [&](std::size_t i) {
    const double free = 0.6 * c.length - fixed_end * c.p[i];
    const double friction = 1.0 + rise * c.p[i] / c.length;
    return -c.d[i] * amplitude * (free * friction - 0.6 * c.length) / c.length;
  });
}

/// The instrument counts wavelengths of air along a path that it does not know of.
Values dead_path_air(const Cycle& c, Random& random, double amplitude) {
  const double pressure = random.uniform(95000.0, 102000.0), sign = random.sign();
  const double weather = random.uniform(60.0, 250.0);  // Pa over the measurement
  const double bend = random.uniform(-0.05, 0.05), warms = random.uniform(0.0, 0.1);
  const auto index = [&](double t) {
    const double x = t / c.duration;
    return air_refractivity(20.0 + sign * -warms * x,
                            pressure + sign * weather * (x + bend * x * x), 1300.0);
  };
  const double range = std::fabs(index(c.duration) - index(0.0));
  const double path = amplitude / range;
  return each(c, [&](std::size_t i) { return -path * (index(c.t[i]) - index(0.0)); });
}

/// Slow warming: far from its end, so that it is nearly proportional to time.
Values slowly(const Cycle& c, Random& random, double amplitude) {
  const double tau = c.duration * random.uniform(14.0, 30.0), sign = random.sign();
  const Values T = two_bodies(c.t, tau, random);
  return each(c, [&](std::size_t i) { return sign * amplitude * T[i] / T.back(); });
}

Values slow_heating(const Cycle& c, double fixed, Random& random, double amplitude) {
  Values s = slowly(c, random, 2.0 * amplitude);
  for (std::size_t i = 0; i < c.size(); ++i) s[i] *= (c.p[i] - fixed) / c.length;
  return s;
}

Values screw_heating(const Cycle& c, double fixed, Random& random, double amplitude) {
  const double tau = c.duration * random.uniform(0.12, 0.4);
  Values s = heated_screw(c, fixed, tau, random);
  const double size = amplitude / rms_about_mean(s);
  for (double& v : s) v *= size;
  return s;
}

Values wrong_expansion(const Cycle& c, double fixed, Random& random, double amplitude) {
  const double coefficient = random.sign() * 2.0 * amplitude / c.length;
  return each(
      c, [&](std::size_t i) { return coefficient * (c.p[i] - fixed) * (c.material[i] - 20.0); });
}

/// The shop is warmest once a day, not quite as a sine; a steel body follows it late and less
/// (first order, long since swung in). What its growth is at the first reading was set right then.
Values shop_day(const Cycle& c, double fixed, Random& random, double amplitude) {
  constexpr double day = 86400.0;
  const double first = random.uniform(0.0, 2.0 * pi), second = random.uniform(0.0, 2.0 * pi);
  const double skew = random.uniform(0.0, 0.03), tau = random.uniform(1800.0, 4.0 * 3600.0);
  const auto body = [&](double t) {
    double sum = 0.0;
    for (const double harmonic : {1.0, 2.0}) {
      const double w = 2.0 * pi * harmonic / day;
      const double phase = harmonic > 1.0 ? second : first;
      sum += (harmonic > 1.0 ? skew : 1.0) / std::hypot(1.0, w * tau) *
             std::sin(w * t + phase - std::atan(w * tau));
    }
    return sum;
  };
  return each(c, [&](std::size_t i) {
    return 2.0 * amplitude * (c.p[i] - fixed) / c.length * (body(c.t[i]) - body(0.0));
  });
}

Cause optics_slip(const Cycle& c, Random& random, double amplitude) {
  const std::size_t n = c.size();
  const std::size_t first = random.whole(n / 10 + 1, n - n / 10 - 1);
  const double creep = random.uniform(0.0, 0.04), sign = random.sign();
  const double from = c.t[first], settling = 1.5 * c.duration / static_cast<double>(n);
  Values s = each(c, [&](std::size_t i) {
    return i < first
               ? 0.0
               : sign * 2.0 * amplitude * (1.0 - creep * std::exp((from - c.t[i]) / settling));
  });
  return {std::move(s), (c.t[first - 1] + from) / 2.0};
}

/// The disc's centre circles about the axis at e; the head, at radius R, reads the line whose angle
/// from the disc's centre is theta - psi; the axis stops where that is the target.
Values eccentric_scale(const Cycle& c, Random& random, double amplitude) {
  const double e_by_R = amplitude, towards = random.uniform(0.0, 2.0 * pi);
  return each(c, [&](std::size_t i) {
    double psi = 0.0;
    for (int pass = 0; pass < 6; ++pass) {
      const double at = c.position[i] + psi + towards;
      psi = std::atan2(-e_by_R * std::sin(at), 1.0 - e_by_R * std::cos(at));
    }
    return psi;
  });
}

/// A disc tilted by beta: its circle is seen as an ellipse, tan(seen) = tan(angle) cos(beta).
Values tilted_scale(const Cycle& c, Random& random, double amplitude) {
  const double beta = 2.0 * std::sqrt(amplitude), node = random.uniform(0.0, 2.0 * pi);
  return each(c, [&](std::size_t i) {
    const double angle = c.position[i] + node;
    const double seen = std::atan2(std::sin(angle) * std::cos(beta), std::cos(angle));
    return std::remainder(seen - angle, 2.0 * pi);
  });
}

/// Friction is proportional to the resultant of preload and a weight that turns with the table;
/// the controller's backlash value takes out its mean.
Values unbalance_wind_up(const Cycle& c, Random& random, double amplitude) {
  const double weight = random.uniform(0.03, 0.08), towards = random.uniform(0.0, 2.0 * pi);
  const auto load = [&](double theta) {
    return std::hypot(1.0 + weight * std::cos(theta - towards), weight * std::sin(theta - towards));
  };
  double mean = 0.0;
  for (int k = 0; k < 720; ++k) mean += load(2.0 * pi * k / 720.0) / 720.0;
  return each(c, [&](std::size_t i) {
    return -c.d[i] * amplitude * (load(c.position[i]) - mean) / weight;
  });
}

Cause dent(const Cycle& c, Random& random, double amplitude) {
  const std::size_t at = random.whole(1, c.targets.size() - 2);
  const double width = 0.08 * c.length / static_cast<double>(c.targets.size());
  const double sign = random.sign(), where = c.targets[at];
  Values s = each(c, [&](std::size_t i) {
    return sign * amplitude * std::exp(-0.5 * std::pow((c.position[i] - where) / width, 2));
  });
  return {std::move(s), where};
}

Values creeping_reversal(const Cycle& c, Random& random, double amplitude) {
  const double bend = random.uniform(-0.2, 0.2);
  return each(c, [&](std::size_t i) {
    const double x = c.t[i] / c.duration;
    return -c.d[i] * amplitude * (x + bend * x * x);
  });
}

Values sawtooth(const Cycle& c, Random& random, double amplitude) {
  const double section = c.length / random.uniform(1.6, 3.4), start = random.uniform();
  const double sign = random.sign();
  return each(c, [&](std::size_t i) {
    const double x = c.position[i] / section + start;
    return sign * amplitude * (x - std::floor(x) - 0.5);
  });
}

Values zero_walk(const Cycle& c, Random& random, double amplitude) {
  double at = 0.0;
  Values s = each(c, [&](std::size_t) { return at += random.normal(); });
  const double size = amplitude / rms_about_mean(s);
  for (double& v : s) v *= size;
  return s;
}

Values travel_hysteresis(const Cycle& c, Random& random, double amplitude) {
  const double way = c.length * random.uniform(0.1, 0.3);
  return each(c, [&](std::size_t i) {
    return -c.d[i] * amplitude * (1.0 - 2.0 * std::exp(-c.since_turn[i] / way));
  });
}

Cause wild_run(const Cycle& c, Random& random, double amplitude) {
  const auto wild = static_cast<std::uint32_t>(random.whole(1, c.run.back()));
  Values s = each(c, [&](std::size_t i) {
    const double scatter = random.normal();
    return c.run[i] == wild ? amplitude * scatter : 0.0;
  });
  return {std::move(s), wild};
}

Values contradiction(const Cycle& c, Random& random, double amplitude) {
  return each(c, [&](std::size_t) { return random.flag(0.35) ? amplitude : 0.0; });
}

}  // namespace

Cause simulate(Source source, const Cycle& c, const Scenario& s, Random random, double amplitude) {
  switch (source) {
    case Source::wrong_scale:
      return {wrong_scale(c, random, amplitude)};
    case Source::ground_pitch:
      return {ground_pitch(c, random, amplitude)};
    case Source::lead_error:
      return {meshing(c, s.pitch, random, amplitude)};
    case Source::lost_motion:
      return {trailing_nut(c, random.uniform(0.0, 0.7), random, amplitude)};
    case Source::preload_loss:
      return {trailing_nut(c, 0.95, random, amplitude)};
    case Source::screw_wind_up:
      return {screw_wind_up(c, random, amplitude)};
    case Source::dead_path_air:
      return {dead_path_air(c, random, amplitude)};
    case Source::leaning_instrument:
      return {slowly(c, random, amplitude)};
    case Source::screw_heating:
      return {screw_heating(c, s.fixed * c.length, random, amplitude)};
    case Source::slow_heating:
      return {slow_heating(c, s.fixed * c.length, random, amplitude)};
    case Source::wrong_expansion:
      return {wrong_expansion(c, s.fixed * c.length, random, amplitude)};
    case Source::optics_slip:
      return optics_slip(c, random, amplitude);
    case Source::eccentric_scale:
      return {eccentric_scale(c, random, amplitude)};
    case Source::tilted_scale:
      return {tilted_scale(c, random, amplitude)};
    case Source::worm_mesh:
      return {meshing(c, 2.0 * pi / s.teeth, random, amplitude)};
    case Source::unbalance_wind_up:
      return {unbalance_wind_up(c, random, amplitude)};
    case Source::shop_day:
      return {shop_day(c, s.fixed * c.length, random, amplitude)};
    case Source::dent:
      return dent(c, random, amplitude);
    case Source::creeping_reversal:
      return {creeping_reversal(c, random, amplitude)};
    case Source::sawtooth:
      return {sawtooth(c, random, amplitude)};
    case Source::zero_walk:
      return {zero_walk(c, random, amplitude)};
    case Source::travel_hysteresis:
      return {travel_hysteresis(c, random, amplitude)};
    case Source::wild_run:
      return wild_run(c, random, amplitude);
    case Source::contradiction:
      return {contradiction(c, random, amplitude)};
  }
  return {};
}

Cause simulate_sized(Source source, const Cycle& c, const Scenario& s, const Random& random,
                     double rms) {
  double amplitude = rms;
  Cause cause = simulate(source, c, s, random, amplitude);
  for (int pass = 0; pass < 4; ++pass) {
    amplitude *= rms / rms_about_mean(cause.deviation);
    cause = simulate(source, c, s, random, amplitude);
  }
  return cause;
}

}  // namespace nonio::hidden
