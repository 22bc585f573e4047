// SPDX-License-Identifier: Apache-2.0
#include "font_subset.h"

#include <algorithm>
#include <map>

#include "font_reader.h"

namespace nonio::reports {
namespace {

void put16(std::string& out, std::uint32_t value) {
  out += static_cast<char>(value >> 8 & 0xFF);
  out += static_cast<char>(value & 0xFF);
}
void put32(std::string& out, std::uint32_t value) {
  put16(out, value >> 16);
  put16(out, value & 0xFFFF);
}
void set32(std::string& out, std::size_t at, std::uint32_t value) {
  std::string bytes;
  put32(bytes, value);
  out.replace(at, 4, bytes);
}

std::uint32_t checksum(const std::string& padded) {
  const FontReader r(padded);
  std::uint32_t sum = 0;
  for (std::size_t i = 0; i < padded.size(); i += 4) sum += r.u32(i);
  return sum;
}

std::vector<char> closed(std::vector<char> kept, const FontReader& r, const Outlines& outlines) {
  std::vector<std::size_t> open;
  for (std::size_t g = 0; g < kept.size(); ++g)
    if (kept[g] != 0) open.push_back(g);
  while (!open.empty()) {
    const std::size_t glyph = open.back();
    open.pop_back();
    for (const std::size_t at : outlines.components(glyph))
      if (const std::size_t part = r.u16(at); part < kept.size() && kept[part] == 0)
        kept[part] = 1, open.push_back(part);
  }
  return kept;
}

using Tables = std::map<std::string, std::string>;

std::string joined(Tables tables) {
  const auto count = static_cast<std::uint32_t>(tables.size());
  std::uint32_t power = 1, log = 0;
  for (; 2 * power <= count; power *= 2) ++log;
  std::string out;
  put32(out, 0x00010000);
  for (const std::uint32_t v : {count, 16 * power, log, 16 * (count - power)}) put16(out, v);
  std::size_t at = 12 + 16 * tables.size(), head = 0;
  std::string bodies;
  for (auto& [tag, bytes] : tables) {
    const std::size_t size = bytes.size();
    bytes.resize((size + 3) / 4 * 4, '\0');
    if (tag == "head") head = at + bodies.size();
    out += tag;
    put32(out, checksum(bytes));
    put32(out, static_cast<std::uint32_t>(at + bodies.size()));
    put32(out, static_cast<std::uint32_t>(size));
    bodies += bytes;
  }
  out += bodies;
  set32(out, head + 8, 0xB1B0AFBA - checksum(out));
  return out;
}

Tables tables_of(std::string_view font, const FontReader& r) {
  Tables tables;
  for (const char* tag : {"head", "hhea", "hmtx", "maxp", "name", "loca", "glyf"}) {
    const auto at = r.table(tag), size = r.table_size(tag);
    if (!at || !size || *at + *size > font.size()) return {};
    if (tag != std::string_view("glyf")) tables[tag] = font.substr(*at, *size);
  }
  const std::size_t metrics = r.u16(*r.table("hhea") + 34);
  if (tables["head"].size() < 54 || tables["hmtx"].size() < 4 * metrics) return {};
  return tables;
}

std::string with_outlines(Tables tables, std::string glyf,
                          const std::vector<std::size_t>& offsets) {
  const bool halves = glyf.size() <= 0x1FFFE;
  std::string loca;
  for (const std::size_t offset : offsets)
    halves ? put16(loca, static_cast<std::uint32_t>(offset / 2))
           : put32(loca, static_cast<std::uint32_t>(offset));
  tables["glyf"] = std::move(glyf);
  tables["loca"] = std::move(loca);
  set32(tables["head"], 8, 0);
  tables["head"][50] = '\0';
  tables["head"][51] = halves ? '\0' : '\1';
  return joined(std::move(tables));
}

}  // namespace

std::string font_subset(std::string_view font, const std::vector<char>& glyphs) {
  const FontReader r(font);
  Tables tables = tables_of(font, r);
  if (tables.empty()) return {};
  const std::size_t metrics = r.u16(*r.table("hhea") + 34);
  const Outlines outlines(r, *r.table("head"), *r.table("loca"), *r.table("glyf"));
  const std::vector<char> kept = closed(glyphs, r, outlines);
  std::string glyf;
  std::vector<std::size_t> offsets;
  for (std::size_t g = 0; g < kept.size(); ++g) {
    offsets.push_back(glyf.size());
    if (kept[g] != 0)
      glyf += font.substr(std::min(outlines.begin(g), font.size()), outlines.size(g));
    if (glyf.size() % 2 != 0) glyf += '\0';
    if (kept[g] == 0 && g < metrics) tables["hmtx"].replace(4 * g, 4, 4, '\0');
  }
  offsets.push_back(glyf.size());
  return r.ok() ? with_outlines(std::move(tables), std::move(glyf), offsets) : std::string();
}

std::string font_part(std::string_view font, std::vector<std::uint16_t> glyphs) {
  const FontReader r(font);
  Tables tables = tables_of(font, r);
  if (tables.empty() || tables["hhea"].size() < 36 || tables["maxp"].size() < 6) return {};
  const std::size_t metrics = r.u16(*r.table("hhea") + 34), widths = *r.table("hmtx");
  const Outlines outlines(r, *r.table("head"), *r.table("loca"), *r.table("glyf"));
  std::vector<std::uint16_t> number(r.u16(*r.table("maxp") + 4));
  for (std::size_t n = 0; n < glyphs.size(); ++n)
    if (glyphs[n] < number.size()) number[glyphs[n]] = static_cast<std::uint16_t>(n);
  std::string glyf, hmtx;
  std::vector<std::size_t> offsets;
  for (std::size_t n = 0; n < glyphs.size(); ++n) {
    const std::size_t g = glyphs[n], begin = std::min(outlines.begin(g), font.size());
    offsets.push_back(glyf.size());
    std::string outline(font.substr(begin, outlines.size(g)));
    for (const std::size_t at : outlines.components(g)) {
      const std::size_t part = r.u16(at);
      if (part >= number.size() || at + 2 > begin + outline.size()) return {};
      if (number[part] == 0 && part != glyphs[0]) {
        number[part] = static_cast<std::uint16_t>(glyphs.size());
        glyphs.push_back(static_cast<std::uint16_t>(part));
      }
      outline[at - begin] = static_cast<char>(number[part] >> 8);
      outline[at - begin + 1] = static_cast<char>(number[part] & 0xFF);
    }
    glyf += outline;
    if (glyf.size() % 2 != 0) glyf += '\0';
    put16(hmtx, r.u16(widths + 4 * std::min(g, metrics - 1)));
    put16(hmtx, r.u16(widths + (g < metrics ? 4 * g + 2 : 2 * (g + metrics))));
  }
  offsets.push_back(glyf.size());
  if (!r.ok()) return {};
  std::string count;
  put16(count, static_cast<std::uint32_t>(glyphs.size()));
  tables["hmtx"] = std::move(hmtx);
  tables["hhea"].replace(34, 2, count);
  tables["maxp"].replace(4, 2, count);
  return with_outlines(std::move(tables), std::move(glyf), offsets);
}

}  // namespace nonio::reports
