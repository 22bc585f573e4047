// SPDX-License-Identifier: Apache-2.0
// Texts of the DCC, equal to those of the printed pages in all languages.
#include <algorithm>

#include "certificate.h"
#include "nonio/reports/model.h"
#include "nonio/reports/number.h"
#include "nonio/reports/wording.h"
#include "nonio/sdk/format.h"

namespace nonio::certificate {

using namespace reports;

namespace {

template <class Say>
dcc::Text in_all(const std::vector<Source>& sources, const Say& say) {
  dcc::Text text;
  for (const Source& source : sources) text.emplace_back(source.language(), say(source));
  return text;
}

dcc::Text word(const std::vector<Source>& sources, const char* key) {
  return in_all(sources, [&](const Source& s) { return s.words.get(key); });
}

std::string joined(std::initializer_list<std::string> texts, const char* between = ", ") {
  std::string out;
  for (const std::string& part : texts)
    if (!part.empty()) out += (out.empty() ? "" : between) + part;
  return out;
}

std::string labelled(const Source& s, const char* key, const std::string& value) {
  return value.empty() ? "" : s.words.get(key) + ": " + value;
}

std::vector<dcc::Condition> conditions(const std::vector<Source>& sources,
                                       const Observations& observations) {
  const Conditions found = conditions_of({observations});
  std::vector<dcc::Condition> out;
  const auto add = [&](const char* ref_type, const char* unit, const char* key, const Range& range,
                       Quantity q, int decimals) {
    if (!range.known()) return;
    const auto number = [&](double v) { return fixed_text(printed(v, q), decimals); };
    dcc::Text name = in_all(sources, [&](const Source& s) {
      std::string text = s.words.get(key, {{"range", ""}});
      while (!text.empty() && (text.back() == '.' || text.back() == ' ')) text.pop_back();
      if (text.ends_with("。")) text.resize(text.size() - std::string_view("。").size());
      return text;
    });
    out.push_back({ref_type, unit, std::move(name), number(range.low), number(range.high)});
  };
  add("basic_temperature", "\\degreecelsius", "conditions.material", found.material,
      Quantity::temperature, 1);
  add("basic_temperature", "\\degreecelsius", "conditions.air", found.air, Quantity::temperature,
      1);
  add("", "\\hecto\\pascal", "conditions.pressure", found.pressure, Quantity::number, 0);
  add("", "\\percent", "conditions.humidity", found.humidity, Quantity::number, 0);
  return out;
}

dcc::Words words_of(const std::vector<Source>& sources, const Results::Analysed& a) {
  const OutputInput& in = sources.front().in;
  const std::vector<pages::Measured> all = pages::measured(in);
  dcc::Words words;
  for (const pages::Measured& m : all) {
    const auto& uses = a.evaluation.uses;
    const bool own = m.measurement.id == a.measurement;
    if (!own && std::find(uses.begin(), uses.end(), m.measurement.id) == uses.end()) continue;
    for (std::size_t i = 0; i < departures_of(sources.front(), m).size(); ++i)
      words.departures.push_back(
          in_all(sources, [&](const Source& s) { return departures_of(s, m)[i]; }));
    if (!own) continue;
    words.title = in_all(sources, [&](const Source& s) {
      return pages::analysis_title(s, a) + " – " + pages::heading_of(s, m);
    });
    words.test = in_all(sources, [&](const Source& s) {
      return pages::test_of(s, m) + " " + test_parameters(s, m);
    });
    words.conditions = conditions(sources, m.observations);
    const std::string& adjustment = m.measurement.adjustment;
    if (!adjustment.empty()) words.status = adjustment + "Adjustment";
  }
  words.method = in_all(sources, [&](const Source& s) { return method_of(s, a); });
  return words;
}

void add_decided(const std::vector<Source>& sources, dcc::About& about) {
  const OutputInput& in = sources.front().in;
  for (const Conformity& c : in.results.conformity) {
    const bool is_stated = std::any_of(
        in.results.analyses.begin(), in.results.analyses.end(), [&](const Results::Analysed& a) {
          const auto& values = a.evaluation.values;
          return a.plugin == c.plugin && a.measurement == c.measurement &&
                 std::any_of(values.begin(), values.end(),
                             [&](const Value& v) { return v.name == c.name && v.U; });
        });
    if (!is_stated) continue;
    dcc::Decided d;
    d.name = in_all(sources, [&](const Source& s) {
      return pages::symbol(c.name) + ", " + c.measurement + ": " + s.words.get("conformity.limit") +
             " " + pages::plain_number(s, c.tolerance, c.quantity) + " " + unit_text(c.quantity);
    });
    d.says = in_all(sources, [&](const Source& s) { return pages::decision_text(s, c.decision); });
    d.is = c.decision == Decision::conforms           ? "pass"
           : c.decision == Decision::does_not_conform ? "fail"
                                                      : "";
    about.decided.push_back(std::move(d));
  }
  about.rule = in_all(sources, [](const Source& s) { return pages::rule_text(s); });
  const std::string& rule = in.campaign.certificate.decision_rule;
  about.norm = rule.starts_with("ilac")    ? "ILAC-G8:09/2019"
               : rule == "iso14253-1:2013" ? "ISO 14253-1:2013"
                                           : "ISO 14253-1:2017";
}

void add_statements(const std::vector<Source>& sources, dcc::About& about) {
  const OutputInput& in = sources.front().in;
  const CertificateTexts& t = in.campaign.certificate;
  const auto add = [&](const char* ref_type, dcc::Text says) {
    about.statements.push_back({ref_type, std::move(says)});
  };
  const auto own = [&](const char* key, const std::string& text) {
    if (!text.empty())
      add("", in_all(sources, [&](const Source& s) { return labelled(s, key, text); }));
  };
  add("basic_metrologicallyTraceableToSI", in_all(sources, [&](const Source& s) {
        return s.words.get("method_heading.traceability",
                           {{"certificate", in.campaign.instrument.certificate}});
      }));
  if (!expired_text(sources.front()).empty())
    add("", in_all(sources, [](const Source& s) { return expired_text(s); }));
  if (!in.issue->replaces.empty())
    add("basic_revision", in_all(sources, [](const Source& s) { return amendment_text(s); }));
  own("method_heading.title", t.procedure);
  if (!t.deviations.empty())
    add("", in_all(sources, [&](const Source& s) {
          return s.words.get("method_heading.deviations", {{"deviations", t.deviations}});
        }));
  if (!t.no_other_deviations_by.empty())
    add("", in_all(sources, [&](const Source& s) {
          return s.words.get("method_heading.nothing_else", {{"person", t.no_other_deviations_by}});
        }));
  own("conditions.title", t.conditions);
  own("opinions.title", t.opinions);
  own("parties.place", in.campaign.site);
  for (const Results::Analysed& a : in.results.analyses)
    if (is_printed(a) && !pages::cmc_text(sources.front(), a).empty())
      add("", in_all(sources, [&](const Source& s) {
            return s.words.get(
                "method_heading.departures_of",
                {{"measurement", a.measurement}, {"departures", pages::cmc_text(s, a)}});
          }));
  if (!not_reported_text(sources.front()).empty())
    add("", in_all(sources, [](const Source& s) { return not_reported_text(s); }));
  if (!undecided_text(sources.front()).empty())
    add("", in_all(sources, [](const Source& s) { return undecided_text(s); }));
  if (has_directions(in)) add("", word(sources, "notes.sign"));
  add("", word(sources, "notes.items"));
  add("", word(sources, "statements.whole"));
  if (!t.customer_data.empty())
    add("", in_all(sources, [&](const Source& s) {
          std::string keys;
          for (const std::string& key : t.customer_data) keys += (keys.empty() ? "" : ", ") + key;
          return keys + ": " + s.words.get("statements.customer_data");
        }));
}

}  // namespace

dcc::About about_of(const std::vector<Source>& sources, const char* release) {
  const OutputInput& in = sources.front().in;
  const Campaign& c = in.campaign;
  dcc::About about{in.issue->number, c.certificate.languages, c.certificate.location, "certificate",
                   release};
  about.only_with_U = true;
  about.not_reported = reports::model_analysis;
  for (const Results::Analysed& a : in.results.analyses) {
    if (!is_printed(a)) continue;
    about.words[dcc::name_of(a)] = words_of(sources, a);
    for (const Value& v : a.evaluation.values)
      about.meaning[v.name] = in_all(sources, [&](const Source& s) {
        return pages::meaning_of(s, pages::without_rule(v.name));
      });
  }
  about.lowest = word(sources, "conditions.lowest");
  about.highest = word(sources, "conditions.highest");
  about.uncertainty = in_all(sources, [](const Source& s) {
    return s.words.get("notes.uncertainty") + " " + s.words.get("statements.guides");
  });
  about.item = in_all(sources, [&](const Source& s) {
    const std::string& structure = c.machine.structure;
    return joined(
        {labelled(s, "item.structure",
                  structure.empty() ? "" : s.words.get_or("structure." + structure, structure)),
         labelled(s, "item.control", c.machine.control),
         labelled(s, "item.condition", c.machine.condition)});
  });
  about.equipment = in_all(sources, [&](const Source& s) {
    return joined({labelled(s, "instrument.calibrated", c.instrument.calibrated),
                   labelled(s, "instrument.uncertainty", pages::instrument_U(s))});
  });
  about.register_name = word(sources, "authority.register");
  about.released = in_all(sources, [&](const Source& s) {
    return s.words.get("authority.rules", {{"name", c.laboratory.authoriser}});
  });
  add_decided(sources, about);
  add_statements(sources, about);
  return about;
}

}  // namespace nonio::certificate
