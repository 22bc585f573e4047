// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "nonio/sdk/error.h"

namespace nonio::live {

struct LiveWish {
  std::filesystem::path folder;
  std::string name;  ///< the folder as stated by the user
  std::vector<std::filesystem::path> plugin_folders, template_folders;
  std::vector<std::string> plugin_paths, template_paths;  ///< as stated on the command line
  std::filesystem::path own_plugins, program;
  std::string version;
  std::filesystem::path out;
  std::string token_file;          ///< empty for a new token at each start
  std::vector<std::string> hosts;  ///< names under which a proxy calls this server (--host)
  /// Header with the user of the proxy; empty without such a proxy.
  std::string user_header;
  std::uint16_t port = 0;
  bool edit = false, quiet = false;
  /// Whether users sign in at this server: a site with users.toml and without `user_header`.
  bool sign_in = false;
};

/// Serves the page until SIGINT, SIGTERM or SIGHUP. Prints the address, with the token unless users
/// sign in. An error if the server cannot start. Must be called in a process with one thread and
/// without plugins.
Expected<void> serve(const LiveWish& wish);

/// Type of `nonio_serve` in a library that is loaded on demand (late_library.h).
using Serve = Expected<void> (*)(const LiveWish& wish);

}  // namespace nonio::live
