// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "nonio/sdk/campaign.h"
#include "nonio/sdk/results.h"

namespace nonio::evaluation {

/// An accredited laboratory's smallest uncertainty, `[laboratory.cmc]`: no result of the evaluation
/// keeps a smaller U. length: that it was measured over, m. Nothing happens without accreditation.
/// Source: the policy of ILAC-P14 that U on a certificate is not below the CMC; its text was not at
/// hand.
void apply_cmc(const Laboratory&, double length, Evaluation&);

}  // namespace nonio::evaluation
