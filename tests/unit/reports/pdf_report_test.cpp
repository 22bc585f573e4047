// SPDX-License-Identifier: Apache-2.0
#include <algorithm>

#include "fixtures.h"
#include "nonio/reports/number.h"
#include "pdf_reader.h"

namespace nonio::fixtures::pdf_report_test {
namespace {

struct PdfReport : testing::Test {
  Plugins plugins;
  Templates templates = read_templates(NONIO_TEMPLATES);

  void SetUp() override {
    for (const char* name : {"iso230-2", "vdi-dgq-3441", "pdf-report"})
      ASSERT_TRUE(plugins.load(NONIO_PLUGINS, name));
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

// What is for the customer; what follows is for the laboratory.
TEST_F(PdfReport, AnOrdinaryAxisTakesTwoPages) {
  for (const char* language : {"de", "en", "it"}) {
    const auto result = write(usual(), language);
    ASSERT_TRUE(result) << result.error().message;
    const Artifact& file = result->artifacts.front();
    EXPECT_EQ(file.name, std::string("en") == language
                             ? "report.pdf"
                             : "report-" + std::string(language) + ".pdf");
    const auto pages = read_pdf(file.bytes).pages;
    ASSERT_EQ(pages.size(), 3U) << language;
    const char* advice = "→ ";
    EXPECT_FALSE(has(pages[0] + pages[1], advice)) << language;
    EXPECT_TRUE(has(pages[2], advice)) << language;
    EXPECT_TRUE(has(pages[2], std::string("it") == language   ? "Per il laboratorio"
                              : std::string("de") == language ? "Für das Laboratorium"
                                                              : "For the laboratory"));
    EXPECT_LT(file.bytes.size(), 100000U);
  }
}

/// One line with the axes' names for all limits of axes that were not measured.
TEST_F(PdfReport, LimitsOfAxesThatWereNotMeasuredAreNamedOnce) {
  Case c = usual();
  for (const char* name : {"V", "W"}) {
    Axis axis = c.campaign.machine.axes.front();
    axis.name = name;
    axis.tolerance = {{"A", 20e-6}, {"B", 6e-6}, {"R", 9e-6}};
    c.campaign.machine.axes.push_back(axis);
    for (const auto& [limit, value] : axis.tolerance)
      c.results.conformity.push_back({"", name, "", limit, value, Quantity::deviation,
                                      Decision::cannot_be_decided, "no-value"});
  }
  std::string all = text(c);
  std::replace(all.begin(), all.end(), '\n', ' ');
  EXPECT_TRUE(has(all, "not measured; no decisions are given for them: V, W.")) << all;
  EXPECT_FALSE(has(all, "can neither be accepted")) << all;
}

/// Tables that were refused, models and advice are no business of a customer.
TEST_F(PdfReport, WhatIsForTheLaboratoryIsInItsPartAlone) {
  Case c = usual();
  for (auto& a : c.results.analyses) a.evaluation.findings.clear();
  decide(c, "iso230-2", "A", 50e-6, Decision::conforms);
  c.results.analyses.front().evaluation.findings = {{.id = "model.unrepeatable",
                                                     .attention = true,
                                                     .evidence = {},
                                                     .texts = {{"part", "Axis"}, {"axis", "X"}}}};
  Results::Written table{"fanuc", "1", {}};
  Finding refused{.id = "table.refused-reversal", .attention = true};
  refused.measurement = "X";
  refused.evidence = {{"mean", 1e-6, Quantity::deviation}, {"max", 5e-6, Quantity::deviation}};
  refused.texts = {{"axis", "X"}};
  table.result.findings = {refused};
  c.results.outputs.push_back(table);
  const std::string all = text(c);
  const std::size_t part = all.find("For the laboratory");
  ASSERT_NE(part, std::string::npos);
  const std::string customer = all.substr(0, part), laboratory = all.substr(part);
  EXPECT_TRUE(has(customer, "No action required, no warnings.")) << customer;
  for (const char* what : {"fanuc", "no table", "contradict each other", "Check the set-up"}) {
    EXPECT_FALSE(has(customer, what)) << what;
    if (what != std::string("Check the set-up")) {
      EXPECT_TRUE(has(laboratory, what)) << what;
    }
  }
  EXPECT_FALSE(has(all, "Authorised by")) << "a report is not authorised";
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
  for (const char* what : {"Measurement report", "Officine Rossi S.r.l.", "FP 12", "LX 80",
                           "does not conform", "conforms", "Lost motion at reversal",
                           "some-control-X.txt", "11.90 → 1.20", "VDI/DGQ 3441"})
    EXPECT_TRUE(has(en, what)) << what;
  for (const char* what : {"Relazione di misura", "non conforme", "11,90 → 1,20", "Asse X"})
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
  for (const std::string language : {"de", "en", "it"}) {
    const std::string report = text(c, language), mark = language == "en" ? "." : ",";
    for (const std::string n : {"1|25", "20|75", "3|25", "0|19"}) {
      std::string number = n;
      number.replace(number.find('|'), 1, mark);
      EXPECT_TRUE(has_line(report, number)) << language << ": " << number;
    }
    const auto& words = templates.tables.at("words/" + language + "/results").values;
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

TEST_F(PdfReport, NothingNeedsAttentionOnlyWhereSomethingWasJudged) {
  Behaviour even;
  even.reversal = 0;
  even.s_plus = even.s_minus = 0.5;
  const Case quiet = usual(even);
  const std::string green = "No action required, no warnings.";
  // No tolerance: nothing was judged.
  EXPECT_FALSE(has(text(quiet), green));
  EXPECT_TRUE(has(text(quiet), "conformity was not assessed"));
  // A tolerance that is kept is.
  Case judged = quiet;
  decide(judged, "iso230-2", "A", 50e-6, Decision::conforms);
  EXPECT_TRUE(has(text(judged), green));
  EXPECT_FALSE(has(text(judged), "conformity was not assessed"));
  // With a measurement that was not evaluated it is not green.
  Case part = judged;
  part.results.notes.push_back({"measurement.not-evaluated", {}, {{"kind", "angle"}}, "yaw"});
  EXPECT_FALSE(has(text(part), green));
  EXPECT_TRUE(has(text(part), "Not evaluated: yaw."));
  // Nothing evaluated at all.
  Case nothing = quiet;
  nothing.results.analyses.clear();
  EXPECT_FALSE(has(text(nothing), green));
  EXPECT_TRUE(has(text(nothing), "Nothing was evaluated"));
}

TEST_F(PdfReport, WhatItSaysOfTheCampaignIsSo) {
  Case axes = usual();
  const std::string positioning = "Accuracy and repeatability of positioning",
                    rule = "Decision rule according to", sign = "B = mean";
  EXPECT_TRUE(has(text(axes), positioning));
  EXPECT_TRUE(has(text(axes), sign));
  // A limit of an axis that was not measured: no decision, and no rule of one.
  axes.results.conformity.push_back(
      {"", "Y", "", "A", 5e-6, Quantity::deviation, Decision::cannot_be_decided, "no-value"});
  EXPECT_FALSE(has(text(axes), rule));
  decide(axes, "iso230-2", "A", 50e-6, Decision::conforms);
  EXPECT_TRUE(has(text(axes), rule));
  Case centres = usual();
  centres.campaign.measurements[0].kind = "ball-centres";
  EXPECT_FALSE(has(text(centres), positioning));
  EXPECT_TRUE(has(text(centres), "Geometry of a machine tool"));
  EXPECT_FALSE(has(text(centres), sign)) << "nothing was approached";
  Case both = centres;
  both.campaign.measurements.push_back(axes.campaign.measurements[0]);
  both.campaign.measurements.back().id = "X2";
  EXPECT_TRUE(has(text(both), "Positioning and geometry of a machine tool"));
  Case plan;
  EXPECT_TRUE(has(text(plan), "Plan of measurements"));
  Case not_evaluated = usual();
  EXPECT_TRUE(has(text(not_evaluated), "Readings and mean of each direction"));
  not_evaluated.results.analyses.clear();  // of a diagonal, say: no mean is drawn
  EXPECT_FALSE(has(text(not_evaluated), "mean of each direction"));
  EXPECT_TRUE(has(text(not_evaluated), "Readings by run"));
  // Values that have no U by definition: no statement is missing.
  const std::string not_stated = "the data for an uncertainty budget were not stated";
  Case without = usual();
  for (auto& a : without.results.analyses) {
    std::erase_if(a.evaluation.findings,
                  [](const Finding& f) { return f.id == "uncertainty.no-data"; });
    for (Value& v : a.evaluation.values) v.U.reset();
  }
  EXPECT_FALSE(has(text(without), not_stated));
  without.results.analyses[0].evaluation.findings.push_back({.id = "uncertainty.no-data"});
  EXPECT_TRUE(has(text(without), not_stated));
}

// What the table refuses, the figure does not show.
TEST_F(PdfReport, NoBracketIsDrawnForAMissingResult) {
  Case c = usual();
  const auto marks = [&](const std::string& name) { return has_line(text(c), name); };
  ASSERT_TRUE(marks("E"));
  for (const char* gone : {"A", "E", "P", "Pa"}) {
    for (auto& a : c.results.analyses)
      std::erase_if(a.evaluation.values, [&](const Value& v) { return v.name == gone; });
    EXPECT_FALSE(marks(gone)) << gone;
  }
}

TEST_F(PdfReport, ADiagonalIsAsLongAsItIs) {
  Case c = usual();
  Measurement m;
  m.id = "D1";
  m.kind = "diagonal";
  m.file = "d1.csv";
  m.from = {{"X", 0.0}, {"Y", 1.0}};
  m.to = {{"X", 12.0}, {"Y", 10.0}};
  Observations o;
  o.measurement = "D1";
  o.axes = {{"X", false, {}, {}}, {"Y", false, {}, {}}};
  o.lines = {{"D1", {0.8, 0.6, 0.0}}};
  for (int i = 0; i <= 30; ++i) {
    const double along = 0.5 * i + (i == 30 ? 5e-8 : 0.0);  // the last digit of the file
    o.axes[0].position.push_back(0.8 * along);
    o.axes[1].position.push_back(1.0 + 0.6 * along);
    for (auto& axis : o.axes) axis.approach.push_back(1);
    o.deviation.push_back(1e-6 * i);
    o.run.push_back(1);
  }
  c.campaign.measurements.push_back(m);
  c.observations.push_back(o);
  const std::string report = text(c);
  EXPECT_TRUE(has(report, "31 targets from 0 to 15000")) << report;
  EXPECT_FALSE(has(report, "12000.0"));
}

TEST_F(PdfReport, AFindingOfTwoAnalysesIsSaidOnce) {
  const std::string report = text(usual());
  // once in the status at the top, once among the findings, once with its advice
  EXPECT_EQ(occurrences(report, "Lost motion at reversal"), 3U);
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
  table.result.notes = {{"fanuc.sign"}, {.id = "unknown", .english = "As it came."}};
  c.results.outputs.push_back(table);
  c.results.notes = {{"csv.empty-rows", {{"rows", 3.0, Quantity::count}}, {}, "X"}};
  const std::string en = text(c), it = text(c, "it");
  for (const char* what : {"Inferred: the sign", "X: Empty rows of the file", "computed directly"})
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
  c.campaign.customer = "กข";
  EXPECT_TRUE(has(complaint(c), "campaign.customer"));
  EXPECT_TRUE(has(complaint(c), "U+0E01"));
  EXPECT_EQ(write(c).error().key, "campaign.customer");
  c.campaign.customer = "Ωμέγα, Ёлка, Łódź";
  EXPECT_TRUE(has(text(c), "Ωμέγα, Ёлка, Łódź"));
}

TEST_F(PdfReport, ErrorsThatQuoteRubbishArePrinted) {
  Case c = simple_case();
  c.results.errors.push_back({"expected a number, found \"ก\x01\"", "x.csv", 7});
  EXPECT_TRUE(has(text(c), "x.csv:7: expected a number, found \"<U+0E01><U+0001>\""));
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
  templates.tables["words/en/report"].values.erase("status.warnings");
  EXPECT_TRUE(has(complaint(c), "templates/words/en/report.toml: the key \"status.warnings\""));
}

Series curve(const std::string& name, double length, double size) {
  Series s{name, name.substr(2), Quantity::length, Quantity::deviation, {}, {}, {}};
  for (int i = 0; i <= 10; ++i) {
    s.position.push_back(length * i / 10);
    s.value.push_back(size * std::sin(std::numbers::pi * i / 10));
  }
  return s;
}

/// A campaign with measurements of this kind, and what an analysis said of each.
Case spatial(const std::string& kind, const std::vector<std::pair<std::string, Evaluation>>& said) {
  Case c = simple_case();
  for (const auto& [id, e] : said) {
    c.add("X", {});
    c.campaign.measurements.back().id = id;
    c.campaign.measurements.back().kind = kind;
    c.results.analyses.push_back({kind, "1", id, e});
  }
  return c;
}

Evaluation diagonals(double size, bool separable) {
  Evaluation e;
  e.values = {{"C0Y", 4e-6, Quantity::small_angle, 1e-7}};
  PointTable::Column target{"target", Quantity::length, {}}, D1{"D1", Quantity::deviation, {}};
  for (int i = 0; i <= 10; ++i) {
    target.values.push_back(1.5 * i);
    D1.values.push_back(size * i);
  }
  PointTable::Column D2 = D1;
  D2.name = "D2";
  e.points.columns = {target, D1, D2};
  if (separable) e.series = {curve("EYX", 12.0, size), curve("EXY", 9.0, -size)};
  return e;
}

TEST_F(PdfReport, DiagonalsShowTheEarlierSetAndThePlaneWithItsFactor) {
  // Largest error of the plane: 4 urad over 9 m; 6 % of 12 m is 20000 times that.
  const Case c = spatial(
      "diagonal", {{"D1 00", diagonals(4e-6, true)}, {"D1 final", diagonals(0.4e-6, false)}});
  const std::string en = text(c), it = text(c, "it");
  EXPECT_EQ(occurrences(en, "Readings of both diagonals"), 2U);
  EXPECT_EQ(occurrences(en, "D1, D1 00"), 1U) << "the first set in the figure of the later one";
  EXPECT_EQ(occurrences(en, "D2, D1 00"), 1U);
  EXPECT_EQ(occurrences(en, "The plane, errors × 20000"), 1U)
      << "what was not separated is not drawn";
  EXPECT_TRUE(has(en, "Position of X / mm") && has(en, "Position of Y / mm"));
  EXPECT_EQ(occurrences(it, "Il piano, errori × 20000"), 1U);
}

Evaluation step_diagonals(bool scales) {
  Evaluation e;
  for (const char* name : {"C0Y", "B0Z", "A0Z"})
    e.values.push_back({name, 0.0, Quantity::small_angle, 1e-7});
  for (const char* name : {"EYX", "EZX", "EXY", "EZY", "EXZ", "EYZ"})
    e.series.push_back(curve(name, name[2] == 'X' ? 0.8 : 0.6, 0.0));
  for (const char* name : {"EXX", "EYY", "EZZ"})
    e.series.push_back(
        curve(name + std::string(scales ? "" : "_shape"), name[2] == 'X' ? 0.8 : 0.6, 0.0));
  for (Series& s : e.series) s.over = s.name.substr(2, 1);
  for (double& v : e.series[0].value) v = 0.0;
  e.series[0].value.back() = 24e-6;  // of EYX, at the far end of X
  return e;
}

TEST_F(PdfReport, TheVolumeSaysItsFactorAndItsLargestError) {
  const Case c = spatial("step-diagonal", {{"SD", step_diagonals(true)}});
  const auto on_one_line = [](std::string words) {
    std::replace(words.begin(), words.end(), '\n', ' ');
    return words;
  };
  const std::string en = on_one_line(text(c)), it = on_one_line(text(c, "it"));
  // A fifth of 800 mm is 6667 times 24 um; the factor is 1, 2 or 5 times a power of ten.
  EXPECT_TRUE(has(en, "The volume, errors × 5000")) << en;
  EXPECT_TRUE(has(en, "Errors relative to the corner are enlarged 5000 times."));
  EXPECT_TRUE(has(en, "The largest is 24.0 µm, at X 800, Y")) << en;
  EXPECT_TRUE(has(en, "X 0 – 800, Y 0 – 600,")) << en;
  EXPECT_FALSE(has(en, "Without E"));
  EXPECT_TRUE(has(it, "ingranditi 5000 volte"));
  const std::string shapes =
      on_one_line(text(spatial("step-diagonal", {{"SD", step_diagonals(false)}})));
  EXPECT_TRUE(has(shapes, "Without EXX, EYY, EZZ: these scales are not known."));
  Evaluation incomplete = step_diagonals(true);
  incomplete.values.pop_back();
  EXPECT_FALSE(has(text(spatial("step-diagonal", {{"SD", incomplete}})), "The volume"));
}

TEST_F(PdfReport, AHeadingWithOneLineBelowItGoesToTheNextPageToo) {
  std::size_t seen = 0;
  for (int targets = 5; targets < 80; targets += 2) {
    Case c = simple_case();
    Behaviour b;
    b.targets = targets;
    c.add("X", b);
    c.add("Y", {});
    c.analyse(plugins);
    const auto result = write(c);
    ASSERT_TRUE(result) << result.error().message;
    for (const std::string& page : read_pdf(result->artifacts.front().bytes).pages) {
      const std::size_t at = page.find("Axis Y, linear");
      if (at == page.npos) continue;
      ++seen;
      EXPECT_NE(page.find("Symbol", at), page.npos) << targets;
    }
  }
  EXPECT_EQ(seen, 38U);
}

TEST_F(PdfReport, PlansAndTheirFindingsAreShown) {
  Case c = usual();
  Evaluation plan;
  plan.rows.columns = {{"a", Quantity::count, {56, 45}},
                       {"step_x", Quantity::length, {0.448, 0.495}},
                       {"cover_x", Quantity::ratio, {0.9956, 0.95}}};
  plan.findings = {
      {.id = "triples.flat", .attention = true, .evidence = {{"gain", 3.4, Quantity::ratio}}}};
  c.results.analyses.push_back({"triple-planner", "1", "", plan});
  const std::string en = text(c), it = text(c, "it");
  for (const char* what : {"Plans: stops for the diagonals", "step X", "448", "0.9956",
                           "Diagonals too flat for a plan"})
    EXPECT_TRUE(has(en, what)) << what;
  EXPECT_EQ(occurrences(en, "Diagonals too flat for a plan"), 3U)
      << "at the top, beside the plans, with its advice";
  for (const char* what : {"Piani: fermate", "passo X", "0,9956"})
    EXPECT_TRUE(has(it, what)) << what;
}

TEST_F(PdfReport, ManyPredictionsHaveTheirFilesBelowTheTable) {
  Case c = usual();
  Results::Written table{"some-control", "1", {}};
  table.result.artifacts = {{"some-control-X.txt", ""}, {"some-control-XYZ.txt", ""}};
  for (const char* name : {"E", "B", "PPP", "NPP", "PNP", "PPN"})
    table.result.predictions.push_back({"X", name, 60.0e-6, 0.7e-6});
  c.results.outputs.push_back(table);
  const std::string en = text(c);
  EXPECT_TRUE(has(en, "some-control: some-control-X.txt, some-control-XYZ.txt")) << en;
  EXPECT_EQ(occurrences(en, "60.00 → 0.70"), 6U);
}

TEST_F(PdfReport, ValuesThatNameAnotherMeasurementHaveTheirMeaning) {
  Case c = usual();
  Evaluation e;
  e.values = {{"distance_C 2", 1e-4, Quantity::length, 1e-6},
              {"angle_C 2", 1.57, Quantity::angle, {}}};
  c.results.analyses.push_back({"rotary-kinematics", "1", "X", e});
  EXPECT_TRUE(has(text(c), "Distance from the axis of C 2"));
  EXPECT_TRUE(has(text(c, "it"), "Angolo con l'asse di C 2"));
}

}  // namespace
}  // namespace nonio::fixtures::pdf_report_test
