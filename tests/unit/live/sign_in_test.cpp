// SPDX-License-Identifier: Apache-2.0
#include "live/sign_in.h"

#include <gtest/gtest.h>

#include <chrono>
#include <string>
#include <vector>

namespace sign_in_test {

using namespace nonio;
using live::SignIn;

namespace {

const std::vector<certificates::User> users{
    {"rossi", "A. Rossi", certificates::Role::measure, "hash of rossi"},
    {"sample", "B. Sample", certificates::Role::approve, "hash of sample"}};

live::Head with_cookie(const std::string& line) {
  return {"GET", "/", {{"Cookie", line.substr(0, line.find(';'))}}};
}

}  // namespace

TEST(SignIn, ASessionEndsAfterItsTime) {
  SignIn::Clock::time_point now{};
  SignIn sign_in([&] { return now; });
  const auto cookie = sign_in.begin(users[0], false);
  ASSERT_TRUE(cookie);
  const live::Head head = with_cookie(*cookie);
  now += SignIn::lasting;
  EXPECT_EQ("rossi", sign_in.user_of(head, users)->account) << "use does not prolong it";
  now += std::chrono::seconds(1);
  EXPECT_FALSE(sign_in.user_of(head, users));
  now -= SignIn::lasting;
  EXPECT_FALSE(sign_in.user_of(head, users)) << "it does not come back";
}

TEST(SignIn, ManySessionsOfOneAccountEndNoOther) {
  SignIn::Clock::time_point now{};
  SignIn sign_in([&] { return now += std::chrono::milliseconds(1); });
  const auto other = sign_in.begin(users[1], false);
  std::vector<std::string> own;
  for (int i = 0; i < 1000; ++i) own.push_back(*sign_in.begin(users[0], false));
  EXPECT_TRUE(sign_in.user_of(with_cookie(*other), users));
  std::size_t open = 0;
  for (const std::string& one : own) open += sign_in.user_of(with_cookie(one), users) ? 1 : 0;
  EXPECT_EQ(SignIn::most_of_account, open);
  EXPECT_TRUE(sign_in.user_of(with_cookie(own.back()), users)) << "the newest remain";
  EXPECT_FALSE(sign_in.user_of(with_cookie(own.front()), users));
}

}  // namespace sign_in_test
