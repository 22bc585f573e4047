// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cctype>
#include <set>

#include "certificate.h"
#include "dcc.h"
#include "nonio/reports/model.h"

namespace nonio::certificate {

namespace {

/// A serial number of blanks, dashes or "n/a" names no instrument.
bool names_something(std::string text) {
  for (const std::string_view mark : {"\u2010", "\u2011", "\u2012", "\u2013", "\u2014", "\u2015",
                                      "\u2212", "\uff0d", "\u00a0", "\u3000"})  // dashes, blanks
    for (std::size_t at; (at = text.find(mark)) != std::string::npos;) text.erase(at, mark.size());
  std::string letters;
  for (const char c : text)
    if (std::isalnum(static_cast<unsigned char>(c)) != 0 || static_cast<unsigned char>(c) >= 0x80)
      letters += static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  static const std::set<std::string> nothing = {"",    "na",   "nd",      "nn",  "none",
                                                "nil", "null", "unknown", "tbd", "todo"};
  return !nothing.contains(letters) && letters.find_first_not_of("x0") != std::string::npos;
}

class List {
 public:
  void want(bool there, std::string key) {
    if (!there && seen_.insert(key).second) keys_.push_back(std::move(key));
  }
  void laboratory(const std::string& value, const char* key) {
    want(!value.empty(), std::string("laboratory.") + key + " (site.toml)");
  }
  std::vector<std::string> take() { return std::move(keys_); }

 private:
  std::vector<std::string> keys_;
  std::set<std::string> seen_;
};

std::vector<std::string> split(const std::string& text) {
  std::vector<std::string> out;
  for (std::size_t at = 0; at < text.size();) {
    const std::size_t end = std::min(text.find(", ", at), text.size());
    out.push_back(text.substr(at, end - at));
    at = end + 2;
  }
  return out;
}

/// The keys of the uncertainty budget, as the analyses name them.
void want_uncertainty(const OutputInput& in, List& list) {
  for (const Results::Analysed& a : in.results.analyses) {
    if (a.plugin == reports::model_analysis || a.evaluation.values.empty() || is_printed(a))
      continue;
    for (const Finding& f : a.evaluation.findings)
      for (const auto& [name, text] : f.texts)
        if (f.id == "uncertainty.no-data" && name == "missing")
          for (std::string& key : split(text)) list.want(false, std::move(key));
  }
  const auto& analyses = in.results.analyses;
  list.want(std::any_of(analyses.begin(), analyses.end(),
                        [](const Results::Analysed& a) { return is_printed(a); }),
            "a result with an uncertainty (no analysis gives one; see the findings)");
}

}  // namespace

bool is_printed(const Results::Analysed& a) {
  const auto& values = a.evaluation.values;
  return a.plugin != reports::model_analysis &&
         std::any_of(values.begin(), values.end(), [](const Value& v) { return v.U.has_value(); });
}

std::vector<std::string> lacks(const OutputInput& in) {
  const Campaign& c = in.campaign;
  List list;
  list.laboratory(c.laboratory.name, "name");
  list.laboratory(c.laboratory.address, "address");
  list.want(dcc::is_country(c.laboratory.country),
            "laboratory.country (site.toml; two capital letters: IT)");
  list.laboratory(c.laboratory.authoriser, "authoriser");
  if (const std::string claim = accredited_claim(in); !claim.empty())
    list.want(!c.laboratory.accreditation.empty(),
              "laboratory.accreditation (site.toml; " + claim + ")");
  list.want(!c.customer.empty(), "campaign.customer");
  list.want(!c.customer_address.empty(), "campaign.customer_address");
  list.want(!c.site.empty(), "campaign.site");
  list.want(!c.date.empty(), "campaign.date");
  list.want(names_something(c.machine.maker), "machine.maker");
  list.want(names_something(c.machine.model), "machine.model");
  list.want(names_something(c.machine.serial), "machine.serial");
  list.want(names_something(c.instrument.maker), "instrument.maker");
  list.want(names_something(c.instrument.model), "instrument.model");
  list.want(names_something(c.instrument.serial), "instrument.serial");
  list.want(!c.instrument.calibrated.empty(), "instrument.calibrated");
  list.want(names_something(c.instrument.certificate), "instrument.certificate");
  for (const Sensor& s : c.sensors) {
    const std::string key = "sensor " + s.measures + ": ";
    list.want(names_something(s.serial), key + "serial");
    list.want(!s.calibrated.empty(), key + "calibrated");
    list.want(names_something(s.certificate), key + "certificate");
  }
  for (const Measurement& m : c.measurements)
    list.want(m.exclude.empty() || !m.exclude_reason.empty(),
              "measurement." + m.id + ".exclude_reason (why readings were excluded)");
  const Conditions found = conditions_of(in.observations);
  list.want(found.material.known() || found.air.known() || !c.certificate.conditions.empty(),
            "certificate.conditions (no file of readings has temperatures)");
  want_uncertainty(in, list);
  return list.take();
}

}  // namespace nonio::certificate
