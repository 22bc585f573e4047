// SPDX-License-Identifier: Apache-2.0
#include "campaign/reading/measurement_reader.h"

#include <algorithm>
#include <map>
#include <set>

#include "campaign/reading/checked_read.h"
#include "campaign/reading/plausibility/plausibility.h"
#include "campaign/reading/unknown_format.h"
#include "nonio/sdk/observations.h"
#include "nonio/sdk/text.h"
#include "platform/process/guarded.h"
#include "platform/storage/digest.h"
#include "platform/storage/files.h"
#include "platform/storage/nearest.h"

namespace nonio::reading {

namespace {

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
    const auto reads = process::guarded_answer(who, [&] { return reading::reads(r, m, method); });
    if (!reads) return fail(reads.error());
    any = any || *reads;
    const auto recognised =
        process::guarded_answer(who, [&] { return *reads && r.recognises(head_of(bytes)); });
    if (!recognised) return fail(recognised.error());
    if (*recognised) return &r;
    if (!reads_columns_of(r, method)) continue;
    const auto knows = process::guarded_answer(who, [&] { return r.recognises(head_of(bytes)); });
    if (!knows) return fail(knows.error());
    if (*knows) return &r;
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
  const auto converted = utf8_of_utf16(file->bytes());
  if (!converted) return fail(converted.error());
  const std::string_view bytes = *converted ? std::string_view(**converted) : file->bytes();
  const auto reader = choose_reader(from, m, bytes, out);
  if (!reader) return fail(reader.error());
  if (*reader == nullptr) return {};
  const Info& info = (*reader)->info;
  const auto options = settle_reader(from, info, out);
  if (!options) return {};
  const std::string who = "reader " + info.name;
  from.stage(who + " (measurement " + m.id + ")");
  auto observations = checked_read(**reader, {bytes, out.manifest->campaign, m, *options,
                                              [&](std::size_t offset) {
                                                if (!*converted) file->release(offset);
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

}  // namespace

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

}  // namespace nonio::reading
