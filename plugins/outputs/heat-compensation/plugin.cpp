// SPDX-License-Identifier: Apache-2.0
// The model of displacements over time as the thermal compensation of a control.
#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "law.h"
#include "nonio/sdk/format.h"

namespace nonio::heat_compensation {

namespace {

/// Files of a compensation law for each control; README.md states the sources.
struct Format {
  const char* name;  ///< choice of option `control`
  const char* note;  ///< id of the remark about inferred facts, or null
  /// Returns the id of the finding that refuses the law, or an empty text.
  std::string (*refusal)(const Law&);
  std::vector<Artifact> (*files)(const OutputInput&, const Law&);
};

std::string lower(std::string s) {
  for (char& c : s) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return s;
}

std::string mm(double m) { return fixed_text(1e3 * m, 9); }
std::string um(double m) { return fixed_text(1e6 * m, 2); }

std::vector<std::string> heading(const OutputInput& in, const Law& law) {
  std::string effects;
  for (const std::string& effect : law.effects) effects += (effects.empty() ? "" : ", ") + effect;
  std::vector<std::string> out{
      "Nonio: compensation of heat for " + plain(law.axis) + " of " + in.campaign.id +
          (law.of_runs ? ", runs of the axis" : ", displacement " + law.displacement),
      "model: " + effects,
      std::string("RMS of the ") + (law.of_runs ? "deviations" : "displacement") +
          " in this test: " + um(law.before) + " um, with the compensation " + um(law.after) +
          " um"};
  const auto fixed = [](const Term& term) { return term.zero.has_value(); };
  for (const Term& term : law.terms)
    if (term.zero)
      out.push_back("Zero of " + term.channels.front() + " is " + fixed_text(*term.zero, 3) +
                    " degC, the mean of this test, as for tables of the same model.");
  if (!std::all_of(law.terms.begin(), law.terms.end(), fixed))
    out.emplace_back(
        "Zero is the state in which the compensation begins: begin it where the machine is "
        "zeroed.");
  for (const std::string& effect : law.left_out)
    out.push_back("not compensated, it follows no recorded channel: " + effect);
  return out;
}

std::string comment(const std::vector<std::string>& lines, const std::string& before,
                    const std::string& after = "") {
  std::string out;
  for (std::string line : lines) {
    for (char& c : line)
      if (c == '\n' || c == '\r' || c == '*') c = ' ';
    out += before + line + after + "\n";
  }
  return out;
}

std::string file_of(const Law& law, const char* control, const char* ending) {
  return std::string("heat-") + control + "-" + plain(law.axis) + ending;
}

std::string anything(const Law&) { return ""; }

bool grows(const Law& law) {
  return std::any_of(law.terms.begin(), law.terms.end(),
                     [](const Term& term) { return term.growth != 0.0; });
}

std::string one_value(const Law& law) { return grows(law) ? "heat-compensation.position" : ""; }

std::string signal_of(const Law& law, const std::string& channel) {
  for (const auto& c : law.channels)
    if (c.name == channel)
      return "heat-" + lower(plain(channel)) + (c.is_temperature() ? "-c" : "");
  return "";
}

class Hal {
 public:
  Hal(const Law& law, double period) : law_(law), period_(period), axis_(lower(plain(law.axis))) {}

  std::string text() {
    std::string sum;
    for (std::size_t i = 0; i < law_.terms.size(); ++i) sum = one(law_.terms[i], i, sum);
    const std::string counts = component("scale", "counts"),
                      whole = component("conv_float_s32", "s32");
    set(counts + ".gain", fixed_text(1.0 / 1e-4, 0));
    net("sum", sum + " => " + counts + ".in");
    net("counts", counts + ".out => " + whole + ".in");
    net("offset", whole + ".out => axis." + axis_ + ".eoffset-counts");
    set("axis." + axis_ + ".eoffset-scale", "0.0001");
    set("axis." + axis_ + ".eoffset-enable", "1");
    std::string out;
    for (const char* kind : {"abs", "mult2", "scale", "lowpass", "sum2", "conv_float_s32"}) {
      std::string names;
      for (const auto& [of, name] : components_)
        if (of == kind) names += (names.empty() ? "" : ",") + name;
      if (!names.empty()) out += std::string("loadrt ") + kind + " names=" + names + "\n";
    }
    for (const auto& [of, name] : components_) out += "addf " + name + " servo-thread\n";
    return out + lines_;
  }

 private:
  std::string component(const char* kind, const std::string& part) {
    components_.emplace_back(kind, "heat-" + axis_ + "-" + part);
    return components_.back().second;
  }
  void set(const std::string& pin, const std::string& value) {
    lines_ += "setp " + pin + " " + value + "\n";
  }
  void net(const std::string& name, const std::string& pins) {
    lines_ += "net heat-" + axis_ + "-" + name + " " + pins + "\n";
  }
  void from_channel(const std::string& channel, const std::string& pin) {
    lines_ += "net " + signal_of(law_, channel) + " => " + pin + "\n";
  }

  std::string lagged(const Term& term, std::size_t channel, const std::string& id) {
    std::string from;
    if (term.kind == Term::Kind::source) {
      const std::string size = component("abs", id + "-abs"),
                        part = component("scale", id + "-part");
      from_channel(term.channels[channel], size + ".in");
      set(part + ".gain", short_text(1.0 / term.largest, 12));
      net(id + "-size", size + ".out => " + part + ".in");
      from = part + ".out";
      if (term.power == 2) {
        const std::string square = component("mult2", id + "-square");
        net(id + "-part", from + " => " + square + ".in0 " + square + ".in1");
        from = square + ".out";
      }
    }
    const std::string lag = component("lowpass", id);
    if (from.empty())
      from_channel(term.channels[channel], lag + ".in");
    else
      net(id + "-in", from + " => " + lag + ".in");
    set(lag + ".gain", short_text(term.tau > period_ ? -std::expm1(-period_ / term.tau) : 1.0, 12));
    lines_ += "net heat-" + axis_ + "-start => " + lag + ".load\n";
    return lag + ".out";
  }

  std::string one(const Term& term, std::size_t i, const std::string& sum) {
    const std::string id = std::to_string(i + 1);
    const std::string first = lagged(term, 0, id + "a");
    const std::string second =
        term.kind == Term::Kind::difference ? lagged(term, 1, id + "b") : std::string();
    std::string out = sum;
    for (const auto& [pin, sign] : {std::pair(first, -1.0), std::pair(second, 1.0)}) {
      if (pin.empty()) continue;
      const std::string part = id + (sign < 0.0 ? "a-mm" : "b-mm");
      const std::string add = component("sum2", part);
      set(add + ".gain0", "1");
      set(add + ".gain1", mm(sign * term.gain));
      if (!out.empty()) net(part + "-before", out + " => " + add + ".in0");
      net(part + "-in", pin + " => " + add + ".in1");
      out = add + ".out";
    }
    return out;
  }

  const Law& law_;
  double period_;
  std::string axis_, lines_;
  std::vector<std::pair<std::string, std::string>> components_;
};

std::vector<Artifact> linuxcnc(const OutputInput& in, const Law& law) {
  const double period = in.options.number("period_s", 0.001);
  std::vector<std::string> lines = heading(in, law);
  lines.push_back(
      "for a servo-thread of " + fixed_text(1e3 * period, 3) +
      " ms (option period_s) and LINEAR_UNITS = mm; run it after the motion module is loaded");
  lines.emplace_back("connect the sensors, in degC and as recorded, to:");
  for (const auto& c : law.channels)
    lines.push_back("  net " + signal_of(law, c.name) + " <= (the pin of " + c.name + ", " +
                    c.unit + ")");
  lines.push_back("set heat-" + lower(plain(law.axis)) +
                  "-start once when the sensors read and before the axis is homed: sets heat-" +
                  lower(plain(law.axis)) + "-start 1, then 0");
  lines.emplace_back("the axis needs OFFSET_AV_RATIO in its section of the INI file");
  lines.emplace_back(
      "external offsets count from the moment when the machine is on and homed: what heat does "
      "while "
      "it is off is not compensated; home again then");
  const std::string start = "newsig heat-" + lower(plain(law.axis)) + "-start bit\n";
  return {
      {file_of(law, "linuxcnc", ".hal"), comment(lines, "# ") + start + Hal(law, period).text()}};
}

std::string one_sensor_of_z(const Law& law) {
  if (law.axis != "Z") return "heat-compensation.only-z";
  if (grows(law)) return one_value(law);
  const bool one = law.terms.size() == 1 && law.terms[0].kind == Term::Kind::temperature;
  return one ? "" : "heat-compensation.one-sensor";
}

std::vector<Artifact> klipper(const OutputInput& in, const Law& law) {
  const Term& term = law.terms.front();
  std::vector<std::string> lines = heading(in, law);
  lines.push_back("sensor: " + term.channels[0] +
                  "; add its sensor_type, sensor_pin, min_temp and "
                  "max_temp to this section");
  lines.emplace_back(
      "the firmware takes the temperature at the end of homing Z as reference, and smooths "
      "from 0 degC when it starts: wait five times smooth_time before homing");
  return {{file_of(law, "klipper", ".cfg"),
           comment(lines, "# ") + "[z_thermal_adjust]\ntemp_coeff: " + mm(term.gain) +
               "\nsmooth_time: " + fixed_text(std::max(term.tau, 1.0), 1) + "\n"}};
}

struct Dialect {
  const char *number, *result;
  double sign;          ///< sign of the result relative to the error
  bool takes_position;  ///< whether the result has the growth in it; otherwise it is `slope`
};

/// Cycle time, s: a fiftieth of the shortest lag, from 0.1 s to 10 s, so that single precision is
/// sufficient.
double step_of(const Law& law) {
  double step = 10.0;
  for (const Term& term : law.terms)
    if (term.tau > 0.0) step = std::min(step, term.tau / 50.0);
  return std::max(step, 0.1);
}

std::string variable(const std::string& channel) { return "in_" + plain(channel); }

std::string input_of(const Term& term, std::size_t channel) {
  const std::string name = variable(term.channels[channel]);
  if (term.kind != Term::Kind::source) return name;
  const std::string part = "ABS(" + name + ") / " + fixed_text(term.largest, 6);
  return term.power == 2 ? "(" + part + ") * (" + part + ")" : part;
}

std::string block(const OutputInput& in, const Law& law, const std::string& name,
                  const Dialect& d) {
  std::string inputs, states, begin, step, at_once, sum, slope;
  for (const auto& c : law.channels)
    inputs += "  " + variable(c.name) + " : " + d.number + ";  (* " + c.unit + " *)\n";
  std::size_t n = 0;
  for (const Term& term : law.terms)
    for (std::size_t k = 0; k < term.channels.size(); ++k) {
      const std::string id = std::to_string(++n), x = input_of(term, k), y = "y" + id, r = "r" + id;
      states += "  " + y + " : " + d.number + ";\n  " + r + " : " + d.number + ";\n";
      begin += "  " + y + " := " + x + ";\n  " + r +
               " := " + (term.zero ? fixed_text(*term.zero, 3) : y) + ";\n";
      if (term.tau > 0.0)
        step += "  " + y + " := " + y + " + (" + x + " - " + y + ") * (1.0 - EXP(-elapsed / " +
                fixed_text(term.tau, 3) + "));\n";
      else
        at_once += y + " := " + x + ";\n";
      const std::string change = " * (" + y + " - " + r + ")";
      const double gain = d.sign * (k == 0 ? term.gain : -term.gain);
      sum += (sum.empty() ? "(" : " + (") + mm(gain) + ")" + change;
      if (term.growth != 0.0)
        slope +=
            (slope.empty() ? "(" : " + (") + fixed_text(d.sign * term.growth, 12) + ")" + change;
    }
  const std::string of = d.number;
  std::string slopes;
  if (!slope.empty() && d.takes_position) {
    inputs += "  position : " + of + ";  (* mm *)\n";
    sum += " + (" + slope + ") * (position - (" + mm(law.reference) + "))";
    slope.clear();
  } else if (!slope.empty()) {
    slopes = "  slope : " + of + ";  (* mm/mm *)\n";
    slope = "slope := " + slope + ";\n";
  }
  return comment(heading(in, law), "(* ", " *)") + "FUNCTION_BLOCK " + name +
         "\nVAR_INPUT\n  dt : " + of +
         ";  (* s since the last call *)\n  reset : BOOL;  (* TRUE: begin from this state *)\n" +
         inputs + "END_VAR\nVAR_OUTPUT\n  " + d.result + " : " + of + ";  (* mm *)\n" + slopes +
         "END_VAR\nVAR\n  started : BOOL;\n" + "  elapsed : " + of + ";\n" + states + "END_VAR\n" +
         "IF NOT started OR reset THEN\n" + begin +
         "  elapsed := 0.0;\n  started := TRUE;\nEND_IF;\nelapsed := elapsed + dt;\nIF elapsed "
         ">= " +
         fixed_text(step_of(law), 3) + " THEN\n" + step + "  elapsed := 0.0;\nEND_IF;\n" + at_once +
         d.result + " := " + sum + ";\n" + slope + "END_FUNCTION_BLOCK\n";
}

std::vector<Artifact> twincat(const OutputInput& in, const Law& law) {
  const std::string axis = plain(law.axis);
  const std::string position = grows(law) ? ", position := axis" + axis + ".NcToPlc.ActPos" : "";
  const std::vector<std::string> use{
      "use, with Position Correction enabled in the parameters of the axis:",
      "  heat" + axis + "(dt := cycle, reset := zeroing" + position + ", ...);",
      "  limiter" + axis + "(Axis := axis" + axis +
          ", Enable := TRUE, PositionCorrectionValue := heat" + axis +
          ".correction_mm, CorrectionMode := POSITIONCORRECTION_MODE_FAST, Acceleration := 1.0);",
      "limiter" + axis +
          ": MC_PositionCorrectionLimiter. It adds the value to the actual position, so that the "
          "axis moves against it: the value is the error itself.",
      "check the sign once: with PositionCorrectionValue 0.01 the axis must move by -0.01 mm"};
  return {{file_of(law, "twincat", ".st"),
           comment(use, "(* ", " *)") +
               block(in, law, "FB_Heat" + axis, {"LREAL", "correction_mm", 1.0, true})}};
}

std::vector<Artifact> siemens(const OutputInput& in, const Law& law) {
  const std::string axis = plain(law.axis);
  std::vector<std::string> lines = heading(in, law);
  lines.emplace_back("SD43900 is written by the PLC: offset_mm of the SCL block next to this file");
  lines.push_back("check the sign once: with SD43900 = 0.01 the axis must move by +0.01 mm");
  const bool slope = grows(law);
  if (slope) {
    lines.emplace_back("SD43910 is written by the PLC too: slope of the SCL block");
    lines.emplace_back("the axis adds SD43900 + SD43910 (P - SD43920), P in machine coordinates");
    lines.push_back(
        "check its sign once: with SD43900 = 0 and SD43910 = 0.00001 the axis must move "
        "by +0.001 mm at 100 mm beyond SD43920");
    lines.push_back("largest SD43910 in this test: " + fixed_text(law.largest_slope, 9) +
                    "; the control limits it without an alarm: MD32760 must permit it");
  }
  const std::string type = slope ? "]=3 ; MD32750, position-independent and position-dependent\n"
                                 : "]=1 ; MD32750, position-independent\n";
  const std::string data = "$MA_TEMP_COMP_TYPE[" + axis + type + "$SA_TEMP_COMP_ABS_VALUE[" + axis +
                           "]=0 ; SD43900, mm\n" + "$SA_TEMP_COMP_SLOPE[" + axis +
                           "]=0 ; SD43910\n" + "$SA_TEMP_COMP_REF_POSITION[" + axis +
                           "]=" + (slope ? mm(law.reference) : "0") + " ; SD43920, mm\n";
  return {{file_of(law, "siemens", ".ini"), comment(lines, "; ") + data + "M17\n"},
          {file_of(law, "siemens", ".scl"),
           block(in, law, "NonioHeat" + axis, {"REAL", "offset_mm", -1.0, false})}};
}

std::string not_documented(const Law&) { return "heat-compensation.not-documented"; }

const std::vector<Format>& formats() {
  static const std::vector<Format> all{
      {"linuxcnc", nullptr, one_value, linuxcnc},
      {"klipper", nullptr, one_sensor_of_z, klipper},
      {"siemens", "heat-compensation.sign-inferred", anything, siemens},
      {"twincat", "heat-compensation.sign-inferred", anything, twincat},
      {"heidenhain", nullptr, not_documented, nullptr}};
  return all;
}

Finding refusal(std::string id, const Format& format, const Law& law) {
  return {
      .id = std::move(id),
      .attention = true,
      .texts = {{"control", format.name}, {"axis", law.axis}, {"displacement", law.displacement}}};
}

void add(OutputResult& result, const OutputInput& in, const Format& format, const Law& law) {
  if (std::string id = format.refusal(law); !id.empty()) {
    result.findings.push_back(refusal(std::move(id), format, law));
    return;
  }
  if (!(law.after < law.before)) {
    Finding f = refusal("heat-compensation.no-gain", format, law);
    f.evidence = {{"before", law.before, Quantity::deviation},
                  {"after", law.after, Quantity::deviation}};
    result.findings.push_back(std::move(f));
    return;
  }
  for (Artifact& file : format.files(in, law)) result.artifacts.push_back(std::move(file));
  result.predictions.push_back(
      {law.measurement, law.displacement + " RMS", law.before, law.after, Quantity::deviation});
  result.notes.push_back({.id = "heat-compensation.predicted",
                          .evidence = {{"before", law.before, Quantity::deviation},
                                       {"after", law.after, Quantity::deviation}},
                          .texts = {{"displacement", law.displacement}, {"axis", law.axis}},
                          .measurement = law.measurement});
  for (const std::string& effect : law.left_out)
    result.notes.push_back({.id = effect.find('@') == std::string::npos
                                      ? "heat-compensation.left-out"
                                      : "heat-compensation.grouped",
                            .texts = {{"effect", effect}, {"displacement", law.displacement}},
                            .measurement = law.measurement});
}

Expected<OutputResult> write(const OutputInput& in) {
  const std::string control = in.options.text("control");
  OutputResult result;
  NONIO_TRY(auto all, laws(in, result.findings));
  if (all.empty() && result.findings.empty())
    result.findings.push_back({.id = "heat-compensation.no-model", .attention = true});
  for (const Format& format : formats()) {
    if (format.name != control) continue;
    for (const Law& law : all) add(result, in, format, law);
    if (format.note != nullptr && !result.artifacts.empty())
      result.notes.push_back({.id = format.note, .texts = {{"control", control}}});
  }
  return result;
}

std::vector<std::string> controls() {
  std::vector<std::string> out;
  for (const Format& format : formats()) out.emplace_back(format.name);
  return out;
}

}  // namespace

NONIO_PLUGIN(registry) {
  Output output;
  output.info = {
      "heat-compensation",
      "1.0.0",
      "The model of displacements over time as the thermal compensation of a control.",
      {{.name = "control",
        .default_value = std::string("linuxcnc"),
        .unit = "",
        .help = "The control that compensates.",
        .choices = controls()},
       {.name = "axes",
        .default_value = std::vector<std::string>{},
        .unit = "",
        .help = "Axis of each displacement, \"ch3 = Z\", or \"ch3 = -Z\" where the sensor counts "
                "against the axis; without it z, z1, ... are of Z."},
       {.name = "period_s",
        .default_value = 0.001,
        .unit = "s",
        .help = "Period of the thread that runs the filters (linuxcnc).",
        .min = 1e-5,
        .max = 1.0}},
      true};
  output.applies = [](const Campaign&) { return true; };
  output.write = write;
  registry.add(std::move(output));
}

}  // namespace nonio::heat_compensation
