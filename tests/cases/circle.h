// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "case.h"

/// Of a path that the numbers of the case describe (tests/cases/circle.cpp).
Outcome evaluate_circle(const Case&);
