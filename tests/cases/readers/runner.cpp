// SPDX-License-Identifier: Apache-2.0
// Usage: nonio_reader_cases [--data FOLDER] FILE...
// Exit status 0: all hold; 1: some do not; 2: a file cannot be read; 77: a real file is not there.
#include <cmath>
#include <iostream>
#include <limits>
#include <sstream>

#include "case.h"
#include "readers.h"

namespace {

using nonio::Expected;
using nonio::Observations;
using nonio::Reader;
using nonio::Setting;
using reader_cases::Case;

/// An option as the declared kind: lists are divided by "|".
Setting setting_of(const Setting& declared, const std::string& text) {
  if (std::holds_alternative<bool>(declared)) return text == "true";
  if (std::holds_alternative<std::int64_t>(declared)) return std::int64_t{std::stoll(text)};
  if (std::holds_alternative<double>(declared)) return std::stod(text);
  if (std::holds_alternative<std::string>(declared)) return text;
  std::vector<std::string> list;
  std::istringstream in(text);
  for (std::string one; std::getline(in, one, '|');) list.push_back(one);
  return list;
}

struct Run {
  nonio::Campaign campaign;
  nonio::Measurement measurement;
  nonio::Settings options;

  Run(const Case& c, const Reader& reader) {
    nonio::Axis axis;
    axis.name = c.axis;
    axis.rotary = c.rotary;
    if (c.expansion > 0.0) axis.expansion = c.expansion * 1e-6;
    axis.slave = c.slave;
    campaign.machine.axes.push_back(axis);
    campaign.machine.serial = c.serial;
    campaign.date = c.date;
    measurement.side = c.side;
    if (!c.other_axis.empty()) {
      nonio::Axis other;
      other.name = c.other_axis;
      other.rotary = std::string_view("ABC").find(other.name.front()) != std::string_view::npos;
      campaign.machine.axes.push_back(other);
    }
    measurement.id = "m";
    measurement.kind = c.kind;
    measurement.axis = c.axis;
    measurement.file = "m.txt";
    for (const nonio::Option& o : reader.info.options) {
      const auto given = c.options.find(o.name);
      options.values[o.name] =
          given == c.options.end() ? o.default_value : setting_of(o.default_value, given->second);
    }
    for (const auto& [name, text] : c.options)
      if (!options.has(name)) std::cerr << c.name << ": no option " << name << "\n";
  }
};

struct Checker {
  const Case& c;
  const Reader& reader;
  const Expected<Observations>& read;
  std::string complaint{};

  bool say(const std::string& wanted_and_found) {
    complaint = wanted_and_found;
    return false;
  }

  bool near(double wanted, double found, double tolerance) {
    if (std::fabs(wanted - found) <= tolerance) return true;
    return say("expected " + std::to_string(wanted) + ", found " + std::to_string(found));
  }

  /// error WORDS [line N]
  bool error(std::string rest) {
    if (read) return say("expected an error, found readings");
    std::uint64_t line = 0;
    if (const std::size_t at = rest.rfind(" line "); at != rest.npos) {
      line = std::stoull(rest.substr(at + 6));
      rest.resize(at);
    }
    const nonio::Error& e = read.error();
    if (e.message.find(rest) == e.message.npos) return say("expected words, found: " + e.message);
    if (line != 0 && e.line != line)
      return say("expected line " + std::to_string(line) + ", found " + std::to_string(e.line) +
                 ": " + e.message);
    if (line != 0 && e.file != "m.txt") return say("expected the file's name in the error");
    return true;
  }

  /// RUN DIRECTION TARGET VALUE [line N] [u U], in mm and um or deg and arcsec
  bool reading(std::istringstream& in) {
    const Observations& o = *read;
    std::uint32_t run = 0;
    char direction = 0;
    double target = 0.0, value = 0.0, u = -1.0;
    std::uint32_t line = 0;
    in >> run >> direction >> target >> value;
    for (std::string word; in >> word;) {
      if (word == "line") in >> line;
      if (word == "u") in >> u;
    }
    const auto p = nonio::unit_of(nonio::position_of(o.axes[0].rotary)).per_si;
    const auto d = nonio::unit_of(nonio::deviation_of(o.angular)).per_si;
    for (std::size_t i = 0; i < o.size(); ++i) {
      if (o.run[i] != run || o.axes[0].approach[i] != (direction == '+' ? 1 : -1) ||
          std::fabs(o.axes[0].position[i] * p - target) > 1e-9)
        continue;
      if (line != 0 && o.source_line[i] != line)
        return say("expected line " + std::to_string(line) + ", found " +
                   std::to_string(o.source_line[i]));
      if (u >= 0.0 && !near(u, o.u[i] * d, 1e-6)) return false;
      return near(value, o.deviation[i] * d, 1e-6);
    }
    return say("no such reading");
  }

  /// centre RUN ANGLE X Y Z [at AXIS ANGLE], mm and deg: AXIS turned too
  bool centre(std::istringstream& in) {
    const Observations& o = *read;
    std::uint32_t run = 0;
    double angle = 0.0, tolerance = 1e-6;
    double xyz[3] = {};
    in >> run >> angle >> xyz[0] >> xyz[1] >> xyz[2];
    std::string other;
    double other_angle = 0.0;
    for (std::string word; in >> word;) {
      if (word == "tolerance") in >> tolerance;
      if (word == "at") in >> other >> other_angle;
    }
    const auto* also = other.empty() ? nullptr : o.axis(other);
    if (!other.empty() && also == nullptr) return say("expected axis " + other + ", found none");
    const auto stands = [&](const auto& axis, std::size_t i, double where) {
      return std::fabs(axis.position[i] * nonio::deg_per_rad - where) < 1e-9;
    };
    int seen = 0;
    for (std::size_t i = 0; i < o.size(); ++i) {
      if (o.run[i] != run || !stands(o.axes[0], i, angle)) continue;
      if (also != nullptr && !stands(*also, i, other_angle)) continue;
      const auto& sense = o.sense_of(i);
      for (std::size_t k = 0; k < 3; ++k)
        if (sense[k] == 1.0) {
          if (!near(xyz[k], o.deviation[i] * 1e3, tolerance)) return false;
          ++seen;
        }
    }
    return seen == 3 ||
           say("expected a centre of three coordinates, found " + std::to_string(seen));
  }

  /// note ID [NAME VALUE], the value as it is printed (texts: as they are); doubt likewise
  template <class Said>
  bool said(const std::vector<Said>& all, std::istringstream& in) {
    std::string id, name, wanted;
    in >> id >> name;
    std::getline(in >> std::ws, wanted);
    std::string known;
    for (const Said& r : all) {
      known += " " + r.id;
      if (r.id != id) continue;
      if (name.empty()) return true;
      for (const auto& [key, text] : r.texts) {
        if (key == name && text == wanted) return true;
        if (key == name) known += "(" + text + ")";
      }
      for (const nonio::Number& n : r.evidence) {
        if (n.name == name && nonio::evidence_text(n) == wanted) return true;
        if (n.name == name) known += "(" + nonio::evidence_text(n) + ")";
      }
    }
    return say("expected " + id + ", found" + known);
  }

  bool holds(const std::string& text) {
    std::istringstream in(text);
    std::string word;
    in >> word;
    if (word == "recognised") return reader.recognises(c.bytes) || say("not recognised");
    if (word == "not-recognised") return !reader.recognises(c.bytes) || say("recognised");
    if (word == "error") return error(text.substr(6));
    if (!read) return say("error: " + read.error().message);
    if (word == "note") return said(read->notes, in);
    if (word == "no-note") return !said(read->notes, in) || say("expected no such note");
    if (word == "doubt") return said(read->doubts, in);
    if (word == "no-doubts") return read->doubts.empty() || say("found " + read->doubts.front().id);
    if (word == "reading") return reading(in);
    if (word == "centre") return centre(in);
    double value = 0.0, tolerance = 1e-9;
    in >> value;
    if (std::string more; in >> more && more == "tolerance") in >> tolerance;
    const auto scale = nonio::unit_of(nonio::deviation_of(read->angular)).per_si;
    if (word == "readings") return near(value, static_cast<double>(read->size()), 0.0);
    if (word == "missing") return near(value, static_cast<double>(read->missing), 0.0);
    if (word == "material-start") return near(value, read->material.front(), tolerance);
    if (word == "material-end") return near(value, read->material.back(), tolerance);
    double sum = 0.0, low = INFINITY, high = -INFINITY;
    for (const double d : read->deviation) {
      sum += d;
      low = std::min(low, d);
      high = std::max(high, d);
    }
    if (word == "mean")
      return near(value, scale * sum / static_cast<double>(read->size()), tolerance);
    if (word == "max") return near(value, scale * high, tolerance);
    if (word == "min") return near(value, scale * low, tolerance);
    if (word == "slope_um_per_m") {
      const auto line = nonio::readers::straight_through(read->axes[0].position, read->deviation);
      return near(value, 1e6 * line.slope, tolerance);
    }
    return say("unknown expectation");
  }
};

int failures_of(const Case& c) {
  const Reader* reader = nullptr;
  for (const Reader& r : reader_cases::readers())
    if (r.info.name == c.reader) reader = &r;
  if (reader == nullptr) {
    std::cout << c.name << ": no reader " << c.reader << "\n";
    return 1;
  }
  const Run run(c, *reader);
  const auto read = reader->read({c.bytes, run.campaign, run.measurement, run.options, {}});
  int failures = c.expectations.empty() ? 1 : 0;
  if (failures != 0) std::cout << c.name << ": nothing is expected\n";
  for (const Case::Line& e : c.expectations) {
    Checker checker{c, *reader, read};
    if (checker.holds(e.text)) continue;
    std::cout << c.name << ", line " << e.number << ": " << e.text << ": " << checker.complaint
              << "\n";
    ++failures;
  }
  return failures;
}

}  // namespace

int main(int argc, char** argv) {
  std::filesystem::path data;
  int failures = 0, cases = 0, missing = 0;
  for (int i = 1; i < argc; ++i) {
    if (std::string(argv[i]) == "--data" && i + 1 < argc) {
      data = argv[++i];
      continue;
    }
    std::string error;
    int absent = 0;
    for (const Case& c : reader_cases::read_cases(argv[i], data, error, absent)) {
      failures += failures_of(c);
      ++cases;
    }
    missing += absent;
    if (!error.empty()) {
      std::cout << error << "\n";
      return 2;
    }
  }
  std::cout << cases << " cases, " << failures << " expected something else";
  if (missing > 0) std::cout << ", " << missing << " skipped: no real file in " << data.string();
  std::cout << "\n";
  if (failures > 0) return 1;
  return cases == 0 ? 77 : 0;
}
