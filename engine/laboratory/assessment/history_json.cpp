// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>

#include "laboratory/assessment/assess.h"
#include "nonio/sdk/format.h"
#include "nonio/sdk/json_writer.h"
#include "nonio/sdk/units.h"

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
      if (s.forecast) {
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
    json_.member("answer", f.answer);
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

}  // namespace nonio::assessment
