// SPDX-License-Identifier: Apache-2.0
#include "campaign/config/manifest.h"

#include <gtest/gtest.h>

#include <map>
#include <tuple>

#include "campaign/config/site_files.h"
#include "methods.h"

namespace nonio::manifest_test {

namespace {

const std::string whole = R"(format = 1
[campaign]
id = "a-1"
date = 2026-11-03
[machine]
structure = "gantry"
[machine.axes.Y]
kind = "linear"
travel = [0.0, 500.0]
screw_pitch_mm = 20.0
expansion_um_per_m_K = 11.5
tolerance_um = { A = 15.0, "R+" = 6 }
[machine.axes.C]
kind = "rotary"
teeth = 120
[instrument]
U_fixed_um = 0.2
calibrated = 2026-02-01
[environment]
drift_um = 0.5
[[measurement]]
id = "Y"
kind = "axis"
axis = "Y"
file = "y.csv"
[run]
analyses = ["iso230-2"]
[options.iso230-2]
edition = 2006
)";

/// The message that a manifest with `bad` in place of `good` gets, with its line in front.
std::string complaint(const std::string& good, const std::string& bad) {
  std::string text = whole;
  const std::size_t at = text.find(good);
  EXPECT_NE(at, std::string::npos) << good;
  text.replace(at, good.size(), bad);
  const auto parsed = config::parse_manifest(text, "campaign.toml", own_methods());
  if (parsed) return "accepted";
  std::string all;
  for (const Error& e : parsed.error()) all += std::to_string(e.line) + ": " + e.message + "\n";
  return all;
}

}  // namespace

TEST(Manifest, EverythingArrivesInSi) {
  const auto m = config::parse_manifest(whole, "campaign.toml", own_methods());
  ASSERT_TRUE(m);
  EXPECT_EQ(m->campaign.id, "a-1");
  EXPECT_EQ(m->campaign.date, "2026-11-03");
  ASSERT_EQ(m->campaign.machine.axes.size(), 2u);
  const Axis& y = m->campaign.machine.axes[0];  // in the order of the file, not of the alphabet
  EXPECT_EQ(y.name, "Y");
  EXPECT_DOUBLE_EQ(y.travel->second, 0.5);
  EXPECT_DOUBLE_EQ(*y.screw_pitch, 0.020);
  EXPECT_DOUBLE_EQ(*y.expansion, 11.5e-6);
  EXPECT_DOUBLE_EQ(y.tolerance.at("A"), 15e-6);
  EXPECT_DOUBLE_EQ(y.tolerance.at("R+"), 6e-6);
  EXPECT_EQ(*m->campaign.machine.axes[1].teeth, 120);
  EXPECT_DOUBLE_EQ(*m->campaign.environment.drift, 0.5e-6);
  EXPECT_EQ(m->options.at("iso230-2").at("edition").line, 29u);
}

TEST(Manifest, AMeasurementHasTheMotionOfItsKind) {
  using Motion = Measurement::Motion;
  std::vector<Method> methods = own_methods();
  methods.push_back({.info = {"gauge", "1.0.0", "Seen as a test over time"},
                     .observed_as = "thermal",
                     .motion = Motion::path});
  for (const auto& [kind, motion] : {std::pair("axis", Motion::targets),
                                     {"thermal", Motion::time},
                                     {"spindle", Motion::none},
                                     {"lengths", Motion::none},
                                     {"gauge", Motion::time}}) {
    std::string text = whole;
    const std::string stated = "kind = \"axis\"\naxis = \"Y\"\n";
    text.replace(text.find(stated), stated.size(),
                 "kind = \"" + std::string(kind) + "\"\n" +
                     (kind == std::string("axis") ? "axis = \"Y\"\n" : ""));
    const auto m = config::parse_manifest(text, "campaign.toml", methods);
    ASSERT_TRUE(m) << kind << ": " << m.error().front().message;
    EXPECT_EQ(m->campaign.measurements[0].motion, motion) << kind;
  }
}

TEST(Manifest, AMeasurementHasLimitsOfItsOwn) {
  std::string text = whole;
  const std::string kind = "kind = \"axis\"\n";
  text.replace(text.find(kind), kind.size(),
               kind + "tolerance_um = { E = 4 }\ntolerance_um_per_m = { slope = 12.5 }\n");
  const auto m = config::parse_manifest(text, "campaign.toml", own_methods());
  ASSERT_TRUE(m);
  const auto& limits = m->campaign.measurements[0].tolerances;
  ASSERT_EQ(limits.size(), 2U);
  EXPECT_EQ(limits[0].result + " " + limits[1].result, "E slope");
  EXPECT_DOUBLE_EQ(limits[0].limit, 4e-6);
  EXPECT_DOUBLE_EQ(limits[1].limit, 12.5e-6);
  EXPECT_EQ(limits[1].quantity, Quantity::deviation_per_length);
  text.replace(text.find("slope"), 5, "E");
  const auto twice = config::parse_manifest(text, "campaign.toml", own_methods());
  ASSERT_FALSE(twice);
  EXPECT_NE(twice.error()[0].message.find("expected one limit of E, found a second"),
            std::string::npos)
      << twice.error()[0].message;
}

TEST(Manifest, ComplaintsNameLineFoundAndWanted) {
  struct Row {
    const char *good, *bad, *wanted;
  };
  for (const Row& r : std::initializer_list<Row>{
           {"structure = ", "struture = ",
            "6: unknown key machine.struture (nearest: \"structure\")"},
           {"\"gantry\"", "\"portal\"", "6: machine.structure: expected one of gantry"},
           {"id = \"a-1\"", "id = \"A 1\"", "3: campaign.id: expected a-z"},
           {"id = \"a-1\"", "", "campaign.id is missing"},
           {"id = \"a-1\"", "id = 7",
            "3: campaign.id: expected a text in quotes, found a whole number"},
           {"date = 2026-11-03", "date = 3.11.2026  # day",
            "expected a date such as 2026-03-23, found 3.11.2026"},
           {"date = 2026-11-03", "date = \"3.11.2026\"",
            "4: campaign.date: expected a date without quotes"},
           {"travel = [0.0, 500.0]", "travel = [500.0, 0.0]",
            "9: machine.axes.Y.travel: expected two"},
           {"screw_pitch_mm = 20.0", "screw_pitch_mm = nan",
            "10: machine.axes.Y.screw_pitch_mm: expected a finite"},
           {"screw_pitch_mm = 20.0", "screw_pitch_mm = \"20\"", "expected a number, found a text"},
           {"teeth = 120", "teeth = 0", "15: machine.axes.C.teeth: expected a number above 0"},
           {"A = 15.0", "A = -1", "tolerance above 0"},
           {"kind = \"axis\"", "kind = \"axes\"", "(nearest: \"axis\")"},
           {"axis = \"Y\"\n", "", "measurement.axis: is missing"},
           {"format = 1", "format = 2", "1: format: expected 1, found 2"},
           {"format = 1", "", "format: is missing"},
           {"[[measurement]]", "[measurement]",
            "measurement: expected tables, each headed [[measurement]]"},
           {"[run]", "[ruin]", "26: unknown key ruin (nearest: \"run\")"},
           {"edition = 2006", "edition = ", "29: not valid TOML"},
           {"edition = 2006", "\xD2\x89 = 1", "29: not valid TOML: a letter outside"},
           {"id = \"a-1\"",
            "id = \"a-1\" # \xC3\xA8\nsite = '\xC3\xA8'\noperator = "
            "\"\"\"\xC3\xA8\n\\\"\"\"\"\nteh = 1",
            "7: unknown key campaign.teh"},
           {"id = \"a-1\"", "id = -x['\xC3\xA8']", "3: not valid TOML: a quote in the middle"},
           {"id = \"a-1\"", "id = 1.'\xC3\xA8'", "3: not valid TOML: a quote in the middle"},
           {"id = \"a-1\"", "id = -x='\xC3\xA8'", "3: not valid TOML: a quote in the middle"},
           {"id = \"a-1\"", "id = \"\"\"a\\\n \xC3\xA8\"\"\"", "3: not valid TOML: after \\"},
           {"id = \"a-1\"",
            "id = \"a-1\"\nx = [{'\xC3\xA8' = '\xC3\xA8', "
            "b.'\xC3\xA8'=['\xC3\xA8',\n-2.5,'\xC3\xA8']},"
            "'\xC3\xA8', \"\"\"a\\\n b\xC3\xA8\"\"\"]",
            "4: unknown key campaign.x"},
           {"date = 2026-11-03", "customer = \"a\\nb\"",
            "4: campaign.customer: expected one line of text, found a line break"},
           {"date = 2026-11-03", "site = \"a\\tb\"",
            "4: campaign.site: expected one line of text, found a tab"},
           {"kind = \"axis\"", "kind = \"straightness\"\nlateral = \"Y\"",
            "measurement.lateral: expected another axis than Y"},
           {"U_fixed_um = 0.2", "U_fixed_um = -0.2",
            "17: instrument.U_fixed_um: expected a number that is not negative"},
       }) {
    const std::string found = complaint(r.good, r.bad);
    EXPECT_NE(found.find(r.wanted), std::string::npos)
        << r.bad << "\ngot: " << found << "expected: " << r.wanted;
  }
}

TEST(Manifest, PositionsOfTheOtherAxes) {
  const auto parse = [](const std::string& at) {
    std::string text = whole;
    return config::parse_manifest(text.replace(text.find("file = "), 0, "at = " + at + "\n"),
                                  "campaign.toml", own_methods());
  };
  const auto m = parse("{ X = 300, Z = -50.5, C = 1 }");
  ASSERT_TRUE(m) << m.error().front().message;
  const std::map<std::string, double> expected{{"C", 0.001}, {"X", 0.3}, {"Z", -0.0505}};
  EXPECT_EQ(m->campaign.measurements.front().at, expected);
  const auto moves = parse("{ X = 300, Y = 1 }");
  ASSERT_FALSE(moves);
  EXPECT_EQ(moves.error().front().line, 25U);
  EXPECT_NE(moves.error().front().message.find("stationary axes, found Y, which moves"),
            std::string::npos);
  EXPECT_NE(complaint("file = ", "at = { X = \"far\" }\nfile = ").find("expected a number"),
            std::string::npos);
}

TEST(Manifest, AReversalIsOfOneOtherMeasurementOfTheLine) {
  const auto with = [](const std::string& second, const std::string& third) {
    const std::string begin =
        "[[measurement]]\nkind = \"straightness\"\naxis = \"Y\"\nfile = \"s.csv\"\n";
    std::string all;
    for (const std::string& rest : {std::string("id = \"S\"\nlateral = \"C\"\n"), second, third})
      if (!rest.empty()) all += begin + rest;
    return complaint("[run]\n", all + "[run]\n");
  };
  const std::string reversed = "id = \"R\"\nlateral = \"C\"\nreversal_of = \"S\"\n";
  EXPECT_EQ(with(reversed, ""), "accepted");
  for (const auto& [second, third] :
       {std::pair<std::string, std::string>{"id = \"R\"\nlateral = \"C\"\nreversal_of = \"no\"\n",
                                            ""},
        {"id = \"R\"\nlateral = \"C\"\nreversal_of = \"R\"\n", ""},
        {"id = \"R\"\nlateral = \"Z\"\nreversal_of = \"S\"\n", ""},
        {"id = \"R\"\nlateral = \"C\"\nreversal_of = \"Y\"\n", ""},
        {reversed, "id = \"T\"\nlateral = \"C\"\nreversal_of = \"S\"\n"},
        {reversed, "id = \"T\"\nlateral = \"C\"\nreversal_of = \"R\"\n"}})
    EXPECT_NE(with(second, third).find("reversal_of: expected the id of another straightness of Y"),
              std::string::npos)
        << second << third << with(second, third);
}

TEST(Manifest, ALineOnASquareIsOnceInEachOfItsPositions) {
  const auto with = [](const std::string& squares, const std::string& lines) {
    return complaint("[run]\n", squares + lines + "[run]\n");
  };
  const auto line = [](const std::string& id, const std::string& rest) {
    return "[[measurement]]\nkind = \"straightness\"\naxis = \"Y\"\nlateral = \"C\"\nfile = "
           "\"s.csv\"\nid = \"" +
           id + "\"\n" + rest;
  };
  const std::string Q = "[[square]]\nid = \"Q\"\n", on = "square = \"Q\"\n",
                    turned = "square_turned = true\n";
  EXPECT_EQ(with(Q, line("A", on) + line("B", on + turned)), "accepted");
  for (const auto& [squares, lines, words] :
       {std::tuple<std::string, std::string, std::string>{
            "", line("A", on), "square: expected the id of a [[square]], found \"Q\""},
        {Q + Q, line("A", on), "id: \"Q\" is given twice"},
        {Q, line("A", on) + line("B", on), "square: expected one line of Y towards C"},
        {Q, line("A", turned), "square_turned: expected the key square as well"},
        {Q, line("A", "") + line("B", on + "reversal_of = \"A\"\n"),
         "square: is given together with reversal_of"},
        {Q + "U_urad = 0\n", line("A", on), "U_urad: expected an uncertainty above 0"}})
    EXPECT_NE(with(squares, lines).find(words), std::string::npos) << words << with(squares, lines);
}

TEST(Manifest, KeysHaveTheirLines) {
  const auto m = config::parse_manifest(whole, "campaign.toml", own_methods());
  ASSERT_TRUE(m);
  EXPECT_EQ(m->lines.at("campaign.date"), 4U);
  EXPECT_EQ(m->lines.at("machine.axes.Y.travel"), 9U);
  EXPECT_EQ(m->lines.at("measurement.Y.file"), 25U);
  EXPECT_EQ(m->lines.at("run.analyses"), 27U);
  EXPECT_EQ(m->lines.at("options.iso230-2.edition"), 29U);
}

TEST(Manifest, AllErrorsAtOnce) {
  const auto m = config::parse_manifest("format = 1\nnonsense = 2\n[campaign]\nid = 3\n",
                                        "campaign.toml", own_methods());
  ASSERT_FALSE(m);
  EXPECT_EQ(m.error().size(), 3u);  // the key, the id, no measurement
}

TEST(Manifest, SalvagesTheIdOfABrokenFile) {
  EXPECT_EQ(config::extract_id("format = 1\n[campaign]\n  id = \"x.1\" # c\n[machine\n"), "x.1");
  EXPECT_EQ(config::extract_id("[campaign]\ndate = 1\n[other]\nid = \"x\"\n"), "");
  EXPECT_EQ(config::extract_id("[campaign]\nid = \"../x\"\n"), "");
  EXPECT_EQ(config::extract_id(""), "");
}

TEST(Manifest, SiteFile) {
  const auto site = config::parse_site(
      "[limits]\nseconds = 5\nmemory_MB = 512\n[database]\nurl = \"postgresql://u@h/d\"\n"
      "password_file = \"p\"\n",
      "site.toml");
  ASSERT_TRUE(site);
  EXPECT_EQ(site->limits.seconds, 5.0);
  ASSERT_TRUE(site->database);
  EXPECT_EQ(site->database->url, "postgresql://u@h/d");
  EXPECT_EQ(site->database->schema, "nonio");
  EXPECT_FALSE(site->numbering.server);
  EXPECT_EQ(config::secret_files(*site, "/site"),
            (std::vector<std::filesystem::path>{"/site/users.toml", "/site/p"}));
  for (const char* bad :
       {"url = \"postgresql://u:Geheim77@h/d\"", "url = \"Geheim77\"",
        "password_file = \"Geheim77\"", "url = \"postgresql://h/d\"\nschema = \"1a\"",
        "url = \"postgresql://h/d\"\nschema = \"a\\\"; DROP\""}) {
    const auto refused = config::parse_site("[database]\n" + std::string(bad) + "\n", "site.toml");
    ASSERT_FALSE(refused) << bad;
    EXPECT_EQ(refused.error()[0].message.find("Geheim77"), std::string::npos)
        << refused.error()[0].message;
  }
  EXPECT_FALSE(config::parse_site("[limits]\nsecond = 5\n", "site.toml"));
}

TEST(Manifest, TheRegisterIsInOnePlaceAndNotInTheHistory) {
  const auto parsed = [](const std::string& more) {
    return config::parse_site("[database]\nurl = \"postgresql://u@h/d\"\n" + more, "site.toml");
  };
  const auto site = parsed("password_file = \"p\"\nregister = \"numbers\"\n");
  ASSERT_TRUE(site && site->numbering.server);
  EXPECT_EQ(site->numbering.server->schema, "numbers");
  EXPECT_EQ(site->numbering.server->url, "postgresql://u@h/d");
  EXPECT_EQ(site->numbering.server->password_file, "p");
  EXPECT_EQ(site->database->schema, "nonio");
  for (const char* bad :
       {"register = \"nonio\"\n", "schema = \"a\"\nregister = \"a\"\n", "register = \"A\"\n",
        "register = \"a;b\"\n", "register = \"a\"\n[certificate]\nregister = \"r.sqlite\"\n"})
    EXPECT_FALSE(parsed(bad)) << bad;
}

TEST(Manifest, Signing) {
  const auto parse = [](const std::string& keys) {
    return config::parse_site("[run]\noutputs = [\"csv\"]\n[signing]\n" + keys, "site.toml");
  };
  const std::string key = "pkcs12 = \"k.p12\"\n", password = "password_env = \"P\"\n";
  const auto good = parse(key + password);
  ASSERT_TRUE(good);
  EXPECT_EQ(good->signing->pkcs12, "k.p12");
  EXPECT_TRUE(good->signing->time_stamp_required);
  // Settings that a certificate prints are inputs of the results; those of the key are not.
  EXPECT_NE(good->settings.find("csv"), std::string::npos);
  EXPECT_EQ(good->settings.find("k.p12"), std::string::npos);
  EXPECT_FALSE(parse(key));
  EXPECT_FALSE(parse(password));
  EXPECT_FALSE(parse(key + password + "password_file = \"f\"\n"));
  EXPECT_FALSE(parse(key + password + "pkcs11 = \"pkcs11:x\"\n"));
  EXPECT_FALSE(parse(password + "pkcs11 = \"pkcs11:x\"\n"));
  EXPECT_FALSE(parse(key + password + "time_stamp = \"http://x\"\n"));
  EXPECT_FALSE(parse(key + password + "trust = \"t\"\ntime_stamp = \"https://x\"\n"));
  EXPECT_FALSE(parse(key + password + "password = \"secret\"\n"));
}

TEST(Options, DefaultsSiteCampaignInThisOrder) {
  Info info{"p",
            "1",
            "",
            {{"n", 2.0, "mm", "", {}, 0.0, 10.0},
             {"word", std::string("a"), "", "", {"a", "b"}, {}, {}}}};
  const auto raw = [](Setting s) {
    return config::RawOptions{{"p", {{"n", config::RawOption{std::move(s), "f", 3}}}}};
  };
  EXPECT_EQ(config::settle_options(info, {}, {})->number("n"), 2.0);
  EXPECT_EQ(config::settle_options(info, raw(3.0), {})->number("n"), 3.0);
  EXPECT_EQ(config::settle_options(info, raw(3.0), raw(std::int64_t{4}))->number("n"), 4.0);
  const auto high = config::settle_options(info, {}, raw(11.0));
  ASSERT_FALSE(high);
  EXPECT_EQ(high.error()[0].message,
            "options.p.n: expected at least 0.00000 and at most 10.0000, found 11.0000");
  EXPECT_EQ(high.error()[0].line, 3u);
  const auto kind = config::settle_options(info, {}, raw(std::string("x")));
  ASSERT_FALSE(kind);
  EXPECT_EQ(kind.error()[0].message, "options.p.n: expected a number, found a text");
  const auto word = config::settle_options(
      info, {}, {{"p", {{"word", config::RawOption{std::string("c"), "f", 1}}}}});
  ASSERT_FALSE(word);
  info.options.push_back({"list", std::vector<double>{1.0}, "", ""});
  const auto list = config::settle_options(
      info, {}, {{"p", {{"list", config::RawOption{std::vector<std::string>{}, "f", 1}}}}});
  ASSERT_TRUE(list) << list.error()[0].message;  // [] has no kind of its own
  EXPECT_TRUE(list->numbers("list").empty());
  const auto unknown =
      config::settle_options(info, {}, {{"p", {{"wort", config::RawOption{1.0, "f", 1}}}}});
  ASSERT_FALSE(unknown);
  EXPECT_EQ(unknown.error()[0].message, "unknown option options.p.wort (nearest: \"word\")");
}

}  // namespace nonio::manifest_test
