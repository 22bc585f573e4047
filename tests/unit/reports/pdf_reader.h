// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <zlib.h>

#include <map>
#include <string>
#include <vector>

/// As much of a PDF reader as the tests need: the pages' texts, through the fonts' ToUnicode.
namespace nonio::fixtures {

inline std::string inflated(const std::string& bytes) {
  static std::vector<char> space(4 << 20);  // made once: to fill it takes longer than to inflate
  uLongf size = space.size();
  if (uncompress(reinterpret_cast<Bytef*>(space.data()), &size,
                 reinterpret_cast<const Bytef*>(bytes.data()), bytes.size()) != Z_OK)
    return {};
  return {space.data(), size};
}

inline std::vector<std::string> streams(const std::string& pdf) {
  std::vector<std::string> out;
  for (std::size_t at = 0; (at = pdf.find("stream\r\n", at)) != std::string::npos;) {
    at += 8;
    const std::size_t end = pdf.find("\nendstream", at);
    out.push_back(inflated(pdf.substr(at, end - at)));
    at = end;
  }
  return out;
}

using ToUnicode = std::map<unsigned, std::string>;

inline ToUnicode to_unicode(const std::string& cmap) {
  ToUnicode out;
  for (std::size_t at = 0; (at = cmap.find("\n<", at)) != std::string::npos; ++at) {
    if (at + 15 > cmap.size() || cmap.compare(at + 6, 3, "> <") != 0) continue;
    const unsigned glyph = static_cast<unsigned>(std::stoul(cmap.substr(at + 2, 4), nullptr, 16));
    const unsigned c = static_cast<unsigned>(std::stoul(cmap.substr(at + 9, 4), nullptr, 16));
    std::string text;
    if (c < 0x80) {
      text += static_cast<char>(c);
    } else if (c < 0x800) {
      text += static_cast<char>(0xC0 | c >> 6);
      text += static_cast<char>(0x80 | (c & 0x3F));
    } else {
      text += static_cast<char>(0xE0 | c >> 12);
      text += static_cast<char>(0x80 | (c >> 6 & 0x3F));
      text += static_cast<char>(0x80 | (c & 0x3F));
    }
    out[glyph] = text;
  }
  return out;
}

/// The texts of a page, one a line, in the order in which they are drawn.
inline std::string texts(const std::string& content, const std::vector<ToUnicode>& maps) {
  std::string out;
  std::size_t font = 0;
  for (std::size_t i = 0; i + 2 < content.size(); ++i) {
    if (content.compare(i, 2, "/F") == 0) font = static_cast<std::size_t>(content[i + 2] - '1');
    if (content.compare(i, 3, "ET\n") == 0) out += '\n';
    if (content[i] != '(') continue;
    std::string bytes;
    for (++i; i < content.size() && content[i] != ')'; ++i) {
      if (content[i] == '\\')
        ++i, bytes += content[i] == 'r' ? '\r' : content[i];
      else
        bytes += content[i];
    }
    for (std::size_t k = 0; k + 1 < bytes.size(); k += 2) {
      const unsigned glyph =
          static_cast<unsigned char>(bytes[k]) << 8 | static_cast<unsigned char>(bytes[k + 1]);
      const ToUnicode& map = maps.at(font);
      const auto it = map.find(glyph);
      out += it == map.end() ? "\uFFFD" : it->second;
    }
  }
  return out;
}

struct PdfText {
  std::vector<std::string> pages;
  std::string all() const {
    std::string out;
    for (const auto& page : pages) out += page;
    return out;
  }
};

/// Of the PDFs that this project writes: fonts in the order of their names; pages in order.
inline PdfText read_pdf(const std::string& pdf) {
  std::vector<ToUnicode> maps;
  std::vector<std::string> contents;
  for (const std::string& stream : streams(pdf))
    if (stream.find("begincmap") != std::string::npos)
      maps.push_back(to_unicode(stream));
    else if (stream.find("BT ") != std::string::npos)
      contents.push_back(stream);
  PdfText out;
  if (maps.size() < 2) return out;
  for (const std::string& content : contents) out.pages.push_back(texts(content, maps));
  return out;
}

}  // namespace nonio::fixtures
