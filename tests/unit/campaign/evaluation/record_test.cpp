// SPDX-License-Identifier: Apache-2.0
#include "campaign/evaluation/record.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <string>

namespace nonio::evaluation::record_test {
namespace {

namespace fs = std::filesystem;

class RecordTest : public ::testing::Test {
 protected:
  RecordTest() {
    std::string pattern = (fs::temp_directory_path() / "nonio-record-XXXXXX").string();
    folder_ = ::mkdtemp(pattern.data());
  }
  ~RecordTest() override { fs::remove_all(folder_); }

  void write(const std::string& json) const { std::ofstream(folder_ / record_name) << json; }

  fs::path folder_;
};

TEST_F(RecordTest, EveryStatusIsReadAsItWasWritten) {
  for (const auto& [status, word] : {std::pair{Status::ok, "\"status\":\"ok\""},
                                     {Status::attention, "\"status\":\"attention\""},
                                     {Status::failed, "\"status\":\"failed\""}}) {
    Record record;
    record.status = status;
    std::string json = to_json(record);
    std::string plain = json;
    std::erase_if(plain, [](char c) { return c == ' ' || c == '\n'; });
    EXPECT_NE(plain.find(word), std::string::npos) << json;
    write(json);
    const auto read = read_record(folder_);
    ASSERT_TRUE(read) << read.error().message;
    EXPECT_EQ(read->status, status);
  }
}

// What a record says decides whether a good result is kept: a word that nonio never wrote is none.
TEST_F(RecordTest, AnotherWordForTheStatusIsNoRecord) {
  Record record;
  record.status = Status::ok;
  const std::string json = to_json(record);
  for (const char* word : {"\"\"", "\"OK\"", "\"good\""}) {
    std::string other = json;
    other.replace(other.find("\"ok\""), 4, word);
    write(other);
    EXPECT_FALSE(read_record(folder_)) << other;
  }
}

}  // namespace
}  // namespace nonio::evaluation::record_test
