// SPDX-License-Identifier: Apache-2.0
#include "fixtures.h"
#include "nonio/reports/number.h"
#include "pdf_reader.h"

namespace nonio::fixtures {
namespace {

struct PdfReport : testing::Test {
  Plugins plugins;
  Templates templates = read_templates(NONIO_TEMPLATES);

  void SetUp() override {
    for (const char* name : {"iso230-2", "vdi-dgq-3441", "pdf-report"})
      ASSERT_TRUE(plugins.load(std::string(NONIO_PLUGINS) + "/" + name + ".so"));
  }
  Expected<OutputResult> write(const Case& c, const std::string& language = "en",
                               const std::string& look = "report") {
    const Output& output = plugins.outputs.front();
    Settings options = defaults(output.info);
    options.values["language"] = language;
    options.values["template"] = look;
    return output.write({c.campaign, c.observations, c.results, options, templates});
  }
  std::string text(const Case& c, const std::string& language = "en") {
    const auto result = write(c, language);
    EXPECT_TRUE(result) << result.error().message;
    return result ? read_pdf(result->artifacts.front().bytes).all() : "";
  }
  std::string complaint(const Case& c, const std::string& look = "report") {
    const auto result = write(c, "en", look);
    EXPECT_FALSE(result);
    return result ? "" : result.error().file + ": " + result.error().message;
  }
  Case usual(Behaviour b = {}) {
    Case c = simple_case();
    c.add(b.rotary ? "C" : "X", b);
    c.analyse(plugins);
    return c;
  }
};

bool has(const std::string& text, const std::string& what) {
  return text.find(what) != std::string::npos;
}

std::size_t occurrences(const std::string& text, const std::string& what) {
  std::size_t n = 0;
  for (std::size_t at = 0; (at = text.find(what, at)) != std::string::npos; ++at) ++n;
  return n;
}

TEST_F(PdfReport, AnOrdinaryAxisTakesTwoPages) {
  for (const char* language : {"en", "it"}) {
    const auto result = write(usual(), language);
    ASSERT_TRUE(result) << result.error().message;
    const Artifact& file = result->artifacts.front();
    EXPECT_EQ(file.name, std::string("it") == language ? "report-it.pdf" : "report.pdf");
    EXPECT_EQ(read_pdf(file.bytes).pages.size(), 2U) << language;
    EXPECT_LT(file.bytes.size(), 100000U);
  }
}

TEST_F(PdfReport, SaysWhatTheResultsSay) {
  Case c = usual();
  decide(c, "iso230-2", "A", 1e-6, Decision::does_not_conform);
  decide(c, "iso230-2", "B", 50e-6, Decision::conforms);
  Results::Written table{"some-control", "1", {}};
  table.result.artifacts = {{"some-control-X.txt", ""}};
  table.result.predictions = {{"X", "E", 11.9e-6, 1.2e-6}};
  c.results.outputs.push_back(table);
  const std::string en = text(c), it = text(c, "it");
  for (const char* what : {"Calibration report", "Officine Rossi S.r.l.", "FP 12", "LX 80",
                           "does not conform", "conforms", "Lost motion at reversal",
                           "some-control-X.txt", "11.90 → 1.20", "VDI/DGQ 3441"})
    EXPECT_TRUE(has(en, what)) << what;
  for (const char* what : {"Rapporto di taratura", "non conforme", "11,90 → 1,20", "Asse X"})
    EXPECT_TRUE(has(it, what)) << what;
}

/// A text drawn in one line, not divided: a whole line of the page's texts.
bool has_line(const std::string& text, const std::string& line) {
  return has("\n" + text, "\n" + line + "\n");
}

TEST_F(PdfReport, NoCellOfAValuesTableWithTolerancesIsDivided) {
  Case c = usual();
  decide(c, "iso230-2", "A", 1.25e-6, Decision::does_not_conform);
  decide(c, "vdi-dgq-3441", "P", 20.75e-6, Decision::conforms);
  decide(c, "vdi-dgq-3441", "U_max", 3.25e-6, Decision::cannot_be_decided);
  for (auto& a : c.results.analyses)
    for (Value& v : a.evaluation.values) v.U = 0.19e-6;
  for (const std::string language : {"en", "it"}) {
    const std::string report = text(c, language), mark = language == "it" ? "," : ".";
    for (const std::string n : {"1|25", "20|75", "3|25", "0|19"}) {
      std::string number = n;
      number.replace(number.find('|'), 1, mark);
      EXPECT_TRUE(has_line(report, number)) << language << ": " << number;
    }
    const auto& words = templates.tables.at("words/" + language + "/report").values;
    for (const char* key : {"symbol", "meaning", "value", "uncertainty", "tolerance", "decision",
                            "conforms", "does_not_conform", "cannot_be_decided"}) {
      const auto word = std::get<std::string>(words.at("results." + std::string(key)));
      EXPECT_TRUE(has_line(report, word)) << language << ": " << word;
    }
    for (const auto& a : c.results.analyses)
      for (const Value& v : a.evaluation.values) {
        auto printed = reports::printed_result(v.value, v.U, v.quantity, language).value;
        if (printed.starts_with("−")) printed.replace(0, 3, "-");  // the font's glyph of both
        EXPECT_TRUE(has_line(report, printed)) << language << ": " << v.name << " " << printed;
      }
  }
}

TEST_F(PdfReport, AFindingOfTwoAnalysesIsSaidOnce) {
  const std::string report = text(usual());
  // once in the status at the top, once among the findings
  EXPECT_EQ(occurrences(report, "Lost motion at reversal"), 2U);
}

TEST_F(PdfReport, WhatVdiHidesIsSaidOnlyWhereATestSaysSo) {
  EXPECT_TRUE(has(text(usual()), "What VDI/DGQ 3441 does not show"));
  Behaviour even;
  even.reversal = 0;
  even.s_plus = even.s_minus = 0.5;
  EXPECT_FALSE(has(text(usual(even)), "What VDI/DGQ 3441 does not show"));
}

TEST_F(PdfReport, RemarksSpeakTheLanguageOfTheReport) {
  Case c = usual();
  Results::Written table{"some-control", "1", {}};
  table.result.notes = {{"fanuc.sign-inferred"}, {.id = "unknown", .english = "As it came."}};
  c.results.outputs.push_back(table);
  c.results.notes = {{"csv.empty-rows", {{"rows", 3.0, Quantity::count}}, {}, "X"}};
  const std::string en = text(c), it = text(c, "it");
  for (const char* what : {"Inferred: the sign", "X: Rows of the file", "computed directly"})
    EXPECT_TRUE(has(en, what)) << what;
  for (const char* what :
       {"Dedotto: il segno", "X: Righe del file", "calcolati direttamente", "As it came."})
    EXPECT_TRUE(has(it, what)) << what;
}

TEST_F(PdfReport, TheSameBytesWithAndWithoutPreparation) {
  const Case c = usual();
  const auto lazily = write(c);
  Templates other = templates;  // other fonts come first, so that the remembered ones are replaced
  std::swap(other.files["fonts/LiberationSans-Regular.ttf"],
            other.files["fonts/LiberationSans-Bold.ttf"]);
  plugins.outputs.front().prepare(other);
  const auto afterwards = write(c);
  plugins.outputs.front().prepare(templates);
  const auto prepared = write(c);
  ASSERT_TRUE(lazily && afterwards && prepared);
  EXPECT_EQ(lazily->artifacts.front().bytes, afterwards->artifacts.front().bytes);
  EXPECT_EQ(lazily->artifacts.front().bytes, prepared->artifacts.front().bytes);
}

TEST_F(PdfReport, AFieldThatCannotBePrintedIsNamed) {
  Case c = usual();
  c.campaign.customer = "校准";
  EXPECT_TRUE(has(complaint(c), "campaign.customer"));
  EXPECT_TRUE(has(complaint(c), "U+6821"));
  EXPECT_EQ(write(c).error().key, "campaign.customer");
  c.campaign.customer = "Ωμέγα, Ёлка, Łódź";
  EXPECT_TRUE(has(text(c), "Ωμέγα, Ёлка, Łódź"));
}

TEST_F(PdfReport, ErrorsThatQuoteRubbishArePrinted) {
  Case c = simple_case();
  c.results.errors.push_back({"expected a number, found \"校\x01\"", "x.csv", 7});
  EXPECT_TRUE(has(text(c), "x.csv:7: expected a number, found \"<U+6821><U+0001>\""));
}

TEST_F(PdfReport, BearsAnyCampaign) {
  EXPECT_TRUE(write(Case{}));
  Case c = simple_case();
  c.campaign.customer = c.campaign.id = c.campaign.laboratory.name = std::string(5000, 'x');
  Behaviour b;
  b.targets = 3;
  c.add(std::string(5000, 'y'), b);
  c.analyse(plugins);
  EXPECT_TRUE(write(c));
  for (const double size : {1e308, 1e300, 1e20, 1e-320}) {
    Case wild = simple_case();
    wild.add("X", b);
    for (double& d : wild.observations[0].deviation) d = d > 0 ? size : -size;
    wild.observations[0].axes[0].position[0] = size;
    wild.analyse(plugins);
    EXPECT_TRUE(write(wild)) << size;
  }
}

TEST_F(PdfReport, BearsEveryKindOfTest) {
  Behaviour one_run, one_way, one_target, rotary;
  one_run.runs = 1;
  one_way.minus = false;
  one_target.targets = 1;
  rotary.rotary = true;
  rotary.length = 6;
  for (const Behaviour& b : {one_run, one_way, one_target, rotary}) {
    const auto result = write(usual(b));
    EXPECT_TRUE(result) << result.error().message;
  }
}

TEST_F(PdfReport, ManyTargetsAndRuns) {
  Behaviour b;
  b.targets = 1000;
  b.runs = 40;
  const auto result = write(usual(b));
  ASSERT_TRUE(result) << result.error().message;
  EXPECT_LT(result->artifacts.front().bytes.size(), 1000000U);
  EXPECT_TRUE(has(read_pdf(result->artifacts.front().bytes).all(), "range of the runs, +"));
}

TEST_F(PdfReport, UnknownAnalysesPrintTheirValuesAndCurves) {
  Case c = simple_case();
  c.add("Y", {});
  Evaluation e;
  e.values = {{"C0Y", 12.5e-6, Quantity::small_angle, 1.5e-6},
              {"radius", 0.1, Quantity::length, {}}};
  e.series = {{"EYX",
               "X",
               Quantity::length,
               Quantity::deviation,
               {0, 1, 2},
               {0, 1e-6, 0},
               {1e-7, 1e-7, 1e-7}}};
  e.points.columns = {{"step", Quantity::count, {1, 2}},
                      {"strange_thing", Quantity::ratio, {0.5, NAN}}};
  c.results.analyses.push_back({"new-analysis", "1", "Y", e});
  const std::string report = text(c);
  for (const char* what : {"new-analysis", "C0Y", "12.5", "radius", "100.000", "EYX / µm",
                           "strange thing", "0.500", "–"})
    EXPECT_TRUE(has(report, what)) << what;
}

TEST_F(PdfReport, TemplatesAreCheckedWithFileAndKey) {
  const Case c = usual();
  struct Line {
    const char* key;
    Setting value;
    const char* says;
  };
  const Line lines[] = {{"blocks", std::vector<std::string>{"title", "titel"}, "\"titel\""},
                        {"plots", std::string("runs"), "\"plots\""},
                        {"colour.plus", std::string("blue"), "\"blue\""},
                        {"page.width_mm", 1e9, "\"page.width_mm\""},
                        {"font.bold", std::string("fonts/none.ttf"), "fonts/none.ttf"},
                        {"colour.pluss", std::string("#000000"), "\"colour.pluss\""}};
  for (const Line& l : lines) {
    templates.tables["report-bad"] = templates.tables["report"];
    templates.tables["report-bad"].values[l.key] = l.value;
    EXPECT_TRUE(has(complaint(c, "report-bad"), l.says)) << complaint(c, "report-bad");
  }
  templates.tables["report-bad"] = templates.tables["report"];
  templates.tables["report-bad"].values.erase("plot.height_mm");
  EXPECT_TRUE(
      has(complaint(c, "report-bad"), "templates/report-bad.toml: the key \"plot.height_mm\""));
  EXPECT_TRUE(has(complaint(c, "nowhere"), "nowhere"));
  templates.tables["words/en/report"].values.erase("status.attention");
  EXPECT_TRUE(has(complaint(c), "templates/words/en/report.toml: the key \"status.attention\""));
}

}  // namespace
}  // namespace nonio::fixtures
