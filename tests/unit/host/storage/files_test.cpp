// SPDX-License-Identifier: Apache-2.0
#include "host/storage/files.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>

#include "host/storage/digest.h"

namespace nonio::host::files_test {
namespace fs = std::filesystem;

class Files : public testing::Test {
 protected:
  void SetUp() override {
    std::string name = (fs::temp_directory_path() / "nonio-files-XXXXXX").string();
    ASSERT_NE(::mkdtemp(name.data()), nullptr);
    folder_ = name;
  }
  void TearDown() override { fs::remove_all(folder_); }
  fs::path folder_;
};

TEST_F(Files, PathsNeverLeaveTheFolder) {
  fs::create_directories(folder_ / "campaign/data");
  std::ofstream(folder_ / "campaign/data/x.csv") << "x";
  std::ofstream(folder_ / "secret.csv") << "x";
  fs::create_symlink(folder_ / "secret.csv", folder_ / "campaign/link.csv");
  const fs::path base = folder_ / "campaign";
  EXPECT_TRUE(storage::path_inside(base, "data/x.csv"));
  EXPECT_TRUE(storage::path_inside(base, "data/../data/x.csv"));
  for (const char* bad :
       {"../secret.csv", "/etc/passwd", "link.csv", "", ".", "data/../../secret.csv"})
    EXPECT_FALSE(storage::path_inside(base, bad)) << bad;
}

TEST_F(Files, ArtifactNames) {
  for (const char* good : {"report.pdf", "siemens-840d-X-EEC.ini", "points X+.csv"})
    EXPECT_TRUE(storage::is_artifact_name(good)) << good;
  for (const char* bad :
       {"", "../x", "a/b", "/x", ".hidden", "results.json", "run.json", "a\nb", ".."})
    EXPECT_FALSE(storage::is_artifact_name(bad)) << bad;
}

TEST_F(Files, PublishWritesWholeFilesAndNothingElse) {
  ASSERT_TRUE(storage::publish(folder_ / "a/b", {{"one", "1"}, {"two", std::string(100000, 'x')}}));
  EXPECT_EQ(*storage::read_file(folder_ / "a/b/one"), "1");
  EXPECT_EQ(storage::read_file(folder_ / "a/b/two")->size(), 100000u);
  EXPECT_EQ(std::distance(fs::directory_iterator(folder_ / "a/b"), {}), 2);
}

TEST_F(Files, PublishRenamesNothingWhenOneCannotBeWritten) {
  ASSERT_TRUE(storage::publish(folder_, {{"one", "old"}}));
  fs::create_directory(folder_ / ".two.nonio-tmp");  // stands in the way of the second file
  EXPECT_FALSE(storage::publish(folder_, {{"one", "new"}, {"two", "2"}}));
  EXPECT_EQ(*storage::read_file(folder_ / "one"), "old");
  EXPECT_FALSE(fs::exists(folder_ / ".one.nonio-tmp"));
}

TEST(Digest, PublishedVectors) {  // FIPS 180-4 examples
  EXPECT_EQ(storage::sha256(""),
            "e3b0c44298fc1c149afbf4c8996fb92427ae41e4649b934ca495991b7852b855");
  EXPECT_EQ(storage::sha256("abc"),
            "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad");
}

}  // namespace nonio::host::files_test
