// SPDX-License-Identifier: Apache-2.0
#include "laboratory/store/store.h"

#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>

#include "laboratory.h"
#include "laboratory/store/query.h"
#include "laboratory/store/reader.h"

namespace nonio::test::store_test {

namespace {

namespace config = config;

config::Event crash() {
  return {"2026-02-03", "S-1", "X", "crash", "tool \"T1\" hit the vice; O'Brien", "B. Sample", 3};
}

store::SiteRecords records() {
  store::SiteRecords t;
  t.logs.events = {crash()};
  t.logs.acknowledged = {{"2026-02-04", "reversal.constant", "S-1", "X", "B_mean", "2026-06-30",
                          -5.25, 0.5, "B. Sample", "nut is ordered", 2}};
  t.logs.forgotten = {{"2026-02-04", "gone", "B. Sample", "sold", 2}};
  t.aliases = {{"M 0417", "S-1", "same plate"}};
  t.due = {{"", 12}, {"S-1", 6}};
  return t;
}

/// Five runs in which everything changes that can; after each the store is updated and `after` is
/// called.
void live(Output& out, const std::function<void(std::uint64_t)>& after = {}) {
  const auto run = [&](std::uint64_t n, const std::vector<std::string>& campaigns) {
    const auto done = store::update(out.root(), false, campaigns, records(), nothing);
    ASSERT_TRUE(done) << done.error().message;
    EXPECT_EQ(done->rebuilt, n == 1) << "night " << n;
    EXPECT_TRUE(done->left_out.empty()) << done->left_out.front();
    if (after) after(n);
  };
  ASSERT_TRUE(out.store({.id = "b"}, 1, "r1"));
  ASSERT_TRUE(out.store({.id = "a", .day = "2026-01-09"}, 1, "r2"));
  ASSERT_TRUE(out.store({.id = "gone"}, 1, "r3"));
  run(1, {"b", "a", "gone"});
  // Other readings; other options; a certificate is issued; an older campaign comes in late.
  ASSERT_TRUE(out.store({.id = "b", .scale = 1.5}, 2, "r1b"));
  ASSERT_TRUE(out.store({.id = "a", .day = "2026-01-09", .b_mean = -6.0}, 2, "r2"));
  ASSERT_TRUE(out.store({.id = "late", .day = "2021-01-09", .asset = ""}, 2, "r4"));
  run(2, {"late", "b", "a"});
  // Back to the first options; evaluated again with nothing new; a failure that may pass.
  ASSERT_TRUE(out.store({.id = "a", .day = "2026-01-09", .certificate = "N-1"}, 3, "r2"));
  ASSERT_TRUE(out.store({.id = "late", .day = "2021-01-09", .asset = ""}, 3, "r4", "1.1"));
  ASSERT_TRUE(out.store({.id = "b", .status = "failed"}, 3, "r1b", "1.1", true));
  run(3, {"a", "b", "late"});
  // It passes, and another version comes to another value; a failure that stays.
  ASSERT_TRUE(out.store({.id = "b", .scale = 1.75}, 4, "r1b", "1.1"));
  ASSERT_TRUE(out.store({.id = "late", .status = "failed"}, 4, "r4x", "1.1"));
  ASSERT_TRUE(out.store({.id = "a", .day = "2026-01-09", .certificate = "N-2"}, 4, "r2z"));
  run(4, {"a", "b", "late"});
  run(5, {});
}

}  // namespace

TEST(HistoryStore, MadeAgainHasTheSameRows) {
  Output out("same");
  live(out);
  const std::string grown = rows_of(out.root());
  out.lose_store();
  const auto done = store::update(out.root(), true, {}, records(), nothing);
  ASSERT_TRUE(done) << done.error().message;
  EXPECT_EQ(done->evaluations, 10U);
  EXPECT_EQ(rows_of(out.root()), grown);
  ASSERT_TRUE(store::update(out.root(), true, {}, records(), nothing)) << "in place of itself";
  EXPECT_EQ(rows_of(out.root()), grown);
  EXPECT_EQ(grown.find("ERROR"), std::string::npos);
}

TEST(HistoryStore, KeepsWhatWasSupersededAndWhy) {
  Output out("chain");
  live(out);
  EXPECT_EQ(ask(out.root(),
                "SELECT evaluation, campaign, night, version, status, supersedes, why "
                "FROM evaluation ORDER BY evaluation"),
            "1|a|1|1.0|ok||;2|b|1|1.0|ok||;3|gone|1|1.0|ok||;"
            "4|a|2|1.0|ok|1|settings;5|b|2|1.0|ok|2|files;6|late|2|1.0|ok||;"
            "7|a|3|1.0|ok|4|settings;"
            "8|a|4|1.0|ok|7|files;9|b|4|1.1|ok|5|version;10|late|4|1.1|failed|6|files;");
  EXPECT_EQ(ask(out.root(), "SELECT number, campaign FROM certificate ORDER BY number"),
            "N-1|a;N-2|a;");
  EXPECT_EQ(ask(out.root(), "SELECT evaluation FROM latest ORDER BY evaluation"), "3;8;9;10;");
  // What the first night knew is still there, to the last digit.
  EXPECT_EQ(ask(out.root(),
                "SELECT value FROM result r JOIN evaluation e ON e.evaluation = "
                "r.evaluation WHERE campaign = 'b' AND quantity = 'scale' ORDER BY 1"),
            "1.25;1.5;1.75;");
  EXPECT_EQ(ask(out.root(), "SELECT message FROM evaluation WHERE evaluation = 10"),
            "no readings;");
}

TEST(HistoryStore, HasTheParts) {
  Output out("parts");
  live(out);
  EXPECT_EQ(ask(out.root(),
                "SELECT quantity, source, u_repeat, u_common, expanded, k, tolerance, "
                "decision, not_stated FROM result WHERE evaluation = 1 ORDER BY item"),
            "scale|followed|0.1|0.5|||||a.b, c.d;B_mean|followed|0.2||||||;"
            "A|iso230-2|0.5|0.5|1.9|2|10|conforms|;");
  EXPECT_EQ(ask(out.root(),
                "SELECT item, part, source, u FROM common_part WHERE evaluation = 1 "
                "ORDER BY item, part"),
            "0|0|instrument O L-1 C-7 2026-01-01|0.3;0|1|expansion of axis X|-0.4;"
            "2|0|instrument O L-1 C-7 2026-01-01|0.3;2|1|expansion of axis X|0.4;");
  // Doubles, least significant byte first: 0.01 is 0x3F847AE147AE147B.
  EXPECT_EQ(
      ask(out.root(),
          on_server ? "SELECT first_item, items, length(upper_triangle), "
                      "upper(encode(substr(upper_triangle, 1, 8), 'hex')) FROM covariance WHERE "
                      "evaluation = 1"
                    : "SELECT first_item, items, length(upper_triangle), "
                      "hex(substr(upper_triangle, 1, 8)) FROM covariance WHERE evaluation = 1"),
      "0|2|24|7B14AE47E17A843F;");
  EXPECT_EQ(ask(out.root(), "SELECT day, machine, axis, kind, note, line FROM event"),
            "2026-02-03|S-1|X|crash|tool \"T1\" hit the vice; O'Brien|3;");
}

TEST(HistoryStore, IsAppendOnly) {
  Output out("append");
  live(out);
  const std::string before = rows_of(out.root());
  for (const std::string table : {"machine", "campaign", "evaluation", "result", "common_part",
                                  "covariance", "finding", "certificate"}) {
    const std::string refused = ask(out.root(), ("DELETE FROM " + table).c_str());
    EXPECT_TRUE(refused.ends_with(out.store_words() + ": " + table + " is append-only")) << refused;
    const std::string columns =
        on_server ? "SELECT column_name FROM information_schema.columns WHERE table_schema = "
                    "current_schema() AND table_name = '" +
                        table + "' ORDER BY ordinal_position LIMIT 1"
                  : "SELECT name FROM pragma_table_info('" + table + "') LIMIT 1";
    const std::string first = ask(out.root(), columns.c_str());
    ASSERT_EQ(first.find(' '), std::string::npos) << first;
    const std::string column = first.substr(0, first.size() - 1);
    EXPECT_NE(ask(out.root(), ("UPDATE " + table + " SET " + column + " = " + column).c_str())
                  .find("append-only"),
              std::string::npos);
    if (on_server) {
      EXPECT_NE(ask(out.root(), ("TRUNCATE " + table + " CASCADE").c_str()).find("append-only"),
                std::string::npos);
    }
  }
  EXPECT_EQ(rows_of(out.root()), before);
}

TEST(HistoryStore, OfAnotherVersionIsMadeAgainOrRefused) {
  Output out("version");
  live(out);
  const std::string before = rows_of(out.root());
  ask(out.root(), "UPDATE store SET value = 0 WHERE name = 'schema'");
  ask(out.root(), "DROP VIEW point");
  ask(out.root(), "DROP TABLE finding");
  auto done = store::update(out.root(), false, {}, records(), nothing);
  ASSERT_TRUE(done) << done.error().message;
  EXPECT_TRUE(done->rebuilt);
  EXPECT_EQ(rows_of(out.root()), before);
  ask(out.root(), "UPDATE store SET value = 99 WHERE name = 'schema'");
  const std::string newer = rows_of(out.root());
  done = store::update(out.root(), false, {}, records(), nothing);
  ASSERT_FALSE(done);
  EXPECT_NE(done.error().message.find("is of version 99, this program writes 7"),
            std::string::npos);
  EXPECT_FALSE(store::query(out.root(), {}));
  EXPECT_EQ(rows_of(out.root()), newer);
}

TEST(HistoryStore, DamagedOrBehindIsMadeAgain) {
  Output out("damaged");
  live(out);
  const std::string before = rows_of(out.root());
  if (on_server)
    ask(out.root(), "DROP TABLE store CASCADE");
  else
    Output::write(out.root() / store::store_name, "this is no database, though it is long enough");
  auto done = store::update(out.root(), false, {}, records(), nothing);
  ASSERT_TRUE(done) << done.error().message;
  EXPECT_TRUE(done->rebuilt);
  EXPECT_EQ(rows_of(out.root()), before);
  done = store::update(out.root(), true, {}, records(), nothing);
  ASSERT_TRUE(done);
  EXPECT_TRUE(done->rebuilt);
  EXPECT_EQ(rows_of(out.root()), before);
  // A campaign that came in before others that the store has: it would get another number.
  ASSERT_TRUE(out.store({.id = "aa"}, 2, "r7"));
  done = store::update(out.root(), false, {"aa"}, records(), nothing);
  ASSERT_TRUE(done);
  EXPECT_TRUE(done->rebuilt);
  EXPECT_EQ(ask(out.root(), "SELECT evaluation FROM evaluation WHERE campaign = 'aa'"), "5;");
}

TEST(HistoryStore, TheRunThatItKnowsIsKeptWithIt) {
  Output out("known");
  EXPECT_EQ(store::known_run(out.root()).value(), std::nullopt);
  ASSERT_TRUE(store::note_known_run(out.root(), 41));
  EXPECT_EQ(store::known_run(out.root()).value(), 41U);
  ASSERT_TRUE(store::forget_known_run(out.root()));
  EXPECT_EQ(store::known_run(out.root()).value(), std::nullopt);
  ASSERT_TRUE(store::forget_known_run(out.root()));
  for (const char* damaged : {"", "x\n", "41", "41 \n", "99999999999999999999\n"}) {
    Output::write(out.root() / ".nonio" / "history", damaged);
    EXPECT_EQ(store::known_run(out.root()).value(), std::nullopt) << damaged;
  }
}

TEST(HistoryStore, KilledAtAnyMomentItIsTheOldOneOrTheNewOne) {
  Output out("killed");
  live(out);
  ASSERT_TRUE(out.store({.id = "b", .scale = 2.5}, 6, "r9"));
  ASSERT_TRUE(out.store({.id = "c", .scale = 3.5}, 6, "r10"));
  const std::string old_rows = rows_of(out.root());
  int kept = 0;
  for (int moment = 0; moment < 50; ++moment) {
    const bool again = moment % 2 == 1;  // update and rebuild
    const pid_t child = ::fork();
    ASSERT_GE(child, 0);
    if (child == 0) {
      int calls = moment / 2;
      const auto done = store::update(out.root(), again, {"b", "c"}, records(), [&] {
        if (calls-- == 0) ::raise(SIGKILL);
      });
      ::_exit(done ? 0 : 1);
    }
    int status = 0;
    ASSERT_EQ(::waitpid(child, &status, 0), child);
    if (WIFSIGNALED(status)) {
      EXPECT_EQ(rows_of(out.root()), old_rows) << "moment " << moment;
      ++kept;
    } else {
      ASSERT_EQ(WEXITSTATUS(status), 0);
      ASSERT_TRUE(store::update(out.root(), true, {}, records(), nothing));
      // Back to what it was: only the store forgets what the results say already.
      out.lose_store();
      break;
    }
  }
  EXPECT_GE(kept, 6) << "it was killed while it was at work";
  ASSERT_TRUE(store::update(out.root(), false, {"b", "c"}, records(), nothing));
  const std::string grown = rows_of(out.root());
  ASSERT_TRUE(store::update(out.root(), true, {}, records(), nothing));
  EXPECT_EQ(rows_of(out.root()), grown);
}

TEST(HistoryStore, AnErrorLeavesTheOldOne) {
  Output out("error");
  live(out);
  const std::string before = rows_of(out.root());
  ASSERT_TRUE(out.store({.id = "b", .scale = 2.5}, 6, "r9"));
  ask(out.root(),
      on_server ? "ALTER TABLE finding ADD CONSTRAINT \"disk is full\" CHECK (item < 0) NOT VALID"
                : "CREATE TRIGGER full BEFORE INSERT ON finding BEGIN SELECT RAISE(ABORT, "
                  "'database or disk is full'); END");
  const auto done = store::update(out.root(), false, {"b"}, records(), nothing);
  ASSERT_FALSE(done);
  EXPECT_NE(done.error().message.find("disk is full"), std::string::npos);
  EXPECT_EQ(rows_of(out.root()), before);
}

TEST(HistoryStore, LeavesOutWhatCannotBeReadAndSaysIt) {
  Output out("hostile");
  ASSERT_TRUE(out.store({.id = "good"}, 1, "r1"));
  for (const char* id :
       {"cut", "nan", "copy", "deep", "wrong-type", "no-covariance", "zero", "list"})
    ASSERT_TRUE(out.store({.id = id}, 1, "r1"));
  const std::string whole = Made{.id = "cut"}.json();
  const auto replaced = [&](const std::string& id, const std::string& a, const std::string& b) {
    std::string text = Made{.id = id}.json();
    const std::size_t at = text.find(a);
    ASSERT_NE(at, std::string::npos) << a;
    Output::write(out.root() / id / "results.json", text.replace(at, a.size(), b));
  };
  replaced("nan", "7.5", "NaN");
  replaced("copy", "\"id\": \"copy\"", "\"id\": \"good\"");
  replaced("deep", "7.5", std::string(100000, '['));
  replaced("zero", "reversal.constant", "reversal\\u0000constant");
  replaced("wrong-type", "7.5", "\"seven\"");
  replaced("no-covariance", "\"count\": 2", "\"count\": 18446744073709551615");
  Output::write(out.root() / "list" / "results.json", "[]");
  for (std::size_t size = 0; size + 2 < whole.size(); size += 41) {
    Output::write(out.root() / "cut" / "results.json", whole.substr(0, size));
    const auto done = store::update(out.root(), true, {}, records(), nothing);
    ASSERT_TRUE(done) << done.error().message;
    EXPECT_EQ(done->left_out.size(), 8U) << size;
    EXPECT_EQ(ask(out.root(), "SELECT campaign FROM campaign"), "good;");
  }
  const auto done = store::update(out.root(), false, {"copy"}, records(), nothing);
  ASSERT_TRUE(done);
  ASSERT_EQ(done->left_out.size(), 1U);
  EXPECT_NE(done->left_out[0].find("expected campaign copy, found \"good\""), std::string::npos)
      << done->left_out[0];
}

TEST(HistoryStore, NamesWithQuotesAndLineBreaksAreNames) {
  Output out("names");
  const std::string serial = R"(0\"417'\n); DROP TABLE result; --)";  // as JSON has it
  ASSERT_TRUE(out.store({.id = "a", .asset = "", .serial = serial}, 1, "r1"));
  ASSERT_TRUE(store::update(out.root(), false, {"a"}, {}, nothing));
  const std::string name = "M 0\"417'\n); DROP TABLE result; --";
  EXPECT_EQ(ask(out.root(), "SELECT machine FROM machine"), name + ";");
  const auto found = store::query(out.root(), {.machine = name, .quantity = "A"});
  ASSERT_TRUE(found) << found.error().message;
  ASSERT_EQ(found->size(), 1U);
  EXPECT_EQ(found->front().machine, name);
}

TEST(HistoryStore, DamagedMemoryIsSaidAndNeverTakenForNone) {
  Output out("memory");
  ASSERT_TRUE(out.store({.id = "a"}, 1, "r1"));
  ASSERT_TRUE(out.store({.id = "a", .scale = 2.0}, 2, "r1"));
  const fs::path path = out.root() / "a" / "earlier.json";
  const std::string whole = storage::read_file(path).value();
  for (const std::string& damage : {whole.substr(0, whole.size() / 2), std::string("{}"),
                                    "x" + whole, whole.substr(0, 60) + "\1" + whole.substr(61)}) {
    Output::write(path, damage);
    EXPECT_FALSE(out.store({.id = "a", .scale = 3.0}, 3, "r1"));
    EXPECT_NE(out.why().find("earlier.json is damaged"), std::string::npos) << out.why();
    const auto done = store::update(out.root(), true, {}, {}, nothing);
    ASSERT_TRUE(done);
    EXPECT_EQ(done->left_out.size(), 1U);
  }
  Output::write(path, whole);
  EXPECT_TRUE(out.store({.id = "a", .scale = 3.0}, 3, "r1"));
}

TEST(HistoryStore, AFailureThatMayPassChangesNothing) {
  Output out("passing");
  ASSERT_TRUE(out.store({.id = "a"}, 1, "r1"));
  ASSERT_TRUE(out.store({.id = "a", .scale = 2.0}, 2, "r1"));
  ASSERT_TRUE(store::update(out.root(), true, {}, {}, nothing));
  const std::string before = rows_of(out.root());
  ASSERT_TRUE(out.store({.id = "a", .status = "failed"}, 3, "r1", "1.0", true));
  ASSERT_TRUE(out.store({.id = "a", .status = "failed"}, 4, "r1", "1.0", true));
  ASSERT_TRUE(store::update(out.root(), true, {}, {}, nothing));
  EXPECT_EQ(rows_of(out.root()), before);
  ASSERT_TRUE(out.store({.id = "a", .scale = 2.0}, 5, "r1"));
  ASSERT_TRUE(store::update(out.root(), true, {}, {}, nothing));
  EXPECT_EQ(rows_of(out.root()), before);
}

TEST(HistoryStore, AFailureThatStaysIsKeptBehindOneThatMayPass) {
  Output out("stays");
  ASSERT_TRUE(out.store({.id = "a"}, 1, "r1"));
  ASSERT_TRUE(out.store({.id = "a", .status = "failed"}, 2, "r2"));
  ASSERT_TRUE(store::update(out.root(), true, {}, {}, nothing));
  const std::string before = rows_of(out.root());
  for (const std::uint64_t run : {3, 4}) {
    ASSERT_TRUE(out.store({.id = "a", .status = "failed"}, run, "r2", "1.0", true));
    const auto done = store::update(out.root(), false, {"a"}, {}, nothing);
    ASSERT_TRUE(done);
    EXPECT_FALSE(done->rebuilt);
    EXPECT_EQ(rows_of(out.root()), before);
  }
  ASSERT_TRUE(out.store({.id = "a", .scale = 2.0}, 5, "r3"));
  ASSERT_TRUE(store::update(out.root(), false, {"a"}, {}, nothing));
  EXPECT_EQ(ask(out.root(), "SELECT night, status, supersedes FROM evaluation ORDER BY evaluation"),
            "1|ok|;2|failed|1;5|ok|2;");
}

// Largest values of a path (ISO 230-4) are shown and compared with limits, never followed; of a
// cyclic error its two linear parts are followed, not the amplitude.
TEST(HistoryStore, OfCirclesLargestValuesAreShownAndLinearOnesFollowed) {
  std::string values, followed;
  for (const char* name : {"G_ccw", "G_cw", "G_b", "H", "D", "F_max", "F_min", "spike_X",
                           "cyclic_X", "cyclicCos_X", "B_X", "s"})
    values += std::string(values.empty() ? "" : ", ") + "\"" + name +
              R"(": {"value": 7.5, "unit": "um", "U": 1.0, "k": 2.0})";
  for (const auto& [axis, name] :
       {std::pair("XY", "scale_mismatch:XY"), {"X", "cyclic_circle_cos"}})
    followed += std::string(R"(, {"measurement": "C1", "axis": ")") + axis + R"(", "quantity": ")" +
                name + R"(", "unit": "um", "value": 0.5, "u": 0.1, "state": "as-found"})";
  Output out("circles");
  ASSERT_TRUE(
      out.store({.id = "a",
                 .analyses = R"(, {"plugin": "circle", "version": "1", "measurement": "C1",)"
                             R"( "values": {)" +
                             values + R"(}, "findings": []})",
                 .followed = followed},
                1, "r1"));
  ASSERT_TRUE(store::update(out.root(), false, {"a"}, {}, nothing));
  auto reader = store::StoreReader::open(out.root());
  ASSERT_TRUE(reader) << reader.error().message;
  const auto machine = reader->machine("S-1");
  ASSERT_TRUE(machine) << machine.error().message;
  std::string shown, lines;
  for (const store::StoredResult& r : machine->results)
    if (r.measurement == "C1") {
      (r.followed ? lines : shown) += r.axis + " " + r.quantity + ";";
      EXPECT_EQ(r.expanded.has_value(), !r.followed) << r.quantity;
    }
  EXPECT_EQ(lines, "XY scale_mismatch:XY;X cyclic_circle_cos;");
  EXPECT_EQ(shown, "XY G_ccw;XY G_cw;XY G_b;XY H;XY D;XY F_max;XY F_min;");
}

TEST(HistoryQuery, JoinsAliasesAndOrdersByDay) {
  Output out("query");
  live(out);
  const auto found = store::query(
      out.root(), {.machine = "M 0417", .axis = "X", .quantity = "B_mean", .source = "followed"});
  ASSERT_TRUE(found) << found.error().message;
  std::string seen;
  for (const auto& p : *found) seen += p.day + " " + p.campaign + " " + p.value + ";";
  EXPECT_EQ(seen, "2026-01-05 b -5;2026-01-05 gone -5;2026-01-09 a -5;");
  const auto all = store::query(out.root(), {.machine = "S-1",
                                             .quantity = "B_mean",
                                             .from = "2021-01-01",
                                             .to = "2021-12-31",
                                             .superseded = true});
  ASSERT_TRUE(all);
  ASSERT_EQ(all->size(), 1U) << "the alias' campaign, which failed since";
  EXPECT_EQ(all->front().superseded_by, "10");
  EXPECT_EQ(store::query(out.root(), {.machine = "S1"}).error().message,
            "there is no machine \"S1\" in the history (nearest: \"S-1\")");
  EXPECT_EQ(store::query(out.root(), {.quantity = "B_maen"}).error().message,
            "there is no quantity \"B_maen\" in the history (nearest: \"B_mean\")");
}

TEST(HistoryQuery, ACheckIsAStateOfItsOwn) {
  Output out("check");
  ASSERT_TRUE(out.store({.id = "a", .purpose = "check"}, 1, "r1"));
  ASSERT_TRUE(store::update(out.root(), false, {"a"}, {}, nothing));
  EXPECT_EQ(ask(out.root(), "SELECT DISTINCT state, purpose FROM point"), "check|check;");
}

TEST(HistoryIdentity, SpellingsAreProposedAndNeverJoined) {
  using store::NamedMachine;
  const std::vector<NamedMachine> machines{{"S-0042", {"S-0042", "", "", ""}, 9},
                                           {"s 0O42", {"s 0O42", "", "", ""}, 1},
                                           {"S-0043", {"S-0043", "M", "V", "77"}, 3},
                                           {"M 77", {"", "M", "V", "77"}, 2},
                                           {"T-Il1", {"T-Il1", "", "", ""}, 1},
                                           {"T-111", {"T-111", "", "", ""}, 1},
                                           {"", {}, 4}};
  std::string seen;
  for (const store::Spelling& s : store::spellings(machines))
    seen += s.one + "/" + s.other + ": " + s.why + ";";
  EXPECT_EQ(seen,
            "S-0042/s 0O42: spelled alike;T-111/T-Il1: spelled alike;"
            "S-0043/M 77: same maker and serial;");
  Output out("spell");
  ASSERT_TRUE(out.store({.id = "a"}, 1, "r1"));
  ASSERT_TRUE(out.store({.id = "b", .asset = "s1"}, 1, "r1"));
  ASSERT_TRUE(store::update(out.root(), false, {"a", "b"}, {}, nothing));
  const auto apart = store::machines_in(out.root());
  ASSERT_TRUE(apart);
  EXPECT_EQ(apart->size(), 2U);
  const auto found = store::spellings_in(out.root());
  ASSERT_TRUE(found);
  EXPECT_EQ(found->size(), 1U);
  store::SiteRecords alias;
  alias.aliases = {{"s1", "S-1", "same plate"}};
  ASSERT_TRUE(store::update(out.root(), false, {}, alias, nothing));
  EXPECT_EQ(store::machines_in(out.root())->size(), 1U);
  EXPECT_TRUE(store::spellings_in(out.root())->empty());
}

}  // namespace nonio::test::store_test
