// SPDX-License-Identifier: Apache-2.0
// The plugin as it was built, on campaigns of the exact machine.
#include "workpiece.h"

namespace nonio::diagonal_test {
namespace {

TEST(DiagonalPlugin, RecoversTheMachineAndSaysWhatItUsed) {
  std::cout << "seed " << seed << "\n";
  std::mt19937 rng(seed);
  const Rectangle rect{12.0, 9.0, 30};
  const Errors errors = random_gantry(rng, rect);
  Workpiece w(rect, errors);
  w.everything();
  w.diagonal("D3", half_diagonal(errors, rect));
  const Evaluation e = w.evaluate();
  EXPECT_EQ(e.uses, (std::vector<std::string>{"D2", "D3", "Y", "X1", "X2"}));
  EXPECT_NEAR(value(e, "C0Y"), errors.C0Y, 0.01e-6);
  EXPECT_NEAR(value(e, "slave_shift"), 8.0 * errors.C0Y, 0.05 * um);
  const Series *f = series(e, "EYX"), *g = series(e, "EXY");
  ASSERT_TRUE(f != nullptr && g != nullptr) << ids(e);
  for (std::size_t i = 0; i <= rect.n; ++i) {
    EXPECT_NEAR(f->value[i], errors.EYX(f->position[i]), 0.05 * um);
    EXPECT_NEAR(g->value[i], errors.EXY(g->position[i]), 0.05 * um);
  }
  EXPECT_EQ(series(e, "q_odd"), nullptr);
}

TEST(DiagonalPlugin, TheSlaveIsShiftedWhereverTheManifestHasIt) {
  std::mt19937 rng(seed);
  const Rectangle rect{12.0, 9.0, 30};
  const Errors errors = random_gantry(rng, rect);
  for (const bool first : {true, false}) {
    Workpiece w(rect, errors);
    w.everything();
    for (Measurement& m : w.campaign.measurements)
      if (m.id == "X1" || m.id == "X2") m.side = (m.id == "X1") == first ? "slave" : "master";
    const Evaluation e = w.evaluate();
    EXPECT_NEAR(value(e, "slave_shift"), (first ? -8.0 : 8.0) * errors.C0Y, 0.05 * um);
  }
}

TEST(DiagonalPlugin, NeverSplitsWhatTwoDiagonalsDoNotContain) {
  Workpiece w({12.0, 9.0, 30});
  w.errors.EXY = [](double y) { return 50 * um * std::sin(2.0 * std::numbers::pi * y / 9.0); };
  w.errors.EYX = [](double x) {
    return -50 * um * 12.0 / 9.0 * std::sin(2.0 * std::numbers::pi * x / 12.0);
  };
  w.everything();
  Evaluation e = w.evaluate();
  ASSERT_NE(finding(e, "not-separable"), nullptr) << ids(e);
  EXPECT_EQ(finding(e, "not-separable")->evidence.front().value, 14.0);
  EXPECT_EQ(series(e, "EYX"), nullptr);
  EXPECT_EQ(series(e, "EXY"), nullptr);
  ASSERT_NE(series(e, "EYX_even"), nullptr);
  for (const double v : series(e, "q_odd")->value) EXPECT_LT(std::fabs(v), 0.01 * um);
  w.options["EXY_odd_bound_um"] = 50.0;
  e = w.evaluate();
  ASSERT_NE(finding(e, "not-separable-band"), nullptr) << ids(e);
  const Series *low = series(e, "EYX_low"), *high = series(e, "EYX_high");
  for (std::size_t i = 0; i <= 30; ++i) {
    const double truth = w.errors.EYX(low->position[i]);
    EXPECT_LE(low->value[i], truth + 0.05 * um);
    EXPECT_GE(high->value[i], truth - 0.05 * um);
  }
}

TEST(DiagonalPlugin, ASingleColumnNeverBowsTheOtherWay) {
  Workpiece w({12.0, 9.0, 30});
  w.campaign.machine.structure = "single-column";
  w.errors.EYX = [](double x) { return 160 * um * x / 12.0 * (1.0 - x / 12.0); };
  w.errors.ECX = [](double x) { return -320 * um / 144.0 * x; };
  w.errors.C0Y = -160 * um / 12.0;
  w.errors.y_ref = 4.5;
  w.X("X", 4.5);
  w.Y();
  w.D1();
  w.D2();
  expect_refused(w, "refused-single-column");
  w.campaign.machine.structure = "gantry";
  expect_refused(w, "yaw-needed");

  w.campaign.machine.structure = "single-column";
  w.yaw();
  const Evaluation with_yaw = w.evaluate();
  ASSERT_NE(series(with_yaw, "EYX_even"), nullptr) << ids(with_yaw);
  EXPECT_NEAR(series(with_yaw, "EYX_even")->value[15], 40 * um, 0.05 * um);
  EXPECT_NEAR(series(with_yaw, "ECX")->value[30], w.errors.ECX(12.0), 1e-9);
  const auto place = std::find_if(with_yaw.notes.begin(), with_yaw.notes.end(),
                                  [](const auto& n) { return n.id == "method.squareness-place"; });
  ASSERT_NE(place, with_yaw.notes.end());
  EXPECT_NEAR(place->evidence.at(0).value, w.errors.ECX(6.0), 1e-9);
  w.campaign.measurements[0].at.clear();
  expect_refused(w, "refused-place");

  Workpiece measured({12.0, 9.0, 30}, w.errors);
  measured.campaign.machine.structure = "single-column";
  const Evaluation e = measured.everything().evaluate();
  ASSERT_NE(series(e, "EYX_even"), nullptr) << ids(e);
  EXPECT_NEAR(series(e, "EYX_even")->value[15], 40 * um, 0.05 * um);
}

TEST(DiagonalPlugin, BadInputIsRefusedByName) {
  const Rectangle rect{12.0, 9.0, 10};
  Workpiece w(rect);
  w.everything();
  const Workpiece good = w;
  EXPECT_NE(finding(good.evaluate(), "not-separable"), nullptr);

  w.D1("D1b");
  expect_refused(w, "refused-sets");
  w = Workpiece(rect);
  w.X("X1", 0.5), w.X("X2", 8.5), w.Y(), w.D1();
  expect_refused(w, "refused-missing-diagonal");
  w = good;  // unequal number of stops
  w.campaign.measurements.pop_back(), w.all.pop_back();
  w.rect.n = 12;
  w.D2();
  expect_refused(w, "refused-stops");
  w = good;  // unequal steps: mm typed instead of the next whole step
  for (double& x : w.all[3].axes[0].position)
    if (std::fabs(x - 6.0) < 1e-9) x = 6.3;
  expect_refused(w, "refused-stops");
  w = good;  // a stop that was not read
  for (auto& a : w.all[4].axes) {
    std::vector<double> kept;
    for (std::size_t i = 0; i < a.position.size(); ++i)
      if (i % 11 != 4) kept.push_back(a.position[i]);
    a.position = kept;
    a.approach.resize(kept.size());
  }
  w.all[4].deviation.resize(w.all[4].axes[0].position.size());
  expect_refused(w, "refused-stops");
  w = good;  // positioning of Y from one direction only, and D2 runs against it
  for (auto& a : w.all[2].axes) std::fill(a.approach.begin(), a.approach.end(), std::int8_t{1});
  expect_refused(w, "refused-one-direction");
  w = good;  // a stop of D1 that was read from + and another one from - only
  for (auto& a : w.all[3].axes)
    for (std::size_t i = 0; i < a.approach.size(); ++i)
      if (i % 11 == 3 || i % 11 == 5) a.approach[i] = i % 11 == 3 ? 1 : -1;
  expect_refused(w, "refused-one-direction");
  w = good;
  w.yaw(), w.yaw();
  expect_refused(w, "refused-ambiguous");
  w = good;
  w.Y("Y-again");
  expect_refused(w, "refused-ambiguous");
  w = good;
  w.campaign.measurements[0].at.clear();
  expect_refused(w, "refused-place");
  w = good;
  for (double& x : w.all[2].axes[0].position) x *= 1.001;
  expect_refused(w, "refused-pitch-points");
  w = Workpiece(rect);
  w.X("X1", 0.5), w.X("X2", 8.5), w.D1(), w.D2();
  expect_refused(w, "refused-pitch");
  w = good;
  w.campaign.measurements[0].at["Z"] = 0.4;
  for (const std::size_t i : {3UL, 4UL})
    w.campaign.measurements[i].from["Z"] = w.campaign.measurements[i].to["Z"] = 0.1;
  expect_refused(w, "refused-height");
}

TEST(DiagonalPlugin, OneDirectionGoesWithPositioningInItsDirections) {
  std::mt19937 rng(seed + 5);
  std::cout << "seed " << seed + 5 << "\n";
  const Rectangle rect{12.0, 9.0, 30};
  for (const bool autocollimator : {false, true}) {
    Workpiece w(rect, random_gantry(rng, rect));
    w.BX = [](double x) { return -4 * um - 9 * um * x / 12.0; };
    w.BY = [](double y) { return 5 * um - 7 * um * y / 9.0; };
    w.X("X1", 0.5);
    autocollimator ? w.yaw() : w.X("X2", 8.5);
    w.Y();
    w.directions = {1};
    w.D1();
    w.D2();
    w.diagonal("D3", half_diagonal(w.errors, rect));
    const Evaluation e = w.evaluate();
    ASSERT_NE(series(e, "EYX"), nullptr) << ids(e);
    EXPECT_NE(finding(e, "one-direction"), nullptr);
    EXPECT_EQ(finding(e, "reversal"), nullptr);
    EXPECT_NEAR(value(e, "C0Y"), w.errors.C0Y, 0.01e-6);
    for (std::size_t i = 0; i <= rect.n; ++i) {
      EXPECT_NEAR(series(e, "EYX")->value[i], w.errors.EYX(rect.x(i)), 0.05 * um);
      EXPECT_NEAR(series(e, "EXY")->value[i], w.errors.EXY(rect.y(i)), 0.05 * um);
    }
  }
}

/// What the finding says of lateral reversal: Y comes back on another line, which changes along Y.
TEST(DiagonalPlugin, LateralReversalIsWorthWhatIsSaid) {
  const Rectangle rect{12.0, 9.0, 30};
  Workpiece w(rect);
  w.X("X1", 0.5), w.X("X2", 8.5), w.Y();
  w.directions = {1};
  const auto b = [](double y) { return 2 * um * std::sin(std::numbers::pi * y / 9.0); };
  w.errors.EXY = [b](double y) { return b(y) / 2.0; };  // Y moves towards plus on D1,
  w.D1();
  w.errors.EXY = [b](double y) { return -b(y) / 2.0; };  // and towards minus on D2
  w.D2();
  const Evaluation e = w.evaluate();
  ASSERT_NE(finding(e, "one-direction"), nullptr) << ids(e);
  const double per_um = finding(e, "one-direction")->evidence[0].value;
  EXPECT_NEAR(series(e, "EYX_even")->value[15], b(4.5) * per_um / um, 0.02 * um);
  EXPECT_EQ(finding(e, "one-direction")->texts[1].second, "EYX");
}

TEST(DiagonalPlugin, AYawThatContradictsTwoLinesIsSaid) {
  std::mt19937 rng(seed + 6);
  std::cout << "seed " << seed + 6 << "\n";
  const Rectangle rect{12.0, 9.0, 20};
  for (const bool turned : {false, true}) {
    Workpiece w(rect, random_gantry(rng, rect));
    w.scatter = 0.3 * um;
    w.everything();
    w.yaw(0.05e-6, turned ? -1.0 : 1.0);
    const Evaluation e = w.evaluate();
    EXPECT_EQ(finding(e, "yaw-disagrees") != nullptr, turned) << ids(e);
    EXPECT_NE(series(e, "EYX_even"), nullptr);
  }
}

TEST(DiagonalPlugin, ADiagonalNamedFromTheOtherEndIsTheSame) {
  std::mt19937 rng(seed + 1);
  std::cout << "seed " << seed + 1 << "\n";
  const Rectangle rect{12.0, 9.0, 30};
  const Errors errors = random_gantry(rng, rect);
  Workpiece w(rect, errors), turned(rect, errors);
  w.everything();
  turned.X("X1", 0.5), turned.X("X2", 8.5), turned.Y(), turned.D1();
  turned.diagonal("D2", line(errors, rect, down(rect.n), count(rect.n)));
  const auto a = w.evaluate(), b = turned.evaluate();
  ASSERT_NE(series(b, "q_odd"), nullptr) << ids(b);
  EXPECT_NEAR(value(a, "C0Y"), value(b, "C0Y"), 1e-9);
  for (std::size_t i = 0; i <= rect.n; ++i)
    EXPECT_NEAR(series(a, "q_odd")->value[i], series(b, "q_odd")->value[i], 0.01 * um);
}

/// The same readings of the machine's mirror image, in which Y carries X. What is read about Z has the other sign.
Workpiece mirror_image(Workpiece w) {
  const auto other = [](std::string& axis) { axis = axis == "X" ? "Y" : axis == "Y" ? "X" : axis; };
  const auto others = [&](std::map<std::string, double>& places) {
    std::map<std::string, double> out;
    for (const auto& [axis, place] : places) {
      std::string name = axis;
      other(name);
      out[name] = place;
    }
    places = std::move(out);
  };
  for (std::size_t i = 0; i < w.all.size(); ++i) {
    Measurement& m = w.campaign.measurements[i];
    Observations& o = w.all[i];
    other(m.axis), other(m.lateral), others(m.at), others(m.from), others(m.to);
    for (auto& axis : o.axes) other(axis.axis);
    if (o.axes.size() == 2) std::swap(o.axes[0], o.axes[1]);
    for (auto& of : o.lines) std::swap(of.sense[0], of.sense[1]);
    if (o.angular)
      for (double& v : o.deviation) v = -v;
  }
  return w;
}

void expect_mirrored(const Evaluation& a, const Evaluation& b) {
  for (const char* name : {"C0Y", "C0Y_LSQ", "slave_shift", "racking", "S_n", "S_odd"})
    for (const Value& v : a.values) {
      if (v.name != name) continue;
      EXPECT_NEAR(value(b, name), v.value, 1e-6 * um + 1e-9 * std::fabs(v.value)) << name;
      for (const Value& of : b.values)
        if (of.name == name && v.U) {
          EXPECT_NEAR(of.U.value_or(0.0), *v.U, 1e-6 * *v.U) << name;
        }
    }
  const std::vector<std::array<const char*, 3>> pairs{
      {"EYX", "EXY", ""},           {"EXY", "EYX", ""},     {"EYX_even", "EXY_even", ""},
      {"EXY_even", "EYX_even", ""}, {"q_odd", "q_odd", ""}, {"ECX", "ECY", "-"}};
  for (const auto& [one, two, sign] : pairs) {
    const Series *f = series(a, one), *g = series(b, two);
    ASSERT_EQ(f == nullptr, g == nullptr) << one << ids(b);
    if (f == nullptr) continue;
    EXPECT_EQ(g->over, std::string(one) == "q_odd" ? "X" : f->over == "X" ? "Y" : "X");
    for (std::size_t i = 0; i < f->value.size(); ++i)
      EXPECT_NEAR(g->value[i], *sign == '-' ? -f->value[i] : f->value[i], 1e-6 * um) << one << i;
  }
  const auto *D1 = a.points.column("D1"), *E1 = b.points.column("D1"), *D2 = a.points.column("D2"),
             *E2 = b.points.column("D2");
  ASSERT_TRUE(D1 && E1 && D2 && E2);
  for (std::size_t i = 0; i < D1->values.size(); ++i) {
    EXPECT_NEAR(E1->values[i], D1->values[i], 1e-6 * um);
    // The second diagonal begins at small X: in the image this is its other end.
    EXPECT_NEAR(E2->values[i], D2->values.back() - D2->values[D2->values.size() - 1 - i],
                1e-6 * um);
  }
}

TEST(DiagonalPlugin, AYThatCarriesXIsTheMirrorImage) {
  std::mt19937 rng(seed + 9);
  std::cout << "seed " << seed + 9 << "\n";
  const Rectangle rect{12.0, 9.0, 30};
  for (int c = 0; c < 8; ++c) {
    Workpiece w(rect, random_gantry(rng, rect));
    w.scatter = 0.3 * um;
    w.states_all();
    w.everything();
    if (c == 5) w.yaw(0.05e-6);
    if (c % 2 == 1) w.diagonal("D3", half_diagonal(w.errors, rect));
    const bool sides = c % 4 < 2;
    Workpiece image = mirror_image(w);
    image.campaign.machine.axes[1].slave = sides ? "Y2" : "";
    w.campaign.machine.axes[0].slave = sides ? "X2" : "";
    for (Workpiece* of : {&w, &image})
      for (Measurement& m : of->campaign.measurements)
        if (sides && m.id[0] == 'X') m.side = m.id == "X1" ? "master" : "slave";
    image.campaign.machine.structure = sides ? "" : c % 4 == 2 ? "gantry" : "bridge";
    const Evaluation a = w.evaluate(), b = image.evaluate();
    ASSERT_NE(series(a, c % 2 == 1 ? "EYX" : "EYX_even"), nullptr) << ids(a);
    expect_mirrored(a, b);
  }
}

TEST(DiagonalPlugin, AYOnTwoLinesWithoutAStatementThatItCarriesXIsRefused) {
  Workpiece w({12.0, 9.0, 10});
  w.everything();
  Workpiece image = mirror_image(w);
  image.campaign.machine.structure = "";
  expect_refused(image, "refused-carrier");
  image.campaign.machine.axes[1].slave = "Y2";
  EXPECT_NE(finding(image.evaluate(), "not-separable"), nullptr);
  for (Measurement& m : image.campaign.measurements) m.at.clear();
  expect_refused(image, "refused-place");
}

TEST(DiagonalPlugin, OneDirectionOnAYThatCarriesXNamesTheRightCurve) {
  Workpiece w({12.0, 9.0, 30});
  w.X("X1", 0.5), w.X("X2", 8.5), w.Y();
  w.directions = {1};
  w.D1(), w.D2();
  const Evaluation e = mirror_image(w).evaluate();
  ASSERT_NE(finding(e, "one-direction"), nullptr) << ids(e);
  EXPECT_EQ(finding(e, "one-direction")->texts[0].second, "X");
  EXPECT_EQ(finding(e, "one-direction")->texts[1].second, "EXY");
}

TEST(DiagonalPlugin, ClosureRefusesAChangedPitch) {
  Workpiece w({12.0, 9.0, 30});
  w.scatter = 0.5 * um;
  w.everything();
  for (std::size_t i = 0; i < w.all[2].size(); ++i)  // Y grew by 2 um/m after it was measured
    w.all[2].deviation[i] -= 2e-6 * w.all[2].axes[0].position[i];
  expect_refused(w, "closure");
}

TEST(DiagonalPlugin, ReversalOfTheAxesHasToBeThatOfTheDiagonals) {
  Workpiece w({12.0, 9.0, 30});
  w.scatter = 0.5 * um;
  w.everything();
  const auto reverse = [&](std::size_t i, double B) {
    for (std::size_t k = 0; k < w.all[i].size(); ++k)
      w.all[i].deviation[k] += w.all[i].axes[0].approach[k] * B / 2.0;
  };
  reverse(0, -4 * um), reverse(1, -4 * um), reverse(2, -2 * um);
  EXPECT_NE(finding(w.evaluate(), "reversal"), nullptr);
  reverse(3, -4.4 * um), reverse(4, -4.4 * um);  // 0.8 * -4 + 0.6 * -2
  EXPECT_EQ(finding(w.evaluate(), "reversal"), nullptr) << ids(w.evaluate());
}

TEST(DiagonalPlugin, FlatDiagonalsGiveSquarenessOnly) {
  Workpiece w({12.0, 1.8, 30});
  w.errors.C0Y = 5e-6;
  w.X("X1", 0.1), w.X("X2", 1.7), w.Y(), w.D1(), w.D2();
  const auto e = w.evaluate();
  ASSERT_NE(finding(e, "flat"), nullptr) << ids(e);
  EXPECT_TRUE(e.series.empty());
  EXPECT_NEAR(value(e, "C0Y"), 5e-6, 0.01e-6);
}

TEST(DiagonalPlugin, SetsBeforeAndAfterAreApart) {
  Workpiece w({12.0, 9.0, 30});
  w.errors.C0Y = 8e-6;
  w.X("X1", 0.5), w.X("X2", 8.5), w.Y(), w.D1("D1 00"), w.D2("D2 00");
  w.errors.C0Y = 0.5e-6;
  w.D1("D1 final"), w.D2("D2 final");
  const auto before = w.evaluate("D1 00"), after = w.evaluate("D1 final");
  EXPECT_NEAR(value(before, "C0Y"), 8e-6, 0.01e-6);
  EXPECT_NEAR(value(after, "C0Y"), 0.5e-6, 0.01e-6);
  EXPECT_EQ(finding(before, "remeasured"), nullptr);
  EXPECT_NE(finding(after, "remeasured"), nullptr);
  EXPECT_FALSE(the_analysis().applies(w.campaign, w.campaign.measurements[w.index("D2 00")]));
}

TEST(DiagonalPlugin, SetsAreThoseOfTheKeyState) {
  Workpiece w({12.0, 9.0, 30});
  w.errors.C0Y = 8e-6;
  w.X("X 1", 0.5), w.X("X 2", 8.5), w.Y(), w.D1("D1"), w.D2("D2");
  w.errors.C0Y = 0.5e-6;
  w.D1("D3"), w.D2("D4");
  for (Measurement& m : w.campaign.measurements)
    m.state = m.kind != "diagonal" ? "" : m.id < "D3" ? "before" : "final";
  EXPECT_NEAR(value(w.evaluate("D1"), "C0Y"), 8e-6, 0.01e-6);
  EXPECT_NEAR(value(w.evaluate("D3"), "C0Y"), 0.5e-6, 0.01e-6);
  EXPECT_FALSE(the_analysis().applies(w.campaign, w.campaign.measurements[w.index("D4")]));
}

}  // namespace
}  // namespace nonio::diagonal_test
