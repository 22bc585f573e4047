// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <numeric>

#include "campaign/config/manifest.h"
#include "campaign/modelling/model_fit.h"
#include "campaign/reading/checked_read.h"
#include "plugin_check/plugin_checks.h"

namespace nonio::plugin_check::kit {

namespace {

const Artifact* file_named(const Source& source, const std::string& name) {
  for (const Artifact& f : source.files)
    if (f.name == name) return &f;
  return nullptr;
}

const Reader* reader_of(const Measurement& m, const Method* method, std::string_view bytes,
                        const std::vector<Reader>& readers) {
  const Reader* of_columns = nullptr;
  for (const Reader& r : readers) {
    if (m.reader.empty() ? reading::reads(r, m, method) && r.recognises(reading::head_of(bytes))
                         : r.info.name == m.reader)
      return &r;
    if (!m.reader.empty() || !reading::reads_columns_of(r, method)) continue;
    if (r.recognises(reading::head_of(bytes))) return &r;
    if (of_columns == nullptr) of_columns = &r;
  }
  return of_columns;
}

}  // namespace

const Method* method_of(const Measurement& m, const std::vector<Method>& methods) {
  const auto found = std::find_if(methods.begin(), methods.end(), [&](const Method& one) {
    return one.info.name == method_name(m);
  });
  return found == methods.end() ? nullptr : &*found;
}

Expected<Sample> open_source(const Source& source, const std::vector<Reader>& readers,
                             const std::vector<Method>& methods) {
  auto manifest =
      config::parse_manifest(source.manifest, source.name + "/" + config::manifest_name, methods);
  if (!manifest) return fail(manifest.error().front());
  Sample s{source.name, std::move(manifest->campaign), std::move(manifest->options), {}};
  for (Axis& axis : s.campaign.machine.axes) {  // controllers require these data
    if (!axis.active_table) axis.active_table.emplace();
    if (!axis.active_backlash) axis.active_backlash = 0.0;
  }
  for (const Measurement& m : s.campaign.measurements) {
    const std::string place = "sample " + source.name + ", " + m.file;
    const Artifact* file = file_named(source, m.file);
    if (file == nullptr) return fail(place + ": there is no such file");
    const Method* method = method_of(m, methods);
    const Reader* reader = reader_of(m, method, file->bytes, readers);
    if (reader == nullptr) return fail(place + ": no reader recognizes it");
    const Settings options = settings_for(reader->info, s);
    auto read = reading::checked_read(*reader, {file->bytes, s.campaign, m, options, {}, method});
    if (!read) return fail(place + ": " + read.error().message);
    s.observations.push_back(std::move(*read));
  }
  return s;
}

std::vector<std::uint32_t> shuffled(std::size_t n, storage::Random& random) {
  std::vector<std::uint32_t> order(n);
  std::iota(order.begin(), order.end(), 0U);
  for (std::size_t i = n; i > 1; --i)
    std::swap(order[i - 1],
              order[static_cast<std::size_t>(random.uniform() * static_cast<double>(i))]);
  return order;
}

std::vector<std::pair<std::string, Observations>> odd_tables(const Observations& o) {
  std::vector<std::pair<std::string, Observations>> all;
  all.emplace_back("no readings", rearranged(o, {}));
  all.emplace_back("one reading", rearranged(o, {0}));
  std::vector<std::uint32_t> same(9, static_cast<std::uint32_t>(o.size() / 2)), plus;
  all.emplace_back("one target", rearranged(o, same));
  for (std::uint32_t i = 0; i < o.size(); ++i)
    if (o.axes.empty() || o.axes.front().approach.empty() || o.axes.front().approach[i] > 0)
      plus.push_back(i);
  all.emplace_back("one direction", rearranged(o, plus));
  Observations bare = o;
  for_each_measured_column([](auto& column) { column.clear(); }, bare);
  all.emplace_back("positions only", bare);
  Observations huge = o;
  for (auto& axis : huge.axes)
    for (double& x : axis.position) x *= 1e150;
  all.emplace_back("huge positions", std::move(huge));
  Observations blank = o;
  for (auto* column : {&blank.time, &blank.material})
    for (std::size_t i = 0; i < column->size(); i += 3) (*column)[i] = std::nan("");
  all.emplace_back("times and temperatures missing", std::move(blank));
  return all;
}

namespace {

config::MachineRecord record_for(const Sample& sample) {
  config::MachineRecord record;
  for (const Axis& a : sample.campaign.machine.axes)
    record.axes[a.name] = {.rotary = a.rotary,
                           .settings = {{"number", static_cast<double>(record.axes.size() + 1)}}};
  return record;
}

/// Sets encoder resolutions for controllers whose table entries are in counts: 62500 counts per mm,
/// so that 1/16 count is 1 nm, and 3600 counts per degree.
void add_encoders(Settings& settings, const Info& info, const Machine& machine) {
  for (const Option& o : info.options) {
    if (o.name != "axes" || o.help.find("counts_per_mm") == o.help.npos) continue;
    auto entries = settings.values.find(o.name);
    if (entries == settings.values.end()) continue;
    auto* tables = std::get_if<NumberTables>(&entries->second);
    if (tables == nullptr) continue;
    for (const Axis& axis : machine.axes)
      (*tables)[axis.name].emplace(axis.rotary ? "counts_per_deg" : "counts_per_mm",
                                   axis.rotary ? 3600.0 : 62500.0);
  }
}

Settings or_defaults(config::Checked<Settings> settled, const Info& info) {
  if (settled) return std::move(*settled);
  Settings defaults;
  for (const Option& o : info.options) defaults.values[o.name] = o.default_value;
  return defaults;
}

}  // namespace

Settings settings_for(const Info& info, const Sample& sample) {
  return or_defaults(config::settle_options(info, {}, sample.options), info);
}

Settings settings_for(const Output& output, const Sample& sample) {
  return settings_for(output.info, sample);
}

Settings settings_for(const Controller& controller, const Sample& sample) {
  config::Manifest manifest;
  manifest.campaign = sample.campaign;
  manifest.options = sample.options;
  const config::MachineRecord record = record_for(sample);
  Settings settings = or_defaults(
      config::settle_table_options(controller.info, {}, manifest, &record), controller.info);
  add_encoders(settings, controller.info, sample.campaign.machine);
  return settings;
}

Results results_of(const Sample& s, const Bench& bench) {
  if (s.results) return *s.results;
  Results results;
  const auto add = [&](const Analysis& a, const Measurement* m, const auto& call) {
    auto evaluation = process::guarded("analysis " + a.info.name, call);
    if (!evaluation) return;
    const std::string id = m == nullptr ? "" : m->id;
    for (Finding& f : evaluation->findings) f.measurement = id;
    results.analyses.push_back({a.info.name, a.info.version, id, std::move(*evaluation)});
  };
  for (const Analysis& a : bench.analyses) {
    const Settings options = settings_for(a.info, s);
    if (a.analyse_campaign)
      add(a, nullptr, [&] { return a.analyse_campaign({s.campaign, s.observations, options}); });
    for (const Measurement& m : s.campaign.measurements)
      if (a.applies && a.applies(s.campaign, m))
        add(a, &m, [&] { return a.analyse({s.campaign, m, s.of(m), options, &s.observations}); });
  }
  if (s.campaign.model.empty()) return results;
  reading::ReadCampaign read;
  read.manifest.emplace().campaign = s.campaign;
  read.observations = s.observations;
  read.effects = bench.effects;
  auto fitted =
      process::guarded("the model", [&] { return modelling::model_fit(read, bench.context); });
  if (!fitted) return results;
  results.models = std::move(fitted->models);
  for (auto& one : fitted->analyses) results.analyses.push_back(std::move(one));
  return results;
}

}  // namespace nonio::plugin_check::kit
