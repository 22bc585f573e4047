// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>

#include "laboratory/assessment/assess.h"
#include "nonio/reports/wording.h"
#include "nonio/sdk/format.h"
#include "nonio/sdk/json_writer.h"
#include "nonio/sdk/units.h"
#include "platform/storage/json_values.h"

namespace nonio::assessment {

namespace {

using reports::HistoryPoint;
using reports::HistorySeries;

const char* name_of(HistoryPoint::State state) {
  switch (state) {
    case HistoryPoint::State::as_left:
      return "as-left";
    case HistoryPoint::State::check:
      return "check";
    case HistoryPoint::State::as_found:
      break;
  }
  return "as-found";
}

void put_text_or_null(JsonWriter& json, std::string_view name, const std::string& text) {
  json.key(name);
  if (text.empty())
    json.null();
  else
    json.value(text);
}

class HistoryWriter {
 public:
  explicit HistoryWriter(JsonWriter& json) : json_(json) {}

  void put(const std::string& machine, const HistorySeries& s) {
    unit_ = s.unit;
    json_.begin_object();
    json_.member("machine", machine);
    json_.member("axis", s.axis);
    json_.member("quantity", s.quantity);
    if (!s.line.empty()) json_.member("line", s.line);
    json_.member("unit", unit_of(s.unit).symbol);
    if (s.ended) json_.member("ended", true);
    if (s.compared_over) {
      json_.key("compared_over");
      json_.begin_object();
      const auto& over = *s.compared_over;
      json_.member("from", printed(over.from, s.position()));
      json_.member("to", printed(over.to, s.position()));
      json_.member("unit", unit_of(s.position()).symbol);
      json_.end_object();
    }
    json_.list("points", s.points, [&](const HistoryPoint& p) { put(p); });
    if (!s.model.empty()) {
      json_.member("model", s.model);
      json_.list("segments", s.segments, [&](const auto& g) { put(g); });
      json_.list("changes", s.changes, [&](const auto& c) { put(c); });
      json_.key("smallest_change");
      number_or_null(s.smallest_change);
      json_.key("forecast");
      if (s.forecast)
        put(*s.forecast, s.limit);
      else
        json_.null();
    } else if (s.limit) {
      number("limit", *s.limit);
      if (s.forecast && !s.forecast->of_largest) {
        json_.key("forecast");
        put(*s.forecast, s.limit);
      }
    }
    json_.end_object();
  }

  void put(const std::string& machine, const reports::TableLoaded& t) {
    unit_ = t.unit;
    json_.begin_object();
    json_.member("machine", machine);
    json_.member("axis", t.axis);
    json_.member("kind", t.kind);
    if (!t.table.empty()) json_.member("table", t.table);
    if (t.kind == "offset") json_.member("points", static_cast<std::int64_t>(t.points));
    json_.member("after", t.after_campaign);
    json_.member("before", t.before_campaign);
    json_.member("unit", unit_of(t.unit).symbol);
    number("rms", t.rms);
    number("left", t.left);
    json_.member("stated", t.is_stated);
    json_.end_object();
  }

 private:
  void number(std::string_view name, double si) {
    json_.key(name);
    number_or_null(si);
  }
  void number_or_null(std::optional<double> si) {
    if (si && std::isfinite(*si))
      json_.value(printed(*si, unit_));
    else
      json_.null();
  }

  void put(const HistoryPoint& p) {
    json_.begin_object();
    json_.member("campaign", p.campaign);
    json_.member("date", p.date);
    json_.member("state", name_of(p.state));
    number("value", p.value);
    number("u", p.u);
    number("u_common", std::max(0.0, p.u_common));
    number("U", 2.0 * reports::u_of_value(p));
    json_.member("joined", p.joined);
    if (!p.joined) json_.member("why_not", p.why_not);
    json_.end_object();
  }

  void put(const reports::HistorySegment& s) {
    json_.begin_object();
    json_.member("from", s.from_campaign);
    json_.member("to", s.to_campaign);
    number("value", s.last);
    number("u", s.u_last);
    number("slope_per_year", s.slope);
    number("u_slope", s.u_slope);
    json_.end_object();
  }

  void put(const reports::HistoryChange& c) {
    json_.begin_object();
    json_.member("after", c.after_campaign);
    json_.member("before", c.before_campaign);
    number("size", c.size);
    number("u", c.u);
    json_.member("p", c.p_alone);
    json_.member("p_adjusted", c.p);
    json_.member("cause", c.cause);
    put_text_or_null(json_, "event", c.event);
    json_.end_object();
  }

  void put(const reports::HistoryForecast& f, std::optional<double> limit) {
    const bool says = f.answer != "cannot-say";
    json_.begin_object();
    json_.member("date", f.date);
    json_.key("value");
    number_or_null(says ? std::optional(f.value) : std::nullopt);
    json_.key("u");
    number_or_null(says ? std::optional(f.u) : std::nullopt);
    json_.key("limit");
    number_or_null(limit);
    json_.key("p_out");
    if (says && limit && std::isfinite(f.p_out))
      json_.value(f.p_out);
    else
      json_.null();
    put_text_or_null(json_, "leaves", says ? f.leaves : "");
    json_.member("answer", f.answer == "expected"        ? "keep"
                           : f.answer == "other-decides" ? "watch"
                                                         : f.answer);
    json_.end_object();
  }

  JsonWriter& json_;
  Quantity unit_ = Quantity::number;
};

void put_machine(JsonWriter& json, const reports::MachineHistory& m, const Templates& templates) {
  json.begin_object();
  json.member("machine", m.id);
  put_text_or_null(json, "next_due", m.due);
  json.key("proposal");
  json.begin_object();
  json.key("months");
  if (m.proposal.months)
    json.value(static_cast<std::uint64_t>(*m.proposal.months));
  else
    json.null();
  json.member("method", m.proposal.method);
  json.member("why", finding_text(templates, "en", m.proposal.why, "says"));
  json.end_object();
  json.end_object();
}

}  // namespace

std::string history_json(const reports::SiteHistory& site, const LastRun& last_run,
                         const Templates& templates) {
  JsonWriter json;
  HistoryWriter writer(json);
  json.begin_object();
  json.member("schema", "nonio-history/1");
  json.member("night", last_run.run);
  json.member("date", last_run.date);
  json.list("series", site.machines, [&](const reports::MachineHistory& m) {
    for (const HistorySeries& s : m.series) writer.put(m.id, s);
  });
  json.list("machines", site.machines,
            [&](const reports::MachineHistory& m) { put_machine(json, m, templates); });
  if (std::any_of(site.machines.begin(), site.machines.end(),
                  [](const auto& m) { return !m.tables_loaded.empty(); })) {
    json.list("tables_loaded", site.machines, [&](const reports::MachineHistory& m) {
      for (const reports::TableLoaded& t : m.tables_loaded) writer.put(m.id, t);
    });
  }
  json.objects("vanished", last_run.vanished, [&](const LastRun::Vanished& v) {
    json.member("campaign", v.campaign);
    json.member("folder", v.folder);
    json.member("last_seen_night", v.last_seen_run);
  });
  json.end_object();
  return json.take();
}

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
