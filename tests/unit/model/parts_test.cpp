// SPDX-License-Identifier: Apache-2.0
// What of a campaign is explained together.
#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <numbers>
#include <set>

#include "nonio/model/measurements.h"

namespace nonio::model::parts_test {

namespace {

using Ids = std::vector<std::string>;
using Places = std::map<std::string, double>;
constexpr int stops = 5;

/// Measurements as readers give them, there and back, on a machine with X, Y, Z and C.
struct Visit {
  Campaign campaign;
  std::vector<Observations> read;

  Visit() {
    for (const char* axis : {"X", "Y", "Z"}) campaign.machine.axes.push_back({.name = axis});
    campaign.machine.axes.push_back({.name = "C", .rotary = true});
    campaign.machine.structure = "gantry";
  }

  Measurement& begin(const std::string& id, const std::string& kind) {
    Measurement m;
    m.id = id;
    m.kind = kind;
    campaign.measurements.push_back(m);
    read.push_back({});
    read.back().measurement = id;
    return campaign.measurements.back();
  }

  void put(double deviation) {
    Observations& o = read.back();
    o.deviation.push_back(deviation);
    o.run.push_back(1);
    o.source_line.push_back(static_cast<std::uint32_t>(o.size() + 1));
  }

  /// 0 to 1 m and back.
  Measurement& run(const std::string& id, const std::string& axis, std::array<double, 3> sense,
                   const Places& at = {}) {
    Measurement& m = begin(id, "axis");
    m.axis = axis;
    m.at = at;
    Observations& o = read.back();
    o.angular = axis == "C";
    o.axes = {{axis, axis == "C", {}, {}}};
    o.lines = {{id, sense}};
    for (int i = 0; i < 2 * stops; ++i) {
      o.axes[0].position.push_back(0.25 * (i < stops ? i : 2 * stops - 1 - i));
      o.axes[0].approach.push_back(i < stops ? 1 : -1);
      put(1e-6 * i);
    }
    return m;
  }

  void straightness(const std::string& id, const std::string& axis, const std::string& lateral,
                    const Places& at = {}) {
    std::array<double, 3> sense{};
    sense[coordinate_of(lateral)] = 1.0;
    Measurement& m = run(id, axis, sense, at);
    m.kind = "straightness";
    m.lateral = lateral;
  }

  void diagonal(const std::string& id, const Places& from, const Places& to) {
    Measurement& m = begin(id, "diagonal");
    m.from = from;
    m.to = to;
    Observations& o = read.back();
    double length = 0.0;
    for (const auto& [axis, start] : from) length = std::hypot(length, to.at(axis) - start);
    o.lines = {{id, {}}};
    for (const auto& [axis, start] : from) {
      o.lines[0].sense[coordinate_of(axis)] = (to.at(axis) - start) / length;
      o.axes.push_back({axis, false, {}, {}});
    }
    for (int i = 0; i < 2 * stops; ++i) {
      const double t = 0.25 * (i < stops ? i : 2 * stops - 1 - i);
      for (auto& axis : o.axes) {
        const double way = to.at(axis.axis) - from.at(axis.axis);
        axis.position.push_back(from.at(axis.axis) + t * way);
        axis.approach.push_back((i < stops) == (way > 0.0) ? 1 : -1);
      }
      put(1e-6 * i);
    }
  }

  void diagonals(const std::string& state = "") {
    diagonal("D1" + state, {{"X", 0.0}, {"Y", 0.0}}, {{"X", 4.0}, {"Y", 3.0}});
    diagonal("D2" + state, {{"X", 0.0}, {"Y", 3.0}}, {{"X", 4.0}, {"Y", 0.0}});
  }

  /// A ball on a table; `wobble`: of its second centre, m.
  void balls(const std::string& id, int places, double wobble = 0.0) {
    begin(id, "ball-centres").axis = "C";
    Observations& o = read.back();
    o.axes = {
        {"C", true, {}, {}}, {"X", false, {}, {}}, {"Y", false, {}, {}}, {"Z", false, {}, {}}};
    o.lines = {{"x", {1, 0, 0}}, {"y", {0, 1, 0}}, {"z", {0, 0, 1}}};
    for (int place = 0; place < places; ++place) {
      const double angle = 2.0 * std::numbers::pi * place / places;
      const std::array<double, 3> at{0.3 + 0.2 * std::cos(angle), 0.4 + 0.2 * std::sin(angle),
                                     0.1 + (place == 1 ? wobble : 0.0)};
      for (std::size_t k = 0; k < 3; ++k) {
        o.axes[0].position.push_back(angle);
        o.axes[0].approach.push_back(place % 2 == 0 ? 1 : -1);
        for (std::size_t c = 0; c < 3; ++c) o.axes[1 + c].position.push_back(at[c]);
        o.line.push_back(static_cast<std::uint32_t>(k));
        put(at[k]);
      }
    }
  }

  std::vector<Part> parts() const { return parts_of(campaign, read); }
};

Ids names(const std::vector<Part>& parts) {
  Ids out;
  for (const Part& part : parts) out.push_back(part.name);
  return out;
}

Ids axes(const Part& part) {
  Ids out;
  for (const Axis& axis : part.axes) out.push_back(axis.name);
  return out;
}

/// Every reading can be found again in the file that it came from.
void expect_traceable(const Part& part, const Visit& test) {
  const std::size_t n = part.table.size();
  ASSERT_EQ(part.measurement.size(), n);
  ASSERT_EQ(part.row.size(), n);
  ASSERT_EQ(part.along.size(), n);
  ASSERT_EQ(part.way.size(), n);
  ASSERT_EQ(part.table.line.size(), n);
  for (const auto& axis : part.table.axes) ASSERT_EQ(axis.position.size(), n) << axis.axis;
  std::set<std::string> lines;
  for (const auto& line : part.table.lines)
    EXPECT_TRUE(lines.insert(line.name).second) << line.name;
  for (std::size_t i = 0; i < n; ++i) {
    const std::string& id = part.measurements.at(part.measurement[i]);
    std::size_t m = 0;
    while (test.campaign.measurements.at(m).id != id) ++m;
    const Observations& o = test.read[m];
    EXPECT_EQ(part.table.source_line[i], o.source_line.at(part.row[i]));
    if (part.kind != Part::Kind::balls) {
      EXPECT_EQ(part.table.deviation[i], o.deviation[part.row[i]]);
      EXPECT_EQ(part.table.sense_of(i), o.sense_of(part.row[i]));
    }
  }
}

}  // namespace

TEST(Parts, RunsOfAnAxisAreOnePartEach) {
  Visit t;
  t.run("Y", "Y", {0, 1, 0});
  t.run("X1", "X", {1, 0, 0}, {{"Y", 0.5}});
  t.run("C", "C", {});
  t.run("X2", "X", {1, 0, 0});
  const auto parts = t.parts();
  ASSERT_EQ(names(parts), (Ids{"Y", "X", "C"}));
  EXPECT_EQ(parts[1].measurements, (Ids{"X1", "X2"}));
  EXPECT_TRUE(parts[2].table.angular);
  for (const Part& part : parts) {
    EXPECT_EQ(part.kind, Part::Kind::axis);
    ASSERT_EQ(part.table.axes.size(), 1u);
    EXPECT_EQ(part.along, part.table.axes[0].position);
    EXPECT_EQ(part.way, part.table.axes[0].approach);
    EXPECT_TRUE(unstated_positions(part).empty());
    expect_traceable(part, t);
  }
}

// What a reader says of a reading's uncertainty comes along, whatever it is joined with.
TEST(Parts, TheUncertaintyOfReadingsIsKept) {
  Visit t;
  t.run("X1", "X", {1, 0, 0});
  t.run("X2", "X", {1, 0, 0});
  t.read[1].run.clear();
  for (std::size_t i = 0; i < t.read[1].size(); ++i)
    t.read[1].u.push_back(1e-6 * static_cast<double>(i + 1));
  const Part run = t.parts().at(0);
  ASSERT_EQ(run.table.u.size(), run.table.size());
  ASSERT_EQ(run.table.run.size(), run.table.size());
  for (std::size_t i = 0; i < run.table.size(); ++i) {
    const bool stated = i >= t.read[0].size();
    EXPECT_EQ(std::isnan(run.table.u[i]), !stated);
    if (!stated) continue;
    EXPECT_EQ(run.table.u[i], t.read[1].u[run.row[i]]);
  }

  Visit space;
  space.diagonals();
  space.read[0].u.assign(space.read[0].size(), 2e-6);
  space.read[1].u.assign(space.read[1].size(), 5e-6);
  const Part diagonals = space.parts().at(0);
  ASSERT_EQ(diagonals.table.u.size(), diagonals.table.size());
  for (std::size_t i = 0; i < diagonals.table.size(); ++i)
    EXPECT_EQ(diagonals.table.u[i], diagonals.measurement[i] == 0 ? 2e-6 : 5e-6);

  // Of a ball's centre: along the radius and along the axis, which is Z here.
  Visit balls;
  balls.balls("B", 12);
  for (std::size_t i = 0; i < balls.read[0].size(); ++i)
    balls.read[0].u.push_back(i % 3 == 2 ? 4e-6 : 1e-6);
  const Part part = balls.parts().at(0);
  ASSERT_EQ(part.table.u.size(), part.table.size());
  for (std::size_t i = 0; i < part.table.size(); ++i)
    EXPECT_NEAR(part.table.u[i], part.table.line[i] == 0 ? 1e-6 : 4e-6, 1e-12);
}

// Yaw read by an autocollimator is no position of the axis.
TEST(Parts, AnAngleOfALinearAxisIsLeftOut) {
  Visit t;
  t.run("yaw", "X", {}).kind = "angle";
  t.read.back().angular = true;
  t.run("X", "X", {1, 0, 0});
  const auto parts = t.parts();
  ASSERT_EQ(names(parts), Ids{"X"});
  EXPECT_EQ(parts[0].measurements, Ids{"X"});
}

TEST(Parts, AStraightnessAloneIsNamedByItsLetters) {
  Visit t;
  t.straightness("a", "X", "Y", {{"Y", 0.5}});
  t.straightness("b", "Y", "X");
  t.straightness("c", "X", "Y", {{"Y", 1.5}});
  t.run("X", "X", {1, 0, 0});
  const auto parts = t.parts();
  ASSERT_EQ(names(parts), (Ids{"EYX", "EXY", "X"}));
  EXPECT_EQ(parts[0].kind, Part::Kind::space);
  EXPECT_EQ(parts[0].measurements, (Ids{"a", "c"}));
  EXPECT_EQ(axes(parts[0]), (Ids{"X", "Y"}));
  EXPECT_EQ(parts[0].table.axes[1].position.front(), 0.5);
  EXPECT_EQ(parts[0].table.axes[1].position.back(), 1.5);
  EXPECT_EQ(parts[0].table.axes[1].approach, std::vector<std::int8_t>(std::size_t{4} * stops, 0));
  EXPECT_EQ(parts[0].along[2], 0.5);
  EXPECT_EQ(parts[0].way[stops], -1);
  for (const Part& part : parts) expect_traceable(part, t);
}

TEST(Parts, DiagonalsAndTheirAxesAreOnePart) {
  Visit t;
  t.run("X1", "X", {1, 0, 0}, {{"Y", 0.5}});
  t.run("Z", "Z", {0, 0, 1});
  t.diagonals();
  t.run("Y", "Y", {0, 1, 0});
  t.run("C", "C", {});
  t.straightness("S", "X", "Y", {{"Y", 1.5}});
  const auto parts = t.parts();
  ASSERT_EQ(names(parts), (Ids{"Z", "XY", "C"}));
  const Part& part = parts[1];
  EXPECT_EQ(part.kind, Part::Kind::space);
  EXPECT_EQ(part.measurements, (Ids{"X1", "D1", "D2", "Y", "S"}));
  EXPECT_EQ(axes(part), (Ids{"X", "Y"}));
  EXPECT_EQ(part.table.structure, "gantry");
  EXPECT_EQ(part.table.axes[1].position[0], 0.5);                                // X1: at
  EXPECT_TRUE(std::isnan(part.table.axes[0].position[std::size_t{6} * stops]));  // Y: not stated
  EXPECT_EQ(part.table.axes[0].approach[std::size_t{6} * stops], 0);
  EXPECT_EQ(unstated_positions(part), Ids{"Y"});
  expect_traceable(part, t);
}

TEST(Parts, ThePlaceOnADiagonalIsTheWayFromItsStart) {
  Visit t;
  t.diagonals();
  const auto parts = t.parts();
  ASSERT_EQ(names(parts), Ids{"XY"});
  EXPECT_TRUE(unstated_positions(parts[0]).empty());
  for (int line = 0; line < 2; ++line)
    for (int i = 0; i < 2 * stops; ++i) {
      const auto row =
          std::size_t{2} * static_cast<std::size_t>(line) * stops + static_cast<std::size_t>(i);
      EXPECT_NEAR(parts[0].along[row], 1.25 * (i < stops ? i : 2 * stops - 1 - i), 1e-12);
      EXPECT_EQ(parts[0].way[row], i < stops ? 1 : -1);
      EXPECT_EQ(parts[0].measurement[row], static_cast<std::uint32_t>(line));
      EXPECT_EQ(parts[0].row[row], static_cast<std::uint32_t>(i));
    }
}

// Three of the four do not begin at `from`.
TEST(Parts, ThePlaceOnAStepDiagonalIsTheWayFromItsOwnStart) {
  Visit t;
  Measurement& m = t.begin("SD", "step-diagonal");
  m.from = {{"X", 0.1}, {"Y", 0.2}, {"Z", 0.3}};
  m.to = {{"X", 0.9}, {"Y", 0.8}, {"Z", 0.9}};
  const double length = std::hypot(0.8, 0.6, 0.6);
  Observations& o = t.read.back();
  const std::array<double, 3> way{0.8, 0.6, 0.6};
  const std::vector<std::array<double, 3>> signs{{1, 1, 1}, {-1, 1, 1}, {1, -1, 1}, {1, 1, -1}};
  for (const char* axis : {"X", "Y", "Z"}) o.axes.push_back({axis, false, {}, {}});
  for (std::size_t line = 0; line < signs.size(); ++line) {
    o.lines.push_back({"SD " + std::to_string(line), {}});
    for (std::size_t k = 0; k < 3; ++k) o.lines.back().sense[k] = signs[line][k] * way[k] / length;
    for (int moves = 1; moves <= 6; ++moves) {
      for (std::size_t k = 0; k < 3; ++k) {
        const int half = (moves - static_cast<int>(k) + 2) / 3;  // of two
        const double start = signs[line][k] > 0.0 ? 0.1 * (1.0 + static_cast<double>(k))
                                                  : (k == 0   ? 0.9
                                                     : k == 1 ? 0.8
                                                              : 0.9);
        o.axes[k].position.push_back(start + signs[line][k] * way[k] * half / 2.0);
        o.axes[k].approach.push_back(signs[line][k] > 0.0 ? 1 : -1);
      }
      o.line.push_back(static_cast<std::uint32_t>(line));
      t.put(0.0);
    }
  }
  const auto parts = t.parts();
  ASSERT_EQ(names(parts), Ids{"XYZ"});
  for (std::size_t i = 0; i < o.size(); ++i) {
    const double first = 0.8 * 0.8 / length / 2.0;
    if (i % 6 == 0) {
      EXPECT_NEAR(parts[0].along[i], first, 1e-12);
    }
    if (i % 6 == 5) {
      EXPECT_NEAR(parts[0].along[i], length, 1e-12);
    }
    EXPECT_EQ(parts[0].way[i], 1);
  }
  expect_traceable(parts[0], t);
}

TEST(Parts, EachStateOfTheMachineIsAPart) {
  Visit t;
  t.run("X", "X", {1, 0, 0});
  t.run("Y final", "Y", {0, 1, 0});
  t.diagonals(" 00");
  t.diagonals(" final");
  const auto parts = t.parts();
  ASSERT_EQ(names(parts), (Ids{"XY 00", "XY final"}));
  EXPECT_EQ(parts[0].measurements, (Ids{"X", "D1 00", "D2 00"}));
  EXPECT_EQ(parts[1].measurements, (Ids{"X", "Y final", "D1 final", "D2 final"}));
  for (const Part& part : parts) expect_traceable(part, t);
}

// The key says what the ids said before, and an id with a space may say nothing.
TEST(Parts, TheKeyOfTheStateCountsBeforeTheId) {
  Visit t;
  t.run("X 1", "X", {1, 0, 0}).state = "";
  t.run("Y1", "Y", {0, 1, 0}).state = "final";
  t.diagonals("a");
  t.diagonals("b");
  for (Measurement& m : t.campaign.measurements)
    if (m.kind == "diagonal") m.state = m.id.back() == 'a' ? "00" : "final";
  const auto parts = t.parts();
  ASSERT_EQ(names(parts), (Ids{"XY 00", "XY final"}));
  EXPECT_EQ(parts[0].measurements, (Ids{"X 1", "D1a", "D2a"}));
  EXPECT_EQ(parts[1].measurements, (Ids{"X 1", "Y1", "D1b", "D2b"}));
}

// Everything measured in addition to the deviation is in the part, NaN if a measurement has none.
TEST(Parts, NoColumnIsLost) {
  Visit t;
  t.run("X1", "X", {1, 0, 0});
  Observations& first = t.read.back();
  const std::size_t n = first.size();
  for (std::size_t i = 0; i < n; ++i) {
    const auto x = static_cast<double>(i);
    first.u.push_back(1e-7 * (x + 1.0)), first.time.push_back(x),
        first.material.push_back(20.0 + x);
    first.air.push_back(30.0 + x), first.pressure.push_back(1000.0 + x),
        first.humidity.push_back(40.0 + x);
  }
  t.run("X2", "X", {1, 0, 0});
  const auto parts = t.parts();
  ASSERT_EQ(parts.size(), 1U);
  const Observations& o = parts[0].table;
  for_each_measured_column(
      [&](const auto& column, const auto& given) {
        ASSERT_EQ(column.size(), o.size());
        for (std::size_t i = 0; i < given.size(); ++i) EXPECT_EQ(column[i], given[i]);
      },
      o, t.read[0]);
  for (const auto* column : {&o.u, &o.time, &o.material, &o.air, &o.pressure, &o.humidity})
    for (std::size_t i = n; i < o.size(); ++i) EXPECT_TRUE(std::isnan((*column)[i]));
}

TEST(Parts, ReadingsOfALineThatIsNotThereAreInNoPart) {
  Visit t;
  t.run("X", "X", {1, 0, 0});
  t.read.back().line.assign(t.read.back().size(), 7);
  EXPECT_TRUE(t.parts().empty());
}

TEST(Parts, ARunOfAStateWithoutDiagonalsStaysAlone) {
  Visit t;
  t.run("X spring", "X", {1, 0, 0});
  t.straightness("S", "X", "Y");
  t.diagonals(" 00");
  const auto parts = t.parts();
  ASSERT_EQ(names(parts), (Ids{"X", "XY 00"}));
  EXPECT_EQ(parts[1].measurements, (Ids{"S", "D1 00", "D2 00"}));
}

TEST(Parts, BallCentresAreRadialAndAxial) {
  Visit t;
  t.balls("ball", 8);
  t.run("C", "C", {});
  t.balls("other", 8, 4e-6);
  const auto parts = t.parts();
  ASSERT_EQ(names(parts), (Ids{"ball", "C", "other"}));
  const Part& part = parts[0];
  EXPECT_EQ(part.kind, Part::Kind::balls);
  EXPECT_EQ(axes(part), Ids{"C"});
  EXPECT_FALSE(part.table.angular);
  ASSERT_EQ(part.table.size(), 16u);
  ASSERT_EQ(part.table.lines.size(), 2u);
  for (std::size_t i = 0; i < 16; ++i) {
    const double angle = 2.0 * std::numbers::pi * static_cast<double>(i % 8) / 8.0;
    EXPECT_EQ(part.table.line[i], i < 8 ? 0u : 1u);
    EXPECT_NEAR(part.table.deviation[i], 0.0, 1e-12);
    EXPECT_NEAR(part.along[i], angle, 1e-12);
    EXPECT_EQ(part.way[i], i % 2 == 0 ? 1 : -1);
    EXPECT_EQ(part.row[i], 3 * (i % 8));
    const auto sense = part.table.sense_of(i);
    EXPECT_NEAR(sense[0], i < 8 ? std::cos(angle) : 0.0, 1e-9);
    EXPECT_NEAR(sense[1], i < 8 ? std::sin(angle) : 0.0, 1e-9);
    EXPECT_NEAR(std::fabs(sense[2]), i < 8 ? 0.0 : 1.0, 1e-9);
  }
  expect_traceable(part, t);
  // A plane takes 3/8 of what one of eight is high.
  EXPECT_NEAR(std::fabs(parts[2].table.deviation[9]), 4e-6 * 5.0 / 8.0, 1e-9);
}

TEST(Parts, TwoBallsAreNoCircle) {
  Visit t;
  t.balls("ball", 2);
  EXPECT_EQ(names(t.parts()), Ids{});
}

// A general table may call its lines as another one does.
TEST(Parts, LinesOfTwoTablesHaveTwoNames) {
  Visit t;
  t.diagonals();
  for (Observations& o : t.read) o.lines[0].name = "1";
  const auto parts = t.parts();
  ASSERT_EQ(names(parts), Ids{"XY"});
  expect_traceable(parts[0], t);
}

TEST(Parts, NothingIsMadeOfNothing) {
  Visit t;
  EXPECT_EQ(names(t.parts()), Ids{});
  t.diagonals();
  for (Observations& o : t.read) o = {};
  t.begin("empty", "axis").axis = "X";
  t.run("Q", "Q", {1, 0, 0});  // no axis of the machine
  EXPECT_EQ(names(t.parts()), Ids{});
  t.read.pop_back();  // not all were read
  EXPECT_EQ(names(t.parts()), Ids{});
}

}  // namespace nonio::model::parts_test
