// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <set>

#include "certificate.h"
#include "dcc.h"
#include "nonio/reports/model.h"

namespace nonio::certificate {

namespace {

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
  list.want(!c.machine.maker.empty(), "machine.maker");
  list.want(!c.machine.model.empty(), "machine.model");
  list.want(!c.machine.serial.empty(), "machine.serial");
  list.want(!c.instrument.maker.empty(), "instrument.maker");
  list.want(!c.instrument.model.empty(), "instrument.model");
  list.want(!c.instrument.serial.empty(), "instrument.serial");
  list.want(!c.instrument.calibrated.empty(), "instrument.calibrated");
  list.want(!c.instrument.certificate.empty(), "instrument.certificate");
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
