// SPDX-License-Identifier: Apache-2.0
#include "campaign/config/manifest.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>
#include <tuple>

#include "campaign/config/checks.h"
#include "campaign/config/formula_reader.h"
#include "campaign/config/measurement_keys.h"
#include "campaign/config/number_pattern.h"
#include "campaign/config/toml_reader.h"
#include "nonio/sdk/format.h"
#include "nonio/sdk/statement.h"
#include "platform/storage/nearest.h"

namespace nonio::config {

namespace {

constexpr double mm = 1e-3, um = 1e-6;
constexpr double deg = 1.0 / deg_per_rad, arcsec = 1.0 / arcsec_per_rad;

/// Reports a coefficient that is stated in 1/K instead of um/(m K).
void check_expansion(TableReader& reader, const std::optional<double>& value) {
  constexpr double least = 1e-3;
  if (value && *value != 0.0 && std::fabs(*value) < least * um)
    reader.error("expansion_um_per_m_K", "expected um/(m K), 11.5 for steel, 0 for none; found " +
                                             short_text(*value / um, 4) + ", which looks like 1/K");
}

NumberTable scaled(NumberTable table, double scale) {
  for (auto& [name, value] : table) value *= scale;
  return table;
}

/// Sets `from` to the center of a circle and `to` to its point at 0 deg (m).
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

void check_common(TableReader& reader, Measurement& m) {
  if (reader.contains("state") && !m.state) m.state.emplace();
  for (const auto& [linear, rotary] :
       {std::pair{"feed_mm_per_min", "feed_deg_per_min"}, {"over_travel_mm", "over_travel_deg"}})
    if (reader.contains(linear) && reader.contains(rotary))
      reader.error(rotary, "is not allowed with " + std::string(linear) + "; expected one of them");
}

void refuse_kind(TableReader& reader, const std::string& kind, const std::vector<Method>& methods) {
  std::vector<std::string> kinds;
  for (const Method& method : methods) kinds.push_back(method.info.name);
  std::sort(kinds.begin(), kinds.end());
  reader.error("kind", storage::not_one_of(kinds, kind));
}

/// Without `methods`, reads only the keys that all methods share and accepts all others.
void read_measurement(TableReader& common, const std::vector<Method>* methods, Measurement& m) {
  const std::string kind = common.raw()["kind"].value_or(std::string());
  const auto method = methods == nullptr
                          ? std::vector<Method>::const_iterator{}
                          : std::find_if(methods->begin(), methods->end(),
                                         [&](const Method& one) { return one.info.name == kind; });
  if (methods == nullptr || method == methods->end()) {
    common.fill(m);
    check_common(common, m);
    if (methods != nullptr && !m.kind.empty()) refuse_kind(common, kind, *methods);
    return;
  }
  const KindKeys keys(*method);
  TableReader reader = common.declared(keys.table());
  for (const Option& option : method->info.options)
    m.settings.values[option.name] = option.default_value;
  reader.fill(m);
  check_common(reader, m);
  if (!method->observed_as.empty()) {
    m.method = m.kind;
    m.kind = method->observed_as;
  }
  for (const Method& one : *methods)
    if (one.info.name == m.kind) m.motion = one.motion;
  fill_members(reader, m);
  check_members(reader, m);
  fill_circle(reader, m);
  if (m.at.contains(m.axis))
    reader.error("at", "expected the stationary axes, found " + m.axis + ", which moves");
  reader.finish();
}

void add_axis(const std::string& name, bool any_named, Manifest& manifest) {
  manifest.campaign.machine.axes.push_back(Axis{.name = name, .rotary = rotary_by_name(name)});
  if (any_named) manifest.undeclared_axes.push_back(name);
}

/// Checks that `reversal_of` names a straightness of the same line, and each at most once.
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

/// Checks that each line on a square is measured at most once per state and position.
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

struct Reading : Manifest {
  const std::vector<Method>* methods = nullptr;
};

}  // namespace

void check_axis(TableReader& reader, Axis& axis) {
  axis.name = reader.name();
  axis.rotary = reader.settled() == "rotary";
  if (axis.travel) {
    const double unit = axis.rotary ? deg : mm;
    axis.travel = {axis.travel->first * unit, axis.travel->second * unit};
  }
  check_expansion(reader, axis.expansion);
  if (axis.slave == axis.name && !axis.slave.empty())
    reader.error("slave", "expected another axis than " + axis.name + ", which is the master");
  if (axis.active_table == "none") axis.active_table.emplace();
}

void check_instrument(TableReader& reader, Instrument& instrument) {
  check_expansion(reader, instrument.expansion);
}

void check_square(TableReader& reader, Square& square, Manifest& manifest) {
  if (given_before(manifest.campaign.squares, &Square::name))
    reader.error("id", "\"" + square.name + "\" is given twice");
}

void read_tolerances(TableReader& reader, const Key& key, std::vector<Tolerance>& tolerances) {
  for (const Quantity q : {Quantity::deviation, Quantity::small_angle, Quantity::angular_deviation,
                           Quantity::deviation_per_length}) {
    if (tolerance_key(q) != key.name) continue;
    const Numbers limits = value_of<Numbers>(reader, key).value_or(Numbers{});
    for (const auto& row : limits) {
      const std::string& result = row.first;
      const bool known = std::any_of(tolerances.begin(), tolerances.end(),
                                     [&](const Tolerance& t) { return t.result == result; });
      if (known)
        reader.error(tolerance_key(q) + "." + result,
                     "expected one limit of " + result + ", found a second");
      else
        tolerances.push_back({result, row.second, q});
    }
  }
}

void read_measurements(TableReader& top, const Key& key, std::vector<Measurement>& all,
                       Manifest& manifest) {
  const auto* methods = static_cast<Reading&>(manifest).methods;
  Campaign& campaign = manifest.campaign;
  const bool plans = manifest.run.analyses && manifest.run.outputs;
  const bool any_named = !campaign.machine.axes.empty();

  auto list = top.tables(key);
  if (list.empty() && !plans)
    top.error("measurement",
              "is missing: a campaign has at least one [[measurement]], or, where it only plans, "
              "[run] analyses and outputs");
  std::set<std::string> ids;
  for (TableReader& reader : list) {
    Measurement m;
    read_measurement(reader, methods, m);
    if (!m.id.empty() && !ids.insert(m.id).second)
      reader.error("id", "\"" + m.id + "\" is given twice");
    if (!m.axis.empty() && campaign.machine.axis(m.axis) == nullptr)
      add_axis(m.axis, any_named, manifest);
    if (const Axis* axis = campaign.machine.axis(m.axis);
        m.side == "slave" && axis != nullptr && axis->slave.empty())
      reader.error("side", "expected [machine.axes." + m.axis +
                               "] slave, the name of the control's axis on that side");
    all.push_back(std::move(m));
  }
  if (list.size() != all.size()) return;
  check_reversals(list, all);
  check_squares(list, campaign);
}

void check_accepted(TableReader& reader, AcceptedFinding& accepted) {
  accepted.line = reader.line_of("finding");
  if (!accepted.reason.empty() && !has_content(accepted.reason))
    reader.error("reason", "expected why a table may be written all the same, found \"" +
                               accepted.reason + "\"");
}

void check_own_formula(TableReader& reader, Formula&, Manifest& manifest) {
  check_formula(reader, manifest.campaign.formulas, manifest.campaign.machine);
}

void check_campaign(TableReader& reader, Manifest& manifest) {
  const Campaign& campaign = manifest.campaign;
  if (!campaign.end_date.empty() && campaign.end_date < campaign.date)
    reader.error("end_date", "expected a day that is not before date, " + campaign.date);
}

/// toml++ sorts tables by name, but controllers that number the axes need the written order.
void restore_axis_order(TableReader& reader, Machine& machine) {
  const toml::table* axes = reader.raw()["axes"].as_table();
  if (axes == nullptr) return;
  const auto line = [&](const Axis& axis) {
    const toml::node* node = axes->get(axis.name);
    return node == nullptr ? std::numeric_limits<std::uint64_t>::max()
                           : std::uint64_t{node->source().begin.line};
  };
  std::stable_sort(machine.axes.begin(), machine.axes.end(),
                   [&](const Axis& a, const Axis& b) { return line(a) < line(b); });
}

namespace {

Checked<Manifest> parse(std::string_view text, const std::string& file,
                        const std::vector<Method>* methods) {
  auto root = parse_toml(text, file);
  if (!root) return tl::unexpected(std::vector<Error>{root.error()});
  std::vector<Error> errors;
  Reading manifest;
  manifest.methods = methods;
  manifest.warnings = warnings_of(rename_former_keys(*root, campaign_file()), file);
  TableReader top(*root, campaign_file(), file, errors);
  top.fill<Manifest>(manifest);
  top.finish();
  if (!errors.empty()) return tl::unexpected(std::move(errors));
  note_lines(*root, "", manifest.lines);
  return Manifest(std::move(manifest));
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

void check_numbering(TableReader& reader, SiteFile& site) {
  const Numbering& n = site.numbering;
  if (n.automatic && !reader.raw().contains("accept"))
    reader.error("release",
                 "\"automatic\" requires the list of accepted findings, [[certificate.accept]] "
                 "with finding and reason; accept = [] if none is accepted");
  if (n.automatic && n.two_persons)
    reader.error("two_persons", "true and release = \"automatic\" contradict each other");
  if (const auto sound = number_text(n.pattern, "2026", 1); !sound)
    reader.error("numbering", sound.error().message);
}

CertificateTexts certificate_of(const CertificateTexts& site, const CertificateTexts& campaign) {
  CertificateTexts out = campaign;
  if (out.languages.empty()) out.languages = site.languages;
  if (out.languages.empty()) out.languages = {"en"};
  if (out.title.empty()) out.title = site.title;
  for (const auto& [mine, others, otherwise] :
       {std::tuple{&out.form, &site.form, "certificate"},
        {&out.location, &site.location, "customer"},
        {&out.procedure, &site.procedure, ""},
        {&out.decision_rule, &site.decision_rule, "iso14253-1"}}) {
    if (mine->empty()) *mine = *others;
    if (mine->empty()) *mine = otherwise;
  }
  return out;
}

}  // namespace nonio::config
