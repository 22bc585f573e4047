// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <sstream>

#include "campaign/config/checks.h"
#include "campaign/config/toml_reader.h"
#include "nonio/sdk/format.h"
#include "nonio/sdk/statement.h"
#include "platform/storage/database.h"

namespace nonio::config {

namespace {

constexpr const char* ways[] = {"smtp", "tls", "port", "trust", "user"};

int usual_port(Mail::Tls tls) {
  switch (tls) {
    case Mail::Tls::starttls:
      return 587;
    case Mail::Tls::tls:
      return 465;
    case Mail::Tls::none:
      break;
  }
  return 25;
}

}  // namespace

/// A login requires encryption, so that the password is never sent as plain text.
void check_mail(TableReader& reader, Mail& m) {
  if (m.port == 0) m.port = usual_port(m.tls);
  if (reader.raw().contains("to") && m.to.empty())
    reader.error("to", "expected at least one address");
  if (m.sendmail.empty() == m.smtp.empty())
    reader.error("smtp", "expected either smtp (a server) or sendmail (a program)");
  if (!m.sendmail.empty())
    for (const char* key : ways)
      if (reader.raw().contains(key) && m.smtp.empty())
        reader.error(key, "is not allowed with sendmail; it belongs to smtp");
  const int passwords = int{!m.password_file.empty()} + int{!m.password_env.empty()} +
                        int{!m.password_credential.empty()};
  if (passwords != (m.user.empty() ? 0 : 1))
    reader.error("password_file", m.user.empty() ? "is a password without user"
                                                 : "expected one of password_file, password_env, "
                                                   "password_credential (of systemd)");
  if (!m.user.empty() && m.tls == Mail::Tls::none)
    reader.error("tls", "none would send the password readable; expected starttls or tls");
}

/// Without encryption only addresses of this machine are allowed.
void check_webhook(TableReader& reader, Webhook& w) {
  const auto begins = [&](std::string_view host) {
    const std::string from = "http://" + std::string(host);
    return w.url.starts_with(from) &&
           (w.url.size() == from.size() || w.url[from.size()] == ':' || w.url[from.size()] == '/');
  };
  if (!w.url.empty() && !w.url.starts_with("https://") && !begins("127.0.0.1") &&
      !begins("localhost"))
    reader.error("url",
                 "expected an address that begins with https://, or with http://127.0.0.1; without "
                 "encryption customers and machines would be readable on the way");
}

void check_signer(TableReader& reader, SignerRule& rule) {
  if (!rule.from.empty() && !rule.until.empty() && rule.until < rule.from)
    reader.error("until", "is before from");
}

void check_signing(TableReader& reader, Signing& s) {
  if (s.pkcs12.empty() == s.pkcs11.empty())
    reader.error("pkcs12", "expected the key in either pkcs12 (a file) or pkcs11 (a token)");
  if (!s.pkcs11.empty() && s.module.empty())
    reader.error("module", "is missing: the PKCS#11 library of the token");
  const int passwords = int{!s.password_file.empty()} + int{!s.password_env.empty()} +
                        int{!s.password_credential.empty()};
  if (passwords != 1)
    reader.error("password_file",
                 "expected one of password_file, password_env, password_credential (of systemd)");
  if (!s.trust.empty() && !(s.signer_roots.empty() && s.time_stamp_roots.empty()))
    reader.error("trust", "excludes signer_roots and time_stamp_roots");
  if (!s.time_stamp.empty() && s.trust.empty() && s.time_stamp_roots.empty())
    reader.error("time_stamp_roots",
                 "is missing: a PEM file with the root of the time-stamp server");
  if (!s.signer.empty() && !s.signers.empty())
    reader.error("signer", "excludes [[signing.signers]]");
}

void check_alias(TableReader& reader, Alias& alias, SiteFile& site) {
  alias.line_of_asset = reader.line_of("asset");
  if (!alias.name.empty() && given_before(site.aliases, &Alias::name))
    reader.error("name", "\"" + alias.name + "\" is given twice");
  if (!alias.why.empty() && !has_content(alias.why))
    reader.error("why", "expected how this is known, found \"" + alias.why + "\"");
}

void check_database(TableReader& reader, DatabaseChoice& choice) {
  if (choice.register_schema == choice.schema)
    reader.error("register",
                 "\"" + choice.schema +
                     "\" is the schema of the history, which may be removed and is made again; "
                     "expected another one for the register of certificate numbers");
  if (!choice.url.empty())
    if (const auto well = storage::check_address(choice.url); !well)
      reader.error("url", well.error().message);
}

void check_due(TableReader& reader, DueRule& rule, SiteFile& site) {
  if (given_before(site.due, &DueRule::machine))
    reader.error(rule.machine.empty() ? "months" : "machine",
                 rule.machine.empty() ? "a rule for all machines is given twice"
                                      : "\"" + rule.machine + "\" is given twice");
}

namespace {

std::string settings_of(const toml::table& root, std::initializer_list<const char*> keys) {
  toml::table out;
  for (const char* key : keys)
    if (const toml::table* table = root[key].as_table()) out.insert(key, *table);
  if (out.empty()) return {};
  std::ostringstream text;
  text << out << "\n";
  return text.str();
}

}  // namespace

Checked<SiteFile> parse_site(std::string_view text, const std::string& file) {
  auto root = parse_toml(text, file);
  if (!root) return tl::unexpected(std::vector<Error>{root.error()});
  std::vector<Error> errors;
  SiteFile site;
  site.warnings = warnings_of(rename_former_keys(*root, site_file()), file);
  TableReader top(*root, site_file(), file, errors);
  top.fill(site);
  for (const Alias& alias : site.aliases)
    if (!alias.asset.empty() &&
        std::any_of(site.aliases.begin(), site.aliases.end(),
                    [&](const Alias& other) { return other.name == alias.asset; }))
      errors.push_back(Error{"alias.asset: \"" + alias.asset +
                                 "\" is itself the name of an alias; expected the machine",
                             file, alias.line_of_asset});
  site.evaluation = settings_of(*root, {"run", "options"});
  toml::table printed = *root;
  if (toml::table* certificate = printed["certificate"].as_table())
    for (const char* key : {"release", "accept", "two_persons", "register", "register_seconds"})
      certificate->erase(key);
  site.settings = settings_of(printed, {"run", "options", "laboratory", "certificate"});
  if (const toml::table* laboratory = (*root)["laboratory"].as_table())
    site.evaluation += settings_of(*laboratory, {"cmc"});
  // The decision rule changes which results conform. The default requires no new evaluation,
  // because it was used before this key existed.
  if (const auto rule = (*root)["certificate"]["decision_rule"].value<std::string>();
      rule && *rule != "iso14253-1")
    site.evaluation += "decision_rule = \"" + *rule + "\"\n";
  if (site.database && !site.database->register_schema.empty()) {
    const auto in_file = (*root)["certificate"]["register"].value_or(std::string());
    if (!in_file.empty())
      top.tables(*find_key(site_file().keys, "database"))
          .front()
          .error("register", "[certificate] register states \"" + in_file +
                                 "\"; expected the register here or there");
    site.numbering.server = site.database;
    site.numbering.server->schema = site.database->register_schema;
  }
  top.finish();
  if (!errors.empty()) return tl::unexpected(std::move(errors));
  note_lines(*root, "", site.lines);
  return site;
}

}  // namespace nonio::config
