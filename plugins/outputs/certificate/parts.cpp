// SPDX-License-Identifier: Apache-2.0
// Blocks of the first page and the statements; clauses are those of ISO/IEC 17025:2017.
#include <algorithm>
#include <cctype>
#include <cmath>
#include <utility>

#include "certificate.h"
#include "nonio/reports/number.h"
#include "nonio/sdk/format.h"
#include "rules.h"

namespace nonio::certificate {

using namespace reports;
using Look = Paragraph::Look;

namespace {

void widen(Range& range, const std::vector<double>& values) {
  for (const double v : values)
    if (std::isfinite(v)) range.low = std::min(range.low, v), range.high = std::max(range.high, v);
}

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

std::string days(const Campaign& c) {
  return c.end_date.empty() || c.end_date == c.date ? c.date : c.date + " – " + c.end_date;
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
  std::string edition, k, window;
  for (const Remark& note : a.evaluation.notes)
    for (const Number& n : note.evidence) {
      const std::string text = printed_number(n.value, Quantity::number, 0, source.language());
      if (n.name == "edition") edition = text;
      if (n.name == "k") k = text;
      if (n.name == "window_min") window = localised(short_text(n.value, 4), source.language());
    }
  const std::string key =
      (pages::follows_plan(source.in, a) ? "method." : "method_own_plan.") + a.plugin;
  if (source.words.get_or(key, "").empty()) return pages::analysis_title(source, a);
  if (const Remark* rules = pages::rules_of(a))
    return source.words.get(key, {{"rules", rules->texts.front().second}});
  return source.words.get(key, {{"edition", edition},
                                {"k", k},
                                {"window_min", window},
                                {"procedure", source.in.campaign.certificate.procedure}});
}

void add_title(const Source& source, Blocks& blocks) {
  const Campaign& c = source.in.campaign;
  const Laboratory& l = c.laboratory;
  Blocks by;
  for (const std::string& name : {source.look.logo, source.look.mark})
    if (const auto file = source.in.templates.files.find(name);
        !name.empty() && file != source.in.templates.files.end())
      by.push_back({Image{std::string(std::string_view(file->second)), "templates/" + name,
                          source.look.logo_height},
                    "logo"});
  paragraph(by, l.name, "laboratory.name", Look::bold);
  paragraph(by, l.address + (l.country.empty() ? "" : " · " + l.country), "laboratory.address",
            Look::muted);
  paragraph(by, l.contact, "laboratory.contact", Look::muted);
  if (!l.accreditation.empty())
    paragraph(by, source.words.get("title.accreditation", {{"accreditation", l.accreditation}}),
              "laboratory.accreditation", Look::muted);
  Blocks title = {
      {Heading{title_of(source), 0}, "certificate.title"},
      {Paragraph{source.in.issue->is_draft()
                     ? number_of(source)
                     : source.words.get("title.number", {{"number", number_of(source)}}),
                 Look::bold},
       "title.number"},
      {Paragraph{source.in.issue->is_draft()
                     ? source.words.get("draft.says")
                     : source.words.get("title.issued", {{"date", source.in.issue->date}}),
                 Look::body},
       "title.issued"}};
  blocks.push_back({Columns{{std::move(title), std::move(by)}, {0.6, 0.4}}, "title"});
  blocks.push_back({Spacer{6}});
}

namespace {

void add_changes(const Source& source, const FileChange& file, Grid& into) {
  const Wording& w = source.words;
  const std::string field = "amendment.changes";
  const auto shown = [&](const std::optional<std::string>& value) {
    return value ? (value->empty() ? "\"\"" : *value) : w.get("amendment.absent");
  };
  if (file.changes.empty()) into.rows.push_back({file.file, w.get("amendment.whole"), field});
  for (const Change& c : file.changes) {
    const std::string place =
        c.key.empty() ? w.get("amendment.line", {{"line", std::to_string(c.line)}}) : c.key;
    into.rows.push_back(
        {file.file + ", " + place, shown(c.before) + " → " + shown(c.after), field});
  }
  if (file.more != 0)
    into.rows.push_back(
        {file.file, w.get("amendment.more", {{"count", std::to_string(file.more)}}), field});
}

std::string replaced_text(const Source& source) {
  const Wording& w = source.words;
  const Issue& issue = *source.in.issue;
  std::string text =
      w.get("amendment.replaces", {{"number", issue.replaces}, {"date", issue.replaces_date}});
  if (!issue.why.empty()) text += " " + ended(source, w.get("amendment.why", {{"why", issue.why}}));
  if (issue.changes.empty()) text += " " + w.get("amendment.nothing");
  return text;
}

Grid changes_of(const Source& source) {
  Grid changes{source.words.get("amendment.changed"), {}};
  for (const FileChange& file : source.in.issue->changes) add_changes(source, file, changes);
  return changes;
}

/// Long changes would displace the results from the first page; they therefore precede the method.
bool is_long(const Grid& changes) {
  constexpr std::size_t few = 6;
  return changes.rows.size() > few;
}

}  // namespace

std::string amendment_text(const Source& source) {
  if (source.in.issue->replaces.empty()) return {};
  std::string text = replaced_text(source);
  const Grid changes = changes_of(source);
  if (!changes.rows.empty()) text += " " + changes.title + ": ";
  for (const Grid::Row& row : changes.rows)
    text += (&row == &changes.rows.front() ? "" : "; ") + row.label + ": " + row.value;
  return text;
}

void add_amendment(const Source& source, Blocks& blocks) {
  if (source.in.issue->replaces.empty()) return;
  blocks.push_back(
      {Note{Level::attention, source.words.get("amendment.title"), replaced_text(source), ""},
       "certificate.amendment"});
  Grid changes = changes_of(source);
  if (!changes.rows.empty() && !is_long(changes))
    blocks.push_back({std::move(changes), "amendment.changes"});
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

namespace {

bool has_part(const OutputInput& in, const pages::Measured& m) {
  const auto& analyses = in.results.analyses;
  return is_printed(m) ||
         std::any_of(analyses.begin(), analyses.end(), [&](const Results::Analysed& a) {
           const auto& uses = a.evaluation.uses;
           return is_printed(a) &&
                  std::find(uses.begin(), uses.end(), m.measurement.id) != uses.end();
         });
}

}  // namespace

std::string not_reported_text(const Source& source) {
  std::string all;
  for (const pages::Measured& m : pages::measured(source.in))
    if (!has_part(source.in, m)) {
      const std::string heading = pages::heading_of(source, m), &id = m.measurement.id;
      const bool named = heading.find(id) != std::string::npos;
      all += (all.empty() ? "" : "; ") + heading + (named ? "" : " (" + id + ")");
    }
  return all.empty() ? all
                     : source.words.get("method_heading.not_reported", {{"measurements", all}});
}

namespace {

void add_departures(const Source& source, Blocks& blocks) {
  const CertificateTexts& texts = source.in.campaign.certificate;
  blocks.push_back({Heading{label(source, "method_heading.departures"), 2}, "departures"});
  bool none = true;
  for (const pages::Measured& m : pages::measured(source.in)) {
    if (!has_part(source.in, m)) continue;
    std::string all;
    for (const std::string& sentence : departures_of(source, m))
      all += (all.empty() ? "" : " ") + sentence;
    if (all.empty()) continue;
    none = false;
    paragraph(blocks,
              source.words.get("method_heading.departures_of",
                               {{"measurement", m.measurement.id}, {"departures", all}}),
              "departures of measurement " + m.measurement.id);
  }
  if (none) paragraph(blocks, source.words.get("method_heading.none_found"), "departures");
  paragraph(blocks, not_reported_text(source), "departures");
  if (!texts.deviations.empty())
    paragraph(blocks,
              source.words.get("method_heading.deviations", {{"deviations", texts.deviations}}),
              "certificate.deviations");
  if (!texts.no_other_deviations_by.empty())
    paragraph(
        blocks,
        source.words.get("method_heading.nothing_else", {{"person", texts.no_other_deviations_by}}),
        "certificate.no_other_deviations_by");
}

}  // namespace

namespace {

void add_methods(const Source& source, Blocks& blocks) {
  struct Method {
    std::string plugin, words, measurements;
  };
  std::vector<Method> methods;
  for (const Results::Analysed& a : source.in.results.analyses) {
    if (!is_printed(a)) continue;
    const std::string words = method_of(source, a);
    const auto known = std::find_if(methods.begin(), methods.end(), [&](const Method& m) {
      return m.plugin == a.plugin && m.words == words;
    });
    if (known == methods.end())
      methods.push_back({a.plugin, words, a.measurement});
    else
      known->measurements += ", " + a.measurement;
  }
  std::string all;
  for (const Method& m : methods) {
    const bool alone = std::none_of(methods.begin(), methods.end(), [&](const Method& o) {
      return &o != &m && o.plugin == m.plugin;
    });
    all += (all.empty() ? "" : " ") +
           (alone ? m.words
                  : source.words.get("method_heading.departures_of",
                                     {{"measurement", m.measurements}, {"departures", m.words}}));
  }
  paragraph(blocks, all, "method");
}

}  // namespace

void add_method(const Source& source, Blocks& blocks) {
  const CertificateTexts& texts = source.in.campaign.certificate;
  if (!source.in.issue->replaces.empty())
    if (Grid changes = changes_of(source); is_long(changes))
      blocks.push_back({std::move(changes), "amendment.changes"});
  blocks.push_back({Heading{label(source, "method_heading.title"), 2}, "method_heading.title"});
  add_methods(source, blocks);
  const auto& analyses = source.in.results.analyses;
  const bool named = std::any_of(analyses.begin(), analyses.end(), [](const auto& a) {
    return is_printed(a) && is_by_own_procedure(a);
  });
  if (!texts.procedure.empty() && !named)
    paragraph(blocks,
              source.words.get("method_heading.procedure", {{"procedure", texts.procedure}}),
              "certificate.procedure");
  paragraph(blocks,
            source.words.get("method_heading.traceability",
                             {{"certificate", source.in.campaign.instrument.certificate}}),
            "instrument.certificate");
  paragraph(blocks, expired_text(source), "instrument.valid_until");
  add_departures(source, blocks);
}

namespace {

struct Normalised {
  std::optional<bool> is;             ///< from the file, otherwise from the manifest
  std::optional<double> coefficient;  ///< 1/K
};

Normalised normalised(const Source& source, const pages::Measured& m) {
  Normalised out{source.in.campaign.environment.normalised, std::nullopt};
  if (const Axis* axis = source.in.campaign.machine.axis(m.measurement.axis))
    out.coefficient = axis->expansion;
  for (const Remark& note : m.observations.notes) {
    if (note.id != "renishaw.normalised" && note.id != "renishaw.not-normalised") continue;
    out.is = note.id == "renishaw.normalised";
    for (const Number& n : note.evidence)
      if (n.name == "expansion") out.coefficient = n.value;
  }
  return out;
}

}  // namespace

/// Results refer to 20 degC (ISO 1, ISO 230-2), and a document must state how they were converted.
std::string reference_temperature_text(const Source& source) {
  std::vector<std::pair<std::string, std::string>> sentences;
  for (const pages::Measured& m : pages::measured(source.in)) {
    if (!has_part(source.in, m) || m.observations.angular) continue;
    const Normalised n = normalised(source, m);
    std::string key = "conditions.normalised_unknown";
    if (n.is) key = *n.is ? "conditions.normalised" : "conditions.not_normalised";
    if (n.is == true && !n.coefficient) key = "conditions.normalised_by_unknown";
    const std::string text = source.words.get(
        key, {{"coefficient",
               pages::plain_number(source, n.coefficient.value_or(0.0), Quantity::expansion) + " " +
                   unit_text(Quantity::expansion)}});
    const auto known = std::find_if(sentences.begin(), sentences.end(),
                                    [&](const auto& s) { return s.first == text; });
    if (known == sentences.end())
      sentences.emplace_back(text, m.measurement.id);
    else
      known->second += ", " + m.measurement.id;
  }
  if (sentences.empty()) return {};
  std::string all = source.words.get("conditions.reference");
  for (const auto& [text, of] : sentences)
    all += " " + (sentences.size() == 1
                      ? text
                      : source.words.get("method_heading.departures_of",
                                         {{"measurement", of}, {"departures", text}}));
  return all;
}

void add_conditions(const Source& source, Blocks& blocks) {
  const Conditions c = conditions_of(source.in.observations);
  std::string all = reference_temperature_text(source);
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

void add_opinions(const Source& source, Blocks& blocks) {
  const std::string& opinions = source.in.campaign.certificate.opinions;
  if (opinions.empty()) return;
  blocks.push_back({Heading{label(source, "opinions.title"), 2}, "opinions.title"});
  paragraph(blocks, opinions, "certificate.opinions");
}

bool has_directions(const OutputInput& in) {
  const std::vector<pages::Measured> all = pages::measured(in);
  return std::any_of(all.begin(), all.end(), [](const pages::Measured& m) {
    return is_printed(m) && pages::over_one_position(m.measurement);
  });
}

void add_statements(const Source& source, Blocks& blocks) {
  const Wording& w = source.words;
  blocks.push_back({Heading{w.get("statements.title"), 2}, "statements.title"});
  const std::vector<std::string>& parts = source.look.measurement;
  const bool budget = std::find(parts.begin(), parts.end(), "budget") != parts.end();
  paragraph(blocks,
            w.get("notes.uncertainty") + " " + w.get("statements.guides") +
                (budget ? " " + w.get("statements.budget") : ""),
            "statements");
  if (has_directions(source.in)) paragraph(blocks, w.get("notes.sign"), "notes.sign");
  paragraph(blocks, w.get("notes.items") + " " + w.get("statements.whole"), "statements");
  if (!source.in.campaign.certificate.customer_data.empty())
    paragraph(blocks, "* " + w.get("statements.customer_data"), "statements.customer_data");
}

namespace {

std::string released_by(const Source& source) {
  const Issue& issue = *source.in.issue;
  const std::string& responsible = source.in.campaign.laboratory.authoriser;
  if (issue.is_draft()) return source.words.get("draft.not_approved");
  if (!issue.released_by.empty()) return issue.released_by;
  return source.words.get("authority.rules", {{"name", responsible}});
}

}  // namespace

void add_authority(const Source& source, Blocks& blocks) {
  const Wording& w = source.words;
  const Issue& issue = *source.in.issue;
  blocks.push_back({Spacer{4}});
  blocks.push_back({Grid{"",
                         {{w.get("authority.verify"),
                           issue.is_draft() ? "" : w.get("authority.how"), "authority.how"},
                          {w.get("authority.readings"), issue.readings_sha256, "readings"},
                          {w.get("authority.register"), issue.register_id, "register"}}},
                    "authority"});
}

namespace {

/// RFC 3986, 2.1; for the fragment of a URL.
std::string percent_encoded(std::string_view text) {
  constexpr std::string_view digits = "0123456789ABCDEF", plain = "-._~";
  std::string out;
  for (const char c : text) {
    const auto byte = static_cast<unsigned char>(c);
    if (byte < 0x80 && (std::isalnum(byte) != 0 || plain.find(c) != plain.npos))
      out += c;
    else
      (out += '%') += {digits[byte >> 4], digits[byte & 15]};
  }
  return out;
}

/// With an address, a smartphone opens the verification page. The data are in the fragment, which
/// the browser does not send.
std::string text_of_code(const Source& source) {
  const Issue& issue = *source.in.issue;
  const std::string& address = source.look.verification;
  if (address.empty())
    return issue.number + "\n" + issue.date + "\nSHA-256 " + issue.readings_sha256;
  return address + "#number=" + percent_encoded(issue.number) + "&date=" + issue.date +
         "&readings=" + issue.readings_sha256;
}

}  // namespace

/// A draft has neither signature frame nor code.
void add_signature(const Source& source, Blocks& foot) {
  const Wording& w = source.words;
  const Issue& issue = *source.in.issue;
  const bool draft = issue.is_draft();
  Grid grid{w.get("authority.title"),
            {{w.get("authority.by"), released_by(source), "laboratory.authoriser"},
             {w.get("authority.author"), issue.author, "authority.author"},
             {w.get("authority.signed"), w.get(draft ? "draft.says" : "authority.electronic"),
              "authority.electronic"}}};
  foot.push_back({Spacer{4}});
  if (draft) {
    foot.push_back({std::move(grid), "authority"});
    return;
  }
  SignatureBox box{
      w.get("authority.box"),
      {issue.released_by.empty() ? source.in.campaign.laboratory.authoriser : issue.released_by,
       source.in.campaign.laboratory.name, w.get("title.number", {{"number", issue.number}}),
       issue.date}};
  Code code{text_of_code(source), w.get("authority.code")};
  foot.push_back({Columns{{{{std::move(grid), "authority"}},
                           {{std::move(box), "authority.box"}},
                           {{std::move(code), "authority.code"}}},
                          {0.5, 0.33, 0.17}},
                  "authority"});
}

}  // namespace nonio::certificate
