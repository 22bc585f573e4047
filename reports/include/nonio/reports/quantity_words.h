// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "nonio/reports/wording.h"

namespace nonio::reports {

/// Name of a quantity that is followed over the campaigns: "Scale", "Straightness Z, bow"; its
/// symbol where it has no words. `site`: the words of site.toml.
std::string followed_quantity(const Wording& site, const std::string& quantity);

/// Whether a quantity that is followed is the logarithm of a scatter ("ln_s",
/// "straightness:Z.ln_s"; s in um or arcsec). People read the scatter, and its changes as factors.
bool is_log_of_scatter(const std::string& quantity);

/// "crash: tool hit the vice", as a change of a series has it, with the kind in words.
std::string event_text(const Wording& site, const std::string& event);

}  // namespace nonio::reports
