// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "case.h"

/// Thermal tests, spindles and lengths, of lists of numbers (tests/cases/heat.cpp).
bool is_heat(const Case&);
Outcome evaluate_heat(const Case&);
