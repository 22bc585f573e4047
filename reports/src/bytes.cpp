// SPDX-License-Identifier: Apache-2.0
#include "bytes.h"

#include <zlib.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <memory>

namespace nonio::reports {

std::string deflated(std::string_view bytes, int level) {
  uLongf size = compressBound(static_cast<uLong>(bytes.size()));
  const auto buffer = std::make_unique_for_overwrite<Bytef[]>(size);
  const int status = compress2(buffer.get(), &size, reinterpret_cast<const Bytef*>(bytes.data()),
                               static_cast<uLong>(bytes.size()), level);
  return status == Z_OK ? std::string(reinterpret_cast<const char*>(buffer.get()), size) : "";
}

void append_int(std::string& out, long long value) {
  char buffer[24];
  out.append(buffer, std::to_chars(buffer, buffer + sizeof buffer, value).ptr);
}

void append_real(std::string& out, double value) {
  if (!(std::fabs(value) < 30000.0))
    value = std::copysign(30000.0, std::isnan(value) ? 0.0 : value);
  long long hundredths = std::llround(value * 100.0);
  if (hundredths < 0) {
    out += '-';
    hundredths = -hundredths;
  }
  append_int(out, hundredths / 100);
  const auto rest = static_cast<int>(hundredths % 100);
  if (rest == 0) return;
  out += '.';
  out += static_cast<char>('0' + rest / 10);
  if (rest % 10 != 0) out += static_cast<char>('0' + rest % 10);
}

}  // namespace nonio::reports
