// SPDX-License-Identifier: Apache-2.0
#include "live/launcher.h"

#include <sys/socket.h>
#include <unistd.h>

#include <csignal>

#include "live/bench.h"
#include "live/tool.h"
#include "platform/process/child.h"

namespace nonio::live {

namespace {

/// Path that executes this program even if its file was replaced after the start.
constexpr const char* own_program = "/proc/self/exe";

/// Returns false if the server has ended.
bool launch(const BenchWish& common, const storage::Json& what, int to_server) {
  auto ends = process::channel_pair(SOCK_STREAM, "a process of its own");
  if (!ends) return process::send_descriptors(to_server, '-', {});
  auto child = process::Child::start("a request", {}, [&] {
    ::signal(SIGCHLD, SIG_DFL);
    ::close(to_server);
    (*ends)[0] = process::Handle();
    if (what.contains("partner"))
      run_partner(own_program, what["partner"].get<std::vector<std::string>>(),
                  std::move((*ends)[1]));
    if (what.contains("arguments"))
      run_tool(own_program, what["arguments"].get<std::vector<std::string>>(),
               what.value("input", ""), what.value("seconds", 0.0), std::move((*ends)[1]));
    BenchWish wish = common;
    wish.folder = what.at("campaign").get<std::string>();
    run_bench(wish, std::move((*ends)[1]));
  });
  if (!child) return process::send_descriptors(to_server, '-', {});
  child->release();
  return process::send_descriptors(to_server, '+', {(*ends)[0].get()});
}

void serve_launches(const BenchWish& common, int server) {
  ::signal(SIGINT, SIG_IGN);   // the server ends this process
  ::signal(SIGCHLD, SIG_IGN);  // ended children are removed by the kernel
  for (std::string what; process::read_text(server, what);)
    if (!launch(common, storage::parse(what), server)) break;
}

}  // namespace

Expected<Launcher> Launcher::start(const BenchWish& common) {
  NONIO_TRY(auto ends, process::channel_pair(SOCK_STREAM, "the process that starts others"));
  NONIO_TRY(auto child, process::Child::start("what starts others", {}, [&] {
              ends[0] = process::Handle();
              serve_launches(common, ends[1].get());
            }));
  child.release();
  return Launcher(std::move(ends[0]));
}

Expected<process::Handle> Launcher::open(const std::filesystem::path& campaign) {
  return ask({{"campaign", campaign.string()}});
}

Expected<process::Handle> Launcher::run(const std::vector<std::string>& arguments, double seconds,
                                        const std::string& input) {
  return ask({{"arguments", arguments}, {"seconds", seconds}, {"input", input}});
}

Expected<process::Handle> Launcher::partner(const std::vector<std::string>& arguments) {
  return ask({{"partner", arguments}});
}

Expected<process::Handle> Launcher::ask(const storage::Json& what) {
  const std::lock_guard lock(*mutex_);
  if (!process::write_text(channel_.get(), storage::dump_line(what)))
    return fail("the process that starts others has ended; start nonio serve again");
  auto answer = process::receive_descriptors(channel_.get());
  if (!answer) return fail("the process that starts others has ended; start nonio serve again");
  if (answer->word != '+' || answer->descriptors.size() != 1)
    return fail("no process could be started");
  return std::move(answer->descriptors.front());
}

}  // namespace nonio::live
