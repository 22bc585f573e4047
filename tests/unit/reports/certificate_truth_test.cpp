// SPDX-License-Identifier: Apache-2.0
//
// What a signed paper says is so: of the method, of its departures, of the decision; and the DCC
// says the same.
#include <algorithm>
#include <cstdlib>
#include <set>

#include "certificate_case.h"
#include "nonio/sdk/format.h"
#include "pdf_reader.h"

namespace nonio::fixtures::certificate_truth_test {
namespace {

bool has(const std::string& text, const std::string& what) {
  return text.find(what) != std::string::npos;
}

struct Truth : testing::Test {
  Plugins plugins;
  Templates templates = read_templates(NONIO_TEMPLATES);
  Issue issue{"2026-0012", "2026-11-21", "", "", {}, std::string(64, 'a')};

  void SetUp() override {
    for (const char* name : {"iso230-2", "vdi-dgq-3441", "certificate"})
      ASSERT_TRUE(plugins.load(NONIO_PLUGINS, name));
  }
  const Output& output() const { return plugins.outputs.front(); }
  OutputInput input(const Case& c) const {
    static const Settings none;
    return {c.campaign, c.observations, c.results, none, templates, &issue};
  }
  std::vector<std::string> files(const Case& c) const {
    const auto result = output().write(input(c));
    EXPECT_TRUE(result) << result.error().message;
    if (!result) return {"", ""};
    return {result->artifacts[0].bytes, result->artifacts[1].bytes};
  }
  std::string page(const Case& c) const {
    std::string text = read_pdf(files(c)[0]).all();
    std::replace(text.begin(), text.end(), '\n', ' ');
    return text;
  }
  std::string dcc(const Case& c) const { return files(c)[1]; }

  Case made(const Behaviour& b) const {
    Case c = whole_case(plugins);
    c.observations = {observe("X", "X", b)};
    analyse(c);
    return c;
  }
  void analyse(Case& c) const {
    c.results.analyses.clear();
    c.analyse(plugins);
  }
  /// With an option that both evaluations have.
  void analyse_with(Case& c, const std::string& option, Setting value) const {
    c.results.analyses.clear();
    for (const Analysis& a : plugins.analyses) {
      Settings options = defaults(a.info);
      if (options.has(option)) options.values[option] = value;
      auto e =
          a.analyse({c.campaign, c.campaign.measurements[0], c.observations[0], options, nullptr});
      ASSERT_TRUE(e) << e.error().message;
      c.results.analyses.push_back({a.info.name, a.info.version, "X", std::move(*e)});
    }
  }
};

constexpr const char* unchanged = "othing was added to the method";

TEST_F(Truth, ThatNothingWasChangedIsNotStatedByDefault) {
  Case c = whole_case(plugins);
  EXPECT_FALSE(has(page(c), unchanged));
  EXPECT_TRUE(has(page(c), "The evaluation of the readings found none."));
  c.campaign.certificate.no_other_deviations_by = "B. Verdi";
  EXPECT_TRUE(
      has(page(c), "B. Verdi states: apart from the departures listed here, nothing was added"));
  EXPECT_TRUE(has(dcc(c), "B. Verdi states: apart from"));
}

TEST_F(Truth, WhatWasExcludedIsSaidWithItsReasonAndWithoutOneThereIsNoCertificate) {
  Case c = whole_case(plugins);
  c.campaign.measurements[0].exclude = {57};
  c.observations[0].notes = {
      {"reading.excluded",
       {{"line", 57, Quantity::count}, {"deviation", 88e-6, Quantity::deviation}},
       {{"file", "X.csv"}}}};
  const auto keys = output().certificate->missing_requirements(input(c));
  ASSERT_EQ(keys.size(), 1U);
  EXPECT_TRUE(keys[0].starts_with("measurement.X.exclude_reason")) << keys[0];
  c.campaign.measurements[0].exclude_reason = " - ";
  EXPECT_EQ(output().certificate->missing_requirements(input(c)), keys) << "a dash is no reason";
  c.campaign.measurements[0].exclude_reason = "beam interrupted";
  EXPECT_TRUE(output().certificate->missing_requirements(input(c)).empty());
  const std::string said = "X.csv: line 57 (88.0 µm). Reason: beam interrupted.";
  EXPECT_TRUE(has(page(c), said));
  EXPECT_TRUE(has(dcc(c), said));
}

// ISO 17025 7.2.2: a test that follows a standard only in part is one by the laboratory's procedure, which has a name.
TEST_F(Truth, ATestThatIsOnlyBasedOnAStandardNamesTheLaboratorysProcedure) {
  for (const auto& [plugin, standard] : {std::pair{"circle", "ISO 230-4"},
                                         {"thermal", "ISO 230-3"},
                                         {"spindle", "ISO 230-7"},
                                         {"lengths", "ISO 10360-2"}}) {
    Case c = whole_case(plugins);
    Results::Analysed own;
    own.plugin = plugin, own.version = "1.0.0", own.measurement = "X";
    own.evaluation.values.push_back({"D", 1e-6, Quantity::deviation, 0.5e-6, 2.0, {}});
    c.results.analyses.push_back(own);
    c.campaign.certificate.procedure = "";
    const auto keys = output().certificate->missing_requirements(input(c));
    EXPECT_TRUE(std::any_of(keys.begin(), keys.end(), [](const std::string& key) {
      return key.starts_with("certificate.procedure");
    })) << plugin;
    c.campaign.certificate.procedure = "PT-07";
    for (const std::string& text : {page(c), dcc(c)})
      EXPECT_TRUE(has(text, std::string("Laboratory procedure PT-07, based on ") + standard))
          << plugin << text;
  }
}

// Paper and DCC state that a calibration had expired, and who approved the certificate in spite of it.
TEST_F(Truth, AnExpiredCalibrationAndTheReasonOfTheApprovalAreStated) {
  struct Expired {
    const char* id;
    std::vector<std::pair<std::string, std::string>> texts;
    const char* says;
  };
  const std::vector<Expired> all{
      {"traceability.calibration-expired",
       {{"instrument", "instrument L-1"},
        {"valid_until", "2026-06-01"},
        {"measured", "2026-11-20"}},
       "The calibration of Measuring instrument L-1 expired on 2026-06-01, before the measurement "
       "of "
       "2026-11-20."},
      {"traceability.calibrated-long-ago",
       {{"instrument", "sensor pressure P-9"},
        {"calibrated", "2019-01-12"},
        {"measured", "2026-11-20"},
        {"years", "2"}},
       "Air pressure P-9 was calibrated on 2019-01-12, more than 2 years before the measurement of "
       "2026-11-20; the validity of its calibration is not stated."}};
  const Case plain = whole_case(plugins);
  EXPECT_FALSE(has(page(plain), "expired"));
  for (const Expired& one : all) {
    Case c = plain;
    Results::Analysed found;
    found.plugin = "plausibility";
    found.evaluation.findings.push_back({.id = one.id, .attention = true, .texts = one.texts});
    c.results.analyses.push_back(found);
    issue.reasons.clear();
    for (const std::string& text : {page(c), dcc(c)}) {
      EXPECT_TRUE(has(text, one.says)) << text;
      EXPECT_FALSE(has(text, "Approved by"));
    }
    issue.reasons = {{one.id, "compared with a second laser", "B. Verdi"},
                     {"traceability.other", "of another finding", "B. Verdi"}};
    for (const std::string& text : {page(c), dcc(c)}) {
      EXPECT_TRUE(has(text, std::string(one.says) +
                                " Approved by B. Verdi because: compared with a second laser."))
          << text;
      EXPECT_FALSE(has(text, "of another finding"));
    }
    for (const char* language : {"it", "de", "es", "zh"}) {
      c.campaign.certificate.languages = {language};
      const std::string text = page(c);
      EXPECT_TRUE(has(text, "compared with a second laser")) << language;
      EXPECT_FALSE(has(text, "{")) << language << text;
    }
  }
}

TEST_F(Truth, ReadingsThatWereNotTakenAreCounted) {
  Case c = whole_case(plugins);
  c.observations[0].missing = 3;
  analyse(c);
  EXPECT_TRUE(has(page(c), "3 planned readings were not taken; 210 were."));
}

/// One target from one direction only.
Case with_target_of_one_direction(const Plugins& plugins) {
  Case c = whole_case(plugins);
  Observations& o = c.observations[0];
  for (std::size_t i = 0; i < o.size();)
    if (o.axes[0].approach[i] < 0 && o.axes[0].position[i] == o.axes[0].position[3]) {
      o.axes[0].position.erase(o.axes[0].position.begin() + static_cast<std::ptrdiff_t>(i));
      o.axes[0].approach.erase(o.axes[0].approach.begin() + static_cast<std::ptrdiff_t>(i));
      for (auto* column : {&o.deviation, &o.u, &o.material})
        column->erase(column->begin() + static_cast<std::ptrdiff_t>(i));
      o.run.erase(o.run.begin() + static_cast<std::ptrdiff_t>(i));
    } else {
      ++i;
    }
  return c;
}

TEST_F(Truth, TargetsLeftOutAreNotCountedAsEvaluated) {
  Case c = with_target_of_one_direction(plugins);
  analyse_with(c, "incomplete_targets", std::string("leave-out"));
  const std::string text = page(c);
  EXPECT_TRUE(has(text, "Evaluated: 20 of 21 targets."));
  EXPECT_TRUE(has(text, "1 of 21 targets were left out"));
}

TEST_F(Truth, AMeasurementOfWhichNothingIsPrintedIsNamed) {
  Case c = whole_case(plugins);
  const std::string said = "Measured in this campaign and not reported here";
  EXPECT_FALSE(has(page(c), said));
  Measurement straight = c.campaign.measurements[0];
  straight.id = "X-in-Y", straight.kind = "straightness", straight.lateral = "Y";
  c.campaign.measurements.push_back(straight);
  c.observations.push_back(c.observations[0]);
  for (const std::string& text : {page(c), dcc(c)})
    EXPECT_TRUE(has(text, said + ": Straightness of X in Y – measurement X-in-Y."));
}

TEST_F(Truth, ATestWithTargetsLeftOutIsOneToAPlanOfItsOwn) {
  Case c = with_target_of_one_direction(plugins);
  analyse(c);  // no value is given that needs the target; its plan is no other one for that
  EXPECT_TRUE(has(page(c), "1 of 21 targets were not reached from both directions"));
  EXPECT_TRUE(has(page(c), "the plan of ISO 230-2 was not followed"));
  EXPECT_FALSE(has(page(c), "ISO 230-2:2014, accuracy"));
  for (const char* of_vdi : {"VDI", "Ps"})  // it gives no value at all: no column either
    EXPECT_FALSE(has(page(c), of_vdi)) << of_vdi;
  analyse_with(c, "incomplete_targets", std::string("leave-out"));
  for (const std::string& text : {page(c), dcc(c)}) {
    EXPECT_TRUE(has(text, "20 of 21 targets are evaluated; ISO 230-2 requires all of them."));
    EXPECT_TRUE(has(text, "the plan of ISO 230-2 was not followed"));
    EXPECT_TRUE(has(text, "Positioning, with a non-standard test plan"));
    EXPECT_FALSE(has(text, "ISO 230-2:2014, accuracy"));
    EXPECT_FALSE(has(text, "VDI/DGQ 3441:1977, statistical"));
  }
}

TEST_F(Truth, APlanThatIsNotTheStandardsHasNoTitleWithItsName) {
  const Case follows = whole_case(plugins);
  EXPECT_TRUE(has(page(follows), "ISO 230-2:2014, accuracy"));
  EXPECT_FALSE(has(page(follows), "non-standard test plan"));
  Behaviour two_runs;
  two_runs.runs = 2;
  Case c = made(two_runs);
  for (const std::string& text : {page(c), dcc(c)}) {
    EXPECT_TRUE(has(text, "approached 2 times from one direction; ISO 230-2 requires 5."));
    EXPECT_TRUE(has(text, "the plan of ISO 230-2 was not followed"));
    EXPECT_TRUE(has(text, "Positioning, with a non-standard test plan"));
    EXPECT_FALSE(has(text, "ISO 230-2:2014, accuracy"));
    EXPECT_FALSE(has(text, "ISO 230-2: mean"));
    EXPECT_FALSE(has(text, "VDI/DGQ 3441:1977, statistical"));
  }
  Case pitch = whole_case(plugins);
  pitch.campaign.machine.axes[0].screw_pitch = 0.0001;
  analyse(pitch);
  EXPECT_TRUE(has(page(pitch), "whole multiples of 0.1 mm apart"));
  EXPECT_TRUE(has(page(pitch), "non-standard test plan"));
}

TEST_F(Truth, OneDirectionAndDriftAndEditionAreSaid) {
  Behaviour one;
  one.minus = false;
  const std::string single = page(made(one));
  EXPECT_TRUE(has(single, "Approached in direction + only."));
  EXPECT_TRUE(has(single, "non-standard test plan"));
  Behaviour drifting;
  drifting.drift = 3;
  const Case drifted = made(drifting);
  EXPECT_TRUE(has(page(drifted), "The whole travel drifted by 1"));
  EXPECT_TRUE(has(dcc(drifted), "The whole travel drifted by 1"));
  Case old = whole_case(plugins);
  analyse_with(old, "edition", std::int64_t{2006});
  EXPECT_TRUE(has(page(old), "Edition 2006 of the standard was used, not that of 2014."));
}

TEST_F(Truth, ASuspectThatCountsIsSaid) {
  Case c = whole_case(plugins);
  c.observations[0].deviation[50] += 30e-6;
  analyse(c);
  EXPECT_TRUE(has(page(c), "The results include a suspected misreading: run "));
}

TEST_F(Truth, HowTheTestWasMadeIsPrintedAndWhatWasNotStatedToo) {
  Case c = whole_case(plugins);
  const std::string before = page(c);
  for (const char* what : {"Not stated: feed, dwell, over-travel", "positions of the other axes",
                           "whether the compensation in the control was active", "warm-up"})
    EXPECT_TRUE(has(before, what)) << what;
  Measurement& m = c.campaign.measurements[0];
  m.feed = 1.2 / 60.0, m.dwell = 3.0, m.over_travel = 2e-3, m.compensation = "on";
  m.at = {{"Y", 0.5}}, m.tool_offset = {{"Z", -0.12}}, m.workpiece_offset = {{"X", 0.04}};
  c.campaign.environment.warm_up = "30 min at half feed";
  c.campaign.environment.sensors = "bed, ball nut";
  const std::string text = page(c);
  for (const char* what : {"Feed 1200 mm/min.", "Dwell 3 s.", "Over-travel 2 mm.",
                           "Other axes at Y 500 mm.", "Tool reference offset Z -120 mm.",
                           "Offset to the workpiece X 40 mm.", "Compensation in the control: on.",
                           "Warm-up: 30 min at half feed.", "Temperature sensors: bed, ball nut."})
    EXPECT_TRUE(has(text, what)) << what;
  EXPECT_FALSE(has(text, "Not stated"));
}

TEST_F(Truth, TheRuleIsNamedWithItsEditionAndItsWordsAreUsed) {
  struct Rule {
    const char *rule, *words, *pass, *fail, *norm, *risk;
  };
  const Rule rules[] = {
      {"iso14253-1", "ISO 14253-1:2017", "conforms", "does not conform", "ISO 14253-1:2017",
       "at least 95 %"},
      {"iso14253-1:2013", "ISO 14253-1:2013", "conforms", "does not conform", "ISO 14253-1:2013",
       "below 2.5 %"},
      {"ilac-g8-simple", "simple acceptance", "pass", "fail", "ILAC-G8:09/2019", "up to 50 %"},
      {"ilac-g8-guarded", "guard band w = U", "pass", "fail", "ILAC-G8:09/2019", "below 2.5 %"}};
  for (const Rule& r : rules) {
    Case c = whole_case(plugins);
    c.campaign.certificate.decision_rule = r.rule;
    decide(c, "iso230-2", "A", 1e-6, Decision::does_not_conform);
    decide(c, "iso230-2", "B", 50e-6, Decision::conforms);
    const std::string text = page(c), xml = dcc(c);
    for (const std::string& t : {text, xml}) {
      EXPECT_TRUE(has(t, r.words)) << r.rule;
      EXPECT_TRUE(has(t, r.risk)) << r.rule;
      EXPECT_TRUE(has(t, r.pass)) << r.rule;
      EXPECT_TRUE(has(t, r.fail)) << r.rule;
    }
    EXPECT_TRUE(has(xml, std::string("<dcc:norm>") + r.norm)) << r.rule;
  }
  Case open = whole_case(plugins);
  decide(open, "iso230-2", "A", 19e-6, Decision::cannot_be_decided, "near-limit");
  const std::string xml = dcc(open);
  EXPECT_TRUE(has(xml, "indeterminate"));
  EXPECT_FALSE(has(xml, "<dcc:conformity>")) << "ISO 14253-1 knows no conditional pass";
}

/// The texts between <element> and its end.
std::vector<std::string> texts_of(const std::string& xml, const std::string& element) {
  std::vector<std::string> out;
  for (std::size_t at = 0; (at = xml.find("<" + element + ">", at)) != std::string::npos;) {
    at += element.size() + 2;
    out.push_back(xml.substr(at, xml.find('<', at) - at));
  }
  return out;
}

std::size_t digits_of(const std::string& number) {
  std::size_t n = 0;
  bool leading = true;
  for (const char ch : number)
    if (ch >= '0' && ch <= '9' && !(leading && ch == '0')) ++n, leading = false;
  return n;
}

TEST_F(Truth, TheDccHasTheNumbersOfThePagesAndNoOthers) {
  Case c = whole_case(plugins);
  for (auto& a : c.results.analyses)
    for (Value& v : a.evaluation.values)
      if (v.name == "M") v.U.reset();
  const std::string xml = dcc(c);
  const auto values = texts_of(xml, "si:value"), Us = texts_of(xml, "si:valueExpandedMU");
  const std::string text = page(c);
  std::size_t told = 0;
  for (const auto& a : c.results.analyses)
    for (const Value& v : a.evaluation.values)
      if (v.U) {
        const auto shown = rounded_result(printed(v.value, v.quantity), printed(*v.U, v.quantity));
        EXPECT_NE(std::find(values.begin(), values.end(), shown->value), values.end()) << v.name;
        EXPECT_TRUE(has(text, " " + shown->value + " ")) << v.name;  // a reader copies "-" for "−"
        ++told;
      }
  EXPECT_EQ(Us.size(), told);
  EXPECT_FALSE(has(xml, "<dcc:content>M<")) << "without U it is not on paper either";
  for (const std::string& U : Us) EXPECT_LE(digits_of(U), 2U) << U;
  const auto lists = texts_of(xml, "si:valueExpandedMUXMLList");
  EXPECT_FALSE(lists.empty());
  for (const std::string& list : lists) {
    std::istringstream all(list);
    for (std::string U; all >> U;) EXPECT_LE(digits_of(U), 2U) << U;
  }
}

TEST_F(Truth, TheDccSpeaksTheLanguagesOfThePages) {
  Case c = whole_case(plugins);
  c.campaign.certificate.languages = {"it", "en"};
  c.campaign.certificate.procedure = "PT-07";
  c.campaign.certificate.opinions = "Good enough.";
  const std::string xml = dcc(c);
  for (const char* what :
       {"lang=\"it\">ISO 230-2:2014", "lang=\"en\">ISO 230-2:2014",
        "lang=\"en\">The results are traceable", "lang=\"it\">I risultati",
        "refType=\"basic_metrologicallyTraceableToSI\"",
        "refType=\"basic_methodMeasurementUncertainty\"", "refType=\"basic_measurementStandard\"",
        "refType=\"basic_temperature\"", "<si:value>20.1</si:value>", "PT-07", "Good enough.",
        "M. Bianchi", "info@example.org", "reproduced only in full", "Condition: in use",
        "Deviation = actual position"})
    EXPECT_TRUE(has(xml, what)) << what;
}

TEST_F(Truth, TheDccNamesWhatItReplacesWithItsDigestAndItselfOnlyOnce) {
  const Case c = whole_case(plugins);
  issue.replaces = "2026-0003", issue.replaces_date = "2026-10-01";
  issue.replaces_readings = std::string(64, 'b');
  issue.replaces_file = "certificate.xml", issue.replaces_sha256 = std::string(64, 'c');
  const std::string xml = dcc(c);
  EXPECT_TRUE(has(xml, "<dcc:uniqueIdentifier>2026-0012." + std::string(64, 'a')));
  EXPECT_TRUE(has(xml, "<dcc:value>2026-0012<"));
  EXPECT_TRUE(has(xml, "<dcc:replacedUniqueIdentifier>2026-0003." + std::string(64, 'b')));
  EXPECT_TRUE(has(xml, "<dcc:value>" + std::string(64, 'c')));
  EXPECT_TRUE(has(xml, "refType=\"basic_revision\""));
}

TEST_F(Truth, CurvesAreTablesWithUOnPaperAndListsInTheDcc) {
  Case c = whole_case(plugins);
  c.results.analyses[0].evaluation.series.push_back({"EYX",
                                                     "X",
                                                     Quantity::length,
                                                     Quantity::deviation,
                                                     {0.0, 0.5, 1.0},
                                                     {1.234e-6, -5.678e-6, 9.1e-6},
                                                     {0.44e-6, 0.55e-6, 0.66e-6}});
  const std::string text = page(c), xml = dcc(c);
  EXPECT_TRUE(has(text, "Curve EYX"));
  for (const char* what : {" 1.23 ", " -5.68 ", " 9.10 ", " 0.44 ", " 0.55 ", " 0.66 "})
    EXPECT_TRUE(has(text, what)) << what;
  EXPECT_TRUE(has(xml, "<si:valueXMLList>1.23 -5.68 9.10<"));
  EXPECT_TRUE(has(xml, "<si:valueExpandedMUXMLList>0.44 0.55 0.66<"));
}

TEST_F(Truth, TheFirstPageSaysItAll) {
  Case c = whole_case(plugins);
  decide(c, "iso230-2", "A", 25e-6, Decision::conforms);
  std::string first = read_pdf(files(c)[0]).pages.front();
  std::replace(first.begin(), first.end(), '\n', ' ');
  for (const char* what : {"Limit", "conforms", "U (k = 2)", "Limit of A = 25 µm", "run 1", "run 5",
                           "Temperature of the machine", "Electronic signature", "B. Verdi"})
    EXPECT_TRUE(has(first, what)) << what;
}

/// A limit with which no result was compared is stated; a test in one direction has results.
TEST_F(Truth, LimitsThatNothingWasHeldAgainstAreSaid) {
  Behaviour one;
  one.minus = false;
  Case c = made(one);
  Axis other = c.campaign.machine.axes[0];
  other.name = "Z";
  other.tolerance = {{"A", 10e-6}};
  c.campaign.machine.axes.push_back(other);
  c.campaign.machine.axes[0].tolerance = {{"A", 30e-6}, {"B", 6e-6}};
  std::string first = read_pdf(files(c)[0]).pages.front();
  std::replace(first.begin(), first.end(), '\n', ' ');
  for (const std::string& text : {first, dcc(c)}) {
    EXPECT_TRUE(has(text, "X: no decision on A, B; a limit is stated, but")) << text;
    EXPECT_TRUE(has(text, "axes that were not measured; no decisions are given for them: Z."));
  }
  for (const char* what : {"A↑", "E↑", "R↑"}) EXPECT_TRUE(has(first, what)) << what;
  decide(c, "iso230-2", "A", 30e-6, Decision::conforms);
  EXPECT_TRUE(has(page(c), "X: no decision on B; a limit"));
}

/// However many there are: a customer could not object to a decision that is not printed.
TEST_F(Truth, EveryDecisionIsPrinted) {
  Case c = whole_case(plugins);
  for (int i = 1; i <= 8; ++i) {
    const std::string id = "X" + std::to_string(i);
    c.add(id, {});
    c.campaign.machine.axes.back().expansion = 11.5e-6;
  }
  analyse(c);
  for (const Measurement& m : c.campaign.measurements)
    for (const char* name : {"A", "R", "B"})
      c.results.conformity.push_back(
          {m.id, "X", "iso230-2", name, 1e-6, Quantity::deviation, Decision::does_not_conform, ""});
  ASSERT_EQ(c.results.conformity.size(), 27U);
  const std::string text = page(c);
  std::size_t count = 0;
  for (std::size_t at = text.find("does not conform "); at != std::string::npos;
       at = text.find("does not conform ", at + 1))
    ++count;
  EXPECT_GE(count, c.results.conformity.size()) << text;
}

/// "ISO 230-2" and "the plan of ISO 230-2 was not followed" of one paper: of which axis each.
TEST_F(Truth, TwoMethodsSayForWhichMeasurementsTheyHold) {
  Case c = whole_case(plugins);
  Behaviour two_runs;
  two_runs.runs = 2;
  c.add("Y short", two_runs);
  c.campaign.machine.axes.back().expansion = 11.5e-6;
  analyse(c);
  const std::string text = page(c);
  EXPECT_TRUE(has(text, "X: ISO 230-2:2014, accuracy")) << text;
  EXPECT_TRUE(has(
      text, "Y short: Positioning of a numerically controlled axis with a non-standard test plan"));
}

/// The frame's page is the first one, however long names, tables and changes are.
TEST_F(Truth, TheSignatureIsOnTheFirstPageWhateverIsAboveIt) {
  const std::string name(90, 'N');
  for (const std::vector<std::string>& languages :
       {std::vector<std::string>{"en"}, {"de", "en"}, {"it", "en"}, {"es", "zh"}}) {
    Case c = whole_case(plugins);
    c.campaign.certificate.languages = languages;
    c.campaign.customer = c.campaign.customer_address = c.campaign.machine.maker =
        name + " " + name;
    c.campaign.laboratory.name = name;
    for (int i = 0; i < 8; ++i)
      c.campaign.sensors.push_back({"air", name, name, "1", "2026-01-01", "", "C-1", name});
    for (const char* result : {"A", "A+", "A-", "E", "E+", "E-", "R", "R+", "R-", "B"})
      decide(c, "iso230-2", result, 25e-6, Decision::conforms);
    issue.replaces = "2026-0003", issue.replaces_date = "2026-10-01", issue.why = name;
    issue.changes = {{"x.csv", {}, 40}};
    for (std::uint64_t i = 1; i <= 40; ++i) issue.changes[0].changes.push_back({"", i, "1", "2"});
    const std::string bytes = files(c)[0];
    const auto pages = read_pdf(bytes).pages;
    ASSERT_GT(pages.size(), 2U);
    const std::size_t frame = bytes.find("/NonioSignature"), first = bytes.find("/Type /Page\n");
    ASSERT_NE(frame, std::string::npos);
    ASSERT_NE(first, std::string::npos);
    EXPECT_LT(frame, bytes.find("/Type /Page\n", first + 1)) << languages.front();
    EXPECT_TRUE(has(pages[0], "B. Verdi")) << languages.front();
    EXPECT_TRUE(has(read_pdf(bytes).all(), "1 → 2"));
  }
  Case plain = whole_case(plugins);
  decide(plain, "iso230-2", "A", 25e-6, Decision::conforms);
  EXPECT_TRUE(has(read_pdf(files(plain)[0]).pages[0], "18.8")) << "the results begin there too";
}

TEST_F(Truth, TheRegistersIdentityIsInBothWithTheSameWords) {
  Case c = whole_case(plugins);
  c.campaign.certificate.languages = {"it", "en"};
  issue.register_id = "0f0e0d0c-1111-2222-3333-444455556666";
  issue.released_by = "B. Verdi", issue.author = "C. Neri";
  std::string xml = dcc(c);
  std::erase_if(xml, [](char x) { return x == '\n'; });
  for (std::size_t at; (at = xml.find("> ")) != std::string::npos;) xml.erase(at + 1, 1);
  const std::string pages = page(c);
  EXPECT_TRUE(has(xml, "<dcc:value>" + issue.register_id +
                           "</dcc:value><dcc:name>"
                           "<dcc:content lang=\"it\">Registro"))
      << xml;
  EXPECT_TRUE(has(xml, "lang=\"en\">Register of certificates<"));
  EXPECT_TRUE(has(pages, issue.register_id));
  EXPECT_TRUE(has(pages, "Register of certificates"));
  EXPECT_TRUE(has(xml, "C. Neri")) << "who prepared it stands on the page";
  EXPECT_FALSE(has(xml, "automatic release"));
  issue.released_by.clear();
  EXPECT_TRUE(has(dcc(c), "B. Verdi (by the rules of the laboratory for automatic approval)"));
}

TEST_F(Truth, TheFactorOfACurveIsTheSameOnPaperAndInTheDcc) {
  Case c = whole_case(plugins);
  Series s{"radial", "X", Quantity::length, Quantity::deviation, {0, 1}, {0, 2e-6}, {0, 4e-7}};
  s.k = 2.23;
  c.results.analyses.front().evaluation.series = {s};
  EXPECT_TRUE(has(dcc(c), "<si:coverageFactorXMLList>2.23 2.23<"));
  EXPECT_TRUE(has(page(c), "U (k = 2.23)"));
  EXPECT_TRUE(has(page(c), "zero by the definition of the curve"));
}

/// Contributions to a centre in mm and to a direction are short, and nothing is 0.00000000.
TEST_F(Truth, BudgetsAreReadable) {
  Case c = whole_case(plugins);
  auto& e = c.results.analyses.front().evaluation;
  e.values = {{"centre_x", 0.4123013, Quantity::length, 2.5e-6},
              {"direction_i", 1.197e-4, Quantity::number, 5.3e-6}};
  e.budget->results.clear();
  const std::size_t n = e.budget->contributions.size();
  for (const auto& [name, q, u] : {std::tuple("centre_x", Quantity::length, 1.25e-6),
                                   std::tuple("direction_i", Quantity::number, 2.65e-6)}) {
    UncertaintyBudget::Result r{name, q, std::vector<double>(n, 1e-15)};
    r.u[0] = u;
    e.budget->results.push_back(std::move(r));
  }
  const std::string text = page(c);
  for (const char* what : {" 1.3 ", " 2.5 ", " 10^-6 ", " 2.7 ", " 5.3 "})
    EXPECT_TRUE(has(text, what)) << what;
  EXPECT_FALSE(has(text, "0.00000000"));
}

TEST_F(Truth, WithoutRoomForTwoThingsCalledU) {
  const std::string text = page(whole_case(plugins));
  EXPECT_TRUE(has(text, "U(VDI) max"));
  EXPECT_TRUE(has(text, "Uncertainty (k = 2)"));
  EXPECT_FALSE(has(text, " U max "));
}

TEST_F(Truth, TheSignatureHasAFrameOnThePage) {
  const std::string bytes = files(whole_case(plugins))[0];
  const std::size_t at = bytes.find("/NonioSignature");
  ASSERT_NE(at, std::string::npos);
  EXPECT_EQ(bytes.find("/NonioSignature", at + 1), std::string::npos);
  double left = 0, low = 0, right = 0, high = 0;
  ASSERT_EQ(std::sscanf(bytes.c_str() + bytes.find('[', at), "[ %lf %lf %lf %lf", &left, &low,
                        &right, &high),
            4);
  EXPECT_GT(right - left, 100);
  EXPECT_GT(high - low, 50);
  EXPECT_GE(left, 0);
  EXPECT_LE(right, 595);
  EXPECT_LE(high, 842);
}

}  // namespace
}  // namespace nonio::fixtures::certificate_truth_test
