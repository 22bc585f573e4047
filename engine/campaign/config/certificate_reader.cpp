// SPDX-License-Identifier: Apache-2.0
#include "campaign/config/certificate_reader.h"

#include <tuple>

#include "campaign/config/number_pattern.h"

namespace nonio::config {

CertificateTexts read_certificate(TableReader& reader) {
  CertificateTexts c;
  c.languages = reader.texts("languages").value_or(std::vector<std::string>{});
  c.form = reader.text("template");
  c.location = reader.text("location");
  c.procedure = reader.text("procedure");
  c.title = reader.translations("title");
  c.decision_rule = reader.text("decision_rule");
  return c;
}

void read_certificate_of_campaign(TableReader& reader, CertificateTexts& into) {
  into.deviations = reader.text("deviations");
  into.no_other_deviations_by = reader.text("no_other_deviations_by");
  into.conditions = reader.text("conditions");
  into.opinions = reader.text("opinions");
  into.amendment = reader.text("amendment");
  into.customer_data = reader.texts("customer_data").value_or(std::vector<std::string>{});
}

Numbering read_numbering(TableReader& reader) {
  Numbering n;
  if (const std::string pattern = reader.text("numbering"); !pattern.empty()) n.pattern = pattern;
  if (const std::string file = reader.text("register"); !file.empty()) n.register_file = file;
  n.patience = reader.number("register_seconds").value_or(n.patience);
  n.automatic = reader.text("release") == "automatic";
  n.two_persons = reader.flag("two_persons").value_or(false);
  for (TableReader& rule : reader.tables("accept")) {
    n.accepted.push_back({rule.text("finding"), rule.text("reason")});
    rule.finish();
  }
  if (n.automatic && !reader.raw().contains("accept"))
    reader.error("release",
                 "\"automatic\" requires the list of accepted findings, [[certificate.accept]] "
                 "with finding and reason; accept = [] if none is accepted");
  if (n.automatic && n.two_persons)
    reader.error("two_persons", "true and release = \"automatic\" contradict each other");
  if (const auto sound = number_text(n.pattern, "2026", 1); !sound)
    reader.error("numbering", sound.error().message);
  return n;
}

CertificateTexts certificate_of(const CertificateTexts& site, const CertificateTexts& campaign) {
  CertificateTexts out = campaign;
  if (out.languages.empty()) out.languages = site.languages;
  if (out.languages.empty()) out.languages = {"en"};
  if (out.title.empty()) out.title = site.title;
  for (const auto& [mine, others, otherwise] :
       {std::tuple{&out.form, &site.form, "certificate"},
        {&out.location, &site.location, "customer"},
        {&out.procedure, &site.procedure, ""},
        {&out.decision_rule, &site.decision_rule, "iso14253-1"}}) {
    if (mine->empty()) *mine = *others;
    if (mine->empty()) *mine = otherwise;
  }
  return out;
}

}  // namespace nonio::config
