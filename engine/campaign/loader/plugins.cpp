// SPDX-License-Identifier: Apache-2.0
#include "campaign/loader/plugins.h"

#include <elf.h>
#include <unistd.h>

#include <algorithm>
#include <boost/core/demangle.hpp>
#include <boost/dll/shared_library.hpp>
#include <cstring>
#include <span>

#include "campaign/loader/offered.h"
#include "platform/process/apart.h"
#include "platform/process/child.h"
#include "platform/process/confine.h"
#include "platform/process/shared_status.h"
#include "platform/storage/digest.h"
#include "platform/storage/files.h"
#include "platform/storage/nearest.h"

namespace nonio::loader {

namespace fs = std::filesystem;
namespace dll = boost::dll;

namespace {

constexpr double probe_seconds = 10.0;
constexpr const char* out_of_memory = "could not be loaded: out of memory";

/// The libraries are never unloaded while the process runs.
std::vector<dll::shared_library>& libraries() {
  static auto* kept = new std::vector<dll::shared_library>;
  return *kept;
}

}  // namespace

Expected<const PluginEntry*> open_entry(const fs::path& path) {
  boost::dll::fs::error_code error;
  dll::shared_library library(path.string(), error, dll::load_mode::rtld_now);
  if (error)
    return fail("is no shared library (.so), or a library that it needs is missing: " +
                error.message());
  if (!library.has("nonio_plugin")) return fail("is not a plugin: it has no symbol nonio_plugin");
  const PluginEntry* entry = &library.get<const PluginEntry>("nonio_plugin");
  libraries().push_back(std::move(library));
  const std::string tag(entry->abi_tag, ::strnlen(entry->abi_tag, sizeof entry->abi_tag));
  if (tag != NONIO_ABI_TAG)
    return fail("was built for \"" + tag + "\", this program is \"" NONIO_ABI_TAG "\"");
  if (entry->add_to == nullptr) return fail("has no registration function");
  return entry;
}

namespace {

std::string try_registering(const fs::path& path) {
  struct Nobody final : Registry {
    void add(Method) override {}
    void add(Reader) override {}
    void add(Effect) override {}
    void add(Analysis) override {}
    void add(Output) override {}
    void add(Controller) override {}
  } nobody;
  try {
    const auto entry = open_entry(path);
    if (!entry) return entry.error().message;
    (*entry)->add_to(nobody);
  } catch (const std::bad_alloc&) {
    return out_of_memory;
  } catch (const std::exception& e) {
    return std::string("threw while registering: ") + e.what();
  } catch (...) {
    return "threw while registering";
  }
  return "";
}

struct Probed {
  std::vector<std::string> refusals;
  process::ChildEnd end;
};

Probed probe_in_child(std::span<const fs::path> paths) {
  std::vector<process::SharedStatus> said(paths.size());
  for (const process::SharedStatus& words : said)
    if (!words.valid()) return {{}, {false, "no memory"}};
  auto child = process::Child::start("the plugins", {}, [&] {
    if (process::is_apart()) {
      if (const std::string why = process::confine_loading({"/"}); !why.empty()) ::_exit(1);
    }
    for (std::size_t i = 0; i < paths.size(); ++i) said[i].set("." + try_registering(paths[i]));
  });
  Probed probed;
  probed.end = child ? child->wait(probe_seconds) : process::ChildEnd{false, child.error().message};
  for (const process::SharedStatus& words : said) {
    const std::string answer = words.get();
    if (answer.empty()) break;
    probed.refusals.push_back(answer.substr(1));
  }
  return probed;
}

/// SIGKILL comes from outside (a person, or a system without memory), so it shows nothing about the
/// plugin.
bool is_killed(const Probed& p) {
  return p.refusals.empty() && !p.end.well && !p.end.overdue &&
         p.end.words.starts_with("signal 9 ");
}

/// Returns the reason of refusal of each file, or "". One child tries all files, because starting a
/// child takes longer than a plugin. The file with which the child ended is tried again alone.
std::vector<std::string> probe(std::span<const fs::path> paths) {
  std::vector<std::string> refusals;
  while (refusals.size() < paths.size()) {
    Probed together = probe_in_child(paths.subspan(refusals.size()));
    for (std::string& r : together.refusals) refusals.push_back(std::move(r));
    if (refusals.size() == paths.size()) break;
    if (together.end.overdue) {
      refusals.push_back("did not survive loading: " + together.end.words);
      continue;
    }
    Probed alone = probe_in_child(paths.subspan(refusals.size(), 1));
    for (int again = 0; again < 4 && is_killed(alone); ++again)
      alone = probe_in_child(paths.subspan(refusals.size(), 1));
    const std::string end = alone.end.well ? "ended the process" : alone.end.words;
    refusals.push_back(alone.refusals.empty() ? "did not survive loading: " + end
                                              : alone.refusals.front());
  }
  return refusals;
}

}  // namespace

namespace {

template <class Plugin>
std::vector<Info> described(const std::vector<Plugin>& all) {
  std::vector<Info> out;
  for (const Plugin& plugin : all) out.push_back(plugin.info);
  return out;
}

template <class Plugin>
std::vector<Plugin> named(std::vector<Info> all) {
  std::vector<Plugin> out;
  for (Info& info : all) out.emplace_back().info = std::move(info);
  return out;
}

}  // namespace

Plugins::Plugins(Catalogue c)
    : files_(std::move(c.files)),
      conflicts_(std::move(c.conflicts)),
      names_(std::move(c.names)),
      methods_(named<Method>(std::move(c.methods))),
      readers_(named<Reader>(std::move(c.readers))),
      effects_(named<Effect>(std::move(c.effects))),
      analyses_(named<Analysis>(std::move(c.analyses))),
      outputs_(named<Output>(std::move(c.outputs))),
      controllers_(named<Controller>(std::move(c.controllers))) {}

Catalogue Plugins::catalogue() const {
  return {files_,
          conflicts_,
          names_,
          described(methods_),
          described(readers_),
          described(effects_),
          described(analyses_),
          described(outputs_),
          described(controllers_)};
}

std::vector<fs::path> Plugins::files_in(const std::vector<fs::path>& folders) {
  std::vector<fs::path> paths;
  for (const fs::path& folder : folders) {
    std::vector<fs::path> here;
    std::error_code error;
    const fs::path real = fs::canonical(folder, error);
    error.clear();
    for (fs::directory_iterator it(folder, error), end; !error && it != end; it.increment(error))
      if (it->path().extension() == ".so" && it->is_regular_file()) {
        const bool resolved = !real.empty() && !it->is_symlink(error);
        const fs::path path =
            resolved ? real / it->path().filename() : fs::canonical(it->path(), error);
        if (error) break;
        if (std::find(paths.begin(), paths.end(), path) == paths.end()) here.push_back(path);
      }
    if (error && error != std::errc::no_such_file_or_directory)
      conflicts_.push_back("cannot read the folder of plugins " + folder.string() + ": " +
                           error.message());
    std::sort(here.begin(), here.end());
    paths.insert(paths.end(), here.begin(), here.end());
  }
  return paths;
}

void Plugins::load(const std::vector<fs::path>& folders) {
  process::step_aside();
  const std::vector<fs::path> paths = files_in(folders);
  std::vector<fs::path> strange;
  std::copy_if(paths.begin(), paths.end(), std::back_inserter(strange), process::must_be_tried);
  std::vector<std::string> refusals = probe(strange);
  for (std::size_t i = 0; i < strange.size(); ++i)
    if (!refusals[i].empty() && !refusals[i].starts_with("did not survive"))
      refusals[i] = probe(std::span(strange).subspan(i, 1)).front();
  const process::LoadingUntried loading;
  const process::Muted muted;
  std::size_t tried = 0;
  for (const fs::path& path : paths) {
    const bool is_strange = tried < strange.size() && strange[tried] == path;
    load_file(path, is_strange ? refusals[tried++] : "");
  }
}

void Plugins::load_file(const fs::path& path, const std::string& refusal) {
  files_.push_back(PluginFile{.path = path, .refused = refusal, .brought = {}});
  PluginFile& file = files_.back();
  if (refusal == out_of_memory) conflicts_.push_back(path.string() + " " + refusal);
  if (!file.refused.empty()) return;
  const process::Muted muted;
  try {
    auto entry = open_entry(path);
    // A temporary failure must not change the results of a run.
    if (!entry) entry = open_entry(path);
    Offered offered;
    if (entry) (*entry)->add_to(offered);
    file.refused = entry ? offered.incomplete() : entry.error().message;
    if (file.refused.empty()) offered.give_to(*this);
  } catch (const std::bad_alloc&) {
    file.refused = out_of_memory;
  } catch (const std::exception& e) {
    file.refused = std::string("threw while registering: ") + e.what();
  } catch (...) {
    file.refused = "threw while registering";
  }
  if (file.refused == out_of_memory) conflicts_.push_back(path.string() + " " + file.refused);
}

bool Plugins::all_from(const fs::path& folder) const {
  std::error_code error;
  const fs::path wanted = fs::canonical(folder, error);
  return std::all_of(files_.begin(), files_.end(), [&](const PluginFile& f) {
    return !f.refused.empty() || f.path.parent_path() == wanted;
  });
}

Expected<std::string> Plugins::digest() const {
  std::string all;
  for (const PluginFile& file : files_) {
    if (!file.refused.empty()) continue;
    NONIO_TRY(const auto bytes, storage::MappedFile::open(file.path));
    all += file.path.filename().string() + " " + storage::sha256(bytes.bytes()) + "\n";
  }
  return storage::sha256(all);
}

namespace {

std::string_view named_with(std::string_view kind) {
  return kind == "output" ? "controller" : kind == "controller" ? "output" : kind;
}

}  // namespace

bool Plugins::accept(std::string_view kind, const Info& info) {
  const std::string name = std::string(kind) + " " + info.name;
  const fs::path path = files_.empty() ? fs::path() : files_.back().path;
  const std::string other = std::string(named_with(kind)) + " " + info.name;
  for (const auto& [known, where] : names_)
    if (known == name || known == other) {
      conflicts_.push_back("two plugins are the " + name + ": " + where.string() + " and " +
                           path.string());
      return false;
    }
  names_.emplace_back(name, path);
  if (!files_.empty()) files_.back().brought.push_back(name + " " + info.version);
  return true;
}

void Plugins::add(Method method) {
  if (accept("method", method.info)) methods_.push_back(std::move(method));
}
void Plugins::add(Reader reader) {
  if (accept("reader", reader.info)) readers_.push_back(std::move(reader));
}
void Plugins::add(Effect effect) {
  if (accept("effect", effect.info)) effects_.push_back(std::move(effect));
}
void Plugins::add(Analysis analysis) {
  if (accept("analysis", analysis.info)) analyses_.push_back(std::move(analysis));
}
void Plugins::add(Output output) {
  if (accept("output", output.info)) outputs_.push_back(std::move(output));
}
void Plugins::add(Controller controller) {
  if (accept("controller", controller.info)) controllers_.push_back(std::move(controller));
}

const Method* Plugins::method(std::string_view kind) const {
  const auto found = std::find_if(methods_.begin(), methods_.end(),
                                  [&](const Method& m) { return m.info.name == kind; });
  return found == methods_.end() ? nullptr : &*found;
}

namespace {

bool may_contain(const fs::path& file, std::string_view kind, std::string_view name) {
  const std::string stem = file.stem().string();
  const std::string all = kind == "analysis" ? "analyses" : std::string(kind) + "s";
  return stem == all || stem == std::string(named_with(kind)) + "s" ||
         stem.find(name) != std::string::npos;
}

/// Sources that are delivered, but not built.
constexpr std::string_view samples = " " NONIO_SAMPLE_PLUGINS " ";

/// If `name` is a sample plugin, returns how to get it, otherwise `suggestion`.
std::string sample_or(std::string_view name, std::string suggestion) {
  if (samples.find(" " + std::string(name) + " ") == samples.npos) return suggestion;
  return "; it is a sample plugin: build " NONIO_SAMPLES_SUBDIR
         " with CMake (its README.md), then pass the build folder with --plugin-path or "
         "NONIO_PLUGIN_PATH";
}

}  // namespace

std::vector<Option> Plugins::options_of_namesakes(const Info& plugin) const {
  std::vector<Option> found;
  const auto take = [&](const auto& all) {
    for (const auto& one : all)
      if (one.info.name == plugin.name && one.info.summary != plugin.summary)
        found.insert(found.end(), one.info.options.begin(), one.info.options.end());
  };
  take(readers_);
  take(analyses_);
  take(outputs_);
  take(controllers_);
  return found;
}

std::string Plugins::absence(std::string_view kind, std::string_view name) const {
  std::vector<std::string> candidates;
  const std::string prefix = std::string(kind) + " ";
  for (const std::string& of : {prefix, std::string(named_with(kind)) + " "})
    for (const auto& [known, where] : names_)
      if (known.starts_with(of)) candidates.push_back(known.substr(of.size()));
  std::string words = "there is no " + prefix + "\"" + std::string(name) + "\"" +
                      sample_or(name, storage::suggestion(name, candidates));
  for (const PluginFile& file : files_)
    if (!file.refused.empty() && may_contain(file.path, kind, name))
      words += "; " + file.path.string() + " " + file.refused;
  return words;
}

std::string Plugins::refusals() const {
  std::string words;
  for (const PluginFile& file : files_)
    if (!file.refused.empty())
      words += (words.empty() ? "" : "; ") + file.path.string() + " " + file.refused;
  return words;
}

std::vector<std::string> Plugins::refusal_notes() const {
  std::vector<std::pair<std::string, std::string>> files;
  for (const PluginFile& file : files_) {
    if (file.refused.empty()) continue;
    const std::string name = file.path.filename().string();
    const auto known = std::find_if(files.begin(), files.end(),
                                    [&](const auto& one) { return one.first == file.refused; });
    if (known == files.end())
      files.emplace_back(file.refused, name);
    else
      known->second += ", " + name;
  }
  std::vector<std::string> notes;
  for (const auto& [reason, names] : files) notes.push_back("plugin " + names + " " + reason);
  return notes;
}

namespace {

/// Returns no entries if the table would exceed the end of the ELF file.
template <class Entry>
std::vector<Entry> entries(std::string_view bytes, std::uint64_t at, std::uint64_t n) {
  if (at > bytes.size() || n > (bytes.size() - at) / sizeof(Entry)) return {};
  std::vector<Entry> out(n);
  if (n != 0) std::memcpy(out.data(), bytes.data() + at, n * sizeof(Entry));
  return out;
}

bool of_standard_library(const std::string& mangled) {
  const std::string name = boost::core::demangle(mangled.c_str());
  return name.find("std::") != name.npos || name.find("__gnu_cxx::") != name.npos;
}

std::string text_at(std::string_view bytes, std::uint64_t at) {
  return at < bytes.size()
             ? std::string(bytes.data() + at, ::strnlen(bytes.data() + at, bytes.size() - at))
             : std::string();
}

}  // namespace

// boost::dll::library_info reads a table that `strip` removes, and includes weak symbols.
Expected<std::vector<std::string>> exported_symbols(const std::filesystem::path& library) {
  NONIO_TRY(const auto file, storage::MappedFile::open(library));
  const std::string_view bytes = file.bytes();
  const auto head = entries<Elf64_Ehdr>(bytes, 0, 1);
  if (head.empty() || std::memcmp(head[0].e_ident, ELFMAG, SELFMAG) != 0 ||
      head[0].e_ident[EI_CLASS] != ELFCLASS64)
    return fail("is not an ELF library of 64 bits");
  const auto sections = entries<Elf64_Shdr>(bytes, head[0].e_shoff, head[0].e_shnum);
  std::vector<std::string> names;
  for (const Elf64_Shdr& section : sections) {
    if (section.sh_type != SHT_DYNSYM || section.sh_link >= sections.size()) continue;
    const std::uint64_t texts = sections[section.sh_link].sh_offset;
    for (const auto& symbol :
         entries<Elf64_Sym>(bytes, section.sh_offset, section.sh_size / sizeof(Elf64_Sym))) {
      const auto binding = ELF64_ST_BIND(symbol.st_info);
      const auto visible = ELF64_ST_VISIBILITY(symbol.st_other);
      if (symbol.st_shndx == SHN_UNDEF || binding == STB_LOCAL || visible == STV_HIDDEN) continue;
      const std::string name = text_at(bytes, texts + symbol.st_name);
      if (binding == STB_GLOBAL || !of_standard_library(name)) names.push_back(name);
    }
  }
  if (names.empty()) return fail("has no table of dynamic symbols");
  return names;
}

}  // namespace nonio::loader
