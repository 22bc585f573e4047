// SPDX-License-Identifier: Apache-2.0
#include "campaign/config/keys/shared.h"

namespace nonio::config {
namespace declared {

constexpr Choice releases[] = {
    choice(false, "by-hand", "a person, with nonio certificate approve"),
    choice(true, "automatic", "the nightly run, for findings that `accept` lists")};
constexpr Key accepted_rule_keys[] = {
    {"finding", into<&AcceptedRule::finding>,
     "Id of a finding, \"plan.few-runs\"; with \".*\" at its end a group of findings.",
     missing("expected the id of a finding"),
     spelled({.letters = "a-zA-Z0-9.*+_-"},
             "expected the id of a finding, or of a kind, \"tolerance.*\"; found \"{}\"")},
    {"reason", into<&AcceptedRule::reason>,
     "Reason why a certificate may be issued in spite of the finding; kept in the register.",
     missing("expected why a certificate may be issued despite the finding")},
};

constexpr Key numbering_keys[] = {
    {"numbering", into<&SiteFile::numbering, &Numbering::pattern>,
     "Format of the certificate numbers; with {year} the sequence restarts each year.",
     otherwise("{year}-{number:4}")},
    {"register", into<&SiteFile::numbering, &Numbering::register_file>,
     "File inside the site with all numbers and issued files; include it in the backup.",
     otherwise("certificates.sqlite")},
    {"register_seconds", into<&SiteFile::numbering, &Numbering::patience>,
     "Waiting time for a register that another process has locked. Campaigns that still need a "
     "number are evaluated again in the next run.",
     seconds, otherwise("60"), within(0.0, 86400.0, "expected a number from 0 to 86400")},
    {"release", chosen<&SiteFile::numbering, &Numbering::automatic>,
     "Who approves certificates: a person, or the nightly run if every finding with severity "
     "warning is listed in `accept`.",
     otherwise("by-hand"), releases},
    {"accept", nested<&SiteFile::numbering, &Numbering::accepted>,
     "Findings with severity warning that do not prevent an automatic approval, each with the "
     "reason; [] for none.",
     accepted_rule_keys, former("may_stand")},
    {"two_persons", into<&SiteFile::numbering, &Numbering::two_persons>,
     "The author signs off each draft, and another person, an authoriser, approves it.",
     otherwise("false")},
};

constexpr auto certificate_of_site =
    joined(certificate_texts<&SiteFile::certificate>, numbering_keys);

constexpr Key cmc_keys[] = {
    {"fixed_um", into<&Cmc::fixed>, "The part a of a + b L.", um, not_negative},
    {"per_m_um", into<&Cmc::per_length>, "The part b of a + b L, per metre of length.", um,
     not_negative},
    {"arcsec", into<&Cmc::angle>,
     "The smallest uncertainty of angles: rotary axes, squareness, directions.", arcsec,
     not_negative},
};

constexpr Key laboratory_keys[] = {
    {"name", into<&Laboratory::name>, "Name of the laboratory."},
    {"address", into<&Laboratory::address>, "Address of the laboratory."},
    {"country", into<&Laboratory::country>, "Country of the laboratory, two letters: \"IT\"."},
    {"accreditation", into<&Laboratory::accreditation>,
     "Number of the accreditation; for accredited laboratories only."},
    {"authoriser", into<&Laboratory::authoriser>,
     "Names of the persons who may approve certificates, separated by ';'."},
    {"contact", into<&Laboratory::contact>, "Contact of the laboratory."},
    {"cmc", nested<&Laboratory::cmc>,
     "The smallest expanded uncertainty (k = 2) that the accreditation covers, a + b L: no result "
     "gets a smaller one.",
     cmc_keys},
};

constexpr Key limits_keys[] = {
    {"seconds", into<&Limits::seconds>, "Time limit for one campaign.", seconds, otherwise("600"),
     Range{"expected a number above 0 and at most 1000000", 0.0, 1e6, true}},
    {"memory_MB", into<&Limits::memory_MB>, "Memory limit for one campaign.", MB, otherwise("4096"),
     within(64.0, 1e9, "expected 64 or more, and at most 1000000000")},
    {"disk_seconds", into<&Limits::disk_seconds>,
     "Time without a response after which a folder or file of the site is reported as failed "
     "during the survey.",
     seconds, otherwise("60"),
     Range{"expected a number above 0 and at most 1000000", 0.0, 1e6, true}},
    {"missing_campaigns", into<&Limits::missing_campaigns>,
     "Number of campaigns of the previous run that may be missing; with more of them the exit "
     "status is 1. Record campaigns removed on purpose with `nonio machine remove`.",
     otherwise("0"), former("vanished")},
};

constexpr Key alias_keys[] = {
    {"name", into<&Alias::name>,
     "Name of a machine in campaigns: an asset, or maker and serial with a space between them.",
     required},
    {"asset", into<&Alias::asset>, "The same machine as `nonio machine list` names it.", required},
    {"why", into<&Alias::why>, "Evidence for it.", required},
};

constexpr TextRule schema_name = {.letters = "a-z0-9_", .not_first = "0123456789", .longest = 63};
constexpr const char* schema_wanted =
    "expected 1 to 63 characters of a-z, 0-9 and _, not starting with a digit, found \"{}\"";

constexpr Key database_keys[] = {
    {"url", into<&DatabaseChoice::url>,
     "The PostgreSQL database that keeps the history in place of OUT/history.sqlite, "
     "postgresql://user@host/name?sslmode=verify-full, as libpq reads it; without a password.",
     required, secret,
     spelled({.begins = "postgresql://"}, "expected postgresql://user@host/name")},
    {"password_file", into<&DatabaseChoice::password_file>,
     "File with the password, for its owner alone (chmod 600). Default: as libpq finds it: "
     "service, ~/.pgpass, PGPASSFILE, PGPASSWORD."},
    {"schema", into<&DatabaseChoice::schema>,
     "Schema of this site's tables; each site of a database has its own.", otherwise("nonio"),
     spelled(schema_name, schema_wanted)},
    {"register", into<&DatabaseChoice::register_schema>,
     "Another schema, for the register of certificate numbers. Default: the register is a file, "
     "see [certificate] register.",
     spelled(schema_name, schema_wanted)},
};

constexpr Key due_keys[] = {
    {"machine", into<&DueRule::machine>,
     "The machine, as `nonio machine list` names it; without it, all machines that no other entry "
     "names."},
    {"months", into<&DueRule::months>, "From the last campaign to the next.", required,
     within(1, 240, "expected 1 to 240 months")},
};

constexpr Choice result_folders[] = {choice(false, "flat", "OUT/ID"),
                                     choice(true, "hashed", "OUT/ab/ID")};
constexpr Key results_keys[] = {
    {"folders", chosen<&SiteFile::hashed_folders>,
     "Layout of the output folder: each campaign in OUT/ID, or in OUT/ab/ID, where ab are the "
     "first two digits of the SHA-256 of the id; for sites with a million campaigns.",
     otherwise("flat"), result_folders},
};

constexpr Choice fail_or_sign[] = {choice(true, "fail"), choice(false, "sign")};
constexpr Key signer_keys[] = {
    {"who", into<&SignerRule::who>, "Subject of the certificate, or its SHA-256.", required},
    {"from", day<&SignerRule::from>, "First day of its signatures."},
    {"until", day<&SignerRule::until>, "Last day of its signatures."},
};
constexpr Key signing_keys[] = {
    {"pkcs12", into<&Signing::pkcs12>,
     "The key as a file, relative to the site; alternative to pkcs11."},
    {"pkcs11", into<&Signing::pkcs11>,
     "The key on a token, \"pkcs11:token=lab;object=calib\"; alternative to pkcs12."},
    {"module", into<&Signing::module>, "PKCS#11 library of the token."},
    {"certificates", into<&Signing::certificates>, "PEM file with the intermediate certificates."},
    {"password_file", into<&Signing::password_file>,
     "File with the password; alternative to password_env and password_credential."},
    {"password_env", into<&Signing::password_env>, "Environment variable with the password."},
    {"password_credential", into<&Signing::password_credential>,
     "Credential of systemd with the password."},
    {"trust", into<&Signing::trust>,
     "PEM file with one root, for signers and for time servers; alternative to signer_roots and "
     "time_stamp_roots."},
    {"signer_roots", into<&Signing::signer_roots>,
     "PEM file with the roots of signers, for `nonio certificate verify`."},
    {"time_stamp_roots", into<&Signing::time_stamp_roots>,
     "PEM file with the roots of time servers; they make no signer."},
    {"revocation", into<&Signing::revocation>,
     "PEM file with revocation lists, for `nonio certificate verify`."},
    {"signer", into<&Signing::signer>,
     "Signer that `nonio certificate verify` expects: subject, or SHA-256 of the certificate; "
     "alternative to signers."},
    {"signers", checked<check_signer, &Signing::signers>,
     "Signers that `nonio certificate verify` expects, each with the days on which it signed.",
     signer_keys},
    {"time_stamp", into<&Signing::time_stamp>, "Address of a time-stamp server, http://...",
     spelled({.begins = "http://"},
             "expected http://..., found \"{}\" (a time stamp is signed; it needs no https)")},
    {"time_stamp_missing", chosen<&Signing::time_stamp_required>,
     "Behaviour if the time-stamp server does not answer: the campaign fails, or the certificate "
     "is signed without time stamp, and the summary states this.",
     otherwise("fail"), fail_or_sign},
    {"time_stamp_seconds", into<&Signing::time_stamp_seconds>,
     "Time limit for the time-stamp server.", seconds, otherwise("10"),
     within(1, 300, "expected 1 to 300")},
};

constexpr TextRule address_rule{
    .not_letters = " \t\r\n,;<>\"\\", .not_first = "-.@", .longest = 250};
constexpr Words address_wanted = "expected an address, found \"{}\"";
constexpr Choice mail_reasons[] = {choice(Mail::On::lost, "lost"),
                                   choice(Mail::On::out, "out", "what is lost or out of tolerance"),
                                   choice(Mail::On::decision, "decision", "whatever is new")};
constexpr Choice mail_tls[] = {choice(Mail::Tls::starttls, "starttls", "port 587"),
                               choice(Mail::Tls::tls, "tls", "port 465"),
                               choice(Mail::Tls::none, "none", "port 25, no password")};
constexpr Key mail_keys[] = {
    {"to", into<&Mail::to>, "Addresses that get it.", required,
     spelled(address_rule, "expected addresses without spaces, commas and brackets"), longest(50),
     distinct},
    {"from", into<&Mail::from>, "Address of the sender.", required,
     spelled(address_rule, address_wanted)},
    {"on", into<&Mail::on>,
     "Condition for a mail: a campaign is lost or failed; or a machine is out of tolerance; or any "
     "line requires action.",
     otherwise("decision"), mail_reasons},
    {"base_url", into<&Mail::base_url>,
     "Address at which people open the output folder: https://lab.example/out. Links in a mail "
     "begin with it; without it they are relative to the output folder.",
     spelled({.not_letters = " \t\r\n<>\"[]", .longest = 500, .begins = "http"},
             "expected an address that begins with https:// or http://, found \"{}\"")},
    {"sendmail", into<&Mail::sendmail>,
     "Program that takes the mail, with its whole path; alternative to smtp.",
     spelled({.begins = "/"}, "expected a path that begins with /, found \"{}\"")},
    {"smtp", into<&Mail::smtp>, "Name of the mail server; alternative to sendmail.",
     spelled({.letters = "a-zA-Z0-9.:_-", .not_first = "-.", .longest = 250},
             "expected the name of a server, found \"{}\"")},
    {"tls", into<&Mail::tls>,
     "Encryption of the way to the server: begun with STARTTLS, from the first byte, or none.",
     otherwise("starttls"), mail_tls},
    {"port", into<&Mail::port>, "Port of the server; by tls 587, 465 or 25.",
     within(1, 65535, "expected 1 to 65535")},
    {"trust", into<&Mail::trust>,
     "PEM file with the roots that the server's certificate must come from; without it those of "
     "the system."},
    {"user", into<&Mail::user>, "Name at the server; without it the mail is sent without a login."},
    {"password_file", into<&Mail::password_file>,
     "File with the password; alternative to password_env and password_credential."},
    {"password_env", into<&Mail::password_env>, "Environment variable with the password."},
    {"password_credential", into<&Mail::password_credential>,
     "Credential of systemd with the password."},
};

constexpr Key webhook_keys[] = {
    {"url", into<&Webhook::url>,
     "Address that new lines of the worklist are sent to: https://, or http:// on this machine.",
     required,
     spelled(
         {.not_letters = " \t\r\n<>\"[]@", .longest = 500, .begins = "http"},
         "expected an address that begins with https://, or with http://127.0.0.1, found \"{}\"")},
    {"secret_file", into<&Webhook::secret_file>, "File with the secret that signs each message.",
     required},
    {"trust", into<&Webhook::trust>,
     "PEM file with the roots that the server's certificate must come from; without it those of "
     "the system."},
};

constexpr Key explain_keys[] = {
    {"priors", into<&SiteFile::priors>,
     "Whether it weighs its candidates by how often they were found on other machines "
     "(fleet.toml). Printed evidence is the same.",
     otherwise("true")},
};

constexpr Choice terminal_languages[] = {{"de"}, {"en"}, {"it"}};
constexpr Key site_file_keys[] = {
    format_key,
    {"language", into<&SiteFile::language>,
     "Language of summary.txt, the pages and what commands print. English in every language are "
     "JSON, --help, messages of errors (also where a screen quotes them), `check "
     "--only-templates`, `certificate extend` and `send`, `model simulate`, `table controls`, "
     "`plugin`, `schema`, `serve`, `upgrade`, `backup` and `restore`, `certificate verify` without "
     "--site, and commands that find no site or results.",
     otherwise("en"), terminal_languages},
    {"laboratory", nested<&SiteFile::laboratory>, "The calibration laboratory.", laboratory_keys},
    {"limits", nested<&SiteFile::limits>, "Limits for one campaign.", limits_keys},
    {"results", same<SiteFile>, "Layout of the output folder.", results_keys},
    run_key<SiteFile>,
    {"explain", same<SiteFile>, "Search of `nonio model explain`.", explain_keys},
    options_key<SiteFile>,
    {"alias", checked<check_alias, &SiteFile::aliases>,
     "Two names of one machine, [[alias]]: its campaigns form one history.", alias_keys},
    {"due", checked<check_due, &SiteFile::due>, "When machines are measured again, [[due]].",
     due_keys},
    {"signing", checked<check_signing, &SiteFile::signing>,
     "Key and time stamps for signed certificates.", signing_keys},
    {"mail", checked<check_mail, &SiteFile::mail>,
     "Mail of the nightly run, sent only when action is required.", mail_keys},
    {"webhook", checked<check_webhook, &SiteFile::webhook>,
     "Message to a program about new lines of the worklist.", webhook_keys},
    {"certificate", same<SiteFile, check_numbering>, "Content and numbering of certificates.",
     certificate_of_site},
    {"database", checked<check_database, &SiteFile::database>,
     "A PostgreSQL server for the history.", database_keys},
};

constexpr Key site_toml = {"site.toml", file<SiteFile>, "Settings for all campaigns of a site.",
                           site_file_keys};

}  // namespace declared

const Key& site_file() { return declared::site_toml; }

}  // namespace nonio::config
