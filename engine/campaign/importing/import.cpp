// SPDX-License-Identifier: Apache-2.0
#include "campaign/importing/import.h"

#include <algorithm>
#include <cstring>
#include <set>
#include <sstream>
#include <tuple>

#include "campaign/config/toml_reader.h"
#include "campaign/evaluation/evaluate.h"
#include "campaign/reading/checked_read.h"
#include "campaign/reading/unknown_format.h"
#include "nonio/sdk/text.h"
#include "platform/storage/digest.h"
#include "platform/storage/files.h"

namespace nonio::importing {
namespace fs = std::filesystem;

namespace {

std::string iso_date(const std::string& date) {
  if (date.size() != 8) return date;
  return date.substr(0, 4) + "-" + date.substr(4, 2) + "-" + date.substr(6);
}

std::optional<std::string> filled_in(const std::string& text, const Places& places) {
  std::string out;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const std::size_t close = text[i] == '{' ? text.find('}', i) : std::string::npos;
    if (close == std::string::npos) {
      out += text[i];
      continue;
    }
    const std::string name = text.substr(i + 1, close - i - 1);
    const auto place = places.find(name);
    if (place == places.end()) return std::nullopt;
    out += name == "date" ? iso_date(place->second) : place->second;
    i = close;
  }
  return out;
}

/// Without `campaign` in the rule, the id consists of date and placeholders except axis and id.
/// Capital letters become small letters, blanks become "-".
std::string campaign_of(const ImportRule& rule, const Places& places) {
  std::string id;
  if (!rule.campaign.empty()) {
    id = filled_in(rule.campaign, places).value_or("");
  } else {
    if (const auto date = places.find("date"); date != places.end()) id = iso_date(date->second);
    for (const auto& [name, value] : places)
      if (name != "axis" && name != "id" && name != "date") id += (id.empty() ? "" : "-") + value;
  }
  for (char& c : id)
    if (c >= 'A' && c <= 'Z')
      c = static_cast<char>(c + 32);
    else if (c == ' ')
      c = '-';
  return id;
}

/// The digest depends on the readings only, not on line ends or comments; empty without readings.
std::string digest_of(const Observations& o) {
  std::string bytes;
  const auto put = [&](const auto& column) {
    for (const auto& value : column) {
      char raw[sizeof(value)];
      std::memcpy(raw, &value, sizeof(value));
      bytes.append(raw, sizeof(value));
    }
  };
  put(o.deviation);
  put(o.run);
  for (const auto& axis : o.axes) {
    put(axis.position);
    put(axis.approach);
  }
  return bytes.empty() ? "" : storage::sha256(bytes);
}

struct Found {
  std::string file, bytes;
  Places places;
};

class Importer {
 public:
  Importer(const ImportRequest& request, const loader::Plugins& plugins)
      : request_(request), plugins_(plugins) {}

  Expected<ImportReport> import() {
    if (auto ok = look(); !ok) return fail(ok.error());
    for (auto& [id, files] : campaigns_)
      if (auto ok = make(id, files); !ok) return fail(ok.error());
    return std::move(report_);
  }

 private:
  std::string say(const char* name, const config::TerminalWords::Parts& parts = {}) const {
    return request_.say(name, parts);
  }

  Expected<std::vector<std::string>> files() const {
    std::error_code error;
    const fs::path root = fs::canonical(request_.folder, error);
    if (error) return fail("cannot find the folder " + request_.folder.string());
    const fs::path out = fs::weakly_canonical(request_.out, error);
    if (const fs::path below = out.lexically_relative(root);
        !below.empty() && *below.begin() != "..")
      return fail("expected a site outside of the folder that is imported, found " + out.string());
    std::vector<std::string> names;
    fs::recursive_directory_iterator it(root, error), end;
    for (; !error && it != end; it.increment(error))
      if (it->is_regular_file(error) && !it->is_symlink(error))
        names.push_back(it->path().lexically_relative(root).generic_string());
    if (error) return fail("cannot read " + root.string() + ": " + error.message());
    std::sort(names.begin(), names.end());
    return names;
  }

  Expected<void> look() {
    NONIO_TRY(const auto names, files());
    std::map<std::string, std::string> first;
    for (const std::string& name : names) {
      const auto excluded =
          std::find_if(request_.rule.exclude.begin(), request_.rule.exclude.end(),
                       [&](const std::string& part) { return name.find(part) != name.npos; });
      if (excluded != request_.rule.exclude.end()) {
        report_.excluded.push_back({name, say("import.why.excluded", {{"text", *excluded}})});
        continue;
      }
      const auto ways = readings_of_name(request_.rule, name);
      if (ways.size() != 1) {
        report_.unmatched.push_back(
            {name, say(ways.empty() ? "import.why.no-match" : "import.why.two-ways")});
        continue;
      }
      const auto path = storage::path_inside(request_.folder, name);
      NONIO_TRY(auto bytes, path ? storage::read_file(*path) : fail(path.error()));
      const auto [same, fresh] = first.try_emplace(storage::sha256(bytes), name);
      if (!fresh) {
        report_.duplicates.push_back(
            {name, say("import.why.same-bytes", {{"file", same->second}})});
        continue;
      }
      campaigns_[campaign_of(request_.rule, ways[0])].push_back({name, std::move(bytes), ways[0]});
    }
    return {};
  }

  Expected<void> make(const std::string& id, std::vector<Found>& found) {
    ImportedCampaign campaign;
    campaign.id = id;
    if (!config::is_campaign_id(id))
      campaign.lacks.push_back(say("import.lack.id", {{"found", id}}));
    std::set<std::string> names, ids;
    for (const Found& f : found) campaign.files.push_back(file_of(f, names, ids));
    if (config::is_campaign_id(id) && is_there(request_.out / id, campaign, found)) {
      campaign.there = true;
      for (ImportedFile& file : campaign.files) file.lacks.clear();
      report_.campaigns.push_back(std::move(campaign));
      return {};
    }
    check(campaign, found);
    std::error_code error;
    const fs::path folder = request_.out / id;
    if (config::is_campaign_id(id) && fs::exists(fs::symlink_status(folder, error)))
      campaign.lacks.push_back(say("import.lack.exists", {{"folder", folder.string()}}));
    const bool may = config::is_campaign_id(id) && !fs::exists(fs::symlink_status(folder, error));
    if (may && !request_.dry_run && (campaign.whole() || request_.partial)) {
      std::vector<Artifact> artifacts;
      for (std::size_t i = 0; i < found.size(); ++i)
        if (!campaign.files[i].name.empty())
          artifacts.push_back({campaign.files[i].name, std::move(found[i].bytes)});
      artifacts.push_back(
          {config::manifest_name,
           // last, because a process that sees the manifest requires the other files
           manifest_of(campaign, found.front().places)});
      if (auto ok = storage::publish(folder, artifacts); !ok) return ok;
      campaign.written = true;
    }
    report_.campaigns.push_back(std::move(campaign));
    return {};
  }

  /// A folder with these files and a measurement for each was imported before, even if its manifest
  /// was completed since.
  static bool is_there(const fs::path& folder, const ImportedCampaign& campaign,
                       const std::vector<Found>& found) {
    std::error_code error;
    if (!fs::is_directory(fs::symlink_status(folder, error))) return false;
    const auto text = storage::read_file(folder / config::manifest_name);
    const auto manifest =
        text ? config::parse_without_methods(*text, config::manifest_name)
             : config::Checked<config::Manifest>(tl::unexpected(std::vector<Error>{}));
    if (!manifest || manifest->campaign.id != campaign.id) return false;
    const auto& measurements = manifest->campaign.measurements;
    for (std::size_t i = 0; i < found.size(); ++i) {
      const std::string& name = campaign.files[i].name;
      const bool measured = std::any_of(measurements.begin(), measurements.end(),
                                        [&](const Measurement& m) { return m.file == name; });
      const auto path = storage::path_inside(folder, name);
      const auto bytes =
          measured && path ? storage::read_file(*path) : Expected<std::string>(fail(""));
      if (!bytes || *bytes != found[i].bytes) return false;
    }
    return true;
  }

  ImportedFile file_of(const Found& f, std::set<std::string>& names,
                       std::set<std::string>& ids) const {
    ImportedFile file;
    file.file = f.file;
    file.reader = request_.rule.reader;
    const std::string name = fs::path(f.file).filename().string();
    if (!storage::is_artifact_name(name) || name == config::manifest_name)
      file.lacks.push_back(say("import.lack.plain-name", {{"name", name}}));
    else if (!names.insert(name).second)
      file.lacks.push_back(say("import.lack.same-name", {{"name", name}}));
    else
      file.name = name;
    if (const auto axis = f.places.find("axis"); axis != f.places.end())
      take_axis(axis->second, file);
    else if (!request_.rule.axis.empty())
      file.axis = request_.rule.axis,
      file.assumed.push_back(say("import.axis.rule", {{"name", file.axis}}));
    else if (request_.rule.kind != "observations")
      file.lacks.push_back(say("import.lack.axis"));
    const auto own = f.places.find("id");
    file.measurement = own != f.places.end() ? own->second : file.axis;
    if (file.measurement.empty()) file.measurement = fs::path(f.file).stem().string();
    if (!ids.insert(file.measurement).second)
      file.lacks.push_back(say("import.lack.same-id", {{"measurement", file.measurement}}));
    return file;
  }

  void take_axis(const std::string& word, ImportedFile& file) const {
    file.axis = word;
    if (const auto stated = request_.rule.axes.find(word); stated != request_.rule.axes.end())
      file.axis = stated->second;
    else if (file.axis[0] >= 'a' && file.axis[0] <= 'z')
      file.axis[0] = static_cast<char>(file.axis[0] - 32);
    if (file.axis != word)
      file.assumed.push_back(
          say(request_.rule.axes.empty() ? "import.axis.name" : "import.axis.name-rule",
              {{"name", file.axis}, {"word", word}}));
  }

  std::string manifest_of(const ImportedCampaign& campaign, const Places& places) const {
    toml::table root;
    if (auto extra = config::parse_toml(request_.rule.manifest, "rule"); extra)
      root = std::move(*extra);
    if (!root.contains("campaign")) root.insert("campaign", toml::table{});
    if (toml::table* own = root["campaign"].as_table()) {
      own->insert_or_assign("id", campaign.id);
      if (const auto date = places.find("date"); date != places.end() && !own->contains("date"))
        if (auto parsed = config::parse_toml("d = " + iso_date(date->second), "date"))
          own->insert("date", *(*parsed)["d"].as_date());
    }
    if (!root.contains("machine")) root.insert("machine", toml::table{});
    if (toml::table* machine = root["machine"].as_table()) put_machine(*machine, places);
    std::ostringstream out;
    for (const std::string& lack : campaign.lacks) out << "# to fill: " << one_line(lack) << "\n";
    out << "format = 1\n\n" << root << "\n";
    for (const ImportedFile& f : campaign.files) {
      out << "\n[[measurement]]\n";
      for (const std::string& lack : f.lacks) out << "# to fill: " << one_line(lack) << "\n";
      toml::table m{{"id", f.measurement}, {"kind", request_.rule.kind}};
      if (!f.axis.empty()) m.insert("axis", f.axis);
      m.insert("file", f.name);
      if (!request_.rule.reader.empty()) m.insert("reader", request_.rule.reader);
      out << m << "\n";
    }
    return out.str();
  }
  /// The request has precedence over the rule's manifest, which has precedence over the file name.
  void put_machine(toml::table& machine, const Places& places) const {
    for (const auto& [key, place, said] :
         {std::tuple("asset", "asset", &request_.asset),
          {"maker", "maker", &request_.maker},
          {"model", "machine", static_cast<const std::string*>(nullptr)},
          {"serial", "serial", &request_.serial}}) {
      const auto named = places.find(place);
      if (said != nullptr && !said->empty())
        machine.insert_or_assign(key, *said);
      else if (named != places.end() && !machine.contains(key))
        machine.insert(key, named->second);
    }
  }

  static std::string one_line(std::string text) {
    std::replace_if(
        text.begin(), text.end(), [](char c) { return static_cast<unsigned char>(c) < 0x20; }, ' ');
    return text;
  }

  void check(ImportedCampaign& campaign, const std::vector<Found>& found) {
    if (const auto manifest = manifest_to_read(campaign, found.front().places)) {
      const Machine& machine = manifest->campaign.machine;
      campaign.asset = machine.asset, campaign.maker = machine.maker;
      campaign.serial = machine.serial;
      std::map<std::string, std::string> first;
      auto measurement = manifest->campaign.measurements.begin();
      for (std::size_t i = 0; i < found.size(); ++i) {
        ImportedFile& file = campaign.files[i];
        if (!can_be_read(file)) continue;
        const std::string digest = look_into(*manifest, *measurement++, file, found[i]);
        if (digest.empty()) continue;
        const auto [same, fresh] = first.try_emplace(digest, file.file);
        if (fresh) continue;
        file.same_as = same->second;
        file.lacks = {
            say("import.lack.same-readings", {{"file", file.same_as}, {"own", file.file}})};
      }
    }
    const bool asked = std::any_of(campaign.files.begin(), campaign.files.end(),
                                   [](const ImportedFile& f) { return !f.lacks.empty(); });
    if (asked || !campaign.lacks.empty()) return;
    const auto manifest = config::parse_manifest(manifest_of(campaign, found.front().places),
                                                 config::manifest_name, plugins_.methods());
    if (!manifest)
      for (const Error& e : manifest.error()) campaign.lacks.push_back(e.message);
  }

  bool can_be_read(const ImportedFile& file) const {
    return !file.axis.empty() || request_.rule.kind == "observations";
  }

  config::Checked<config::Manifest> manifest_to_read(const ImportedCampaign& campaign,
                                                     const Places& places) const {
    ImportedCampaign all;
    all.id = "import";
    for (const ImportedFile& file : campaign.files) {
      if (!can_be_read(file)) continue;
      ImportedFile own;
      own.axis = file.axis;
      own.name = own.measurement = "m" + std::to_string(all.files.size());
      all.files.push_back(std::move(own));
    }
    return config::parse_manifest(manifest_of(all, places), config::manifest_name,
                                  plugins_.methods());
  }

  /// Returns the digest of the readings; empty if the file cannot be read.
  std::string look_into(const config::Manifest& manifest, Measurement m, ImportedFile& file,
                        const Found& found) const {
    m.id = file.measurement;
    m.file = fs::path(file.file).filename().string();
    const auto obs = read(manifest, m, found, file.reader);
    if (!obs) {
      const Error& e = obs.error();
      file.lacks.push_back((e.line != 0 ? "line " + std::to_string(e.line) + ": " : "") +
                           e.message);
      return {};
    }
    file.readings = obs->size();
    file.missing = obs->missing;
    return digest_of(*obs);
  }

  Expected<Observations> read(const config::Manifest& manifest, const Measurement& m,
                              const Found& found, std::string& name) const {
    NONIO_TRY(const auto converted, utf8_of_utf16(found.bytes));
    const std::string& bytes = converted ? *converted : found.bytes;
    const Reader* reader = nullptr;
    for (const Reader& r : plugins_.readers()) {
      if (!name.empty() ? r.info.name == name
                        : r.reads(m.kind) && r.recognises(reading::head_of(bytes)))
        reader = reader == nullptr ? &r : reader;
    }
    if (reader == nullptr)
      return fail(name.empty() ? "no reader recognizes the format of this file: " +
                                     reading::what_is_wrong(bytes, found.file)
                               : plugins_.absence("reader", name));
    name = reader->info.name;
    const auto options = config::settle_options(reader->info, site_options(), manifest.options,
                                                plugins_.options_of_namesakes(reader->info));
    if (!options) return fail(options.error().front());
    return reading::checked_read(
        *reader, {bytes, manifest.campaign, m, *options, {}, plugins_.method(m.kind)});
  }

  config::RawOptions site_options() const {
    const auto text = storage::read_file(request_.out / "site.toml");
    if (!text) return {};
    auto site = config::parse_site(*text, "site.toml");
    return site ? std::move(site->options) : config::RawOptions{};
  }

  const ImportRequest& request_;
  const loader::Plugins& plugins_;
  std::map<std::string, std::vector<Found>> campaigns_;
  ImportReport report_;
};

}  // namespace

bool ImportedCampaign::whole() const {
  return lacks.empty() && std::all_of(files.begin(), files.end(),
                                      [](const ImportedFile& f) { return f.lacks.empty(); });
}

Expected<ImportReport> import_folder(const ImportRequest& request, const loader::Plugins& plugins) {
  return Importer(request, plugins).import();
}

}  // namespace nonio::importing
