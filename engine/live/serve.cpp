// SPDX-License-Identifier: Apache-2.0
#include "live/server.h"
#include "platform/storage/late_library.h"

namespace nonio::live {

Expected<void> serve(const LiveWish& wish) {
  const auto server = storage::exported_as<Serve>("libnonio_live_server.so", "nonio_serve");
  return server ? (**server)(wish) : fail(server.error());
}

}  // namespace nonio::live
