// SPDX-License-Identifier: Apache-2.0
#include "certificates/restamp.h"

#include "campaign/config/site_files.h"
#include "campaign/evaluation/record.h"
#include "platform/storage/files.h"

namespace nonio::certificates {
namespace fs = std::filesystem;

namespace {

tl::unexpected<std::vector<Error>> as_errors(const Error& error) {
  return tl::unexpected(std::vector<Error>{error});
}

}  // namespace

config::Checked<sign::Prolonging> prolonging_of(const RestampOptions& options) {
  auto verifier = verifier_of(options.whom);
  if (!verifier) return tl::unexpected(verifier.error());
  sign::Prolonging how;
  how.verifier = std::move(*verifier);
  how.fetch = options.fetch;
  how.stamping.url = options.time_stamp;
  if (!options.whom.site.empty()) {
    std::string digest;
    const auto site = config::read_site(options.whom.site, digest);
    if (!site) return tl::unexpected(site.error());
    if (const auto& s = site->signing) {
      if (how.stamping.url.empty()) how.stamping.url = s->time_stamp;
      how.stamping.seconds = how.seconds = s->time_stamp_seconds;
    }
  }
  if (!options.with_time_stamp) how.stamping.url.clear();
  if (options.with_time_stamp && how.stamping.url.empty())
    return as_errors(Error{
        "no time-stamp server: expected --time-stamp URL, time_stamp in [signing] of site.toml "
        "(--site), or --no-time-stamp for the revocation data alone"});
  how.stamping.trust = how.verifier.time_stamp_roots;
  for (const fs::path& path : options.answers) {
    auto answer = storage::read_file(path);
    if (!answer) return as_errors(answer.error());
    how.answers.push_back(std::move(*answer));
  }
  return how;
}

Expected<Restamped> restamp(const fs::path& file, const sign::Prolonging& with,
                            const RegisterRows& rows, const fs::path& out) {
  const fs::path folder = !out.empty()             ? out
                          : file.has_parent_path() ? file.parent_path()
                                                   : fs::path(".");
  std::error_code error;
  if (fs::exists(folder / evaluation::record_name, error))
    return fail(
        "is in the output of a run, which writes it again as it was issued: expected "
        "another folder (--out), found " +
        (folder / evaluation::record_name).string());
  NONIO_TRY(const auto bytes, read_bounded(file));
  if (bytes.starts_with("<?xml"))
    return fail(
        "is a separate DCC: long-term validation of XAdES (B-LT, B-LTA) is not supported; extend "
        "the PDF that carries the DCC");
  sign::Prolonging how = with;
  how.verifier.issued_by = issued_by(rows, bytes);
  auto done = sign::prolong(bytes, how);
  if (!done && how.verifier.issued_by.empty() && !rows.no_answer.empty())
    return fail(done.error().message +
                " (the register, which may know an earlier signer, cannot be read: " +
                rows.no_answer + ")");
  if (!done) return fail(done.error());
  const std::string name = file.filename().string();
  if (auto written = storage::publish(folder, {{name, std::move(done->bytes)}}); !written)
    return fail(written.error());
  return Restamped{folder / name, std::move(done->added)};
}

}  // namespace nonio::certificates
