// SPDX-License-Identifier: Apache-2.0
#include "host/morning/assess.h"
#include "host/storage/json_values.h"
#include "nonio/reports/wording.h"
#include "nonio/sdk/format.h"
#include "nonio/sdk/units.h"

namespace nonio::host::morning {

namespace {

using reports::MorningLine;
using storage::Json;

const char* name_of(MorningLine::Kind kind) {
  constexpr const char* names[] = {"lost", "failed",  "out",       "changed",
                                   "soon", "overdue", "undecided", "information"};
  return names[static_cast<std::size_t>(kind)];
}

const char* name_of(MorningLine::State state) {
  constexpr const char* names[] = {"new", "known", "fixed"};
  return names[static_cast<std::size_t>(state)];
}

void put(Json& json, const char* name, const std::string& text) {
  if (!text.empty()) json[name] = text;
}

Json json_of(const MorningLine& l, const Templates& templates) {
  Json json = {{"id", l.id}, {"kind", name_of(l.kind)}, {"state", name_of(l.state)}};
  put(json, "machine", l.machine);
  put(json, "axis", l.axis);
  put(json, "quantity", l.quantity);
  put(json, "campaign", l.campaign);
  put(json, "customer", l.customer);
  const double per_si = unit_of(l.unit).per_si;
  if (l.value) {
    json["value"] = *l.value * per_si;
    if (l.u) json["u"] = *l.u * per_si;
    if (l.limit) json["limit"] = *l.limit * per_si;
    json["unit"] = unit_of(l.unit).symbol;
  }
  put(json, "says", finding_text(templates, "en", l.finding, "says"));
  put(json, "advice", finding_text(templates, "en", l.finding, "advice"));
  put(json, "since", l.since);
  put(json, "link", l.link);
  put(json, "by", l.by);
  put(json, "until", l.until);
  put(json, "why", l.why);
  json["mail"] = reports::asks_by_mail(l);
  return json;
}

}  // namespace

std::string lines_json(const reports::SiteHistory& site, const Templates& templates) {
  std::string out = "[";
  for (const MorningLine& l : site.lines)
    out += (&l == &site.lines.front() ? "\n  " : ",\n  ") +
           json_of(l, templates).dump(-1, ' ', false, Json::error_handler_t::replace);
  return out + (site.lines.empty() ? "]" : "\n ]");
}

}  // namespace nonio::host::morning
