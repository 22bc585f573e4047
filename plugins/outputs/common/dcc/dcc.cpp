// SPDX-License-Identifier: Apache-2.0
// PTB's schema 3.3.0, including its order of elements. Template texts have a language; names,
// symbols and texts of the manifest do not.
#include "dcc.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <optional>

#include "nonio/sdk/dsi_units.h"
#include "nonio/sdk/format.h"
#include "xml_writer.h"

namespace nonio::dcc {
namespace {

/// Coverage probability of k = 2 with a normal distribution, as printed in certificates.
constexpr const char* coverage_probability = "0.95";

std::string number_text(double si, Quantity q) {
  std::array<char, 32> buffer{};
  const auto end = std::to_chars(buffer.data(), buffer.data() + buffer.size(), printed(si, q));
  return {buffer.data(), end.ptr};
}

RoundedResult result_text(double si, std::optional<double> U, Quantity q) {
  if (U)
    if (const auto rounded = rounded_result(printed(si, q), printed(*U, q))) return *rounded;
  return {number_text(si, q), ""};
}

class Writer {
 public:
  Writer(const OutputInput& in, const About& about) : in_(in), about_(about) {}

  std::string write() {
    xml_.open("dcc:digitalCalibrationCertificate", {{"xmlns:dcc", "https://ptb.de/dcc"},
                                                    {"xmlns:si", "https://ptb.de/si"},
                                                    {"schemaVersion", "3.3.0"}});
    xml_.open("dcc:administrativeData");
    software();
    core();
    item();
    people();
    statements();
    xml_.close();
    xml_.open("dcc:measurementResults");
    for (const Results::Analysed& a : in_.results.analyses)
      if (has_values(a)) result(a);
    xml_.close();
    xml_.close();
    return xml_.take();
  }

 private:
  bool is_stated(const Value& v) const { return !about_.only_with_U || v.U.has_value(); }
  bool has_values(const Results::Analysed& a) const {
    if (a.plugin == about_.not_reported) return false;
    const auto& values = a.evaluation.values;
    return std::any_of(values.begin(), values.end(), [&](const Value& v) { return is_stated(v); });
  }

  void contents(const Text& text) {
    for (const auto& [language, content] : text)
      if (!content.empty()) xml_.element("dcc:content", content, {{"lang", language}});
  }
  static bool empty(const Text& text) {
    return std::all_of(text.begin(), text.end(), [](const auto& t) { return t.second.empty(); });
  }
  void text(const char* name, const Text& content) {
    if (empty(content)) return;
    xml_.open(name);
    contents(content);
    xml_.close();
  }
  void text(const char* name, const std::string& content) { text(name, Text{{"", content}}); }

  void software() {
    xml_.open("dcc:dccSoftware");
    xml_.open("dcc:software");
    text("dcc:name", "Nonio " + about_.software);
    xml_.element("dcc:release", about_.release);
    xml_.element("dcc:type", "application");
    xml_.close();
    xml_.close();
  }

  void core() {
    const Campaign& c = in_.campaign;
    xml_.open("dcc:coreData");
    xml_.element("dcc:countryCodeISO3166_1", c.laboratory.country);
    for (const char* element : {"dcc:usedLangCodeISO639_1", "dcc:mandatoryLangCodeISO639_1"})
      for (const std::string& language : about_.languages) xml_.element(element, language);
    const Issue* issue = in_.issue != nullptr && !in_.issue->is_draft() ? in_.issue : nullptr;
    xml_.element(
        "dcc:uniqueIdentifier",
        issue == nullptr ? about_.number : identifier_of(issue->number, issue->readings_sha256));
    if (issue != nullptr) {
      xml_.open("dcc:identifications");
      identification(issue->number, {});
      if (!issue->register_id.empty()) identification(issue->register_id, about_.register_name);
      xml_.close();
    }
    if (!c.received.empty()) xml_.element("dcc:receiptDate", c.received);
    xml_.element("dcc:beginPerformanceDate", c.date);
    xml_.element("dcc:endPerformanceDate", c.end_date.empty() ? c.date : c.end_date);
    xml_.element("dcc:performanceLocation", about_.location);
    if (issue != nullptr) {
      xml_.element("dcc:issueDate", issue->date);
      replaced(*issue);
    }
    xml_.close();
  }

  void identification(const std::string& value, const Text& name) {
    xml_.open("dcc:identification");
    xml_.element("dcc:issuer", "calibrationLaboratory");
    xml_.element("dcc:value", value);
    text("dcc:name", name);
    xml_.close();
  }

  void replaced(const Issue& issue) {
    if (issue.replaces.empty()) return;
    const std::string identifier = issue.replaces_readings.empty()
                                       ? issue.replaces
                                       : identifier_of(issue.replaces, issue.replaces_readings);
    xml_.open("dcc:reportAmendedSubstituted");
    xml_.element("dcc:typeOfChange", "substituted");
    xml_.element("dcc:replacedUniqueIdentifier", identifier);
    xml_.close();
    if (issue.replaces_sha256.empty()) return;
    xml_.open("dcc:previousReport");
    text("dcc:referral", issue.replaces + ", " + issue.replaces_file);
    xml_.element("dcc:referralID", identifier);
    xml_.element("dcc:procedure", "SHA-256 of the file");
    xml_.element("dcc:value", issue.replaces_sha256);
    xml_.close();
  }

  void item() {
    const Machine& m = in_.campaign.machine;
    xml_.open("dcc:items");
    xml_.open("dcc:item");
    text("dcc:name", m.description.empty() ? m.model : m.description);
    text("dcc:description", about_.item);
    manufacturer(m.maker);
    xml_.element("dcc:model", m.model);
    serial_number(m.serial);
    xml_.close();
    xml_.close();
  }

  void manufacturer(const std::string& maker) {
    if (maker.empty()) return;
    xml_.open("dcc:manufacturer");
    text("dcc:name", maker);
    xml_.close();
  }
  void serial_number(const std::string& serial) {
    if (serial.empty()) return;
    xml_.open("dcc:identifications");
    xml_.open("dcc:identification", {{"refType", "basic_serialNumber"}});
    xml_.element("dcc:issuer", "manufacturer");
    xml_.element("dcc:value", serial);
    xml_.close();
    xml_.close();
  }

  void people() {
    const Campaign& c = in_.campaign;
    const Laboratory& l = c.laboratory;
    xml_.open("dcc:calibrationLaboratory");
    if (!l.accreditation.empty()) xml_.element("dcc:calibrationLaboratoryCode", l.accreditation);
    contact("dcc:contact", l.name,
            l.address + (l.contact.empty() ? "" : (l.address.empty() ? "" : " · ") + l.contact),
            l.country);
    xml_.close();
    xml_.open("dcc:respPersons");
    const bool by_a_person = in_.issue != nullptr && !in_.issue->released_by.empty();
    person(by_a_person ? in_.issue->released_by : l.authoriser, "authoriser", true,
           by_a_person ? Text{} : about_.released);
    if (by_a_person && !in_.issue->author.empty()) person(in_.issue->author, "author", false, {});
    if (!c.operator_name.empty()) person(c.operator_name, "operator", false, {});
    xml_.close();
    contact("dcc:customer", c.customer, c.customer_address.empty() ? c.site : c.customer_address,
            {});
  }

  void person(const std::string& name, const char* role, bool signer, const Text& description) {
    xml_.open("dcc:respPerson");
    xml_.open("dcc:person");
    text("dcc:name", name);
    xml_.close();
    text("dcc:description", description);
    xml_.element("dcc:role", role);
    xml_.element("dcc:mainSigner", signer ? "true" : "false");
    xml_.close();
  }

  /// Indeterminate decisions have no status.
  void statements() {
    if (about_.decided.empty() && about_.statements.empty()) return;
    xml_.open("dcc:statements");
    for (const Decided& d : about_.decided) {
      xml_.open("dcc:statement", {{"refType", "basic_conformity"}});
      text("dcc:name", d.name);
      text("dcc:description", about_.rule);
      if (!about_.norm.empty()) xml_.element("dcc:norm", about_.norm);
      text("dcc:declaration", d.says);
      if (!d.is.empty()) xml_.element("dcc:conformity", d.is);
      xml_.close();
    }
    for (const Statement& s : about_.statements) {
      xml_.open("dcc:statement", {{"refType", s.ref_type}});
      text("dcc:declaration", s.says);
      xml_.close();
    }
    xml_.close();
  }

  void contact(const char* element, const std::string& name, const std::string& place,
               const std::string& country) {
    xml_.open(element);
    text("dcc:name", name);
    xml_.open("dcc:location");
    if (!country.empty()) xml_.element("dcc:countryCode", country);
    if (!place.empty()) text("dcc:further", place);
    xml_.close();
    xml_.close();
  }

  void result(const Results::Analysed& a) {
    static const Words none;
    const std::string name = name_of(a);
    const auto found = about_.words.find(name);
    const Words& words = found == about_.words.end() ? none : found->second;
    const Text title = empty(words.title) ? Text{{"", name}} : words.title;
    xml_.open("dcc:measurementResult");
    text("dcc:name", title);
    text("dcc:description", name);
    methods(words);
    equipment();
    influences(words);
    xml_.open("dcc:results");
    xml_.open("dcc:result", {{"refType", "basic_measurementResult"}});
    text("dcc:name", title);
    xml_.open("dcc:data");
    for (const Value& v : a.evaluation.values)
      if (is_stated(v)) value(v);
    table(a.evaluation.points);
    for (const Series& s : a.evaluation.series) series(s);
    xml_.close();
    xml_.close();
    xml_.close();
    xml_.close();
  }

  void methods(const Words& words) {
    if (empty(words.method)) return;
    xml_.open("dcc:usedMethods");
    xml_.open("dcc:usedMethod");
    text("dcc:name", words.method);
    if (!words.departures.empty() || !empty(words.test)) {
      xml_.open("dcc:description");
      contents(words.test);
      for (const Text& departure : words.departures) contents(departure);
      xml_.close();
    }
    xml_.close();
    if (!empty(about_.uncertainty)) {
      xml_.open("dcc:usedMethod", {{"refType", "basic_methodMeasurementUncertainty"}});
      text("dcc:name", about_.uncertainty);
      xml_.close();
    }
    xml_.close();
  }

  void equipment() {
    const Instrument& i = in_.campaign.instrument;
    if (i.model.empty() && in_.campaign.sensors.empty()) return;
    xml_.open("dcc:measuringEquipments");
    if (!i.model.empty())
      one_equipment(
          {"", i.maker, i.model, i.serial, i.calibrated, i.valid_until, i.certificate, i.issuer},
          "basic_measurementStandard", about_.equipment);
    for (const Sensor& s : in_.campaign.sensors) one_equipment(s, "", {});
    xml_.close();
  }

  void one_equipment(const Sensor& s, const std::string& ref_type, const Text& description) {
    std::string name = s.model;
    const auto add = [&](const std::string& before, const std::string& text) {
      if (!text.empty()) name += (name.empty() ? "" : ", ") + before + text;
    };
    add("sensor of ",
        s.measures == "material" || s.measures == "air" ? s.measures + " temperature" : s.measures);
    add("certificate ", s.certificate);
    add("issued by ", s.issuer);
    add("calibrated ", s.calibrated);
    add("valid until ", s.valid_until);
    xml_.open("dcc:measuringEquipment", {{"refType", ref_type}});
    text("dcc:name", name);
    if (!empty(description)) text("dcc:description", description);
    manufacturer(s.maker);
    if (!s.model.empty()) xml_.element("dcc:model", s.model);
    serial_number(s.serial);
    xml_.close();
  }

  void influences(const Words& words) {
    if (words.conditions.empty()) return;
    xml_.open("dcc:influenceConditions");
    for (const Condition& c : words.conditions) {
      xml_.open("dcc:influenceCondition", {{"refType", c.ref_type}});
      text("dcc:name", c.name);
      if (!words.status.empty()) xml_.element("dcc:status", words.status);
      xml_.open("dcc:data");
      for (const auto& [name, number] :
           {std::pair(&about_.lowest, &c.low), std::pair(&about_.highest, &c.high)}) {
        xml_.open("dcc:quantity");
        text("dcc:name", *name);
        xml_.open("si:real");
        xml_.element("si:value", *number);
        xml_.element("si:unit", c.unit);
        xml_.close();
        xml_.close();
      }
      xml_.close();
      xml_.close();
    }
    xml_.close();
  }

  void meaning(const std::string& name) {
    const auto known = about_.meaning.find(name);
    if (known != about_.meaning.end()) text("dcc:description", known->second);
  }

  void value(const Value& v) {
    const RoundedResult said = result_text(v.value, v.U, v.quantity);
    xml_.open("dcc:quantity", {{"refType", "basic_measuredValue"}});
    text("dcc:name", v.name);
    meaning(v.name);
    xml_.open("si:real");
    xml_.element("si:value", said.value);
    xml_.element("si:unit", dsi_of(unit_of(v.quantity).symbol));
    if (!said.U.empty()) {
      xml_.open("si:measurementUncertaintyUnivariate");
      xml_.open("si:expandedMU");
      xml_.element("si:valueExpandedMU", said.U);
      xml_.element("si:coverageFactor", number_text(v.k, Quantity::number));
      xml_.element("si:coverageProbability", coverage_probability);
      xml_.close();
      xml_.close();
    }
    xml_.close();
    xml_.close();
  }

  struct Column {
    std::string name, ref_type;
    Quantity quantity;
    std::vector<double> values;
    std::vector<double> U;
    double k = 2.0;
  };

  void column(const Column& c) {
    std::string values, Us, ks, ps;
    const auto add = [](std::string& to, const std::string& one) {
      to += (to.empty() ? "" : " ") + one;
    };
    for (std::size_t i = 0; i < c.values.size(); ++i) {
      const RoundedResult said =
          result_text(c.values[i], c.U.empty() ? std::nullopt : std::optional(c.U[i]), c.quantity);
      add(values, said.value);
      if (c.U.empty()) continue;
      add(Us, said.U.empty() ? "0" : said.U), add(ks, number_text(c.k, Quantity::number)),
          add(ps, coverage_probability);
    }
    xml_.open("dcc:quantity", {{"refType", c.ref_type}});
    text("dcc:name", c.name);
    meaning(c.name);
    xml_.open("si:realListXMLList");
    xml_.element("si:valueXMLList", values);
    xml_.element("si:unitXMLList", dsi_of(unit_of(c.quantity).symbol));
    if (!c.U.empty() && !Us.empty()) {
      xml_.open("si:measurementUncertaintyUnivariateXMLList");
      xml_.open("si:expandedMUXMLList");
      xml_.element("si:valueExpandedMUXMLList", Us);
      xml_.element("si:coverageFactorXMLList", ks);
      xml_.element("si:coverageProbabilityXMLList", ps);
      xml_.close();
      xml_.close();
    }
    xml_.close();
    xml_.close();
  }

  void list(const std::string& name, const std::vector<Column>& columns) {
    xml_.open("dcc:list");
    text("dcc:name", name);
    for (const Column& c : columns) column(c);
    xml_.close();
  }

  /// Complete columns are in one list; a column with gaps gets a separate list of its existing
  /// rows.
  void table(const PointTable& points) {
    std::vector<Column> whole;
    std::vector<std::vector<Column>> parts;
    for (const PointTable::Column& c : points.columns) {
      const bool first = &c == &points.columns.front(), count = c.quantity == Quantity::count;
      if (about_.only_with_U && !first && !count && !c.U) continue;
      const auto finite = [](double x) { return std::isfinite(x); };
      const auto n = std::count_if(c.values.begin(), c.values.end(), finite);
      Column out{c.name,     first ? "basic_nominalValue" : count ? "" : "basic_measuredValue",
                 c.quantity, c.values,
                 {},         2.0};
      if (c.U) out.U.assign(c.values.size(), *c.U);
      if (n == static_cast<std::ptrdiff_t>(c.values.size()) && n > 0)
        whole.push_back(std::move(out));
      else if (n > 0 && !whole.empty())
        parts.push_back(without_gaps({whole.front(), std::move(out)}));
    }
    if (!whole.empty()) list("points", whole);
    for (const auto& part : parts) list("points of " + part.back().name, part);
  }

  static std::vector<Column> without_gaps(std::vector<Column> columns) {
    std::vector<Column> out = columns;
    for (Column& c : out) c.values.clear(), c.U.clear();
    for (std::size_t i = 0; i < columns.back().values.size(); ++i) {
      if (!std::isfinite(columns.back().values[i])) continue;
      for (std::size_t k = 0; k < columns.size(); ++k) {
        out[k].values.push_back(columns[k].values[i]);
        if (!columns[k].U.empty()) out[k].U.push_back(columns[k].U[i]);
      }
    }
    return out;
  }

  void series(const Series& s) {
    if (about_.only_with_U && s.U.size() != s.value.size()) return;
    Column place{s.over, "basic_nominalValue", s.position_quantity, s.position, {}, 2.0};
    Column curve{s.name, "basic_measuredValue", s.quantity, s.value, s.U, s.k};
    const auto columns = without_gaps({std::move(place), std::move(curve)});
    if (!columns.back().values.empty()) list("curve " + s.name, columns);
  }

  const OutputInput& in_;
  const About& about_;
  XmlWriter xml_;
};

}  // namespace

std::string name_of(const Results::Analysed& a) {
  return a.measurement.empty() ? a.plugin : a.plugin + " of " + a.measurement;
}

std::string write(const OutputInput& in, const About& about) { return Writer(in, about).write(); }

bool is_country(std::string_view text) {
  return text.size() == 2 && text[0] >= 'A' && text[0] <= 'Z' && text[1] >= 'A' && text[1] <= 'Z';
}

}  // namespace nonio::dcc
