// SPDX-License-Identifier: Apache-2.0
#include "campaign/config/manifest.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>

#include "campaign/config/certificate_reader.h"
#include "campaign/config/formula_reader.h"
#include "campaign/config/measurement_keys.h"
#include "campaign/config/run_reader.h"
#include "campaign/config/toml_reader.h"
#include "nonio/sdk/format.h"
#include "nonio/sdk/statement.h"
#include "platform/storage/nearest.h"

namespace nonio::config {

namespace {

constexpr double mm = 1e-3, um = 1e-6;
constexpr double deg = 1.0 / deg_per_rad, arcsec = 1.0 / arcsec_per_rad;

/// A coefficient in 1/K under the key for um/(m K) would leave the length as it is, in silence.
std::optional<double> expansion_of(TableReader& reader) {
  constexpr const char* key = "expansion_um_per_m_K";
  constexpr double least = 1e-3;
  const auto value = reader.number(key, um);
  if (value && *value != 0.0 && std::fabs(*value) < least * um)
    reader.error(key, "expected um/(m K), 11.5 for steel, 0 for none; found " +
                          short_text(*value / um, 4) + ", which looks like 1/K");
  return value;
}

/// None if it is not stated; empty if it is stated that there was none.
std::optional<std::string> active_table(const std::string& text) {
  if (text.empty()) return std::nullopt;
  return text == "none" ? std::string() : text;
}

Axis read_axis(const std::string& name, TableReader& reader) {
  Axis axis{.name = name, .rotary = rotary_by_name(name)};
  const std::string kind = reader.text("kind");
  if (!kind.empty()) axis.rotary = kind == "rotary";
  reader.settle("kind", axis.rotary ? "rotary" : "linear");
  axis.travel = reader.span("travel", axis.rotary ? deg : mm);
  if (axis.rotary) {
    axis.teeth = reader.integer("teeth");
  } else {
    axis.screw_pitch = reader.number("screw_pitch_mm", mm);
    axis.fixed_point = reader.number("fixed_point_mm", mm);
    axis.expansion = expansion_of(reader);
    axis.slave = reader.text("slave");
    if (axis.slave == axis.name && !axis.slave.empty())
      reader.error("slave", "expected another axis than " + axis.name + ", which is the master");
  }
  axis.active_table = active_table(reader.text("active_table"));
  axis.active_backlash = axis.rotary ? reader.number_or_none("active_backlash_deg", deg)
                                     : reader.number_or_none("active_backlash_mm", mm);
  for (const auto& [result, limit] : axis.rotary ? reader.number_table("tolerance_arcsec", arcsec)
                                                 : reader.number_table("tolerance_um", um))
    axis.tolerance[result] = limit;
  reader.finish();
  return axis;
}

Machine read_machine(TableReader& top) {
  Machine machine;
  auto reader = top.table("machine");
  if (!reader) return machine;
  machine.asset = reader->text("asset");
  machine.maker = reader->text("maker");
  machine.model = reader->text("model");
  machine.serial = reader->text("serial");
  machine.description = reader->text("description");
  machine.condition = reader->text("condition");
  machine.control = reader->text("control");
  machine.structure = reader->text("structure");
  for (auto& [name, axis] : reader->named_tables("axes"))
    machine.axes.push_back(read_axis(name, axis));
  reader->finish();
  return machine;
}

Instrument read_instrument(TableReader& top) {
  Instrument instrument;
  auto reader = top.table("instrument");
  if (!reader) return instrument;
  instrument.maker = reader->text("maker");
  instrument.model = reader->text("model");
  instrument.serial = reader->text("serial");
  instrument.calibrated = reader->date("calibrated");
  instrument.certificate = reader->text("certificate");
  instrument.issuer = reader->text("issuer");
  instrument.valid_until = reader->date("valid_until");
  instrument.U_fixed = reader->number("U_fixed_um", um);
  instrument.U_per_length = reader->number("U_per_m_um", um);
  instrument.U_angle = reader->number("U_arcsec", arcsec);
  instrument.sphere = reader->number("sphere_um", um);
  instrument.probe = reader->number("probe_um", um);
  instrument.expansion = expansion_of(*reader);
  instrument.temperature_range = reader->number("temperature_range_K");
  instrument.expansion_range = reader->number("expansion_range_um_per_m_K", um);
  reader->finish();
  return instrument;
}

std::vector<Sensor> read_sensors(TableReader& top) {
  std::vector<Sensor> sensors;
  for (TableReader& reader : top.tables("sensor")) {
    Sensor s;
    s.measures = reader.text("measures");
    s.maker = reader.text("maker");
    s.model = reader.text("model");
    s.serial = reader.text("serial");
    s.calibrated = reader.date("calibrated");
    s.valid_until = reader.date("valid_until");
    s.certificate = reader.text("certificate");
    s.issuer = reader.text("issuer");
    reader.finish();
    sensors.push_back(std::move(s));
  }
  return sensors;
}

std::vector<Square> read_squares(TableReader& top) {
  constexpr double urad = 1e-6;
  std::vector<Square> squares;
  for (TableReader& reader : top.tables("square")) {
    Square s;
    s.name = reader.text("id");
    s.error = reader.number("error_urad", urad);
    s.U = reader.number("U_urad", urad);
    const bool twice = std::any_of(squares.begin(), squares.end(),
                                   [&](const Square& other) { return other.name == s.name; });
    if (twice) reader.error("id", "\"" + s.name + "\" is given twice");
    reader.finish();
    squares.push_back(std::move(s));
  }
  return squares;
}

Environment read_environment(TableReader& top) {
  Environment environment;
  auto reader = top.table("environment");
  if (!reader) return environment;
  environment.misalignment = reader->number("misalignment_mm", mm);
  environment.temperature_range = reader->number("temperature_range_K");
  environment.temperature_difference = reader->number("temperature_difference_K");
  environment.expansion_range = reader->number("expansion_range_um_per_m_K", um);
  environment.drift = reader->number("drift_um", um);
  environment.drift_angle = reader->number("drift_arcsec", arcsec);
  environment.warm_up = reader->text("warm_up");
  environment.sensors = reader->text("sensors");
  environment.normalised = reader->flag("normalised");
  environment.drift_time = reader->number("drift_minutes", 60.0);
  reader->finish();
  return environment;
}

NumberTable scaled(NumberTable table, double scale) {
  for (auto& [name, value] : table) value *= scale;
  return table;
}

/// One key for linear and one for rotary axes.
std::optional<double> either(TableReader& reader, const char* linear, double linear_unit,
                             const char* rotary, double rotary_unit) {
  const auto length = reader.number(linear, linear_unit),
             angle = reader.number(rotary, rotary_unit);
  if (length && angle)
    reader.error(rotary, "is not allowed with " + std::string(linear) + "; expected one of them");
  return length ? length : angle;
}

void read_test(TableReader& reader, Measurement& m) {
  constexpr double minute = 60.0;
  m.feed = either(reader, "feed_mm_per_min", mm / minute, "feed_deg_per_min", deg / minute);
  m.dwell = reader.number("dwell_s");
  m.over_travel = either(reader, "over_travel_mm", mm, "over_travel_deg", deg);
  for (const auto& [axis, offset] : reader.number_table("tool_offset", mm))
    m.tool_offset[axis] = offset;
  for (const auto& [axis, offset] : reader.number_table("workpiece_offset", mm))
    m.workpiece_offset[axis] = offset;
  m.compensation = reader.text("compensation");
}

/// A circle goes from its centre (`from`) to its point at 0 deg (`to`): on the first axis of its
/// plane.
void fill_circle(TableReader& reader, Measurement& m) {
  const std::string plane = m.settings.text("plane");
  const NumberTable centre = scaled(m.settings.table("centre"), mm);
  if (plane.size() != 2 || !reader.raw().contains("radius_mm") || !reader.raw().contains("centre"))
    return;
  for (const char letter : plane) {
    const auto at = centre.find(std::string_view(&letter, 1));
    if (at == centre.end())
      return reader.error("centre", "expected the axes " + plane.substr(0, 1) + " and " +
                                        plane.substr(1) + ", found no " + letter);
    m.from[at->first] = m.to[at->first] = at->second;
  }
  m.to[plane.substr(0, 1)] += m.settings.number("radius_mm") * mm;
  for (const auto& [axis, position] : centre)
    if (!m.from.contains(axis)) m.at[axis] = position;
}

/// A result has one limit, in the unit of its key.
void read_tolerances(TableReader& reader, Measurement& m) {
  for (const Quantity q : {Quantity::deviation, Quantity::small_angle, Quantity::angular_deviation,
                           Quantity::deviation_per_length}) {
    const std::string key = tolerance_key(q);
    for (const auto& row : reader.number_table(key, 1.0 / unit_of(q).per_si)) {
      const std::string& result = row.first;
      const bool known = std::any_of(m.tolerances.begin(), m.tolerances.end(),
                                     [&](const Tolerance& t) { return t.result == result; });
      if (known)
        reader.error(key + "." + result, "expected one limit of " + result + ", found a second");
      else
        m.tolerances.push_back({result, row.second, q});
    }
  }
}

/// A key that a method declares, as it is written; its default where it is not.
Setting read_setting(TableReader& reader, const Option& option) {
  const Setting& value = option.default_value;
  if (const auto* flag = std::get_if<bool>(&value)) return reader.flag(option.name).value_or(*flag);
  if (const auto* whole = std::get_if<std::int64_t>(&value)) {
    const auto found = reader.integer(option.name);
    return found ? std::int64_t{*found} : *whole;
  }
  if (const auto* number = std::get_if<double>(&value))
    return reader.number(option.name).value_or(*number);
  if (const auto* text = std::get_if<std::string>(&value)) {
    std::string found = reader.text(option.name);
    return found.empty() ? *text : found;
  }
  if (const auto* numbers = std::get_if<std::vector<double>>(&value))
    return reader.numbers(option.name).value_or(*numbers);
  if (const auto* texts = std::get_if<std::vector<std::string>>(&value))
    return reader.texts(option.name).value_or(*texts);
  NumberTable table;
  for (const auto& [name, number] : reader.number_table(option.name, 1.0)) table[name] = number;
  if (const auto* usual = std::get_if<NumberTable>(&value);
      usual != nullptr && !reader.raw().contains(option.name))
    return *usual;
  return table;
}

/// The members of a measurement that keys of a method fill, whichever method has them. SI.
void fill_members(TableReader& reader, Measurement& m) {
  const Settings& s = m.settings;
  m.axis = s.text("axis");
  for (const char* key : {"lateral", "about", "artefact"})
    if (std::string value = s.text(key); !value.empty()) m.lateral = std::move(value);
  m.order = s.text("order");
  m.side = s.text("side");
  m.reversal_of = s.text("reversal_of");
  m.square = s.text("square");
  m.square_turned = s.flag("square_turned");
  for (const char* key : {"foot_mm", "sensor_distance_mm"})
    if (s.has(key) && reader.raw().contains(key)) m.foot = s.number(key) * mm;
  for (const auto& [axis, position] : scaled(s.table("from"), mm)) m.from[axis] = position;
  for (const auto& [axis, position] : scaled(s.table("to"), mm)) m.to[axis] = position;
}

/// What several keys of a method have to agree in.
void check_members(TableReader& reader, const Measurement& m) {
  if (!m.axis.empty() && m.settings.text("lateral") == m.axis)
    reader.error("lateral", "expected another axis than " + m.axis +
                                ", which moves: along it the deviation is one of positioning");
  if (!m.square.empty() && !m.reversal_of.empty())
    reader.error("square",
                 "is given together with reversal_of; expected one of them: a square that was "
                 "turned over has square_turned = true");
  if (m.square_turned && m.square.empty())
    reader.error("square_turned", "expected the key square as well");
}

/// The keys of every method.
void read_common(TableReader& reader, Measurement& m) {
  m.id = reader.text("id");
  m.kind = reader.text("kind");
  m.file = reader.text("file");
  m.reader = reader.text("reader");
  m.adjustment = reader.text("adjustment");
  if (std::string state = reader.text("state"); reader.raw().contains("state"))
    m.state = std::move(state);
  read_tolerances(reader, m);
  m.exclude = reader.integers("exclude");
  m.exclude_reason = reader.text("exclude_reason");
  for (TableReader& one : reader.tables("channel")) {
    m.channels.push_back({one.text("name"), one.text("place"), one.text("role")});
    one.finish();
  }
  for (const auto& [axis, position] : reader.number_table("at", mm)) m.at[axis] = position;
  read_test(reader, m);
}

void refuse_kind(TableReader& reader, const std::string& kind, const std::vector<Method>& methods) {
  std::vector<std::string> kinds;
  for (const Method& method : methods) kinds.push_back(method.info.name);
  std::sort(kinds.begin(), kinds.end());
  std::string list;
  for (const std::string& known : kinds) list += (list.empty() ? "" : ", ") + known;
  reader.error("kind", "expected one of " + list + "; found \"" + kind + "\"" +
                           storage::suggestion(kind, kinds));
}

/// Without `methods` only the keys of every method are read, and others are accepted.
Measurement read_measurement(TableReader& common, const std::vector<Method>* methods) {
  Measurement m;
  if (methods == nullptr) {
    read_common(common, m);
    return m;
  }
  const std::string kind = common.raw()["kind"].value_or(std::string());
  const auto method = std::find_if(methods->begin(), methods->end(),
                                   [&](const Method& one) { return one.info.name == kind; });
  if (method == methods->end()) {
    read_common(common, m);
    if (!m.kind.empty()) refuse_kind(common, kind, *methods);
    return m;
  }
  const KindKeys keys(*method);
  TableReader reader = common.declared(keys.table());
  read_common(reader, m);
  for (const Option& option : method->info.options)
    m.settings.values[option.name] = read_setting(reader, option);
  if (!method->observed_as.empty()) {
    m.method = m.kind;
    m.kind = method->observed_as;
  }
  fill_members(reader, m);
  check_members(reader, m);
  fill_circle(reader, m);
  if (m.at.contains(m.axis))
    reader.error("at", "expected the stationary axes, found " + m.axis + ", which moves");
  reader.finish();
  return m;
}

/// Where the machine's axes are named, a measured one that is not among them is worth a finding.
void add_axis(const std::string& name, bool any_named, Manifest& manifest) {
  manifest.campaign.machine.axes.push_back(Axis{.name = name, .rotary = rotary_by_name(name)});
  if (any_named) manifest.undeclared_axes.push_back(name);
}

/// A straightedge that was turned over: the same line, and each measurement in one pair.
void check_reversals(std::vector<TableReader>& list, const std::vector<Measurement>& all) {
  std::set<std::string> taken;
  for (std::size_t i = 0; i < all.size(); ++i) {
    const std::string& of = all[i].reversal_of;
    if (of.empty()) continue;
    const auto first =
        std::find_if(all.begin(), all.end(), [&](const Measurement& m) { return m.id == of; });
    const bool fits = first != all.end() && first->kind == all[i].kind &&
                      first->axis == all[i].axis && first->lateral == all[i].lateral &&
                      first->reversal_of.empty() && of != all[i].id;
    if (!fits || !taken.insert(of).second)
      list[i].error("reversal_of", "expected the id of another straightness of " + all[i].axis +
                                       " towards " + all[i].lateral +
                                       " that has one reversal, found \"" + of + "\"");
  }
}

/// A line on the face of a square: of a square that there is, and once in each of its positions.
void check_squares(std::vector<TableReader>& list, const Campaign& campaign) {
  std::set<std::string> seen;
  for (std::size_t i = 0; i < list.size(); ++i) {
    const Measurement& m = campaign.measurements[i];
    if (m.square.empty()) continue;
    const bool known = std::any_of(campaign.squares.begin(), campaign.squares.end(),
                                   [&](const Square& s) { return s.name == m.square; });
    if (!known)
      list[i].error("square", "expected the id of a [[square]], found \"" + m.square + "\"");
    std::string line = state_of(m) + "\n" + m.square + "\n" + m.axis + "\n" + m.lateral;
    if (m.square_turned) line += "\nturned";
    if (!seen.insert(std::move(line)).second)
      list[i].error("square", "expected one line of " + m.axis + " towards " + m.lateral +
                                  " on this square in each of its two positions");
  }
}

void read_measurements(TableReader& top, Manifest& manifest, const std::vector<Method>* methods) {
  Campaign& campaign = manifest.campaign;
  const bool plans = manifest.run.analyses && manifest.run.outputs;
  const bool any_named = !campaign.machine.axes.empty();

  auto list = top.tables("measurement");
  if (list.empty() && !plans)
    top.error("measurement",
              "is missing: a campaign has at least one [[measurement]], or, where it only plans, "
              "[run] analyses and outputs");
  std::set<std::string> ids;
  for (TableReader& reader : list) {
    Measurement m = read_measurement(reader, methods);
    if (!m.id.empty() && !ids.insert(m.id).second)
      reader.error("id", "\"" + m.id + "\" is given twice");
    if (!m.axis.empty() && campaign.machine.axis(m.axis) == nullptr)
      add_axis(m.axis, any_named, manifest);
    if (const Axis* axis = campaign.machine.axis(m.axis);
        m.side == "slave" && axis != nullptr && axis->slave.empty())
      reader.error("side", "expected [machine.axes." + m.axis +
                               "] slave, the name of the control's axis on that side");
    campaign.measurements.push_back(std::move(m));
  }
  if (list.size() != campaign.measurements.size()) return;
  check_reversals(list, campaign.measurements);
  check_squares(list, campaign);
}

void read_tables(TableReader& top, Manifest& manifest) {
  auto reader = top.table("tables");
  if (!reader) return;
  for (TableReader& one : reader->tables("accept")) {
    AcceptedFinding accepted{one.text("finding"), one.text("reason"), one.line_of("finding")};
    if (!accepted.reason.empty() && !has_content(accepted.reason))
      one.error("reason", "expected why a table may be written all the same, found \"" +
                              accepted.reason + "\"");
    one.finish();
    manifest.accepted.push_back(std::move(accepted));
  }
  reader->finish();
}

void read_campaign(TableReader& top, Manifest& manifest) {
  auto reader = top.table("campaign");
  if (!reader) return;
  Campaign& campaign = manifest.campaign;
  campaign.id = reader->text("id");
  campaign.customer = reader->text("customer");
  campaign.site = reader->text("site");
  campaign.operator_name = reader->text("operator");
  campaign.customer_address = reader->text("customer_address");
  campaign.date = reader->date("date");
  campaign.end_date = reader->date("end_date");
  campaign.received = reader->date("received");
  manifest.purpose = reader->text("purpose");
  if (!campaign.end_date.empty() && campaign.end_date < campaign.date)
    reader->error("end_date", "expected a day that is not before date, " + campaign.date);
  reader->finish();
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

Checked<Manifest> parse(std::string_view text, const std::string& file,
                        const std::vector<Method>* methods) {
  auto root = parse_toml(text, file);
  if (!root) return tl::unexpected(std::vector<Error>{root.error()});
  std::vector<Error> errors;
  Manifest manifest;
  Campaign& campaign = manifest.campaign;
  manifest.warnings = warnings_of(rename_former_keys(*root, campaign_file()), file);
  TableReader top(*root, campaign_file(), file, errors);
  top.integer("format");
  read_campaign(top, manifest);
  campaign.machine = read_machine(top);
  restore_axis_order(*root, campaign.machine);
  campaign.instrument = read_instrument(top);
  campaign.sensors = read_sensors(top);
  campaign.squares = read_squares(top);
  campaign.environment = read_environment(top);
  if (auto reader = top.table("certificate")) {
    campaign.certificate = read_certificate(*reader);
    read_certificate_of_campaign(*reader, campaign.certificate);
    reader->finish();
  }
  manifest.run = read_run(top);
  read_measurements(top, manifest, methods);
  if (auto reader = top.table("model")) {
    if (auto effects = reader->texts("effects")) campaign.model = std::move(*effects);
    campaign.compensate_model = reader->text("compensate") == "model";
    campaign.formulas = read_formulas(*reader, campaign.machine);
    reader->finish();
  }
  read_tables(top, manifest);
  manifest.options = read_options(top, errors);
  top.finish();
  if (!errors.empty()) return tl::unexpected(std::move(errors));
  note_lines(*root, "", manifest.lines);
  return manifest;
}

}  // namespace

bool is_campaign_id(std::string_view id) { return !id.empty() && obeys(id, campaign_id_rule); }

Checked<Manifest> parse_manifest(std::string_view text, const std::string& file,
                                 const std::vector<Method>& methods) {
  return parse(text, file, &methods);
}

Checked<Manifest> parse_without_methods(std::string_view text, const std::string& file) {
  return parse(text, file, nullptr);
}

std::string extract_id(std::string_view text) {
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

}  // namespace nonio::config
