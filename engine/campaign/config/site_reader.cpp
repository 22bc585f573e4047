// SPDX-License-Identifier: Apache-2.0
#include <set>
#include <sstream>

#include "campaign/config/certificate_reader.h"
#include "campaign/config/manifest.h"
#include "campaign/config/run_reader.h"
#include "campaign/config/toml_reader.h"
#include "nonio/sdk/format.h"
#include "nonio/sdk/statement.h"
#include "platform/storage/database.h"

namespace nonio::config {

namespace {

constexpr const char* ways[] = {"smtp", "tls", "port", "trust", "user"};

/// Keys that exclude each other, and keys that need another one.
void check_mail(TableReader& reader, const Mail& m) {
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

/// `[mail]` of site.toml. No password leaves without encryption.
Mail read_mail(TableReader& reader) {
  Mail m;
  m.to = reader.texts("to").value_or(std::vector<std::string>{});
  m.from = reader.text("from");
  const std::string on = reader.text("on"), tls = reader.text("tls");
  m.on = on == "lost" ? Mail::On::lost : on == "out" ? Mail::On::out : Mail::On::decision;
  m.tls = tls == "tls" ? Mail::Tls::tls : tls == "none" ? Mail::Tls::none : Mail::Tls::starttls;
  m.base_url = reader.text("base_url");
  m.sendmail = reader.text("sendmail");
  m.smtp = reader.text("smtp");
  m.port = reader.integer("port").value_or(usual_port(m.tls));
  m.trust = reader.text("trust");
  m.user = reader.text("user");
  m.password_file = reader.text("password_file");
  m.password_env = reader.text("password_env");
  m.password_credential = reader.text("password_credential");
  check_mail(reader, m);
  reader.finish();
  return m;
}

/// `[webhook]` of site.toml. Nothing leaves this machine readable.
Webhook read_webhook(TableReader& reader) {
  Webhook w{reader.text("url"), reader.text("secret_file"), reader.text("trust")};
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
  reader.finish();
  return w;
}

constexpr double cmc_length = 1e-6, cmc_angle = 1.0 / arcsec_per_rad;

/// Keys that exclude each other, and keys that need another one.
void check_signing(TableReader& reader, const Signing& s) {
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

Signing read_signing(TableReader& reader) {
  Signing s;
  s.pkcs12 = reader.text("pkcs12");
  s.pkcs11 = reader.text("pkcs11");
  s.module = reader.text("module");
  s.certificates = reader.text("certificates");
  s.password_file = reader.text("password_file");
  s.password_env = reader.text("password_env");
  s.password_credential = reader.text("password_credential");
  s.trust = reader.text("trust");
  s.revocation = reader.text("revocation");
  s.signer_roots = reader.text("signer_roots");
  s.time_stamp_roots = reader.text("time_stamp_roots");
  s.signer = reader.text("signer");
  for (TableReader& one : reader.tables("signers")) {
    s.signers.push_back({one.text("who"), one.date("from"), one.date("until")});
    const SignerRule& rule = s.signers.back();
    if (!rule.from.empty() && !rule.until.empty() && rule.until < rule.from)
      one.error("until", "is before from");
    one.finish();
  }
  s.time_stamp = reader.text("time_stamp");
  s.time_stamp_required = reader.text("time_stamp_missing") != "sign";
  s.time_stamp_seconds = reader.integer("time_stamp_seconds").value_or(s.time_stamp_seconds);
  check_signing(reader, s);
  reader.finish();
  return s;
}

Cmc read_cmc(TableReader& laboratory) {
  Cmc cmc;
  auto reader = laboratory.table("cmc");
  if (!reader) return cmc;
  cmc.fixed = reader->number("fixed_um", cmc_length);
  cmc.per_length = reader->number("per_m_um", cmc_length);
  cmc.angle = reader->number("arcsec", cmc_angle);
  reader->finish();
  return cmc;
}

/// A name that leads to a name would be followed or not, whoever reads it.
std::vector<Alias> read_aliases(TableReader& top) {
  std::vector<Alias> aliases;
  std::set<std::string> names;
  auto tables = top.tables("alias");
  for (TableReader& reader : tables) {
    Alias alias{reader.text("name"), reader.text("asset"), reader.text("why")};
    if (!alias.name.empty() && !names.insert(alias.name).second)
      reader.error("name", "\"" + alias.name + "\" is given twice");
    if (!alias.why.empty() && !has_content(alias.why))
      reader.error("why", "expected how this is known, found \"" + alias.why + "\"");
    reader.finish();
    aliases.push_back(std::move(alias));
  }
  for (std::size_t i = 0; i < aliases.size(); ++i)
    if (names.contains(aliases[i].asset))
      tables[i].error("asset", "\"" + aliases[i].asset +
                                   "\" is itself the name of an alias; expected the machine");
  return aliases;
}

DatabaseChoice read_database(TableReader& reader) {
  DatabaseChoice choice{reader.text("url"), reader.text("password_file")};
  if (const std::string schema = reader.text("schema"); !schema.empty()) choice.schema = schema;
  choice.register_schema = reader.text("register");
  if (choice.register_schema == choice.schema)
    reader.error("register",
                 "\"" + choice.schema +
                     "\" is the schema of the history, which may be removed and is made again; "
                     "expected another one for the register of certificate numbers");
  if (!choice.url.empty())
    if (const auto well = storage::check_address(choice.url); !well)
      reader.error("url", well.error().message);
  reader.finish();
  return choice;
}

std::vector<DueRule> read_due(TableReader& top) {
  std::vector<DueRule> rules;
  std::set<std::string> machines;
  for (TableReader& reader : top.tables("due")) {
    DueRule rule{reader.text("machine"), 0};
    rule.months = reader.integer("months").value_or(0);
    if (!machines.insert(rule.machine).second)
      reader.error(rule.machine.empty() ? "months" : "machine",
                   rule.machine.empty() ? "a rule for all machines is given twice"
                                        : "\"" + rule.machine + "\" is given twice");
    reader.finish();
    rules.push_back(std::move(rule));
  }
  return rules;
}

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
  top.integer("format");
  if (const std::string language = top.text("language"); !language.empty())
    site.language = language;
  if (auto reader = top.table("laboratory")) {
    site.laboratory = {reader->text("name"),       reader->text("address"),
                       reader->text("country"),    reader->text("accreditation"),
                       reader->text("authoriser"), reader->text("contact"),
                       read_cmc(*reader)};
    reader->finish();
  }
  if (auto reader = top.table("limits")) {
    site.limits.seconds = reader->number("seconds").value_or(site.limits.seconds);
    site.limits.memory_MB = reader->number("memory_MB").value_or(site.limits.memory_MB);
    site.limits.disk_seconds = reader->number("disk_seconds").value_or(site.limits.disk_seconds);
    if (const auto most = reader->integer("missing_campaigns"))
      site.limits.missing_campaigns = static_cast<std::size_t>(*most);
    reader->finish();
  }
  if (auto reader = top.table("results")) {
    site.hashed_folders = reader->text("folders") == "hashed";
    reader->finish();
  }
  site.run = read_run(top);
  site.options = read_options(top, errors);
  site.aliases = read_aliases(top);
  site.due = read_due(top);
  site.evaluation = settings_of(*root, {"run", "options"});
  toml::table printed = *root;
  // How it comes to a release is the laboratory's own business, and nothing that is printed.
  if (toml::table* certificate = printed["certificate"].as_table())
    for (const char* key : {"release", "accept", "two_persons", "register", "register_seconds"})
      certificate->erase(key);
  site.settings = settings_of(printed, {"run", "options", "laboratory", "certificate"});
  if (const toml::table* laboratory = (*root)["laboratory"].as_table())
    site.evaluation += settings_of(*laboratory, {"cmc"});
  // Decides anew what conforms. The default is what certificates were issued by before there was a
  // choice, and needs no new evaluation.
  if (const auto rule = (*root)["certificate"]["decision_rule"].value<std::string>();
      rule && *rule != "iso14253-1")
    site.evaluation += "decision_rule = \"" + *rule + "\"\n";
  if (auto reader = top.table("signing")) site.signing = read_signing(*reader);
  if (auto reader = top.table("mail")) site.mail = read_mail(*reader);
  if (auto reader = top.table("webhook")) site.webhook = read_webhook(*reader);
  if (auto reader = top.table("certificate")) {
    site.certificate = read_certificate(*reader);
    site.numbering = read_numbering(*reader);
    reader->finish();
  }
  if (auto reader = top.table("database")) {
    site.database = read_database(*reader);
    if (!site.database->register_schema.empty()) {
      const auto in_file = (*root)["certificate"]["register"].value_or(std::string());
      if (!in_file.empty())
        reader->error("register", "[certificate] register states \"" + in_file +
                                      "\"; expected the register here or there");
      site.numbering.server = site.database;
      site.numbering.server->schema = site.database->register_schema;
    }
  }
  top.finish();
  if (!errors.empty()) return tl::unexpected(std::move(errors));
  note_lines(*root, "", site.lines);
  return site;
}

}  // namespace nonio::config
