// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <optional>

#include "fixtures.h"
#include "model_fixture.h"
#include "nonio/reports/residuals.h"
#include "pdf_reader.h"

namespace nonio::fixtures::model_report_test {
namespace {

/// Lines are as the layout breaks them; sentences are wanted.
std::string flat(std::string text) {
  std::replace(text.begin(), text.end(), '\n', ' ');
  return text;
}

struct ModelReport : testing::Test {
  Plugins plugins;
  Templates templates = read_templates(NONIO_TEMPLATES);

  void SetUp() override { ASSERT_TRUE(plugins.load(NONIO_PLUGINS, "pdf-report")); }
  std::string pdf(const ModelFit& fit, const std::string& language = "en",
                  const std::optional<Results::Analysed>& fitted = {}) {
    Case c = simple_case();
    c.results.models = {fit};
    if (fitted) {
      c.campaign.measurements = {{"X", "axis", "X", "", "x.csv", "", {}, {}}};
      c.results.analyses = {*fitted};
    }
    Settings options = defaults(plugins.outputs.front().info);
    options.values["language"] = language;
    const auto result =
        plugins.outputs.front().write({c.campaign, c.observations, c.results, options, templates});
    EXPECT_TRUE(result) << result.error().message;
    return result ? result->artifacts.front().bytes : "";
  }
  /// The text of the page of pictures.
  std::string pictures(const ModelFit& fit, const std::string& language = "en") {
    const auto read = read_pdf(pdf(fit, language));
    const std::string first = language == "de"   ? "1 Über der Position"
                              : language == "it" ? "1 Per posizione"
                                                 : "1 By position";
    for (const auto& page : read.pages)
      if (page.find(first) != std::string::npos) return flat(page);
    ADD_FAILURE() << "no page of pictures";
    return "";
  }
};

bool has(const std::string& text, const std::string& what) {
  return text.find(what) != std::string::npos;
}

MadeModel bare() { return {false, false, false, false, false, 11, 1, false}; }
MadeModel turn() { return {true, true, true, false, true, 25, 3, true}; }

TEST_F(ModelReport, NinePicturesAreOnOnePageInBothLanguagesWhateverTheDataAre) {
  for (const MadeModel& made : {MadeModel{}, bare(), turn()})
    for (const char* language : {"de", "en", "it"}) {
      const std::string page = pictures(made_model(made), language);
      const reports::Wording words(templates, language, {"pictures"});
      for (const auto& said : reports::picture_words(made_model(made), words))
        EXPECT_TRUE(has(page, said.title)) << language << ": " << said.title << "\n" << page;
    }
}

TEST_F(ModelReport, APictureWithoutDataSaysWhy) {
  const std::string page = pictures(made_model(bare()));
  for (const char* why : {"Measured from one direction only.", "No times.", "No temperature.",
                          "Screw pitch not stated.", "A single run: none can be left out."})
    EXPECT_TRUE(has(page, why)) << why << "\n" << page;
  ModelFit aliased = made_model();
  for (double& p : aliased.target) p = aliased.period.value() * std::round(p / *aliased.period);
  EXPECT_TRUE(has(pictures(aliased), "All targets are at the same phase of 12 mm"));
  EXPECT_FALSE(has(pictures(made_model()), "All targets are at the same phase"));
}

TEST_F(ModelReport, GivesParametersWithUAndNamesThoseThatGoTogether) {
  const std::string text = flat(read_pdf(pdf(made_model())).all());
  for (const char* what : {"-6.10", "0.12", "µm/h", "backlash:X b and periodic:X a (-0.95)",
                           "+ zero-drift:X", "noise floor, 0.590 ± 0.060"})
    EXPECT_TRUE(has(text, what)) << what << "\n" << text;
}

TEST_F(ModelReport, SaysWhatAParameterIsIfThereAreWords) {
  ModelFit fit = made_model();
  fit.parameters.push_back({"sag:X", "a", 1.25e-6, 0.1e-6, Quantity::deviation});
  fit.parameters.push_back({"run-jump:X", "instant", 720.7, {}, Quantity::time, true});
  fit.parameters.push_back({"pitch-curve:X", "s12", 2e-6, 0.1e-6, Quantity::deviation});
  const std::string english = flat(read_pdf(pdf(fit)).all());
  for (const char* what : {"backlash:X b reversal -6.10", "sag:X a 1.25 0.20 µm",
                           "instant instant 720.7 – s", "s12 part of the curve"})
    EXPECT_TRUE(has(english, what)) << what << "\n" << english;
  const std::string italian = flat(read_pdf(pdf(fit, "it")).all());
  EXPECT_TRUE(has(italian, "backlash:X b errore di inversione")) << italian;
}

TEST_F(ModelReport, ValuesOfTheFitAreInWordsAndWithUnits) {
  Results::Analysed fitted{"model-fit", "1", "X", {}};
  fitted.evaluation.values = {{"rms", 0.6e-6, Quantity::deviation},
                              {"cv_rms", 0.61e-6, Quantity::deviation},
                              {"largest_residual", -1.5e-6, Quantity::deviation},
                              {"redundancy", 401, Quantity::count},
                              {"lack_of_fit_F", 2.5, Quantity::number},
                              {"lack_of_fit_p", 1e-9, Quantity::probability}};
  const std::string text = flat(read_pdf(pdf(made_model(), "en", fitted)).all());
  EXPECT_TRUE(has(text, "410 readings, redundancy 401. Largest residual -1.50 µm.")) << text;
  for (const char* raw : {"cv rms", "cv_rms", "lack of fit", "F = ", "model-fit"})
    EXPECT_FALSE(has(text, raw)) << raw;
}

TEST_F(ModelReport, PlacesAreSaidInTheLanguageOfTheReport) {
  Results::Analysed fitted{"model-fit", "1", "X", {}};
  fitted.evaluation.findings = {{"model.fails",
                                 true,
                                 {{"percent", 64, Quantity::count},
                                  {"rms", 1.5e-6, Quantity::deviation},
                                  {"p", 1e-9, Quantity::probability}},
                                 {{"where", "direction x time"}, {"line", ""}}}};
  for (const auto& [language, says] :
       {std::pair("en", "depends on the direction of approach together with the time (p < 0.0001)"),
        std::pair("it", "dipende dalla direzione di avvicinamento e insieme dal tempo")}) {
    const std::string text = flat(read_pdf(pdf(made_model(), language, fitted)).all());
    EXPECT_TRUE(has(text, says)) << text;
  }
}

TEST_F(ModelReport, CurvesAreDescribedByTheirShape) {
  ModelFit fit = made_model();
  fit.effects.push_back({"pitch-curve:X", true, std::vector<double>(fit.size(), 0.0),
                         ModelFit::Curve{0.7e-6, -1.1e-6, 0.9e-6, 0.21, 0.64}});
  fit.parameters.push_back({"pitch-curve:X", "s1", 0.4936e-6, 0.04e-6, Quantity::deviation});
  fit.parameters.push_back({"pitch-curve:X", "s2", -0.3546e-6, 0.04e-6, Quantity::deviation});
  const std::string english = flat(read_pdf(pdf(fit)).all());
  for (const char* what :
       {"pitch-curve:X curve, RMS 0.700", "lowest, at 210 mm -1.10", "highest, at 640 mm 0.900"})
    EXPECT_TRUE(has(english, what)) << what << "\n" << english;
  EXPECT_FALSE(has(english, "s1")) << english;
  EXPECT_TRUE(has(flat(read_pdf(pdf(fit, "it")).all()), "minimo, a 210 mm -1,10"));
}

TEST_F(ModelReport, CandidatesTheSizesOfOthersAndWhatToMeasureAreInIt) {
  const std::string text = flat(read_pdf(pdf(with_candidates(made_model()))).all());
  for (const char* what :
       {"scale:X – significant 81.5 0.600 µm 0.620 µm 0.150 µm",
        "No sign of: warm-up:X (would be detected from 1.10 µm); temperature:X (0.250 µm).",
        "What to measure next: Record the material temperature"})
    EXPECT_TRUE(has(text, what)) << what << "\n" << text;
}

TEST(Residuals, LinesInSpaceHaveLanesOfTheirOwn) {
  ModelFit fit;
  fit.axis = "XY";
  fit.measurements = {"X1", "D1"};
  fit.measurement = {0, 0, 1, 1, 1};
  fit.target = {0.1, 0.5, 0.0, 0.3, 1.2};
  fit.deviation = fit.residual = {0, 0, 0, 0, 0};
  const reports::Lanes lanes = reports::lanes_of(fit);
  ASSERT_EQ(lanes.names, fit.measurements);
  for (std::size_t i = 0; i < fit.size(); ++i) {
    const double at = lanes.at(fit.measurement[i], fit.target[i]);
    EXPECT_GT(at, fit.measurement[i]);
    EXPECT_LT(at, fit.measurement[i] + 1.0);
  }
  EXPECT_NEAR(lanes.at(1, 0.6), 1.5, 1e-12);
  fit.axis = "X";  // two measurements of one axis have one scale
  EXPECT_TRUE(reports::lanes_of(fit).names.empty());
}

TEST_F(ModelReport, ItsLastLineSaysThatItIsTheEnd) {
  const std::string page = pictures(made_model());
  EXPECT_TRUE(has(page, "End of the report.")) << page;
}

TEST_F(ModelReport, AMillionReadingsMakeALightFile) {
  MadeModel many;
  many.targets = 1001;
  many.runs = 500;
  many.suspects = false;
  const ModelFit fit = made_model(many);
  ASSERT_GT(fit.size(), 1000000U);
  EXPECT_LT(pdf(fit).size(), 1500000U);
}

TEST_F(ModelReport, TheSameBytesTwice) { EXPECT_EQ(pdf(made_model()), pdf(made_model())); }

TEST_F(ModelReport, AModelWithoutEffectsAndReadingsStillHasItsPage) {
  ModelFit fit;
  fit.part = fit.axis = "X";
  EXPECT_TRUE(has(pictures(fit), "No readings."));
}

TEST(Residuals, NormalQuantilesAreThoseOfTheTables) {
  ModelFit fit;
  for (int i = 0; i < 200; ++i) fit.residual.push_back(i), fit.deviation.push_back(i);
  const auto normal = reports::normal_plot(fit);
  ASSERT_EQ(normal.values.x.size(), 200U);
  EXPECT_NEAR(normal.values.x[0], -2.807033768343811, 1e-9);  // p = 0.0025, tabulated
  EXPECT_NEAR(normal.values.x[4], -2.005, 1e-3);              // p = 0.0225
  for (std::size_t i = 0; i < 200; ++i)
    EXPECT_NEAR(normal.values.x[i], -normal.values.x[199 - i], 1e-9);
}

TEST(Residuals, ReversalOfTheResidualLeavesSuspectsOut) {
  ModelFit fit;
  fit.target = {1, 1, 1, 2};
  fit.direction = {1, -1, -1, 1};
  fit.deviation = fit.residual = {3, 1, 100, 5};
  fit.weight = {1, 1, 0, 1};
  const auto reversal = reports::reversal_of(fit);
  ASSERT_EQ(reversal.values.x, std::vector<double>{1.0});
  EXPECT_EQ(reversal.values.y, std::vector<double>{2.0});
  EXPECT_EQ(reversal.spread, std::vector<double>{std::sqrt(2.0)});
}

TEST(Residuals, AMultipleOfThePeriodHasPhaseZeroWhateverItsLastDigit) {
  ModelFit fit;
  fit.target = {0.0, 0.3 - 1e-16, 0.1 * 3, -0.05};
  fit.deviation = fit.residual = {0, 0, 0, 0};
  const auto phase = reports::phase_of(fit, 0.1);
  EXPECT_NEAR(phase[0], 0.0, 1e-12);
  EXPECT_NEAR(phase[1], 0.0, 1e-12);
  EXPECT_NEAR(phase[2], 0.0, 1e-12);
  EXPECT_NEAR(phase[3], 0.05, 1e-12);
}

TEST_F(ModelReport, ErrorsOfAPartAreDrawnOverItsFeatures) {
  Observations o;
  o.measurement = "P1";
  o.axes = {{"X", false, {}, {}}, {"Y", false, {}, {}}};
  ModelFit fit;
  fit.part = fit.axis = "XY";
  fit.measurements = {"P1"};
  fit.effects = {{"scale:X", true, {}}, {"body-turn:P1", false, {}}};
  fit.effects[1].is_set_up = true;
  for (const char* name : {"P1 X", "P1 Y"}) {
    o.lines.push_back({name, {}});
    o.lines.back().body = "P1";
    o.lines.back().sense[o.lines.size() - 1] = 1.0;
  }
  for (std::uint32_t feature = 0; feature < 4; ++feature)
    for (std::uint32_t line = 0; line < 2; ++line) {
      o.axes[0].position.push_back(feature % 2 == 0 ? 0.0 : 0.1);
      o.axes[1].position.push_back(feature < 2 ? 0.0 : 0.1);
      o.line.push_back(line);
      o.source_line.push_back(feature + 2);
      o.deviation.push_back(line == 0 ? 9e-6 : 0.0);
      fit.measurement.push_back(0), fit.source_line.push_back(feature + 2), fit.run.push_back(1);
      fit.target.push_back(0.0), fit.direction.push_back(0);
      fit.time.push_back(NAN), fit.temperature.push_back(NAN);
      fit.deviation.push_back(o.deviation.back());
      fit.residual.push_back(line == 0 ? 1e-6 : 0.0), fit.weight.push_back(1.0);
      fit.effects[0].contribution.push_back(line == 0 ? 3e-6 : 0.0);
      fit.effects[1].contribution.push_back(line == 0 ? 5e-6 : 0.0);
    }
  Case c = simple_case();
  c.campaign.measurements = {{"P1", "part", "", "", "p.csv", "", {}, {}}};
  c.observations = {o};
  c.results.models = {fit};
  c.results.analyses.clear();
  const Settings options = defaults(plugins.outputs.front().info);
  const auto text = [&] {
    const auto result =
        plugins.outputs.front().write({c.campaign, c.observations, c.results, options, templates});
    EXPECT_TRUE(result) << result.error().message;
    std::string all;
    for (const auto& page : read_pdf(result->artifacts.front().bytes).pages) all += flat(page);
    return all;
  };
  const std::string map = text();
  EXPECT_TRUE(has(map, "P1: errors, RMS 2.83 \u00b5m")) << map;  // 4 um in X, 0 in Y
  EXPECT_TRUE(has(map, "P1: what the model leaves, RMS 0.707 \u00b5m")) << map;
  EXPECT_TRUE(has(map, "2000 times enlarged")) << map;  // 100 mm / 8 / 4 um is 3125
  c.observations.front().lines[0].body.clear(), c.observations.front().lines[1].body.clear();
  EXPECT_FALSE(has(text(), "times enlarged"));
}

}  // namespace
}  // namespace nonio::fixtures::model_report_test
