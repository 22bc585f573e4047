// SPDX-License-Identifier: Apache-2.0
#include "platform/storage/files.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>

#include "platform/storage/digest.h"

namespace nonio::files_test {
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

TEST_F(Files, RealFoldersAreThoseOfTheMoment) {
  const auto same = [](const fs::path& folder) {
    std::error_code error, wanted_error;
    const fs::path wanted = fs::canonical(folder, wanted_error);
    EXPECT_EQ(storage::real_folder(folder, error), wanted) << folder;
    EXPECT_EQ(error, wanted_error) << folder;
  };
  for (const char* name : {"one/a", "one/b", "two/a"}) fs::create_directories(folder_ / name);
  fs::create_directory_symlink(folder_ / "two", folder_ / "link");
  fs::create_directory_symlink(folder_ / "two", folder_ / "one/c");
  std::ofstream(folder_ / "one/d") << "x";
  for (const char* name : {"one/a", "one/b", "one/a", "two/a", "one/b", "link/a", "one/c", "one/d",
                           "one/e", "one/..", "link/..", "one/a/", "two/../one/a", "."})
    same(folder_ / name);
  same("a");
  // The parent is moved away, or becomes a link, between two questions.
  same(folder_ / "one/a");
  fs::rename(folder_ / "one", folder_ / "three");
  same(folder_ / "one/a");
  fs::create_directory_symlink(folder_ / "three", folder_ / "one");
  same(folder_ / "one/a");
  same(folder_ / "link/a");
  fs::rename(folder_ / "two", folder_ / "four");
  fs::remove(folder_ / "link");
  fs::create_directory_symlink(folder_ / "four", folder_ / "link");
  same(folder_ / "link/a");
}

TEST_F(Files, PlainNamesAreResolvedAsOthers) {
  fs::create_directories(folder_ / "site/campaign/data");
  std::ofstream(folder_ / "site/campaign/x.csv") << "x";
  std::ofstream(folder_ / "secret.csv") << "x";
  fs::create_symlink(folder_ / "secret.csv", folder_ / "site/campaign/link.csv");
  fs::create_symlink("x.csv", folder_ / "site/campaign/own.csv");
  fs::create_directory_symlink(folder_ / "site", folder_ / "way");
  const fs::path real = fs::canonical(folder_) / "site/campaign";
  for (const char* site : {"site", "way", "site", "way"}) {
    const fs::path base = folder_ / site / "campaign";
    for (const char* name : {"x.csv", "own.csv", "missing.csv"}) {
      const auto found = storage::path_inside(base, name);
      ASSERT_TRUE(found) << name;
      EXPECT_EQ(*found, real / (std::string(name) == "own.csv" ? "x.csv" : name));
    }
    for (const char* bad : {"link.csv", "..", ".", ""})
      EXPECT_FALSE(storage::path_inside(base, bad)) << bad;
  }
}

TEST_F(Files, FilesAreReadWhole) {
  for (const std::size_t size : {0U, 1U, 2U, 4095U, 4096U, 70000U, 1500000U}) {
    std::string bytes(size, 'x');
    for (std::size_t i = 0; i < size; i += 97) bytes[i] = static_cast<char>(i);
    std::ofstream(folder_ / "file", std::ios::binary) << bytes;
    const auto read = storage::read_file(folder_ / "file");
    ASSERT_TRUE(read);
    EXPECT_EQ(*read, bytes) << size;
  }
  const auto of_system = storage::read_file("/proc/self/status");  // its size is said to be 0
  ASSERT_TRUE(of_system);
  EXPECT_NE(of_system->find("VmRSS"), std::string::npos);
  EXPECT_FALSE(storage::read_file(folder_));
  EXPECT_FALSE(storage::read_file(folder_ / "missing"));
}

TEST_F(Files, ArtifactNames) {
  for (const char* good : {"report.pdf", "siemens-840d-X-EEC.ini", "points X+.csv"})
    EXPECT_TRUE(storage::is_artifact_name(good)) << good;
  for (const char* bad : {"", "../x", "a/b", "/x", ".hidden", "results.json", "run.json", "a\nb",
                          "..", "earlier.json", "last-good", "x.nonio-tmp"})
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
  fs::create_directory(folder_ / ".two.nonio-tmp");  // blocks the second file
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

}  // namespace nonio::files_test
