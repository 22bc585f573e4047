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

/// A value of `[options.<plugin>]` as written.
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
  /// Plugins to run; nullopt selects all that apply, except those that run only on request.
  std::optional<std::vector<std::string>> analyses, outputs;
};

/// `[[tables.accept]]`: a finding in spite of which tables may be written, and the reason.
struct AcceptedFinding {
  std::string finding, reason;
  std::uint64_t line = 0;
};

struct Manifest {
  Campaign campaign;
  /// "periodic", "acceptance", "after-repair" or "check"; empty if not stated.
  std::string purpose{};
  /// Axes that are measured but not listed in [machine.axes]; empty if it lists no axis.
  std::vector<std::string> undeclared_axes{};
  std::vector<AcceptedFinding> accepted{};
  RunChoice run;
  RawOptions options;
  KeyLines lines;
  std::vector<Error> warnings{};  ///< about keys with former names
};

struct Limits {
  double seconds = 600.0;
  double memory_MB = 4096.0;
  /// Time after which a disk or network share without a response is reported as failed, s.
  double disk_seconds = 60.0;
  /// Number of campaigns of the previous run that may be missing before the run reports a failure.
  std::size_t missing_campaigns = 0;
};

struct Alias {
  std::string name, asset, why;
  std::uint64_t line_of_asset = 0;
};

struct DatabaseChoice {
  std::string url;
  std::string password_file{};
  std::string schema = "nonio";
  /// Schema of the register of certificate numbers; empty if the register is a file.
  std::string register_schema{};
};

/// `[[due]]`: months between campaigns. An empty `machine` means all machines without a rule.
struct DueRule {
  std::string machine;
  int months = 0;
};

/// A signer that `verify` accepts between two days, because keys are replaced.
struct SignerRule {
  std::string who;          ///< subject of the certificate, or its SHA-256
  std::string from, until;  ///< first and last day, YYYY-MM-DD; empty for no limit
};

/// `[signing]` of site.toml. Paths are relative to the site.
struct Signing {
  std::string pkcs12, pkcs11, module, certificates;
  std::string password_file, password_env, password_credential;
  /// `trust` is one root for signers and time servers; if it is empty, each has a file of its own.
  std::string trust, signer_roots, time_stamp_roots, revocation;
  std::string signer;  ///< the only accepted signer; if empty, those of `signers` are accepted
  std::vector<SignerRule> signers{};
  std::string time_stamp;           ///< address of the server; empty for no time stamps
  bool time_stamp_required = true;  ///< no certificate is issued without a time stamp
  int time_stamp_seconds = 10;
};

/// `[[certificate.accept]]`: a finding that does not prevent an automatic approval. Findings
/// plausibility.* always prevent it.
struct AcceptedRule {
  std::string finding;  ///< id of the finding, or "kind.*" for all ids that begin with "kind."
  std::string reason;
};

struct Numbering {
  /// If the pattern contains {year}, the sequence begins anew each year.
  std::string pattern = "{year}-{number:4}";
  std::string register_file = "certificates.sqlite";
  std::optional<DatabaseChoice> server{};
  double patience = 60.0;  ///< longest time to wait for a locked register, s
  /// Whether a run approves certificates that no finding prevents.
  bool automatic = false;
  std::vector<AcceptedRule> accepted{};
  bool two_persons = false;  ///< author and approver must be different persons
};

struct Mail {
  enum class On {
    lost,
    out,
    decision
  };  ///< lost: failed campaigns; out: also out of tolerance; decision: any required action
  enum class Tls { starttls, tls, none };
  std::vector<std::string> to;
  std::string from;
  On on = On::decision;
  std::string base_url;  ///< address of the output folder; if empty, links are relative
  /// Program that sends mail, or name of the mail server; exactly one is stated.
  std::string sendmail, smtp;
  Tls tls = Tls::starttls;
  int port = 0;
  std::string trust;  ///< PEM file relative to the site; if empty, the roots of the system are used
  std::string user;
  /// Exactly one source of the password is stated if `user` is stated.
  std::string password_file, password_env, password_credential;
};

struct Webhook {
  std::string url;  ///< https, or http on this machine
  std::string secret_file;
  std::string trust;  ///< PEM file with root certificates; if empty, those of the system are used
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
  std::vector<Alias> aliases{};  ///< each name occurs once, and never as an asset
  std::vector<DueRule> due{};
  std::optional<DatabaseChoice> database{};
  KeyLines lines;
  bool priors = true;           ///< whether `explain` uses SITE/fleet.toml
  std::string language = "en";  ///< language of the terminal and of summary.txt
  bool hashed_folders = false;  ///< results are in OUT/ab/<id> (ab from SHA-256), not in OUT/<id>
  std::string settings;         ///< TOML with the keys that certificates depend on
  std::string evaluation;       ///< TOML with the keys that results depend on
  std::vector<Error> warnings{};
};

template <class T>
using Checked = tl::expected<T, std::vector<Error>>;

/// Returns all errors of the file at once, each with its line.
Checked<Manifest> parse_manifest(std::string_view text, const std::string& file,
                                 const std::vector<Method>& methods);
/// For a process without plugins: accepts any kind, and does not read keys of methods.
Checked<Manifest> parse_without_methods(std::string_view text, const std::string& file);
Checked<SiteFile> parse_site(std::string_view text, const std::string& file);

/// Returns the id in a manifest that may have errors elsewhere; empty if it cannot be read.
std::string extract_id(std::string_view text);
bool is_campaign_id(std::string_view id);

/// Returns the options of one plugin: defaults, then the site's options, then the campaign's.
/// `others`: options of plugins of another kind with the same name, which share the table.
Checked<Settings> settle_options(const Info& plugin, const RawOptions& site,
                                 const RawOptions& campaign,
                                 const std::vector<Option>& others = {});

/// A key of a nested table is named `table.key` in the settings.
Expected<Settings> parse_settings(std::string_view text, const std::string& file);

/// Missing options get defaults. In an option that is a list or contains tables (`axes`), commas
/// separate the entries.
Checked<Settings> options_from(const Info& plugin, const std::map<std::string, std::string>& texts);

/// A key has the value of the campaign, otherwise that of the site, otherwise the default.
CertificateTexts certificate_of(const CertificateTexts& site, const CertificateTexts& campaign);

}  // namespace nonio::config
