// SPDX-License-Identifier: Apache-2.0
#include "plugin_check/plugin_check.h"

#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <clocale>
#include <cstdlib>
#include <map>
#include <thread>
#include <type_traits>

#include "campaign/config/site_files.h"
#include "campaign/config/template_files.h"
#include "campaign/loader/plugins.h"
#include "nonio/sdk/format.h"
#include "platform/process/child.h"
#include "platform/process/confine.h"
#include "platform/process/shared_status.h"
#include "platform/storage/digest.h"
#include "platform/storage/files.h"
#include "platform/storage/nearest.h"
#include "plugin_check/plugin_checks.h"

namespace nonio::plugin_check {
namespace fs = std::filesystem;

namespace {

using kit::Bench;
using kit::Verdict;
using CheckState = PluginCheck::State;

constexpr double scan_seconds = 1.0;
// Number of timeouts after which the remaining checks of a plugin are skipped.
constexpr std::size_t most_hanging = 2;

bool went_well(const PluginCheck& c) {
  return c.state == CheckState::passed || c.state == CheckState::skipped;
}

constexpr const char* of_files[][2] = {
    {"loads", "The library loads, its ABI is the program's, it registers within a second."},
    {"symbols", "One symbol is exported, nonio_plugin."},
    {"cases", "Every campaign of its cases can be read."},
    {"pure", "The result depends on the input only; no file, socket or process is used."},
    {"time", "At most one of its checks hangs; after two the others are skipped."}};

struct Brought final : Registry {
  std::vector<Method> methods;
  std::vector<Reader> readers;
  std::vector<Effect> effects;
  std::vector<Analysis> analyses;
  std::vector<Output> outputs;
  std::vector<Controller> controllers;
  void add(Method m) override { methods.push_back(std::move(m)); }
  void add(Reader r) override { readers.push_back(std::move(r)); }
  void add(Effect e) override { effects.push_back(std::move(e)); }
  void add(Analysis a) override { analyses.push_back(std::move(a)); }
  void add(Output o) override { outputs.push_back(std::move(o)); }
  void add(Controller c) override { controllers.push_back(std::move(c)); }
};

double processor_seconds(int who = RUSAGE_SELF) {
  rusage usage{};
  ::getrusage(who, &usage);
  const auto of = [](const timeval& t) {
    return static_cast<double>(t.tv_sec) + 1e-6 * static_cast<double>(t.tv_usec);
  };
  return of(usage.ru_utime) + of(usage.ru_stime);
}

process::SharedStatus* impure_answer = nullptr;

[[noreturn]] void tell_impurity(const char* call) {
  impure_answer->set(std::string("fit calls ") + call +
                     ": expected nothing but its arguments, no file, socket or process");
  ::_exit(0);
}

/// Two time zones 26 hours apart, so that the local dates of the two runs always differ.
constexpr const char *first_zone = "HERE+12", *second_zone = "ELSE-14";

void set_zone(const char* zone) {
  ::setenv("TZ", zone, 1);
  ::tzset();
}

void go_elsewhere() {
  for (const char* name : {"HOME", "TMPDIR", "USER", "PWD"}) ::setenv(name, "/elsewhere", 1);
  if (::chdir("/usr") != 0) throw std::runtime_error("no folder /usr");
}

void speak_otherwise() {
  for (const char* name : {"de_DE.UTF-8", "de_DE.utf8", "it_IT.UTF-8", "es_ES.UTF-8"})
    if (std::setlocale(LC_ALL, name) != nullptr) return;
}

template <class Plugin>
std::vector<Plugin> joined(std::vector<Plugin> own, const std::vector<Plugin>& others) {
  const std::size_t n = own.size();
  for (const Plugin& p : others)
    if (std::none_of(own.begin(), own.begin() + static_cast<std::ptrdiff_t>(n),
                     [&](const Plugin& o) { return o.info.name == p.info.name; }))
      own.push_back(p);
  return own;
}

std::vector<fs::path> files_with(const fs::path& folder, const std::string& ending) {
  std::vector<fs::path> found;
  std::error_code error;
  for (fs::recursive_directory_iterator it(folder, error), end; !error && it != end;
       it.increment(error))
    if (it->is_regular_file() && it->path().string().ends_with(ending)) found.push_back(it->path());
  std::sort(found.begin(), found.end());
  return found;
}

Expected<std::vector<kit::Source>> sources_below(const fs::path& folder) {
  std::vector<kit::Source> sources;
  for (const fs::path& manifest : files_with(folder, std::string("/") + config::manifest_name)) {
    const fs::path place = manifest.parent_path();
    NONIO_TRY(auto text, storage::read_file(manifest));
    kit::Source s{place.filename().string(), std::move(text), {}};
    for (const auto& entry : fs::directory_iterator(place)) {
      if (!entry.is_regular_file()) continue;
      NONIO_TRY(auto bytes, storage::read_file(entry.path()));
      s.files.push_back({entry.path().filename().string(), std::move(bytes)});
    }
    if (auto values = storage::read_file(place / "expected" / "values.csv"); values)
      s.files.push_back({"expected/values.csv", std::move(*values)});
    sources.push_back(std::move(s));
  }
  return sources;
}

class Checker {
 public:
  Checker(const PluginCheckRequest& request, const std::function<void(const PluginCheck&)>& tell)
      : request_(request), tell_(tell) {}

  Expected<void> prepare() {
    storage::sha256("");  // OpenSSL reads its settings at the first use, which no plugin is to be
                          // blamed for
    own_.load({request_.own_plugins});
    NONIO_TRY(auto templates, config::read_templates(request_.template_folders));
    bench_.templates = std::move(templates);
    bench_.context.version = request_.version;
    bench_.context.plugins = &own_;
    bench_.context.templates = bench_.templates;
    seed(request_.seed);
    for (const fs::path& folder : request_.cases) {
      NONIO_TRY(auto cases, sources_below(folder));
      for (kit::Source& s : cases) cases_.push_back(std::move(s));
    }
    return {};
  }

  void check(const fs::path& path) {
    hung_ = 0;
    path_ = fs::absolute(path);
    shown_path_ = path;
    std::string list;
    const bool loads = run(
        "", "loads", [&](Bench&) { return load(); }, &list, true);
    if (!loads) return;
    run("", "symbols", [&](Bench&) { return symbols(); });
    if (!cases_.empty()) run("", "cases", [&](Bench&) { return open_cases(); });
    std::size_t at[6] = {};
    for (std::size_t i = 0; i < list.size();) {
      const std::size_t end = std::min(list.find('\n', i), list.size());
      check_plugin(list.substr(i, end - i), at);
      i = end + 1;
    }
    pure_again();
  }

  const std::vector<std::string>& names() const { return names_; }

 private:
  void seed(std::uint64_t number) {
    const auto [place, anew] = made_.try_emplace(number);
    Made& made = place->second;
    if (anew) {
      made.sources = kit::made_sources(number);
      // A reader under test may not recognize the samples that are made for the program's own
      // readers.
      for (const kit::Source& s : made.sources)
        if (auto sample = kit::open_source(s, own_.readers(), own_.methods()))
          made.samples.push_back(std::move(*sample));
    }
    bench_.seed = number;
  }

  /// Evaluates the samples in the parent process, because each check runs in its own child process
  /// and would have to repeat the evaluation.
  void evaluate() {
    Made& made = made_.at(bench_.seed);
    if (std::exchange(made.evaluated, true)) return;
    Bench own = bench_;
    own.effects = own_.effects();
    own.analyses = own_.analyses();
    for (kit::Sample& s : made.samples) s.results = kit::results_of(s, own);
  }

  void check_plugin(const std::string& plugin, std::size_t (&at)[6]) {
    hung_ = 0;
    const std::string kind = plugin.substr(0, plugin.find(' '));
    names_.push_back(plugin.substr(kind.size() + 1));
    if (kind == "method") {
      run_all(plugin, kit::method_checks(), &Brought::methods, at[5]++);
    } else if (kind == "reader") {
      run_all(plugin, kit::reader_checks(), &Brought::readers, at[0]++);
    } else if (kind == "effect") {
      run_all(plugin, kit::effect_checks(), &Brought::effects, at[1]++);
    } else if (kind == "analysis") {
      run_all(plugin, kit::analysis_checks(), &Brought::analyses, at[2]++);
    } else if (kind == "output") {
      run_all(plugin, kit::output_checks(), &Brought::outputs, at[3]++);
    } else {
      run_all(plugin, kit::controller_checks(), &Brought::controllers, at[4]++);
    }
  }

  template <class Plugin>
  void run_all(const std::string& plugin, const std::vector<kit::Check<Plugin>>& checks,
               std::vector<Plugin> Brought::*kind, std::size_t index) {
    if (!request_.plugin.empty() && names_.back() != request_.plugin) return;
    wants_results_ = std::is_same_v<Plugin, Output> || std::is_same_v<Plugin, Controller>;
    for (const auto& c : kit::info_checks()) {
      if (std::is_same_v<Plugin, Method> && c.name == std::string_view("options")) continue;
      run(plugin, c.name, [&](Bench& b) { return c.run((brought_.*kind)[index].info, b); });
    }
    run_of(plugin, checks, kind, index);
    pure(plugin,
         [this, kind, index](Bench& b) { return kit::fingerprint((brought_.*kind)[index], b); });
  }

  /// First run of the check `pure`, which runs the same work twice: the second time later, in
  /// another environment, and without files, sockets or processes.
  void pure(const std::string& plugin, std::function<Verdict(Bench&)> digest) {
    if ((!request_.only.empty() && request_.only != "pure") || hung_ >= most_hanging) return;
    zone_ = first_zone;
    PluginCheck result = in_child(plugin, "pure", digest);
    zone_ = nullptr;
    if (result.state == CheckState::passed)
      once_.push_back({plugin, std::move(digest), std::move(result.says), wants_results_,
                       std::chrono::steady_clock::now()});
    else
      tell_(result);
  }

  /// Second runs of the check `pure`. They are made together, because each must start at least a
  /// second after the first run.
  void pure_again() {
    for (const Once& once : std::exchange(once_, {})) {
      hung_ = 0;
      wants_results_ = once.wants_results;
      std::this_thread::sleep_until(once.ended + a_second);
      zone_ = second_zone;
      const PluginCheck result = in_child(once.plugin, "pure", [&](Bench& b) {
        std::string why;
        b.only_plugin = [&] {
          // Calls of the host before this point restore the working folder, so the environment is
          // changed only here.
          go_elsewhere();
          speak_otherwise();
          why = process::confine_pure(tell_impurity);
        };
        Verdict v = once.digest(b);
        if (!why.empty()) return kit::skipped("it cannot be confined: " + why);
        if (v.state != Verdict::State::passed) return v;
        return v.says == once.says ? kit::passed()
                                   : kit::failed(
                                         "another home, folder, locale, time zone and a second "
                                         "later it makes something else of the same input");
      });
      zone_ = nullptr;
      tell_(result);
    }
  }

  template <class Plugin>
  void run_of(const std::string& plugin, const std::vector<kit::Check<Plugin>>& checks,
              std::vector<Plugin> Brought::*kind, std::size_t index) {
    for (const auto& c : checks)
      run(plugin, c.name, [&](Bench& b) { return c.run((brought_.*kind)[index], b); });
  }

  /// Runs one check in a child process, for each seed until it fails. `list` receives the text of a
  /// passed check. With `always` the check also runs if it was not requested, because other checks
  /// need its result; then only a failure is reported.
  bool run(const std::string& plugin, const std::string& name,
           const std::function<Verdict(Bench&)>& work, std::string* list = nullptr,
           bool always = false) {
    const bool asked = request_.only.empty() || request_.only == name;
    if (!asked && !always) return true;
    if (hung_ >= most_hanging) return false;
    PluginCheck result = in_child(plugin, name, work);
    const std::uint64_t seeds = plugin.empty() ? 1 : std::max<std::uint64_t>(1, request_.seeds);
    for (std::uint64_t i = 1; i < seeds && went_well(result); ++i) {
      seed(request_.seed + i);
      PluginCheck next = in_child(plugin, name, work);
      if (!went_well(next) || result.state == CheckState::skipped) result = std::move(next);
    }
    if (seeds > 1) seed(request_.seed);
    const bool well = went_well(result);
    if (list != nullptr && well) *list = std::exchange(result.says, {});
    if (asked || !well) tell_(result);
    if (hung_ >= most_hanging)
      tell_({shown_path_.string(), plugin, "time", CheckState::failed,
             "two of its checks hang: the others were not tried", bench_.seed});
    return well;
  }

  PluginCheck in_child(const std::string& plugin, const std::string& name,
                       const std::function<Verdict(Bench&)>& work) {
    PluginCheck result{shown_path_.string(), plugin, name, CheckState::passed, {}, bench_.seed};
    if (wants_results_) evaluate();
    process::SharedStatus stage, answer;
    if (!stage.valid() || !answer.valid()) {
      result.state = CheckState::crashed;
      result.says = "no memory to share with a child process";
      return result;
    }
    const double before = processor_seconds(RUSAGE_CHILDREN);
    auto child = process::Child::start("a check", {.memory_MB = request_.memory_MB}, [&] {
      limit_processor();
      impure_answer = &answer;
      answer.set(told(name == "loads", stage, work));
    });
    const process::ChildEnd end = child ? child->wait(10.0 * request_.seconds)
                                        : process::ChildEnd{false, child.error().message};
    const std::string words = answer.get();
    // A check that waits until the time limit costs most time, so no further check of the plugin is
    // run.
    if (end.overdue) hung_ = most_hanging;
    if (!end.well && processor_seconds(RUSAGE_CHILDREN) - before > 0.9 * request_.seconds) ++hung_;
    if (!end.well || words.empty()) {
      result.state = CheckState::crashed;
      result.says = end.words + (stage.get().empty() ? "" : " in: " + stage.get());
      return result;
    }
    result.state = words[0] == 'p'   ? CheckState::passed
                   : words[0] == 'f' ? CheckState::failed
                                     : CheckState::skipped;
    result.says = words.substr(1);
    return result;
  }

  void limit_processor() const {
    const auto seconds = static_cast<rlim_t>(std::max(1.0, request_.seconds));
    const rlimit limit{seconds, seconds};
    ::setrlimit(RLIMIT_CPU, &limit);
  }

  std::string told(bool first, process::SharedStatus& stage,
                   const std::function<Verdict(Bench&)>& work) {
    Verdict v;
    try {
      bench_.stage = [&stage](const std::string& words) { stage.set(words); };
      if (zone_ != nullptr) set_zone(zone_);
      if (!first) set_up();
      v = work(bench_);
    } catch (const std::bad_alloc&) {
      v = kit::failed("out of memory in: " + stage.get());
    } catch (const std::exception& e) {
      v = kit::failed(std::string("threw ") + e.what() + " in: " + stage.get());
    } catch (...) {
      v = kit::failed("threw something in: " + stage.get());
    }
    const char letter = v.state == Verdict::State::passed   ? 'p'
                        : v.state == Verdict::State::failed ? 'f'
                                                            : 's';
    return letter + v.says;
  }

  void set_up() {
    if (const auto entry = loader::open_entry(path_)) (*entry)->add_to(brought_);
    bench_.methods = joined(brought_.methods, own_.methods());
    bench_.readers = joined(brought_.readers, own_.readers());
    bench_.effects = joined(brought_.effects, own_.effects());
    bench_.analyses = joined(brought_.analyses, own_.analyses());
    bench_.stage("reading the samples");
    bench_.sources = std::move(made_.at(bench_.seed).sources);
    bench_.samples = std::move(made_.at(bench_.seed).samples);
    if (!brought_.analyses.empty() || !brought_.effects.empty())
      for (kit::Sample& s : bench_.samples) s.results.reset();
    for (const kit::Source& s : cases_)
      if (auto sample = kit::open_source(s, bench_.readers, bench_.methods))
        bench_.samples.push_back(std::move(*sample));
    bench_.sources.insert(bench_.sources.end(), cases_.begin(), cases_.end());
    bench_.stage("");
  }

  Verdict load() {
    const double before = processor_seconds();
    const auto entry = loader::open_entry(path_);
    if (!entry) return kit::failed(entry.error().message);
    (*entry)->add_to(brought_);
    const double took = processor_seconds() - before;
    if (took > scan_seconds)
      return kit::failed("it took " + fixed_text(took, 1) + " s to load and register: expected " +
                         fixed_text(scan_seconds, 0) + " s at most");
    std::string list;
    for (const auto& p : brought_.methods) list += "method " + p.info.name + "\n";
    for (const auto& p : brought_.readers) list += "reader " + p.info.name + "\n";
    for (const auto& p : brought_.effects) list += "effect " + p.info.name + "\n";
    for (const auto& p : brought_.analyses) list += "analysis " + p.info.name + "\n";
    for (const auto& p : brought_.outputs) list += "output " + p.info.name + "\n";
    for (const auto& p : brought_.controllers) list += "controller " + p.info.name + "\n";
    return list.empty() ? kit::failed("it registers nothing")
                        : Verdict{Verdict::State::passed, list};
  }

  Verdict symbols() const {
    const auto names = loader::exported_symbols(path_);
    if (!names) return kit::failed(names.error().message);
    for (const std::string& name : *names)
      if (name != "nonio_plugin")
        return kit::failed("it exports " + name +
                           " too: hide it (-fvisibility=hidden, as nonio_add_plugin does)");
    return kit::passed();
  }

  Verdict open_cases() const {
    for (const kit::Source& s : cases_)
      if (const auto sample = kit::open_source(s, bench_.readers, bench_.methods); !sample)
        return kit::failed(sample.error().message);
    return kit::passed();
  }

  const PluginCheckRequest& request_;
  const std::function<void(const PluginCheck&)>& tell_;
  loader::Plugins own_;
  Bench bench_;
  struct Made {
    std::vector<kit::Source> sources;
    std::vector<kit::Sample> samples;
    bool evaluated = false;
  };
  std::map<std::uint64_t, Made> made_;
  bool wants_results_ = false;
  std::vector<kit::Source> cases_;
  std::vector<std::string> names_;
  fs::path path_, shown_path_;
  std::size_t hung_ = 0;
  const char* zone_ = nullptr;  ///< time zone of the next child; unchanged if null
  struct Once {
    std::string plugin;
    std::function<Verdict(Bench&)> digest;
    std::string says;
    bool wants_results;
    std::chrono::steady_clock::time_point ended;
  };
  static constexpr std::chrono::milliseconds a_second{1100};
  std::vector<Once> once_;
  Brought brought_;  ///< plugins of the file; filled only in a child process
};

template <class Checks>
void add_names(const Checks& checks, std::vector<std::pair<std::string, std::string>>& names) {
  for (const auto& c : checks)
    if (std::none_of(names.begin(), names.end(), [&](const auto& n) { return n.first == c.name; }))
      names.emplace_back(c.name, c.law);
}

}  // namespace

const char* to_text(PluginCheck::State state) {
  switch (state) {
    case CheckState::passed:
      return "passed";
    case CheckState::failed:
      return "failed";
    case CheckState::crashed:
      return "crashed";
    case CheckState::skipped:
      break;
  }
  return "skipped";
}

std::vector<std::pair<std::string, std::string>> plugin_check_names() {
  std::vector<std::pair<std::string, std::string>> names;
  for (const auto& [name, law] : of_files) names.emplace_back(name, law);
  add_names(kit::info_checks(), names);
  add_names(kit::method_checks(), names);
  add_names(kit::reader_checks(), names);
  add_names(kit::effect_checks(), names);
  add_names(kit::analysis_checks(), names);
  add_names(kit::output_checks(), names);
  add_names(kit::controller_checks(), names);
  return names;
}

Expected<void> check_plugins(const PluginCheckRequest& wanted,
                             const std::function<void(const PluginCheck&)>& tell) {
  PluginCheckRequest request = wanted;
  std::vector<std::string> names;
  for (const auto& [name, law] : plugin_check_names()) names.push_back(name);
  if (!request.only.empty() && std::find(names.begin(), names.end(), request.only) == names.end())
    return fail("there is no check \"" + request.only + "\"" +
                storage::suggestion(request.only, names));
  std::vector<fs::path> files{request.subject};
  if (fs::is_directory(request.subject)) {
    files = files_with(request.subject, ".so");
    request.cases.push_back(request.subject / "cases");
  }
  if (files.empty()) return fail("there is no plugin (*.so) below " + request.subject.string());
  Checker checker(request, tell);
  if (auto ready = checker.prepare(); !ready) return ready;
  for (const fs::path& file : files) checker.check(file);
  const std::vector<std::string>& found = checker.names();
  if (!request.plugin.empty() && !found.empty() &&
      std::find(found.begin(), found.end(), request.plugin) == found.end())
    return fail("there is no plugin \"" + request.plugin + "\" in " + request.subject.string() +
                storage::suggestion(request.plugin, found));
  return {};
}

}  // namespace nonio::plugin_check
