// SPDX-License-Identifier: Apache-2.0
//
// What the analysis gives, and what it refuses by name.
#include <gtest/gtest.h>

#include "machine.h"
#include "words.h"

namespace nonio::chain_test {
namespace {

/// Every place in the words has its evidence.
void expect_words(const Evaluation& e) {
  for (const char* language : {"en", "de", "it"}) {
    const auto words = turntable::word_places(language);
    const auto filled = [&](const std::string& id, const auto& evidence, const auto& texts) {
      if (id.starts_with("uncertainty.")) return;
      const auto places = words.find(id);
      ASSERT_NE(places, words.end()) << id << " " << language;
      for (const std::string& place : places->second) {
        bool has = false;
        for (const Number& n : evidence) has |= n.name == place;
        for (const auto& [name, text] : texts) has |= name == place;
        EXPECT_TRUE(has) << id << " " << place << " " << language;
      }
    };
    for (const Finding& f : e.findings) filled(f.id, f.evidence, f.texts);
    for (const Remark& r : e.notes) filled(r.id, r.evidence, r.texts);
  }
}

Evaluation said(const Workshop& shop) {
  auto e = shop.evaluated();
  EXPECT_TRUE(e);
  if (e) expect_words(*e);
  return e ? *e : Evaluation{};
}

std::string ids(const Evaluation& e) {
  std::string out;
  for (const Finding& f : e.findings) out += f.id + " ";
  return out;
}

std::vector<math::ChainReading> noisy(const Machine& m, const Positions& at, Builder& noise,
                                      double sigma = 1 * um) {
  auto all = readings(m, at);
  for (auto& r : all)
    for (double& x : r.at) x += sigma * noise.normal();
  return all;
}

Workshop shop_of(const Machine& m, const Positions& at, Builder& noise) {
  Workshop shop(m);
  shop.stated(2 * um, 0.5 * um, 3.0).measured(observed(noisy(m, at, noise), m));
  return shop;
}

std::string text_of(const Finding& f, std::string_view name) {
  for (const auto& [key, text] : f.texts)
    if (key == name) return text;
  return {};
}

TEST(RotaryChainPlugin, GivesBothLinesAndHowTheyLie) {
  Builder builder(11);
  Machine m = builder.tables();
  m.tables[1].point[0] = m.tables[0].point[0] + 52 * um;
  Workshop shop = shop_of(m, grid(tilts, turns), builder);
  const Evaluation e = said(shop.with("offset_mm", 0.0));
  for (std::size_t j = 0; j < 2; ++j)
    for (std::size_t k = 0; k < 3; ++k) {
      const Value* c = value(e, std::string("centre_") + "xyz"[k] + "_" + m.joint(j).name);
      const Value* n = value(e, std::string("direction_") + "ijk"[k] + "_" + m.joint(j).name);
      ASSERT_TRUE(c && n && c->U && n->U) << ids(e);
      EXPECT_NEAR(c->value, m.centre(j)[static_cast<int>(k)], 2 * *c->U);
      EXPECT_NEAR(n->value, m.direction(j)[static_cast<int>(k)], 2 * *n->U);
      EXPECT_LT(*c->U, 10 * um);
    }
  const Value* distance = value(e, "distance");
  ASSERT_TRUE(distance && distance->U);
  EXPECT_GE(distance->value, 0.0);
  EXPECT_LT(*distance->U, 5 * um);
  EXPECT_NE(found(e, "rotary-chain.offset-differs"), nullptr) << ids(e);
  ASSERT_NE(value(e, "angle"), nullptr);
  EXPECT_NEAR(value(e, "angle")->value, 90 * deg, 1e-3);
  EXPECT_EQ(value(e, "pivot_B"), nullptr);
  EXPECT_TRUE(e.budget);
  EXPECT_EQ(e.points.columns.front().values.size(), 36U);
  const Evaluation as_stated =
      said(shop.with("offset_mm", std::round(distance->value * 1e7) * 1e-4));
  EXPECT_NE(found(as_stated, "rotary-chain.offset-as-stated"), nullptr) << ids(as_stated);
}

TEST(RotaryChainPlugin, NamesWhatIsNotIdentifiable) {
  Builder builder(12);
  const Machine m = builder.tables();
  const Evaluation e = said(shop_of(m, grid({0}, turns), builder));
  const Finding* f = found(e, "rotary-chain.not-identifiable");
  ASSERT_NE(f, nullptr) << ids(e);
  EXPECT_TRUE(f->attention);
  EXPECT_EQ(text_of(*f, "which"), "line of B");
  EXPECT_NE(text_of(*f, "names").find("distance, angle"), std::string::npos);
  EXPECT_EQ(text_of(*f, "names").find("centre_x_C"), std::string::npos);
  EXPECT_NE(value(e, "centre_x_C"), nullptr);
  EXPECT_EQ(value(e, "centre_x_B"), nullptr);
  EXPECT_EQ(value(e, "distance"), nullptr);
  // With B fixed at another angle, C at 0 is not identifiable either.
  const Evaluation away = said(shop_of(m, grid({30}, turns), builder));
  EXPECT_EQ(value(away, "direction_i_C"), nullptr);
  EXPECT_NE(found(away, "rotary-chain.not-identifiable"), nullptr) << ids(away);
  // Two places half a turn apart are a chord, about which the axis may lean.
  const Evaluation chord = said(shop_of(m, grid(tilts, {0, 180}), builder));
  EXPECT_NE(value(chord, "direction_i_B"), nullptr) << ids(chord);
  ASSERT_NE(found(chord, "rotary-chain.not-identifiable"), nullptr) << ids(chord);
  for (const char* open : {"direction_i_C", "direction_j_C", "direction_k_C", "angle", "distance"})
    EXPECT_EQ(value(chord, open), nullptr) << open;
  EXPECT_NE(value(chord, "centre_x_C"), nullptr) << "the middle of the chord";
}

TEST(RotaryChainPlugin, RefusesWithTheReason) {
  Builder builder(13);
  const Machine m = builder.tables();
  const auto refused = [&](const Workshop& shop, const char* id) {
    const Evaluation e = said(shop);
    EXPECT_NE(found(e, id), nullptr) << id << ", found " << ids(e);
    EXPECT_TRUE(e.values.empty()) << id;
    EXPECT_TRUE(found(e, id) == nullptr || found(e, id)->attention) << id;
  };
  const Workshop good = shop_of(m, grid(tilts, turns), builder);
  Workshop shop = good;
  refused(shop.with("tables", std::vector<std::string>{"B"}), "rotary-chain.axes-needed");
  refused(shop.with("tables", std::vector<std::string>{"B", "B"}), "rotary-chain.axes-needed");
  refused(shop.with("tables", std::vector<std::string>{"B", "A"}), "rotary-chain.axes-needed");
  refused(shop.with("tables", std::vector<std::string>{"C", "B"}), "rotary-chain.refused-fit");
  shop = good;
  shop.with("tables", std::vector<std::string>{"C"});
  refused(shop.with("heads", std::vector<std::string>{"B"}), "rotary-chain.does-not-fit");
  shop = good;
  shop.all[0].axes.pop_back();
  refused(shop, "rotary-chain.no-angles");
  shop = good;
  for (auto& axis : shop.all[0].axes)
    for (std::size_t i = 3; i < 6; ++i) axis.position[i] = axis.position[i - 3];
  refused(shop, "rotary.repeated-angles");
  refused(shop_of(m, grid({0, 180}, turns), builder), "rotary-chain.ambiguous");
  refused(shop_of(m, grid({0}, {0, 40}), builder), "rotary-chain.too-few");
  EXPECT_EQ(found(said(good), "rotary-chain.not-identifiable"), nullptr);
}

TEST(RotaryChainPlugin, SeveralBallsNeedOneReference) {
  Builder builder(14);
  Machine m = builder.tables();
  Workshop shop = shop_of(m, grid(tilts, turns), builder);
  m.ball += Vector(-0.15, 0.05, 0.12);
  shop.measured(observed(noisy(m, grid(tilts, turns), builder), m, "high"));
  const Evaluation apart = said(shop);
  EXPECT_NE(found(apart, "rotary-chain.reference-unknown"), nullptr);
  EXPECT_TRUE(apart.uses.empty());
  const Evaluation both = said(shop.with("same_reference", std::vector<std::string>{"BC", "high"}));
  EXPECT_EQ(both.uses, std::vector<std::string>{"high"});
  EXPECT_EQ(both.points.columns.front().values.size(), 72U);
  EXPECT_LT(*value(both, "direction_i_C")->U, *value(apart, "direction_i_C")->U);
  // Another one, without the angle of B.
  Observations alone = observed(noisy(m, grid({0}, turns), builder), m, "C");
  alone.axes.pop_back();
  const Evaluation left = said(shop.measured(alone));
  EXPECT_EQ(left.uses, std::vector<std::string>{"high"});
}

TEST(RotaryChainPlugin, AnEncoderThatErrsIsFound) {
  Builder builder(15);
  const Machine m = builder.tables();
  auto all = readings(m, grid(tilts, turns));
  for (auto& r : all) {
    auto wrong = r;
    wrong.angle[1] += 60 * urad * std::sin(2.0 * r.angle[1]);
    const Vector p = m.reading(wrong.angle);
    for (std::size_t k = 0; k < 3; ++k)
      r.at[k] = p[static_cast<int>(k)] + 1 * um * builder.normal();
  }
  Workshop shop(m);
  const Evaluation e = said(shop.stated(5 * um, 0.5 * um, 3.0).measured(observed(all, m)));
  const Finding* f = found(e, "rotary-chain.angles-not-trusted");
  ASSERT_NE(f, nullptr) << ids(e);
  EXPECT_EQ(text_of(*f, "axis"), "C");
}

TEST(RotaryChainPlugin, LinearAxesBeyondTheirBoundAreFound) {
  Builder builder(18);
  Machine m = builder.tables();
  EXPECT_EQ(found(said(shop_of(m, grid(tilts, turns), builder)), "rotary-chain.linear-axes"),
            nullptr);
  m.linear(0, 2) = 60 * urad;
  const Evaluation e = said(shop_of(m, grid(tilts, turns), builder));
  EXPECT_NE(found(e, "rotary-chain.linear-axes"), nullptr) << ids(e);
}

TEST(RotaryChainPlugin, AMisprobedCentreIsNamed) {
  Builder builder(21);
  const Machine m = builder.tables();
  int accused = 0;
  for (int i = 0; i < 50; ++i) {
    auto all = noisy(m, grid(tilts, turns), builder);
    Workshop clean(m);
    clean.stated(5 * um, 0.5 * um, 3.0).measured(observed(all, m));
    accused += found(said(clean), "rotary-chain.suspect-centre") != nullptr;
    all[7].at[static_cast<std::size_t>(i % 3)] += 20 * um;
    Workshop shop(m);
    const Evaluation e = said(shop.stated(5 * um, 0.5 * um, 3.0).measured(observed(all, m)));
    const Finding* f = found(e, "rotary-chain.suspect-centre");
    ASSERT_NE(f, nullptr) << ids(e);
    for (const Number& n : f->evidence)
      if (n.name == "away") EXPECT_NEAR(n.value, 20 * um, 6 * um);
    EXPECT_EQ(text_of(*f, "at").substr(0, 4), "B = ");
  }
  EXPECT_LE(accused, 1) << "seed 21";
}

/// A head tells the pivot length and the tool together; apart only by a stated length.
TEST(RotaryChainPlugin, APivotNeedsAStatedTool) {
  Builder builder(16);
  Machine m = builder.heads();
  const double length = 0.12;
  const Vector along = Vector(300 * urad, -200 * urad, -1.0).normalized();
  const Vector nose = m.tip - length * along;
  const Vector pivot_at = m.heads[1].point, n = m.direction(1);
  const double pivot = (nose - pivot_at - n * n.dot(nose - pivot_at)).norm();
  const auto at = grid(turns, {-90, -45, 0, 45, 90});
  Workshop shop = shop_of(m, at, builder);
  Evaluation e = said(shop);
  EXPECT_NE(found(e, "rotary-chain.tool-not-stated"), nullptr) << ids(e);
  EXPECT_EQ(value(e, "pivot_B"), nullptr);
  EXPECT_EQ(value(e, "tool_i"), nullptr);
  ASSERT_NE(value(e, "radius_B"), nullptr);
  EXPECT_NEAR(value(e, "radius_B")->value, (m.centre(1)).norm(), 10 * um);
  // One tool of stated length and unknown inclination.
  shop.campaign.measurements[0].tool_offset["Z"] = -length;
  EXPECT_EQ(value(said(shop), "pivot_B"), nullptr) << "without U of the length";
  e = said(shop.with("tool_U_um", 4.0));
  ASSERT_NE(value(e, "pivot_B"), nullptr) << ids(e);
  EXPECT_EQ(found(e, "rotary-chain.tool-not-stated"), nullptr);
  EXPECT_NEAR(value(e, "pivot_B")->value, pivot, 2 * *value(e, "pivot_B")->U);
  EXPECT_GT(*value(e, "pivot_B")->U, 4 * um);
  // A second one, 100 mm longer, shows where it points.
  m.tool = 0.1 * along;
  shop.measured(observed(noisy(m, at, builder), m, "long"), length + 0.1);
  e = said(shop.with("same_reference", std::vector<std::string>{"BC", "long"}));
  ASSERT_NE(value(e, "tool_i"), nullptr) << ids(e);
  for (std::size_t k = 0; k < 3; ++k) {
    const Value* d = value(e, std::string("tool_") + "ijk"[k]);
    EXPECT_NEAR(d->value, along[static_cast<int>(k)], 2 * *d->U);
  }
  EXPECT_NEAR(value(e, "pivot_B")->value, pivot, 2 * *value(e, "pivot_B")->U);
  EXPECT_EQ(found(e, "rotary-chain.tools-disagree"), nullptr) << ids(e);
  shop.campaign.measurements[1].tool_offset["Z"] = -length - 0.1001;
  EXPECT_NE(found(said(shop), "rotary-chain.tools-disagree"), nullptr);
}

TEST(RotaryChainPlugin, AHeadAndATableHaveAnAngleAndNoDistance) {
  Builder builder(17);
  const Machine m = builder.head_and_table();
  const Evaluation e = said(shop_of(m, grid(turns, tilts), builder));
  EXPECT_EQ(value(e, "distance"), nullptr);
  ASSERT_NE(value(e, "angle"), nullptr) << ids(e);
  for (std::size_t j = 0; j < 2; ++j)
    for (std::size_t k = 0; k < 3; ++k) {
      const Value* c = value(e, std::string("centre_") + "xyz"[k] + "_" + m.joint(j).name);
      ASSERT_TRUE(c != nullptr && c->U) << ids(e);
      EXPECT_NEAR(c->value, m.centre(j)[static_cast<int>(k)], 2 * *c->U);
    }
}

}  // namespace
}  // namespace nonio::chain_test
