// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <gtest/gtest.h>
#include <unistd.h>

#include <cstdlib>
#include <filesystem>
#include <functional>
#include <stdexcept>
#include <string>
#include <vector>

#include "certificates/register.h"
#include "platform/storage/database.h"

/// A site with a register: an SQLite file, or a schema of the server of these tests.
namespace nonio::register_test {
namespace fs = std::filesystem;

#ifdef NONIO_TEST_POSTGRESQL
inline constexpr bool on_server = true;
#else
inline constexpr bool on_server = false;
#endif

inline const reading::Inputs first_data = {
    {"campaign.toml", "aa"}, {"file x.csv", "bb"}, {"site.toml", "cc"}};
inline const reading::Inputs other_readings = {
    {"campaign.toml", "aa"}, {"file x.csv", "b2"}, {"site.toml", "cc"}};
inline const std::string day = "2026-11-21";

class RegisterTest : public testing::Test {
 protected:
  RegisterTest() {
    std::string path = (fs::temp_directory_path() / "nonio-register-XXXXXX").string();
    site_ = ::mkdtemp(path.data());
    if (!on_server) return;
    const char* url = std::getenv("NONIO_TEST_DATABASE");
    if (url == nullptr) throw std::runtime_error("there is no NONIO_TEST_DATABASE");
    const std::string name = testing::UnitTest::GetInstance()->current_test_info()->name();
    numbering_.server = config::DatabaseChoice{url};
    numbering_.server->schema = "r" + std::to_string(::getpid()) + "_" +
                                std::to_string(std::hash<std::string>{}(name) % 1000000);
  }
  ~RegisterTest() override {
    if (numbering_.server) lose_schema();
    fs::remove_all(site_);
  }
  void lose_schema() const {
    raw().script("DROP SCHEMA IF EXISTS " + numbering_.server->schema + " CASCADE");
  }
  /// The database itself, past the register.
  storage::Database raw() const {
    auto opened = numbering_.server ? storage::Database::open(storage::Server{
                                          numbering_.server->url, numbering_.server->schema, {}})
                                    : storage::Database::open(site_ / numbering_.register_file,
                                                              storage::Database::Use::write);
    if (!opened) throw std::runtime_error(opened.error().message);
    return std::move(*opened);
  }

  certificates::Register open() const {
    auto opened = certificates::Register::open(site_, numbering_);
    if (!opened) throw std::runtime_error(opened.error().message);
    return std::move(*opened);
  }
  static evaluation::Certificate drawn(certificates::Register& r, const std::string& campaign,
                                       const reading::Inputs& data,
                                       const std::string& today = day) {
    auto c = r.draw(campaign, data, today);
    EXPECT_TRUE(c) << c.error().message;
    return c ? *c : evaluation::Certificate{};
  }
  static evaluation::Certificate issued(certificates::Register& r, const std::string& campaign,
                                        const reading::Inputs& data,
                                        const std::string& today = day) {
    evaluation::Certificate c = drawn(r, campaign, data, today);
    EXPECT_FALSE(c.issued);
    c.output = "certificate";
    c.templates_sha256 = "tt";
    c.issue.readings_sha256 = "rr";
    c.results = "{}";
    c.files = {
        {"certificate", "certificate.pdf", std::string("%PDF\0\xFF", 6) + c.issue.number, ""},
        {"dcc", "dcc.xml", "<?xml", "no answer"}};
    auto done = r.issue(c, campaign, data);
    EXPECT_TRUE(done) << done.error().message;
    return done ? *done : evaluation::Certificate{};
  }
  static std::vector<std::string> files_of(const Issue& issue) {
    std::vector<std::string> names;
    for (const FileChange& change : issue.changes) names.push_back(change.file);
    return names;
  }
  std::vector<certificates::RegisterEntry> entries() const {
    auto all = certificates::Register::entries(site_, numbering_);
    EXPECT_TRUE(all) << all.error().message;
    return all ? *all : std::vector<certificates::RegisterEntry>{};
  }
  certificates::RegisterEntry entry(const std::string& number) const {
    for (const certificates::RegisterEntry& e : entries())
      if (e.number == number) return e;
    ADD_FAILURE() << "no entry " << number;
    return {};
  }

  fs::path site_;
  config::Numbering numbering_;
};

}  // namespace nonio::register_test
