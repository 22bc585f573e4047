// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cctype>
#include <set>
#include <string_view>

#include "certificate.h"
#include "dcc.h"
#include "nonio/reports/model.h"
#include "nonio/sdk/statement.h"

namespace nonio::certificate {

namespace {

/// False for placeholders such as "n/a", "unknown", "xxx", "000".
bool names_something(std::string_view text) {
  if (!has_content(text)) return false;
  std::string letters;
  for (const char c : text)
    if (std::isalnum(static_cast<unsigned char>(c)) != 0 || static_cast<unsigned char>(c) >= 0x80)
      letters += static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  static const std::set<std::string> nothing = {"na",   "nd",      "nn",  "none", "nil",
                                                "null", "unknown", "tbd", "todo"};
  return !nothing.contains(letters) && letters.find_first_not_of("x0") != std::string::npos;
}

class List {
 public:
  void want(bool there, std::string key) {
    if (!there && seen_.insert(key).second) keys_.push_back(std::move(key));
  }
  void laboratory(const std::string& value, const char* key) {
    want(has_content(value), std::string("laboratory.") + key + " (site.toml)");
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

/// A budget with a zero entry, for example no drift, also prevents a certificate, because a result
/// would lack U.
void want_uncertainty(const OutputInput& in, List& list) {
  for (const Results::Analysed& a : in.results.analyses) {
    if (a.plugin == reports::model_analysis || a.evaluation.values.empty()) continue;
    for (const Finding& f : a.evaluation.findings)
      for (const auto& [name, text] : f.texts) {
        if (name != "missing") continue;
        if (f.id == "uncertainty.no-data")
          for (std::string& key : split(text)) list.want(false, std::move(key));
        if (f.id == "uncertainty.zero") list.want(false, text + " (0: nothing is without drift)");
      }
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
         std::any_of(values.begin(), values.end(),
                     [](const Value& v) { return v.U && *v.U > 0.0; });
}

bool is_by_own_procedure(const Results::Analysed& a) {
  return a.plugin == "circle" || a.plugin == "thermal" || a.plugin == "spindle" ||
         a.plugin == "lengths";
}

std::vector<std::string> lacks(const OutputInput& in) {
  const Campaign& c = in.campaign;
  List list;
  for (const Results::Analysed& a : in.results.analyses)
    if (is_printed(a) && is_by_own_procedure(a))
      list.want(has_content(c.certificate.procedure),
                "certificate.procedure (site.toml; the laboratory's procedure, which is based on "
                "the standard)");
  list.laboratory(c.laboratory.name, "name");
  list.laboratory(c.laboratory.address, "address");
  list.want(dcc::is_country(c.laboratory.country),
            "laboratory.country (site.toml; two capital letters: IT)");
  list.laboratory(c.laboratory.authoriser, "authoriser");
  if (const std::string claim = accredited_claim(in); !claim.empty())
    list.want(has_content(c.laboratory.accreditation),
              "laboratory.accreditation (site.toml; " + claim + ")");
  list.want(c.laboratory.accreditation.empty() || c.laboratory.cmc.stated(),
            "laboratory.cmc (site.toml; the smallest uncertainty that the accreditation covers)");
  list.want(has_content(c.customer), "campaign.customer");
  list.want(has_content(c.customer_address), "campaign.customer_address");
  list.want(has_content(c.site), "campaign.site");
  list.want(!c.date.empty(), "campaign.date");
  list.want(has_content(c.machine.maker), "machine.maker");
  list.want(has_content(c.machine.model), "machine.model");
  list.want(names_something(c.machine.serial), "machine.serial");
  list.want(has_content(c.instrument.maker), "instrument.maker");
  list.want(has_content(c.instrument.model), "instrument.model");
  list.want(names_something(c.instrument.serial), "instrument.serial");
  list.want(!c.instrument.calibrated.empty(), "instrument.calibrated");
  list.want(names_something(c.instrument.certificate), "instrument.certificate");
  for (const Sensor& s : c.sensors) {
    const std::string key = "sensor " + s.measures + ": ";
    list.want(names_something(s.serial), key + "serial");
    list.want(!s.calibrated.empty(), key + "calibrated");
    list.want(names_something(s.certificate), key + "certificate");
  }
  list.want(c.certificate.no_other_deviations_by.empty() ||
                has_content(c.certificate.no_other_deviations_by),
            "certificate.no_other_deviations_by (a person's name, or not at all)");
  for (const Measurement& m : c.measurements)
    list.want(m.exclude.empty() || has_content(m.exclude_reason),
              "measurement." + m.id + ".exclude_reason (why readings were excluded)");
  const Conditions found = conditions_of(in.observations);
  list.want(found.material.known() || found.air.known() || has_content(c.certificate.conditions),
            "certificate.conditions (no file of readings has temperatures)");
  want_uncertainty(in, list);
  return list.take();
}

}  // namespace nonio::certificate
