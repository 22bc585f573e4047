// SPDX-License-Identifier: Apache-2.0
#include "live/difference.h"

#include <gtest/gtest.h>

namespace difference_test {

using nonio::live::unified_difference;

TEST(LiveDifference, IsThatOfDiff) {
  EXPECT_EQ(unified_difference("f", "a\n", "a\n"), "");
  EXPECT_EQ(unified_difference("f", "1\n2\n3\n4\n5\n6\n7\n8\n9\n", "1\n2\n3\n4\nx\n6\n7\n8\n9\n"),
            "--- f\n+++ f\n@@ -2,7 +2,7 @@\n 2\n 3\n 4\n-5\n+x\n 6\n 7\n 8\n");
  EXPECT_EQ(unified_difference("f", "1\n2\n", "1\n2\n3\n"),
            "--- f\n+++ f\n@@ -1,2 +1,3 @@\n 1\n 2\n+3\n");
  EXPECT_EQ(unified_difference("f", "", "1\n"), "--- f\n+++ f\n@@ -0,0 +1,1 @@\n+1\n");
  EXPECT_EQ(unified_difference("f", "1", "2\n"),
            "--- f\n+++ f\n@@ -1,1 +1,1 @@\n-1\n\\ No newline at end of file\n+2\n");
}

}  // namespace difference_test
