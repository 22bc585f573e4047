// SPDX-License-Identifier: Apache-2.0
//
// The plugin compared with exact transforms: an indicator in the spindle reads the planes of a
// misaligned square. The true value is the angle between straight lines through the exact points of
// the tool.
#include "nonio/math/square.h"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>
#include <iostream>
#include <numbers>
#include <random>

#include "loaded_analysis.h"
#include "machine.h"
#include "nonio/sdk/plugin.h"

namespace nonio::fixtures::square_test {
namespace {

using machine::Errors;
using machine::Vector;

constexpr unsigned seed = 20261124;
constexpr double um = 1e-6, urad = 1e-6;
constexpr double travel = 0.6;
constexpr std::size_t stops = 7;

const Analysis& the_analysis() {
  static const Analysis analysis = loaded_analysis(NONIO_ANALYSES, "square");
  return analysis;
}

int number(char axis) { return axis - 'X'; }
Vector unit(char axis) { return Vector::Unit(number(axis)); }

/// Commanded places along an axis.
std::vector<Vector> way(char axis) {
  std::vector<Vector> out;
  for (std::size_t i = 0; i < stops; ++i)
    out.push_back(Vector(0.1, 0.15, 0.12) +
                  unit(axis) * travel * static_cast<double>(i) / static_cast<double>(stops - 1));
  return out;
}

/// A square with an angle of 90 degrees + g between its faces in the quadrant of +first, +second;
/// turned over about the first face; then set up askew by a small turn.
struct Block {
  char first, second;
  double g = 0.0;
  bool turned = false;
  Vector askew = Vector::Zero();
  double bent = 0.0;  ///< m, size of a form of both faces

  /// Along a face, and the normal of its plane.
  std::pair<Vector, Vector> face(bool of_first) const {
    const Vector a = unit(first), b = unit(second);
    const Vector out = a.cross(b);
    Vector along = of_first ? a : Vector(-std::sin(g) * a + std::cos(g) * b);
    Vector normal = out.cross(along);
    Eigen::Matrix3d R = Eigen::Matrix3d::Identity();
    if (turned) R = Eigen::AngleAxisd(std::numbers::pi, a).toRotationMatrix();
    if (askew.norm() > 0.0)
      R = Eigen::AngleAxisd(askew.norm(), askew.normalized()).toRotationMatrix() * R;
    return {R * along, R * normal};
  }
  /// How far the tool is beyond the face along the lateral axis, less that at the first stop.
  std::vector<double> read(const Errors& errors, char axis, char lateral) const {
    const Vector n = face(axis == first).second;
    const std::vector<Vector> places = way(axis);
    const Vector origin = machine::point(errors, places.front());
    std::vector<double> out;
    for (const Vector& p : places)
      out.push_back((machine::point(errors, p) - origin).dot(n) / n.dot(unit(lateral)));
    for (std::size_t i = 0; i < stops && bent != 0.0; ++i)
      out[i] -= form(axis == first, i) - form(axis == first, 0);
    return out;
  }
  /// Turned about the first face: that face to the other side, the second one end for end.
  double form(bool of_first, std::size_t i) const {
    const double t = static_cast<double>(i) / static_cast<double>(stops - 1);
    if (of_first) return (turned ? -bent : bent) * t * t;
    return 2.0 * bent * std::pow(turned ? 1.0 - t : t, 3);
  }
};

/// Direction of the straight line through the exact points.
Vector line_of(const Errors& errors, char axis) {
  Eigen::Matrix<double, stops, 3> P;
  const auto places = way(axis);
  for (std::size_t i = 0; i < stops; ++i)
    P.row(static_cast<Eigen::Index>(i)) = machine::point(errors, places[i]).transpose();
  const Eigen::RowVector3d middle = P.colwise().mean();
  P.rowwise() -= middle;
  const Vector d = Eigen::JacobiSVD<Eigen::MatrixXd>(P, Eigen::ComputeThinV).matrixV().col(0);
  return d.dot(unit(axis)) < 0.0 ? Vector(-d) : d;
}

/// The angle between both lines in their plane, with the sign of ISO 230-1.
double truth(const Errors& errors, char first, char second) {
  Vector a = line_of(errors, first), b = line_of(errors, second);
  const int other = 3 - number(first) - number(second);
  a[other] = b[other] = 0.0;
  const double over = std::acos(a.normalized().dot(b.normalized())) - std::numbers::pi / 2.0;
  return first == 'X' && second == 'Z' ? -over : over;  // B0Z turns +Z towards +X
}

Errors random_errors(std::mt19937& rng) {
  std::normal_distribution<double> normal;
  Errors e;
  for (const char* name : {"EYX", "EZX", "EXY", "EZY", "EXZ", "EYZ"}) {
    const double bow = 8 * um * normal(rng), wave = 4 * um * normal(rng), lean = 6e-6 * normal(rng);
    e[name] = [=](double p) {
      const double t = p / travel;
      return bow * t * (1.0 - t) + wave * std::sin(7.0 * t) + lean * p;
    };
  }
  for (const char* name : {"ECX", "EBX", "EAY", "EAZ"}) {
    const double size = 5e-6 * normal(rng);
    e[name] = [=](double p) { return size * std::sin(5.0 * p); };
  }
  e.C0Y = 30e-6 * normal(rng), e.B0Z = 30e-6 * normal(rng), e.A0Z = 30e-6 * normal(rng);
  return e;
}

struct Shop {
  Errors errors;
  Campaign campaign;
  std::vector<Observations> all;
  double scatter = 0.0;
  double leaning = 0.0;  ///< of the instrument: error over the way, the same on every line
  std::mt19937 rng{seed};

  explicit Shop(Errors e) : errors(std::move(e)) {
    campaign.squares.push_back({.name = "Q", .error = {}, .U = {}});
    campaign.instrument.U_fixed = 1e-9, campaign.instrument.U_per_length = 1e-10;
    campaign.environment.drift = 1e-10;
  }
  void line(const Block& block, bool of_first) {
    std::normal_distribution<double> normal;
    Measurement m;
    const char axis = of_first ? block.first : block.second,
               lateral = of_first ? block.second : block.first;
    m.id = std::string(1, axis) + (block.turned ? "t" : "");
    m.kind = "straightness";
    m.axis = axis;
    m.lateral = lateral;
    m.square = "Q";
    m.square_turned = block.turned;
    Observations o;
    o.measurement = m.id;
    o.axes.push_back({m.axis, false, {}, {}});
    const auto mean = block.read(errors, axis, lateral);
    const auto places = way(axis);
    for (std::uint32_t run = 1; run <= 2; ++run)
      for (const int direction : {1, -1})
        for (std::size_t i = 0; i < stops; ++i) {
          o.axes[0].position.push_back(places[i][number(axis)]);
          o.axes[0].approach.push_back(static_cast<std::int8_t>(direction));
          o.deviation.push_back(mean[i] + leaning * (places[i] - places[0]).norm() +
                                scatter * normal(rng));
          o.run.push_back(run);
        }
    campaign.measurements.push_back(std::move(m));
    all.push_back(std::move(o));
  }
  void both(const Block& block) { line(block, true), line(block, false); }
  Evaluation evaluate() const {
    const Settings none;
    EXPECT_TRUE(the_analysis().applies(campaign, campaign.measurements.front()));
    const auto e =
        the_analysis().analyse({campaign, campaign.measurements.front(), all.front(), none, &all});
    EXPECT_TRUE(e) << (e ? "" : e.error().message);
    return e.value_or(Evaluation{});
  }
};

const Value* value(const Evaluation& e, const std::string& name) {
  for (const Value& v : e.values)
    if (v.name == name) return &v;
  return nullptr;
}
bool says(const Evaluation& e, const std::string& id) {
  for (const Finding& f : e.findings)
    if (f.id == id) return true;
  return false;
}

Vector some_turn(std::mt19937& rng) {
  std::normal_distribution<double> normal(0.0, 100 * urad);
  return {normal(rng), normal(rng), normal(rng)};
}

TEST(Square, SignsAreThoseOfExactTransforms) {
  std::mt19937 rng(seed);
  std::cout << "seed " << seed << "\n";
  for (int k = 0; k < 20; ++k)
    for (const auto& [first, second, name] :
         {std::tuple{'X', 'Y', "C0Y_LSQ"}, {'X', 'Z', "B0Z_LSQ"}, {'Y', 'Z', "A0Z_LSQ"}}) {
      const Errors errors = random_errors(rng);
      const double g = 40 * urad, wanted = truth(errors, first, second);
      Shop turned(errors), stated(errors);
      const Block one{first, second, g, false, some_turn(rng)},
          other{first, second, g, true, some_turn(rng)};
      turned.both(one), turned.both(other);
      stated.both(one);
      stated.campaign.squares[0].error = g;
      for (const Shop* shop : {&turned, &stated}) {
        const Evaluation e = shop->evaluate();
        ASSERT_NE(value(e, name), nullptr);
        EXPECT_NEAR(value(e, name)->value, wanted, 0.3 * urad) << name;
      }
      EXPECT_NEAR(value(turned.evaluate(), "square_error")->value, g, 0.3 * urad) << name;
      EXPECT_GT(std::fabs(wanted), 0.0);
    }
  Errors only;  // the definition itself
  only.C0Y = 20 * urad, only.B0Z = 30 * urad, only.A0Z = -10 * urad;
  EXPECT_NEAR(truth(only, 'X', 'Y'), only.C0Y, 0.01 * urad);
  EXPECT_NEAR(truth(only, 'X', 'Z'), only.B0Z, 0.01 * urad);
  EXPECT_NEAR(truth(only, 'Y', 'Z'), only.A0Z, 0.01 * urad);
}

/// Not straight, with other forms: what is left of them in the mean of both positions is nothing.
TEST(Square, BentFacesDropOutOfTheMean) {
  std::mt19937 rng(seed + 3);
  const Errors errors = random_errors(rng);
  Shop shop(errors);
  Block block{'X', 'Y', 40 * urad};
  block.bent = 30 * um;
  shop.both(block);
  block.turned = true;
  shop.both(block);
  const Evaluation e = shop.evaluate();
  ASSERT_NE(value(e, "C0Y_LSQ"), nullptr);
  EXPECT_NEAR(value(e, "C0Y_LSQ")->value, truth(errors, 'X', 'Y'), 0.1 * urad);
  EXPECT_GT(std::fabs(value(e, "square_error")->value - 40 * urad), 20 * urad)
      << "faces' own lines";
}

/// Two sides of a gantry against one square are two results, not one of four lines.
TEST(Square, EachNameOfAnAxisHasItsOwnLines) {
  std::mt19937 rng(seed + 4);
  Shop shop(random_errors(rng));
  shop.line({'X', 'Y'}, true);
  shop.line({'X', 'Y'}, true);
  shop.campaign.measurements[1].axis = "X2";
  EXPECT_TRUE(says(shop.evaluate(), "square.one-line"));
}

TEST(Square, RefusesWhatItCannotKnow) {
  std::mt19937 rng(seed + 1);
  const Errors errors = random_errors(rng);
  Shop shop(errors);
  shop.line({'X', 'Y'}, true);
  EXPECT_TRUE(says(shop.evaluate(), "square.one-line"));
  shop.line({'X', 'Y'}, false);
  EXPECT_TRUE(says(shop.evaluate(), "square.unknown"));
  EXPECT_TRUE(shop.evaluate().values.empty());
  shop.campaign.squares[0].error = 1 * urad;
  shop.scatter = 1 * um;
  const Evaluation e = shop.evaluate();
  EXPECT_TRUE(says(e, "uncertainty.no-data")) << "U_urad";
  ASSERT_NE(value(e, "C0Y_LSQ"), nullptr);
  EXPECT_FALSE(value(e, "C0Y_LSQ")->U);
  shop.line({'X', 'Y', 0.0, true}, true);
  EXPECT_TRUE(says(shop.evaluate(), "square.one-line"));
  // Its certificate is compared with what turning it over shows.
  Shop two(errors);
  two.scatter = 0.5 * um;
  two.both({'X', 'Y', 50 * urad});
  two.both({'X', 'Y', 50 * urad, true});
  two.campaign.squares[0].error = 50 * urad, two.campaign.squares[0].U = 2 * urad;
  EXPECT_FALSE(says(two.evaluate(), "square.certificate"));
  two.campaign.squares[0].error = -50 * urad;  // another quadrant was meant
  EXPECT_TRUE(says(two.evaluate(), "square.certificate"));
}

/// Turned over, and with the square's own error and its U: 2,000 campaigns each.
TEST(Square, UncertaintiesCoverTheTruth) {
  std::cout << "seed " << seed + 2 << "\n";
  constexpr int campaigns = 2000;
  for (const bool turned : {true, false}) {
    std::mt19937 rng(seed + 2);
    std::normal_distribution<double> normal;
    const Errors errors = random_errors(rng);
    const double wanted = truth(errors, 'X', 'Y'), U = 6 * urad;
    double inside = 0.0;
    for (int c = 0; c < campaigns; ++c) {
      Shop shop(errors);
      shop.rng.seed(seed + 1000 + static_cast<unsigned>(c));
      shop.scatter = 2 * um;
      shop.campaign.instrument.U_per_length = 2e-6;
      shop.leaning = 1e-6 * normal(rng);
      shop.campaign.squares[0].error = 10 * urad, shop.campaign.squares[0].U = U;
      const double g = 10 * urad + U / 2.0 * normal(rng);
      shop.both({'X', 'Y', g, false, some_turn(rng)});
      if (turned) shop.both({'X', 'Y', g, true, some_turn(rng)});
      const Evaluation e = shop.evaluate();
      const Value* v = value(e, "C0Y_LSQ");
      ASSERT_TRUE(v != nullptr && v->U);
      inside += std::fabs(v->value - wanted) <= *v->U;
    }
    std::cout << (turned ? "turned over" : "stated") << ": " << 100.0 * inside / campaigns
              << " %\n";
    EXPECT_GE(inside, 0.94 * campaigns);
    EXPECT_LE(inside, 0.965 * campaigns);
  }
}

TEST(Square, OneQuantityWeighsByUncertainty) {
  const auto one = math::one_quantity(10.0, {.u = 1.0, .U = {}}, 13.0, {.u = 2.0, .U = {}});
  EXPECT_DOUBLE_EQ(one.value, (10.0 * 4.0 + 13.0) / 5.0);
  EXPECT_DOUBLE_EQ(one.u, std::sqrt(0.8));
  EXPECT_DOUBLE_EQ(one.difference, -3.0);
  EXPECT_NEAR(one.p, std::erfc(3.0 / std::sqrt(5.0) / std::sqrt(2.0)), 1e-5);
}

}  // namespace
}  // namespace nonio::fixtures::square_test
