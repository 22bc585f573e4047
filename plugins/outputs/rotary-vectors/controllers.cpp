// SPDX-License-Identifier: Apache-2.0
// Kinematic parameters with the names that controls use.
#include <algorithm>
#include <cmath>
#include <optional>

#include "vectors.h"

namespace nonio::rotary_vectors {
namespace {

/// A table C on a tilting axis: A rotates about X, B about Y. Coordinates in m.
struct TiltingTable {
  const Line *c = nullptr, *tilt = nullptr;
  std::size_t about = 0;  ///< coordinate along the tilting axis: 0 for A, 1 for B
  std::size_t across = 1;
  std::array<double, 3> c_point{}, tilt_point{};
};

std::array<double, 3> point_at(const Line& line, std::size_t coordinate, double where) {
  std::array<double, 3> out{};
  const double way = (where - line.centre[coordinate].value) / line.direction[coordinate].value;
  for (std::size_t k = 0; k < 3; ++k) out[k] = line.centre[k].value + way * line.direction[k].value;
  return out;
}

bool along(const Line& line, std::size_t coordinate) {
  constexpr double near = 0.999;  // 2.6 deg; larger angles are another type of machine
  return line.direction[coordinate].value > near;
}

bool parallel(const Line& line, std::size_t coordinate) {
  constexpr double near = 0.999;
  return std::fabs(line.direction[coordinate].value) > near;
}

bool compared(const Line& a, const Line& b) {
  if (a.of_chain && b.of_chain) return a.measurement == b.measurement;
  const auto names = [](const Line& x, const Line& y) {
    return std::find(x.shares_reference.begin(), x.shares_reference.end(), y.measurement) !=
           x.shares_reference.end();
  };
  return names(a, b) || names(b, a);
}

/// The only C and the only A or B of the campaign; empty if an axis occurs twice.
TiltingTable tilting_table(const std::vector<Line>& lines) {
  TiltingTable t;
  for (const Line& line : lines) {
    const bool tilts = line.axis == "A" || line.axis == "B";
    const Line*& place = tilts ? t.tilt : t.c;
    if (!tilts && line.axis != "C") continue;
    if (place != nullptr) return {};
    place = &line;
  }
  if (t.c == nullptr || t.tilt == nullptr) return {};
  t.about = t.tilt->axis == "A" ? 0 : 1;
  t.across = 1 - t.about;
  return t;
}

/// Whether a chain contradicts the assumption that the tilting axis carries C and both carry the
/// workpiece.
bool of_another_chain(const TiltingTable& t) {
  const std::string wanted = t.tilt->axis + ", C";
  return (t.c->of_chain && t.c->tables != wanted) || (t.tilt->of_chain && t.tilt->tables != wanted);
}

/// Sets the reference points: that of C at the height of the tilting axis, and that of the tilting
/// axis nearest to C.
void meet(TiltingTable& t) {
  t.c_point = point_at(*t.c, 2, t.tilt->centre[2].value);
  t.tilt_point = point_at(*t.tilt, t.about, t.c_point[t.about]);
  t.c_point = point_at(*t.c, 2, t.tilt_point[2]);
}

struct Field {
  std::string name;
  double value = 0.0;
  bool length = true;      ///< whether it is in mm; otherwise dimensionless
  bool documented = true;  ///< otherwise inferred, for the reason `why`
  const char* why = "";
};

struct Change {
  std::string control;
  std::vector<Field> fields;
};

std::string text_of(const Field& f, double value) {
  return f.length ? millimetres(value) : component(value);
}

std::optional<double> before(const Wish& wish, const Change& c, const Field& f) {
  const auto table = wish.before.find(c.control);
  if (table == wish.before.end()) return std::nullopt;
  const auto value = table->second.find(f.name);
  if (value == table->second.end()) return std::nullopt;
  return f.length ? value->second * 1e-3 : value->second;
}

/// All lengths must change within the limit and all stated names must be known; otherwise adds
/// findings.
bool within_limits(const Wish& wish, const Change& c, OutputResult& result) {
  bool good = true;
  for (const Field& f : c.fields)
    if (const auto was = before(wish, c, f);
        f.length && was && std::fabs(f.value - *was) > wish.limit) {
      result.findings.push_back({.id = "vectors.change-too-large",
                                 .attention = true,
                                 .evidence = {{"change", f.value - *was, Quantity::length},
                                              {"limit", wish.limit, Quantity::length}},
                                 .texts = {{"control", c.control}, {"name", f.name}}});
      good = false;
    }
  if (const auto table = wish.before.find(c.control); table != wish.before.end())
    for (const auto& [name, value] : table->second)
      if (std::none_of(c.fields.begin(), c.fields.end(),
                       [&known = name](const Field& f) { return f.name == known; })) {
        result.findings.push_back({.id = "vectors.unknown-name",
                                   .attention = true,
                                   .texts = {{"control", c.control}, {"name", name}}});
        good = false;
      }
  return good;
}

std::string rows_of(const Wish& wish, const Change& c, const char* comment) {
  std::size_t wide = 0;
  for (const Field& f : c.fields) wide = std::max(wide, f.name.size());
  std::string out = std::string(comment) + " name" + std::string(wide > 4 ? wide - 4 : 0, ' ') +
                    padded("before", 13) + padded("new", 13) + padded("change", 13) + "\n";
  for (const Field& f : c.fields) {
    const auto was = before(wish, c, f);
    out += "  " + f.name + std::string(wide - f.name.size(), ' ') +
           padded(was ? text_of(f, *was) : "not stated", 13) + padded(text_of(f, f.value), 13) +
           padded(was ? text_of(f, f.value - *was) : "-", 13) +
           (f.documented ? "  documented" : std::string("  INFERRED: ") + f.why) + "\n";
  }
  return out;
}

Change linuxcnc_fields(const TiltingTable& t) {
  const bool a = t.about == 0;
  return {"linuxcnc",
          {{"x-rot-point", t.c_point[0]},
           {"y-rot-point", t.c_point[1]},
           {"z-rot-point", t.tilt_point[2]},
           {a ? "y-offset" : "x-offset", t.tilt_point[t.across] - t.c_point[t.across]},
           {"z-offset", 0.0}}};
}

std::string linuxcnc(const TiltingTable& t, const std::string& campaign, const Change& c) {
  const bool a = t.about == 0;
  const std::string module = a ? "xyzac-trt-kins" : "xyzbc-trt-kins";
  std::string out = "# " + campaign + ": offsets for " + module + ", mm (machine units: mm)\n";
  out += "# Documented by its source: C passes through x-rot-point, y-rot-point with ";
  out += t.tilt->axis + " at 0;\n# " + t.tilt->axis + " through " + (a ? "y" : "x") +
         "-rot-point + " + (a ? "y" : "x") + "-offset and z-rot-point + z-offset.\n";
  out += "# Only the sum of z-rot-point and z-offset is used: z-offset is set to 0.\n";
  out += t.c->of_chain ? "# INFERRED: machine coordinates without tool length. C is that with " +
                             t.tilt->axis + " at 0, from one fit.\n"
                       : "# INFERRED: that C was measured with " + t.tilt->axis +
                             " at 0, and in machine coordinates without tool length.\n";
  out += "# The module takes both axes as parallel to the linear axes; they lean by\n";
  const double lean_c = std::hypot(t.c->direction[0].value, t.c->direction[1].value);
  const double lean_t = std::hypot(t.tilt->direction[t.across].value, t.tilt->direction[2].value);
  out += "# C " + component(lean_c * 1e3) + " mm/m, " + t.tilt->axis + " " +
         component(lean_t * 1e3) + " mm/m. tool-offset belongs to the tool.\n";
  for (const Field& f : c.fields)
    out += "setp " + module + "." + f.name + " " + millimetres(f.value) + "\n";
  return out;
}

/// Rows of a kinematics table: from the machine base to the tilting axis, and from there to C.
std::string heidenhain(const TiltingTable& t, const std::string& campaign, const Change& c) {
  std::string out = "; " + campaign + ": values for a kinematics table (iTNC 530), mm\n";
  out += "; Documented: the columns KEY, AXIS, COORD and the keys Trans, MachAxis.\n";
  out +=
      "; INFERRED: order of the rows, signs, and the place of the machine's base. Compare with\n";
  out += "; the table that is in the control and change only its values; do not load this file.\n";
  out += "KEY       AXIS  COORD\n";
  const auto row = [&](const char* key, char axis, const std::string& coord) {
    out += std::string(key) + std::string(10 - std::string_view(key).size(), ' ') + axis +
           (coord.empty() ? "" : "     " + coord) + "\n";
  };
  for (std::size_t k = 0; k < 3; ++k) row("Trans", "XYZ"[k], millimetres(c.fields[k].value));
  row("MachAxis", t.tilt->axis[0], "");
  for (std::size_t k = 0; k < 3; ++k) row("Trans", "XYZ"[k], millimetres(c.fields[3 + k].value));
  row("MachAxis", 'C', "");
  return out;
}

void put_vectors(const TiltingTable& t, Change& c, const std::array<const char*, 3>& first,
                 const std::array<const char*, 3>& second, bool documented, const char* why) {
  for (std::size_t k = 0; k < 3; ++k)
    c.fields.push_back({first[k], t.tilt_point[k], true, documented, why});
  for (std::size_t k = 0; k < 3; ++k)
    c.fields.push_back({second[k], t.c_point[k] - t.tilt_point[k], true, documented, why});
}

/// Swivel table: I2 from the machine reference point to the first rotary axis, I3 to the second
/// axis, I4 = -(I2 + I3). V1, V2: directions of the rotary axes, negative if they move the
/// workpiece (SINUMERIK Operate, Commissioning Manual 12/2017, swivelling).
Change siemens_fields(const TiltingTable& t, bool sign_shown) {
  Change c{"siemens", {}};
  put_vectors(t, c, {"$TC_CARR4", "$TC_CARR5", "$TC_CARR6"},
              {"$TC_CARR15", "$TC_CARR16", "$TC_CARR17"}, true, "");
  static constexpr const char* closing[] = {"$TC_CARR18", "$TC_CARR19", "$TC_CARR20"};
  for (std::size_t k = 0; k < 3; ++k) c.fields.push_back({closing[k], -t.c_point[k]});
  if (!sign_shown) return c;
  static constexpr const char* why =
      "which sign of a vector turns the table as it does; shown on the machine (sign_shown)";
  static constexpr const char* vectors[] = {"$TC_CARR7",  "$TC_CARR8",  "$TC_CARR9",
                                            "$TC_CARR10", "$TC_CARR11", "$TC_CARR12"};
  for (std::size_t k = 0; k < 3; ++k)
    c.fields.push_back({vectors[k], t.tilt->direction[k].value, false, false, why});
  for (std::size_t k = 0; k < 3; ++k)
    c.fields.push_back({vectors[3 + k], t.c->direction[k].value, false, false, why});
  return c;
}

/// Table rotation type (No. 19680 = 12); the first axis tilts (FANUC A-79348E: 19700 to 19705,
/// 19684).
Change fanuc_fields(const TiltingTable& t) {
  Change c{"fanuc", {}};
  put_vectors(t, c, {"19700", "19701", "19702"}, {"19703", "19704", "19705"}, true, "");
  const auto turns = [](const Line& line, std::size_t k) {
    return line.direction[k].value > 0.0 ? 0.0 : 1.0;
  };
  c.fields.push_back({"19684", turns(*t.tilt, t.about), false});
  c.fields.push_back(
      {"19689", turns(*t.c, 2), false, false, "number by the order of 19686 to 19690"});
  return c;
}

Change heidenhain_fields(const TiltingTable& t) {
  Change c{"heidenhain", {}};
  put_vectors(t, c, {"first_X", "first_Y", "first_Z"}, {"second_X", "second_Y", "second_Z"}, false,
              "order of rows, signs and the machine's base");
  return c;
}

std::string values_file(const TiltingTable& t, const std::string& campaign, const Wish& wish,
                        const Change& c, const char* what) {
  std::string out = "; " + campaign + ": " + what + ", mm\n";
  out += "; first rotary axis " + t.tilt->axis + ", second C; " +
         (t.c->of_chain ? "both at 0, from one fit\n" : "both measured with the other at 0\n");
  out += "; INFERRED: centres in machine coordinates without tool length\n";
  out += "; write down what the control has before you change it\n";
  return out + rows_of(wish, c, ";");
}

bool contains(const std::vector<std::string>& list, const char* name) {
  return std::find(list.begin(), list.end(), name) != list.end();
}

std::string log_of(const std::string& campaign, const Wish& wish, const std::vector<Change>& all) {
  std::string out;
  for (const Change& c : all)
    if (wish.before.contains(c.control)) out += "\n" + c.control + "\n" + rows_of(wish, c, " ");
  return out.empty() ? out : "Changes of kinematic parameters, " + campaign + ", mm\n" + out;
}

}  // namespace

void write_controllers(const std::vector<Line>& lines, const std::string& campaign,
                       const Wish& wish, OutputResult& result) {
  TiltingTable t = tilting_table(lines);
  if (t.c == nullptr) return;
  const std::vector<std::pair<std::string, std::string>> names = {{"one", t.c->measurement},
                                                                  {"other", t.tilt->measurement}};
  if (of_another_chain(t)) {
    result.findings.push_back({.id = "vectors.other-chain", .attention = true, .texts = names});
    return;
  }
  if (!compared(*t.c, *t.tilt)) {
    result.findings.push_back({.id = "vectors.no-reference", .texts = names});
    return;
  }
  if (!parallel(*t.c, 2) || !parallel(*t.tilt, t.about)) {
    result.findings.push_back({.id = "vectors.other-sense", .attention = true, .texts = names});
    return;
  }
  meet(t);
  std::vector<Change> written;
  const auto put = [&](Change c, const char* file, const auto& text) {
    if (!within_limits(wish, c, result)) return;
    result.artifacts.push_back({file, text(c)});
    written.push_back(std::move(c));
  };
  const bool right_handed = along(*t.c, 2) && along(*t.tilt, t.about);
  if (right_handed)
    put(linuxcnc_fields(t), "rotary-vectors-linuxcnc.hal",
        [&](const Change& c) { return linuxcnc(t, campaign, c); });
  else
    result.findings.push_back({.id = "vectors.other-sense", .attention = true, .texts = names});
  if (right_handed && contains(wish.sign_shown, "heidenhain"))
    put(heidenhain_fields(t), "rotary-vectors-heidenhain.txt",
        [&](const Change& c) { return heidenhain(t, campaign, c); });
  else if (right_handed)
    result.findings.push_back(
        {.id = "vectors.sign-not-shown", .texts = {{"control", "heidenhain"}}});
  const bool siemens_sign = contains(wish.sign_shown, "siemens");
  put(siemens_fields(t, siemens_sign), "rotary-vectors-siemens.txt", [&](const Change& c) {
    return values_file(
        t, campaign, wish, c,
        "swivel data record of a swivel table ($TC_CARR23 = \"P\"): I2, I3, I4, V1, V2");
  });
  if (!siemens_sign)
    result.findings.push_back({.id = "vectors.sign-not-shown", .texts = {{"control", "siemens"}}});
  put(fanuc_fields(t), "rotary-vectors-fanuc.txt", [&](const Change& c) {
    return values_file(t, campaign, wish, c,
                       "parameters of tool center point control, table rotation type (19680 = 12)");
  });
  if (std::string log = log_of(campaign, wish, written); !log.empty())
    result.artifacts.push_back({"rotary-vectors-changes.txt", std::move(log)});
  const std::string chain = t.c->of_chain ? "-chain" : "";
  if (right_handed)
    result.notes.push_back(
        {.id = "vectors.linuxcnc-inferred" + chain, .texts = {{"axis", t.tilt->axis}}});
  if (right_handed && contains(wish.sign_shown, "heidenhain"))
    result.notes.push_back({.id = "vectors.heidenhain-inferred"});
  result.notes.push_back({.id = "vectors.controls-inferred" + chain});
}

}  // namespace nonio::rotary_vectors
