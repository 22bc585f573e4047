// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <charconv>
#include <cmath>
#include <map>
#include <optional>
#include <regex>
#include <string>
#include <vector>

#include "workshop.h"

/// What controls do with the text of their tables, written from their makers' words and not from
/// the plugins: none of the code that writes or reads tables there is used here.
namespace models {

using workshop::deg;
using workshop::mm;
using workshop::um;

/// Adds to the position of one axis. SI.
struct Control {
  struct Table {
    std::vector<double> x, plus, minus;
    bool repeats = false;
  };
  std::vector<Table> tables;
  /// The axis goes so much further when it moves towards minus; nothing: as it was.
  std::optional<double> backlash{};
  bool of_reading = false;  ///< the table is looked up with what the encoder reads

  static double at(const Table& t, double x, bool up) {
    const auto& v = up ? t.plus : t.minus;
    if (t.repeats) {
      const double turn = t.x.back() - t.x.front();
      x -= turn * std::floor((x - t.x.front()) / turn);
    }
    if (x <= t.x.front()) return v.front();
    for (std::size_t i = 1; i < t.x.size(); ++i)
      if (x <= t.x[i])
        return v[i - 1] + (v[i] - v[i - 1]) * (x - t.x[i - 1]) / (t.x[i] - t.x[i - 1]);
    return v.back();
  }
  double of_tables(double x, bool up) const {
    double sum = 0.0;
    for (const Table& t : tables) sum += at(t, x, up);
    return sum;
  }
  double added(double x, bool up, double present) const {
    double c = of_tables(x, up);
    for (int i = 0; of_reading && i < 5; ++i) c = of_tables(x + c, up);
    const double half = backlash.value_or(present) / 2.0;  // which half is homing's: a constant
    return c + (up ? half : -half);
  }
};

struct Axis {
  int number = 1;
  std::string name = "X";
  bool rotary = false;
  double reference = 0.0;
  double unit() const { return rotary ? deg : mm; }
};

using Files = std::vector<nonio::Artifact>;

inline double number(const std::string& text) {
  double v = NAN;
  const char* from = text.data() + (text.front() == '+' ? 1 : 0);
  std::from_chars(from, text.data() + text.size(), v);
  return v;
}

inline std::string all(const Files& files, const std::string& ending) {
  std::string out;
  for (const auto& f : files)
    if (f.name.size() >= ending.size() &&
        f.name.compare(f.name.size() - ending.size(), ending.size(), ending) == 0)
      out += f.bytes;
  return out;
}

/// Every match's groups.
inline std::vector<std::vector<std::string>> found(const std::string& text, const char* pattern) {
  std::vector<std::vector<std::string>> out;
  const std::regex regex(pattern);
  for (std::sregex_iterator i(text.begin(), text.end(), regex), end; i != end; ++i) {
    std::vector<std::string> groups;
    for (std::size_t k = 1; k < i->size(); ++k) groups.push_back((*i)[k]);
    out.push_back(std::move(groups));
  }
  return out;
}

/// The number of the first match.
inline std::optional<double> one(const std::string& text, const std::string& pattern) {
  const auto f = found(text, pattern.c_str());
  return f.empty() ? std::nullopt : std::optional(number(f[0].back()));
}

/// Columns of numbers that are not behind a mark.
inline std::vector<std::vector<double>> rows(const std::string& text) {
  std::vector<std::vector<double>> out;
  for (const std::string& line : workshop::lines(text)) {
    if (line.empty() || line[0] == '#' || line[0] == ';' || line[0] == '/') continue;
    std::vector<double> row;
    for (const auto& w : found(line, "([-+0-9.]+)")) row.push_back(number(w[0]));
    out.push_back(std::move(row));
  }
  return out;
}

/// The number of the first match in this unit.
inline std::optional<double> one(const std::string& text, const std::string& pattern, double unit) {
  const auto v = one(text, pattern);
  return v ? std::optional(*v * unit) : std::nullopt;
}

inline Control one_table(Control::Table t) {
  if (t.minus.empty()) t.minus = t.plus;
  Control c;
  c.tables.push_back(std::move(t));
  return c;
}

/// Nominal, and for each direction the actual position (type 0) or what is added (type 1).
inline Control linuxcnc(const Files& files, const Axis& a, bool type_1) {
  Control::Table t;
  for (const auto& r : rows(all(files, ".comp"))) {
    t.x.push_back(r.at(0) * a.unit());
    t.plus.push_back((type_1 ? r.at(1) : r.at(0) - r.at(1)) * a.unit());
    t.minus.push_back((type_1 ? r.at(2) : r.at(0) - r.at(2)) * a.unit());
  }
  Control c = one_table(t);
  c.backlash = 0.0;  // BACKLASH has no effect if there is a table
  return c;
}

/// A positive entry drives towards minus; MD32450 positive for lost motion.
inline Control siemens(const Files& files, const Axis& a) {
  const std::string text = all(files, ".ini"), ax = "AX" + std::to_string(a.number);
  Control::Table t;
  const double min = one(text, "ENC_COMP_MIN\\[0," + ax + "\\]=(.*)").value_or(NAN),
               step = one(text, "ENC_COMP_STEP\\[0," + ax + "\\]=(.*)").value_or(NAN);
  const std::string pattern = "ENC_COMP\\[0,(\\d+)," + ax + "\\]=(.*)";
  for (const auto& f : found(text, pattern.c_str())) {
    t.x.push_back((min + step * number(f[0])) * a.unit());
    t.plus.push_back(-number(f[1]) * a.unit());
  }
  t.repeats = one(text, "IS_MODULO\\[0," + ax + "\\]=(.*)") == 1.0;
  Control c = one_table(t);
  c.backlash = one(text, "BACKLASH\\[0," + ax + "\\]=(.*)", a.unit());
  return c;
}

/// Columns by their headings; the error is taken off.
inline Control heidenhain(const Files& files, const Axis& a) {
  Control::Table t;
  const auto text = workshop::lines(all(files, "-" + a.name + ".COM"));
  const std::size_t x = text.at(1).find("AXISPOS"), v = text[1].find(" " + a.name) + 1;
  for (std::size_t i = 2; i < text.size() && text[i] != "[END]"; ++i) {
    t.x.push_back(number(text[i].substr(x, text[i].find(' ', x) - x)) * a.unit());
    t.plus.push_back(-number(text[i].substr(v, text[i].find(' ', v) - v)) * a.unit());
  }
  t.repeats = a.rotary && t.x.front() == 0.0;
  Control c = one_table(t);
  c.backlash = one(all(files, ".txt"), "backLash = (\\S+)", a.unit());
  return c;
}

/// Number n is the change of the compensation over the interval that ends n - 3620 intervals from
/// the reference position; units of 1 um, 0.001 deg.
inline Control fanuc(const Files& files, const Axis& a) {
  const std::string text = all(files, ".prm");
  const double unit = a.rotary ? 1e-3 * deg : um;
  const auto parameter = [&](int n) {
    const auto v = one(text, "N" + std::to_string(n) + "A" + std::to_string(a.number) + "P(.*)");
    return v ? std::optional<int>(static_cast<int>(*v)) : std::nullopt;
  };
  const int reference = *parameter(3620), low = *parameter(3621), high = *parameter(3622);
  std::map<int, double> change;
  for (const auto& f : found(text, "N1(\\d{4})P(.*)"))
    change[static_cast<int>(number(f[0]))] = number(f[1]);
  std::map<int, double> value{{0, 0.0}};  // intervals from the reference
  for (int n = reference + 1; n <= high; ++n)
    value[n - reference] = value[n - reference - 1] + change.at(n);
  for (int n = reference; n >= low && !parameter(3625); --n)
    value[n - reference - 1] = value[n - reference] - change.at(n);
  Control::Table t;
  const double from = parameter(3625) ? 0.0 : a.reference;
  for (const auto& [k, v] : value) {
    t.x.push_back(from + k * *parameter(3624) * unit);
    t.plus.push_back(v * *parameter(3623) * unit);
  }
  t.repeats = parameter(3625).has_value();
  Control c = one_table(t);
  if (const auto lost = parameter(1851)) c.backlash = *lost * unit;
  return c;
}

/// actual - setpoint in 0.1 um, 0.0001 deg; P-AXIS-00103 too.
inline Control twincat_cnc(const Files& files, const Axis& a) {
  const std::string text = all(files, ".lis");
  const double unit = a.rotary ? 1e-4 * deg : 1e-7;
  Control::Table t;
  const double start = *one(text, "kw_startpos +(\\S+)"), step = *one(text, "interval +(\\S+)");
  for (const auto& f : found(text, "table\\[(\\d+)\\].pos +(\\S+)")) {
    t.x.push_back((start + step * number(f[0])) * unit);
    t.plus.push_back(-number(f[1]) * unit);
  }
  t.repeats = one(text, "modulo +(\\S+)") == 1.0;
  Control c = one_table(t);
  c.backlash = one(text, "getriebe\\[0\\]\\.lose = (-?\\d+) ", unit);
  return c;
}

inline Control twincat_nc_ptp(const Files& files, const Axis& a) {
  const std::string text = all(files, ".st");
  Control::Table t;
  for (const auto& f : found(text, "Position := (\\S+), Compensation := ([-0-9.]+)")) {
    t.x.push_back(number(f[0]) * a.unit());
    t.plus.push_back(number(f[1]) * a.unit());
  }
  t.repeats = text.find("Modulo := TRUE") != std::string::npos;
  Control c = one_table(t);
  c.backlash = one(text, "Backlash = (\\S+) ", a.unit());
  return c;
}

/// Lists of point, position, entry: `sign` -1 where an entry is the error.
inline Control list(const Files& files, const Axis& a, double sign, double unit) {
  Control::Table t;
  for (const auto& r : rows(all(files, ".txt"))) {
    t.x.push_back(r.at(1) * unit);
    t.plus.push_back(sign * r.at(2) * unit);
  }
  t.repeats = a.rotary && t.x.front() == 0.0 && std::fabs(t.x.back() - 360 * deg) < 1e-9;
  return one_table(t);
}

/// The first entry is at machine zero, the following ones every half inch towards minus.
inline Control haas(const Files& files, const Axis&) {
  constexpr double inch = 25.4 * mm;
  std::map<double, double> at;
  for (const auto& r : rows(all(files, ".txt"))) at[-(r.at(0) - 1.0) * inch / 2.0] = r.at(2) * inch;
  Control::Table t;
  for (const auto& [x, v] : at) {
    t.x.push_back(x);
    t.plus.push_back(v);
  }
  return one_table(t);
}

/// (division interval - way moved) x 2 in um, from the reference position to both sides.
inline Control mitsubishi(const Files& files, const Axis& a) {
  std::map<int, double> number_of, value{{0, 0.0}};
  double step = 0.0;
  for (const auto& r : rows(all(files, ".txt"))) {
    number_of[static_cast<int>(r.at(0))] = r.at(2);
    step = r.at(1) * mm;
  }
  for (int k = 1; number_of.count(k) != 0; ++k) value[k] = value[k - 1] + number_of[k];
  for (int k = -1; number_of.count(k) != 0; --k) value[k] = value[k + 1] - number_of[k];
  Control::Table t;
  for (const auto& [k, v] : value) {
    t.x.push_back(a.reference + k * step);
    t.plus.push_back(v * 0.5 * um);
  }
  return one_table(t);
}

/// 1/16 count at 1, 2, ... spacings from motor zero; it rolls over.
inline Control pmac(const Files& files, const Axis& a, double counts) {
  const std::string text = all(files, ".pmc");
  const auto head = found(text, "#(\\d+) DEFINE COMP (\\d+),(\\d+)").at(0);
  const double count = a.unit() / counts, n = number(head[1]);
  Control::Table t;
  t.x.push_back(0.0), t.plus.push_back(0.0);
  const auto values = found(text.substr(text.find('\n')), "(-?\\d+)");
  for (std::size_t k = 1; k <= values.size(); ++k) {
    t.x.push_back(static_cast<double>(k) * number(head[2]) / n * count);
    t.plus.push_back(number(values[k - 1][0]) / 16.0 * count);
  }
  t.repeats = true;
  Control c = one_table(t);
  c.backlash = one(all(files, ".txt"), "Ix86 in 1/16 count: (\\S+)", count / 16.0);
  return c;
}

/// Corrections from home at SAMPLEDIST, all tables added, the nearest end beyond.
inline Control aerotech(const Files& files, const Axis& a) {
  Control c;
  double step = 0.0;
  for (const std::string& line : workshop::lines(all(files, ".cal"))) {
    if (line.empty() || line[0] == ';') continue;
    if (const auto s = one(line, "SAMPLEDIST=(\\S+)")) {
      step = *s;
      c.tables.emplace_back();
    } else if (line[0] != ':') {
      auto& t = c.tables.back();
      const auto k = static_cast<double>(t.x.size());
      const auto place = step > 0.0 ? t.x.end() : t.x.begin();
      const auto value = step > 0.0 ? t.plus.end() : t.plus.begin();
      t.x.insert(place, k * step * a.unit());
      t.plus.insert(value, number(line) * a.unit());
    }
  }
  for (auto& t : c.tables) t.minus = t.plus;
  return c;
}

/// The value is taken off the reading.
inline Control ecmc(const Files& files, const Axis& a) {
  Control::Table t;
  for (const auto& r : rows(all(files, ".corr"))) {
    t.x.push_back(r.at(0) * a.unit());
    t.plus.push_back(r.at(1) * a.unit());
  }
  t.repeats = all(files, ".yaml").find("range: 360") != std::string::npos;
  Control c = one_table(t);
  c.of_reading = true;
  return c;
}

inline Control volumetric(const Files& files, const Axis& a) {
  Control::Table t;
  for (const auto& r : rows(all(files, ".csv"))) {
    if (r.size() != 2) continue;  // the names
    t.x.push_back(r[0] * a.unit());
    t.plus.push_back(-r[1] * a.unit());
  }
  return one_table(t);
}

}  // namespace models
