// SPDX-License-Identifier: Apache-2.0
#include <unistd.h>

#include <algorithm>
#include <iostream>
#include <map>
#include <memory>
#include <set>

#include "axis_argument.h"
#include "campaign/config/site_files.h"
#include "campaign/evaluation/evaluate.h"
#include "campaign/reading/campaign_reader.h"
#include "campaign/reading/unknown_format.h"
#include "new_text.h"
#include "nonio/sdk/format.h"
#include "platform/storage/files.h"
#include "platform/storage/json_values.h"
#include "platform/storage/nearest.h"
#include "questions.h"
#include "site_words.h"
#include "verbs.h"

namespace nonio::app {
using storage::Json;
namespace fs = std::filesystem;

namespace {

struct NewWish {
  std::string what, folder, id, customer, operator_name, date, maker, machine, serial, asset,
      control, instrument, laboratory, address, country;
  std::vector<std::string> axes, files, columns, settings;
  bool empty = false, defaults = false;
};

struct NewFiles {
  fs::path folder;
  std::vector<Artifact> files;
};

/// Returns the nearest parent folder with a site.toml, otherwise the direct parent folder if it
/// contains another campaign.
std::optional<fs::path> site_above(const fs::path& folder) {
  std::error_code error;
  for (fs::path up = folder.parent_path(); !up.empty(); up = up.parent_path()) {
    if (fs::exists(up / config::site_name, error)) return up;
    if (up == up.parent_path()) break;
  }
  for (const auto& entry : fs::directory_iterator(folder.parent_path(), error))
    if (fs::exists(entry.path() / config::manifest_name, error)) return folder.parent_path();
  return std::nullopt;
}

fs::path holder_of(const std::string& id, const fs::path& site) {
  std::error_code error;
  // A folder without site.toml is not searched, because it may be a home folder.
  if (!fs::exists(site / config::site_name, error)) return {};
  fs::recursive_directory_iterator it(site, fs::directory_options::skip_permission_denied, error);
  for (; !error && it != fs::recursive_directory_iterator(); it.increment(error)) {
    if (it->path().filename().string().starts_with('.')) it.disable_recursion_pending();
    if (it->path().filename() != config::manifest_name) continue;
    if (const auto text = storage::read_file(it->path()); text && config::extract_id(*text) == id)
      return it->path().parent_path();
  }
  return {};
}

std::vector<std::string> words_of(const std::string& text) {
  std::vector<std::string> words;
  std::string word;
  for (const char c : text + " ")
    if (c != ' ' && c != '\t')
      word += c;
    else if (!word.empty())
      words.push_back(std::exchange(word, {}));
  return words;
}
Expected<void> one_line(const std::string& option, const std::string& text) {
  for (const char c : text)
    if (static_cast<unsigned char>(c) < 0x20 || c == 0x7f)
      return fail(option + ": expected a text of one line");
  return {};
}

Expected<std::vector<NewAxis>> axes_of(const std::vector<std::string>& texts) {
  std::vector<NewAxis> axes;
  for (const std::string& text : texts) {
    NONIO_TRY(const auto axis, axis_of(text));
    for (const NewAxis& other : axes)
      if (other.axis.name == axis.name) return fail("--axis: " + axis.name + " is given twice");
    axes.push_back({.axis = axis, .file = {}, .bytes = {}});
  }
  return axes;
}

std::string lower(std::string text) {
  for (char& c : text)
    if (c >= 'A' && c <= 'Z') c = static_cast<char>(c + 32);
  return text;
}

/// `text` is AXIS=PATH, such as "X=path.csv". An axis that is not in `axes` is added.
Expected<void> take_file(const std::string& text, std::vector<NewAxis>& axes) {
  const std::size_t equals = text.find('=');
  if (equals == 0 || equals == std::string::npos || equals + 1 == text.size())
    return fail("--file: expected AXIS=PATH such as X=x.csv, found \"" + text + "\"");
  const std::string name = text.substr(0, equals);
  const fs::path path = text.substr(equals + 1);
  if (!is_axis_name(name))
    return fail("--file: expected an axis of capital letters and digits, found \"" + name + "\"");
  auto it =
      std::find_if(axes.begin(), axes.end(), [&](const NewAxis& a) { return a.axis.name == name; });
  if (it == axes.end())
    it = axes.insert(axes.end(), {.axis = axis_named(name), .file = {}, .bytes = {}});
  if (!it->file.empty()) return fail("--file: axis " + name + " has two files");
  NONIO_TRY(auto bytes, storage::read_file(path));
  if (bytes.empty()) return fail("--file: " + path.string() + " is empty");
  it->file = path.filename().string();
  if (!storage::is_artifact_name(it->file) || it->file == config::manifest_name)
    return fail("--file: expected a plain file name, found \"" + it->file + "\"");
  it->bytes = std::move(bytes);
  return {};
}

struct Setting {
  const char* key;
  /// English, because a new site has no language yet; empty for `new.ask.` and the key in the words.
  const char* question = "";
};

/// Keys that a certificate requires, except the contributions to the uncertainty, which a person
/// must judge.
constexpr Setting for_certificates = {"laboratory.authoriser",
                                      "Person who approves certificates (empty: none are issued)"};
constexpr Setting signing_settings[] = {
    {"signing.pkcs12", "Key that signs certificates, a PKCS#12 file (empty: none)"},
    {"signing.password_file", "File with the password of the key"},
    {"signing.trust", "PEM file with the root of the signer's certificate"}};
constexpr Setting campaign_settings[] = {{"campaign.customer_address"}, {"campaign.site"}};
constexpr Setting instrument_settings[] = {{"instrument.maker"},      {"instrument.serial"},
                                           {"instrument.calibrated"}, {"instrument.certificate"},
                                           {"instrument.U_fixed_um"}, {"instrument.U_per_m_um"}};

using Values = std::map<std::string, std::string>;

Expected<void> ask_for(const Setting& one, const std::string& otherwise, Values& values,
                       Questions& ask) {
  const std::string question =
      *one.question != '\0' ? one.question : ask.say.of("new.ask", one.key);
  if (auto done = ask.text(question, values[one.key], otherwise); !done) return done;
  return one_line(one.key, values[one.key]);
}

Expected<void> set_all(const Values& values, std::string& text) {
  for (const auto& [key, value] : values)
    if (!value.empty() && !set_offered(text, key, value))
      return fail("--set: the new file offers no key " + key +
                  "; expected one of its keys with the table, such as instrument.serial");
  return {};
}

std::optional<Campaign> last_campaign(const fs::path& site) {
  std::optional<Campaign> last;
  std::error_code error;
  for (const auto& entry : fs::directory_iterator(site, error)) {
    const auto text = storage::read_small_file(entry.path() / config::manifest_name);
    if (!text) continue;
    auto read = config::parse_without_methods(*text, config::manifest_name);
    if (read && (!last || read->campaign.date > last->date)) last = std::move(read->campaign);
  }
  return last;
}

std::string um_text(const std::optional<double>& m) {
  std::string text;
  if (m) append_shortest(text, printed(*m, Quantity::deviation));
  return text;
}

Values known_instrument(const std::optional<Campaign>& last, const std::string& model) {
  if (!last || last->instrument.model.empty() || last->instrument.model != model) return {};
  const Instrument& i = last->instrument;
  return {{"instrument.maker", i.maker},
          {"instrument.serial", i.serial},
          {"instrument.calibrated", i.calibrated},
          {"instrument.certificate", i.certificate},
          {"instrument.U_fixed_um", um_text(i.U_fixed)},
          {"instrument.U_per_m_um", um_text(i.U_per_length)}};
}

Expected<void> ask_for_certificate(const NewCampaign& c, const fs::path& site, Values& values,
                                   Questions& ask) {
  std::string digest;
  const auto settings = config::read_site(site, digest);
  if (!settings || settings->laboratory.authoriser.empty()) return {};
  for (const Setting& one : campaign_settings)
    if (auto done = ask_for(one, "", values, ask); !done) return done;
  if (c.instrument.empty()) return {};
  const Values known = known_instrument(last_campaign(site), c.instrument);
  for (const Setting& one : instrument_settings) {
    const auto before = known.find(one.key);
    if (auto done = ask_for(one, before == known.end() ? "" : before->second, values, ask); !done)
      return done;
  }
  return {};
}

/// The default id is made from the name of the folder.
Expected<std::string> id_of(const NewWish& wish, const fs::path& folder, Questions& ask) {
  std::string id = wish.id, near = valid_id(folder.filename().string());
  if (!config::is_campaign_id(near)) near = "campaign-" + near;
  if (auto done = ask.text(ask.say("new.ask.id"), id, near); !done) return fail(done.error());
  if (!config::is_campaign_id(id)) {
    const std::string nearest = valid_id(id);
    return fail(
        "id: expected a-z 0-9 . _ - and no more than 100, not starting with . or -; found \"" + id +
        "\"" + (config::is_campaign_id(nearest) ? " (nearest: \"" + nearest + "\")" : ""));
  }
  if (const auto site = site_above(folder))
    if (const fs::path other = holder_of(id, *site); !other.empty())
      return fail("id: " + other.string() + " has the id \"" + id + "\"; expected another (--id)");
  return id;
}

Expected<std::vector<NewAxis>> axes_with_files(const NewWish& wish, Questions& ask) {
  std::vector<std::string> texts = wish.axes, files = wish.files;
  const bool asks = texts.empty() && files.empty();
  if (asks) {
    std::string typed;
    if (auto done = ask.text(ask.say("new.ask.axes"), typed, "X=0:500"); !done)
      return fail(done.error());
    texts = words_of(typed);
  }
  auto axes = axes_of(texts);
  if (!axes) return fail(axes.error());
  if (asks && ask.asks())
    for (const NewAxis& a : *axes) {
      std::string path;
      const std::string question = ask.say("new.ask.file", {{"axis", a.axis.name}});
      if (auto done = ask.text(question, path, ""); !done) return fail(done.error());
      if (!path.empty()) files.push_back(a.axis.name + "=" + path);
    }
  for (const std::string& file : files)
    if (auto done = take_file(file, *axes); !done) return fail(done.error());
  std::set<std::string> names;
  for (NewAxis& a : *axes) {
    if (a.file.empty()) a.file = "EXAMPLE-" + lower(a.axis.name) + ".csv";
    if (!names.insert(a.file).second) return fail("--file: two files are called " + a.file);
  }
  return axes;
}

Expected<NewCampaign> settled(const NewWish& wish, const fs::path& folder, Questions& ask) {
  NewCampaign c{.id = {},
                .customer = wish.customer,
                .operator_name = wish.operator_name,
                .date = wish.date,
                .maker = wish.maker,
                .machine = wish.machine,
                .serial = wish.serial,
                .asset = wish.asset,
                .control = wish.control,
                .instrument = wish.instrument,
                .axes = {}};
  NONIO_TRY(auto id, id_of(wish, folder, ask));
  c.id = std::move(id);
  for (const auto& [name, to, otherwise] : {std::tuple{"customer", &c.customer, std::string()},
                                            {"operator", &c.operator_name, std::string()},
                                            {"date", &c.date, today()},
                                            {"maker", &c.maker, std::string()},
                                            {"machine", &c.machine, std::string()},
                                            {"serial", &c.serial, std::string()},
                                            {"asset", &c.asset, std::string()},
                                            {"instrument", &c.instrument, std::string()}}) {
    if (auto done = ask.text(ask.say.of("new.ask", name), *to, otherwise); !done)
      return fail(done.error());
    if (auto done = one_line("--" + std::string(name), *to); !done) return fail(done.error());
  }
  if (auto done = one_line("--control", c.control); !done) return fail(done.error());
  if (!is_day(c.date))
    return fail("--date: expected a day such as 2026-11-03, found \"" + c.date + "\"");
  NONIO_TRY(auto axes, axes_with_files(wish, ask));
  c.axes = std::move(axes);
  return c;
}

/// Chooses the reader of the files by their content. An error if two files need different readers.
Expected<void> take_columns(const NewWish& wish, NewCampaign& c, const Common& common) {
  if (wish.columns.empty()) return {};
  for (const std::string& column : wish.columns)
    if (auto done = one_line("--column", column); !done) return done;
  loader::Plugins plugins;
  plugins.load(common.plugin_folders());
  for (const NewAxis& a : c.axes) {
    if (a.example()) continue;
    const auto table = reading::stated_table(plugins, a.bytes, 2);
    if (!table) return fail("--column: " + a.file + " contains no table with columns");
    if (!c.reader.empty() && c.reader != table->reader->info.name)
      return fail("--column: expected files of one format, found those of the readers " + c.reader +
                  " and " + table->reader->info.name);
    c.reader = table->reader->info.name;
  }
  if (c.reader.empty()) return fail("--column: expected a file of readings (--file)");
  c.columns = wish.columns;
  return {};
}

std::vector<Artifact> files_of(const NewCampaign& c, std::string manifest) {
  std::vector<Artifact> files;
  for (const NewAxis& a : c.axes)
    files.push_back({a.file, a.example() ? example_readings(a.axis, c.id) : a.bytes});
  // The manifest is written last, because its presence makes the folder a campaign.
  files.push_back({config::manifest_name, std::move(manifest)});
  return files;
}

/// Evaluates the files in a temporary folder with the settings of the site, as a run does.
std::vector<Error> mistakes(const std::vector<Artifact>& files, const std::string& id,
                            const std::optional<fs::path>& site, const Common& common) {
  const storage::ScratchFolder trial("new");
  if (trial.path().empty()) return {Error{"cannot make a folder for a trial"}};
  const fs::path folder = trial.path() / "campaign";
  if (site)
    if (const auto text = storage::read_file(*site / config::site_name))
      if (auto done = storage::publish(trial.path(), {{config::site_name, *text}}); !done)
        return {done.error()};
  if (auto done = storage::publish(folder, files); !done) return {done.error()};
  auto place = reading::open_workplace(folder, common.plugin_folders(), common.template_folders(),
                                       NONIO_VERSION);
  if (!place) return {place.error()};
  return evaluation::evaluate(folder, id, (*place)->context, [](const std::string&) {})
      .results.errors;
}

std::string in_the_way(const fs::path& folder) {
  std::error_code error;
  if (!fs::exists(fs::symlink_status(folder, error))) return {};
  if (fs::is_directory(folder, error) && fs::is_empty(folder, error) && !error) return {};
  return folder.string() + " exists: nothing is written over it";
}

int write_new(const std::vector<NewFiles>& all, const NewWish& wish, const std::string& what,
              bool example, const config::TerminalWords& say, const Common& common) {
  std::vector<std::string> written;
  for (const NewFiles& one : all) {
    if (auto done = storage::publish(one.folder, one.files); !done)
      return complain(text_of(done.error()), exit_failed);
    for (const Artifact& file : one.files) written.push_back((one.folder / file.name).string());
  }
  if (common.json) {
    print_json(Json{{"schema", "nonio-new/1"},
                    {"kind", what},
                    {"folder", all.front().folder.string()},
                    {"example", example},
                    {"files", written}});
    return exit_done;
  }
  if (common.quiet) return exit_done;
  for (const std::string& file : written) std::cout << file << "\n";
  if (example) std::cout << say("new.example") << "\n";
  if (what == "machine") return exit_done;
  const bool is_empty_site = what == "site" && !example;
  std::cout << say("new.next") << "  nonio "
            << (is_empty_site    ? "new campaign "
                : what == "site" ? "run "
                                 : "show ")
            << wish.folder
            << (is_empty_site    ? "/NAME\n"
                : what == "site" ? " --out out\n"
                                 : "\n");
  return exit_done;
}

/// The files are evaluated in a temporary folder. An error means that nothing is written.
Expected<NewFiles> campaign_files(const NewWish& wish, const fs::path& folder,
                                  const std::optional<fs::path>& site, Questions& ask,
                                  bool& example, const Common& common) {
  NONIO_TRY(auto campaign, settled(wish, folder, ask));
  if (auto done = take_columns(wish, campaign, common); !done) return fail(done.error());
  example = campaign.example();
  NONIO_TRY(auto values, settings_of(wish.settings));
  if (site)
    if (auto done = ask_for_certificate(campaign, *site, values, ask); !done)
      return fail(done.error());
  std::string text = campaign_text(campaign);
  if (auto done = set_all(values, text); !done) return fail(done.error());
  NewFiles out{folder, files_of(campaign, std::move(text))};
  if (const auto wrong = mistakes(out.files, campaign.id, site, common); !wrong.empty())
    return fail(text_of(wrong.front()) + "; nothing was written");
  return out;
}

/// Prompts for the person who approves certificates and for the signing key. With a key, the
/// outputs of the site include the certificate.
Expected<void> settle_certificates(const fs::path& folder, Values& values, Questions& ask) {
  if (auto done = ask_for(for_certificates, "", values, ask); !done) return done;
  if (values[for_certificates.key].empty()) return {};
  for (const Setting& one : signing_settings) {
    if (auto done = ask_for(one, "", values, ask); !done) return done;
    std::string& file = values[one.key];
    if (file.empty()) return {};
    // A typed path is relative to the current folder, but a path in site.toml is relative to the
    // site.
    const fs::path path = fs::absolute(file).lexically_normal(),
                   below = path.lexically_relative(folder);
    file = below.empty() || below.string().starts_with("..") ? path.string() : below.string();
  }
  values.emplace("run.outputs", "[\"pdf-report\", \"csv\", \"certificate\"]");
  return {};
}

int new_site(const NewWish& wish, const fs::path& folder, const config::TerminalWords& say,
             const Common& common) {
  NewSite site{wish.laboratory, wish.address, wish.country};
  Questions ask(!wish.defaults && Questions::on_terminal(), say);
  for (const auto& [question, to] : {std::pair{"Laboratory, name", &site.laboratory},
                                     {"Laboratory, address", &site.address},
                                     {"Country (two letters)", &site.country}}) {
    if (auto done = ask.text(question, *to, ""); !done)
      return complain(done.error().message, ask.status());
    if (auto done = one_line(question, *to); !done) return complain(done.error().message);
  }
  auto values = settings_of(wish.settings);
  if (!values) return complain(values.error().message);
  std::string text = site_text(site);
  if (auto done = settle_certificates(folder, *values, ask); !done)
    return complain(done.error().message, ask.status());
  if (auto done = set_all(*values, text); !done) return complain(done.error().message);
  if (const auto read = config::parse_site(text, config::site_name); !read)
    return complain(text_of(read.error().front()) + "; nothing was written");
  std::vector<NewFiles> all{{folder, {{config::site_name, text}}}};
  if (wish.empty) return write_new(all, wish, "site", false, say, common);
  Questions silent(false, say);
  bool example = false;
  NewWish first = wish;
  first.settings.clear();
  const auto campaign =
      campaign_files(first, folder / "first-campaign", {}, silent, example, common);
  if (!campaign) return complain(campaign.error().message);
  all.push_back(*campaign);
  return write_new(all, wish, "site", example, say, common);
}

int new_campaign(const NewWish& wish, const fs::path& folder, const config::TerminalWords& say,
                 const Common& common) {
  Questions ask(!wish.defaults && Questions::on_terminal(), say);
  bool example = false;
  const auto campaign = campaign_files(wish, folder, site_above(folder), ask, example, common);
  if (!campaign) return complain(campaign.error().message, ask.status());
  return write_new({*campaign}, wish, "campaign", example, say, common);
}

int new_machine(const NewWish& wish, const fs::path& path, const config::TerminalWords& say,
                const Common& common) {
  NewMachine machine{path.stem().string(), wish.maker, wish.machine, wish.serial, wish.control, {}};
  if (path.extension() != ".toml" || path.parent_path().filename() != config::machines_folder)
    return complain("expected SITE/machines/<asset>.toml, found " + wish.folder);
  const auto axes = axes_of(wish.axes.empty() ? std::vector<std::string>{"X=0:500"} : wish.axes);
  if (!axes) return complain(axes.error().message);
  for (const NewAxis& a : *axes) machine.axes.push_back(a.axis);
  const std::string text = machine_text(machine);
  const std::string file = path.filename().string();
  if (const auto read = config::parse_machine(text, file, machine.asset); !read)
    return complain(text_of(read.error().front()) + "; nothing was written");
  if (!storage::is_artifact_name(file)) return complain("expected a plain name, found " + file);
  std::vector<NewFiles> all{{path.parent_path(), {{file, text}}}};
  return write_new(all, wish, "machine", false, say, common);
}

int make_new(NewWish wish, const Common& common) {
  const std::vector<std::string> kinds{"site", "campaign", "machine"};
  const bool named = std::find(kinds.begin(), kinds.end(), wish.what) != kinds.end();
  if (wish.folder.empty() && named)
    return complain("expected a folder after \"" + wish.what + "\"");
  if (!wish.folder.empty() && !named)
    return complain("expected site, campaign or machine, found \"" + wish.what + "\"" +
                    storage::suggestion(wish.what, kinds));
  if (wish.folder.empty()) wish.folder = std::exchange(wish.what, {});
  fs::path folder = fs::absolute(wish.folder).lexically_normal();
  if (!folder.has_filename()) folder = folder.parent_path();
  if (const std::string why = in_the_way(folder); !why.empty()) return complain(why);
  if (wish.what.empty()) wish.what = site_above(folder) ? "campaign" : "site";
  const SiteWords words(common, wish.what == "site" ? "en" : language_at(folder));
  if (wish.what == "machine") return new_machine(wish, folder, words.get(), common);
  if (wish.what == "site") return new_site(wish, folder, words.get(), common);
  if (wish.empty || !(wish.laboratory + wish.address + wish.country).empty())
    return complain(
        "--empty, --laboratory, --address and --country are for a site, not a campaign");
  return new_campaign(wish, folder, words.get(), common);
}

}  // namespace

Verb new_verb(Common& common) {
  auto wish = std::make_shared<NewWish>();
  using Takes = Argument::Takes;
  return {
      .name = "new",
      .summary = "Makes a site, a campaign or the record of a machine, with an example",
      .arguments = joined(
          {required(offering({"site", "campaign", "machine"},
                             {"WHAT", &wish->what,
                              "site, campaign or machine. Default: a campaign inside a site or "
                              "next to other campaigns, otherwise a site"})),
           takes(Takes::folder, {"FOLDER", &wish->folder,
                                 "The folder; new, or empty. For a machine the file of its record, "
                                 "SITE/machines/<asset>.toml"}),
           {"--id", &wish->id, "Id of the campaign (default: from the folder's name)"},
           {"--customer", &wish->customer, "Customer"},
           {"--operator", &wish->operator_name, "Name of the operator"},
           day({"--date", &wish->date,
                "Day of the measurement, such as 2026-11-03 (default: today)"}),
           {"--maker", &wish->maker, "Maker of the machine"},
           {"--machine", &wish->machine, "Model of the machine"},
           {"--serial", &wish->serial, "Its serial number; with the maker it names the machine"},
           {"--asset", &wish->asset, "Its name in the laboratory, in place of maker and serial"},
           takes(Argument::Takes::control,
                 {"--control", &wish->control, "Its control (`nonio table controls`)"}),
           {"--instrument", &wish->instrument, "Model of the instrument"},
           {"--axis", &wish->axes,
            "NAME=FROM:TO, travel in mm, for A, B and C in deg; may be given several times "
            "(default: X=0:500)"},
           takes(Takes::file, {"--file", &wish->files,
                               "AXIS=PATH: readings of that axis, copied; may be given several "
                               "times. An axis without a file gets example readings"}),
           {"--column", &wish->columns,
            "Columns of these files with other names: \"NAME = KNOWN\" such as \"Soll mm = "
            "target_mm\"; may be given several times"},
           {"--laboratory", &wish->laboratory, "For a site: name of the laboratory"},
           {"--address", &wish->address, "For a site: its address"},
           {"--country", &wish->country, "For a site: country, two letters"},
           settings_argument(wish->settings,
                             "KEY=VALUE: a key of the new file with its table, such as "
                             "instrument.serial=L-001; may be given several times"),
           {"--empty", &wish->empty, "A site without a first campaign"},
           {"--defaults", &wish->defaults, "Do not prompt for missing options"}},
          common_arguments(common)),
      .footer =
          "On a terminal the command prompts for missing options, with the default in brackets; an "
          "empty line accepts it, and ^D or ^C ends without writing anything. If the site names a "
          "person "
          "who approves certificates, it also prompts for what a certificate requires, with the "
          "instrument of the last campaign as the default. Example readings are "
          "marked: every report prints EXAMPLE, NOT MEASURED next to the customer and the machine. "
          "Existing files are never overwritten.",
      .examples = {"nonio new site lab",
                   "nonio new machine site/machines/S-0042.toml --axis X=0:800 --axis C=0:360",
                   "nonio new campaign site/2026-11-rossi --axis X=0:800 --file X=laser/x.csv"},
      .run = [wish, &common] { return make_new(*wish, common); }};
}

}  // namespace nonio::app
