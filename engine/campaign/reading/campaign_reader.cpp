// SPDX-License-Identifier: Apache-2.0
#include "campaign/reading/campaign_reader.h"

#include <algorithm>
#include <map>
#include <set>

#include "campaign/config/formula.h"
#include "campaign/config/manifest.h"
#include "campaign/config/site_files.h"
#include "campaign/reading/checked_read.h"
#include "campaign/reading/formula_copy.h"
#include "campaign/reading/names.h"
#include "campaign/reading/plausibility/plausibility.h"
#include "campaign/reading/unknown_format.h"
#include "nonio/model/measurements.h"
#include "nonio/sdk/observations.h"
#include "nonio/sdk/text.h"
#include "platform/process/guarded.h"
#include "platform/storage/digest.h"
#include "platform/storage/files.h"
#include "platform/storage/nearest.h"

namespace nonio::reading {

namespace fs = std::filesystem;

namespace {

struct CampaignSource {
  const std::filesystem::path& folder;
  const Context& context;
  const Stage& stage;
};

/// An error without a line is assigned the first line of its file.
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

void keep_distinct(std::vector<double>& x) {
  std::sort(x.begin(), x.end());
  x.erase(std::unique(x.begin(), x.end()), x.end());
}

/// Removes duplicates whenever the list has doubled, which limits memory.
std::vector<double> distinct(const std::vector<double>& positions) {
  std::vector<double> out;
  std::size_t limit = 1U << 16U;
  for (const double x : positions) {
    if (!out.empty() && out.back() == x) continue;
    out.push_back(x);
    if (out.size() < limit) continue;
    keep_distinct(out);
    limit = std::max(limit, 2 * out.size());
  }
  keep_distinct(out);
  return out;
}

std::vector<std::map<double, std::size_t>> groups_of(const std::vector<double>& x) {
  std::vector<std::map<double, std::size_t>> groups;
  for (std::size_t i = 0; i < x.size();) {
    std::size_t end = i + 1;
    while (end < x.size() && x[end] - x[i] <= grid_tolerance) ++end;
    if (end - i > 1) {
      auto& group = groups.emplace_back();
      for (std::size_t k = i; k < end; ++k) group[x[k]] = 0;
    }
    i = end;
  }
  return groups;
}

std::size_t join(std::vector<double>& positions) {
  auto groups = groups_of(distinct(positions));
  if (groups.empty()) return 0;
  const auto group_of = [&](double x) -> std::map<double, std::size_t>* {
    const auto after = std::upper_bound(
        groups.begin(), groups.end(), x,
        [](double value, const auto& group) { return value < group.begin()->first; });
    if (after == groups.begin()) return nullptr;
    const auto group = after - 1;
    return group->count(x) != 0 ? &*group : nullptr;
  };
  for (const double x : positions)
    if (auto* group = group_of(x)) ++(*group)[x];
  std::map<const std::map<double, std::size_t>*, double> common;
  for (const auto& group : groups)
    common[&group] = std::max_element(group.begin(), group.end(), [](const auto& a, const auto& b) {
                       return a.second < b.second;
                     })->first;
  std::size_t moved = 0;
  for (double& x : positions)
    if (const auto* group = group_of(x)) {
      moved += x != common[group] ? 1 : 0;
      x = common[group];
    }
  return moved;
}

/// Joins positions within `grid_tolerance` to the position with the most readings, because rounded
/// digits would otherwise split a target. Returns the number of changed positions.
std::size_t join_targets(Observations& o) {
  std::size_t moved = 0;
  for (auto& axis : o.axes) moved += join(axis.position);
  return moved;
}

/// Returns the named reader, otherwise the first that recognizes the content, otherwise the reader
/// for the columns of the method. Null, with a note, if no plugin reads this kind. An error if no
/// reader recognizes the content, or if a refused plugin may be required.
Expected<const Reader*> choose_reader(const CampaignSource& from, const Measurement& m,
                                      std::string_view bytes, ReadCampaign& out) {
  const auto& readers = from.context.plugins->readers();
  if (!m.reader.empty()) {
    for (const Reader& r : readers)
      if (r.info.name == m.reader) return &r;
    return fail(key_error(from, out, "measurement." + m.id + ".reader",
                          from.context.plugins->absence("reader", m.reader)));
  }
  const Method* method = from.context.plugins->method(method_name(m));
  const Reader* of_columns = nullptr;
  bool any = false;
  if (bytes.find_first_not_of(" \t\r\n") == bytes.npos)
    return fail(Error{"expected readings, found an empty file", m.file});
  for (const Reader& r : readers) {
    const std::string who = "reader " + r.info.name;
    from.stage(who + " (measurement " + m.id + "), asked whether it reads this file");
    NONIO_TRY(const auto reads,
              process::guarded_answer(who, [&] { return reading::reads(r, m, method); }));
    any = any || reads;
    const auto recognised =
        process::guarded_answer(who, [&] { return reads && r.recognises(head_of(bytes)); });
    if (!recognised) return fail(recognised.error());
    if (*recognised) return &r;
    if (!reads_columns_of(r, method)) continue;
    NONIO_TRY(const auto knows,
              process::guarded_answer(who, [&] { return r.recognises(head_of(bytes)); }));
    if (knows) return &r;
    if (of_columns == nullptr) of_columns = &r;
  }
  if (of_columns != nullptr) return of_columns;
  const std::string refused = from.context.plugins->refusals();
  if (any)
    return fail(
        Error{"no reader recognizes the format of this file: " + what_is_wrong(bytes, m.file) +
                  "; or the format of an installed reader (`nonio plugin list`)" +
                  (refused.empty() ? "" : "; of the plugins " + refused),
              m.file, first_content_line(bytes)});
  if (!refused.empty())
    return fail(key_error(from, out, "measurement." + m.id + ".kind",
                          "no reader takes measurements of kind \"" + method_name(m) +
                              "\", and of the plugins " + refused));
  out.unread.push_back(m.id);
  out.notes.push_back({"measurement.unread", {}, {{"kind", method_name(m)}}, m.id});
  return nullptr;
}

Expected<void> exclude(const CampaignSource& from, const ReadCampaign& out, const Measurement& m,
                       Observations& o) {
  if (m.exclude.empty()) return {};
  const std::set<std::uint32_t> lines(m.exclude.begin(), m.exclude.end());
  for (const std::uint32_t line : lines)
    if (std::find(o.source_line.begin(), o.source_line.end(), line) == o.source_line.end())
      return fail(
          key_error(from, out, "measurement." + m.id + ".exclude",
                    "line " + std::to_string(line) + " of " + m.file + " holds no reading"));
  std::vector<char> kept(o.size(), 1);
  for (std::size_t i = 0; i < o.size(); ++i) {
    if (!lines.contains(o.source_line[i])) continue;
    kept[i] = 0;
    const Quantity q = o.angular ? Quantity::angular_deviation : Quantity::deviation;
    Remark note{"reading.excluded",
                {{"line", static_cast<double>(o.source_line[i]), Quantity::count},
                 {"deviation", o.deviation[i], q}},
                {{"file", m.file}}};
    if (!m.exclude_reason.empty()) {
      note.id = "reading.excluded-why";
      note.texts.emplace_back("reason", m.exclude_reason);
    }
    o.notes.push_back(std::move(note));
  }
  keep_rows(o, kept);
  return {};
}

Expected<void> describe_channels(const CampaignSource& from, const ReadCampaign& out,
                                 const Measurement& m, Observations& o) {
  for (const Measurement::Channel& stated : m.channels) {
    const auto known = std::find_if(o.channels.begin(), o.channels.end(),
                                    [&](const auto& c) { return c.name == stated.name; });
    if (known == o.channels.end()) {
      std::vector<std::string> names;
      for (const auto& c : o.channels) names.push_back(c.name);
      return fail(key_error(from, out, "measurement." + m.id + ".channel",
                            m.file + " has no channel \"" + stated.name + "\"" +
                                (names.empty() ? "" : "; it has " + storage::listed(names)) +
                                storage::suggestion(stated.name, names)));
    }
    known->place = stated.place;
    known->role = stated.role;
  }
  return {};
}

std::optional<Settings> settle_reader(const CampaignSource& from, const Info& info,
                                      ReadCampaign& out) {
  auto options = config::settle_options(info, from.context.site.options, out.manifest->options,
                                        from.context.plugins->options_of_namesakes(info));
  if (options) return std::move(*options);
  for (Error& e : options.error()) report_in(out, std::move(e));
  return std::nullopt;
}

/// Notes about an implausible end of the file, missing readings and joined targets.
void note_oddities(const Measurement& m, std::string_view bytes, Observations& o,
                   ReadCampaign& out) {
  auto ends = implausible_end(bytes, m.file);
  for (auto* doubts : {&ends, &o.doubts})
    for (Finding& doubt : *doubts) {
      doubt.measurement = m.id;
      out.doubts.push_back(std::move(doubt));
    }
  if (o.missing > 0 && m.kind != "axis")
    o.notes.push_back(
        {"readings.not-taken", {{"missing", static_cast<double>(o.missing), Quantity::count}}});
  // Only targets at which the machine stops are joined; features of an artefact, for example, have
  // positions of their own.
  if (m.motion != Measurement::Motion::targets) return;
  if (const std::size_t moved = join_targets(o); moved > 0)
    o.notes.push_back(
        {"targets.joined", {{"readings", static_cast<double>(moved), Quantity::count}}});
}

Expected<void> read_one_measurement(const CampaignSource& from, const Measurement& m,
                                    Observations& into, ReadCampaign& out) {
  const auto path = storage::path_inside(from.folder, m.file);
  auto file = path ? storage::ReadFile::open(*path) : fail(path.error());
  note_input(out, m.file, file ? storage::sha256(file->bytes()) : config::absent);
  if (!path)
    return fail(key_error(from, out, "measurement." + m.id + ".file", path.error().message));
  if (!file)
    return fail(key_error(from, out, "measurement." + m.id + ".file", file.error().message));
  NONIO_TRY(const auto converted, utf8_of_utf16(file->bytes()));
  const std::string_view bytes = converted ? std::string_view(*converted) : file->bytes();
  NONIO_TRY(const auto reader, choose_reader(from, m, bytes, out));
  if (reader == nullptr) return {};
  const Info& info = reader->info;
  const auto options = settle_reader(from, info, out);
  if (!options) return {};
  const std::string who = "reader " + info.name;
  from.stage(who + " (measurement " + m.id + ")");
  auto observations = checked_read(*reader, {bytes, out.manifest->campaign, m, *options,
                                             [&](std::size_t offset) {
                                               if (!converted) file->release(offset);
                                             },
                                             from.context.plugins->method(method_name(m))});
  if (!observations) {
    Error error = observations.error();
    if (error.message.starts_with(who + ": ")) error.message.erase(0, who.size() + 2);
    return fail(std::move(error));
  }
  if (auto possible = possible_air(*observations, m.file); !possible) return possible;
  if (auto excluded = exclude(from, out, m, *observations); !excluded) return excluded;
  if (auto known = describe_channels(from, out, m, *observations); !known) return known;
  note_oddities(m, bytes, *observations, out);
  into = std::move(*observations);
  for (Remark note : into.notes) {
    note.measurement = m.id;
    out.notes.push_back(std::move(note));
  }
  return {};
}

void read_measurements(const CampaignSource& from, ReadCampaign& out) {
  out.observations.resize(out.manifest->campaign.measurements.size());
  for (std::size_t i = 0; i < out.observations.size(); ++i) {
    const Measurement& m = out.manifest->campaign.measurements[i];
    auto read = read_one_measurement(from, m, out.observations[i], out);
    if (read) continue;
    if (read.error().file.empty()) read.error().file = m.file;
    report_in(out, std::move(read.error()));
  }
}

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
