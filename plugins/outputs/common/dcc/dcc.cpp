// SPDX-License-Identifier: Apache-2.0
//
// PTB's schema 3.3.0; the order of elements is the schema's.
#include "dcc.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>

#include "nonio/sdk/dsi_units.h"
#include "nonio/sdk/format.h"
#include "xml_writer.h"

namespace nonio::dcc {
namespace {

std::string number_text(double si, Quantity q) {
  std::array<char, 32> buffer{};
  const auto end = std::to_chars(buffer.data(), buffer.data() + buffer.size(), printed(si, q));
  return {buffer.data(), end.ptr};
}

class Writer {
 public:
  Writer(const OutputInput& in, const About& about) : in_(in), about_(about) {}

  std::string write() {
    xml_.open("dcc:digitalCalibrationCertificate",
              "xmlns:dcc=\"https://ptb.de/dcc\" xmlns:si=\"https://ptb.de/si\" "
              "schemaVersion=\"3.3.0\"");
    xml_.open("dcc:administrativeData");
    software();
    core();
    item();
    people();
    xml_.close();
    xml_.open("dcc:measurementResults");
    for (const Results::Analysed& a : in_.results.analyses)
      if (!a.evaluation.values.empty()) result(a);
    xml_.close();
    xml_.close();
    return xml_.take();
  }

 private:
  void text(const char* name, const std::string& content) {
    xml_.open(name);
    xml_.element("dcc:content", content);
    xml_.close();
  }

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
    xml_.element("dcc:uniqueIdentifier", about_.number);
    if (!c.received.empty()) xml_.element("dcc:receiptDate", c.received);
    xml_.element("dcc:beginPerformanceDate", c.date);
    xml_.element("dcc:endPerformanceDate", c.end_date.empty() ? c.date : c.end_date);
    xml_.element("dcc:performanceLocation", about_.location);
    if (in_.issue != nullptr) {
      xml_.element("dcc:issueDate", in_.issue->date);
      if (!in_.issue->replaces.empty()) {
        xml_.open("dcc:reportAmendedSubstituted");
        xml_.element("dcc:typeOfChange", "substituted");
        xml_.element("dcc:replacedUniqueIdentifier", in_.issue->replaces);
        xml_.close();
      }
    }
    xml_.close();
  }

  void item() {
    const Machine& m = in_.campaign.machine;
    xml_.open("dcc:items");
    xml_.open("dcc:item");
    text("dcc:name", m.description.empty() ? m.model : m.description);
    if (!m.maker.empty()) {
      xml_.open("dcc:manufacturer");
      text("dcc:name", m.maker);
      xml_.close();
    }
    xml_.element("dcc:model", m.model);
    xml_.open("dcc:identifications");
    xml_.open("dcc:identification", "refType=\"basic_serialNumber\"");
    xml_.element("dcc:issuer", "manufacturer");
    xml_.element("dcc:value", m.serial);
    xml_.close();
    xml_.close();
    xml_.close();
    xml_.close();
  }

  void people() {
    const Campaign& c = in_.campaign;
    xml_.open("dcc:calibrationLaboratory");
    contact("dcc:contact", c.laboratory.name, c.laboratory.address, c.laboratory.country);
    xml_.close();
    xml_.open("dcc:respPersons");
    xml_.open("dcc:respPerson");
    xml_.open("dcc:person");
    text("dcc:name", c.laboratory.authoriser);
    xml_.close();
    xml_.element("dcc:mainSigner", "true");
    xml_.close();
    xml_.close();
    contact("dcc:customer", c.customer, c.customer_address.empty() ? c.site : c.customer_address,
            {});
    statements();
  }

  /// One for each tolerance. Undecided by ISO 14253-1 is what ILAC-G8 calls conditional.
  void statements() {
    if (in_.results.conformity.empty()) return;
    xml_.open("dcc:statements");
    for (const Conformity& c : in_.results.conformity) {
      const Value* value = value_of(c);
      xml_.open("dcc:statement");
      text("dcc:name", c.name + " of " + (c.measurement.empty() ? c.axis : c.measurement) +
                           ", tolerance " + number_text(c.tolerance, c.quantity) + " " +
                           std::string(unit_of(c.quantity).symbol));
      xml_.element("dcc:norm", "ISO 14253-1");
      if (value != nullptr && value->U) {
        const bool inside = std::fabs(value->value) <= c.tolerance;
        xml_.element("dcc:conformity", c.decision == Decision::conforms           ? "pass"
                                       : c.decision == Decision::does_not_conform ? "fail"
                                       : inside ? "conditionalPass"
                                                : "conditionalFail");
      }
      xml_.close();
    }
    xml_.close();
  }

  const Value* value_of(const Conformity& c) const {
    for (const Results::Analysed& a : in_.results.analyses)
      if (a.plugin == c.plugin && a.measurement == c.measurement)
        for (const Value& v : a.evaluation.values)
          if (v.name == c.name) return &v;
    return nullptr;
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

  /// Named as `nonio verify` finds it again: "iso230-2 of X".
  void result(const Results::Analysed& a) {
    const std::string name = a.measurement.empty() ? a.plugin : a.plugin + " of " + a.measurement;
    xml_.open("dcc:measurementResult");
    text("dcc:name", name);
    method(a.plugin);
    equipment();
    xml_.open("dcc:results");
    xml_.open("dcc:result", "refType=\"basic_measurementResult\"");
    text("dcc:name", name);
    xml_.open("dcc:data");
    for (const Value& v : a.evaluation.values) value(v);
    table(a.evaluation.points);
    xml_.close();
    xml_.close();
    xml_.close();
    xml_.close();
  }

  void method(const std::string& plugin) {
    const auto known = about_.methods.find(plugin);
    if (known == about_.methods.end()) return;
    xml_.open("dcc:usedMethods");
    xml_.open("dcc:usedMethod");
    text("dcc:name", known->second);
    xml_.close();
    xml_.close();
  }

  void equipment() {
    const Instrument& i = in_.campaign.instrument;
    if (i.model.empty()) return;
    xml_.open("dcc:measuringEquipments");
    xml_.open("dcc:measuringEquipment");
    text("dcc:name", i.certificate.empty() ? i.model : i.model + ", certificate " + i.certificate);
    if (!i.maker.empty()) {
      xml_.open("dcc:manufacturer");
      text("dcc:name", i.maker);
      xml_.close();
    }
    xml_.element("dcc:model", i.model);
    if (!i.serial.empty()) {
      xml_.open("dcc:identifications");
      xml_.open("dcc:identification", "refType=\"basic_serialNumber\"");
      xml_.element("dcc:issuer", "manufacturer");
      xml_.element("dcc:value", i.serial);
      xml_.close();
      xml_.close();
    }
    xml_.close();
    xml_.close();
  }

  void value(const Value& v) {
    xml_.open("dcc:quantity");
    text("dcc:name", v.name);
    xml_.open("si:real");
    xml_.element("si:value", number_text(v.value, v.quantity));
    xml_.element("si:unit", dsi_of(unit_of(v.quantity).symbol));
    if (v.U) {
      xml_.open("si:measurementUncertaintyUnivariate");
      xml_.open("si:expandedMU");
      xml_.element("si:valueExpandedMU", number_text(*v.U, v.quantity));
      xml_.element("si:coverageFactor", number_text(v.k, Quantity::number));
      xml_.element("si:coverageProbability", "0.95");
      xml_.close();
      xml_.close();
    }
    xml_.close();
    xml_.close();
  }

  /// A list cannot say that a value is missing: such a column stays out, and is in results.json.
  void table(const PointTable& points) {
    std::vector<const PointTable::Column*> columns;
    for (const PointTable::Column& c : points.columns)
      if (!c.values.empty() &&
          std::all_of(c.values.begin(), c.values.end(), [](double x) { return std::isfinite(x); }))
        columns.push_back(&c);
    if (columns.empty()) return;
    xml_.open("dcc:list");
    text("dcc:name", "points");
    for (const PointTable::Column* c : columns) {
      std::string all;
      for (const double x : c->values)
        all += (all.empty() ? "" : " ") + number_text(x, c->quantity);
      xml_.open("dcc:quantity");
      text("dcc:name", c->name);
      xml_.open("si:realListXMLList");
      xml_.element("si:valueXMLList", all);
      xml_.element("si:unitXMLList", dsi_of(unit_of(c->quantity).symbol));
      xml_.close();
      xml_.close();
    }
    xml_.close();
  }

  const OutputInput& in_;
  const About& about_;
  XmlWriter xml_;
};

}  // namespace

std::string write(const OutputInput& in, const About& about) { return Writer(in, about).write(); }

bool is_country(std::string_view text) {
  return text.size() == 2 && text[0] >= 'A' && text[0] <= 'Z' && text[1] >= 'A' && text[1] <= 'Z';
}

}  // namespace nonio::dcc
