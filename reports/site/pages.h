// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "html.h"

namespace nonio::reports::site {

Expected<std::string> index_page(const Page&);
Expected<std::string> machine_page(const Page&, const MachineHistory&);
Expected<std::string> due_page(const Page&);
/// iCalendar file (RFC 5545) with the due calibrations.
std::string due_calendar(const Page&);
Expected<std::string> instruments_page(const Page&);
Expected<std::string> compare_page(const Page&);

}  // namespace nonio::reports::site
