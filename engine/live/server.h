// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "nonio/sdk/error.h"

namespace nonio::live {

/// What `nonio serve` is requested.
struct LiveWish {
  std::filesystem::path folder;  ///< of a campaign, or of a site
  std::string name;              ///< as a person wrote it
  std::vector<std::filesystem::path> plugin_folders, template_folders;
  std::vector<std::string> plugin_paths, template_paths;  ///< as they were given
  std::filesystem::path own_plugins, program;
  std::string version;
  std::filesystem::path out;       ///< of a site: output folder of its runs; empty: none
  std::string token_file;          ///< empty: a new token each time
  std::vector<std::string> hosts;  ///< names by which a proxy calls it
  std::string user_header;         ///< in which the proxy states who is logged in; empty: none does
  std::uint16_t port = 0;
  bool edit = false, quiet = false;
  bool sign_in = false;  ///< of a site with users.toml and no such header: decided by service_of
};

/// Serves the page until SIGINT or SIGTERM. Prints one line, the address with the token. An error
/// states why it could not begin. To be called by a process of one thread without plugins.
Expected<void> serve(const LiveWish& wish);

/// The server itself, as `nonio_serve` of a library that is loaded late (late_library.h).
using Serve = Expected<void> (*)(const LiveWish& wish);

}  // namespace nonio::live
