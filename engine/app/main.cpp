// SPDX-License-Identifier: Apache-2.0
#include <pthread.h>
#include <unistd.h>

#include <csignal>
#include <exception>
#include <iostream>
#include <string_view>
#include <utility>

#include "platform/process/keep_apart.h"
#include "verbs.h"

namespace {

/// The process that the user starts has no plugin code, whatever the verb does.
nonio::app::Verb apart(nonio::app::Verb verb) {
  for (nonio::app::Verb& part : verb.verbs) part = apart(std::move(part));
  if (verb.run)
    verb.run = [run = std::move(verb.run)] {
      nonio::process::keep_plugins_apart(nonio::app::Common::own_plugins());
      return run();
    };
  return verb;
}

/// Who reads our output and goes away is an error of `write`, not the end of a process that stores results. Libraries of
/// plugins (Poco) set the same mask when they are loaded: set before, that is no change of theirs.
void block_pipe_signal() {
  sigset_t pipe;
  ::sigemptyset(&pipe);
  ::sigaddset(&pipe, SIGPIPE);
  ::pthread_sigmask(SIG_BLOCK, &pipe, nullptr);
}

/// What cannot be thrown further, out of a destructor or a library: with a word and a status.
[[noreturn]] void give_up() noexcept {
  constexpr std::string_view words = "nonio: out of memory, or an unexpected error\n";
  [[maybe_unused]] const ssize_t n = ::write(STDERR_FILENO, words.data(), words.size());
  ::_exit(nonio::app::exit_failed);
}

}  // namespace

#ifdef NONIO_SANITIZED
/// The search for leaks stops its own process, which one with plugin code is not permitted to do: it would wait for ever.
/// The programs of the unit tests search.
// NOLINTNEXTLINE(bugprone-reserved-identifier): the sanitizer's name
extern "C" int __lsan_is_turned_off() { return 1; }
#endif

int main(int argc, char** argv) try {
  using namespace nonio::app;
  std::set_terminate(give_up);
  block_pipe_signal();
  Common common;
  Program program{
      .name = "nonio",
      .version = NONIO_VERSION,
      .purpose = "evaluate machine-tool calibrations in batch",
      .summary =
          "Nonio evaluates machine-tool calibration campaigns: by the standards, with findings,\n"
          "reports and the tables that go into the machine's controller.",
      .footer =
          "Exit status: 0 done; 1 done, but some campaign failed; 2 usage or configuration error;\n"
          "130 interrupted.",
      .verbs = {}};
  const auto add = [&](const char* group, std::vector<Verb> verbs) {
    for (Verb& verb : verbs) {
      verb.group = group;
      program.verbs.push_back(std::move(verb));
    }
  };
  add("Every night",
      {run_verb(common), night_verb(common), status_verb(common), morning_verb(common)});
  add("Campaigns", {apart(new_verb(common)), apart(import_verb(common)), apart(show_verb(common)),
                    open_verb(common), get_verb(common), apart(schema_verb(common))});
  add("The machines over the years", {query_verb(common), history_verb(common), event_verb(common),
                                      ack_verb(common), forget_verb(common)});
  add("Certificates", {release_verb(common), certificates_verb(common), apart(verify_verb(common)),
                       restamp_verb(common), apart(template_verb(common))});
  add("The error model",
      {live_verb(common), apart(compare_verb(common)), apart(explain_verb(common)),
       apart(model_verb(common)), apart(simulate_verb(common))});
  add("At the machine",
      {apart(plan_verb(common)), apart(controllers_verb(common)), apart(diff_verb(common)),
       apart(apply_verb(common)), apart(merge_verb(common))});
  add("Plugins", {apart(plugins_verb(common)), apart(plugin_verb(common))});
  add("This program", {help_verb(program), version_verb(common), completion_verb(program)});
  return run(program, argc, argv);
} catch (const std::exception& e) {
  std::cerr << "nonio: " << e.what() << "\n";
  return nonio::app::exit_failed;
}
