// SPDX-License-Identifier: Apache-2.0
#include "host/reading/campaign_reader.h"

#include <algorithm>
#include <set>

#include "host/config/certificate_reader.h"
#include "host/config/formula.h"
#include "host/config/table_files.h"
#include "host/process/guarded.h"
#include "host/reading/formula_copy.h"
#include "host/reading/names.h"
#include "host/reading/plausibility.h"
#include "host/reading/targets.h"
#include "host/reading/unknown_format.h"
#include "host/reading/unsound.h"
#include "host/storage/digest.h"
#include "host/storage/files.h"
#include "nonio/model/explain.h"
#include "nonio/sdk/format.h"
#include "nonio/sdk/text.h"

namespace nonio::host::reading {
namespace fs = std::filesystem;

namespace {

class CampaignReader {
 public:
  CampaignReader(const fs::path& folder, const Context& context, const Stage& stage)
      : folder_(folder), context_(context), stage_(stage) {}

  ReadCampaign read() {
    out_.effects = context_.plugins->effects();
    if (read_manifest()) {
      look_up_machine();
      look_up_what_was_on();
      read_measurements();
      add_formulas();
    }
    for (Observations& o : out_.observations) word(o.notes);
    word(out_.notes);
    return std::move(out_);
  }

 private:
  const Campaign& campaign() const { return out_.manifest->campaign; }
  /// What is wrong with a file as a whole is wrong from its first line on.
  void report(Error error) {
    if (error.line == 0 && !error.file.empty()) error.line = 1;
    out_.errors.push_back(std::move(error));
  }
  void word(std::vector<Remark>& notes) const {
    for (Remark& note : notes) note.english = remark_text(context_.templates, "en", note);
  }
  /// An error that a key of the manifest is to blame for.
  Error at(std::string key, const std::string& message) const {
    Error error{key + ": " + message};
    error.key = std::move(key);
    locate(error, out_.manifest->lines, context_.site.lines);
    return error;
  }

  bool read_manifest() {
    stage_("reading campaign.toml");
    const auto text = storage::read_small_file(folder_ / config::manifest_name);
    if (!text) {
      report(Error{text.error().message, config::manifest_name});
      return false;
    }
    out_.inputs.emplace_back(config::manifest_name, storage::sha256(*text));
    auto manifest = config::parse_manifest(*text, config::manifest_name);
    if (!manifest) {
      for (Error& error : manifest.error()) report(std::move(error));
      return false;
    }
    out_.manifest = std::move(*manifest);
    Campaign& campaign = out_.manifest->campaign;
    campaign.laboratory = context_.site.laboratory;
    campaign.certificate = config::certificate_of(context_.site.certificate, campaign.certificate);
    return true;
  }

  /// What the site's record of the machine says counts where the manifest says nothing.
  void look_up_machine() {
    Machine& machine = out_.manifest->campaign.machine;
    const std::string input = config::machine_input(machine);
    if (input.empty()) return;
    out_.inputs.emplace_back(input, config::machine_digest(context_.machines, input));
    const auto found = config::record_of(context_.machines, machine);
    if (!found) return report(at("machine", found.error().message));
    if (*found == nullptr) return;
    const config::RecordFile& file = **found;
    if (!file.record) {
      for (const Error& e : file.record.error()) report(e);
      return;
    }
    for (Error& e : config::contradictions(*out_.manifest, *file.record)) report(std::move(e));
    out_.machine = *file.record;
    if (machine.control.empty()) machine.control = file.record->control;
    for (Axis& axis : machine.axes) take_present_state(axis, file);
  }

  /// What the record says is in the control counts for measurements of later days, where the
  /// manifest does not say what was on.
  void take_present_state(Axis& axis, const config::RecordFile& file) {
    const auto found = file.record->axes.find(axis.name);
    if (found == file.record->axes.end()) return;
    const config::RecordedAxis& recorded = found->second;
    if (recorded.since.empty() || !(campaign().date > recorded.since)) return;
    if (!axis.table_on && recorded.table) {
      axis.table_on = recorded.table;
      if (const auto files = file.tables.find(axis.name); files != file.tables.end())
        out_.tables_on[axis.name] = files->second;
    }
    if (!axis.backlash_on) axis.backlash_on = recorded.backlash;
  }

  void look_up_what_was_on() {
    for (const Axis& axis : campaign().machine.axes) {
      if (!axis.table_on || axis.table_on->empty() || out_.tables_on.contains(axis.name)) continue;
      const std::string key = "machine.axes." + axis.name + ".table_on";
      auto files = config::read_table_files(*axis.table_on, folder_);
      if (files) {
        note_tables(*axis.table_on, *files);
        out_.tables_on[axis.name] = std::move(*files);
      } else {
        report(at(key, files.error().message));
      }
    }
    for (const Measurement& m : campaign().measurements)
      if (m.compensation == "off" && out_.tables_on.contains(m.axis))
        report(at("measurement." + m.id + ".compensation",
                  "\"off\" contradicts table_on of axis " + m.axis));
  }

  /// In the order of the list.
  void note_tables(const std::string& list, const std::vector<Artifact>& files) {
    std::size_t from = 0;
    for (const Artifact& f : files) {
      const std::size_t comma = std::min(list.find(',', from), list.size());
      note_input(list.substr(from, comma - from), storage::sha256(f.bytes));
      from = comma + 1;
    }
  }

  void read_measurements() {
    out_.observations.resize(campaign().measurements.size());
    for (std::size_t i = 0; i < out_.observations.size(); ++i) {
      const Measurement& m = campaign().measurements[i];
      auto read = read_measurement(m, out_.observations[i]);
      if (read) continue;
      if (read.error().file.empty()) read.error().file = m.file;
      report(std::move(read.error()));
    }
  }

  Expected<void> read_measurement(const Measurement& m, Observations& into) {
    const auto path = storage::path_inside(folder_, m.file);
    auto file = path ? storage::ReadFile::open(*path) : fail(path.error());
    note_input(m.file, file ? storage::sha256(file->bytes()) : config::absent);
    if (!path) return fail(at("measurement." + m.id + ".file", path.error().message));
    if (!file) return fail(at("measurement." + m.id + ".file", file.error().message));
    const auto converted = utf8_of_utf16(file->bytes());
    if (!converted) return fail(converted.error());
    const std::string_view bytes = *converted ? std::string_view(**converted) : file->bytes();
    const auto reader = choose_reader(m, bytes);
    if (!reader) return fail(reader.error());
    if (*reader == nullptr) return {};
    const Info& info = (*reader)->info;
    const auto options = settle(info);
    if (!options) return {};
    const std::string who = "reader " + info.name;
    stage_(who + " (measurement " + m.id + ")");
    auto observations = process::guarded(who, [&] {
      return (*reader)->read({bytes, campaign(), m, *options, [&](std::size_t offset) {
                                if (!*converted) file->release(offset);
                              }});
    });
    if (!observations) {
      Error error = observations.error();
      if (error.message.starts_with(who + ": ")) error.message.erase(0, who.size() + 2);
      return fail(std::move(error));
    }
    if (const std::string why = unsound(*observations); !why.empty())
      return fail(who + " gave " + why);
    if (auto possible = possible_air(*observations, m.file); !possible) return possible;
    if (auto excluded = exclude(m, *observations); !excluded) return excluded;
    auto ends = implausible_end(bytes, m.file);
    for (auto* doubts : {&ends, &observations->doubts})
      for (Finding& doubt : *doubts) {
        doubt.measurement = m.id;
        out_.doubts.push_back(std::move(doubt));
      }
    if (observations->missing > 0 && m.kind != "axis")  // of an axis its analyses say it
      observations->notes.push_back(
          {"readings.not-taken",
           {{"missing", static_cast<double>(observations->missing), Quantity::count}}});
    if (const std::size_t moved = join_targets(*observations); moved > 0)
      observations->notes.push_back(
          {"targets.joined", {{"readings", static_cast<double>(moved), Quantity::count}}});
    into = std::move(*observations);
    for (Remark note : into.notes) {
      note.measurement = m.id;
      out_.notes.push_back(std::move(note));
    }
    return {};
  }

  void note_input(const std::string& name, const std::string& digest_now) {
    for (const auto& [known, digest] : out_.inputs)
      if (known == input_name(name)) return;
    out_.inputs.emplace_back(input_name(name), digest_now);
  }

  /// The reader that is named, or the first that knows the content; none if no plugin reads this
  /// kind of measurement at all, which is noted and leaves the others to be evaluated. Where a
  /// plugin was refused, it may be the one that is wanted, and the measurement was not read.
  Expected<const Reader*> choose_reader(const Measurement& m, std::string_view bytes) {
    const auto& readers = context_.plugins->readers();
    if (!m.reader.empty()) {
      for (const Reader& r : readers)
        if (r.info.name == m.reader) return &r;
      return fail(
          at("measurement." + m.id + ".reader", context_.plugins->absence("reader", m.reader)));
    }
    bool any = false;
    if (bytes.find_first_not_of(" \t\r\n") == bytes.npos)
      return fail(Error{"expected readings, found an empty file", m.file});
    for (const Reader& r : readers) {
      const std::string who = "reader " + r.info.name;
      stage_(who + " (measurement " + m.id + "), asked whether it reads this file");
      const auto reads = process::guarded_answer(who, [&] { return r.reads(m.kind); });
      if (!reads) return fail(reads.error());
      any = any || *reads;
      const auto recognised = process::guarded_answer(
          who, [&] { return *reads && r.recognises(bytes.substr(0, 4096)); });
      if (!recognised) return fail(recognised.error());
      if (*recognised) return &r;
    }
    const std::string refused = context_.plugins->refusals();
    if (any)
      return fail(Error{"no reader knows the format of this file: " + what_is_wrong(bytes, m.file) +
                            "; or the format of an installed reader (`nonio plugins`)" +
                            (refused.empty() ? "" : "; of the plugins " + refused),
                        m.file, first_content_line(bytes)});
    if (!refused.empty())
      return fail(at("measurement." + m.id + ".kind", "no reader takes measurements of kind \"" +
                                                          m.kind + "\", and of the plugins " +
                                                          refused));
    out_.unread.push_back(m.id);
    out_.notes.push_back({"measurement.unread", {}, {{"kind", m.kind}}, m.id});
    return nullptr;
  }

  /// Takes the readings out that the manifest excludes, and says so.
  Expected<void> exclude(const Measurement& m, Observations& o) const {
    if (m.exclude.empty()) return {};
    const std::set<std::uint32_t> lines(m.exclude.begin(), m.exclude.end());
    for (const std::uint32_t line : lines)
      if (std::find(o.source_line.begin(), o.source_line.end(), line) == o.source_line.end())
        return fail(at("measurement." + m.id + ".exclude",
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

  /// The campaign's own effects join those of the plugins.
  void add_formulas() {
    const auto parts = model::parts_of(campaign(), out_.observations);
    for (const Formula& formula : campaign().formulas) {
      const auto blame = [&](const std::string& why) {
        report(Error{"model.formula \"" + formula.name + "\": " + why, config::manifest_name,
                     formula.line});
      };
      const auto same_name = [&](const Effect& e) { return e.info.name == formula.name; };
      if (std::any_of(out_.effects.begin(), out_.effects.end(), same_name)) {
        blame("an effect of the catalogue has this name");
        continue;
      }
      const Axis& axis = *campaign().machine.axis(formula.axis);  // the manifest was checked
      auto effect = config::formula_effect(formula, axis);
      if (!effect) {
        blame(effect.error().message);
        continue;
      }
      if (const std::string why = copied(parts, axis, *effect); !why.empty())
        blame(why);
      else
        out_.effects.push_back(std::move(*effect));
    }
  }

  std::string copied(const std::vector<model::Part>& parts, const Axis& axis,
                     const Effect& effect) const {
    for (const model::Part& part : parts) {
      if (std::none_of(part.axes.begin(), part.axes.end(),
                       [&](const Axis& a) { return a.name == axis.name; }) ||
          !effect.applies(part.table, axis))
        continue;
      const auto same = copy_of(part.table, axis, effect, out_.effects);
      if (!same) return same.error().message;
      if (*same == "zero") return "it says no more than the zero of a measurement";
      if (!same->empty()) return "it says the same as " + *same + " on these readings";
    }
    return {};
  }

  std::optional<Settings> settle(const Info& info) {
    auto options = config::settle_options(info, context_.site.options, out_.manifest->options);
    if (options) return std::move(*options);
    for (Error& e : options.error()) report(std::move(e));
    return std::nullopt;
  }

  const fs::path& folder_;
  const Context& context_;
  const Stage& stage_;
  ReadCampaign out_;
};

template <class Column>
void keep(Column& column, const std::vector<char>& kept) {
  if (column.empty()) return;
  std::size_t to = 0;
  for (std::size_t i = 0; i < kept.size(); ++i)
    if (kept[i] != 0) column[to++] = column[i];
  column.resize(to);
}

}  // namespace

void keep_rows(Observations& o, const std::vector<char>& kept) {
  for (auto& axis : o.axes) {
    keep(axis.position, kept);
    keep(axis.approach, kept);
  }
  for (auto* column : {&o.deviation, &o.u, &o.time, &o.material, &o.air, &o.pressure, &o.humidity})
    keep(*column, kept);
  for (auto* column : {&o.run, &o.line, &o.source_line}) keep(*column, kept);
  keep(o.sense, kept);
}

ReadCampaign read_campaign(const fs::path& folder, const Context& context, const Stage& stage) {
  return CampaignReader(folder, context, stage).read();
}

}  // namespace nonio::host::reading
