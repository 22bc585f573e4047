// SPDX-License-Identifier: Apache-2.0
#include "nonio/host/manifest.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>
#include <sstream>

#include "certificate_reader.h"
#include "formula_reader.h"
#include "nonio/host/nearest.h"
#include "toml_reader.h"

namespace nonio::host {

namespace {

constexpr double mm = 1e-3, um = 1e-6;
constexpr double deg = 1.0 / deg_per_rad, arcsec = 1.0 / arcsec_per_rad;

const std::vector<std::string> measurement_kinds = {"axis",         "straightness",  "angle",
                                                    "diagonal",     "step-diagonal", "ball-centres",
                                                    "observations", "ballbar"};

/// A file that is being read: its name and what was found wrong so far.
struct Source {
  const std::string& file;
  std::vector<Error> errors{};
  TableReader reader(const toml::table& table, std::string name) {
    return {table, std::move(name), file, errors};
  }
};

RunChoice read_run(Source& source, const toml::table* table) {
  RunChoice run;
  if (table == nullptr) return run;
  TableReader reader = source.reader(*table, "run");
  run.analyses = reader.texts("analyses");
  run.outputs = reader.texts("outputs");
  reader.finish();
  return run;
}

RawOptions read_options(Source& source, const toml::table* table) {
  RawOptions options;
  if (table == nullptr) return options;
  for (const auto& [plugin, node] : *table) {
    const std::string name(plugin.str());
    const toml::table* entries = node.as_table();
    if (entries == nullptr) {
      source.errors.push_back(
          Error{"options." + name + ": wanted a table, found " + type_name(node), source.file,
                node.source().begin.line});
      continue;
    }
    auto& of_plugin = options[name];
    for (const auto& [key, value] : *entries) {
      const std::uint64_t line = value.source().begin.line;
      if (auto setting = to_setting(value))
        of_plugin[std::string(key.str())] = RawOption{std::move(*setting), source.file, line};
      else
        source.errors.push_back(Error{"options." + name + "." + std::string(key.str()) +
                                          ": wanted a value, found " + type_name(value),
                                      source.file, line});
    }
  }
  return options;
}

/// ISO 841: A, B, C turn about X, Y, Z.
bool rotary_by_name(const std::string& name) {
  return !name.empty() && name[0] >= 'A' && name[0] <= 'C';
}

void read_tolerance(TableReader& reader, Axis& axis) {
  const char* key = axis.rotary ? "tolerance_arcsec" : "tolerance_um";
  for (const auto& [name, limit] : reader.number_table(key, axis.rotary ? arcsec : um)) {
    if (limit <= 0.0)
      reader.error(key, name + ": wanted a tolerance above 0");
    else
      axis.tolerance[name] = limit;
  }
}

Axis read_axis(Source& source, const std::string& name, const toml::table& table) {
  Axis axis{.name = name, .rotary = rotary_by_name(name)};
  TableReader reader = source.reader(table, "machine.axes." + name);
  const std::string kind = reader.choice("kind", {"linear", "rotary"});
  if (!kind.empty()) axis.rotary = kind == "rotary";
  if (const auto travel = reader.numbers("travel")) {
    const double unit = axis.rotary ? deg : mm;
    if (travel->size() == 2 && (*travel)[0] < (*travel)[1])
      axis.travel = {(*travel)[0] * unit, (*travel)[1] * unit};
    else
      reader.error("travel", "wanted two numbers, the smaller one first");
  }
  if (axis.rotary) {
    axis.teeth = reader.whole("teeth");
    if (axis.teeth && *axis.teeth == 0) reader.error("teeth", "wanted a number above 0");
  } else {
    axis.screw_pitch = reader.number("screw_pitch_mm", mm);
    axis.expansion = reader.number("expansion_um_per_m_K", um);
    if (axis.screw_pitch && *axis.screw_pitch <= 0.0)
      reader.error("screw_pitch_mm", "wanted a pitch above 0");
  }
  read_tolerance(reader, axis);
  reader.finish();
  return axis;
}

Machine read_machine(Source& source, const toml::table* table) {
  Machine machine;
  if (table == nullptr) return machine;
  TableReader reader = source.reader(*table, "machine");
  machine.maker = reader.text("maker");
  machine.model = reader.text("model");
  machine.serial = reader.text("serial");
  machine.description = reader.text("description");
  machine.condition = reader.text("condition");
  machine.control = reader.text("control");
  machine.structure = reader.choice("structure", {"gantry", "single-column", "bridge", "other"});
  if (const toml::table* axes = reader.table("axes"))
    for (const auto& [key, node] : *axes) {
      const std::string name(key.str());
      if (const toml::table* axis = node.as_table())
        machine.axes.push_back(read_axis(source, name, *axis));
      else
        source.errors.push_back(
            Error{"machine.axes." + name + ": wanted a table, found " + type_name(node),
                  source.file, node.source().begin.line});
    }
  reader.finish();
  return machine;
}

std::optional<double> not_negative(TableReader& reader, const char* key, double scale) {
  const auto value = reader.number(key, scale);
  if (value && *value < 0.0) {
    reader.error(key, "wanted a number that is not negative");
    return std::nullopt;
  }
  return value;
}

Instrument read_instrument(Source& source, const toml::table* table) {
  Instrument instrument;
  if (table == nullptr) return instrument;
  TableReader reader = source.reader(*table, "instrument");
  instrument.maker = reader.text("maker");
  instrument.model = reader.text("model");
  instrument.serial = reader.text("serial");
  instrument.calibrated = reader.date("calibrated");
  instrument.certificate = reader.text("certificate");
  instrument.U_fixed = not_negative(reader, "U_fixed_um", um);
  instrument.U_per_length = not_negative(reader, "U_per_m_um", um);
  instrument.U_angle = not_negative(reader, "U_arcsec", arcsec);
  reader.finish();
  return instrument;
}

Environment read_environment(Source& source, const toml::table* table) {
  Environment environment;
  if (table == nullptr) return environment;
  TableReader reader = source.reader(*table, "environment");
  environment.misalignment = not_negative(reader, "misalignment_mm", mm);
  environment.temperature_range = not_negative(reader, "temperature_range_K", 1.0);
  environment.temperature_difference = not_negative(reader, "temperature_difference_K", 1.0);
  environment.expansion_range = not_negative(reader, "expansion_range_um_per_m_K", um);
  environment.drift = not_negative(reader, "drift_um", um);
  environment.drift_angle = not_negative(reader, "drift_arcsec", arcsec);
  reader.finish();
  return environment;
}

Signing read_signing(Source& source, const toml::table& table) {
  Signing s;
  TableReader reader = source.reader(table, "signing");
  s.pkcs12 = reader.text("pkcs12");
  s.pkcs11 = reader.text("pkcs11");
  s.module = reader.text("module");
  s.certificates = reader.text("certificates");
  s.password_file = reader.text("password_file");
  s.password_env = reader.text("password_env");
  s.password_credential = reader.text("password_credential");
  s.trust = reader.text("trust");
  s.revocation = reader.text("revocation");
  s.signer = reader.text("signer");
  s.time_stamp = reader.text("time_stamp");
  s.time_stamp_required = reader.choice("time_stamp_missing", {"fail", "sign"}) != "sign";
  s.time_stamp_seconds = reader.whole("time_stamp_seconds").value_or(s.time_stamp_seconds);
  if (s.pkcs12.empty() == s.pkcs11.empty())
    reader.error("pkcs12", "wanted the key in either pkcs12 (a file) or pkcs11 (a token)");
  if (!s.pkcs11.empty() && s.module.empty())
    reader.error("module", "is missing: the PKCS#11 library of the token");
  const int passwords = int{!s.password_file.empty()} + int{!s.password_env.empty()} +
                        int{!s.password_credential.empty()};
  if (passwords != 1)
    reader.error("password_file",
                 "wanted one of password_file, password_env, password_credential (of systemd)");
  if (!s.time_stamp.empty() && !s.time_stamp.starts_with("http://"))
    reader.error("time_stamp", "wanted http://..., found \"" + s.time_stamp +
                                   "\" (a time stamp is signed; it needs no https)");
  if (!s.time_stamp.empty() && s.trust.empty())
    reader.error("trust", "is missing: a PEM file with the root of the time-stamp server");
  if (s.time_stamp_seconds < 1 || s.time_stamp_seconds > 300)
    reader.error("time_stamp_seconds", "wanted 1 to 300");
  reader.finish();
  return s;
}

bool is_measurement_id(std::string_view id) {
  return !id.empty() && id.size() <= 60 && id.front() != '.' && id.front() != ' ' &&
         id.find_first_of("/\\\n\t") == std::string_view::npos;
}

Measurement read_measurement(Source& source, const toml::table& table) {
  Measurement m;
  TableReader reader = source.reader(table, "measurement");
  m.id = reader.text("id", true);
  if (!m.id.empty() && !is_measurement_id(m.id))
    reader.error("id", "wanted up to 60 characters without / and \\, not starting with a point");
  m.kind = reader.choice("kind", measurement_kinds, true);
  m.file = reader.text("file", true);
  m.reader = reader.text("reader");
  m.axis = reader.text("axis");
  if (m.axis.empty() && (m.kind == "axis" || m.kind == "straightness" || m.kind == "angle" ||
                         m.kind == "ball-centres"))
    reader.error("axis", "is missing: which axis of the machine was measured");
  m.lateral = reader.text("lateral");
  m.adjustment = reader.choice("adjustment", {"before", "after"});
  if (m.kind == "straightness" && m.lateral.empty())
    reader.error("lateral", "is missing: the axis in whose direction the deviation was measured");
  if (m.kind == "straightness" && !m.lateral.empty() && m.lateral == m.axis)
    reader.error("lateral", "wanted another axis than " + m.axis +
                                ", which moves: along it the deviation is one of positioning");
  if (m.kind == "angle") m.lateral = reader.choice("about", {"X", "Y", "Z"}, true);
  for (const double line : reader.numbers("exclude").value_or(std::vector<double>{}))
    if (line >= 1.0 && line <= 4e9 && line == std::floor(line))
      m.exclude.push_back(static_cast<std::uint32_t>(line));
    else
      reader.error("exclude", "wanted line numbers of the file, whole and from 1");
  const bool spans = m.kind == "diagonal" || m.kind == "step-diagonal";
  for (const auto& [key, ends] : {std::pair{"from", &m.from}, std::pair{"to", &m.to}}) {
    for (const auto& [axis, position] : reader.number_table(key, mm)) (*ends)[axis] = position;
    if (spans && ends->empty())
      reader.error(key, "is missing: the axis positions of that end, { X = 0, Y = 0 }");
  }
  for (const auto& [axis, position] : reader.number_table("at", mm)) m.at[axis] = position;
  if (m.at.contains(m.axis))
    reader.error("at", "wanted the axes that stood still, found " + m.axis + ", which moves");
  reader.finish();
  return m;
}

void read_measurements(Source& source, TableReader& top, Campaign& campaign, bool plans) {
  const toml::array* list = top.tables("measurement");
  if (list == nullptr || list->empty()) {
    if (!plans)
      top.error("measurement",
                "is missing: a campaign has at least one [[measurement]], or, where it only plans, "
                "[run] analyses and outputs");
    return;
  }
  std::set<std::string> ids;
  for (const toml::node& node : *list) {
    Measurement m = read_measurement(source, *node.as_table());
    if (!m.id.empty() && !ids.insert(m.id).second)
      source.errors.push_back(Error{"measurement.id: \"" + m.id + "\" is there twice", source.file,
                                    node.source().begin.line});
    if (!m.axis.empty() && campaign.machine.axis(m.axis) == nullptr)
      campaign.machine.axes.push_back(Axis{.name = m.axis, .rotary = rotary_by_name(m.axis)});
    campaign.measurements.push_back(std::move(m));
  }
}

void read_campaign(Source& source, TableReader& top, Campaign& campaign) {
  const toml::table* table = top.table("campaign");
  if (table == nullptr) {
    top.error("campaign", "is missing: [campaign] with at least an id");
    return;
  }
  TableReader reader = source.reader(*table, "campaign");
  campaign.id = reader.text("id", true);
  if (!campaign.id.empty() && !is_campaign_id(campaign.id))
    reader.error("id",
                 "wanted a-z 0-9 . _ - and no more than 100, not starting with a point; "
                 "found \"" +
                     campaign.id + "\"");
  campaign.customer = reader.text("customer");
  campaign.site = reader.text("site");
  campaign.operator_name = reader.text("operator");
  campaign.customer_address = reader.text("customer_address");
  campaign.date = reader.date("date");
  campaign.end_date = reader.date("end_date");
  campaign.received = reader.date("received");
  if (!campaign.end_date.empty() && campaign.end_date < campaign.date)
    reader.error("end_date", "wanted a day that is not before date, " + campaign.date);
  reader.finish();
}

/// toml++ keeps tables sorted by name; the order in which a machine's axes are written matters to
/// controllers that number them.
void restore_axis_order(const toml::table& root, Machine& machine) {
  const toml::table* axes = root["machine"]["axes"].as_table();
  if (axes == nullptr) return;
  const auto line = [&](const Axis& axis) {
    const toml::node* node = axes->get(axis.name);
    return node == nullptr ? std::numeric_limits<std::uint64_t>::max()
                           : std::uint64_t{node->source().begin.line};
  };
  std::stable_sort(machine.axes.begin(), machine.axes.end(),
                   [&](const Axis& a, const Axis& b) { return line(a) < line(b); });
}

void check_format(TableReader& top) {
  const auto format = top.whole("format");
  if (!format && !top.raw().contains("format"))
    top.error("format", "is missing: wanted format = 1 as the first line");
  else if (format && *format != 1)
    top.error("format", "wanted 1, found " + std::to_string(*format) +
                            ": this file is for another version of nonio");
}

void note_lines(const toml::table& table, const std::string& prefix, KeyLines& lines) {
  for (const auto& [key, node] : table) {
    const std::string name = prefix + std::string(key.str());
    lines[name] = node.source().begin.line;
    if (const toml::table* child = node.as_table()) note_lines(*child, name + ".", lines);
    if (const toml::array* list = node.as_array())
      for (const toml::node& item : *list)
        if (const toml::table* child = item.as_table()) {
          const std::string one = name + "." + (*child)["id"].value_or(std::string());
          lines[one] = child->source().begin.line;
          note_lines(*child, one + ".", lines);
        }
  }
}

}  // namespace

bool is_campaign_id(std::string_view id) {
  if (id.empty() || id.size() > 100 || id.front() == '.') return false;
  if (id == "summary.json" || id == "summary.txt") return false;
  return id.find_first_not_of("abcdefghijklmnopqrstuvwxyz0123456789._-") == std::string_view::npos;
}

Checked<Manifest> parse_manifest(std::string_view text, const std::string& file) {
  auto root = parse_toml(text, file);
  if (!root) return tl::unexpected(std::vector<Error>{root.error()});
  Source source{file};
  Manifest manifest;
  Campaign& campaign = manifest.campaign;
  TableReader top = source.reader(*root, "");
  check_format(top);
  read_campaign(source, top, campaign);
  campaign.machine = read_machine(source, top.table("machine"));
  restore_axis_order(*root, campaign.machine);
  campaign.instrument = read_instrument(source, top.table("instrument"));
  campaign.environment = read_environment(source, top.table("environment"));
  if (const toml::table* table = top.table("certificate")) {
    TableReader reader = source.reader(*table, "certificate");
    campaign.certificate = read_certificate(reader);
    read_certificate_of_campaign(reader, campaign.certificate);
    reader.finish();
  }
  manifest.run = read_run(source, top.table("run"));
  read_measurements(source, top, campaign, manifest.run.analyses && manifest.run.outputs);
  if (const toml::table* model = top.table("model")) {
    TableReader reader = source.reader(*model, "model");
    if (auto effects = reader.texts("effects")) campaign.model = std::move(*effects);
    campaign.compensate_model = reader.choice("compensate", {"readings", "model"}) == "model";
    campaign.formulas = read_formulas(reader, campaign.machine, file, source.errors);
    reader.finish();
  }
  manifest.options = read_options(source, top.table("options"));
  top.finish();
  if (!source.errors.empty()) return tl::unexpected(std::move(source.errors));
  note_lines(*root, "", manifest.lines);
  return manifest;
}

namespace {

std::string settings_of(const toml::table& root, std::initializer_list<const char*> keys) {
  toml::table out;
  for (const char* key : keys)
    if (const toml::table* table = root[key].as_table()) out.insert(key, *table);
  if (out.empty()) return {};
  std::ostringstream text;
  text << out << "\n";
  return text.str();
}

}  // namespace

Checked<SiteFile> parse_site(std::string_view text, const std::string& file) {
  auto root = parse_toml(text, file);
  if (!root) return tl::unexpected(std::vector<Error>{root.error()});
  Source source{file};
  SiteFile site;
  TableReader top = source.reader(*root, "");
  if (root->contains("format")) check_format(top);
  if (const toml::table* table = top.table("laboratory")) {
    TableReader reader = source.reader(*table, "laboratory");
    site.laboratory = {reader.text("name"),       reader.text("address"),
                       reader.text("country"),    reader.text("accreditation"),
                       reader.text("authoriser"), reader.text("contact")};
    reader.finish();
  }
  if (const toml::table* table = top.table("limits")) {
    TableReader reader = source.reader(*table, "limits");
    site.limits.seconds = reader.number("seconds").value_or(site.limits.seconds);
    site.limits.memory_MB = reader.number("memory_MB").value_or(site.limits.memory_MB);
    if (!(site.limits.seconds > 0.0 && site.limits.seconds <= 1e6))
      reader.error("seconds", "wanted a number above 0 and at most 1000000");
    if (!(site.limits.memory_MB >= 64.0 && site.limits.memory_MB <= 1e9))
      reader.error("memory_MB", "wanted 64 or more, and at most 1000000000");
    reader.finish();
  }
  site.run = read_run(source, top.table("run"));
  site.options = read_options(source, top.table("options"));
  site.settings = settings_of(*root, {"run", "options", "laboratory", "certificate"});
  site.evaluation = settings_of(*root, {"run", "options"});
  if (const toml::table* table = top.table("signing")) site.signing = read_signing(source, *table);
  if (const toml::table* table = top.table("certificate")) {
    TableReader reader = source.reader(*table, "certificate");
    site.certificate = read_certificate(reader);
    site.numbering = read_numbering(reader);
    reader.finish();
  }
  if (top.table("database") != nullptr)
    site.notes.push_back(file + ", line " + std::to_string(top.line_of("database")) +
                         ": [database] has no effect in this version");
  top.finish();
  if (!source.errors.empty()) return tl::unexpected(std::move(source.errors));
  note_lines(*root, "", site.lines);
  return site;
}

std::string salvage_id(std::string_view text) {
  std::size_t at = text.find("[campaign]");
  if (at == std::string_view::npos) return {};
  at = text.find('\n', at);
  while (at != std::string_view::npos) {
    const std::size_t next = text.find('\n', at + 1);
    std::string_view line =
        text.substr(at + 1, next == std::string_view::npos ? next : next - at - 1);
    at = next;
    line.remove_prefix(std::min(line.find_first_not_of(" \t"), line.size()));
    if (line.starts_with('[')) return {};
    if (!line.starts_with("id")) continue;
    const std::size_t open = line.find_first_of("\"'");
    const std::size_t close = line.find_first_of("\"'", open + 1);
    if (open == std::string_view::npos || close == std::string_view::npos) return {};
    const std::string_view id = line.substr(open + 1, close - open - 1);
    return is_campaign_id(id) ? std::string(id) : std::string();
  }
  return {};
}

}  // namespace nonio::host
