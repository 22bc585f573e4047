// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include "nonio/sdk/text.h"

namespace nonio {

TEST(Markup, NothingInATextEndsItsElement) {
  EXPECT_EQ(escaped_markup("a<b & c>d"), "a&lt;b &amp; c&gt;d");
  EXPECT_EQ(escaped_markup("]]><script>"), "]]&gt;&lt;script&gt;");
}

TEST(Markup, NothingInATextEndsItsAttribute) {
  EXPECT_EQ(escaped_markup("x\" onload='y", Markup::attribute), "x&quot; onload=&#39;y");
  EXPECT_EQ(escaped_markup("\"kept\" between tags"), "\"kept\" between tags");
}

TEST(Markup, ControlCharactersThatXmlDoesNotKnowAreLeftOut) {
  EXPECT_EQ(escaped_markup(std::string_view("a\0b\x01"
                                            "c\td\ne\x1F",
                                            10)),
            "abc\td\ne");
}

}  // namespace nonio
