// SPDX-License-Identifier: Apache-2.0
// What only a register in a file has: its place in the site, and the second file that SQLite writes.
#include <gtest/gtest.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include "certificates/a_register.h"

namespace nonio::register_test {
namespace {

TEST_F(RegisterTest, OnlyAFileInsideTheSiteThatIsARegister) {
  for (const char* path : {"/tmp/x.sqlite", "../x.sqlite", "a/../../x.sqlite", ""}) {
    numbering_.register_file = path;
    EXPECT_FALSE(certificates::Register::open(site_, numbering_)) << path;
  }
  numbering_.register_file = "folder/numbers.sqlite";
  certificates::Register r = open();
  drawn(r, "c1", first_data);
  EXPECT_TRUE(fs::exists(site_ / "folder/numbers.sqlite"));
  auto foreign = storage::Database::open(site_ / "foreign.sqlite", storage::Database::Use::create);
  foreign->script("CREATE TABLE t(x)");
  numbering_.register_file = "foreign.sqlite";
  EXPECT_FALSE(certificates::Register::open(site_, numbering_));
  auto newer =
      storage::Database::open(site_ / "folder/numbers.sqlite", storage::Database::Use::write);
  newer->script("PRAGMA user_version = 3");
  numbering_.register_file = "folder/numbers.sqlite";
  EXPECT_FALSE(certificates::Register::open(site_, numbering_));
}

TEST_F(RegisterTest, ATransactionThatWasCutShortDidNotHappen) {
  {
    certificates::Register r = open();
    issued(r, "c1", first_data);
  }
  const pid_t child = ::fork();
  if (child == 0) {
    auto file =
        storage::Database::open(site_ / numbering_.register_file, storage::Database::Use::write);
    file->rows("PRAGMA cache_size = 1");  // so that it is written before the end
    storage::Database::Transaction transaction(*file);
    for (int i = 0; i < 200; ++i)
      file->rows(
          "INSERT INTO certificates(number, campaign, state, date, reason) VALUES(?, ?, "
          "'drawn', ?, ?)",
          {std::to_string(i), std::to_string(i), day, std::string(4000, 'x')});
    file->rows("UPDATE certificates SET campaign = 'nobody'");
    ::kill(::getpid(), SIGKILL);
  }
  ::waitpid(child, nullptr, 0);
  EXPECT_TRUE(fs::exists(site_ / (numbering_.register_file + "-journal")));
  EXPECT_EQ(entries().size(), 1U);
  EXPECT_EQ(entry("2026-0001").campaign, "c1");
  certificates::Register r = open();
  EXPECT_TRUE(drawn(r, "c1", first_data).issued);
}

}  // namespace
}  // namespace nonio::register_test
