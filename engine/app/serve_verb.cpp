// SPDX-License-Identifier: Apache-2.0
#include <filesystem>
#include <iostream>
#include <memory>

#include "certificates/users.h"
#include "live/server.h"
#include "questions.h"
#include "verbs.h"

namespace nonio::app {

namespace {

struct LiveOptions {
  std::string folder, out, token_file, user_header;
  std::vector<std::string> hosts;
  std::uint64_t port = 0;
  bool edit = false, hash_password = false;
};

int print_hash() {
  const auto password = read_password("the user");
  if (!password) return complain(text_of(password.error()));
  const auto hash = certificates::password_hash(*password);
  if (!hash) return complain(text_of(hash.error()));
  std::cout << "password = \"" << *hash << "\"\n";
  return exit_done;
}

int live(const LiveOptions& options, const Common& common) {
  if (options.hash_password) return print_hash();
  live::LiveWish wish;
  std::error_code error;
  wish.folder = std::filesystem::canonical(options.folder, error);
  if (error) return complain(options.folder + ": " + error.message());
  wish.name = options.folder;
  wish.plugin_folders = common.plugin_folders();
  wish.template_folders = common.template_folders();
  wish.plugin_paths = common.plugin_paths;
  wish.template_paths = common.template_paths;
  wish.own_plugins = Common::own_plugins();
  wish.version = NONIO_VERSION;
  if (!options.out.empty()) wish.out = std::filesystem::absolute(options.out);
  wish.token_file = options.token_file;
  wish.hosts = options.hosts;
  wish.user_header = options.user_header;
  if (!wish.user_header.empty() && wish.hosts.empty())
    return complain("--user-header is for a reverse proxy: expected --host NAME");
  wish.port = static_cast<std::uint16_t>(options.port);
  wish.edit = options.edit;
  wish.quiet = common.quiet;
  if (const auto served = live::serve(wish); !served) return complain(text_of(served.error()));
  return exit_done;
}

}  // namespace

Verb serve_verb(Common& common) {
  auto options = std::make_shared<LiveOptions>();
  using Takes = Argument::Takes;
  return {
      .name = "serve",
      .summary =
          "Serves a page on this computer: the model of a campaign, or the worklist of a site",
      .arguments = joined(
          {required(existing(Takes::folder,
                             {"SITE|CAMPAIGN", &options->folder,
                              "Folder of one campaign, with its campaign.toml; or a site"})),
           takes(Takes::folder,
                 {"--out", &options->out,
                  "Of a site: output folder of `nonio run`, whose worklist is shown"}),
           {"--edit", &options->edit,
            "The page may write: save the model to campaign.toml. Without it nothing is written."},
           takes(Takes::file,
                 {"--token-file", &options->token_file,
                  "Keep the token in this file, so that the address stays after a restart; it is "
                  "created if it does not exist, and only this user may be able to read it"}),
           {"--host", &options->hosts,
            "Name (NAME or NAME:PORT) by which a reverse proxy on this computer calls the page"},
           {"--user-header", &options->user_header,
            "Of a site: header in which that proxy states the account that is logged in; "
            "SITE/users.toml states what each may do. Without it, a site with this file requires a "
            "sign-in with the passwords of the file"},
           {"--hash-password", &options->hash_password,
            "Serve nothing: read a password from the terminal or a line of standard input, and "
            "print "
            "its line for users.toml"},
           within(0, 65535, {"--port", &options->port, "Fixed port; default: any free one"}),
           templates_argument(common)},
          common_arguments(common)),
      .footer =
          "Prints one line, the address, and serves the page until Ctrl-C. On the page: the "
          "effects of the model with their sizes, readings and residuals, where the model fails, "
          "which effect is missing, and the error falling with each step. Nothing is written "
          "before \"save\", which does what `nonio model add` does.\n\nOnly this computer can "
          "reach the page, and only with the token after # in the address: it is a key, do not "
          "pass it on. From another computer: ssh -L (docs/howto-live.md).",
      .examples = {"nonio serve samples/site/02-constant-reversal",
                   "nonio serve --edit --port 4711 --token-file ~/.nonio-token campaigns/c1"},
      .run = [options, &common] { return live(*options, common); }};
}

}  // namespace nonio::app
