// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>

#include "nonio/sdk/format.h"
#include "platform/storage/digest.h"
#include "plugin_check/plugin_check_truth.h"
#include "plugin_check/plugin_checks.h"

namespace nonio::plugin_check::kit {

namespace {

/// Results of an analysis for one sample as a list of numbers. Evidence of findings is separate,
/// because a finding appears or disappears at a threshold.
struct Said {
  struct One {
    std::string name;
    double value = 0.0;
    Quantity quantity = Quantity::number;
  };
  std::vector<One> values, evidence;
  std::string texts;
  std::string error;
  std::string unsound;
  std::size_t evaluations = 0;
  bool failed() const { return !error.empty(); }
};

void add_table(const PointTable& table, const std::string& name, Said& said) {
  for (const auto& c : table.columns)
    for (std::size_t i = 0; i < c.values.size(); ++i)
      said.values.push_back(
          {name + c.name + "[" + std::to_string(i) + "]", c.values[i], c.quantity});
}

void add(const Evaluation& e, const std::string& id, Said& said) {
  ++said.evaluations;
  if (said.unsound.empty()) said.unsound = unsound(e);
  for (const Value& v : e.values) {
    said.values.push_back({id + v.name, v.value, v.quantity});
    if (v.U) said.values.push_back({id + "U of " + v.name, *v.U, v.quantity});
  }
  add_table(e.points, id + "points ", said);
  add_table(e.rows, id + "rows ", said);
  for (const Series& s : e.series)
    for (std::size_t i = 0; i < s.value.size(); ++i) {
      said.values.push_back({id + s.name + " at", s.position[i], s.position_quantity});
      said.values.push_back({id + s.name, s.value[i], s.quantity});
      if (i < s.U.size()) said.values.push_back({id + "U of " + s.name, s.U[i], s.quantity});
    }
  const auto tell = [&](const auto& what) {
    said.texts += id + what.id + "\n";
    for (const Number& n : what.evidence)
      said.evidence.push_back({id + what.id + " " + n.name, n.value, n.quantity});
    for (const auto& [key, text] : what.texts) said.texts += key + "=" + text + "\n";
  };
  for (const Finding& f : e.findings) tell(f);
  for (const Remark& r : e.notes) tell(r);
}

Said said_of(const Analysis& a, const Sample& s) {
  Said said;
  const Settings options = settings_for(a.info, s);
  const auto take = [&](const Expected<Evaluation>& e, const std::string& id) {
    if (e) return add(*e, id, said);
    said.texts += id + e.error().message + "\n";
    if (said.error.empty()) said.error = id + e.error().message;
  };
  if (a.analyse_campaign)
    take(a.analyse_campaign({s.campaign, s.observations, options}), "");
  else
    for (const Measurement& m : s.campaign.measurements)
      if (a.applies(s.campaign, m))
        take(a.analyse({s.campaign, m, s.of(m), options, &s.observations}), m.id + " ");
  return said;
}

bool applies(const Analysis& a, const Sample& s) {
  if (a.analyse_campaign) return true;
  return std::any_of(s.campaign.measurements.begin(), s.campaign.measurements.end(),
                     [&](const Measurement& m) { return a.applies(s.campaign, m); });
}

bool only_kinds(const Sample& s, const std::vector<std::string>& kinds) {
  return std::all_of(s.campaign.measurements.begin(), s.campaign.measurements.end(),
                     [&](const Measurement& m) {
                       return std::find(kinds.begin(), kinds.end(), m.kind) != kinds.end();
                     });
}

bool of_deviations(const Sample& s) {
  return only_kinds(s, {"axis", "straightness", "angle", "diagonal", "step-diagonal"});
}

/// The zero of step diagonals is known, because they begin with 0.
bool of_unknown_zero(const Sample& s) {
  return only_kinds(s, {"axis", "straightness", "angle", "diagonal"});
}

const std::string no_sample =
    "no sample of a kind that it evaluates; put a campaign into cases/<name>/campaign.toml";

/// Fails with the first non-empty text that `law` returns. `otherwise` is the reason for skipping
/// the check if no sample fits.
Verdict each_sample(const Analysis& a, const Bench& bench, bool (*wanted)(const Sample&),
                    const std::function<std::string(const Sample&)>& law,
                    const std::string& otherwise = no_sample) {
  std::size_t tried = 0;
  for (const Sample& s : bench.samples) {
    if (!applies(a, s) || !wanted(s)) continue;
    bench.stage("sample " + s.name);
    if (said_of(a, s).evaluations == 0) continue;
    ++tried;
    if (const std::string why = law(s); !why.empty())
      return failed("sample " + s.name + ": " + why);
  }
  return tried == 0 ? skipped(otherwise) : passed();
}

bool any(const Sample&) { return true; }

std::string number(const Said::One& one, double value) {
  return short_text(value * unit_of(one.quantity).per_si, 9) + " " +
         std::string(unit_of(one.quantity).symbol);
}

bool near(double a, double b, double scale, double relative = 1e-6) {
  if (std::isnan(a) || std::isnan(b)) return std::isnan(a) && std::isnan(b);
  return std::fabs(a - b) <= relative * std::max(std::fabs(a), std::fabs(b)) + 1e-7 * scale;
}

/// Largest absolute deviation of the sample in m or rad, at least 1 nm: the scale of rounding
/// errors.
double size_of(const Sample& s) {
  double size = 1e-9;
  for (const Observations& o : s.observations)
    for (const double d : o.deviation) size = std::max(size, std::fabs(d));
  return size;
}

std::string same_names(const Said& one, const Said& two) {
  if (one.failed() != two.failed())
    return "it fails on one of both: " + (one.failed() ? one : two).error;
  for (std::size_t i = 0; i < std::min(one.values.size(), two.values.size()); ++i)
    if (one.values[i].name != two.values[i].name)
      return one.values[i].name + " became " + two.values[i].name;
  if (one.values.size() != two.values.size())
    return std::to_string(one.values.size()) + " numbers became " +
           std::to_string(two.values.size());
  return {};
}

double scale_of(Quantity q, double deviation) {
  switch (q) {
    case Quantity::deviation:
    case Quantity::angular_deviation:
    case Quantity::small_angle:
    case Quantity::deviation_per_length:
    case Quantity::deviation_per_angle:
      return deviation;
    default:
      return 1e-3;
  }
}

std::string same_values(const Said& one, const Said& two, double deviation) {
  if (std::string why = same_names(one, two); !why.empty()) return why;
  for (std::size_t i = 0; i < one.values.size(); ++i) {
    const auto& a = one.values[i];
    const auto& b = two.values[i];
    if (!near(a.value, b.value, scale_of(a.quantity, deviation)))
      return a.name + " is " + number(a, a.value) + " and then " + number(b, b.value);
  }
  return {};
}

Sample changed(Sample s, const std::function<void(Observations&, const Measurement&)>& change) {
  for (std::size_t i = 0; i < s.observations.size(); ++i)
    change(s.observations[i], s.campaign.measurements[i]);
  return s;
}

Verdict analysis_again(const Analysis& a, const Bench& bench) {
  if (!a.analyse_campaign && (!a.applies || !a.analyse))
    return failed("applies or analyse is missing, and analyse_campaign too");
  return each_sample(a, bench, any, [&](const Sample& s) -> std::string {
    const Said one = said_of(a, s);
    for (const Sample& other : bench.samples)
      if (&other != &s && applies(a, other)) said_of(a, other);
    const Said two = said_of(a, s);
    if (std::string why = same_names(one, two); !why.empty()) return why;
    for (std::size_t i = 0; i < one.values.size(); ++i)
      if (std::bit_cast<std::uint64_t>(one.values[i].value) !=
          std::bit_cast<std::uint64_t>(two.values[i].value))
        return one.values[i].name + " is another one the second time";
    return one.texts == two.texts ? "" : "findings or notes are others the second time";
  });
}

Verdict analysis_finite(const Analysis& a, const Bench& bench) {
  return each_sample(a, bench, any, [&](const Sample& s) -> std::string {
    const Said said = said_of(a, s);
    if (!said.unsound.empty()) return said.unsound;
    for (const auto& v : said.values)
      if (std::isinf(v.value) || (std::isnan(v.value) && v.name.find('[') == v.name.npos))
        return v.name + " is not a number";
    for (const auto& v : said.evidence)
      if (!std::isfinite(v.value)) return "evidence " + v.name + " is not a number";
    return {};
  });
}

Verdict analysis_rows(const Analysis& a, const Bench& bench) {
  storage::Random random = bench.random(5);
  return each_sample(a, bench, any, [&](const Sample& s) {
    const Sample other = changed(s, [&](Observations& o, const Measurement&) {
      o = rearranged(o, shuffled(o.size(), random));
    });
    return same_values(said_of(a, s), said_of(a, other), size_of(s));
  });
}

Sample shifted(const Sample& s, double by) {
  return changed(s, [&](Observations& o, const Measurement&) {
    for (double& d : o.deviation) d += by;
  });
}

/// A constant that is added to all deviations may move a result by this constant, because the zero
/// of the deviations is arbitrary.
Verdict analysis_shift(const Analysis& a, const Bench& bench) {
  return each_sample(a, bench, of_unknown_zero, [&](const Sample& s) -> std::string {
    const double c = 20.0 * size_of(s);
    const Said one = said_of(a, shifted(s, c)), two = said_of(a, shifted(s, 2.0 * c));
    if (std::string why = same_names(one, two); !why.empty()) return why;
    for (std::size_t i = 0; i < one.values.size(); ++i) {
      const auto& v = one.values[i];
      const double moved = two.values[i].value - v.value, scale = scale_of(v.quantity, 20.0 * c);
      if (std::isnan(v.value) && std::isnan(two.values[i].value)) continue;
      if (!near(moved, 0.0, scale) && !near(moved, c, scale) && !near(moved, -c, scale))
        return "readings shifted by " + short_text(c * 1e6, 4) + " um or urad move " + v.name +
               " by " + number(v, moved) + ": expected by nothing, or by the same";
    }
    return {};
  });
}

std::optional<int> power_of(Quantity q) {
  switch (q) {
    case Quantity::deviation:
    case Quantity::angular_deviation:
    case Quantity::small_angle:
    case Quantity::deviation_per_length:
    case Quantity::deviation_per_angle:
    case Quantity::deviation_per_time:
    case Quantity::deviation_per_kelvin:
    case Quantity::angle_per_kelvin:
    case Quantity::angle_per_time:
    case Quantity::deviation_per_reading:
    case Quantity::angle_per_reading:
      return 1;
    case Quantity::count:
    case Quantity::length:
    case Quantity::angle:
    case Quantity::temperature:
    case Quantity::time:
    case Quantity::readings:
      return 0;
    default:
      return std::nullopt;
  }
}

/// Without instrument uncertainty, doubled deviations double results that are deviations, slopes or
/// drifts, and leave positions, times and numbers of readings unchanged.
Verdict analysis_scale(const Analysis& a, const Bench& bench) {
  return each_sample(a, bench, of_deviations, [&](const Sample& given) -> std::string {
    Sample s = given;
    s.campaign.instrument = {};
    s.campaign.environment = {};
    constexpr double by = 2.0;
    const Sample other = changed(s, [&](Observations& o, const Measurement&) {
      for (double& d : o.deviation) d *= by;
      for (double& u : o.u) u *= by;
    });
    const Said one = said_of(a, s), two = said_of(a, other);
    if (std::string why = same_names(one, two); !why.empty()) return why;
    for (std::size_t i = 0; i < one.values.size(); ++i) {
      const auto& v = one.values[i];
      const auto power = power_of(v.quantity);
      if (!power) continue;
      const double wanted = *power == 1 ? by * v.value : v.value;
      // A deviation moves the position of the next reading, which is an effect of second order.
      if (!near(two.values[i].value, wanted, 100.0 * scale_of(v.quantity, size_of(s)), 1e-4))
        return "with twice the deviations " + v.name + " is " + number(v, two.values[i].value) +
               ": expected " + number(v, wanted);
    }
    return {};
  });
}

std::vector<double> sizes(const Said& said) {
  std::vector<double> all;
  for (const auto& v : said.values)
    if (v.name.find('[') == v.name.npos && v.name.find(" at") == v.name.npos)
      all.push_back(std::fabs(v.value));
  std::sort(all.begin(), all.end());
  return all;
}

bool of_one_axis(const Sample& s) { return only_kinds(s, {"axis", "straightness", "angle"}); }

Verdict analysis_mirror(const Analysis& a, const Bench& bench) {
  if (a.analyse_campaign) return skipped("it is of the campaign as a whole");
  return each_sample(
      a, bench, of_one_axis,
      [&](const Sample& s) -> std::string {
        const Sample other = changed(s, [](Observations& o, const Measurement& m) {
          for (auto& axis : o.axes) {
            for (double& x : axis.position) x = -x;
            for (auto& d : axis.approach) d = static_cast<std::int8_t>(-d);
          }
          if (m.kind == "axis")
            for (double& d : o.deviation) d = -d;
        });
        const auto one = sizes(said_of(a, s)), two = sizes(said_of(a, other));
        if (one.size() != two.size())
          return std::to_string(one.size()) + " values became " + std::to_string(two.size());
        for (std::size_t i = 0; i < one.size(); ++i)
          if (!near(one[i], two[i], size_of(s)))
            return "counted the other way the sizes of its values are others: " +
                   short_text(one[i], 9) + " became " + short_text(two[i], 9) + " (SI)";
        return {};
      },
      "it evaluates no measurement along one axis");
}

Verdict analysis_renamed(const Analysis& a, const Bench& bench) {
  if (a.analyse_campaign) return skipped("its options name the axes");
  return each_sample(
      a, bench,
      [](const Sample& s) {
        return only_kinds(s, {"axis"}) && s.campaign.machine.axes.size() == 1;
      },
      [&](const Sample& s) -> std::string {
        Sample other = s;
        const std::string name = "Q7";
        other.campaign.machine.axes.front().name = name;
        for (Measurement& m : other.campaign.measurements) m.axis = name;
        for (Observations& o : other.observations) o.axes.front().axis = name;
        return same_values(said_of(a, s), said_of(a, other), size_of(s));
      },
      "it evaluates no runs of one axis");
}

/// Variants of a sample with unusual readings. Huge deviations and positions are too small for a
/// reader to regard as blank, but too large for any machine.
std::vector<std::pair<std::string, Sample>> odd_samples(const Sample& s) {
  std::vector<std::pair<std::string, Sample>> all;
  const auto with = [&](const char* name, auto change) {
    all.emplace_back(name, changed(s, [&](Observations& o, const Measurement&) { change(o); }));
  };
  with("no readings", [](Observations& o) { o = rearranged(o, {}); });
  with("one reading", [](Observations& o) {
    if (o.size() > 0) o = rearranged(o, {0});
  });
  with("one direction", [](Observations& o) {
    std::vector<std::uint32_t> plus;
    for (std::uint32_t i = 0; i < o.size(); ++i)
      if (o.axes.front().approach.empty() || o.axes.front().approach[i] > 0) plus.push_back(i);
    o = rearranged(o, plus);
  });
  with("one target", [](Observations& o) {
    for (auto& axis : o.axes) axis.position.assign(axis.position.size(), 0.1);
  });
  with("deviations of zero", [](Observations& o) { o.deviation.assign(o.size(), 0.0); });
  with("huge deviations", [](Observations& o) {
    for (double& d : o.deviation) d *= 1e18;
  });
  with("huge positions", [](Observations& o) {
    for (auto& axis : o.axes)
      for (double& x : axis.position) x *= 1e18;
  });
  with("many readings", [](Observations& o) {
    if (o.size() == 0 || o.run.empty()) return;
    const auto n = static_cast<std::uint32_t>(o.size());
    std::vector<std::uint32_t> order(20 * o.size());
    for (std::uint32_t i = 0; i < order.size(); ++i) order[i] = i % n;
    const auto runs = *std::max_element(o.run.begin(), o.run.end());
    o = rearranged(o, order);
    for (std::uint32_t i = 0; i < o.size(); ++i) o.run[i] += runs * (i / n);
  });
  return all;
}

/// A table may contain blanks (NaN).
Verdict analysis_hostile(const Analysis& a, const Bench& bench) {
  for (const Sample& s : bench.samples)
    for (const auto& [name, odd] : odd_samples(s)) {
      if (!applies(a, odd)) continue;
      bench.stage("sample " + s.name + ", " + name);
      const Said said = said_of(a, odd);
      if (!said.unsound.empty())
        return failed("sample " + s.name + ", " + name + ": " + said.unsound);
      for (const auto& v : said.values)
        if (std::isinf(v.value) || (std::isnan(v.value) && v.name.find('[') == v.name.npos))
          return failed("sample " + s.name + ", " + name + ": " + v.name +
                        " is not a number: expected a finite one, an error, or none");
      for (const auto& v : said.evidence)
        if (!std::isfinite(v.value))
          return failed("sample " + s.name + ", " + name + ": evidence " + v.name +
                        " is not a number");
    }
  return passed();
}

Verdict analysis_says(const Analysis& a, const Bench& bench) {
  if (!a.analyse_campaign && (!a.applies || !a.analyse))
    return failed("applies or analyse is missing");
  bool tried = false;
  std::string error;
  for (const Sample& s : bench.samples) {
    if (!applies(a, s)) continue;
    tried = true;
    bench.stage("sample " + s.name);
    const Said said = said_of(a, s);
    if (said.evaluations > 0 && !(said.values.empty() && said.texts.empty())) return passed();
    if (error.empty() && said.failed()) error = "; sample " + s.name + ": " + said.error;
  }
  if (!tried) return skipped(no_sample);
  const std::string nothing = "of no sample that it applies to it states anything" + error;
  return a.info.opt_in
             ? skipped(nothing +
                       "; put a campaign with its options into cases/<name>/campaign.toml")
             : failed(nothing);
}

}  // namespace

Verdict fingerprint(const Analysis& a, const Bench& bench) {
  if (bench.only_plugin) bench.only_plugin();
  std::string all;
  for (const Sample& s : bench.samples) {
    if (!applies(a, s)) continue;
    bench.stage("sample " + s.name);
    const Said said = said_of(a, s);
    all += s.name + "\n" + said.texts;
    for (const auto* list : {&said.values, &said.evidence})
      for (const auto& v : *list) all += v.name + " " + exact_text(v.value) + "\n";
  }
  return all.empty() ? skipped(no_sample) : Verdict{Verdict::State::passed, storage::sha256(all)};
}

const std::vector<Check<Analysis>>& analysis_checks() {
  static const std::vector<Check<Analysis>> checks = {
      {"true-values", "It gives the values of expected/values.csv.",
       [](const Analysis& x, const Bench& bench) { return truth(x, bench); }},
      {"again", "The same input gives the same bytes.", analysis_again},
      {"results", "It gives results for a sample that it applies to.", analysis_says},
      {"finite", "A value that cannot be given is absent.", analysis_finite},
      {"rows", "The order of rows does not change the result.", analysis_rows},
      {"shift",
       "The unknown zero of the readings leaves a result unchanged, or shifts it by itself.",
       analysis_shift},
      {"scale", "Doubled deviations double the results.", analysis_scale},
      {"mirror", "A reversed axis gives results of the same size.", analysis_mirror},
      {"renamed", "Results do not depend on the name of the axis.", analysis_renamed},
      {"inch", "Inches give the same readings as millimetres.",
       [](const Analysis&, const Bench&) { return skipped("an analysis gets SI"); }},
      {"malformed", "Unusual readings cause no crash, no hang and no invalid number.",
       analysis_hostile}};
  return checks;
}

}  // namespace nonio::plugin_check::kit
