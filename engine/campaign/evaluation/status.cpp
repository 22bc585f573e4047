// SPDX-License-Identifier: Apache-2.0
#include "campaign/evaluation/status.h"

namespace nonio::evaluation {

const char* to_text(Status status) {
  switch (status) {
    case Status::none:
      break;
    case Status::ok:
      return "ok";
    case Status::attention:
      return "attention";
    case Status::failed:
      return "failed";
  }
  return "";
}

std::optional<Status> status_named(std::string_view word) {
  for (const Status status : {Status::ok, Status::attention, Status::failed})
    if (word == to_text(status)) return status;
  return std::nullopt;
}

}  // namespace nonio::evaluation
