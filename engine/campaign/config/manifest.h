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

/// Used in place of the SHA-256 of a file that cannot be read.
inline constexpr const char* absent = "absent";

/// A value of `[options.<plugin>]` as written, with its file and line.
struct RawOption {
  Setting value;
  std::string file;
  std::uint64_t line = 0;
};
/// Parses tables in their former form as texts: "X number=1 step_mm=50".
Expected<NumberTables> number_tables_of(const std::vector<std::string>& entries);

using RawOptions = std::map<std::string, std::map<std::string, RawOption>>;

/// Line of each key of a file: "campaign.customer", "measurement.X.file" for the measurement with
/// id X.
using KeyLines = std::map<std::string, std::uint64_t, std::less<>>;

struct RunChoice {
  /// Names of the plugins to run; none: all that apply, except those that run only on request.
  std::optional<std::vector<std::string>> analyses, outputs;
};

/// `[[tables.accept]]`: a finding that would prevent tables, and the reason why a table may be
/// written in spite of it.
struct AcceptedFinding {
  std::string finding, reason;
  std::uint64_t line = 0;
};

struct Manifest {
  Campaign campaign;
  /// Reason for the campaign: periodic, acceptance, after-repair, check; empty: not stated.
  std::string purpose{};
  /// Axes that are measured but not listed in [machine.axes]; empty if it lists no axis.
  std::vector<std::string> undeclared_axes{};
  std::vector<AcceptedFinding> accepted{};
  RunChoice run;
  RawOptions options;
  KeyLines lines;
  std::vector<Error> warnings{};  ///< warnings about keys with former names
};

struct Limits {
  double seconds = 600.0;
  double memory_MB = 4096.0;
  /// Time without a response after which a disk or network share is reported as failed, s.
  double disk_seconds = 60.0;
  /// Number of campaigns of the previous run that may be missing before the run reports a failure.
  std::size_t missing_campaigns = 0;
};

/// `[[alias]]` of site.toml: another name of a machine, and its asset.
struct Alias {
  std::string name, asset, why;
  std::uint64_t line_of_asset = 0;
};

/// `[database]` of site.toml. The path is relative to the site.
struct DatabaseChoice {
  std::string url;  ///< address of the database, without a password
  std::string password_file{};
  std::string schema = "nonio";
  /// Schema of the register of certificate numbers; empty: the register is a file.
  std::string register_schema{};
};

/// `[[due]]` of site.toml: months from the last campaign to the next. If `machine` is empty, the
/// rule applies to all machines without a rule of their own.
struct DueRule {
  std::string machine;
  int months = 0;
};

/// A signer that `verify` accepts, and the days between which it signs, because keys are replaced.
struct SignerRule {
  std::string who;          ///< subject of the certificate, or its SHA-256
  std::string from, until;  ///< first and last day, YYYY-MM-DD; empty: no limit
};

/// `[signing]` of site.toml: the key, the source of its password, the time-stamp server, and the
/// signers and roots that `verify` accepts. Paths are relative to the site.
struct Signing {
  std::string pkcs12, pkcs11, module, certificates;
  /// Source of the password; exactly one is stated.
  std::string password_file, password_env, password_credential;
  /// `trust` is one root for signers and time servers; if it is empty, each has a file of its own.
  std::string trust, signer_roots, time_stamp_roots, revocation;
  std::string signer;  ///< the only accepted signer; empty: those of `signers` are accepted
  std::vector<SignerRule> signers{};
  std::string time_stamp;           ///< address of the time-stamp server; empty: no time stamps
  bool time_stamp_required = true;  ///< no certificate is issued if the server does not answer
  int time_stamp_seconds = 10;
};

/// `[[certificate.accept]]`: a finding that does not prevent an automatic approval. Findings
/// plausibility.* always prevent it.
struct AcceptedRule {
  std::string finding;  ///< id of the finding, or "kind.*" for all ids that begin with "kind."
  std::string reason;
};

/// `[certificate]` of site.toml: how certificates are approved and numbered.
struct Numbering {
  /// Pattern of the numbers. If it contains {year}, the sequence begins anew each year.
  std::string pattern = "{year}-{number:4}";
  /// File of the register, relative to the site.
  std::string register_file = "certificates.sqlite";
  /// Database of the register in place of the file; its schema is that of the register.
  std::optional<DatabaseChoice> server{};
  double patience = 60.0;  ///< longest time to wait for another process that locks the register, s
  /// Whether a run approves certificates that no finding prevents.
  bool automatic = false;
  std::vector<AcceptedRule> accepted{};
  bool two_persons = false;  ///< author and approver must be different persons
};

/// `[mail]` of site.toml: to whom and how a run sends mail, and for which lines of the worklist.
struct Mail {
  enum class On {
    lost,
    out,
    decision
  };  ///< lost: lost or failed campaigns; out: also out of tolerance; decision: any required action
  enum class Tls { starttls, tls, none };
  std::vector<std::string> to;
  std::string from;
  On on = On::decision;
  std::string base_url;  ///< address of the output folder, for links; empty: links are relative
  /// Program that sends mail, or name of the mail server; exactly one is stated.
  std::string sendmail, smtp;
  Tls tls = Tls::starttls;
  int port = 0;  ///< port of the server; without the key, the reader sets the usual one of `tls`
  std::string trust;  ///< PEM file with roots, relative to the site; empty: those of the system
  std::string user;
  /// Source of the password; exactly one is stated if `user` is stated.
  std::string password_file, password_env, password_credential;
};

/// `[webhook]` of site.toml: the address that receives new lines of the worklist.
struct Webhook {
  std::string url;          ///< address: https, or http on this machine
  std::string secret_file;  ///< file with the key of the HMAC that signs the lines
  std::string trust;        ///< PEM file with root certificates; empty: those of the system
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
  std::vector<Alias> aliases{};  ///< other names of machines; each occurs once, never as an asset
  std::vector<DueRule> due{};  ///< rules for the time to the next campaign; at most one per machine
  std::optional<DatabaseChoice> database{};
  KeyLines lines;
  std::string language = "en";    ///< language of the terminal and of summary.txt
  bool hashed_folders = false;    ///< results are in OUT/ab/<id> (ab from SHA-256), not in OUT/<id>
  std::string settings;           ///< TOML: the part of the file that certificates depend on
  std::string evaluation;         ///< TOML: the part of the file that results depend on
  std::vector<Error> warnings{};  ///< warnings about keys with former names
};

template <class T>
using Checked = tl::expected<T, std::vector<Error>>;

/// Parses a manifest. Returns all errors of the file at once, each with its line.
Checked<Manifest> parse_manifest(std::string_view text, const std::string& file,
                                 const std::vector<Method>& methods);
/// Parses a manifest in a process without plugins: any kind is accepted, keys of methods are not
/// read, and the members of Measurement that they fill stay empty.
Checked<Manifest> parse_without_methods(std::string_view text, const std::string& file);
Checked<SiteFile> parse_site(std::string_view text, const std::string& file);

/// Returns the id in a manifest that may have errors elsewhere; empty if it cannot be read.
std::string extract_id(std::string_view text);
bool is_campaign_id(std::string_view id);

/// Returns the options of one plugin: defaults, overridden by the site's, then by the campaign's.
/// Each is checked for name, kind, range and choice. `others` contains the options of plugins of
/// another kind with the same name, which share the table.
Checked<Settings> settle_options(const Info& plugin, const RawOptions& site,
                                 const RawOptions& campaign,
                                 const std::vector<Option>& others = {});

/// Parses a TOML file of templates/ into settings. A key of a nested table has the name
/// `table.key`.
Expected<Settings> parse_settings(std::string_view text, const std::string& file);

/// Returns the options of a plugin from the texts of a command line, with defaults for those that
/// are missing. In an option that is a list or contains tables (`axes`), commas separate the
/// entries.
Checked<Settings> options_from(const Info& plugin, const std::map<std::string, std::string>& texts);

}  // namespace nonio::config
