// SPDX-License-Identifier: Apache-2.0
#include "tracks.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>

#include "nonio/math/differences.h"

namespace nonio::thermal {

namespace {

/// Start and stop of the spindle. The speed of a row applies until the next row.
struct Run {
  std::size_t start = 0, stop = 0;
  bool stopped = false;
};

std::optional<Run> run_of(const Observations& o, const std::vector<std::size_t>& rows,
                          Tracks& out) {
  const auto& s = o.axes.front();
  const auto turns = [&](std::size_t k) { return s.approach[rows[k]] != 0; };
  Run run;
  while (run.start < rows.size() && !turns(run.start)) ++run.start;
  if (run.start == rows.size()) return {};
  run.stop = run.start;
  while (run.stop + 1 < rows.size() && turns(run.stop)) ++run.stop;
  run.stopped = !turns(run.stop);
  for (std::size_t k = run.stop; k < rows.size() && run.stopped; ++k)
    if (turns(k)) {
      out.findings.push_back({.id = "thermal.several-runs", .attention = true});
      break;
    }
  double slowest = INFINITY, fastest = 0.0;
  for (std::size_t k = run.start; k < run.stop; ++k) {
    const double speed = std::fabs((s.position[rows[k + 1]] - s.position[rows[k]]) /
                                   (o.time[rows[k + 1]] - o.time[rows[k]]));
    slowest = std::min(slowest, speed), fastest = std::max(fastest, speed);
  }
  constexpr double same = 0.02;
  out.speed_steps = out.speed_steps || slowest < (1.0 - same) * fastest;
  return run;
}

math::Track cut(const math::Track& k, std::size_t first, std::size_t last) {
  math::Track out;
  for (std::size_t i = first; i <= last && i < k.size(); ++i) {
    out.time.push_back(k.time[i] - k.time[first]);
    out.d.push_back(k.d[i] - k.d[first]);
  }
  return out;
}

Followed followed(std::string name, const math::Track& whole, const std::optional<Run>& run) {
  Followed f;
  f.name = std::move(name);
  if (!run) {
    f.run = cut(whole, 0, whole.size() - 1);
    return f;
  }
  f.run = cut(whole, run->start, run->stop);
  if (run->stopped) f.cool = cut(whole, run->stop, whole.size() - 1);
  return f;
}

math::Track tilt_of(const math::Track& one, const math::Track& two, double distance) {
  math::Track out;
  std::size_t j = 0;
  for (std::size_t i = 0; i < one.size(); ++i) {
    while (j < two.size() && two.time[j] < one.time[i]) ++j;
    if (j == two.size() || two.time[j] != one.time[i]) continue;
    out.time.push_back(one.time[i]);
    out.d.push_back((one.d[i] - two.d[j]) / distance);
  }
  return out;
}

void add_tilts(const Measurement& m, const std::map<std::string, math::Track>& tracks,
               const std::map<std::string, std::optional<Run>>& runs, Tracks& out) {
  for (const auto& [name, letter] : {std::pair{"B", "X"}, {"A", "Y"}}) {
    const auto one = tracks.find(std::string(letter) + "1"),
               two = tracks.find(std::string(letter) + "2");
    if (one == tracks.end() || two == tracks.end()) continue;
    if (!m.foot) {
      out.findings.push_back(
          {.id = "thermal.no-tilt", .attention = false, .texts = {{"axis", letter}}});
      continue;
    }
    math::Track tilt = tilt_of(one->second, two->second, *m.foot);
    if (tilt.size() < 2 || tilt.size() != one->second.size()) continue;
    Followed f = followed(name, tilt, runs.at(one->first));
    f.tilt = true, f.lever = *m.foot;
    out.all.push_back(std::move(f));
  }
}

bool is_loaded(const Observations& o) {
  return std::any_of(o.channels.begin(), o.channels.end(), [](const Observations::Channel& c) {
    return c.unit != "degC" &&
           std::any_of(c.value.begin(), c.value.end(), [](double v) { return v != 0.0; });
  });
}

}  // namespace

Tracks tracks_of(const Measurement& m, const Observations& o) {
  Tracks out;
  out.deviation = deviation_of(o.angular);
  if (!m.axis.empty()) {
    out.test = Test::axis;
    out.visits = math::visits_of(o);
    if (auto dead = math::dead_sensor(m.axis, o.deviation)) out.findings.push_back(*dead);
    return out;
  }
  const bool spindle = !o.axes.empty() && o.axes.front().approach.size() == o.size() &&
                       std::any_of(o.axes.front().approach.begin(), o.axes.front().approach.end(),
                                   [](std::int8_t a) { return a != 0; });
  out.test = spindle ? Test::spindle : is_loaded(o) ? Test::loaded : Test::etve;
  std::vector<std::vector<std::size_t>> rows(o.lines.size());
  for (std::size_t i = 0; i < o.size(); ++i) rows[o.line_of(i)].push_back(i);
  std::map<std::string, math::Track> tracks;
  std::map<std::string, std::optional<Run>> runs;
  for (std::size_t line = 0; line < o.lines.size(); ++line) {
    if (rows[line].size() < 2) continue;
    auto [kept, track] = math::in_time(o, std::move(rows[line]));
    if (track.size() < 2) continue;
    if (auto dead = math::dead_sensor(o.lines[line].name, track.d, out.deviation)) {
      out.findings.push_back(*dead);
      continue;
    }
    std::optional<Run> run;
    if (spindle) run = run_of(o, kept, out);
    out.all.push_back(followed(o.lines[line].name, track, run));
    runs[o.lines[line].name] = run;
    tracks[o.lines[line].name] = std::move(track);
  }
  add_tilts(m, tracks, runs, out);
  std::sort(out.findings.begin(), out.findings.end(),
            [](const Finding& a, const Finding& b) { return a.id < b.id; });
  out.findings.erase(std::unique(out.findings.begin(), out.findings.end(),
                                 [](const Finding& a, const Finding& b) {
                                   return a.id == b.id && a.texts == b.texts;
                                 }),
                     out.findings.end());
  return out;
}

}  // namespace nonio::thermal
