// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "nonio/sdk/error.h"

namespace nonio::live {

/// Options of `nonio serve`.
struct LiveWish {
  std::filesystem::path folder;  ///< folder of a campaign or of a site
  std::string name;              ///< the folder as the person wrote it
  std::vector<std::filesystem::path> plugin_folders, template_folders;
  std::vector<std::string> plugin_paths, template_paths;  ///< plugin and template folders as given
                                                          ///< on the command line
  std::filesystem::path own_plugins, program;
  std::string version;
  std::filesystem::path out;       ///< for a site: output folder of its runs; empty: none
  std::string token_file;          ///< file with the token; empty: a new token at each start
  std::vector<std::string> hosts;  ///< names of this server under which a proxy calls it (--host)
  std::string user_header;         ///< header in which the proxy states the user; empty: there is
                                   ///< no such proxy
  std::uint16_t port = 0;
  bool edit = false, quiet = false;
  bool sign_in = false;  ///< whether users sign in at this server: a site with users.toml and
                         ///< without `user_header`; set by service_of
};

/// Serves the page until SIGINT, SIGTERM or SIGHUP. Prints one line: the address, with the token
/// unless users sign in. An error states why it could not start. Must be called by a process with
/// one thread and without plugins.
Expected<void> serve(const LiveWish& wish);

/// The implementation of `serve`, exported as `nonio_serve` by a library that is loaded late
/// (late_library.h).
using Serve = Expected<void> (*)(const LiveWish& wish);

}  // namespace nonio::live
