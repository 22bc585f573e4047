// SPDX-License-Identifier: Apache-2.0
#include "laboratory/assessment/assess.h"
#include "nonio/reports/wording.h"
#include "nonio/sdk/format.h"
#include "nonio/sdk/units.h"
#include "platform/storage/json_values.h"

namespace nonio::assessment {

namespace {

using reports::WorkItem;
using storage::Json;

const char* name_of(WorkItem::Kind kind) {
  constexpr const char* names[] = {"lost",    "failed",   "out",       "changed",    "soon",
                                   "overdue", "withheld", "undecided", "information"};
  return names[static_cast<std::size_t>(kind)];
}

const char* name_of(WorkItem::State state) {
  constexpr const char* names[] = {"new", "known", "fixed"};
  return names[static_cast<std::size_t>(state)];
}

void put(Json& json, const char* name, const std::string& text) {
  if (!text.empty()) json[name] = text;
}

void put_numbers(Json& json, const std::optional<double>& value, const std::optional<double>& u,
                 const std::optional<double>& limit, Quantity unit) {
  const double per_si = unit_of(unit).per_si;
  if (value) json["value"] = *value * per_si;
  if (value && u) json["u"] = *u * per_si;
  if (limit) json["limit"] = *limit * per_si;
  if (value || limit) json["unit"] = unit_of(unit).symbol;
}

Json json_of(const reports::OpenValue& v) {
  Json json = Json::object();
  put(json, "axis", v.axis);
  put(json, "quantity", v.quantity);
  put(json, "campaign", v.campaign);
  put(json, "measurement", v.measurement);
  put_numbers(json, v.value, v.u, v.limit, v.unit);
  json["decision"] = v.undecided ? "cannot be decided" : "does not conform";
  return json;
}

Json json_of(const WorkItem& l, const Templates& templates, const std::string& language) {
  Json json = {{"id", l.id}, {"kind", name_of(l.kind)}, {"state", name_of(l.state)}};
  put(json, "machine", l.machine);
  put(json, "axis", l.axis);
  put(json, "quantity", l.quantity);
  put(json, "campaign", l.campaign);
  put(json, "customer", l.customer);
  put(json, "measurement", l.measurement);
  put_numbers(json, l.value, l.u, l.limit, l.unit);
  if (!l.also.empty()) json["also"] = Json::array();
  for (const reports::OpenValue& v : l.also) json["also"].push_back(json_of(v));
  if (!l.campaigns.empty()) json["campaigns"] = l.campaigns;
  put(json, "says", reports::line_text(templates, language, l, "says"));
  put(json, "advice", reports::line_text(templates, language, l, "advice"));
  put(json, "since", l.since);
  put(json, "link", l.link);
  put(json, "by", l.by);
  put(json, "until", l.until);
  put(json, "why", l.why);
  json["mail"] = reports::asks_by_mail(l);
  return json;
}

}  // namespace

std::string lines_json(const reports::SiteHistory& site, const Templates& templates,
                       const std::string& language) {
  std::string out = "[";
  for (const WorkItem& l : site.lines)
    out += (&l == &site.lines.front() ? "\n  " : ",\n  ") +
           json_of(l, templates, language).dump(-1, ' ', false, Json::error_handler_t::replace);
  return out + (site.lines.empty() ? "]" : "\n ]");
}

}  // namespace nonio::assessment
