// SPDX-License-Identifier: Apache-2.0
#include "host/live/server.h"
#include "host/storage/late_library.h"

namespace nonio::host::live {

Expected<void> serve(const LiveWish& wish) {
  const auto server = storage::exported_as<Serve>("libnonio_live_server.so", "nonio_serve");
  return server ? (**server)(wish) : fail(server.error());
}

}  // namespace nonio::host::live
