// SPDX-License-Identifier: Apache-2.0
// Whether the host takes manifests, many at a time: schema_reads campaign|site|machine, the paths
// on stdin; a line for each, "ok" or the first error.
#include <iostream>
#include <string>

#include "host/config/machines.h"
#include "host/config/manifest.h"
#include "host/storage/files.h"

namespace {

template <class File>
std::string verdict(const nonio::host::config::Checked<File>& read) {
  if (read) return "ok";
  const nonio::Error& first = read.error().front();
  return std::to_string(first.line) + ": " + first.message;
}

}  // namespace

int main(int argc, char** argv) {
  const std::string file = argc == 2 ? argv[1] : "";
  if (file != "campaign" && file != "site" && file != "machine") return 2;
  for (std::string path; std::getline(std::cin, path);) {
    const auto text = nonio::host::storage::read_file(path);
    if (!text) return 1;
    std::cout << (file == "campaign"
                      ? verdict(nonio::host::config::parse_manifest(*text, "campaign.toml"))
                  : file == "site" ? verdict(nonio::host::config::parse_site(*text, "site.toml"))
                                   : verdict(nonio::host::config::parse_machine(
                                         *text, "machines/S-1.toml", "S-1")))
              << "\n";
  }
}
