// SPDX-License-Identifier: Apache-2.0
//
// A Digital Calibration Certificate, PTB's schema 3.3.0, as XML that the host signs.
#include "nonio/sdk/plugin.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>

#include "nonio/sdk/dsi_units.h"
#include "nonio/sdk/format.h"
#include "xml_writer.h"

namespace nonio::dcc {
namespace {

constexpr const char* version = "1.0.0";

bool applies(const Campaign&) { return true; }

bool is_country(std::string_view text) {
  return text.size() == 2 && text[0] >= 'A' && text[0] <= 'Z' && text[1] >= 'A' && text[1] <= 'Z';
}

/// Everything that is missing, at once, with the key to fill.
Expected<void> check(const Campaign& c) {
  std::string missing;
  const auto want = [&](bool there, const char* key) {
    if (!there) missing += (missing.empty() ? "" : ", ") + std::string(key);
  };
  want(!c.laboratory.name.empty(), "laboratory.name (site.toml)");
  want(is_country(c.laboratory.country), "laboratory.country (site.toml, two capital letters: IT)");
  want(!c.laboratory.authoriser.empty(), "laboratory.authoriser (site.toml)");
  want(!c.customer.empty(), "campaign.customer");
  want(!c.site.empty(), "campaign.site");
  want(!c.date.empty(), "campaign.date");
  want(!c.machine.model.empty(), "machine.model");
  want(!c.machine.serial.empty(), "machine.serial");
  if (missing.empty()) return {};
  return fail("a DCC needs what is missing: " + missing);
}

std::string number_text(double si, Quantity q) {
  std::array<char, 32> buffer{};
  const auto end = std::to_chars(buffer.data(), buffer.data() + buffer.size(), printed(si, q));
  return {buffer.data(), end.ptr};
}

class Writer {
 public:
  explicit Writer(const OutputInput& in) : in_(in), language_(in.options.text("language", "en")) {}

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
    text("dcc:name", "Nonio dcc");
    xml_.element("dcc:release", version);
    xml_.element("dcc:type", "application");
    xml_.close();
    xml_.close();
  }

  void core() {
    const Campaign& c = in_.campaign;
    const std::string number = in_.options.text("number");
    xml_.open("dcc:coreData");
    xml_.element("dcc:countryCodeISO3166_1", c.laboratory.country);
    xml_.element("dcc:usedLangCodeISO639_1", language_);
    xml_.element("dcc:mandatoryLangCodeISO639_1", language_);
    xml_.element("dcc:uniqueIdentifier", number.empty() ? c.id : number);
    xml_.element("dcc:beginPerformanceDate", c.date);
    xml_.element("dcc:endPerformanceDate", c.date);
    xml_.element("dcc:performanceLocation", in_.options.text("location", "customer"));
    xml_.close();
  }

  void item() {
    const Machine& m = in_.campaign.machine;
    xml_.open("dcc:items");
    xml_.open("dcc:item");
    text("dcc:name", m.model);
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
    contact("dcc:customer", c.customer, c.site, {});
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
      xml_.element("si:coverageFactor", "2");
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
  const std::string language_;
  XmlWriter xml_;
};

Expected<OutputResult> write(const OutputInput& in) {
  if (auto complete = check(in.campaign); !complete) return fail(complete.error());
  const auto has_values = [](const auto& a) { return !a.evaluation.values.empty(); };
  const auto& analyses = in.results.analyses;
  if (std::none_of(analyses.begin(), analyses.end(), has_values))
    return fail("a DCC needs at least one result, and there is none");
  OutputResult result;
  result.artifacts.push_back({"dcc.xml", Writer(in).write(), in.options.flag("sign", true)});
  return result;
}

}  // namespace
}  // namespace nonio::dcc

NONIO_PLUGIN(registry) {
  nonio::Output output;
  output.info = {
      "dcc",
      nonio::dcc::version,
      "A Digital Calibration Certificate (DCC 3.3.0, XML) with a signature of its own.",
      {{"number", std::string(), "", "Number of the certificate (default: the campaign's id)."},
       {"language", std::string("en"), "", "Language of the texts, ISO 639-1."},
       {"location",
        std::string("customer"),
        "",
        "Where it was calibrated.",
        {"laboratory", "customer", "laboratoryBranch", "customerBranch", "other"}},
       {"sign", true, "", "Signed with the key of [signing] in site.toml."}},
      true};
  output.applies = nonio::dcc::applies;
  output.write = nonio::dcc::write;
  registry.add(std::move(output));
}
