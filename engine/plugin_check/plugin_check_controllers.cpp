// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <numbers>
#include <set>

#include "nonio/math/loaded_table.h"
#include "nonio/sdk/format.h"
#include "plugin_check/plugin_check_truth.h"
#include "plugin_check/plugin_checks.h"

namespace nonio::plugin_check::kit {

namespace {

struct KnownError {
  bool rotary = false;
  /// Target positions, and mean of the error of both directions at each of them.
  std::vector<double> targets, error;
  double reversal = 0.0;

  double at(double x) const {
    const auto above = std::upper_bound(targets.begin() + 1, targets.end() - 1, x);
    const auto i = static_cast<std::size_t>(above - targets.begin());
    const double part = (x - targets[i - 1]) / (targets[i] - targets[i - 1]);
    return error[i - 1] + std::clamp(part, 0.0, 1.0) * (error[i] - error[i - 1]);
  }
};

/// The error is 0 at the first target. A rotary axis has no slope, so that the error is periodic
/// over a revolution.
KnownError random_error(storage::Random& random, bool rotary, double size, double first) {
  KnownError k{.rotary = rotary, .targets = {}, .error = {}};
  const int n = rotary ? 36 : 40;
  const double length = rotary ? 2.0 * std::numbers::pi : 0.8;
  double wave[3], phase[3];
  for (int j = 0; j < 3; ++j) {
    wave[j] = size * random.uniform(0.2, 0.6) / (j + 1);
    phase[j] = random.uniform(0.0, 6.0);
  }
  const double slope = rotary ? 0.0 : size * random.uniform(-1.0, 1.0);
  for (int i = 0; i <= n; ++i) {
    const double share = static_cast<double>(i) / n;
    double e = slope * share;
    for (int j = 0; j < 3; ++j)
      e += wave[j] *
           (std::sin(2.0 * std::numbers::pi * (j + 1) * share + phase[j]) - std::sin(phase[j]));
    k.targets.push_back(first + length * share);
    k.error.push_back(e);
  }
  return k;
}

Sample sample_of(const KnownError& k) {
  Sample s;
  s.name = k.rotary ? "planted C" : "planted X";
  const std::string name = k.rotary ? "C" : "X";
  s.campaign.id = "planted";
  s.campaign.machine.axes.push_back(
      {.name = name, .rotary = k.rotary, .active_table = "", .active_backlash = 0.0});
  Measurement m;
  m.id = m.axis = name;
  m.kind = "axis";
  s.campaign.measurements.push_back(m);
  Observations o;
  o.measurement = name;
  o.angular = k.rotary;
  o.axes.push_back({name, k.rotary, {}, {}});
  o.lines.push_back({name, k.rotary ? std::array<double, 3>{} : std::array<double, 3>{1, 0, 0}});
  for (std::uint32_t run = 1; run <= 3; ++run)
    for (const int direction : {1, -1})
      for (std::size_t i = 0; i < k.targets.size(); ++i) {
        o.axes[0].position.push_back(k.targets[i]);
        o.axes[0].approach.push_back(static_cast<std::int8_t>(direction));
        o.deviation.push_back(k.error[i] + direction * k.reversal / 2.0);
        o.run.push_back(run);
      }
  s.observations.push_back(std::move(o));
  return s;
}

struct Written {
  std::vector<Artifact> files;
  std::vector<LoadedTable> tables;
  std::string refused;
  bool unable = false;
};

Written written_table(const Controller& o, const Sample& s, const Settings& options, const Bench&) {
  if (o.applies && !o.applies(s.campaign)) return {{}, {}, "it does not apply to runs of one axis"};
  const auto r = o.write({s.campaign, s.observations, {}, options});
  if (!r) return {{}, {}, r.error().message, true};
  if (r->artifacts.empty())
    return {{},
            {},
            r->findings.empty() ? "no file" : "finding " + r->findings.front().id,
            r->findings.empty()};
  auto tables = o.parse({r->artifacts, s.campaign, options});
  if (!tables)
    return {r->artifacts, {}, "its own files cannot be read back: " + tables.error().message, true};
  if (tables->empty()) return {r->artifacts, {}, "its own files, read back, hold no table", true};
  return {r->artifacts, std::move(*tables), {}};
}

/// Option settings to be tested: each choice of `sign`, which the user must state if the control's
/// sign is undocumented, and one table per direction if the control supports this.
std::vector<Settings> set_ups(const Controller& o, const Sample& s) {
  const Settings defaults = settings_for(o, s);
  std::vector<Settings> all{defaults};
  for (const Option& option : o.info.options)
    if (option.name == "sign")
      for (const std::string& choice : option.choices) {
        all.push_back(defaults);
        all.back().values["sign"] = choice;
      }
  if (o.table.bidirectional)
    for (std::size_t i = 0, n = all.size(); i < n; ++i) {
      all.push_back(all[i]);
      all.back().values["directions"] = true;
    }
  return all;
}

/// Settings for a table of one axis, and position of the first target, m. Some controls accept only
/// positions from zero downwards.
struct SetUp {
  Settings options;
  double first = 0.0;
};

std::vector<SetUp> settings_that_write(const Controller& o, const Bench& bench, Written& why) {
  std::vector<SetUp> all;
  for (const double first : {0.0, -0.8}) {
    storage::Random random = bench.random(10);
    const Sample s = sample_of(random_error(random, false, 20e-6, first));
    for (Settings& options : set_ups(o, s)) {
      const Written w = written_table(o, s, options, bench);
      if (math::correction_of(w.tables, "X"))
        all.push_back({std::move(options), first});
      else if (why.refused.empty() || (w.unable && !why.unable))
        why = w;
    }
    if (!all.empty()) break;
  }
  return all;
}

/// Returns the range of the remaining error at the targets if the control adds the tables, m or
/// rad; std::nullopt without a table of the axis. If the files state the reversal, the range
/// includes both directions.
std::optional<double> left(const KnownError& k, const std::vector<LoadedTable>& tables) {
  const std::string axis = k.rotary ? "C" : "X";
  const auto c = math::correction_of(tables, axis);
  if (!c) return std::nullopt;
  const bool joint = std::any_of(tables.begin(), tables.end(), [](const LoadedTable& t) {
    return t.backlash || !t.minus.empty();
  });
  double low[2] = {1e9, 1e9}, high[2] = {-1e9, -1e9};
  for (const int direction : {1, -1})
    for (const double x : k.targets) {
      const double added = (*c)(x, direction);
      const double r = added + k.at(x + added) + direction * k.reversal / 2.0;
      const std::size_t j = joint || direction > 0 ? 0 : 1;
      low[j] = std::min(low[j], r), high[j] = std::max(high[j], r);
    }
  return std::max(high[0] - low[0], joint ? 0.0 : high[1] - low[1]);
}

double range(const KnownError& k) {
  const auto [low, high] = std::minmax_element(k.error.begin(), k.error.end());
  return *high - *low + std::fabs(k.reversal);
}

double steepest(const KnownError& k) {
  double slope = 0.0;
  for (std::size_t i = 1; i < k.targets.size(); ++i)
    slope =
        std::max(slope, std::fabs(k.error[i] - k.error[i - 1]) / (k.targets[i] - k.targets[i - 1]));
  return slope;
}

std::string in_um(double si) { return short_text(si * 1e6, 4) + " um or urad"; }

double step_of(const Controller& o, bool rotary) { return o.table.value_step.of(rotary); }

std::string wrong_table(const Controller& o, const KnownError& k, const Settings& options,
                        const Bench& bench, std::string& refused) {
  const Written w = written_table(o, sample_of(k), options, bench);
  refused = w.refused;
  if (!w.files.empty() && !w.refused.empty()) return w.refused;
  if (!w.refused.empty()) return {};
  for (const LoadedTable& t : w.tables)
    if (const auto sound = math::validate_table(t); !sound) return sound.error().message;
  const auto after = left(k, w.tables);
  if (!after) {
    refused = "no table of that axis alone";
    return {};
  }
  // The control adds the correction at a position where the error already differs.
  const double allowed =
      0.05 * range(k) + 3.0 * step_of(o, k.rotary) + 2.0 * steepest(k) * range(k);
  if (*after <= allowed) return {};
  return "an error of " + in_um(range(k)) + " is one of " + in_um(*after) +
         " once its table is loaded: expected " + in_um(allowed) + " at most";
}

Verdict each_setting(const Controller& o, const Bench& bench,
                     const std::function<std::string(const SetUp&)>& law) {
  if (!o.parse) return failed("it cannot read its table back (Controller::parse)");
  Written why;
  const auto settings = settings_that_write(o, bench, why);
  if (settings.empty()) {
    const std::string none = "no table of one axis alone: " + why.refused;
    return why.unable ? failed(none) : skipped(none);
  }
  for (const SetUp& s : settings)
    if (const std::string wrong = law(s); !wrong.empty()) return failed(wrong);
  return passed();
}

Verdict table_declared(const Controller& o, const Bench&) {
  const ControlTable& t = o.table;
  if (t.name.empty()) return failed("the table has no name: expected the maker's");
  if (!o.parse) return failed("it cannot read its table back (Controller::parse)");
  for (const auto* scale : {&t.position_unit, &t.position_step, &t.value_unit, &t.value_step})
    for (const double x : {scale->linear, scale->rotary})
      if (!(x > 0.0) || !std::isfinite(x)) return failed("a unit or step that is not above 0");
  if (t.increment && !(t.increment->first < t.increment->second))
    return failed("a range of increments that is empty");
  if (t.facts.empty()) return failed("it does not state how well anything is known (facts)");
  std::set<std::string> ids;
  for (const auto& fact : t.facts) {
    if (fact.id.empty() || fact.description.empty()) return failed("a fact without id or words");
    if (!ids.insert(fact.id).second) return failed("two facts are called " + fact.id);
  }
  return passed();
}

Verdict table_cancels(const Controller& o, const Bench& bench) {
  return each_setting(o, bench, [&](const SetUp& s) -> std::string {
    storage::Random random = bench.random(11);
    for (int round = 0; round < 10; ++round) {
      bench.stage("round " + std::to_string(round));
      KnownError k = random_error(random, false, 20e-6, s.first);
      k.reversal = random.uniform(-6e-6, -2e-6);
      std::string refused;
      if (std::string why = wrong_table(o, k, s.options, bench, refused); !why.empty()) return why;
      if (!refused.empty()) return "an error of " + in_um(range(k)) + " is refused: " + refused;
    }
    return {};
  });
}

Verdict table_sign(const Controller& o, const Bench& bench) {
  return each_setting(o, bench, [&](const SetUp& s) -> std::string {
    for (const double slope : {40e-6, -40e-6}) {
      KnownError k{};
      for (int i = 0; i <= 40; ++i) {
        k.targets.push_back(s.first + 0.02 * i);
        k.error.push_back(slope * i / 40.0);
      }
      const Written w = written_table(o, sample_of(k), s.options, bench);
      const auto c = math::correction_of(w.tables, "X");
      if (!c) return "a ramp of " + in_um(slope) + " gets no table: " + w.refused;
      const double added = (*c)(k.targets.back(), 1) - (*c)(k.targets.front(), 1);
      if (!(std::fabs(added + slope) <= 0.05 * std::fabs(slope) + 2.0 * step_of(o, false)))
        return "over an error that rises by " + in_um(slope) + " the control adds " + in_um(added) +
               ": expected " + in_um(-slope);
    }
    return {};
  });
}

double left_at_points(const KnownError& k, const std::vector<LoadedTable>& tables,
                      const math::Correction& added, int direction) {
  double low = 1e9, high = -1e9;
  for (const LoadedTable& t : tables) {
    if (t.output != "X" || t.input != std::vector<std::string>{"X"}) continue;
    for (const double x : t.position[0]) {
      if (x < k.targets.front() || x > k.targets.back()) continue;
      const double rest = added(x, direction) + k.at(x);
      low = std::min(low, rest), high = std::max(high, rest);
    }
  }
  return high - low;
}

/// The remaining errors at the points of the table must differ by at most 1.05 steps, so that
/// rounding errors of increments do not accumulate.
Verdict table_rounding(const Controller& o, const Bench& bench) {
  return each_setting(o, bench, [&](const SetUp& s) -> std::string {
    storage::Random random = bench.random(12);
    for (int round = 0; round < 20; ++round) {
      bench.stage("round " + std::to_string(round));
      const KnownError k = random_error(random, false, 30e-6, s.first);
      const Written w = written_table(o, sample_of(k), s.options, bench);
      const auto added = math::correction_of(w.tables, "X");
      for (const int direction : {1, -1})
        if (const double off = added ? left_at_points(k, w.tables, *added, direction) : 0.0;
            off > 1.05 * step_of(o, false) + 1e-11)
          return "the errors that it leaves at its points differ by " + in_um(off) +
                 ": expected at most 1.05 steps of " + in_um(step_of(o, false));
    }
    return {};
  });
}

Verdict table_limits(const Controller& o, const Bench& bench) {
  return each_setting(o, bench, [&](const SetUp& s) -> std::string {
    storage::Random random = bench.random(13);
    for (const double size : {3e-6, 1e-5, 3e-5, 1e-4, 3e-4, 1e-3, 3e-3, 1e-2}) {
      bench.stage("an error of " + in_um(size));
      const KnownError k = random_error(random, false, size, s.first);
      std::string refused;
      if (std::string why = wrong_table(o, k, s.options, bench, refused); !why.empty()) return why;
    }
    return {};
  });
}

Verdict table_rotary(const Controller& o, const Bench& bench) {
  if (!o.parse) return failed("it cannot read its table back (Controller::parse)");
  storage::Random random = bench.random(14);
  std::size_t tables = 0;
  std::string refused;
  for (int round = 0; round < 5; ++round) {
    const KnownError k = random_error(random, true, 60e-6, 0.0);
    for (const Settings& options : set_ups(o, sample_of(k))) {
      bench.stage("round " + std::to_string(round));
      if (std::string why = wrong_table(o, k, options, bench, refused); !why.empty())
        return failed("over a turn " + why);
      if (!refused.empty()) continue;
      ++tables;
      for (const LoadedTable& t : written_table(o, sample_of(k), options, bench).tables) {
        const double gap = t.plus.empty() ? 0.0 : t.plus.back() - t.plus.front();
        const bool whole =
            t.position[0].back() - t.position[0].front() > 2.0 * std::numbers::pi - 1e-9;
        if (whole && std::fabs(gap) > 0.5 * step_of(o, true))
          return failed("over a whole turn its entries do not end where they begin: " + in_um(gap));
      }
    }
  }
  if (!o.table.rotary)
    return tables == 0 ? passed() : failed("it declares no rotary axes, and writes a table of one");
  return tables > 0 ? passed() : skipped("no table of a turn with its defaults: " + refused);
}

Verdict table_inch(const Controller& o, const Bench& bench) {
  const auto has = [](const Option& option, const char* choice) {
    return std::find(option.choices.begin(), option.choices.end(), choice) != option.choices.end();
  };
  const auto units = std::find_if(o.info.options.begin(), o.info.options.end(),
                                  [&](const Option& u) { return has(u, "mm") && has(u, "inch"); });
  if (units == o.info.options.end()) return skipped("no option has the choices mm and inch");
  return each_setting(o, bench, [&](const SetUp& s) -> std::string {
    storage::Random random = bench.random(15);
    const KnownError k = random_error(random, false, 30e-6, s.first);
    std::vector<math::Correction> both;
    for (const char* unit : {"mm", "inch"}) {
      Settings options = s.options;
      options.values[units->name] = std::string(unit);
      const auto c =
          math::correction_of(written_table(o, sample_of(k), options, bench).tables, "X");
      if (!c) return std::string("no table in ") + unit;
      both.push_back(*c);
    }
    for (const double x : k.targets) {
      const double apart =
          both[0](x, 1) - both[0](k.targets[0], 1) - both[1](x, 1) + both[1](k.targets[0], 1);
      if (std::fabs(apart) > 2.0 * 25.4 * step_of(o, false))
        return "tables in mm and in inch are " + in_um(apart) + " apart";
    }
    return {};
  });
}

}  // namespace

const std::vector<Check<Controller>>& controller_checks() {
  static const std::vector<Check<Controller>> of_tables = {
      {"declared", "Name, units, steps and the confidence of each fact are declared.",
       table_declared},
      {"true-values", "Files of the maker do what table.csv states.",
       [](const Controller& x, const Bench& bench) { return truth(x, bench); }},
      {"cancels", "Its table, read back, removes a planted error.", table_cancels},
      {"sign", "Where the error rises, the control adds a correction that falls equally.",
       table_sign},
      {"rounding", "No point deviates by more than half a step.", table_rounding},
      {"limits", "An error beyond its range is rejected and never wraps around.", table_limits},
      {"rotary", "A table over a full turn ends with the value that it begins with.", table_rotary},
      {"inch", "Inches give the same readings as millimetres.", table_inch}};
  static const std::vector<Check<Controller>> checks = [] {
    auto all = controller_checks_of_files();
    all.insert(all.end(), of_tables.begin(), of_tables.end());
    return all;
  }();
  return checks;
}

}  // namespace nonio::plugin_check::kit
