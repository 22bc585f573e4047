// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>

#include "catalogue.h"

namespace nonio::hidden {
namespace {

const std::vector<Source>& sources(bool rotary) {
  static const std::vector<Source> linear = {
      Source::wrong_scale,   Source::ground_pitch,       Source::lead_error,
      Source::lost_motion,   Source::preload_loss,       Source::screw_wind_up,
      Source::dead_path_air, Source::leaning_instrument, Source::screw_heating,
      Source::slow_heating,  Source::wrong_expansion,    Source::optics_slip};
  static const std::vector<Source> turning = {Source::lost_motion,      Source::leaning_instrument,
                                              Source::optics_slip,      Source::eccentric_scale,
                                              Source::tilted_scale,     Source::worm_mesh,
                                              Source::unbalance_wind_up};
  return rotary ? turning : linear;
}

const std::vector<Source>& outside_sources() {
  static const std::vector<Source> all = {
      Source::dent,         Source::creeping_reversal, Source::sawtooth,
      Source::zero_walk,    Source::travel_hysteresis, Source::wild_run,
      Source::contradiction};
  return all;
}

bool warms(const std::string& kind) {
  return kind == "day-wave" || kind == "warm-up" || kind == "growth-drift" || kind == "temperature";
}

/// `n` causes of different kinds, none physically one with another.
std::vector<Piece> pieces(Random& random, bool rotary, std::size_t n, double least, double most) {
  std::vector<Piece> chosen;
  while (chosen.size() < n) {
    const Source source = sources(rotary)[random.below(sources(rotary).size())];
    const std::string kind = kind_of(source);
    const bool clashes = std::any_of(chosen.begin(), chosen.end(), [&](const Piece& p) {
      const std::string other = kind_of(p.source);
      return other == kind || (warms(other) && warms(kind));
    });
    if (!clashes) chosen.push_back({source, random.uniform(least, most)});
  }
  return chosen;
}

/// A screw of the manifest, or an unknown drive (rack and pinion) of a period that a search among
/// the targets can find.
void draw_pitch(Scenario& s, Random& random) {
  if (s.pitch_known) {
    const double pitches[] = {0.005, 0.008, 0.010, 0.016, 0.020, 0.040};
    s.pitch = pitches[random.below(6)];
    return;
  }
  const double intervals = static_cast<double>(s.targets - 1), step = s.length / intervals;
  const double longest = std::min(5.0, intervals / 3.2);
  s.pitch = std::round(random.spread(s.even ? 2.3 : 0.6, longest) * step * 1e4) * 1e-4;
}

bool always_linear(Kind kind) {
  return kind == Kind::wave_under_curve || kind == Kind::screw_and_curve ||
         kind == Kind::fixed_end || kind == Kind::blank_temperatures || kind == Kind::day_wave ||
         kind == Kind::short_misread || kind == Kind::short_complete;
}

/// Of a fixed bearing a little outside the stretch.
double end_of(Random& random) { return random.sign() * random.uniform(0.5, 0.75); }

/// What the story changes of the cycle.
void draw_story(Scenario& s, Random& random) {
  if (s.kind == Kind::fixed_end) s.fixed = end_of(random);
  if (s.kind == Kind::fixed_end || s.kind == Kind::blank_temperatures) s.timed = true;
  if (s.kind == Kind::day_wave) {
    s.timed = true;
    s.fixed = random.flag(0.5) ? 0.0 : end_of(random);
    s.runs = static_cast<std::uint32_t>(random.whole(4, 8));
    s.pause = 3600.0 * random.uniform(8.0, 30.0) / s.runs;
  }
  if (s.kind == Kind::short_misread || s.kind == Kind::short_complete) {
    s.one_way = random.flag(0.5);
    s.targets = s.one_way ? random.whole(10, 12) : random.whole(5, 6);
    s.runs = 1;
    s.one_misread = s.kind == Kind::short_misread || random.flag(0.5);
  }
}

void draw_cycle(Scenario& s, Random& random) {
  s.rotary = random.flag(0.35);
  if (always_linear(s.kind)) s.rotary = false;
  s.targets = s.rotary ? random.whole(12, 36) : random.whole(11, 31);
  s.length = s.rotary ? 2.0 * pi : std::round(random.spread(300.0, 3000.0) / 10.0) / 100.0;
  s.even = random.flag(0.2);
  s.runs = static_cast<std::uint32_t>(random.whole(2, 5));
  s.timed = !random.flag(s.kind == Kind::several ? 1.0 / 3.0 : 0.2);
  if (s.kind == Kind::grouped) s.timed = false;
  s.dwell = random.uniform(4.0, 10.0);
  s.feed = s.length / random.uniform(10.0, 40.0);
  s.pause = s.timed && random.flag(0.5) ? random.uniform(20.0, 180.0) : 0.0;
  s.pitch_known = random.flag(0.5);
  draw_story(s, random);
  draw_pitch(s, random);
  const int teeth[] = {60, 72, 90, 96, 120, 144, 180};
  s.teeth = teeth[random.below(7)];
  s.noise =
      s.rotary ? random.spread(0.1, 1.0) * pi / 180.0 / 3600.0 : random.spread(0.2, 1.5) * 1e-6;
}

void draw_causes(Scenario& s, Random& random) {
  switch (s.kind) {
    case Kind::fixed_end: {
      const Source growing[] = {Source::screw_heating, Source::slow_heating,
                                Source::wrong_expansion};
      s.hidden = {{growing[random.below(3)], random.uniform(3.5, 9.0)}};
      break;
    }
    case Kind::blank_temperatures:
      s.hidden = {{Source::wrong_expansion, random.uniform(3.5, 9.0)}};
      break;
    case Kind::day_wave:
      s.hidden = {{Source::shop_day, random.uniform(3.5, 9.0)}};
      break;
    case Kind::short_complete: {
      const Source of_one_run[] = {Source::wrong_scale, Source::optics_slip, Source::lost_motion};
      if (random.flag(0.5)) s.model = {{of_one_run[random.below(3)], random.uniform(3.5, 9.0)}};
      break;
    }
    case Kind::short_misread: {
      const Source shown_by_one_run[] = {Source::wrong_scale, Source::lost_motion,
                                         Source::lead_error, Source::optics_slip};
      s.hidden = {{shown_by_one_run[random.below(4)], random.uniform(3.5, 9.0)}};
      break;
    }
    case Kind::one:
    case Kind::smallest:
    case Kind::grouped:
      s.hidden = pieces(random, s.rotary, 1, 3.5, 9.0);
      break;
    case Kind::several:
      s.hidden = pieces(random, s.rotary, random.whole(2, 3), 1.6, 4.0);
      s.misread = 0.01;
      break;
    case Kind::complete:
      s.model = pieces(random, s.rotary, random.whole(1, 4), 1.6, 9.0);
      s.misread = random.flag(0.5) ? 0.01 : 0.0;
      break;
    case Kind::outside:
      s.model = pieces(random, s.rotary, random.below(3), 1.6, 6.0);
      s.hidden = {
          {outside_sources()[random.below(outside_sources().size())], random.uniform(2.5, 6.0)}};
      break;
    case Kind::beside: {
      const Source other[] = {Source::dent, Source::creeping_reversal, Source::zero_walk,
                              Source::travel_hysteresis};
      s.hidden = pieces(random, s.rotary, 1, 6.0, 9.0);
      s.hidden.push_back({other[random.below(4)], random.uniform(2.5, 4.0)});
      break;
    }
    case Kind::wave_under_curve:
      s.model = {{Source::ground_pitch, random.uniform(1.6, 6.0)}};
      s.hidden = {{Source::lead_error, random.uniform(1.6, 6.0)}};
      break;
    case Kind::screw_and_curve:
      s.hidden = {{Source::ground_pitch, random.uniform(1.6, 6.0)},
                  {Source::lead_error, random.uniform(1.6, 6.0)}};
      break;
  }
}

bool any_of(const Scenario& s, Source source) {
  const auto is = [&](const Piece& p) { return p.source == source; };
  return std::any_of(s.model.begin(), s.model.end(), is) ||
         std::any_of(s.hidden.begin(), s.hidden.end(), is);
}

}  // namespace

Scenario random_scenario(Kind kind, std::uint64_t seed) {
  // A cause is drawn once and the cycle around it again, so that those that are hard to show are
  // not rarer than others.
  Scenario causes;
  causes.kind = kind;
  {
    Random random(seed, 1000 + static_cast<std::uint64_t>(kind));
    draw_cycle(causes, random);
    draw_causes(causes, random);
  }
  for (std::uint64_t attempt = 0;; ++attempt) {
    Random random(seed, 2000 + 8 * attempt + static_cast<std::uint64_t>(kind));
    Scenario s = causes;
    do draw_cycle(s, random);
    while (s.rotary != causes.rotary);
    s.seed = seed * 1000 + attempt;
    // Causes that no cycle shows together are drawn anew.
    if (attempt > 0 && attempt % 20 == 0) draw_causes(causes, random), s = causes;
    if (any_of(s, Source::wild_run)) s.runs = std::max<std::uint32_t>(s.runs, 3);
    if (any_of(s, Source::worm_mesh)) s.pitch_known = true;
    s.temperatures = any_of(s, Source::wrong_expansion) || (s.timed && random.flag(0.3));
    if (kind == Kind::day_wave) s.temperatures = false;
    if (shown(s)) return s;
  }
}

}  // namespace nonio::hidden
