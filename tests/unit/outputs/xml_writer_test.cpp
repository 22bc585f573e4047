// SPDX-License-Identifier: Apache-2.0
#include "xml_writer.h"

#include <gtest/gtest.h>

namespace nonio::dcc {

TEST(XmlWriter, AttributesAreEscapedAndEmptyOnesLeftOut) {
  XmlWriter xml;
  xml.open("a", {{"x", "1 < \"2\" & 3"}, {"none", ""}});
  xml.element("b", "text", {{"lang", "de"}});
  xml.element("c", "", {{"lang", ""}});
  xml.close();
  EXPECT_EQ(xml.take(),
            "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n"
            "<a x=\"1 &lt; &quot;2&quot; &amp; 3\">\n <b lang=\"de\">text</b>\n <c></c>\n</a>\n");
}

}  // namespace nonio::dcc
