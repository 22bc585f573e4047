// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <fstream>
#include <iterator>
#include <string>

namespace nonio::secrets_test {
namespace {

std::string loaded_library(const std::string& name) {
  std::ifstream maps("/proc/self/maps");
  for (std::string line; std::getline(maps, line);)
    if (const std::size_t at = line.find('/');
        at != std::string::npos && line.find(name, at) != std::string::npos)
      return line.substr(at);
  return {};
}

// A password is wiped by a call that no compiler leaves out: a plain fill of a string that is not
// read again is a dead store, which -O2 removes. The library imports the call.
TEST(Secrets, ThePasswordIsWipedByWhatIsNotLeftOut) {
  const std::string path = loaded_library("libnonio_engine.so");
  ASSERT_FALSE(path.empty());
  std::ifstream file(path, std::ios::binary);
  const std::string bytes((std::istreambuf_iterator<char>(file)), std::istreambuf_iterator<char>());
  EXPECT_NE(bytes.find(std::string("explicit_bzero") + '\0'), std::string::npos) << path;
}

}  // namespace
}  // namespace nonio::secrets_test
