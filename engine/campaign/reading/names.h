// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "campaign/reading/context.h"

namespace nonio::reading {

/// The analysis of the host itself, see model_fit.h.
inline constexpr const char* model_fit_name = "model-fit";

/// `[options.x]` for an x that no plugin is, which would otherwise be ignored in silence.
std::vector<Error> ownerless_options(const config::RawOptions& options,
                                     const loader::Plugins& plugins);

/// What is wrong with the names and options of site.toml: it would be wrong in every campaign.
std::vector<Error> site_mistakes(const Context& context);

/// Fills in file and line of an error that names the faulty key: an option of `plugin` or a key of
/// the manifest or, where they do not have it, of site.toml.
void locate(Error& error, const config::KeyLines& manifest, const config::KeyLines& site,
            const std::string& plugin = {});

/// Gives an error of a file its line: of the manifest that of the nearest key above the one that is
/// to blame (machine.axes.X for machine.axes.X.slave) or of the first of `others` that exists, else
/// the first line, from which a file as a whole is wrong.
void give_line(Error& error, const config::KeyLines& manifest,
               const std::vector<std::string>& others);

}  // namespace nonio::reading
