// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <atomic>
#include <mutex>
#include <thread>

#include "laboratory.h"
#include "laboratory/store/query.h"

namespace nonio::test::server_test {

namespace {

using storage::Database;
using storage::Server;

std::string test_url() { return std::getenv("NONIO_TEST_DATABASE"); }

void two_campaigns(Output& out, std::uint64_t run, double scale) {
  ASSERT_TRUE(out.store({.id = "a", .scale = scale}, run, "r" + std::to_string(run)));
  ASSERT_TRUE(out.store({.id = "b", .scale = scale}, run, "r" + std::to_string(run)));
}

}  // namespace

TEST(HistoryServer, SaysWhatSqliteSaysToTheLastDigit) {
  Output out("same");
  two_campaigns(out, 1, 0.1 + 0.2);
  two_campaigns(out, 2, 1e-7 / 3.0);
  ASSERT_TRUE(store::update(out.root(), true, {}, {}, nothing));
  const std::string on_the_server = rows_of(out.root());
  const auto place = store::place_of(out.root());
  ASSERT_TRUE(store::note_place(out.root(), std::nullopt).value()) << "it lies elsewhere now";
  ASSERT_TRUE(store::update(out.root(), true, {}, {}, nothing));
  EXPECT_EQ(rows_of(out.root()), on_the_server);
  EXPECT_TRUE(fs::exists(out.root() / store::store_name));
  // Back on the server: the schema is still the site's, and the outdated file is removed.
  ASSERT_TRUE(store::note_place(out.root(), place->server).value());
  EXPECT_FALSE(store::note_place(out.root(), place->server).value());
  ASSERT_TRUE(store::update(out.root(), false, {}, {}, nothing));
  EXPECT_FALSE(fs::exists(out.root() / store::store_name));
  EXPECT_EQ(rows_of(out.root()), on_the_server);
}

TEST(HistoryServer, TwoSitesHaveASchemaEach) {
  Output one("one"), other("other");
  ASSERT_TRUE(one.store({.id = "a"}, 1, "r1"));
  ASSERT_TRUE(other.store({.id = "b", .asset = "S-2"}, 1, "r1"));
  ASSERT_TRUE(store::update(one.root(), false, {"a"}, {}, nothing));
  ASSERT_TRUE(store::update(other.root(), false, {"b"}, {}, nothing));
  EXPECT_EQ(ask(one.root(), "SELECT machine FROM machine"), "S-1;");
  EXPECT_EQ(ask(other.root(), "SELECT machine FROM machine"), "S-2;");
  // The second site with the first one's schema: nothing is written.
  const std::string before = rows_of(one.root());
  const auto place = store::place_of(other.root());
  ASSERT_TRUE(store::note_place(other.root(), store::place_of(one.root())->server));
  for (const bool behind : {false, true}) {
    const auto done = store::update(other.root(), behind, {"b"}, {}, nothing);
    ASSERT_FALSE(done);
    EXPECT_NE(done.error().message.find("holds the history of another output folder"),
              std::string::npos)
        << done.error().message;
    EXPECT_EQ(rows_of(one.root()), before);
  }
  ASSERT_TRUE(store::note_place(other.root(), place->server));
}

TEST(HistoryServer, ACopyOfTheOutputFolderDoesNotWriteIntoTheSameHistory) {
  Output out("copied");
  ASSERT_TRUE(out.store({.id = "a"}, 1, "r1"));
  ASSERT_TRUE(store::update(out.root(), false, {"a"}, {}, nothing));
  const fs::path copy = out.root().string() + "-copy";
  fs::copy(out.root(), copy, fs::copy_options::recursive);
  ASSERT_TRUE(out.store({.id = "b"}, 2, "r1"));
  ASSERT_TRUE(store::update(out.root(), false, {"b"}, {}, nothing));
  const std::string before = rows_of(out.root());
  for (const bool behind : {false, true}) {
    const auto done = store::update(copy, behind, {"a"}, {}, nothing);
    ASSERT_FALSE(done);
    EXPECT_NE(done.error().message.find("another copy of this output folder"), std::string::npos)
        << done.error().message;
    EXPECT_EQ(rows_of(out.root()), before);
  }
  // The first goes on; so does a copy that is taken over before the first has written again.
  ASSERT_TRUE(store::update(out.root(), false, {"a"}, {}, nothing));
  fs::remove_all(copy);
  fs::copy(out.root(), copy, fs::copy_options::recursive);
  ASSERT_TRUE(store::update(copy, false, {"a"}, {}, nothing));
  EXPECT_FALSE(store::update(out.root(), false, {"a"}, {}, nothing));
  fs::remove_all(copy);
}

TEST(HistoryServer, LosesTheConnectionAtAnyMomentAndIsTheOldOne) {
  Output out("gone");
  two_campaigns(out, 1, 1.0);
  ASSERT_TRUE(store::update(out.root(), false, {"a", "b"}, {}, nothing));
  two_campaigns(out, 2, 2.0);
  std::string before = rows_of(out.root());
  int lost = 0;
  bool again = false;  // first it grows, then it is made again
  for (int moment = 0; moment < 40; ++moment) {
    int calls = moment;
    const auto done = store::update(out.root(), again, {"a", "b"}, {}, [&] {
      if (calls-- != 0) return;
      ask(out.root(),
          "SELECT pg_terminate_backend(pid, 5000) FROM pg_stat_activity WHERE application_name = "
          "'nonio' AND pid <> pg_backend_pid()");
    });
    if (done) {  // it was through
      if (again) break;
      again = true;
      moment = -1;
      before = rows_of(out.root());
      continue;
    }
    ++lost;
    EXPECT_NE(done.error().message.find("connection"), std::string::npos) << done.error().message;
    EXPECT_EQ(rows_of(out.root()), before) << "moment " << moment;
  }
  EXPECT_TRUE(again);
  EXPECT_GE(lost, 6);
  EXPECT_EQ(ask(out.root(), "SELECT COUNT(*) FROM evaluation"), "4;");
}

TEST(HistoryServer, OneThatForgotRunsIsMadeAgain) {
  Output out("restored");
  two_campaigns(out, 1, 1.0);
  ASSERT_TRUE(store::update(out.root(), false, {"a", "b"}, {}, nothing));
  const std::string before = rows_of(out.root());
  // As a backup of the server would have it: one evaluation is not there yet.
  for (const char* sql : {"ALTER TABLE evaluation DISABLE TRIGGER USER",
                          "DELETE FROM evaluation WHERE evaluation = 2",
                          "ALTER TABLE evaluation ENABLE TRIGGER USER"})
    EXPECT_EQ(ask(out.root(), sql), "");
  const auto done = store::update(out.root(), false, {}, {}, nothing);
  ASSERT_TRUE(done) << done.error().message;
  EXPECT_TRUE(done->rebuilt);
  EXPECT_EQ(rows_of(out.root()), before);
}

TEST(HistoryServer, ReadersSeeOneRunWhileItIsMadeAgain) {
  Output out("readers");
  for (int i = 0; i < 20; ++i) ASSERT_TRUE(out.store({.id = "c" + std::to_string(i)}, 1, "r1"));
  ASSERT_TRUE(store::update(out.root(), true, {}, {}, nothing));
  const std::size_t all = store::query(out.root(), {})->size();
  ASSERT_EQ(all, 60U);
  std::atomic<bool> over = false;
  std::atomic<int> looks = 0;
  std::mutex mutex;
  std::string wrong;
  std::vector<std::thread> readers;
  for (int i = 0; i < 4; ++i)
    readers.emplace_back([&] {
      while (!over) {
        const auto found = store::query(out.root(), {.machine = "S-1"});
        if (found && found->size() == all) {
          ++looks;
          continue;
        }
        const std::lock_guard guard(mutex);
        wrong += (found ? std::to_string(found->size()) : found.error().message) + "; ";
        break;
      }
    });
  for (int i = 0; i < 10; ++i) {
    const auto made = store::update(out.root(), true, {}, {}, nothing);
    EXPECT_TRUE(made) << made.error().message;
  }
  over = true;
  for (std::thread& reader : readers) reader.join();
  EXPECT_EQ(wrong, "");
  EXPECT_GE(looks, 10);
}

TEST(HistoryServer, TwoThatWriteWaitForEachOther) {
  Output out("writers");
  ASSERT_TRUE(out.store({.id = "a"}, 1, "r1"));
  ASSERT_TRUE(store::update(out.root(), true, {}, {}, nothing));
  const auto server = *store::place_of(out.root())->server;
  auto one = Database::open(server);
  auto other = Database::open(server, 0.2);
  ASSERT_TRUE(one && other);
  Database::Transaction first(*one);
  Database::Transaction second(*other);
  const auto waited = other->take_error();
  ASSERT_FALSE(waited);
  EXPECT_TRUE(storage::is_locked(waited.error())) << waited.error().message;
}

TEST(HistoryServer, ATextWithZeroIsRefusedAndNotCut) {
  Output out("zero");
  auto database = Database::open(*store::place_of(out.root())->server);
  ASSERT_TRUE(database);
  EXPECT_EQ(database->first("SELECT CAST(? AS TEXT)", {std::string_view("a?'b")}), "a?'b");
  database->rows("SELECT CAST(? AS TEXT)", {std::string_view("a\0b", 3)});
  EXPECT_FALSE(database->take_error());
}

TEST(HistoryServer, APasswordFileIsItsOwnersAlone) {
  Output out("password");
  const fs::path file = out.root() / "password";
  Output::write(file, "Geheimwort-77\n");
  const Server server{test_url(), "nonio", file};
  fs::permissions(file, fs::perms(0644));
  const auto open = Database::open(server);
  ASSERT_FALSE(open);
  EXPECT_NE(open.error().message.find("mode 0644"), std::string::npos) << open.error().message;
  fs::permissions(file, fs::perms(0600));
  EXPECT_TRUE(Database::open(server));
  EXPECT_FALSE(Database::open(Server{test_url(), "nonio", out.root() / "none"}));
}

TEST(HistoryServer, NoServerIsAnErrorWithItsAddress) {
  const auto none = Database::open(Server{"postgresql://u@/d?host=/nowhere", "nonio", {}});
  ASSERT_FALSE(none);
  EXPECT_NE(none.error().message.find("/nowhere"), std::string::npos) << none.error().message;
}

TEST(HistoryServer, AddressesWithAPasswordAreRefusedAndNotRepeated) {
  for (const char* good : {"postgresql://u@h/d", "postgresql://h", "postgresql:///d?service=lab",
                           "postgresql://u@h/d?sslmode=verify-full&sslrootcert=/a.pem"})
    EXPECT_TRUE(storage::check_address(good)) << good;
  for (const char* bad :
       {"postgresql://u:Geheim77@h/d", "postgresql://u@h/d?password=Geheim77", "Geheim77",
        "postgresql://u:Geheim77%zz@h/d", "postgresql://h/d?sslpassword=Geheim77",
        "postgresql://u@h/d?pasword=Geheim77", "host=h password=Geheim77", ""}) {
    const auto found = storage::check_address(bad);
    ASSERT_FALSE(found) << bad;
    EXPECT_EQ(found.error().message.find("Geheim77"), std::string::npos) << found.error().message;
  }
}

}  // namespace nonio::test::server_test
