// SPDX-License-Identifier: Apache-2.0
// Parameters of a test and its departures from the method as far as readings and manifest show them
// (ISO/IEC 17025:2017, 7.8.2.1 n). The user cannot suppress them.
#include <algorithm>

#include "certificate.h"
#include "nonio/reports/model.h"
#include "nonio/reports/number.h"
#include "nonio/reports/wording.h"
#include "nonio/sdk/format.h"

namespace nonio::certificate {

using namespace reports;

namespace {

std::string excluded(const Source& source, const pages::Measured& m) {
  std::string which;
  for (const Remark& note : m.observations.notes) {
    if (!note.id.starts_with("reading.excluded")) continue;
    const Finding as_finding{.id = note.id, .evidence = note.evidence, .texts = note.texts};
    which += (which.empty() ? "" : ", ") +
             typeset(filled(source.words.get("departure.line"), as_finding, source.language()));
  }
  if (which.empty()) return {};
  const std::string& reason = m.measurement.exclude_reason;
  return ended(source,
               source.words.get("departure.excluded", {{"file", m.measurement.file},
                                                       {"which", which},
                                                       {"reason", reason.empty() ? "–" : reason}}));
}

std::string edition(const Source& source, const Results::Analysed& a) {
  for (const Remark& note : a.evaluation.notes)
    for (const Number& n : note.evidence)
      if (n.name == "edition" && n.value < 2014)
        return source.words.get("departure.edition",
                                {{"edition", printed_number(n.value, Quantity::number, 0, "en")}});
  return {};
}

class Sentences {
 public:
  void add(std::string sentence) {
    if (!sentence.empty() && std::find(all_.begin(), all_.end(), sentence) == all_.end())
      all_.push_back(std::move(sentence));
  }
  std::vector<std::string> take() { return std::move(all_); }

 private:
  std::vector<std::string> all_;
};

std::string quantity(const Source& source, double si, Quantity q, const char* unit = nullptr) {
  return pages::plain_number(source, si, q) + " " + (unit != nullptr ? unit : unit_text(q));
}

std::string places(const Source& source, const std::map<std::string, double>& at) {
  std::string text;
  for (const auto& [axis, position] : at)
    text += (text.empty() ? "" : ", ") + axis + " " +
            printed_number(position, Quantity::length,
                           decimals_for({position}, Quantity::length, 4), source.language()) +
            " mm";
  return text;
}

}  // namespace

std::string ended(const Source& source, std::string text) {
  for (const std::string_view stop : {".", "!", "?", "。", "！", "？"})
    if (text.ends_with(stop)) return text;
  return text + (source.language() == "zh" ? "。" : ".");
}

std::vector<std::string> departures_of(const Source& source, const pages::Measured& m) {
  Sentences sentences;
  sentences.add(excluded(source, m));
  bool missing_said = false;
  for (const Results::Analysed* a : m.analyses) {
    if (a->plugin == model_analysis) continue;
    sentences.add(edition(source, *a));
    for (const Finding& f : a->evaluation.findings) {
      const std::string words = source.words.get_or("departure." + f.id, "");
      if (words.empty()) continue;
      missing_said |= f.id == "readings.missing";
      sentences.add(typeset(filled(words, f, source.language())));
    }
  }
  if (m.observations.missing > 0 && !missing_said) {
    const auto count = [](const char* name, std::size_t n) {
      return Number{name, static_cast<double>(n), Quantity::count};
    };
    const Finding f{.id = "readings.missing",
                    .evidence = {count("missing", m.observations.missing),
                                 count("taken", m.observations.size())}};
    sentences.add(filled(source.words.get("departure.readings.missing"), f, source.language()));
  }
  return sentences.take();
}

namespace {

std::string instrument_name(const Source& source, const std::string& name) {
  constexpr std::string_view instrument = "instrument", sensor = "sensor ";
  if (name.starts_with(instrument))
    return source.words.get("instrument.title") + name.substr(instrument.size());
  if (!name.starts_with(sensor)) return name;
  const std::string rest = name.substr(sensor.size());
  const std::size_t end = std::min(rest.find(' '), rest.size());
  return source.words.get_or("sensor." + rest.substr(0, end), rest.substr(0, end)) +
         rest.substr(end);
}

}  // namespace

std::string expired_text(const Source& source) {
  std::string all;
  const auto add = [&](const std::string& text) { all += (all.empty() ? "" : " ") + text; };
  std::vector<std::string> said;
  for (const Results::Analysed& a : source.in.results.analyses)
    for (const Finding& f : a.evaluation.findings) {
      const std::string words = source.words.get_or("expired." + f.id, "");
      if (words.empty()) continue;
      Finding named = f;
      for (auto& [key, text] : named.texts)
        if (key == "instrument") text = instrument_name(source, text);
      add(ended(source, typeset(filled(words, named, source.language()))));
      if (std::find(said.begin(), said.end(), f.id) == said.end()) said.push_back(f.id);
    }
  for (const std::string& id : said)
    for (const Issue::Reason& r : source.in.issue->reasons)
      if (r.finding == id)
        add(ended(source,
                  source.words.get("expired.approved", {{"by", r.by}, {"reason", r.text}})));
  return all;
}

bool is_printed(const pages::Measured& m) {
  return std::any_of(m.analyses.begin(), m.analyses.end(),
                     [](const Results::Analysed* a) { return is_printed(*a); });
}

/// The stated test parameters, then those not stated, which ISO 230-2 requires to be reported.
std::string test_parameters(const Source& source, const pages::Measured& m) {
  const Wording& w = source.words;
  const Measurement& t = m.measurement;
  const Environment& e = source.in.campaign.environment;
  std::string said, not_said;
  const bool moves = pages::over_one_position(t);
  const auto add = [&](const char* name, bool there, const std::string& sentence,
                       bool wanted = true) {
    if (there)
      said += (said.empty() ? "" : " ") + sentence;
    else if (wanted)
      not_said += (not_said.empty() ? "" : ", ") + w.get(std::string("test_name.") + name);
  };
  const auto with = [&](const char* key, const char* place, const std::string& text) {
    return w.get(key, {{place, text}});
  };
  const double per_minute = 60.0;
  const Quantity travel = position_of(m.rotary);
  if (t.kind != "circle" || !t.feed)
    add("feed", t.feed.has_value(),
        with("test.feed", "feed",
             quantity(source, t.feed.value_or(0) * per_minute, travel,
                      m.rotary ? "°/min" : "mm/min")));
  add("dwell", t.dwell.has_value(),
      with("test.dwell", "dwell", quantity(source, t.dwell.value_or(0), Quantity::time)), moves);
  add("over_travel", t.over_travel.has_value(),
      with("test.over_travel", "over_travel", quantity(source, t.over_travel.value_or(0), travel)),
      moves);
  add("at", !t.at.empty(), with("test.at", "at", places(source, t.at)));
  add("tool_offset", !t.tool_offset.empty(),
      with("test.tool_offset", "offset", places(source, t.tool_offset)), moves);
  add("workpiece_offset", !t.workpiece_offset.empty(),
      with("test.workpiece_offset", "offset", places(source, t.workpiece_offset)), moves);
  add("compensation", !t.compensation.empty(),
      w.get(t.compensation == "on" ? "test.compensation_on" : "test.compensation_off"));
  add("warm_up", !e.warm_up.empty(), with("test.warm_up", "text", e.warm_up));
  add("sensors", !e.sensors.empty(), with("test.sensors", "text", e.sensors));
  if (not_said.empty()) return said;
  return said + (said.empty() ? "" : " ") + with("test.not_stated", "what", not_said);
}

}  // namespace nonio::certificate
