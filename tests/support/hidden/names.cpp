// SPDX-License-Identifier: Apache-2.0
#include "hidden/generator.h"

namespace nonio::hidden {
namespace {

struct Name {
  const char *words, *kind;
};

Name name_of(Source source) {
  switch (source) {
    case Source::wrong_scale:
      return {"wrong scale", "scale"};
    case Source::ground_pitch:
      return {"ground pitch", "pitch-curve"};
    case Source::lead_error:
      return {"lead error", "periodic"};
    case Source::lost_motion:
      return {"lost motion", "backlash"};
    case Source::preload_loss:
      return {"preload loss", "backlash"};
    case Source::screw_wind_up:
      return {"screw wind-up", "backlash-slope"};
    case Source::dead_path_air:
      return {"dead path air", "zero-drift"};
    case Source::leaning_instrument:
      return {"leaning instrument", "zero-drift"};
    case Source::screw_heating:
      return {"screw heating", "warm-up"};
    case Source::slow_heating:
      return {"slow heating", "growth-drift"};
    case Source::wrong_expansion:
      return {"wrong expansion", "temperature"};
    case Source::optics_slip:
      return {"optics slip", "run-jump"};
    case Source::eccentric_scale:
      return {"eccentric scale", "eccentricity"};
    case Source::tilted_scale:
      return {"tilted scale", "harmonic2"};
    case Source::worm_mesh:
      return {"worm mesh", "gear-mesh"};
    case Source::unbalance_wind_up:
      return {"unbalance wind-up", "elastic-reversal"};
    case Source::shop_day:
      return {"shop's day", "day-wave"};
    case Source::dent:
      return {"dent", ""};
    case Source::creeping_reversal:
      return {"creeping reversal", ""};
    case Source::sawtooth:
      return {"sawtooth", ""};
    case Source::zero_walk:
      return {"zero walk", ""};
    case Source::travel_hysteresis:
      return {"travel hysteresis", ""};
    case Source::wild_run:
      return {"wild run", ""};
    case Source::contradiction:
      return {"contradiction", ""};
  }
  return {"", ""};
}

}  // namespace

const char* to_text(Source source) { return name_of(source).words; }
std::string kind_of(Source source) { return name_of(source).kind; }

}  // namespace nonio::hidden
