// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <filesystem>
#include <iostream>
#include <memory>

#include "batch/close/mail.h"
#include "campaign/config/site_files.h"
#include "certificates/certificate_list.h"
#include "platform/storage/digest.h"
#include "platform/storage/files.h"
#include "platform/storage/json_values.h"
#include "verbs.h"

namespace nonio::app {
namespace fs = std::filesystem;

namespace {

struct SendWish {
  std::string file, site, to;
};

int send(const SendWish& wish, const Common& common) {
  std::string digest;
  const auto site = config::read_site(wish.site, digest);
  if (!site) return complain(text_of(site.error().front()));
  if (!site->mail)
    return complain("site.toml contains no [mail]; expected the addresses and how mail is sent");
  config::Mail mail = *site->mail;
  if (std::find(mail.to.begin(), mail.to.end(), wish.to) == mail.to.end())
    return complain("--to " + wish.to + ": expected an address that [mail] of site.toml states");
  mail.to = {wish.to};
  const auto bytes = storage::read_file(wish.file);
  if (!bytes) return complain(text_of(bytes.error()));
  const std::string sha256 = storage::sha256(*bytes);
  if (const auto may = certificates::not_out_of_force(wish.site, sha256); !may)
    return complain(may.error().message);
  const fs::path path(wish.file);
  const std::string name = path.filename().string(),
                    campaign = fs::absolute(path).parent_path().filename().string();
  const auto sent = batch::send_mail(
      mail, wish.site,
      {campaign + ": " + name, name + "\nSHA-256 " + sha256 + "\n", campaign + "-" + name, *bytes});
  if (!sent) return complain(sent.error().message, exit_failed);
  if (common.json)
    print_json({{"schema", "nonio-send/1"}, {"file", wish.file}, {"to", wish.to}});
  else if (!common.quiet)
    std::cout << name << " of " << campaign << " sent to " << wish.to << "\n";
  return exit_done;
}

}  // namespace

Verb send_verb(Common& common) {
  auto wish = std::make_shared<SendWish>();
  using Takes = Argument::Takes;
  return {.name = "send",
          .summary = "Sends a certificate or report by mail",
          .arguments = joined(
              {required(existing(Takes::file, {"FILE", &wish->file,
                                               "File of a campaign's results, which is attached"})),
               required(existing(Takes::folder, {"--site", &wish->site,
                                                 "Site whose site.toml, [mail], states "
                                                 "the addresses and how mail is sent"})),
               required({"--to", &wish->to, "One of these addresses"})},
              common_arguments(common)),
          .footer =
              "Nothing is sent to an address that [mail] does not state. Exit status 1 if "
              "the mail was not accepted.",
          .examples = {"nonio certificate send out/c1/certificate.pdf --site site --to "
                       "lab@example.org"},
          .run = [wish, &common] { return send(*wish, common); }};
}

}  // namespace nonio::app
