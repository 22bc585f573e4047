// SPDX-License-Identifier: Apache-2.0
#include "campaign/reading/campaign_reader.h"

#include <algorithm>
#include <set>

#include "campaign/config/certificate_reader.h"
#include "campaign/config/formula.h"
#include "campaign/config/table_files.h"
#include "campaign/reading/formula_copy.h"
#include "campaign/reading/measurement_reader.h"
#include "campaign/reading/names.h"
#include "nonio/model/measurements.h"
#include "platform/storage/digest.h"
#include "platform/storage/files.h"

namespace nonio::reading {
namespace fs = std::filesystem;

void report_in(ReadCampaign& out, Error error) {
  if (error.line == 0 && !error.file.empty()) error.line = 1;
  out.errors.push_back(std::move(error));
}

Error key_error(const CampaignSource& from, const ReadCampaign& out, std::string key,
                const std::string& message) {
  Error error{key + ": " + message};
  error.key = std::move(key);
  locate(error, out.manifest->lines, from.context.site.lines);
  return error;
}

void note_input(ReadCampaign& out, const std::string& name, const std::string& digest_now) {
  for (const auto& [known, digest] : out.inputs)
    if (known == input_name(name)) return;
  out.inputs.emplace_back(input_name(name), digest_now);
}

namespace {

const Campaign& campaign_in(const ReadCampaign& out) { return out.manifest->campaign; }

bool read_manifest(const CampaignSource& from, ReadCampaign& out) {
  from.stage("reading campaign.toml");
  const auto text = storage::read_small_file(from.folder / config::manifest_name);
  if (!text) {
    report_in(out, Error{text.error().message, config::manifest_name});
    return false;
  }
  out.inputs.emplace_back(config::manifest_name, storage::sha256(*text));
  auto manifest =
      config::parse_manifest(*text, config::manifest_name, from.context.plugins->methods());
  if (!manifest) {
    for (Error& error : manifest.error()) report_in(out, std::move(error));
    return false;
  }
  out.manifest = std::move(*manifest);
  for (const Error& w : out.manifest->warnings)
    out.notes.push_back(Remark{
        former_key_note, {}, {}, {}, w.file + ":" + std::to_string(w.line) + ": " + w.message});
  Campaign& campaign = out.manifest->campaign;
  campaign.laboratory = from.context.site.laboratory;
  campaign.certificate =
      config::certificate_of(from.context.site.certificate, campaign.certificate);
  return true;
}

void take_present_state(const config::RecordFile& file, Axis& axis, ReadCampaign& out) {
  const auto found = file.record->axes.find(axis.name);
  if (found == file.record->axes.end()) return;
  const config::ControlState* const state = found->second.state_on(campaign_in(out).date);
  if (state == nullptr) return;
  if (!axis.active_table && state->table) {
    axis.active_table = state->table;
    if (const auto files = file.tables.find(state->files); files != file.tables.end())
      out.active_tables[axis.name] = files->second;
  }
  if (!axis.active_backlash) axis.active_backlash = state->backlash;
}

/// The manifest has precedence over the machine's record. Contradictions are reported.
void look_up_machine(const CampaignSource& from, ReadCampaign& out) {
  Machine& machine = out.manifest->campaign.machine;
  const std::string input = config::machine_input(machine);
  if (input.empty()) return;
  out.inputs.emplace_back(input, config::machine_digest(from.context.machines, input));
  const auto found = config::record_of(from.context.machines, machine);
  if (!found) return report_in(out, key_error(from, out, "machine", found.error().message));
  if (*found == nullptr) return;
  const config::RecordFile& file = **found;
  if (!file.record) {
    for (const Error& e : file.record.error()) report_in(out, e);
    if (machine.asset.empty() && file.serial.empty())
      report_in(out, key_error(from, out, "machine",
                               "the record machines/" + file.asset +
                                   ".toml cannot be read, and may be that of this machine; "
                                   "correct it, or state asset in [machine]"));
    return;
  }
  for (Error& e : config::contradictions(*out.manifest, *file.record)) report_in(out, std::move(e));
  out.machine = *file.record, out.state_files = file.tables;
  if (machine.control.empty()) machine.control = file.record->control;
  for (Axis& axis : machine.axes) take_present_state(file, axis, out);
}

void note_tables(ReadCampaign& out, const std::string& list, const std::vector<Artifact>& files) {
  std::size_t from = 0;
  for (const Artifact& f : files) {
    const std::size_t comma = std::min(list.find(',', from), list.size());
    note_input(out, list.substr(from, comma - from), storage::sha256(f.bytes));
    from = comma + 1;
  }
}

void look_up_active_tables(const CampaignSource& from, ReadCampaign& out) {
  for (const Axis& axis : campaign_in(out).machine.axes) {
    if (!axis.active_table || axis.active_table->empty() || out.active_tables.contains(axis.name))
      continue;
    const std::string key = "machine.axes." + axis.name + ".active_table";
    auto files = config::read_table_files(*axis.active_table, from.folder);
    if (files) {
      note_tables(out, *axis.active_table, *files);
      out.active_tables[axis.name] = std::move(*files);
    } else {
      report_in(out, key_error(from, out, key, files.error().message));
    }
  }
}

/// Returns a sentence, or "" if the formula differs from all effects on the readings.
std::string copied(const ReadCampaign& out, const std::vector<model::Part>& parts, const Axis& axis,
                   const Effect& effect) {
  for (const model::Part& part : parts) {
    if (std::none_of(part.axes.begin(), part.axes.end(),
                     [&](const Axis& a) { return a.name == axis.name; }) ||
        !effect.applies(part.table, axis))
      continue;
    const auto same = copy_of(part.table, axis, effect, out.effects);
    if (!same) return same.error().message;
    if (*same == "zero") return "it states no more than the zero of a measurement";
    if (!same->empty()) return "it states the same as " + *same + " on these readings";
  }
  return {};
}

void add_own_effects(ReadCampaign& out) {
  if (campaign_in(out).formulas.empty()) return;
  const auto parts = model::parts_of(campaign_in(out), out.observations);
  for (const Formula& formula : campaign_in(out).formulas) {
    const auto blame = [&](const std::string& why) {
      report_in(out, Error{"model.formula \"" + formula.name + "\": " + why, config::manifest_name,
                           formula.line});
    };
    const auto same_name = [&](const Effect& e) { return e.info.name == formula.name; };
    if (std::any_of(out.effects.begin(), out.effects.end(), same_name)) {
      blame("an effect of the catalogue has this name");
      continue;
    }
    const Axis& axis = *campaign_in(out).machine.axis(formula.axis);
    auto effect = config::formula_effect(formula, axis);
    if (!effect) {
      blame(effect.error().message);
      continue;
    }
    if (const std::string why = copied(out, parts, axis, *effect); !why.empty())
      blame(why);
    else
      out.effects.push_back(std::move(*effect));
  }
}

bool names_a_cause(const ReadCampaign& out) {
  const auto known = [&](const std::string& name) {
    return std::any_of(out.effects.begin(), out.effects.end(),
                       [&](const Effect& e) { return e.info.name == name; });
  };
  const auto& model = out.manifest->campaign.model;
  return std::any_of(model.begin(), model.end(), [&](const std::string& effect) {
    return !known(effect.substr(0, effect.find(':')));
  });
}

std::optional<Error> name_taken(const config::Cause& cause, const ReadCampaign& read) {
  const std::string& name = cause.formula.name;
  for (const Formula& own : read.manifest->campaign.formulas)
    if (own.name == name)
      return Error{"model.formula \"" + name + "\": the library has a cause of this name (" +
                       cause.file + ":" + std::to_string(cause.formula.line) +
                       "); give one of them another name",
                   config::manifest_name, own.line};
  if (std::any_of(read.effects.begin(), read.effects.end(),
                  [&](const Effect& e) { return e.info.name == name; }))
    return Error{
        "cause \"" + name + "\": a plugin has an effect of this name; give the cause another name",
        cause.file, cause.formula.line};
  return std::nullopt;
}

/// Causes become effects if the context or the model requires them. Otherwise a repeated name is no
/// error.
void add_library(const Context& context, ReadCampaign& out) {
  auto causes = config::causes_in(context.templates);
  if (!causes) {
    for (Error& e : causes.error()) report_in(out, std::move(e));
    return;
  }
  const bool as_effects = context.every_cause || names_a_cause(out);
  std::set<std::string> refused;
  for (const config::Cause& cause : **causes) {
    auto error = name_taken(cause, out);
    if (!error && as_effects) {
      auto effect = cause.effect(true);
      if (effect)
        out.effects.push_back(std::move(*effect));
      else
        error = Error{effect.error().message, cause.file, cause.formula.line};
    }
    if (!error) continue;
    refused.insert(cause.formula.name);
    if (as_effects) report_in(out, std::move(*error));
  }
  out.causes = *causes;
  if (refused.empty()) return;
  auto others = std::make_shared<std::vector<config::Cause>>(**causes);
  std::erase_if(*others, [&](const config::Cause& c) { return refused.contains(c.formula.name); });
  out.causes = std::move(others);
}

}  // namespace

ReadCampaign read_campaign(const fs::path& folder, const Context& context, const Stage& stage) {
  const CampaignSource from{folder, context, stage};
  ReadCampaign out;
  out.effects = context.plugins->effects();
  if (!read_manifest(from, out)) return out;
  look_up_machine(from, out);
  look_up_active_tables(from, out);
  read_measurements(from, out);
  add_own_effects(out);
  add_library(context, out);
  return out;
}

}  // namespace nonio::reading
