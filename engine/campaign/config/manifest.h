// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "nonio/sdk/campaign.h"
#include "nonio/sdk/error.h"
#include "nonio/sdk/plugin.h"
#include "nonio/sdk/settings.h"

namespace nonio::config {

inline constexpr const char* manifest_name = "campaign.toml";
inline constexpr const char* site_name = "site.toml";
inline constexpr const char* templates_folder = "templates";
inline constexpr const char* causes_folder = "causes";

/// Stands for the SHA-256 of a file that cannot be read.
inline constexpr const char* absent = "absent";

/// `[options.<plugin>]` as written, with the line of each key.
struct RawOption {
  Setting value;
  std::string file;
  std::uint64_t line = 0;
};
/// Tables in their former form as texts: "X number=1 step_mm=50".
Expected<NumberTables> number_tables_of(const std::vector<std::string>& entries);

using RawOptions = std::map<std::string, std::map<std::string, RawOption>>;

/// Line of each key of a file: "campaign.customer", "measurement.X.file" for the measurement with
/// id X.
using KeyLines = std::map<std::string, std::uint64_t, std::less<>>;

struct RunChoice {
  std::optional<std::vector<std::string>> analyses, outputs;  ///< absent: all that apply
};

/// `[[tables.accept]]`: a finding that makes readings implausible, and why a table may be
/// written from them all the same.
struct AcceptedFinding {
  std::string finding, reason;
  std::uint64_t line = 0;
};

struct Manifest {
  Campaign campaign;
  std::string purpose{};  ///< periodic, acceptance, after-repair, check; empty: not stated
  std::vector<std::string> undeclared_axes{};  ///< measured, and not among [machine.axes]
  std::vector<AcceptedFinding> accepted{};
  RunChoice run;
  RawOptions options;
  KeyLines lines;
  std::vector<Error> warnings{};  ///< keys with former names
};

struct Limits {
  double seconds = 600.0;
  double memory_MB = 4096.0;
  double disk_seconds = 60.0;         ///< without a sign of life, in the survey
  std::size_t missing_campaigns = 0;  ///< of the previous run that may be missing
};

/// `[[alias]]` of site.toml: two names of one machine.
struct Alias {
  std::string name, asset, why;
  std::uint64_t line_of_asset = 0;
};

/// `[database]` of site.toml. The path is relative to the site.
struct DatabaseChoice {
  std::string url;  ///< without a password
  std::string password_file{};
  std::string schema = "nonio";
  std::string register_schema{};  ///< empty: the register of certificate numbers is a file
};

/// `[[due]]` of site.toml: months from the last campaign to the next. machine empty: all that no
/// other rule names.
struct DueRule {
  std::string machine;
  int months = 0;
};

/// One whom `verify` expects, and from which day to which: keys are replaced.
struct SignerRule {
  std::string who;          ///< subject of the certificate, or its SHA-256
  std::string from, until;  ///< YYYY-MM-DD, both included; may be empty
};

/// `[signing]` of site.toml: where the key is, where its password comes from, time stamps, and whom
/// `verify` expects and trusts. Paths are relative to the site.
struct Signing {
  std::string pkcs12, pkcs11, module, certificates;
  std::string password_file, password_env, password_credential;  ///< exactly one
  /// `trust`: one root for signers and for time servers; else each has its own file.
  std::string trust, signer_roots, time_stamp_roots, revocation;
  std::string signer;  ///< the only one, at any time; else `signers`
  std::vector<SignerRule> signers{};
  std::string time_stamp;           ///< address of the server; empty: none
  bool time_stamp_required = true;  ///< no answer: no certificate
  int time_stamp_seconds = 10;
};

/// Of `[certificate]`: a finding that does not hold up an automatic release.
struct AcceptedRule {
  std::string finding;  ///< its id, or "kind.*": all whose id begins with "kind."
  std::string reason;
};

/// `[certificate]` of site.toml: how its certificates are released and numbered.
struct Numbering {
  std::string pattern = "{year}-{number:4}";          ///< the sequence begins anew with each year
  std::string register_file = "certificates.sqlite";  ///< relative to the site
  std::optional<DatabaseChoice> server{};  ///< in place of the file; its schema is the register's
  double patience = 60.0;                  ///< s, with a register that another process keeps locked
  bool automatic = false;                  ///< a run may release what no finding prevents
  std::vector<AcceptedRule> accepted{};
  bool two_persons = false;  ///< author and authoriser must not be the same
};

/// `[mail]` of site.toml: to whom a run writes, how, and from which severity on.
struct Mail {
  enum class On {
    lost,
    out,
    decision
  };  ///< what is lost or failed; or out; or every action required
  enum class Tls { starttls, tls, none };
  std::vector<std::string> to;
  std::string from;
  On on = On::decision;
  std::string base_url;        ///< of the output folder, for links; empty: they are relative
  std::string sendmail, smtp;  ///< exactly one: a program, the name of a server
  Tls tls = Tls::starttls;
  int port = 0;       ///< never 0 when read
  std::string trust;  ///< PEM file with roots, relative to the site; empty: those of the system
  std::string user;
  std::string password_file, password_env, password_credential;  ///< exactly one with `user`
};

/// `[webhook]` of site.toml: which program gets new lines of the worklist.
struct Webhook {
  std::string url;          ///< https, or http on this machine
  std::string secret_file;  ///< what signs them
  std::string trust;        ///< as of the mail
};

struct SiteFile {
  std::optional<Signing> signing;
  std::optional<Mail> mail{};
  std::optional<Webhook> webhook{};
  CertificateTexts certificate;
  Numbering numbering;
  Laboratory laboratory;
  RunChoice run;
  RawOptions options;
  Limits limits;
  std::vector<Alias> aliases{};  ///< each name once; no asset is a name
  std::vector<DueRule> due{};    ///< one for each machine at most
  std::optional<DatabaseChoice> database{};
  KeyLines lines;
  std::string language = "en";    ///< of the terminal and of summary.txt
  bool hashed_folders = false;    ///< results in OUT/ab/<id>
  std::string settings;           ///< TOML: the part of the file that certificates depend on
  std::string evaluation;         ///< TOML: the part of it that results depend on
  std::vector<Error> warnings{};  ///< keys with former names
};

template <class T>
using Checked = tl::expected<T, std::vector<Error>>;

/// All that is wrong with the file at once, each with its line.
Checked<Manifest> parse_manifest(std::string_view text, const std::string& file,
                                 const std::vector<Method>& methods);
/// For a process that has no plugins: any kind is accepted, keys of methods are not read, and the
/// members of Measurement that they fill are empty.
Checked<Manifest> parse_without_methods(std::string_view text, const std::string& file);
Checked<SiteFile> parse_site(std::string_view text, const std::string& file);

/// The id of a manifest that may be broken elsewhere; empty if none can be seen.
std::string extract_id(std::string_view text);
bool is_campaign_id(std::string_view id);

/// The options of one plugin: defaults, then the site's, then the campaign's; each checked for
/// name, kind, range and choice. `others`: of plugins of another kind with the same name, which
/// share its table.
Checked<Settings> settle_options(const Info& plugin, const RawOptions& site,
                                 const RawOptions& campaign,
                                 const std::vector<Option>& others = {});

/// A TOML file of templates/ as flat settings.
Expected<Settings> parse_settings(std::string_view text, const std::string& file);

/// The options of a plugin from the texts of a command line, "axes" with commas between entries;
/// the others have their defaults.
Checked<Settings> options_from(const Info& plugin, const std::map<std::string, std::string>& texts);

}  // namespace nonio::config
