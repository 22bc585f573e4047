// SPDX-License-Identifier: Apache-2.0
#include "campaign/config/keys/shared.h"

namespace nonio::config {
namespace declared {

constexpr Choice releases[] = {{"by-hand", "a person, with nonio certificate approve"},
                               {"automatic", "the nightly run, for findings that `accept` lists"}};
constexpr Key accepted_rule_keys[] = {
    {.name = "finding",
     .holds = text,
     .help = "Id of a finding, \"plan.few-runs\"; with \".*\" at its end a group of findings.",
     .required = true,
     .missing = "expected the id of a finding",
     .wanted = "expected the id of a finding, or of a kind, \"tolerance.*\"; found \"{}\"",
     .text = {.letters = "a-zA-Z0-9.*+_-"}},
    {.name = "reason",
     .holds = text,
     .help = "Reason why a certificate may be issued in spite of the finding; kept in the "
             "register.",
     .required = true,
     .missing = "expected why a certificate may be issued despite the finding"},
};

constexpr Key certificate_of_site[] = {
    languages_key,
    template_key,
    location_key,
    procedure_key,
    title_key,
    decision_rule_key,
    {.name = "numbering",
     .holds = text,
     .help = "Format of the certificate numbers; with {year} the sequence restarts each year.",
     .otherwise = "{year}-{number:4}"},
    {.name = "register",
     .holds = text,
     .help = "File inside the site with all numbers and issued files; include it in the backup.",
     .otherwise = "certificates.sqlite"},
    {.name = "register_seconds",
     .holds = number,
     .help = "Waiting time for a register that another process has locked. Campaigns that "
             "still need a number are evaluated again in the next run.",
     .unit = "s",
     .otherwise = "60",
     .wanted = "expected a number from 0 to 86400",
     .least = 0.0,
     .most = 86400.0},
    {.name = "release",
     .holds = text,
     .help = "Release of certificates: by a person, or by the nightly run if every finding "
             "with severity warning is listed in `accept`.",
     .otherwise = "by-hand",
     .choices = releases},
    {.name = "accept",
     .holds = tables,
     .help = "Findings with severity warning that do not prevent an automatic release, each "
             "with the reason; [] for none.",
     .keys = accepted_rule_keys,
     .former = "may_stand"},
    {.name = "two_persons",
     .holds = flag,
     .help = "The author approves a certificate, and another person releases it.",
     .otherwise = "false"},
};

constexpr Key cmc_keys[] = {
    {.name = "fixed_um",
     .holds = number,
     .help = "The part a of a + b L.",
     .unit = "um",
     .wanted = not_negative,
     .least = 0.0},
    {.name = "per_m_um",
     .holds = number,
     .help = "The part b of a + b L, per metre of length.",
     .unit = "um",
     .wanted = not_negative,
     .least = 0.0},
    {.name = "arcsec",
     .holds = number,
     .help = "The smallest uncertainty of angles: rotary axes, squareness, directions.",
     .unit = "arcsec",
     .wanted = not_negative,
     .least = 0.0},
};

constexpr Key laboratory_keys[] = {
    {"name", text, "Name of the laboratory."},
    {"address", text, "Address of the laboratory."},
    {"country", text, "Country of the laboratory, two letters: \"IT\"."},
    {"accreditation", text, "Number of the accreditation; for accredited laboratories only."},
    {"authoriser", text,
     "Name of the person who authorises certificates; several are separated by ';'. "
     "No other person can approve one."},
    {"contact", text, "Contact of the laboratory."},
    {.name = "cmc",
     .holds = table,
     .help = "The smallest expanded uncertainty (k = 2) that the accreditation covers, a + b L: no "
             "result gets a smaller one.",
     .keys = cmc_keys},
};

constexpr Key limits_keys[] = {
    {.name = "seconds",
     .holds = number,
     .help = "Time limit for one campaign.",
     .unit = "s",
     .otherwise = "600",
     .wanted = "expected a number above 0 and at most 1000000",
     .least = 0.0,
     .most = 1e6,
     .above = true},
    {.name = "memory_MB",
     .holds = number,
     .help = "Memory limit for one campaign.",
     .unit = "MB",
     .otherwise = "4096",
     .wanted = "expected 64 or more, and at most 1000000000",
     .least = 64.0,
     .most = 1e9},
    {.name = "disk_seconds",
     .holds = number,
     .help =
         "Time without a response after which a folder or file of the site is reported as failed "
         "during the survey.",
     .unit = "s",
     .otherwise = "60",
     .wanted = "expected a number above 0 and at most 1000000",
     .least = 0.0,
     .most = 1e6,
     .above = true},
    {.name = "missing_campaigns",
     .holds = whole,
     .help = "Number of campaigns of the previous run that may be missing; with more of them the "
             "exit status is 1. Record campaigns removed on purpose with `nonio machine remove`.",
     .otherwise = "0",
     .former = "vanished"},
};

constexpr Key alias_keys[] = {
    {.name = "name",
     .holds = text,
     .help = "Name of a machine in campaigns: an asset, or maker and serial with a space between "
             "them.",
     .required = true},
    {.name = "asset",
     .holds = text,
     .help = "The same machine as `nonio machine list` names it.",
     .required = true},
    {.name = "why", .holds = text, .help = "Evidence for it.", .required = true},
};

constexpr TextRule schema_name = {.letters = "a-z0-9_", .not_first = "0123456789", .longest = 63};
constexpr const char* schema_wanted =
    "expected 1 to 63 characters of a-z, 0-9 and _, not starting with a digit, found \"{}\"";

constexpr Key database_keys[] = {
    {.name = "url",
     .holds = text,
     .help = "The PostgreSQL database that keeps the history in place of OUT/history.sqlite, "
             "postgresql://user@host/name?sslmode=verify-full, as libpq reads it; without a "
             "password.",
     .required = true,
     .wanted = "expected postgresql://user@host/name",
     .may_be_secret = true,
     .text = {.begins = "postgresql://"}},
    {"password_file", text,
     "File with the password, for its owner alone (chmod 600). Default: as libpq finds it: "
     "service, ~/.pgpass, PGPASSFILE, PGPASSWORD."},
    {.name = "schema",
     .holds = text,
     .help = "Schema of this site's tables; each site of a database has its own.",
     .otherwise = "nonio",
     .wanted = schema_wanted,
     .text = schema_name},
    {.name = "register",
     .holds = text,
     .help = "Another schema, for the register of certificate numbers. Default: the register is a "
             "file, see [certificate] register.",
     .wanted = schema_wanted,
     .text = schema_name},
};

constexpr Key due_keys[] = {
    {"machine", text,
     "The machine, as `nonio machine list` names it; without it, all machines that no "
     "other entry names."},
    {.name = "months",
     .holds = whole,
     .help = "From the last campaign to the next.",
     .required = true,
     .wanted = "expected 1 to 240 months",
     .least = 1,
     .most = 240},
};

constexpr Choice result_folders[] = {{"flat", "OUT/<id>"}, {"hashed", "OUT/ab/<id>"}};
constexpr Key results_keys[] = {
    {.name = "folders",
     .holds = text,
     .help = "Layout of the output folder: each campaign in OUT/<id>, or in OUT/ab/<id>, where ab "
             "are the first two digits of the SHA-256 of the id; for sites with a million "
             "campaigns.",
     .otherwise = "flat",
     .choices = result_folders},
};

constexpr Choice fail_or_sign[] = {{"fail"}, {"sign"}};
constexpr Key signer_keys[] = {
    {.name = "who",
     .holds = text,
     .help = "Subject of the certificate, or its SHA-256.",
     .required = true},
    {"from", date, "First day of its signatures."},
    {"until", date, "Last day of its signatures."},
};
constexpr Key signing_keys[] = {
    {"pkcs12", text, "The key as a file, relative to the site; alternative to pkcs11."},
    {"pkcs11", text,
     "The key on a token, \"pkcs11:token=lab;object=calib\"; alternative to pkcs12."},
    {"module", text, "PKCS#11 library of the token."},
    {"certificates", text, "PEM file with the intermediate certificates."},
    {"password_file", text,
     "File with the password; alternative to password_env and password_credential."},
    {"password_env", text, "Environment variable with the password."},
    {"password_credential", text, "Credential of systemd with the password."},
    {"trust", text,
     "PEM file with one root, for signers and for time servers; alternative to "
     "signer_roots and time_stamp_roots."},
    {"signer_roots", text, "PEM file with the roots of signers, for `nonio certificate verify`."},
    {"time_stamp_roots", text, "PEM file with the roots of time servers; they make no signer."},
    {"revocation", text, "PEM file with revocation lists, for `nonio certificate verify`."},
    {"signer", text,
     "Signer that `nonio certificate verify` expects: subject, or SHA-256 of the certificate; "
     "alternative to signers."},
    {.name = "signers",
     .holds = tables,
     .help =
         "Signers that `nonio certificate verify` expects, each with the days on which it signed.",
     .keys = signer_keys},
    {.name = "time_stamp",
     .holds = text,
     .help = "Address of a time-stamp server, http://...",
     .wanted = "expected http://..., found \"{}\" (a time stamp is signed; it needs no https)",
     .text = {.begins = "http://"}},
    {.name = "time_stamp_missing",
     .holds = text,
     .help = "Behaviour if the time-stamp server does not answer: the campaign fails, or the "
             "certificate is signed without time stamp, and the summary states this.",
     .otherwise = "fail",
     .choices = fail_or_sign},
    {.name = "time_stamp_seconds",
     .holds = whole,
     .help = "Time limit for the time-stamp server.",
     .unit = "s",
     .otherwise = "10",
     .wanted = "expected 1 to 300",
     .least = 1,
     .most = 300},
};

constexpr TextRule address_rule{
    .not_letters = " \t\r\n,;<>\"\\", .not_first = "-.@", .longest = 250};
constexpr Words address_wanted = "expected an address, found \"{}\"";
constexpr Choice mail_reasons[] = {
    {"lost"}, {"out", "what is lost or out of tolerance"}, {"decision", "whatever is new"}};
constexpr Choice mail_tls[] = {
    {"starttls", "port 587"}, {"tls", "port 465"}, {"none", "port 25, no password"}};
constexpr Key mail_keys[] = {
    {.name = "to",
     .holds = texts,
     .help = "Addresses that get it.",
     .required = true,
     .wanted = "expected addresses without spaces, commas and brackets",
     .text = address_rule,
     .longest_list = 50,
     .distinct = true},
    {.name = "from",
     .holds = text,
     .help = "Address of the sender.",
     .required = true,
     .wanted = address_wanted,
     .text = address_rule},
    {.name = "on",
     .holds = text,
     .help = "Condition for a mail: a campaign is lost or failed; or a machine is out of "
             "tolerance; or any line requires action.",
     .otherwise = "decision",
     .choices = mail_reasons},
    {.name = "base_url",
     .holds = text,
     .help = "Address at which people open the output folder: https://lab.example/out. Links in a "
             "mail begin with it; without it they are relative to the output folder.",
     .wanted = "expected an address that begins with https:// or http://, found \"{}\"",
     .text = {.not_letters = " \t\r\n<>\"[]", .longest = 500, .begins = "http"}},
    {.name = "sendmail",
     .holds = text,
     .help = "Program that takes the mail, with its whole path; alternative to smtp.",
     .wanted = "expected a path that begins with /, found \"{}\"",
     .text = {.begins = "/"}},
    {.name = "smtp",
     .holds = text,
     .help = "Name of the mail server; alternative to sendmail.",
     .wanted = "expected the name of a server, found \"{}\"",
     .text = {.letters = "a-zA-Z0-9.:_-", .not_first = "-.", .longest = 250}},
    {.name = "tls",
     .holds = text,
     .help = "Encryption of the way to the server: begun with STARTTLS, from the first byte, or "
             "none.",
     .otherwise = "starttls",
     .choices = mail_tls},
    {.name = "port",
     .holds = whole,
     .help = "Port of the server; by tls 587, 465 or 25.",
     .wanted = "expected 1 to 65535",
     .least = 1,
     .most = 65535},
    {"trust", text,
     "PEM file with the roots that the server's certificate must come from; without it "
     "those of the system."},
    {"user", text, "Name at the server; without it the mail is sent without a login."},
    {"password_file", text,
     "File with the password; alternative to password_env and password_credential."},
    {"password_env", text, "Environment variable with the password."},
    {"password_credential", text, "Credential of systemd with the password."},
};

constexpr Key webhook_keys[] = {
    {.name = "url",
     .holds = text,
     .help = "Address that new lines of the worklist are sent to: https://, or http:// on this "
             "machine.",
     .required = true,
     .wanted = "expected an address that begins with https://, or with http://127.0.0.1, found "
               "\"{}\"",
     .text = {.not_letters = " \t\r\n<>\"[]@", .longest = 500, .begins = "http"}},
    {.name = "secret_file",
     .holds = text,
     .help = "File with the secret that signs each message.",
     .required = true},
    {"trust", text,
     "PEM file with the roots that the server's certificate must come from; without it "
     "those of the system."},
};

constexpr Choice terminal_languages[] = {{"de"}, {"en"}, {"it"}};
constexpr Key site_file_keys[] = {
    format_key,
    {.name = "language",
     .holds = text,
     .help = "Language of the terminal and of summary.txt. JSON, --help and error messages are "
             "English.",
     .otherwise = "en",
     .choices = terminal_languages},
    {.name = "laboratory",
     .holds = table,
     .help = "The calibration laboratory.",
     .keys = laboratory_keys},
    {.name = "limits", .holds = table, .help = "Limits for one campaign.", .keys = limits_keys},
    {.name = "results",
     .holds = table,
     .help = "Layout of the output folder.",
     .keys = results_keys},
    run_key,
    options_key,
    {.name = "alias",
     .holds = tables,
     .help = "Two names of one machine, [[alias]]: its campaigns form one history.",
     .keys = alias_keys},
    {.name = "due",
     .holds = tables,
     .help = "When machines are measured again, [[due]].",
     .keys = due_keys},
    {.name = "signing",
     .holds = table,
     .help = "Key and time stamps for signed certificates.",
     .keys = signing_keys},
    {.name = "mail",
     .holds = table,
     .help = "Mail of the nightly run, sent only when action is required.",
     .keys = mail_keys},
    {.name = "webhook",
     .holds = table,
     .help = "Message to a program about new lines of the worklist.",
     .keys = webhook_keys},
    {.name = "certificate",
     .holds = table,
     .help = "Content and numbering of certificates.",
     .keys = certificate_of_site},
    {.name = "database",
     .holds = table,
     .help = "A PostgreSQL server for the history.",
     .keys = database_keys},
};

constexpr Key site_toml = {.name = "site.toml",
                           .holds = table,
                           .help = "Settings for all campaigns of a site.",
                           .keys = site_file_keys};

}  // namespace declared

const Key& site_file() { return declared::site_toml; }

}  // namespace nonio::config
