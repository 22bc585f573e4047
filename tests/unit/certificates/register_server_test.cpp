// SPDX-License-Identifier: Apache-2.0
// What only a server can do to a register.
#include <gtest/gtest.h>

#include <cstdlib>
#include <fstream>

#include "certificates/a_register.h"
#include "platform/storage/files.h"

namespace nonio::register_test {
namespace {

class RegisterServerTest : public RegisterTest {
 protected:
  static constexpr const char* identity = "certificates.register";

  /// Empty: it is opened.
  std::string refused(const fs::path& site) const {
    const auto opened = certificates::Register::open(site, numbering_);
    return opened ? "" : opened.error().message;
  }
  static void server(const std::string& what) {
    const std::string ctl = std::getenv("NONIO_TEST_PG_CTL");
    ASSERT_EQ(std::system((ctl + " " + what).c_str()), 0) << what;
  }
  static void expect_words(const std::string& said, const std::string& words) {
    EXPECT_NE(said.find(words), std::string::npos) << said;
  }
};

TEST_F(RegisterServerTest, TheSiteHoldsTheIdentityOfItsRegister) {
  certificates::Register r = open();
  const auto text = storage::read_small_file(site_ / identity);
  ASSERT_TRUE(text) << text.error().message;
  EXPECT_TRUE(text->starts_with(r.id() + "\nentry 1 ")) << *text;
  drawn(r, "c1", first_data);
  EXPECT_EQ(open().id(), r.id());
}

TEST_F(RegisterServerTest, AnotherSitesRegisterIsRefused) {
  certificates::Register r = open();
  drawn(r, "c1", first_data);
  const fs::path other = site_ / "other";
  fs::create_directory(other);
  expect_words(refused(other), "holds the register " + r.id() + " of another site");
  EXPECT_FALSE(fs::exists(other / identity));
  std::ofstream(other / identity) << "11111111-1111-4111-8111-111111111111\n";
  expect_words(refused(other), "the register 11111111-1111-4111-8111-111111111111 of this site");
  std::ofstream(other / identity) << r.id() << "\n";
  EXPECT_EQ(refused(other), "");
}

TEST_F(RegisterServerTest, AMissingRegisterIsNotMadeAgain) {
  drawn(*std::make_unique<certificates::Register>(open()), "c1", first_data);
  lose_schema();
  expect_words(refused(site_), "restore it from the backup");
  const auto all = certificates::Register::entries(site_, numbering_);
  ASSERT_FALSE(all);
  expect_words(all.error().message, "restore it from the backup");
}

TEST_F(RegisterServerTest, OnlyASchemaThatHoldsNothingElse) {
  const std::string schema = numbering_.server->schema;
  raw().script("CREATE SCHEMA " + schema + "; CREATE TABLE " + schema + ".t(x INT)");
  expect_words(refused(site_), "holds other tables");
  lose_schema();
  open();
  raw().script("UPDATE register_version SET version = '3'");
  expect_words(refused(site_), "newer version of Nonio");
}

TEST_F(RegisterServerTest, AServerThatMayForgetIsRefused) {
  open();
  for (const char* setting : {"fsync", "full_page_writes", "synchronous_commit"}) {
    server(std::string("-o \"-c ") + setting + "=off\" restart");
    expect_words(refused(site_), std::string(setting) + " is off on this server");
  }
  server("-o \"-c synchronous_standby_names=other -c synchronous_commit=local\" restart");
  expect_words(refused(site_), "synchronous_commit is local");
  server("stop");  // a restart keeps the options
  server("start");
  EXPECT_EQ(refused(site_), "");
  raw().script("ALTER ROLE nonio SET synchronous_commit = off");
  expect_words(refused(site_), "synchronous_commit is off");
  raw().script("ALTER ROLE nonio RESET synchronous_commit");
  EXPECT_EQ(refused(site_), "");
}

TEST_F(RegisterServerTest, AServerThatIsAwayIsWaitedForAndOneThatRefusesIsNot) {
  certificates::Register r = open();
  server("-m immediate stop");
  const auto lost = r.draw("c1", first_data, day);
  ASSERT_FALSE(lost);
  EXPECT_TRUE(storage::is_locked(lost.error())) << lost.error().message;
  const auto away = certificates::Register::open(site_, numbering_);
  ASSERT_FALSE(away);
  EXPECT_TRUE(storage::is_locked(away.error())) << away.error().message;
  server("start");
  EXPECT_EQ(drawn(*std::make_unique<certificates::Register>(open()), "c1", first_data).issue.number,
            "2026-0001");
  auto wrong = numbering_;
  wrong.server->url += "&dbname=nobody";
  const auto unknown = certificates::Register::open(site_, wrong);
  ASSERT_FALSE(unknown);
  EXPECT_FALSE(storage::is_locked(unknown.error())) << unknown.error().message;
}

/// A writer that does not end blocks the others for no longer than their patience.
TEST_F(RegisterServerTest, WhoeverFindsItLockedWaitsForItsPatience) {
  open();
  storage::Database other = raw();
  storage::Database::Transaction transaction(other);
  ASSERT_FALSE(other.failed());
  auto r = certificates::Register::open(site_, numbering_, 0.2);
  ASSERT_TRUE(r) << r.error().message;
  const auto waited = r->draw("c1", first_data, day);
  ASSERT_FALSE(waited);
  EXPECT_TRUE(storage::is_locked(waited.error())) << waited.error().message;
}

}  // namespace
}  // namespace nonio::register_test
