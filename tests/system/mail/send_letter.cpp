// SPDX-License-Identifier: Apache-2.0
//
// send_letter SITE SUBJECT TEXT [SECONDS]: sends a letter as [mail] of SITE/site.toml says. Exit
// status 1: not sent, 2: site.toml is wrong.
#include <iostream>
#include <string>

#include "batch/close/mail.h"
#include "campaign/config/site_files.h"

int main(int argc, char** argv) {
  using namespace nonio;
  using namespace nonio;
  if (argc < 4) return std::cerr << "usage: send_letter SITE SUBJECT TEXT [SECONDS]\n", 2;
  std::string digest;
  const auto site = config::read_site(argv[1], digest);
  if (!site || !site->mail) {
    if (!site)
      for (const Error& e : site.error()) std::cerr << e.line << ": " << e.message << '\n';
    return 2;
  }
  const auto sent = batch::send_mail(*site->mail, argv[1], {argv[2], argv[3]},
                                     argc > 4 ? std::stod(argv[4]) : 60.0);
  if (!sent) std::cerr << sent.error().message << '\n';
  return sent ? 0 : 1;
}
