// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "html.h"

namespace nonio::reports::site {

std::string index_page(const Page&);
std::string machine_page(const Page&, const MachineHistory&);
std::string due_page(const Page&);
/// iCalendar (RFC 5545): a day for each calibration that is due.
std::string due_calendar(const Page&);
std::string instruments_page(const Page&);
std::string compare_page(const Page&);

}  // namespace nonio::reports::site
