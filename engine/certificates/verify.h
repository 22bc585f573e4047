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

/// Plugins and templates, with those of `site` if it is not empty. Neither its site.toml nor the
/// current folder is read.
Expected<std::unique_ptr<reading::Workplace>> open_to_verify(
    const std::vector<std::filesystem::path>& plugin_folders,
    std::vector<std::filesystem::path> template_folders, const std::filesystem::path& site,
    const std::string& version);

/// A file that may be a certificate. Refused by its size where the system reports it, else when
/// more bytes are read than allowed; never read whole.
Expected<std::string> read_bounded(const std::filesystem::path& path);

/// Opens plugins and templates at the first call: a file whose signature does not hold needs none.
using OpenContext = std::function<Expected<const reading::Context*>()>;

/// A certificate (PDF) or a DCC (XML): its signature first, then, where that holds, its content:
/// every attached DCC, and the attached readings evaluated again by the plugins that `open` gives,
/// up to the printed pages. `rows` of the register state whether a number is in force, and whose
/// key signed it. Whatever the file holds, there is an answer; an error is one of `open`, or the
/// register is needed and could not be read.
Expected<sign::Verified> verify_file(const std::filesystem::path& path,
                                     const sign::Verifier& verifier, const OpenContext& open,
                                     const RegisterRows& rows);

/// What all checks of a file amount to; each has an exit status of `nonio certificate verify`.
enum class Verdict {
  valid,         ///< every check was made and passed
  incomplete,    ///< every check that was made passed; some could not be made (`not_made`)
  untrusted,     ///< intact, but the signer is not one whom the user trusts and expects
  not_in_force,  ///< intact and trusted, but the register of the site does not list it as in force
  other_words,   ///< intact, trusted, in force, but its words or layout are not the installed ones
  altered,       ///< changed after signing, or damaged
  no_certificate,  ///< has no signature, or is not a certificate of Nonio
  no_file          ///< does not exist, or cannot be read
};
Verdict verdict_of(const sign::Verified& verified);
/// "valid", "no-certificate": for programs.
std::string id_of(Verdict verdict);
/// "VALID", "NOT A CERTIFICATE": what people read, on the terminal as on the page.
std::string text_of(Verdict verdict);
/// The checks that could not be made and do not change the verdict to a negative one.
std::vector<std::string> not_made(const sign::Verified& verified);

}  // namespace nonio::certificates
