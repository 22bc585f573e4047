// SPDX-License-Identifier: Apache-2.0
//
// Blocks of the first page and the statements; clauses are those of ISO/IEC 17025:2017.
#include <algorithm>
#include <cmath>

#include "certificate.h"
#include "nonio/reports/number.h"
#include "nonio/sdk/format.h"

namespace nonio::certificate {

using namespace reports;
using Look = Paragraph::Look;

namespace {

void widen(Range& range, const std::vector<double>& values) {
  for (const double v : values)
    if (std::isfinite(v)) range.low = std::min(range.low, v), range.high = std::max(range.high, v);
}

/// "19.8 – 20.3 °C", or one number where nothing changed.
std::string range_text(const Source& source, const Range& range, Quantity q, const char* unit,
                       int decimals) {
  if (!range.known()) return {};
  const auto number = [&](double v) { return printed_number(v, q, decimals, source.language()); };
  const std::string low = number(range.low), high = number(range.high);
  return (low == high ? low : low + " – " + high) + " " + unit;
}

std::string label(const Source& source, const char* key) { return source.words.get(key); }

void paragraph(Blocks& blocks, std::string text, std::string field, Look look = Look::small) {
  if (!text.empty()) blocks.push_back({Paragraph{std::move(text), look}, std::move(field)});
}

/// "2026-03-23", or "2026-03-23 – 2026-03-25".
std::string days(const Campaign& c) {
  return c.end_date.empty() || c.end_date == c.date ? c.date : c.date + " – " + c.end_date;
}

const Value* value_of(const OutputInput& in, const Conformity& c) {
  for (const Results::Analysed& a : in.results.analyses)
    if (a.plugin == c.plugin && a.measurement == c.measurement)
      for (const Value& v : a.evaluation.values)
        if (v.name == c.name) return &v;
  return nullptr;
}

}  // namespace

Conditions conditions_of(const std::vector<Observations>& observations) {
  const Range none{INFINITY, -INFINITY};
  Conditions c{none, none, none, none};
  for (const Observations& o : observations) {
    widen(c.material, o.material);
    widen(c.air, o.air);
    widen(c.pressure, o.pressure);
    widen(c.humidity, o.humidity);
  }
  return c;
}

std::string method_of(const Source& source, const Results::Analysed& a) {
  std::string edition, k;
  for (const Remark& note : a.evaluation.notes)
    for (const Number& n : note.evidence) {
      const std::string text = printed_number(n.value, Quantity::number, 0, source.language());
      if (n.name == "edition") edition = text;
      if (n.name == "k") k = text;
    }
  const std::string key = "method." + a.plugin;
  if (source.words.get_or(key, "").empty()) return pages::analysis_title(source, a);
  return source.words.get(key, {{"edition", edition}, {"k", k}});
}

void add_title(const Source& source, Blocks& blocks) {
  const Campaign& c = source.in.campaign;
  const Laboratory& l = c.laboratory;
  Blocks by;
  for (const std::string& name : {source.look.logo, source.look.mark})
    if (const auto file = source.in.templates.files.find(name);
        !name.empty() && file != source.in.templates.files.end())
      by.push_back({Image{file->second, "templates/" + name, source.look.logo_height}, "logo"});
  paragraph(by, l.name, "laboratory.name", Look::bold);
  paragraph(by, l.address + (l.country.empty() ? "" : " · " + l.country), "laboratory.address",
            Look::muted);
  paragraph(by, l.contact, "laboratory.contact", Look::muted);
  if (!l.accreditation.empty())
    paragraph(by, source.words.get("title.accreditation", {{"accreditation", l.accreditation}}),
              "laboratory.accreditation", Look::muted);
  Blocks title = {
      {Heading{title_of(source), 0}, "certificate.title"},
      {Paragraph{source.words.get("title.number", {{"number", source.in.issue->number}}),
                 Look::bold},
       "title.number"},
      {Paragraph{source.words.get("title.issued", {{"date", source.in.issue->date}}), Look::body},
       "title.issued"}};
  blocks.push_back({Columns{{std::move(title), std::move(by)}, {0.6, 0.4}}, "title"});
  blocks.push_back({Spacer{6}});
}

void add_amendment(const Source& source, Blocks& blocks) {
  const Issue& issue = *source.in.issue;
  if (issue.replaces.empty()) return;
  std::string changes;
  for (const std::string& name : issue.changes) changes += (changes.empty() ? "" : ", ") + name;
  std::string text = source.words.get("amendment.replaces",
                                      {{"number", issue.replaces}, {"date", issue.replaces_date}});
  if (!changes.empty()) text += " " + source.words.get("amendment.changes", {{"changes", changes}});
  if (const std::string& why = source.in.campaign.certificate.amendment; !why.empty())
    text += " " + source.words.get("amendment.why", {{"why", why}});
  blocks.push_back({Note{Level::attention, source.words.get("amendment.title"), text, ""},
                    "certificate.amendment"});
}

void add_parties(const Source& source, Blocks& blocks) {
  const Campaign& c = source.in.campaign;
  const std::string place =
      c.site + " (" + source.words.get("location." + c.certificate.location) + ")";
  Grid customer{
      label(source, "parties.customer"),
      {{label(source, "parties.name"), c.customer, "campaign.customer"},
       {label(source, "parties.address"), c.customer_address, "campaign.customer_address"}}};
  Grid work{label(source, "parties.work"),
            {{label(source, "parties.place"), place, "campaign.site"},
             {label(source, "parties.received"), c.received, "campaign.received"},
             {label(source, "parties.performed"), days(c), "campaign.date"},
             {label(source, "parties.operator"), c.operator_name, "campaign.operator"}}};
  blocks.push_back(
      {Columns{{{{std::move(customer), "customer"}}, {{std::move(work), "work"}}}}, "parties"});
}

namespace {

/// "Thermo T2, no. 17, certificate C-3 (LAT 9), calibrated 2026-01-02, valid until 2027-01-02".
std::string sensor_text(const Source& source, const Sensor& s) {
  std::string text;
  const auto add = [&](const std::string& part, const char* between = ", ") {
    if (!part.empty()) text += (text.empty() ? "" : between) + part;
  };
  const auto said = [&](const char* key, const std::string& value) {
    if (!value.empty()) add(source.words.get(key, {{"value", value}}));
  };
  add(s.maker);
  add(s.model, " ");
  said("sensor.serial", s.serial);
  said("sensor.certificate", s.certificate);
  if (!s.issuer.empty()) add("(" + s.issuer + ")", " ");
  said("sensor.calibrated", s.calibrated);
  said("sensor.valid_until", s.valid_until);
  return text;
}

}  // namespace

void add_item(const Source& source, Blocks& blocks) {
  const Machine& m = source.in.campaign.machine;
  const Instrument& i = source.in.campaign.instrument;
  const std::string structure =
      m.structure.empty() ? "" : source.words.get_or("structure." + m.structure, m.structure);
  Grid item{label(source, "item.title"),
            {{label(source, "item.description"), m.description, "machine.description"},
             {label(source, "item.maker"), m.maker, "machine.maker"},
             {label(source, "item.model"), m.model, "machine.model"},
             {label(source, "item.serial"), m.serial, "machine.serial"},
             {label(source, "item.structure"), structure, "machine.structure"},
             {label(source, "item.control"), m.control, "machine.control"},
             {label(source, "item.condition"), m.condition, "machine.condition"}}};
  Grid instrument{
      label(source, "instrument.title"),
      {{label(source, "item.maker"), i.maker, "instrument.maker"},
       {label(source, "item.model"), i.model, "instrument.model"},
       {label(source, "item.serial"), i.serial, "instrument.serial"},
       {label(source, "instrument.certificate"), i.certificate, "instrument.certificate"},
       {label(source, "instrument.issuer"), i.issuer, "instrument.issuer"},
       {label(source, "instrument.calibrated"), i.calibrated, "instrument.calibrated"},
       {label(source, "instrument.valid_until"), i.valid_until, "instrument.valid_until"},
       {label(source, "instrument.uncertainty"), pages::instrument_U(source), "instrument.U"}}};
  for (const Sensor& s : source.in.campaign.sensors)
    instrument.rows.push_back(
        {source.words.get("sensor." + s.measures), sensor_text(source, s), "sensor " + s.measures});
  blocks.push_back(
      {Columns{{{{std::move(item), "machine"}}, {{std::move(instrument), "instrument"}}}}, "item"});
}

void add_method(const Source& source, Blocks& blocks) {
  const CertificateTexts& texts = source.in.campaign.certificate;
  blocks.push_back({Heading{label(source, "method_heading.title"), 2}, "method_heading.title"});
  std::vector<std::string> methods;
  for (const Results::Analysed& a : source.in.results.analyses) {
    if (!is_printed(a)) continue;
    const std::string method = method_of(source, a);
    if (std::find(methods.begin(), methods.end(), method) == methods.end())
      methods.push_back(method);
  }
  std::string all;
  for (const std::string& method : methods) all += (all.empty() ? "" : " ") + method;
  paragraph(blocks, all, "method");
  if (!texts.procedure.empty())
    paragraph(blocks,
              source.words.get("method_heading.procedure", {{"procedure", texts.procedure}}),
              "certificate.procedure");
  paragraph(blocks,
            texts.deviations.empty()
                ? source.words.get("method_heading.no_deviations")
                : source.words.get("method_heading.deviations", {{"deviations", texts.deviations}}),
            "certificate.deviations");
  paragraph(blocks,
            source.words.get("method_heading.traceability",
                             {{"certificate", source.in.campaign.instrument.certificate}}),
            "instrument.certificate");
}

void add_conditions(const Source& source, Blocks& blocks) {
  const Conditions c = conditions_of(source.in.observations);
  std::string all;
  const auto add = [&](const char* key, const Range& range, Quantity q, const char* unit,
                       int decimals) {
    if (range.known())
      all += (all.empty() ? "" : " ") +
             source.words.get(key, {{"range", range_text(source, range, q, unit, decimals)}});
  };
  add("conditions.material", c.material, Quantity::temperature, "°C", 1);
  add("conditions.air", c.air, Quantity::temperature, "°C", 1);
  add("conditions.pressure", c.pressure, Quantity::number, "hPa", 0);
  add("conditions.humidity", c.humidity, Quantity::number, "%", 0);
  const std::string& stated = source.in.campaign.certificate.conditions;
  if (all.empty() && stated.empty()) return;
  blocks.push_back({Heading{label(source, "conditions.title"), 2}, "conditions.title"});
  paragraph(blocks, all, "conditions");
  paragraph(blocks, stated, "certificate.conditions");
}

void add_conformity(const Source& source, Blocks& blocks) {
  const Wording& w = source.words;
  Table table;
  table.columns = {
      {w.get("conformity.measurement"), "", false}, {w.get("results.symbol"), "", false},
      {w.get("results.value"), "", true},           {w.get("results.uncertainty"), "", true},
      {w.get("results.tolerance"), "", true},       {"", "", false},
      {w.get("results.decision"), "", false}};
  for (const Conformity& c : source.in.results.conformity) {
    const Value* v = value_of(source.in, c);
    if (v == nullptr || !v->U) continue;
    const Printed shown = printed_result(v->value, v->U, c.quantity, source.language());
    const bool good = c.decision == Decision::conforms;
    table.rows.push_back({{c.measurement},
                          {pages::symbol(c.name), true},
                          {shown.value},
                          {shown.U},
                          {pages::plain_number(source, c.tolerance, c.quantity)},
                          {unit_text(c.quantity)},
                          {pages::decision_text(source, c.decision), !good,
                           good                                       ? Level::good
                           : c.decision == Decision::does_not_conform ? Level::failed
                                                                      : Level::attention}});
  }
  if (table.rows.empty()) return;
  blocks.push_back({Heading{w.get("conformity.title"), 1}, "conformity.title"});
  blocks.push_back({std::move(table), "conformity"});
  paragraph(blocks, w.get("conformity.rule"), "conformity.rule");
}

void add_opinions(const Source& source, Blocks& blocks) {
  const std::string& opinions = source.in.campaign.certificate.opinions;
  if (opinions.empty()) return;
  blocks.push_back({Heading{label(source, "opinions.title"), 2}, "opinions.title"});
  paragraph(blocks, opinions, "certificate.opinions");
}

void add_statements(const Source& source, Blocks& blocks) {
  const Wording& w = source.words;
  paragraph(blocks, w.get("notes.uncertainty") + " " + w.get("statements.guides"), "statements");
  paragraph(blocks, w.get("notes.sign"), "notes.sign");
  paragraph(blocks, w.get("notes.items") + " " + w.get("statements.whole"), "statements");
  if (!source.in.campaign.certificate.customer_data.empty())
    paragraph(blocks, "* " + w.get("statements.customer_data"), "statements.customer_data");
}

void add_authority(const Source& source, Blocks& blocks) {
  const Wording& w = source.words;
  Grid grid{
      w.get("authority.title"),
      {{w.get("authority.by"), source.in.campaign.laboratory.authoriser, "laboratory.authoriser"},
       {w.get("authority.signed"), w.get("authority.electronic"), "authority.electronic"},
       {w.get("authority.verify"), w.get("authority.how"), "authority.how"},
       {w.get("authority.readings"), source.in.issue->readings_sha256, "readings"}}};
  blocks.push_back({std::move(grid), "authority"});
}

}  // namespace nonio::certificate
