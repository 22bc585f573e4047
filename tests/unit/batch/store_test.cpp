// SPDX-License-Identifier: Apache-2.0
#include "batch/commit/store.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <string>

#include "campaign/evaluation/record.h"
#include "platform/storage/digest.h"
#include "platform/storage/disk.h"
#include "platform/storage/files.h"

namespace nonio::batch::store_test {
namespace {

namespace fs = std::filesystem;

/// Results of run 7 of campaign "c", under temporary names in a folder of the test.
struct Store : testing::Test {
  void SetUp() override {
    fs::create_directories(folder);
    record.folder = "c";
    record.run = 7;
    record.status = evaluation::Status::ok;
    std::vector<Artifact> files;
    for (const char* name : {"report.pdf", "values.csv"}) {
      files.push_back({name, std::string("bytes of ") + name});
      record.files.push_back(
          {name, files.back().bytes.size(), storage::sha256(files.back().bytes)});
    }
    files.push_back({evaluation::record_name, evaluation::to_json(record)});
    ASSERT_TRUE(storage::write_temporaries(folder, files));
  }
  void TearDown() override { fs::remove_all(out); }

  std::string message() {
    const auto done = commit(out, {{"c", 0}}, record.run, disk).front();
    return done ? "" : done.error().message;
  }

  fs::path out =
      fs::temp_directory_path() /
      ("nonio-store-" + std::to_string(::testing::UnitTest::GetInstance()->random_seed()) + "-" +
       std::to_string(::getpid()));
  fs::path folder = out / "c";
  evaluation::Record record;
  storage::Disk disk{fs::temp_directory_path()};
};

TEST_F(Store, GivesFilesTheirNames) {
  EXPECT_EQ(message(), "");
  EXPECT_TRUE(fs::exists(folder / "report.pdf"));
  EXPECT_TRUE(fs::exists(folder / evaluation::record_name));
}

TEST_F(Store, GoesOnWhereItWasCutShort) {
  fs::rename(storage::temporary_path(folder, "report.pdf"), folder / "report.pdf");
  EXPECT_EQ(message(), "");
  EXPECT_TRUE(fs::exists(folder / "values.csv"));
  EXPECT_TRUE(fs::exists(folder / evaluation::record_name));
}

TEST_F(Store, AFileThatIsLostOrOtherIsNamed) {
  fs::remove(storage::temporary_path(folder, "report.pdf"));
  EXPECT_NE(message().find("report.pdf"), std::string::npos);
}

TEST_F(Store, AnOlderFileDoesNotReplaceALostOne) {
  fs::remove(storage::temporary_path(folder, "report.pdf"));
  ASSERT_TRUE(storage::write_temporaries(folder, {{"other", "older bytes"}}));
  fs::rename(storage::temporary_path(folder, "other"), folder / "report.pdf");
  EXPECT_NE(message().find("report.pdf"), std::string::npos);
}

}  // namespace
}  // namespace nonio::batch::store_test
