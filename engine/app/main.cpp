// SPDX-License-Identifier: Apache-2.0
#include <pthread.h>
#include <unistd.h>

#include <csignal>
#include <cstdio>
#include <exception>
#include <iostream>
#include <string_view>
#include <utility>

#include "platform/process/keep_apart.h"
#include "verbs.h"

namespace {

/// Runs the plugins of each command in a separate process, so that the process started by the user
/// contains no plugin code.
nonio::app::Verb apart(nonio::app::Verb verb) {
  for (nonio::app::Verb& part : verb.verbs) part = apart(std::move(part));
  if (verb.run)
    verb.run = [run = std::move(verb.run)] {
      nonio::process::keep_plugins_apart(nonio::app::Common::own_plugins());
      return run();
    };
  return verb;
}

/// Blocks SIGPIPE, so that a closed output is an error of `write` and does not end a process that
/// stores results. This is done before plugins are loaded, because libraries (Poco) set the same
/// mask, which would be reported as a change by the plugin.
void block_pipe_signal() {
  sigset_t pipe;
  ::sigemptyset(&pipe);
  ::sigaddset(&pipe, SIGPIPE);
  ::pthread_sigmask(SIG_BLOCK, &pipe, nullptr);
}

/// Terminate handler for exceptions that cannot be propagated, such as those of destructors.
[[noreturn]] void give_up() noexcept {
  constexpr std::string_view words = "nonio: out of memory, or an unexpected error\n";
  [[maybe_unused]] const ssize_t n = ::write(STDERR_FILENO, words.data(), words.size());
  ::_exit(nonio::app::exit_failed);
}

/// Ends the process without destructors: to free all texts and the state of all libraries takes as
/// long as to read them.
[[noreturn]] void leave(int status) {
  std::cout.flush();
  std::fflush(nullptr);
  ::_exit(status);
}

using namespace nonio::app;

/// Names with `false` are accepted without a message, because scripts use them; all others print
/// the new name.
std::vector<Alias> former_names() {
  return {{"compare", "model compare", false},
          {"explain", "model explain", false},
          {"simulate", "model simulate", false},
          {"verify", "certificate verify", false},
          {"plugins", "plugin list", false},
          {"history", "machine history", false},
          {"query", "machine list"},
          {"event", "machine event"},
          {"ack", "machine ack"},
          {"forget", "machine remove"},
          {"release", "certificate approve"},
          {"certificates", "certificate list"},
          {"restamp", "certificate extend"},
          {"template check", "check --only-templates"},
          {"controllers", "table controls"},
          {"diff", "table diff"},
          {"apply", "table predict"},
          {"merge", "table insert"},
          {"plan sign-probe", "table probe"},
          {"night", "run"},
          {"night plan", "run plan"},
          {"night merge", "run merge"},
          {"night cancel", "run cancel"},
          {"night unlock", "run unlock"},
          {"morning", "status --actions"},
          {"get", "export"},
          {"live", "serve"},
          {"open", "show --open"}};
}

/// Commands that users of other programs may type, each with the Nonio command to suggest.
std::vector<std::pair<std::string, std::string>> synonyms() {
  return {{"report", "show"},
          {"view", "show"},
          {"print", "show"},
          {"validate", "check"},
          {"test", "check"},
          {"lint", "check"},
          {"doctor", "check"},
          {"build", "run"},
          {"evaluate", "run"},
          {"start", "run"},
          {"shard", "run plan"},
          {"web", "serve"},
          {"server", "serve"},
          {"page", "serve"},
          {"init", "new"},
          {"create", "new"},
          {"site", "new site"},
          {"campaign", "new campaign"},
          {"read", "import"},
          {"convert", "import"},
          {"cert", "certificate"},
          {"sign", "certificate approve"},
          {"issue", "certificate approve"},
          {"machines", "machine list"},
          {"log", "machine event"},
          {"acknowledge", "machine ack"},
          {"fit", "model compare"},
          {"compensate", "table predict"},
          {"unpack", "export"},
          {"extract", "export"},
          {"csv", "export"},
          {"summary", "status"},
          {"worklist", "status"},
          {"todo", "status"},
          {"migrate", "upgrade"},
          {"man", "help --man"}};
}

Verb group(const char* name, const char* summary, std::vector<Verb> verbs) {
  return {.name = name, .summary = summary, .verbs = std::move(verbs)};
}

std::vector<Verb> table_of_commands(Common& common, const Program& program) {
  std::vector<Verb> all;
  const auto add = [&](const char* heading, std::vector<Verb> verbs) {
    for (Verb& verb : verbs) {
      verb.heading = heading;
      for (Verb& inner : verb.verbs) inner.heading = "Commands";
      all.push_back(std::move(verb));
    }
  };
  Verb run = run_verb(common);
  run.verbs = run_parts(common);
  std::vector<Verb> certificate = register_verbs(common);
  certificate.insert(certificate.begin() + 1, approve_verb(common));
  certificate.insert(certificate.begin() + 3, apart(verify_verb(common)));
  certificate.insert(certificate.begin() + 4, extend_verb(common));
  certificate.push_back(send_verb(common));
  add("Prepare", {apart(new_verb(common)), apart(import_verb(common)), apart(check_verb(common)),
                  apart(plan_verb(common))});
  add("Evaluate", {std::move(run), status_verb(common), apart(show_verb(common)),
                   export_verb(common), serve_verb(common)});
  add("Follow up", {group("machine", "Machines over the years",
                          {machine_list_verb(common), history_verb(common), event_verb(common),
                           ack_verb(common), remove_verb(common)}),
                    group("certificate", "Certificates and their register", std::move(certificate)),
                    apart(model_verb(common)),
                    apart(group("table", "Compensation tables of controls",
                                {controls_verb(common), diff_verb(common), predict_verb(common),
                                 insert_verb(common), probe_verb(common), session_verb(common)}))});
  add("Program", {apart(plugin_verb(common)), help_verb(program)});
  add("", {version_verb(common), completion_verb(program), apart(schema_verb(common)),
           upgrade_verb(common), backup_verb(common), restore_verb(common)});
  return all;
}

}  // namespace

#ifdef NONIO_SANITIZED
/// Turns off the leak sanitizer, which would suspend its own process. A confined process with
/// plugin code may not do so and would wait for ever. The unit tests check for leaks.
// NOLINTNEXTLINE(bugprone-reserved-identifier): the sanitizer's name
extern "C" int __lsan_is_turned_off() { return 1; }
#endif

int main(int argc, char** argv) try {
  std::set_terminate(give_up);
  block_pipe_signal();
  Common common;
  Program program{
      .name = "nonio",
      .version = NONIO_VERSION,
      .purpose = "evaluate machine-tool calibrations in batch",
      .summary =
          "Nonio evaluates machine-tool calibration campaigns: results according to the standards, "
          "findings, reports, certificates and compensation tables.",
      .footer =
          "Also: nonio version, nonio completion SHELL, nonio schema FILE, nonio upgrade SITE, "
          "nonio backup SITE FILE, nonio restore FILE FOLDER. "
          "`nonio help COMMAND` describes a command.\n\n"
          "Exit status: 0 done; 1 done, but some campaign or check failed; 2 usage or "
          "configuration error; 130 interrupted.",
      .aliases = former_names(),
      .aliases_until = "0.3",
      .synonyms = synonyms()};
  program.verbs = table_of_commands(common, program);
  leave(run(program, argc, argv));
} catch (const std::exception& e) {
  std::cerr << "nonio: " << e.what() << "\n";
  return nonio::app::exit_failed;
}
