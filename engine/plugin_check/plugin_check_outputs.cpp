// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <charconv>
#include <set>

#include "platform/storage/digest.h"
#include "platform/storage/files.h"
#include "platform/storage/json_values.h"
#include "plugin_check/plugin_checks.h"

namespace nonio::plugin_check::kit {

namespace {

const Issue issue{"2026-0001", "2026-11-21", "", "", {}, std::string(64, '0')};

Expected<OutputResult> written(const Output& o, const Sample& s, const Results& results,
                               const Settings& options, const Bench& bench) {
  if (!o.certificate)
    return o.write({s.campaign, s.observations, results, options, bench.templates});
  if (o.certificate->missing_requirements)
    o.certificate->missing_requirements(
        {s.campaign, s.observations, results, options, bench.templates});
  return o.write({s.campaign, s.observations, results, options, bench.templates, &issue});
}

Expected<OutputResult> written(const Controller& c, const Sample& s, const Results& results,
                               const Settings& options, const Bench&) {
  return c.write({s.campaign, s.observations, results, options});
}

void prepare(const Output& o, const Bench& bench) {
  if (o.prepare) o.prepare(bench.templates);
}
void prepare(const Controller&, const Bench&) {}

std::string unsound_output(const OutputResult& r) {
  std::set<std::string> names;
  for (const Artifact& a : r.artifacts) {
    if (!storage::is_artifact_name(a.name))
      return "the file name \"" + a.name.substr(0, 60) + "\": expected a plain name";
    if (!names.insert(a.name).second) return "two files called " + a.name;
    if (a.name.ends_with(".json") && !storage::Json::accept(a.bytes))
      return a.name + " is not JSON";
  }
  return unsound(r);
}

template <class Plugin>
std::string complaint(const Plugin& o, const Sample& s, const Results& results,
                      const Settings& options, const Bench& bench) {
  const auto r = written(o, s, results, options, bench);
  return r ? unsound_output(*r) : std::string();
}

template <class Plugin>
Verdict each_output(const Plugin& o, const Bench& bench,
                    const std::function<std::string(const Sample&, const Results&)>& law) {
  if (!o.applies || !o.write) return failed("applies or write is missing");
  std::size_t tried = 0;
  prepare(o, bench);
  for (const Sample& s : bench.samples) {
    if (!o.applies(s.campaign)) continue;
    bench.stage("sample " + s.name);
    const Results results = results_of(s, bench);
    if (const std::string why = law(s, results); !why.empty())
      return failed("sample " + s.name + ": " + why);
    ++tried;
  }
  return tried == 0
             ? skipped("it applies to no sample; put a campaign into cases/<name>/campaign.toml")
             : passed();
}

bool same(const OutputResult& a, const OutputResult& b) {
  const auto files = [](const Artifact& x, const Artifact& y) {
    return x.name == y.name && x.bytes == y.bytes;
  };
  const auto predictions = [](const Prediction& x, const Prediction& y) {
    return x.name == y.name && x.before == y.before && x.after == y.after;
  };
  const auto findings = [](const Finding& x, const Finding& y) {
    return x.id == y.id && x.texts == y.texts;
  };
  return std::equal(a.artifacts.begin(), a.artifacts.end(), b.artifacts.begin(), b.artifacts.end(),
                    files) &&
         std::equal(a.predictions.begin(), a.predictions.end(), b.predictions.begin(),
                    b.predictions.end(), predictions) &&
         std::equal(a.findings.begin(), a.findings.end(), b.findings.begin(), b.findings.end(),
                    findings);
}

template <class Plugin>
Verdict output_again(const Plugin& o, const Bench& bench) {
  return each_output(o, bench, [&](const Sample& s, const Results& results) -> std::string {
    const Settings options = settings_for(o, s);
    const auto one = written(o, s, results, options, bench);
    const auto two = written(o, s, results, options, bench);
    if (one.has_value() != two.has_value()) return "it fails only one of two times";
    return !one || same(*one, *two) ? "" : "the same input gives other bytes the second time";
  });
}

template <class Plugin>
Verdict output_writes(const Plugin& o, const Bench& bench) {
  std::size_t files = 0;
  std::string first;
  Verdict v = each_output(o, bench, [&](const Sample& s, const Results& results) -> std::string {
    const auto r = written(o, s, results, settings_for(o, s), bench);
    if (!r) {
      if (first.empty()) first = "; sample " + s.name + ": " + r.error().message;
      return {};
    }
    files += r->artifacts.size();
    return unsound_output(*r);
  });
  if (v.state == Verdict::State::passed && files == 0 && !o.info.opt_in)
    return failed("it wrote no file of any sample" + first);
  return v;
}

template <class Plugin>
Verdict output_empty(const Plugin& o, const Bench& bench) {
  return each_output(o, bench, [&](const Sample& given, const Results& results) -> std::string {
    const Settings options = settings_for(o, given);
    if (std::string why = complaint(o, given, {}, options, bench); !why.empty())
      return "without results: " + why;
    Sample s = given;
    for (Observations& one : s.observations) one = rearranged(one, {});
    if (std::string why = complaint(o, s, results, options, bench); !why.empty())
      return "without readings: " + why;
    if (std::string why = complaint(o, s, {}, options, bench); !why.empty())
      return "without readings and results: " + why;
    s.observations.assign(s.observations.size(), {});
    return complaint(o, s, {}, options, bench);
  });
}

void replace_texts(Campaign& c, const std::string& text) {
  for (std::string* t :
       {&c.customer, &c.customer_address, &c.site, &c.operator_name, &c.machine.maker,
        &c.machine.model, &c.machine.serial, &c.machine.description, &c.machine.condition,
        &c.instrument.maker, &c.instrument.model, &c.instrument.serial, &c.instrument.certificate,
        &c.laboratory.name, &c.laboratory.address, &c.laboratory.authoriser,
        &c.certificate.procedure, &c.certificate.conditions, &c.certificate.opinions})
    *t = text;
}

/// Returns the part of a text that the host accepts as a measurement id: at most 50 bytes, without
/// slashes and control characters, and without leading points and blanks.
std::string id_of(const std::string& text) {
  std::string id;
  for (const char c : text)
    if (c != '/' && c != '\\' && static_cast<unsigned char>(c) >= 0x20 && id.size() < 50 &&
        (!id.empty() || (c != '.' && c != ' ')))
      id += c;
  return id;
}

Sample renamed(Sample s, const std::string& text) {
  s.results.reset();
  replace_texts(s.campaign, text);
  for (std::size_t i = 0; i < s.campaign.measurements.size(); ++i) {
    s.campaign.measurements[i].id = id_of(text) + std::to_string(i);
    s.observations[i].measurement = s.campaign.measurements[i].id;
  }
  return s;
}

std::vector<std::pair<std::string, std::string>> hostile_texts() {
  return {{"emoji", "\xf0\x9f\x8f\xad \xe5\xb7\xa5\xe4\xbd\x9c\xe6\x9c\xba \xd7\x90\xcc\x81"},
          {"10,000 characters", std::string(10000, 'w')},
          {"path separators", "../../etc/passwd\\..\\x/"},
          {"markup", "]]><script>&\"'{reason}%s$(x)`\n%\t;N1 G0 X0\r\n"},
          {"bytes that are no UTF-8", std::string("\xff\xfe\x00\x80 x", 6)}};
}

template <class Plugin>
Verdict output_hostile(const Plugin& o, const Bench& bench) {
  std::size_t at = 0;
  return each_output(o, bench, [&](const Sample& s, const Results&) -> std::string {
    // Each sample is tested with the next two texts, so that all samples together use all texts.
    const auto texts = hostile_texts();
    for (std::size_t k = 0; k < 2; ++k) {
      const auto& [name, text] = texts[(at + k) % texts.size()];
      const Sample odd = renamed(s, text);
      bench.stage("sample " + s.name + ", texts: " + name);
      const Results results = results_of(odd, bench);
      if (std::string why = complaint(o, odd, results, settings_for(o, odd), bench); !why.empty())
        return name + ": " + why;
    }
    at += 2;
    return {};
  });
}

std::vector<Setting> ends_of(const Option& option) {
  std::vector<Setting> ends;
  if (std::holds_alternative<bool>(option.default_value)) return {Setting(true), Setting(false)};
  const bool whole = std::holds_alternative<std::int64_t>(option.default_value);
  for (const std::string& choice : option.choices) {
    std::int64_t value = 0;
    if (!whole)
      ends.emplace_back(choice);
    else if (std::from_chars(choice.data(), choice.data() + choice.size(), value).ec == std::errc())
      ends.emplace_back(value);
  }
  const auto number = [&](double x) {
    whole ? ends.emplace_back(static_cast<std::int64_t>(x)) : ends.emplace_back(x);
  };
  const bool is_number = whole || std::holds_alternative<double>(option.default_value);
  if (is_number && option.choices.empty()) {
    number(option.min.value_or(-1e9));
    number(option.max.value_or(1e9));
    if (!option.min || *option.min <= 0.0) number(0.0);
  }
  if (std::holds_alternative<std::string>(option.default_value) && option.choices.empty())
    ends.emplace_back(std::string("../\xf0\x9f\x8f\xad"));
  if (std::holds_alternative<std::vector<std::string>>(option.default_value))
    ends.emplace_back(std::vector<std::string>{"", "X", "../x y=z =", std::string(300, 'q')});
  if (std::holds_alternative<NumberTables>(option.default_value))
    ends.emplace_back(NumberTables{{"", {}},
                                   {"X", {{"", 0.0}, {"step_mm", -1e300}}},
                                   {"../x", {{std::string(300, 'q'), 1e300}}}});
  if (std::holds_alternative<std::vector<double>>(option.default_value))
    ends.emplace_back(std::vector<double>{0.0, -1.0, 1e300});
  return ends;
}

/// Tests one option at a time, on the sample for which the plugin writes the most files.
template <class Plugin>
Verdict output_options(const Plugin& o, const Bench& bench) {
  if (o.info.options.empty()) return skipped("it has no options");
  const Sample* largest = nullptr;
  Results results;
  std::size_t most = 0;
  const Verdict v = each_output(o, bench, [&](const Sample& s, const Results& r) -> std::string {
    const auto w = written(o, s, r, settings_for(o, s), bench);
    std::size_t files = 1;
    if (w) files += w->artifacts.size();
    if (files > most) most = files, largest = &s, results = r;
    return {};
  });
  if (largest == nullptr) return v;
  for (const Option& option : o.info.options)
    for (const Setting& end : ends_of(option)) {
      Settings options = settings_for(o, *largest);
      options.values[option.name] = end;
      bench.stage("sample " + largest->name + ", option " + option.name);
      if (std::string why = complaint(o, *largest, results, options, bench); !why.empty())
        return failed("option " + option.name + ": " + why);
    }
  return passed();
}

Verdict output_templates(const Output& o, const Bench& bench) {
  if (!o.check_templates) return skipped("it does not check templates");
  const auto errors = o.check_templates(bench.templates);
  if (!errors.empty()) return failed(errors.front().file + ": " + errors.front().message);
  bench.stage("no templates at all");
  o.check_templates({});
  return passed();
}

template <class Plugin>
Verdict fingerprint_of(const Plugin& o, const Bench& bench) {
  if (!o.applies || !o.write) return skipped("applies or write is missing");
  std::vector<Results> results;
  for (const Sample& s : bench.samples) results.push_back(results_of(s, bench));
  if (bench.only_plugin) bench.only_plugin();
  prepare(o, bench);
  std::string all;
  for (std::size_t i = 0; i < bench.samples.size(); ++i) {
    const Sample& s = bench.samples[i];
    if (!o.applies(s.campaign)) continue;
    bench.stage("sample " + s.name);
    const auto r = written(o, s, results[i], settings_for(o.info, s), bench);
    all += s.name + (r ? "\n" : ": " + r.error().message + "\n");
    if (!r) continue;
    for (const Artifact& a : r->artifacts) all += a.name + "\n" + storage::sha256(a.bytes) + "\n";
    for (const Prediction& p : r->predictions)
      all += p.name + " " + exact_text(p.before) + " " + exact_text(p.after) + "\n";
    for (const Finding& f : r->findings) {
      all += f.id + "\n";
      for (const auto& [key, text] : f.texts) all += key + "=" + text + "\n";
    }
  }
  return all.empty() ? skipped("it applies to no sample")
                     : Verdict{Verdict::State::passed, storage::sha256(all)};
}

template <class Plugin>
std::vector<Check<Plugin>> checks_of_files() {
  return {{"writes", "It writes files with plain names and valid numbers.", output_writes<Plugin>},
          {"again", "The same input gives the same bytes.", output_again<Plugin>},
          {"empty", "No results or no readings: an error, or less.", output_empty<Plugin>},
          {"malformed", "Texts of any kind do not crash it, and lead to no other folder.",
           output_hostile<Plugin>},
          {"choices", "Every choice and both ends of each option work.", output_options<Plugin>}};
}

}  // namespace

Verdict fingerprint(const Output& o, const Bench& bench) { return fingerprint_of(o, bench); }
Verdict fingerprint(const Controller& c, const Bench& bench) { return fingerprint_of(c, bench); }

const std::vector<Check<Output>>& output_checks() {
  static const std::vector<Check<Output>> checks = [] {
    auto all = checks_of_files<Output>();
    all.push_back({"templates", "Its own templates have no errors.", output_templates});
    return all;
  }();
  return checks;
}

std::vector<Check<Controller>> controller_checks_of_files() {
  return checks_of_files<Controller>();
}

}  // namespace nonio::plugin_check::kit
