// SPDX-License-Identifier: Apache-2.0
// Several processes at a register, killed at any moment; NONIO_SEED says when.
#include <gtest/gtest.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cstdlib>
#include <map>
#include <random>
#include <set>

#include "campaign/config/number_pattern.h"
#include "certificates/a_register.h"
#include "platform/storage/database.h"

namespace nonio::register_test {
namespace {

unsigned from_environment(const char* name, unsigned otherwise) {
  const char* wanted = std::getenv(name);
  return wanted == nullptr ? otherwise : static_cast<unsigned>(std::atoi(wanted));
}

/// Ends the test program's child in the middle of whatever it does.
void kill_after(pid_t child, useconds_t microseconds) {
  ::usleep(microseconds);
  ::kill(child, SIGKILL);
  ::waitpid(child, nullptr, 0);
}

/// Or, on a busy machine, nothing would be tried: none would come as far as to issue one.
template <class Entries>
void until_one_is_issued(const Entries& entries) {
  for (int tries = 0; tries < 1000; ++tries) {
    const auto so_far = entries();
    if (std::any_of(so_far.begin(), so_far.end(), [](const auto& e) { return e.state != "drawn"; }))
      return;
    ::usleep(10000);
  }
}

TEST_F(RegisterTest, ProcessesAtOnceAndKilledOnesLoseAndRepeatNothing) {
  const unsigned seed = from_environment("NONIO_SEED", std::random_device{}());
  SCOPED_TRACE("seed " + std::to_string(seed));
  std::mt19937 random(seed);
  { open(); }
  constexpr int rounds = 30, workers = 4;
  for (int round = 0; round < rounds; ++round) {
    std::vector<pid_t> children;
    for (int w = 0; w < workers; ++w) {
      const pid_t child = ::fork();
      if (child == 0) {
        for (int i = 0;; ++i) {
          auto r = certificates::Register::open(site_, numbering_);
          const std::string campaign =
              "c" + std::to_string(round) + "-" + std::to_string(w) + "-" + std::to_string(i);
          auto c = r->draw(campaign, first_data, day);
          if (!c) ::_exit(1);
          c->files = {{"certificate", "c.pdf", c->issue.number + std::string(20000, 'x'), ""}};
          if (!r->issue(*c, campaign, first_data)) ::_exit(1);
        }
      }
      children.push_back(child);
    }
    if (round == 0) until_one_is_issued([this] { return entries(); });
    ::usleep(static_cast<useconds_t>(random() % 30000));
    for (const pid_t child : children) kill_after(child, static_cast<useconds_t>(random() % 3000));
  }
  const auto all = entries();
  std::set<std::string> numbers, orders;
  std::size_t issued = 0;
  certificates::Register r = open();
  for (const certificates::RegisterEntry& e : all) {
    numbers.insert(e.number);
    if (e.state == "drawn") {
      EXPECT_NE(e.reason, "");
      continue;
    }
    ++issued;
    orders.insert(std::to_string(e.order));
    const auto files = r.files(e.number);
    ASSERT_TRUE(files && files->size() == 1) << e.number;
    EXPECT_TRUE(files->front().bytes.starts_with(e.number + "x"));
  }
  EXPECT_EQ(numbers.size(), all.size());
  EXPECT_EQ(orders.size(), issued);
  // None is missing: they are 1 to n.
  EXPECT_EQ(*std::max_element(numbers.begin(), numbers.end(),
                              [](const auto& a, const auto& b) {
                                return std::stoul(a.substr(5)) < std::stoul(b.substr(5));
                              }),
            *config::number_text(numbering_.pattern, "2026", all.size()));
  EXPECT_GT(issued, 0U);
  EXPECT_EQ(r.draw("another", first_data, day)->issue.number,
            *config::number_text(numbering_.pattern, "2026", all.size() + 1));
}

/// What one process does of the test below: `n` campaigns, every tenth one that all processes draw
/// for. Before every tenth number another one is drawn and taken back.
class Client {
 public:
  Client(fs::path site, config::Numbering numbering, unsigned own, unsigned n)
      : site_(std::move(site)), numbering_(std::move(numbering)), own_(own), n_(n) {}

  static std::string campaign(unsigned own, unsigned i) {
    return i % 10 == 9 ? "all-" + std::to_string(i)
                       : "c" + std::to_string(own) + "-" + std::to_string(i);
  }

  /// Status 0: all is done; 1: an error that does not pass.
  int run() {
    for (unsigned i = 0; i < n_; ++i)
      while (!one(i)) {
        if (!storage::is_locked(why_)) {
          std::fprintf(stderr, "process %u, campaign %u: %s\n", own_, i, why_.message.c_str());
          return 1;
        }
        ::usleep(20000);
      }
    return 0;
  }

 private:
  bool one(unsigned i) {
    auto opened = certificates::Register::open(site_, numbering_);
    if (!opened) return because(opened.error());
    if (i % 10 == 0 && !draw_and_take_back()) return false;
    auto c = opened->draw(campaign(own_, i), first_data, day);
    if (!c) return because(c.error());
    if (i % 4 != 0 || c->issued) return true;
    c->files = {{"certificate", "c.pdf", c->issue.number, ""}};
    const auto done = opened->issue(*c, campaign(own_, i), first_data);
    return done ? true : because(done.error());
  }

  bool draw_and_take_back() {
    auto database = numbering_.server ? storage::Database::open(storage::Server{
                                            numbering_.server->url, numbering_.server->schema, {}})
                                      : storage::Database::open(site_ / numbering_.register_file,
                                                                storage::Database::Use::write);
    if (!database) return because(database.error());
    storage::Database::Transaction transaction(*database);
    const std::string last = database->first("UPDATE counters SET last = last + 1 RETURNING last");
    database->rows(
        "INSERT INTO certificates(number, campaign, state, date, reason) VALUES(?, ?, 'drawn', ?, "
        "'')",
        {"taken back " + last, "taken back", day});
    const auto well = database->take_error();
    return well ? true : because(well.error());
  }

  bool because(const Error& why) {
    why_ = why;
    return false;
  }

  const fs::path site_;
  const config::Numbering numbering_;
  const unsigned own_, n_;
  Error why_;
};

/// Kills with SIGKILL a process of the server that serves a client: the server then ends all others
/// and recovers from its log. One time in three it stops the server as a power cut does, and starts
/// it.
template <class Raw>
void kill_server(const Raw& raw, std::mt19937& random) {
  if (random() % 3 == 0) {
    const std::string ctl = std::getenv("NONIO_TEST_PG_CTL");
    ASSERT_EQ(std::system((ctl + " -m immediate restart").c_str()), 0);
    return;
  }
  std::string one;
  try {
    one = raw().first(
        "SELECT pid FROM pg_stat_activity WHERE backend_type = 'client backend' AND pid <> "
        "pg_backend_pid() ORDER BY random() LIMIT 1");
  } catch (const std::runtime_error&) {  // it recovers just now
  }
  if (!one.empty()) ::kill(std::atoi(one.c_str()), SIGKILL);
}

class RegisterProcesses : public RegisterTest {
 protected:
  /// Of each of the campaigns, in the register and in its counter; nothing else is wrong with it.
  void expect_one_number_each(unsigned processes, unsigned n) const {
    std::set<std::string> campaigns{"first"}, found, numbers;
    for (unsigned own = 0; own < processes; ++own)
      for (unsigned i = 0; i < n; ++i) campaigns.insert(Client::campaign(own, i));
    const auto all = entries();
    for (const certificates::RegisterEntry& e : all) {
      numbers.insert(e.number);
      EXPECT_TRUE(found.insert(e.campaign).second) << e.campaign << " has two numbers";
      EXPECT_NE(e.state == "drawn", e.reason.empty()) << e.number;
    }
    EXPECT_EQ(found, campaigns);
    std::set<std::string> wanted;
    for (std::size_t i = 1; i <= all.size(); ++i)
      wanted.insert(*config::number_text(numbering_.pattern, "2026", i));
    EXPECT_EQ(numbers, wanted);
    EXPECT_EQ(raw().first("SELECT last FROM counters"), std::to_string(all.size()));
    const auto audit = open().audit();
    ASSERT_TRUE(audit) << audit.error().message;
    std::set<std::string> wrong;
    for (const std::string& what : audit->wrong)
      if (what.find("is not what was issued") == what.npos) wrong.insert(what);
    EXPECT_EQ(wrong, std::set<std::string>{});
  }
};

/// Processes, numbers of each and kills are few here; 8, 200 and 60 by hand (CONTRIBUTING).
TEST_F(RegisterProcesses, NoNumberTwiceAndNoneMissingWhateverIsKilled) {
  const unsigned processes = from_environment("NONIO_REGISTER_PROCESSES", 4),
                 n = from_environment("NONIO_REGISTER_NUMBERS", 20),
                 kills = from_environment("NONIO_REGISTER_KILLS", 6),
                 seed = from_environment("NONIO_SEED", std::random_device{}());
  std::printf("seed %u: %u processes, %u numbers each, %u kills\n", seed, processes, n, kills);
  std::fflush(stdout);
  std::mt19937 random(seed);
  { drawn(*std::make_unique<certificates::Register>(open()), "first", first_data); }
  std::map<pid_t, unsigned> running;
  const auto start = [&](unsigned own) {
    const pid_t child = ::fork();
    if (child == 0) ::_exit(Client(site_, numbering_, own, n).run());
    running[child] = own;
  };
  for (unsigned own = 0; own < processes; ++own) start(own);
  unsigned killed = 0, of_server = 0;
  while (!running.empty()) {
    ::usleep(static_cast<useconds_t>(random() % 100000));
    if (killed + of_server < kills) {
      if (on_server && random() % 4 == 0) {
        kill_server([this] { return raw(); }, random);
        ++of_server;
      } else {
        ::kill(std::next(running.begin(), random() % running.size())->first, SIGKILL);
        ++killed;
      }
    }
    int status = 0;
    for (pid_t ended = 0; (ended = ::waitpid(-1, &status, WNOHANG)) > 0;) {
      const auto found = running.find(ended);
      if (found == running.end()) continue;
      const unsigned own = found->second;
      running.erase(found);
      if (WIFSIGNALED(status))
        start(own);  // from its beginning: what was drawn is drawn again
      else
        EXPECT_EQ(WEXITSTATUS(status), 0);
    }
  }
  std::printf("processes killed: %u, server: %u\n", killed, of_server);
  expect_one_number_each(processes, n);
}

}  // namespace
}  // namespace nonio::register_test
