// SPDX-License-Identifier: Apache-2.0
#include "certificates/users.h"

#include <gtest/gtest.h>

#include <string>

namespace nonio::certificates {
namespace {

std::string user(const std::string& account, const std::string& name, const std::string& more) {
  return "[[user]]\naccount = \"" + account + "\"\nname = \"" + name + "\"\n" + more;
}

TEST(Users, AreReadWithTheirRoles) {
  const auto users = parse_users("format = 1\n" + user("a", "A. Bianchi", "role = \"view\"\n") +
                                 user("b", "B. Sample", "role = \"approve\"\n"));
  ASSERT_TRUE(users);
  ASSERT_EQ(2U, users->size());
  EXPECT_EQ(Role::approve, user_with(*users, "b")->role);
  EXPECT_FALSE(user_with(*users, "c"));
}

TEST(Users, NoTwoLookLikeOnePerson) {
  for (const char* other : {"B. Sample", "b.  sample", "\u0412. Sample"})  // a Cyrillic letter
    EXPECT_FALSE(parse_users("format = 1\n" + user("a", "B. Sample", "role = \"view\"\n") +
                             user("b", other, "role = \"view\"\n")))
        << other;
  EXPECT_FALSE(parse_users("format = 1\n" + user("a", "A", "role = \"view\"\n") +
                           user("a", "B", "role = \"view\"\n")));
}

TEST(Passwords, FitTheirOwnHashOnly) {
  const auto hash = password_hash("a password of a person");
  ASSERT_TRUE(hash);
  EXPECT_TRUE(is_password_hash(*hash)) << *hash;
  EXPECT_TRUE(fits_password("a password of a person", *hash));
  for (const char* wrong : {"a password of a persom", "a password of a person ", ""})
    EXPECT_FALSE(fits_password(wrong, *hash)) << wrong;
  EXPECT_FALSE(fits_password("", ""));
  EXPECT_FALSE(fits_password(std::string(longest_password + 1, 'x'), *hash));
}

/// Source: test.c of the reference implementation (phc-winner-argon2, version 0x13).
TEST(Passwords, AHashOfAnotherProgramIsReadAndOthersAreRefused) {
  const std::string known =
      "$argon2id$v=19$m=65536,t=2,p=1$c29tZXNhbHQ$CTFhFdXPJO1aFaMaO6Mm5c8y7cJHAph8ArZWb2GRPPc";
  EXPECT_TRUE(is_password_hash(known));
  EXPECT_TRUE(fits_password("password", known));
  EXPECT_FALSE(fits_password("differentpassword", known));
  for (const char* wrong :
       {"", "$argon2id$",
        "$argon2i$v=19$m=65536,t=3,p=1$c29tZXNhbHRzb21lc2FsdA$AAAAAAAAAAAAAAAAAAAAAAAA",
        "$argon2id$v=16$m=65536,t=3,p=1$c29tZXNhbHRzb21lc2FsdA$AAAAAAAAAAAAAAAAAAAAAAAA",
        "$argon2id$v=19$m=2000000,t=3,p=1$c29tZXNhbHRzb21lc2FsdA$AAAAAAAAAAAAAAAAAAAAAAAA",
        "$argon2id$v=19$m=65536,t=0,p=1$c29tZXNhbHRzb21lc2FsdA$AAAAAAAAAAAAAAAAAAAAAAAA",
        "$argon2id$v=19$m=65536,t=3,p=1$c29tZXNhbHRzb21lc2FsdA",
        "$argon2id$v=19$m=65536,t=3,p=1$c29tZXNhbHRzb21lc2FsdA$AAAA",
        "$argon2id$v=19$m=65536,t=3,p=1$c29tZXNhbHRzb21lc2FsdA$AAAAAAAAAAAAAAAAAAAAAA!A"})
    EXPECT_FALSE(is_password_hash(wrong)) << wrong;
}

}  // namespace
}  // namespace nonio::certificates
