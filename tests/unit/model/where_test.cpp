// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include "nonio/model/comparison.h"

namespace nonio::model::where_test {
namespace {

// The words are those of results.json and of the ids in templates/words.
TEST(Where, IsWrittenAsResultsJsonHasIt) {
  EXPECT_EQ(to_text({Factor::direction}), "direction");
  EXPECT_EQ(to_text({Factor::position}), "position");
  EXPECT_EQ(to_text({Factor::screw_phase}), "screw-phase");
  EXPECT_EQ(to_text({Factor::angle}), "angle");
  EXPECT_EQ(to_text({Factor::run}), "run");
  EXPECT_EQ(to_text({Factor::time}), "time");
  EXPECT_EQ(to_text({Factor::temperature}), "temperature");
  EXPECT_EQ(to_text({Factor::direction, Factor::screw_phase}), "direction x screw-phase");
}

TEST(Where, HasBothFactorsOfAProduct) {
  const Where product{Factor::position, Factor::time};
  EXPECT_TRUE(product.has(Factor::position));
  EXPECT_TRUE(product.has(Factor::time));
  EXPECT_FALSE(product.has(Factor::direction));
  EXPECT_FALSE(product == Where{Factor::position});
}

}  // namespace
}  // namespace nonio::model::where_test
