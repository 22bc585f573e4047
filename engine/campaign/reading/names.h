// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "campaign/reading/context.h"

namespace nonio::reading {

/// Name of the host's own analysis (model_fit.h).
inline constexpr const char* model_fit_name = "model-fit";

/// Returns an error for each `[options.x]` where x is not a plugin; otherwise it would be ignored
/// without a message.
std::vector<Error> ownerless_options(const config::RawOptions& options,
                                     const loader::Plugins& plugins);

/// Returns the mistakes in names and options of site.toml, which would be wrong in every campaign.
std::vector<Error> site_mistakes(const Context& context);

/// Sets file and line of an error that names a key: an option of `plugin`, or a key of the
/// manifest, or of site.toml if the manifest does not contain it.
void locate(Error& error, const config::KeyLines& manifest, const config::KeyLines& site,
            const std::string& plugin = {});

/// Sets the line of an error that has a file and no line. In the manifest it is that of the nearest
/// existing key above the faulty one (machine.axes.X for machine.axes.X.slave), otherwise of the
/// first existing key in `others`; otherwise, and in other files, it is line 1.
void give_line(Error& error, const config::KeyLines& manifest,
               const std::vector<std::string>& others);

}  // namespace nonio::reading
