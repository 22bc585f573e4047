// SPDX-License-Identifier: Apache-2.0
#include "certificates/journal.h"

#include <pwd.h>
#include <unistd.h>

#include <array>
#include <cstdlib>
#include <ctime>
#include <fstream>

#include "platform/storage/digest.h"

namespace nonio::certificates {

const char* const Journal::schema = R"(
CREATE TABLE journal(
  place INTEGER PRIMARY KEY,  -- from 1, without gaps
  at TEXT NOT NULL,  -- UTC
  what TEXT NOT NULL,
  number TEXT NOT NULL,
  says TEXT NOT NULL,  -- JSON
  sha256 TEXT NOT NULL  -- of the digest before, place, at, what, number and says, each with a newline
);
CREATE INDEX of_number ON journal(number);
)";

std::string utc_now() {
  const std::time_t now = std::time(nullptr);
  std::tm utc{};
  ::gmtime_r(&now, &utc);
  std::array<char, 24> text{};
  return {text.data(), std::strftime(text.data(), text.size(), "%Y-%m-%dT%H:%M:%SZ", &utc)};
}

std::string own_account() {
  const uid_t uid = ::getuid();
  passwd entry{};
  passwd* found = nullptr;
  std::vector<char> buffer(16384);
  std::string name = "uid " + std::to_string(uid);
  if (::getpwuid_r(uid, &entry, buffer.data(), buffer.size(), &found) == 0 && found != nullptr)
    name = found->pw_name;
  std::array<char, 256> host{};
  if (::gethostname(host.data(), host.size() - 1) != 0) return name;
  return name + "@" + host.data();
}

bool is_own_account_certain() {
  // Number of user ids in a namespace that an administrator set up; a namespace of a single person
  // has fewer.
  constexpr std::uint64_t few = 65536;
  std::ifstream map("/proc/self/uid_map");
  std::uint64_t inside = 0, outside = 0, count = 0, all = 0;
  bool any = false;
  while (map >> inside >> outside >> count) all += count, any = true;
  return !any || all >= few;
}

std::string Journal::digest(const Entry& e, const std::string& before) {
  std::string all;
  for (const std::string& part : {before, std::to_string(e.place), e.at, e.what, e.number, e.says})
    all += part + "\n";
  return storage::sha256(all);
}

namespace {

Journal::Entry entry_of(storage::Database::Row& row) {
  return {std::strtoll(row[0].c_str(), nullptr, 10),
          std::move(row[1]),
          std::move(row[2]),
          std::move(row[3]),
          std::move(row[4]),
          std::move(row[5])};
}

}  // namespace

std::optional<Journal::Entry> Journal::first(
    const char* sql, std::initializer_list<storage::Database::Value> values) {
  auto rows = database_.rows(sql, values);
  if (rows.empty()) return std::nullopt;
  return entry_of(rows.front());
}

Journal::Entry Journal::add(const char* what, const std::string& number, storage::Json says) {
  says["account"] = own_account();
  const auto before = last();
  Entry e{before ? before->place + 1 : 1,
          utc_now(),
          what,
          number,
          says.dump(-1, ' ', false, storage::Json::error_handler_t::replace),
          {}};
  e.sha256 = digest(e, before ? before->sha256 : "");
  database_.rows("INSERT INTO journal VALUES(?, ?, ?, ?, ?, ?)",
                 {e.place, e.at, e.what, e.number, e.says, e.sha256});
  return e;
}

std::vector<Journal::Entry> Journal::all() {
  std::vector<Entry> entries;
  for (storage::Database::Row& row : database_.rows("SELECT * FROM journal ORDER BY place"))
    entries.push_back(entry_of(row));
  return entries;
}

std::optional<Journal::Entry> Journal::last() {
  return first("SELECT * FROM journal ORDER BY place DESC LIMIT 1", {});
}

std::optional<Journal::Entry> Journal::last_of(const char* what, const std::string& number) {
  return first("SELECT * FROM journal WHERE number = ? AND what = ? ORDER BY place DESC LIMIT 1",
               {number, what});
}

}  // namespace nonio::certificates
