// SPDX-License-Identifier: Apache-2.0
#include "campaign/config/certificate_reader.h"

#include <tuple>

#include "campaign/config/checks.h"
#include "campaign/config/number_pattern.h"
#include "campaign/config/toml_reader.h"

namespace nonio::config {

void check_numbering(TableReader& reader, SiteFile& site) {
  const Numbering& n = site.numbering;
  if (n.automatic && !reader.raw().contains("accept"))
    reader.error("release",
                 "\"automatic\" requires the list of accepted findings, [[certificate.accept]] "
                 "with finding and reason; accept = [] if none is accepted");
  if (n.automatic && n.two_persons)
    reader.error("two_persons", "true and release = \"automatic\" contradict each other");
  if (const auto sound = number_text(n.pattern, "2026", 1); !sound)
    reader.error("numbering", sound.error().message);
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
