// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "campaign/reading/campaign_reader.h"
#include "certificates/register_check.h"
#include "nonio/sign/verify.h"

namespace nonio::certificates {

/// Reads neither the site.toml of `site` nor the current folder.
Expected<std::unique_ptr<reading::Workplace>> open_to_verify(
    const std::vector<std::filesystem::path>& plugin_folders,
    std::vector<std::filesystem::path> template_folders, const std::filesystem::path& site,
    const std::string& version);

/// Returns an error unless the path is a regular file of at most `sign::max_bytes`.
Expected<std::string> read_bounded(const std::filesystem::path& path);

/// Loads plugins and templates at the first call; files without a valid signature need none.
using OpenContext = std::function<Expected<const reading::Context*>()>;

/// Verifies a certificate (PDF) or a DCC (XML): first the signature and, if it is valid, the
/// content, for which the plugins of `open` evaluate the attached readings again. `rows` state
/// whether a number is in force, and whose key signed it. Any content of the file yields a result;
/// errors come from `open`, or from a register that is required and could not be read.
Expected<sign::Verified> verify_file(const std::filesystem::path& path,
                                     const sign::Verifier& verifier, const OpenContext& open,
                                     const RegisterRows& rows);

/// Overall result; each value has an exit status of `nonio certificate verify`.
enum class Verdict {
  valid,           ///< every check was made and passed
  incomplete,      ///< every check that was made passed; some could not be made (`not_made`)
  untrusted,       ///< intact, but the signer is not trusted or not expected
  not_in_force,    ///< intact and trusted, but not in force, or the site has no register
  other_words,     ///< intact, trusted and in force, but with other words or layout
  altered,         ///< changed after signing, or damaged
  no_certificate,  ///< no signature, or not a certificate of Nonio
  no_file          ///< the file does not exist, is too large, or cannot be read
};
Verdict verdict_of(const sign::Verified& verified);
/// Returns the verdict as a word for programs, for example "valid" or "no-certificate".
std::string id_of(Verdict verdict);
/// Returns the verdict as a text for people, for example "VALID" or "NOT A CERTIFICATE".
std::string text_of(Verdict verdict);
/// Returns the ids of the checks that could not be made. A missing DCC is not listed.
std::vector<std::string> not_made(const sign::Verified& verified);

}  // namespace nonio::certificates
