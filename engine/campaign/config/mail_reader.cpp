// SPDX-License-Identifier: Apache-2.0
#include "campaign/config/mail_reader.h"

namespace nonio::config {

namespace {

constexpr const char* ways[] = {"smtp", "tls", "port", "trust", "user"};

/// What stands in one of several keys, or needs another one.
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

}  // namespace

Mail read_mail(TableReader& reader) {
  Mail m;
  m.to = reader.texts("to").value_or(std::vector<std::string>{});
  m.from = reader.text("from");
  const std::string on = reader.text("on"), tls = reader.text("tls");
  m.on = on == "lost" ? Mail::On::lost : on == "out" ? Mail::On::out : Mail::On::decision;
  m.tls = tls == "tls" ? Mail::Tls::tls : tls == "none" ? Mail::Tls::none : Mail::Tls::starttls;
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

}  // namespace nonio::config
