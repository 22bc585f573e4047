// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "case.h"

/// Periodic error and small steps, of lists of numbers (tests/cases/fine_motion.cpp).
bool is_fine_motion(const Case&);
Outcome evaluate_fine_motion(const Case&);
