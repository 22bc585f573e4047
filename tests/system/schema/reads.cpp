// SPDX-License-Identifier: Apache-2.0
// Whether the host takes manifests, many at a time: schema_reads campaign|site|machine|events|...,
// the texts on stdin, each with a NUL at its end; a line for each, "ok" or the first error.
#include <iostream>
#include <string>

#include "campaign/config/machines.h"
#include "campaign/config/manifest.h"
#include "campaign/config/site_logs.h"
#include "certificates/users.h"
#include "methods.h"

namespace {

template <class File>
std::string verdict(const nonio::config::Checked<File>& read) {
  if (read) return "ok";
  const nonio::Error& first = read.error().front();
  return std::to_string(first.line) + ": " + first.message;
}

std::string verdict_of(const std::string& file, const std::string& text) {
  namespace config = nonio::config;
  if (file == "campaign")
    return verdict(config::parse_manifest(text, "campaign.toml", nonio::own_methods()));
  if (file == "site") return verdict(config::parse_site(text, "site.toml"));
  if (file == "machine") return verdict(config::parse_machine(text, "machines/S-1.toml", "S-1"));
  if (file == "events") return verdict(config::parse_events(text, config::events_name));
  if (file == "acknowledged")
    return verdict(config::parse_acknowledged(text, config::acknowledged_name));
  if (file == "forgotten") return verdict(config::parse_forgotten(text, config::forgotten_name));
  if (file == "users") {
    const auto read = nonio::certificates::parse_users(text);
    return read ? "ok" : std::to_string(read.error().line) + ": " + read.error().message;
  }
  return {};
}

}  // namespace

int main(int argc, char** argv) {
  const std::string file = argc == 2 ? argv[1] : "";
  if (verdict_of(file, "").empty()) return 2;
  for (std::string text; std::getline(std::cin, text, '\0');)
    std::cout << verdict_of(file, text) << "\n";
}
