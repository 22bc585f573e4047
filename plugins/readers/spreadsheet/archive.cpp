// SPDX-License-Identifier: Apache-2.0
#include "archive.h"

#include <Poco/Exception.h>
#include <Poco/MemoryStream.h>
#include <Poco/Zip/ZipArchive.h>
#include <Poco/Zip/ZipStream.h>

namespace nonio::spreadsheet {

Expected<std::optional<std::string>> member(std::string_view archive, const std::string& name) {
  try {
    Poco::MemoryInputStream all(archive.data(), static_cast<std::streamsize>(archive.size()));
    const Poco::Zip::ZipArchive zip(all);
    std::size_t members = 0;
    for (auto it = zip.headerBegin(); it != zip.headerEnd(); ++it)
      if (++members > most_members) return fail("expected up to 10,000 files in the spreadsheet");
    const auto found = zip.findHeader(name);
    if (found == zip.headerEnd()) return std::nullopt;
    if (found->second.isEncrypted())
      return fail("the spreadsheet is encrypted; save it without a password");
    Poco::MemoryInputStream again(archive.data(), static_cast<std::streamsize>(archive.size()));
    Poco::Zip::ZipInputStream in(again, found->second);
    std::string out;
    char buffer[65536];
    while (in.read(buffer, sizeof buffer) || in.gcount() > 0) {
      out.append(buffer, static_cast<std::size_t>(in.gcount()));
      if (out.size() > most_bytes) return fail(name + " unpacks to more than 256 MB");
    }
    if (!in.crcValid()) return fail(name + " is damaged: its check sum is another one");
    return out;
  } catch (const Poco::Exception& e) {
    return fail("the file is no spreadsheet that can be opened (" + e.displayText() + ")");
  } catch (const std::exception& e) {
    return fail("the file is no spreadsheet that can be opened (" + std::string(e.what()) + ")");
  }
}

}  // namespace nonio::spreadsheet
