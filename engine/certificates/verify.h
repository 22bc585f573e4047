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

/// Loads plugins and templates, including the templates of `site` if that is not empty. Neither its
/// site.toml nor the current folder is read.
Expected<std::unique_ptr<reading::Workplace>> open_to_verify(
    const std::vector<std::filesystem::path>& plugin_folders,
    std::vector<std::filesystem::path> template_folders, const std::filesystem::path& site,
    const std::string& version);

/// Reads a file that may be a certificate; an error if it is not a regular file. A file that is too
/// large is refused by its size, or when more bytes than allowed are read, without reading all of
/// it.
Expected<std::string> read_bounded(const std::filesystem::path& path);

/// Loads plugins and templates at the first call, because a file without a valid signature needs
/// none.
using OpenContext = std::function<Expected<const reading::Context*>()>;

/// Verifies a certificate (PDF) or a DCC (XML): first its signature, then, if that is valid, its
/// content. Every attached DCC is checked, and the attached readings are evaluated again by the
/// plugins of `open`, up to the printed pages. `rows` of the register state whether a number is in
/// force, and whose key signed it. Any content of the file yields a result; an error comes from
/// `open`, or from a register that is required and could not be read.
Expected<sign::Verified> verify_file(const std::filesystem::path& path,
                                     const sign::Verifier& verifier, const OpenContext& open,
                                     const RegisterRows& rows);

/// Overall result of all checks of a file; each has an exit status of `nonio certificate verify`.
enum class Verdict {
  valid,         ///< every check was made and passed
  incomplete,    ///< every check that was made passed; some could not be made (`not_made`)
  untrusted,     ///< intact, but the signer is not trusted or not expected
  not_in_force,  ///< intact and trusted, but not in force according to the register of the site, or
                 ///< the site has no register
  other_words,   ///< intact, trusted and in force, but with other words or another layout than the
                 ///< installed ones
  altered,       ///< changed after signing, or damaged
  no_certificate,  ///< no signature, or not a certificate of Nonio
  no_file          ///< the file does not exist, or cannot be read
};
Verdict verdict_of(const sign::Verified& verified);
/// Returns the verdict as a word for programs, for example "valid" or "no-certificate".
std::string id_of(Verdict verdict);
/// Returns the verdict as a text for people, for example "VALID" or "NOT A CERTIFICATE".
std::string text_of(Verdict verdict);
/// Returns the ids of the checks that could not be made, except that of the DCC, because a
/// certificate need not have one.
std::vector<std::string> not_made(const sign::Verified& verified);

}  // namespace nonio::certificates
