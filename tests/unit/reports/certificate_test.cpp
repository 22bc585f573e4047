// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <set>

#include "certificate_case.h"
#include "nonio/reports/number.h"
#include "pdf_reader.h"
#include "png_file.h"

namespace nonio::fixtures::certificate_test {
namespace {

bool has(const std::string& text, const std::string& what) {
  return text.find(what) != std::string::npos;
}

/// Whether a page contains `what`, which may be wrapped over lines.
bool says(const std::string& text, const std::string& what) {
  std::string plain;
  for (const char c : text) plain += c == '\n' ? ' ' : c;
  return has(plain, what);
}

struct Certificate : testing::Test {
  Plugins plugins;
  Templates templates = read_templates(NONIO_TEMPLATES);
  Issue issue{"2026-0012", "2026-11-21", "", "", {}, std::string(64, 'a')};

  void SetUp() override {
    for (const char* name : {"iso230-2", "vdi-dgq-3441", "certificate"})
      ASSERT_TRUE(plugins.load(NONIO_PLUGINS, name));
  }
  const Output& output() const { return plugins.outputs.front(); }

  Case whole() const { return whole_case(plugins); }
  OutputInput input(const Case& c, bool drawn = true) const {
    static const Settings none;
    return {c.campaign, c.observations, c.results, none, templates, drawn ? &issue : nullptr};
  }
  std::vector<std::string> lacks(const Case& c) const {
    return output().certificate->missing_requirements(input(c, false));
  }
  Expected<OutputResult> write(const Case& c) const { return output().write(input(c)); }
  std::string text(const Case& c) const {
    const auto result = write(c);
    EXPECT_TRUE(result) << result.error().message;
    return result ? read_pdf(result->artifacts.front().bytes).all() : "";
  }
  std::string complaint(const Case& c) const {
    const auto result = write(c);
    EXPECT_FALSE(result);
    return result ? "" : result.error().file + ": " + result.error().message;
  }
};

TEST_F(Certificate, SaysWhatTheStandardAsksFor) {
  Case c = whole();
  decide(c, "iso230-2", "A", 1e-6, Decision::does_not_conform);
  decide(c, "iso230-2", "B", 50e-6, Decision::conforms);
  const std::string page = text(c);
  for (const char* what : {"Calibration report",
                           "No. 2026-0012",
                           "Issued on 2026-11-21",
                           "Taratura Srl",
                           "Via Dora 2, Torino · IT",
                           "info@example.org",
                           "Officine Rossi S.r.l.",
                           "Via Po 1, Torino",
                           "Torino (at the customer's)",
                           "2026-11-01",
                           "2026-11-03 – 2026-11-04",
                           "M. Bianchi",
                           "Fonderie Po",
                           "FP 12",
                           "0417",
                           "in use",
                           "LX 80",
                           "55821",
                           "2026-02-01",
                           "LAT 123 / 2026-045",
                           "ISO 230-2:2014",
                           "VDI/DGQ 3441:1977",
                           "Temperature of the machine 20.1 – 20.2 °C.",
                           "statement of conformity",
                           "does not conform",
                           "ISO 14253-1",
                           "coverage factor k = 2",
                           "relate only to the machine",
                           "reproduced only in full",
                           "Authorised by",
                           "B. Verdi",
                           "nonio certificate verify",
                           "Page 1 of",
                           "End of 2026-0012."})
    EXPECT_TRUE(says(page, what)) << what;
  EXPECT_TRUE(has(page, issue.readings_sha256));
  EXPECT_FALSE(has(page, "Lost motion at reversal")) << "a certificate explains nothing";
}

TEST_F(Certificate, EverythingThatIsMissingIsListedAtOnce) {
  Case c = whole();
  EXPECT_TRUE(lacks(c).empty()) << lacks(c).front();
  struct Gap {
    const char* key;
    void (*empty)(Campaign&);
  };
  const Gap gaps[] = {
      {"laboratory.name", [](Campaign& m) { m.laboratory.name.clear(); }},
      {"laboratory.address", [](Campaign& m) { m.laboratory.address.clear(); }},
      {"laboratory.country", [](Campaign& m) { m.laboratory.country = "Italy"; }},
      {"laboratory.authoriser", [](Campaign& m) { m.laboratory.authoriser.clear(); }},
      {"campaign.customer", [](Campaign& m) { m.customer.clear(); }},
      {"campaign.customer_address", [](Campaign& m) { m.customer_address.clear(); }},
      {"campaign.site", [](Campaign& m) { m.site.clear(); }},
      {"campaign.date", [](Campaign& m) { m.date.clear(); }},
      {"machine.maker", [](Campaign& m) { m.machine.maker.clear(); }},
      {"machine.model", [](Campaign& m) { m.machine.model.clear(); }},
      {"machine.serial", [](Campaign& m) { m.machine.serial.clear(); }},
      {"instrument.maker", [](Campaign& m) { m.instrument.maker.clear(); }},
      {"instrument.model", [](Campaign& m) { m.instrument.model.clear(); }},
      {"instrument.serial", [](Campaign& m) { m.instrument.serial.clear(); }},
      {"instrument.calibrated", [](Campaign& m) { m.instrument.calibrated.clear(); }},
      {"instrument.certificate", [](Campaign& m) { m.instrument.certificate.clear(); }}};
  Case none = whole();
  for (const Gap& gap : gaps) {
    Case one = whole();
    gap.empty(one.campaign);
    gap.empty(none.campaign);
    const auto keys = lacks(one);
    ASSERT_EQ(keys.size(), 1U) << gap.key;
    EXPECT_TRUE(keys[0] == gap.key || keys[0].starts_with(std::string(gap.key) + " (site.toml"))
        << keys[0];
  }
  EXPECT_EQ(lacks(none).size(), std::size(gaps));
}

// A place-holder is no serial number: nothing on the paper would say which instrument it was.
TEST_F(Certificate, ASerialNumberThatNamesNothingIsMissing) {
  for (const char* text : {" ", "-", "--", "n/a", "N.A.", "?", "unknown", "\u2013", "xxx", "000"})
    for (const bool machine : {true, false}) {
      Case c = whole();
      (machine ? c.campaign.machine.serial : c.campaign.instrument.serial) = text;
      ASSERT_EQ(lacks(c).size(), 1U) << text;
      EXPECT_EQ(lacks(c)[0], machine ? "machine.serial" : "instrument.serial") << text;
    }
  for (const char* text : {"0417", "L-001", "A", "\u7532-7"}) {
    Case c = whole();
    c.campaign.instrument.serial = text;
    EXPECT_TRUE(lacks(c).empty()) << text;
  }
  Case c = whole();
  c.campaign.sensors = {{.measures = "pressure", .serial = "-"}};
  EXPECT_EQ(lacks(c).size(), 3U);  // serial, calibrated, certificate
}

TEST_F(Certificate, ABlankOrADashIsNoStatement) {
  for (const char* nothing :
       {" ", "-", "--", " - ", "?", "/", "—", "–", "\xC2\xA0", "\xE3\x80\x80", "..."}) {
    Case c = whole();
    c.campaign.machine.serial = nothing;
    c.campaign.instrument.serial = nothing;
    c.campaign.instrument.certificate = nothing;
    EXPECT_EQ(lacks(c), (std::vector<std::string>{"machine.serial", "instrument.serial",
                                                  "instrument.certificate"}))
        << nothing;
  }
  for (const char* serial : {"7", "A-7", "№ 7", "甲", "É"}) {
    Case c = whole();
    c.campaign.machine.serial = serial;
    EXPECT_TRUE(lacks(c).empty()) << serial;
  }
}

TEST_F(Certificate, ABudgetOfZerosIsNone) {
  Case c = whole();
  Environment& e = c.campaign.environment;
  e.misalignment = e.temperature_range = e.temperature_difference = e.expansion_range = e.drift =
      0.0;
  c.campaign.instrument.U_fixed = c.campaign.instrument.U_per_length = 0.0;
  c.results = {};
  c.analyse(plugins);
  const auto keys = lacks(c);
  EXPECT_TRUE(std::any_of(keys.begin(), keys.end(), [](const std::string& key) {
    return key.starts_with("instrument.U_fixed_um (0");
  }));
  c.campaign.instrument.U_fixed = 1e-7;
  c.results = {};
  c.analyse(plugins);
  ASSERT_EQ(lacks(c).size(), 1U);
  EXPECT_TRUE(lacks(c)[0].starts_with("environment.drift_um (0"));
}

TEST_F(Certificate, ItContainsTheBudget) {
  Case c = whole();
  for (const char* language : {"en", "it", "de", "es", "zh"}) {
    c.campaign.certificate.languages = {language};
    EXPECT_TRUE(write(c)) << language;
  }
  c.campaign.certificate.languages = {"en"};
  const std::string page = text(c);
  for (const char* what : {"Uncertainty budget: ISO 230-2", "Misalignment", "Drift during the test",
                           "stated environmental conditions", "rectangular"})
    EXPECT_TRUE(says(page, what)) << what;
  EXPECT_FALSE(has(page, "drift_um")) << "a key of the manifest on a customer's page";
  EXPECT_FALSE(has(page, "230-9")) << "its text was not read";
  const std::string said = "Its budget is given with each measurement.";
  EXPECT_TRUE(says(page, said));
  const auto result = write(c);
  ASSERT_TRUE(result);
  EXPECT_FALSE(has(result->artifacts[1].bytes, said)) << "the DCC has none";
  auto& parts =
      std::get<std::vector<std::string>>(templates.tables["certificate"].values["measurement"]);
  std::erase(parts, "budget");
  EXPECT_FALSE(says(text(c), said));
}

TEST_F(Certificate, WhereTheLaboratorysFloorCountsItSaysSo) {
  Case c = whole();
  EXPECT_FALSE(says(text(c), "CMC"));
  c.results.analyses.front().evaluation.findings.push_back(
      {.id = "uncertainty.cmc", .texts = {{"results", "A+, B_mean"}}});
  const std::string said = "The uncertainty of A↑, B mean would be smaller than";
  EXPECT_TRUE(says(text(c), said));
  const auto result = write(c);
  ASSERT_TRUE(result);
  EXPECT_TRUE(has(result->artifacts[1].bytes, said));
}

TEST_F(Certificate, ResultsInTwoLanguagesHaveTheirMeaningsBelow) {
  Case c = whole();
  c.campaign.certificate.languages = {"it", "en"};
  for (const char* name : {"A", "A+", "A-", "E", "R", "R+", "B"})
    decide(c, "iso230-2", name, 50e-6, Decision::conforms);
  const std::string page = text(c);
  EXPECT_TRUE(says(page, "A↑: Accuracy, + direction; "));
  EXPECT_TRUE(says(page, "; B: Errore di inversione massimo."));
}

TEST_F(Certificate, TheCoverageFactorThatWasUsedIsPrinted) {
  Case c = whole();
  c.results.analyses.front().evaluation.values.front().k = 2.318;
  EXPECT_TRUE(has(text(c), "\n2.32\n"));
  const auto result = write(c);
  ASSERT_TRUE(result);
  EXPECT_TRUE(has(result->artifacts[1].bytes, "<si:coverageFactor>2.318<"));
}

TEST_F(Certificate, WithoutTemperaturesTheConditionsMustBeStated) {
  Case c = whole();
  for (Observations& o : c.observations) o.material.clear();
  ASSERT_EQ(lacks(c).size(), 1U);
  EXPECT_TRUE(lacks(c)[0].starts_with("certificate.conditions"));
  c.campaign.certificate.conditions = "Air 20 °C to 21 °C.";
  EXPECT_TRUE(lacks(c).empty());
  EXPECT_TRUE(says(text(c), "Air 20 °C to 21 °C."));
}

TEST_F(Certificate, WithoutABudgetItsKeysAreMissing) {
  Case c = whole();
  c.campaign.environment.drift.reset();
  c.campaign.instrument.U_fixed.reset();
  c.results = {};
  c.analyse(plugins);
  const auto keys = lacks(c);
  const auto there = [&](const char* key) {
    return std::find(keys.begin(), keys.end(), key) != keys.end();
  };
  EXPECT_TRUE(there("environment.drift_um"));
  EXPECT_TRUE(there("instrument.U_fixed_um"));
  EXPECT_FALSE(there("environment.misalignment_mm"));
}

TEST_F(Certificate, NoValueIsPrintedWithoutItsUncertainty) {
  Case c = whole();
  for (auto& a : c.results.analyses)
    if (a.plugin == "iso230-2")
      for (Value& v : a.evaluation.values)
        if (v.name == "M") {
          v.value = 777.77e-6;
          v.U.reset();
        }
  for (auto& a : c.results.analyses)
    for (auto& column : a.evaluation.points.columns)
      if (column.name == "B") {
        column.U.reset();
        for (double& v : column.values) v = 888.88e-6;
      }
  const std::string page = text(c);
  EXPECT_FALSE(has(page, "777"));
  EXPECT_FALSE(has(page, "888.88"));
}

TEST_F(Certificate, NumbersAreRoundedToTheirUncertainty) {
  Case c = whole();
  Value& v = c.results.analyses.front().evaluation.values.front();
  v.value = 12.3456e-6;
  v.U = 1.9499e-6;
  auto& column = c.results.analyses.front().evaluation.points.columns[1];
  column.U = 0.123456e-6;
  column.values.assign(column.values.size(), 4.56789e-6);
  const std::string page = text(c);
  for (const char* what : {"\n12.3\n", "\n1.9\n", "\n4.57\n", "\n0.12\n"})
    EXPECT_TRUE(has(page, what)) << what;
  EXPECT_FALSE(has(page, "4.568"));
}

TEST_F(Certificate, TwoLanguagesAreSideBySide) {
  Case c = whole();
  decide(c, "iso230-2", "A", 1e-6, Decision::does_not_conform);
  c.campaign.certificate.languages = {"it", "en"};
  const std::string page = text(c);
  for (const char* what : {"Rapporto di taratura / Calibration report", "Committente / Customer",
                           "non conforme / does not conform", "I risultati sono riferibili",
                           "The results are traceable", "Pagina 1 di", "Page 1 of",
                           "Asse X, lineare / Axis X, linear"})
    EXPECT_TRUE(says(page, what)) << what;
  EXPECT_TRUE(says(page, "Tarato il / Calibrated"));
  EXPECT_FALSE(says(page, "{"));
}

TEST_F(Certificate, EveryLanguageIsWhole) {
  std::set<std::string> languages;
  for (const auto& [name, table] : templates.tables)
    if (name.starts_with("words/") && name.ends_with("/certificate"))
      languages.insert(name.substr(6, 2));
  for (const char* language : {"de", "en", "es", "it", "zh"})
    EXPECT_TRUE(languages.contains(language)) << language;
  Case c = whole();
  issue.replaces = "2026-0003", issue.replaces_date = "2026-10-01", issue.changes = {{"x.csv"}};
  decide(c, "iso230-2", "A", 1e-6, Decision::does_not_conform);
  decide(c, "iso230-2", "B", 50e-6, Decision::conforms);
  for (const std::string& language : languages) {
    c.campaign.certificate.languages = {language};
    const auto result = write(c);
    ASSERT_TRUE(result) << language << ": " << result.error().file << result.error().message;
    EXPECT_FALSE(says(read_pdf(result->artifacts.front().bytes).all(), "{")) << language;
  }
  EXPECT_TRUE(output().check_templates(templates).empty())
      << output().check_templates(templates).front().file
      << output().check_templates(templates).front().message;
}

TEST_F(Certificate, AnAmendmentNamesWhatItReplacesAndWhy) {
  Case c = whole();
  issue.replaces = "2026-0003", issue.replaces_date = "2026-10-01";
  issue.changes = {{"x.csv", {{"", 7, "1,+,50,4.1", "1,+,50,4.3"}, {"", 9, "2,-,0,1", {}}}, 12},
                   {"campaign.toml", {{"machine.serial", 0, "S-1", "S-2"}}},
                   {"y.bin"}};
  issue.why = "wrong file";
  const std::string page = text(c);
  for (const char* what :
       {"This document replaces 2026-0003 of 2026-10-01, which is no longer valid.",
        "Reason: wrong file", "x.csv, line 7", "1,+,50,4.1 → 1,+,50,4.3", "2,-,0,1 → (nothing)",
        "and 12 more places", "campaign.toml, machine.serial", "S-1 → S-2", "y.bin"})
    EXPECT_TRUE(says(page, what)) << what << "\n" << page;
  issue.changes.clear();
  EXPECT_TRUE(says(text(c), "Its data are unchanged."));
}

TEST_F(Certificate, ADraftSaysSoOnEveryPageAndIsNotSigned) {
  Case c = whole();
  const std::map<std::string, std::string> marks = {
      {"de", "ENTWURF"}, {"en", "DRAFT"}, {"es", "BORRADOR"}, {"it", "BOZZA"}, {"zh", "草稿"}};
  issue.number = issue.date = "";
  for (const auto& [language, mark] : marks) {
    c.campaign.certificate.languages = {language};
    const auto result = write(c);
    ASSERT_TRUE(result) << language << ": " << result.error().message;
    ASSERT_EQ(result->artifacts.size(), 1U) << "no DCC of a draft";
    const PdfText pdf = read_pdf(result->artifacts.front().bytes);
    ASSERT_GT(pdf.pages.size(), 1U);
    for (const auto& page : pdf.pages) EXPECT_TRUE(says(page, mark)) << language << "\n" << page;
    for (std::size_t i = 1; i < pdf.pages.size(); ++i)  // the head has it in a line with others
      EXPECT_TRUE(has("\n" + pdf.pages[i], "\n" + mark + "\n")) << language << ": across the page";
    EXPECT_FALSE(says(pdf.all(), "PAdES")) << language;
  }
}

TEST_F(Certificate, WhoApprovedItIsPrintedOnIt) {
  Case c = whole();
  EXPECT_TRUE(says(text(c), "B. Verdi (by the rules of the laboratory for automatic approval)"));
  issue.released_by = "C. Neri";
  issue.author = "D. Viola";
  issue.register_id = "11111111-2222-4333-8444-555555555555";
  const std::string page = text(c);
  EXPECT_TRUE(says(page, "C. Neri"));
  EXPECT_FALSE(says(page, "B. Verdi")) << "who did not release it";
  EXPECT_TRUE(says(page, "D. Viola"));
  EXPECT_TRUE(says(page, issue.register_id));
}

TEST_F(Certificate, ATitleOrMarkOfAccreditationNeedsOne) {
  Case c = whole();
  c.campaign.certificate.title = {{"", "Protocol of measurement"}};
  EXPECT_TRUE(lacks(c).empty());
  c.campaign.certificate.title = {{"it", "Certificato di taratura"}, {"en", "Report"}};
  ASSERT_EQ(lacks(c).size(), 1U);
  EXPECT_TRUE(lacks(c)[0].starts_with("laboratory.accreditation (site.toml")) << lacks(c)[0];
  c.campaign.laboratory.accreditation = "LAT 123";
  ASSERT_EQ(lacks(c).size(), 1U);
  EXPECT_TRUE(lacks(c)[0].starts_with("laboratory.cmc (site.toml")) << lacks(c)[0];
  c.campaign.laboratory.cmc.fixed = 0.5e-6;
  EXPECT_TRUE(lacks(c).empty());
  EXPECT_TRUE(has(text(c), "Accreditation: LAT 123"));
  c.campaign.laboratory.accreditation.clear();
  c.campaign.certificate.title.clear();
  templates.tables["certificate"].values["logo.mark"] = std::string("mark.png");
  templates.tables["certificate"].values["logo.height_mm"] = 12.0;
  templates.files["mark.png"] = "x";
  ASSERT_EQ(lacks(c).size(), 1U);
  EXPECT_TRUE(has(lacks(c)[0], "mark.png"));
}

TEST_F(Certificate, WhatTheCustomerStatedIsMarked) {
  Case c = whole();
  c.campaign.certificate.customer_data = {"machine.serial"};
  const std::string page = text(c);
  EXPECT_TRUE(has(page, "0417 *"));
  EXPECT_TRUE(has(page, "Stated by the customer"));
  EXPECT_FALSE(has(text(whole()), "Stated by the customer"));
  c.campaign.certificate.customer_data = {"machine.serial", "machine.colour"};
  EXPECT_TRUE(has(complaint(c), "machine.colour"));
}

TEST_F(Certificate, BeforeAndAfterAdjustmentAreDistinguished) {
  Case c = whole();
  Measurement after = c.campaign.measurements.front();
  c.campaign.measurements.front().adjustment = "before";
  after.id = "X after";
  after.adjustment = "after";
  c.campaign.measurements.push_back(after);
  c.observations.push_back(c.observations.front());
  c.results = {};
  c.analyse(plugins);
  const std::string page = text(c);
  EXPECT_TRUE(says(page, "before adjustment"));
  EXPECT_TRUE(says(page, "after adjustment"));
}

TEST_F(Certificate, ATemplateMayMovePartsButNotLeaveThemOut) {
  auto& blocks =
      std::get<std::vector<std::string>>(templates.tables["certificate"].values["blocks"]);
  std::reverse(blocks.begin(), blocks.end());
  EXPECT_TRUE(write(whole()));
  std::erase(blocks, "statements");
  EXPECT_TRUE(has(complaint(whole()), "statements"));
  EXPECT_EQ(output().check_templates(templates).size(), 1U);
}

TEST_F(Certificate, TheAddressOfTheCodeIsAnAddress) {
  auto& address = templates.tables["certificate"].values["verification.address"];
  for (const char* good : {"https://lab.example/verify.html", "https://lab.example/a?b=c%20d"}) {
    address = std::string(good);
    EXPECT_TRUE(write(whole())) << good;
  }
  for (const std::string& bad :
       {std::string("http://lab.example/"), std::string("https://lab.example/#a"),
        std::string("https://lab.example/a b"), "https://lab.example/" + std::string(200, 'a')}) {
    address = bad;
    EXPECT_TRUE(has(complaint(whole()), "verification.address")) << bad;
  }
}

TEST_F(Certificate, ALogoIsAboveTheLaboratory) {
  auto& values = templates.tables["certificate"].values;
  values["logo.file"] = std::string("logo.png");
  values["logo.height_mm"] = 14.0;
  EXPECT_TRUE(has(complaint(whole()), "logo.png"));  // not there
  templates.files["logo.png"] = "no picture";
  EXPECT_TRUE(has(complaint(whole()), "templates/logo.png"));
  ASSERT_EQ(output().check_templates(templates).size(), 1U);
  EXPECT_EQ(output().check_templates(templates)[0].file, "templates/logo.png");
  templates.files["logo.png"] = png(2, 2, PNG_FORMAT_GRAY, "abcd");
  const auto with = write(whole());
  ASSERT_TRUE(with) << with.error().message;
  EXPECT_TRUE(has(with->artifacts.front().bytes, "/Subtype /Image"));
}

TEST_F(Certificate, AWordWithAPlaceholderThatIsNotFilledIsAnError) {
  templates.tables["words/en/certificate"].values["title.issued"] = std::string("Issued on {day}");
  EXPECT_TRUE(has(complaint(whole()), "{day}"));
}

TEST_F(Certificate, ALetterThatTheFontsLackIsAnErrorWithItsKey) {
  Case c = whole();
  c.campaign.machine.condition = "\U0001F600";
  const auto result = write(c);
  ASSERT_FALSE(result);
  EXPECT_EQ(result.error().key, "machine.condition");
}

TEST_F(Certificate, TheSameIsTheSameByteForByte) {
  const auto once = write(whole()), again = write(whole());
  ASSERT_TRUE(once && again);
  ASSERT_EQ(once->artifacts.size(), 2U);
  for (std::size_t i = 0; i < 2; ++i) {
    EXPECT_EQ(once->artifacts[i].bytes, again->artifacts[i].bytes);
    EXPECT_TRUE(once->artifacts[i].sign);
  }
}

TEST_F(Certificate, TheDccHasTheSameNumberAndValues) {
  Case c = whole();
  decide(c, "iso230-2", "A", 1e-6, Decision::does_not_conform);
  issue.replaces = "2026-0003";
  Evaluation model;  // the pages do not report it, so the DCC must not either
  model.values = {
      {.name = "squareness:XY.c", .value = 1e-5, .quantity = Quantity::small_angle, .U = 1e-6}};
  c.results.analyses.push_back({"model-fit", "1", "X", model});
  const auto result = write(c);
  ASSERT_TRUE(result);
  const std::string& xml = result->artifacts[1].bytes;
  for (const char* what :
       {"<dcc:value>2026-0012<", "<dcc:issueDate>2026-11-21<", "<dcc:receiptDate>2026-11-01<",
        "<dcc:endPerformanceDate>2026-11-04<", "<dcc:replacedUniqueIdentifier>2026-0003<",
        "<dcc:conformity>fail<", ">ISO 230-2:2014", "LAT 123 / 2026-045", "\\micro\\metre"})
    EXPECT_TRUE(has(xml, what)) << what;
  EXPECT_FALSE(has(xml, "squareness:XY"));
}

TEST_F(Certificate, WithoutANumberThereIsNone) {
  const Case c = whole();
  EXPECT_FALSE(output().write(input(c, false)));
}

}  // namespace
}  // namespace nonio::fixtures::certificate_test
