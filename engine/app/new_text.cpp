// SPDX-License-Identifier: Apache-2.0
#include "new_text.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numbers>

#include "campaign/schema/schema.h"
#include "nonio/sdk/format.h"
#include "nonio/sdk/json.h"
#include "nonio/sdk/splitmix64.h"

namespace nonio::app {

namespace {

constexpr const char* example_mark = "EXAMPLE, NOT MEASURED";

std::string toml_string(const std::string& text) {
  std::string out = "\"";
  for (const char c : text) {
    if (c == '"' || c == '\\') out += '\\';
    out += c;
  }
  return out + "\"";
}

/// Without a text, the line is a TOML comment with `example`. `comment` starts in column 45 or
/// later.
std::string text_line(const std::string& key, const std::string& text, const std::string& example,
                      const std::string& comment = {}) {
  std::string line =
      (text.empty() ? "# " : "") + key + " = " + toml_string(text.empty() ? example : text);
  if (!comment.empty()) {
    line.resize(std::max<std::size_t>(line.size() + 1, 44), ' ');
    line += "# " + comment;
  }
  return line + "\n";
}

std::string offered(const std::string& table, const std::string& key, const std::string& example) {
  std::string help = schema::campaign_key_help(table + "." + key);
  if (help.empty()) help = schema::site_key_help(table + "." + key);
  return "# " + key + " = " + example + "  # " + help + "\n";
}

std::string test_text(const NewAxis& a) {
  const bool rotary = a.axis.rotary;
  const auto line = [](const char* key, const char* example) {
    return offered("measurement", key, example);
  };
  return line(rotary ? "feed_deg_per_min" : "feed_mm_per_min", "2000.0") + line("dwell_s", "3.0") +
         line(rotary ? "over_travel_deg" : "over_travel_mm", "1.0") +
         line("tool_offset", "{ Z = -120.0 }") + line("workpiece_offset", "{ Z = 200.0 }") +
         line("compensation", "\"off\"");
}

std::string certificate_text() {
  return "\n"
         "# Further statements of the certificate: docs/howto-certificate.md\n"
         "# [certificate]\n" +
         offered("certificate", "conditions", "\"No cutting for four hours before the test.\"") +
         offered("certificate", "customer_data", "[\"machine.serial\"]") +
         offered("certificate", "no_other_deviations_by", "\"B. Sample\"");
}

std::string marked(const std::string& text, bool example) {
  if (!example) return text;
  return text.empty() ? example_mark : text + " (" + example_mark + ")";
}

std::string axis_text(const NewAxis& a) {
  const Axis& axis = a.axis;
  const Quantity at = position_of(axis.rotary);
  std::string text = "\n[machine.axes." + axis.name + "]\nkind = \"" +
                     (axis.rotary ? "rotary" : "linear") + "\"\n";
  const auto number = [&](double si) { return json_number(printed(si, at)); };
  const std::string unit(unit_of(at).symbol);
  text += axis.travel
              ? "travel = [" + number(axis.travel->first) + ", " + number(axis.travel->second) + "]"
              : "# travel = [0, " + std::string(axis.rotary ? "360" : "1000") + "]";
  text += "  # " + unit + "; targets outside get a finding\n";
  text +=
      "# active_table = \"none\"  # table active in the control while measured: its file, or "
      "\"none\"\n"
      "# active_backlash_" +
      unit + " = \"none\"  # backlash value active then; without both no table is written\n";
  if (axis.rotary)
    return text +
           "# teeth = 180  # periods of the drive or scale per revolution\n"
           "# tolerance_arcsec = { A = 10.0, B = 6.0 }  # limits; each gets a decision (needs "
           "U, [instrument])\n";
  return text +
         "# screw_pitch_mm = 10.0  # period of the drive or scale\n"
         "# expansion_um_per_m_K = 11.5  # coefficient of expansion of the scale\n"
         "# tolerance_um = { A = 15.0, B = 6.0 }  # limits; each gets a decision (needs U, "
         "[instrument])\n";
}

std::string instrument_text(const NewCampaign& c) {
  std::string text =
      "\n"
      "# The instrument. With its uncertainty every value gets U, and every tolerance a "
      "decision.\n";
  const bool given = !c.instrument.empty();
  text += given ? "[instrument]\n" : "# [instrument]\n";
  text += text_line("model", c.instrument, "Laser interferometer");
  text +=
      "# maker = \"...\"\n"
      "# serial = \"...\"\n"
      "# calibrated = 2026-01-12\n"
      "# certificate = \"...\"  # of its calibration\n"
      "# U_fixed_um = 0.1  # expanded uncertainty, k = 2: fixed part\n"
      "# U_per_m_um = 0.5  # part per metre\n"
      "# U_arcsec = 0.5  # of angles\n";
  text += offered("instrument", "issuer", "\"LAT 000\"") +
          offered("instrument", "valid_until", "2027-01-12") +
          offered("instrument", "sphere_um", "0.5") + offered("instrument", "probe_um", "1.0");
  text += "\n# " + schema::campaign_key_help("sensor") + "\n# [[sensor]]\n" +
          offered("sensor", "measures", "\"material\"") + offered("sensor", "serial", "\"T-001\"") +
          offered("sensor", "calibrated", "2026-01-12") +
          offered("sensor", "certificate", "\"SO-2026-0009\"");
  text +=
      "\n"
      "# The environment: the other contributions to the uncertainty.\n"
      "# [environment]\n"
      "# misalignment_mm = 1.0  # largest lateral distance of beam and axis over the travel\n"
      "# temperature_range_K = 0.2  # range of the reading error of the machine's temperature\n"
      "# temperature_difference_K = 1.5  # largest difference from 20 degC\n"
      "# expansion_range_um_per_m_K = 1.0  # range of the coefficient of expansion\n"
      "# drift_um = 1.0  # range of the drift test with the axis at rest\n";
  return text + offered("environment", "warm_up", "\"30 min at half feed\"") +
         offered("environment", "sensors", "\"on the table and on the column\"");
}

/// Random numbers that are equal on every platform.
class Noise {
 public:
  explicit Noise(std::uint64_t seed) : numbers_(seed) {}
  /// Returns the scaled mean of three uniform numbers, from -1 to 1.
  double operator()() { return (even() + even() + even()) * 2.0 / 3.0 - 1.0; }

 private:
  double even() { return numbers_.uniform(); }
  SplitMix64 numbers_;
};

}  // namespace

bool NewCampaign::example() const {
  return std::any_of(axes.begin(), axes.end(), [](const NewAxis& a) { return a.example(); });
}

bool set_offered(std::string& text, const std::string& key, const std::string& value) {
  const std::size_t dot = key.rfind('.');
  if (dot == std::string::npos) return false;
  const std::string wanted = key.substr(0, dot), name = key.substr(dot + 1) + " = ";
  std::string out, table;
  std::size_t header = 0;
  bool found = false;
  for (std::size_t at = 0; at < text.size();) {
    const std::size_t end = std::min(text.find('\n', at), text.size() - 1) + 1;
    std::string line = text.substr(at, end - at);
    at = end;
    const std::string plain = line.starts_with("# ") ? line.substr(2) : line;
    if (plain.starts_with('[')) {
      header = out.size();
      const std::size_t begin = plain.find_first_not_of('[');
      table = plain.substr(begin, plain.find(']') - begin);
    } else if (table == wanted && plain.starts_with(name)) {
      const std::size_t comment = plain.find(" # ", name.size());
      line = name + (plain[name.size()] == '"' ? toml_string(value) : value) +
             (comment == std::string::npos ? "\n" : " " + plain.substr(comment));
      if (out.compare(header, 2, "# ") == 0) out.erase(header, 2);
      found = true;
    }
    out += line;
  }
  if (found) text = std::move(out);
  return found;
}

std::string site_text(const NewSite& site) {
  std::string text =
      "# Settings for every campaign of this site. A campaign is a folder below with a\n"
      "# campaign.toml. All keys: docs/site.md.\n\n"
      "# Printed in reports and certificates.\n"
      "[laboratory]\n";
  text += text_line("name", site.laboratory, "Sample Calibration Laboratory");
  text += text_line("address", site.address, "Via dell'Esempio 1, 10100 Torino");
  text += text_line("country", site.country, "IT", "two letters, ISO 3166");
  text += text_line("contact", "", "+39 011 000000", "telephone, e-mail");
  text += text_line("accreditation", "", "LAT 000", "number of the accreditation");
  text += text_line("authoriser", "", "B. Sample", "who authorises certificates");
  return text +
         "\n"
         "# Analyses and outputs for campaigns that do not select their own. Without this\n"
         "# section: all that apply. `nonio plugin list` lists them.\n"
         "# [run]\n"
         "# analyses = [\"iso230-2\", \"vdi-dgq-3441\"]\n"
         "# outputs = [\"pdf-report\", \"csv\"]\n\n"
         "# Options of one plugin, for all campaigns. `nonio plugin list NAME` lists them with "
         "their defaults.\n"
         "# [options.pdf-report]\n"
         "# language = \"it\"\n\n"
         "# Limits for one campaign; beyond them it fails. These are the defaults.\n"
         "[limits]\n"
         "seconds = 600\n"
         "memory_MB = 4096\n\n"
         "# Content and numbering of certificates: docs/howto-certificate.md\n"
         "# [certificate]\n"
         "# languages = [\"it\", \"en\"]\n"
         "# numbering = \"{year}-{number:4}\"\n" +
         offered("certificate", "release", "\"by-hand\"") +
         offered("certificate", "two_persons", "false") +
         "\n# The key that signs certificates: docs/howto-sign.md\n"
         "# [signing]\n"
         "# pkcs12 = \"key.p12\"\n"
         "# password_file = \"/etc/nonio/password\"\n"
         "# trust = \"root.pem\"  # root of signers and time servers\n";
}

std::string machine_text(const NewMachine& m) {
  std::string text =
      "# The record of this machine. Campaigns refer to it by asset in [machine].\n"
      "# All keys: docs/site.md.\n"
      "format = 1\n";
  text += text_line("asset", m.asset, "", "equal to the name of this file");
  text += text_line("maker", m.maker, "Sample Machines");
  text += text_line("model", m.model, "VM 12");
  text += text_line("serial", m.serial, "S-0001");
  text += text_line("control", m.control, "siemens-840d",
                    "the numbers below refer to it: `nonio table controls`");
  text += text_line("control_version", "", "4.95");
  text += "# taken = [\"0\", \"100-227\"]  # numbers in use, of CEC tables or FANUC's points\n";
  int number = 0;
  for (const Axis& a : m.axes) {
    const std::string unit = a.rotary ? "deg" : "mm", small = a.rotary ? "arcsec" : "um";
    const double per = a.rotary ? deg_per_rad : 1e3;
    text += "\n[axes." + a.name + "]\n# number = " + std::to_string(++number) +
            "  # number in the control, not the place in this file\n"
            "# reference_" +
            unit + " = 0.0  # position of the reference point\n";
    if (a.travel)
      text += "travel = [" + json_number(a.travel->first * per) + ", " +
              json_number(a.travel->second * per) + "]\n";
    text += "# largest_" + small +
            " = 100.0  # limits of the maker: largest entry of a table, largest slope\n"
            "# slope_" +
            std::string(a.rotary ? "arcsec_per_deg" : "um_per_m") + " = 200.0\n" +
            "# table = \"none\"  # the table in the control: \"machines/backup/x.ini\", or "
            "\"none\"\n" +
            "# backlash_" + unit +
            " = \"none\"\n"
            "# since = 2026-11-03  # day on which table and backlash value were loaded\n";
  }
  return text;
}

std::string campaign_text(const NewCampaign& c) {
  const bool example = c.example();
  std::string text;
  if (example)
    text +=
        "# EXAMPLE READINGS, not measured. Replace the CSV files named below by your own, then\n"
        "# remove the words \"EXAMPLE, NOT MEASURED\" from customer and model.\n";
  text += "# One campaign. All keys: docs/manifest.md.\nformat = 1\n\n[campaign]\n";
  text += text_line("id", c.id, "", "unique in the site: a-z 0-9 . _ -");
  text += text_line("customer", marked(c.customer, example), "Officine Esempio S.r.l.");
  text += text_line("customer_address", "", "Via degli Esempi 1, 10100 Torino");
  text += text_line("site", "", "Torino", "location of the machine");
  text += text_line("operator", c.operator_name, "A. Sample");
  text += "date = " + c.date + "\n\n[machine]\n";
  text += "# Asset, or maker and serial, name the machine: they join its campaigns.\n";
  text += text_line("asset", c.asset, "S-0001", "its record: machines/S-0001.toml of the site");
  text += text_line("maker", c.maker, "Sample Machines");
  text += text_line("model", marked(c.machine, example), "VM 12");
  text += text_line("serial", c.serial, "S-0001");
  text += text_line("control", c.control, "siemens-840d",
                    "tables for this one only: `nonio table controls`");
  text += text_line("structure", "", "gantry", "gantry, single-column, bridge, other");
  for (const NewAxis& a : c.axes) text += axis_text(a);
  text += instrument_text(c);
  for (const NewAxis& a : c.axes) {
    text += "\n[[measurement]]\nid = " + toml_string(a.axis.name) +
            "\nkind = \"axis\"\naxis = " + toml_string(a.axis.name) +
            "\nfile = " + toml_string(a.file);
    text += a.example() ? "  # EXAMPLE readings\n" : "\n";
    if (!c.reader.empty() && !a.example()) text += "reader = " + toml_string(c.reader) + "\n";
    text += test_text(a);
  }
  text +=
      "# exclude = [57]  # lines of the file with excluded readings\n"
      "# exclude_reason = \"beam interrupted, see the record of the test\"\n\n"
      "# The error model, for `nonio model compare` and `nonio model explain`.\n"
      "# [model]\n"
      "# effects = [\"scale:" +
      c.axes.front().axis.name + "\", \"backlash:" + c.axes.front().axis.name +
      "\"]\n\n"
      "# Analyses and outputs of this campaign, if different from those of the site.\n"
      "# [run]\n"
      "# analyses = [\"iso230-2\"]\n"
      "# outputs = [\"pdf-report\", \"certificate\"]\n" +
      certificate_text() +
      "\n# Options of one plugin, for this campaign.\n"
      "# [options.iso230-2]\n"
      "# edition = 2014\n";
  if (c.reader.empty()) return text;
  text += "\n# What the columns of the files are.\n[options." + c.reader + "]\ncolumns = [\n";
  for (const std::string& column : c.columns) text += "  " + toml_string(column) + ",\n";
  return text + "]\n";
}

std::string example_readings(const Axis& axis, const std::string& campaign) {
  constexpr int targets = 11, runs = 5;
  const Quantity at = position_of(axis.rotary);
  const auto [from, to] =
      axis.travel.value_or(axis.rotary ? std::pair(0.0, 360.0 / deg_per_rad) : std::pair(0.0, 0.5));
  const std::string position(unit_of(at).suffix),
      deviation(unit_of(deviation_of(axis.rotary)).suffix);
  std::string text = "# EXAMPLE readings of axis " + axis.name +
                     ": they were not measured. Put your own here.\n"
                     "# run from 1; direction + or - in which the axis moved to the target;\n"
                     "# deviation = actual - target. Blank or nan: not taken.\n"
                     "run,direction,target" +
                     position + ",deviation" + deviation + "\n";
  std::uint64_t seed = 0xcbf29ce484222325U;  // offset basis of FNV-1a
  for (const char c : campaign + '\n' + axis.name)
    seed = (seed ^ static_cast<unsigned char>(c)) * 0x100000001b3U;
  Noise noise(seed);
  double target[targets];
  const double step = (to - from) / (targets + 1);
  for (int i = 0; i < targets; ++i) target[i] = from + step * (i + 1 + 0.2 * noise());
  for (int run = 1; run <= runs; ++run)
    for (const int direction : {1, -1})
      for (int i = 0; i < targets; ++i) {
        const int k = direction > 0 ? i : targets - 1 - i;
        const double share = (target[k] - from) / (to - from);
        // Values in um or arcsec. For a rotary axis they are periodic in one turn, because a jump
        // there would be a finding of severity warning.
        const double turn = 2.0 * std::numbers::pi * share;
        const double value =
            (axis.rotary ? 2.0 * std::sin(2.0 * turn) : 4.0 * share + std::sin(turn)) +
            0.5 * noise();
        text += std::to_string(run) + (direction > 0 ? ",+," : ",-,") +
                fixed_text(printed(target[k], at), 3) + "," + fixed_text(value, 3) + "\n";
      }
  return text;
}

std::string valid_id(const std::string& name) {
  std::string id;
  for (const char c : name) {
    const bool capital = c >= 'A' && c <= 'Z';
    const char small = capital ? static_cast<char>(c + 32) : c;
    const bool may = (small >= 'a' && small <= 'z') || (small >= '0' && small <= '9') ||
                     small == '.' || small == '_' || small == '-';
    if (may && !(id.empty() && small == '.'))
      id += small;
    else if (!id.empty() && id.back() != '-')
      id += '-';
  }
  id.resize(std::min<std::size_t>(id.size(), 100));
  while (!id.empty() && id.back() == '-') id.pop_back();
  return id.empty() ? "campaign" : id;
}

}  // namespace nonio::app
