// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <numeric>

#include "host/config/manifest.h"
#include "host/modelling/model_fit.h"
#include "host/plugin_check/plugin_checks.h"
#include "host/process/guarded.h"

namespace nonio::host::plugin_check::kit {

namespace {

const Artifact* file_named(const Source& source, const std::string& name) {
  for (const Artifact& f : source.files)
    if (f.name == name) return &f;
  return nullptr;
}

const Reader* reader_of(const Measurement& m, std::string_view bytes,
                        const std::vector<Reader>& readers) {
  for (const Reader& r : readers)
    if (m.reader.empty() ? r.reads(m.kind) && r.recognises(bytes.substr(0, 4096))
                         : r.info.name == m.reader)
      return &r;
  return nullptr;
}

template <class Column>
void rearrange(Column& column, const std::vector<std::size_t>& order) {
  if (column.empty()) return;
  Column out;
  for (const std::size_t i : order) out.push_back(column[i]);
  column = std::move(out);
}

}  // namespace

Expected<Sample> open_source(const Source& source, const std::vector<Reader>& readers) {
  auto manifest =
      config::parse_manifest(source.manifest, source.name + "/" + config::manifest_name);
  if (!manifest) return fail(manifest.error().front());
  Sample s{source.name, std::move(manifest->campaign), std::move(manifest->options), {}};
  for (const Measurement& m : s.campaign.measurements) {
    const std::string place = "sample " + source.name + ", " + m.file;
    const Artifact* file = file_named(source, m.file);
    if (file == nullptr) return fail(place + ": there is no such file");
    const Reader* reader = reader_of(m, file->bytes, readers);
    if (reader == nullptr) return fail(place + ": no reader knows it");
    const Settings options = settings_for(reader->info, s);
    auto read = process::guarded("reader " + reader->info.name, [&] {
      return reader->read({file->bytes, s.campaign, m, options});
    });
    if (!read) return fail(place + ": " + read.error().message);
    if (const std::string why = reading::unsound(*read); !why.empty())
      return fail(place + ": " + why);
    s.observations.push_back(std::move(*read));
  }
  return s;
}

std::vector<std::size_t> shuffled(std::size_t n, storage::Random& random) {
  std::vector<std::size_t> order(n);
  std::iota(order.begin(), order.end(), std::size_t{0});
  for (std::size_t i = n; i > 1; --i)
    std::swap(order[i - 1],
              order[static_cast<std::size_t>(random.uniform() * static_cast<double>(i))]);
  return order;
}

Observations rearranged(const Observations& o, const std::vector<std::size_t>& order) {
  Observations out = o;
  for (auto& axis : out.axes) {
    rearrange(axis.position, order);
    rearrange(axis.approach, order);
  }
  for (auto* column :
       {&out.deviation, &out.u, &out.time, &out.material, &out.air, &out.pressure, &out.humidity})
    rearrange(*column, order);
  for (auto* column : {&out.run, &out.line, &out.source_line}) rearrange(*column, order);
  rearrange(out.sense, order);
  return out;
}

std::vector<std::pair<std::string, Observations>> odd_tables(const Observations& o) {
  std::vector<std::pair<std::string, Observations>> all;
  all.emplace_back("no readings", rearranged(o, {}));
  all.emplace_back("one reading", rearranged(o, {0}));
  std::vector<std::size_t> same(9, o.size() / 2), plus;
  all.emplace_back("one target", rearranged(o, same));
  for (std::size_t i = 0; i < o.size(); ++i)
    if (o.axes.front().approach.empty() || o.axes.front().approach[i] > 0) plus.push_back(i);
  all.emplace_back("one direction", rearranged(o, plus));
  Observations bare = o;
  for (auto* column : {&bare.time, &bare.material, &bare.air, &bare.u}) column->clear();
  for (auto* column : {&bare.run, &bare.source_line}) column->clear();
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

/// How its control counts the axes: by their places, so that tables of every control are written.
config::MachineRecord record_for(const Sample& sample) {
  config::MachineRecord record;
  for (const Axis& a : sample.campaign.machine.axes)
    record.axes[a.name] = {.rotary = a.rotary,
                           .settings = {{"number", static_cast<double>(record.axes.size() + 1)}}};
  return record;
}

/// Of controls that count: nobody but the machine's builder knows how many counts an axis has. So
/// many that a sixteenth of one is a nanometre.
void add_encoders(Settings& settings, const Info& info, const Machine& machine) {
  for (const Option& o : info.options) {
    if (o.name != "axes" || o.help.find("counts_per_mm") == o.help.npos) continue;
    auto entries = settings.values.find(o.name);
    if (entries == settings.values.end()) continue;
    auto* list = std::get_if<std::vector<std::string>>(&entries->second);
    for (const Axis& axis : machine.axes) {
      const std::string counts = axis.rotary ? " counts_per_deg=3600" : " counts_per_mm=62500";
      if (list == nullptr) continue;
      const auto own = std::find_if(list->begin(), list->end(), [&](const std::string& entry) {
        return entry.starts_with(axis.name + " ");
      });
      if (own == list->end())
        list->push_back(axis.name + counts);
      else if (own->find(" counts_per") == own->npos)
        *own += counts;
    }
  }
}

Settings or_defaults(config::Checked<Settings> settled, const Info& info) {
  if (settled) return std::move(*settled);
  Settings defaults;
  for (const Option& o : info.options) defaults.values[o.name] = o.otherwise;
  return defaults;
}

}  // namespace

Settings settings_for(const Info& info, const Sample& sample) {
  return or_defaults(config::settle_options(info, {}, sample.options), info);
}

Settings settings_for(const Output& output, const Sample& sample) {
  if (output.stage != Output::Stage::table) return settings_for(output.info, sample);
  config::Manifest manifest;
  manifest.campaign = sample.campaign;
  manifest.options = sample.options;
  const config::MachineRecord record = record_for(sample);
  Settings settings =
      or_defaults(config::settle_table_options(output.info, {}, manifest, &record), output.info);
  add_encoders(settings, output.info, sample.campaign.machine);
  return settings;
}

Results results_of(const Sample& s, const Bench& bench) {
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

}  // namespace nonio::host::plugin_check::kit
