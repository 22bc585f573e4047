// SPDX-License-Identifier: Apache-2.0
// The exact machine against the linearised one (Schwenke et al., CIRP Annals 57 (2008) 660, for a
// chain X - Y - Z with the tool offset zero).
#include "machine.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <iostream>
#include <numbers>
#include <random>

namespace machine {
namespace {

constexpr unsigned seed = 20261121;

/// Smooth, 0 at 0, of this size over about a metre.
Curve random_curve(std::mt19937& rng, double size) {
  std::uniform_real_distribution<double> u(-1.0, 1.0);
  const double a = size * u(rng), b = size * u(rng), c = 1.0 + u(rng);
  return [=](double p) { return a * std::sin(c * p) + b * p * p; };
}

Errors random_errors(std::mt19937& rng) {
  Errors e;
  for (const char axis : {'X', 'Y', 'Z'})
    for (const char kind : {'X', 'Y', 'Z', 'A', 'B', 'C'})
      e[std::string("E") + kind + axis] = random_curve(rng, 20e-6);
  std::uniform_real_distribution<double> u(-20e-6, 20e-6);
  e.C0Y = u(rng);
  e.B0Z = u(rng);
  e.A0Z = u(rng);
  e.y_ref = 0.3;
  e.z_ref = 0.2;
  return e;
}

Vector linearised(const Errors& e, const Vector& p) {
  const double x = p.x(), y = p.y(), z = p.z(), ry = y - e.y_ref, rz = z - e.z_ref;
  return {e.EXX(x) + e.EXY(y) + e.EXZ(z) - ry * e.ECX(x) + rz * (e.EBX(x) + e.EBY(y) + e.B0Z) -
              e.C0Y * y,
          e.EYX(x) + e.EYY(y) + e.EYZ(z) - rz * (e.EAX(x) + e.EAY(y) + e.A0Z),
          e.EZX(x) + e.EZY(y) + e.EZZ(z) + ry * e.EAX(x)};
}

TEST(Machine, IsTheLinearOneToSecondOrder) {
  std::mt19937 rng(seed);
  std::cout << "seed " << seed << "\n";
  std::uniform_real_distribution<double> u(0.0, 1.0);
  for (int k = 0; k < 200; ++k) {
    const Errors e = random_errors(rng);
    const Vector p(0.8 * u(rng), 0.6 * u(rng), 0.6 * u(rng));
    EXPECT_LT((point(e, p) - p - linearised(e, p)).norm(), 0.02e-6);
  }
}

TEST(Machine, WithoutErrorsEverythingReadsZero) {
  const std::vector<Vector> stops{{0, 0, 0}, {0.4, 0.3, 0}, {0.8, 0.6, 0}};
  for (const double r : interferometer({}, stops)) EXPECT_NEAR(r, 0.0, 1e-15);
  for (const double r : flat_mirror({}, stops, Vector(0.8, 0.6, 0), {0, 0}))
    EXPECT_NEAR(r, 0.0, 1e-15);
}

TEST(Machine, SquarenessMakesTheDiagonalsUnequal) {
  Errors e;
  e.C0Y = 10e-6;
  const auto d1 = interferometer(e, {{0, 0, 0}, {12, 9, 0}});
  const auto d2 = interferometer(e, {{0, 9, 0}, {12, 0, 0}});
  // D1 - D2 = -2 Lx Ly C0Y / L
  EXPECT_NEAR(d1[1] - d2[1], -2.0 * 12.0 * 9.0 * 10e-6 / 15.0, 2e-9);
}

TEST(Machine, AMisalignedMirrorReadsAStepOfEachAxisWrong) {
  const Vector beam = Vector(0.8, 0.6, 0.6).normalized();
  const std::vector<Vector> stops{{0, 0, 0}, {0.02, 0, 0}, {0.02, 0.015, 0}, {0.02, 0.015, 0.015}};
  const auto read = flat_mirror({}, stops, beam, {0.3e-3, 0.0});
  EXPECT_GT(std::fabs(read[1]), 1e-6);
  EXPECT_LT(std::fabs(read[3]), 3e-9);  // the sum over a cycle: second order only
}

/// The four body diagonals of a volume, by the largest reading.
std::array<double, 4> body_diagonals(const Errors& e, const Vector& travel) {
  std::array<double, 4> most{};
  const std::array<Vector, 4> signs{{{1, 1, 1}, {-1, 1, 1}, {1, -1, 1}, {1, 1, -1}}};
  for (std::size_t k = 0; k < 4; ++k) {
    std::vector<Vector> stops;
    for (int i = 0; i <= 40; ++i) {
      Vector p;
      for (int c = 0; c < 3; ++c) p[c] = travel[c] * (signs[k][c] > 0 ? i : 40 - i) / 40.0;
      stops.push_back(p);
    }
    for (const double r : interferometer(e, stops)) most[k] = std::max(most[k], std::fabs(r));
  }
  return most;
}

double largest(const std::array<double, 4>& of) { return *std::max_element(of.begin(), of.end()); }

// Scales whose sum weighted with the squares of the travels is 0 leave every body diagonal perfect:
// a good test of the diagonals does not prove a good machine.
TEST(Machine, BodyDiagonalsDoNotSeeTwoOfThreeScales) {
  const Vector travel(0.8, 0.6, 0.6);
  Errors e;
  e.EXX = [](double x) { return 100e-6 * x; };
  e.EYY = [](double y) { return -100e-6 * y * 0.64 / 0.36; };
  EXPECT_GT(e.EXX(0.8), 79e-6);
  EXPECT_LT(largest(body_diagonals(e, travel)), 0.05e-6);
}

// At tool offset zero, angles about lines through the middle of the volume, 20 urad at the end of
// the travel: EBX, ECX, EAY and EBY are 3.5 to 4.6 um on a body diagonal, EAX cancels, and those of
// the tool's end never enter.
TEST(Machine, BodyDiagonalsSeeSomeAngularErrors) {
  const Vector travel(0.8, 0.6, 0.6);
  const auto seen = [&](const char* angle) {
    Errors e;
    e.y_ref = travel.y() / 2, e.z_ref = travel.z() / 2;
    const double length = travel[angle[2] - 'X'];
    e[angle] = [length](double p) { return 20e-6 * p / length; };
    return largest(body_diagonals(e, travel));
  };
  for (const char* angle : {"EBX", "ECX", "EAY", "EBY"}) {
    EXPECT_GT(seen(angle), 1.2e-6) << angle;
    EXPECT_LT(seen(angle), 5e-6) << angle;
    std::cout << angle << " " << 1e6 * seen(angle) << " um\n";
  }
  for (const char* angle : {"EAX", "ECY", "EAZ", "EBZ", "ECZ"})
    EXPECT_LT(seen(angle), 0.01e-6) << angle;
}

}  // namespace
}  // namespace machine
