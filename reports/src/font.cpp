// SPDX-License-Identifier: Apache-2.0
#include "nonio/reports/font.h"

#include <algorithm>
#include <numeric>

#include "font_reader.h"
#include "font_subset.h"
#include "nonio/pdf/bytes.h"

namespace nonio::reports {
namespace {

bool read_cmap(const FontReader& r, std::size_t cmap, std::vector<std::uint16_t>& glyphs) {
  const std::size_t count = r.u16(cmap + 2);
  for (std::size_t i = 0; i < count; ++i) {
    const std::size_t record = cmap + 4 + 8 * i;
    const std::size_t at = cmap + r.u32(record + 4);
    const bool unicode = r.u16(record) == 0 || (r.u16(record) == 3 && r.u16(record + 2) == 1);
    if (!unicode || r.u16(at) != 4) continue;
    const std::size_t segments = r.u16(at + 6) / 2;
    for (std::size_t s = 0; s < segments; ++s) {
      const std::uint32_t last = r.u16(at + 14 + 2 * s);
      const std::size_t first_at = at + 16 + 2 * segments + 2 * s;
      const std::uint32_t first = r.u16(first_at);
      const std::uint32_t delta = r.u16(first_at + 2 * segments);
      const std::size_t range_at = first_at + 4 * segments;
      const std::uint32_t range = r.u16(range_at);
      for (std::uint32_t c = first; c <= last && c != 0xFFFF && r.ok(); ++c) {
        std::uint32_t glyph =
            range == 0 ? c : r.u16(range_at + range + std::size_t{2} * (c - first));
        if (glyph != 0 || range == 0) glyph = (glyph + delta) & 0xFFFF;
        if (glyph == 0) continue;
        if (c >= glyphs.size()) glyphs.resize(c + 1);
        glyphs[c] = static_cast<std::uint16_t>(glyph);
      }
    }
    return r.ok();
  }
  return false;
}

void append_hex(std::string& out, std::uint32_t value) {
  constexpr char digits[] = "0123456789ABCDEF";
  for (int shift = 12; shift >= 0; shift -= 4) out += digits[value >> shift & 15];
}

/// Glyph of the font by glyph number in the document, or no_glyph.
using Numbers = std::vector<int>;
constexpr int no_glyph = -1;

/// The minus sign maps to "-", so that copied numbers are valid.
std::string to_unicode(const Font& font, const Numbers& numbers) {
  std::vector<std::uint16_t> character(font.advance.size());
  for (std::size_t c = font.glyphs.size(); c-- > 0;)
    if (font.glyphs[c] < character.size())
      character[font.glyphs[c]] = static_cast<std::uint16_t>(c);
  constexpr std::size_t minus = 0x2212;
  if (minus < font.glyphs.size() && font.glyphs[minus] != 0) character[font.glyphs[minus]] = u'-';
  std::vector<std::string> lines;
  for (std::size_t n = 1; n < numbers.size(); ++n) {
    const std::uint32_t c =
        numbers[n] == no_glyph ? 0U : character[static_cast<unsigned>(numbers[n])];
    if (c == 0) continue;
    std::string line = "<";
    append_hex(line, static_cast<std::uint32_t>(n));
    line += "> <";
    append_hex(line, c);
    lines.push_back(line + ">\n");
  }
  std::string out =
      "/CIDInit /ProcSet findresource begin\n12 dict begin\nbegincmap\n"
      "/CIDSystemInfo << /Registry (Adobe) /Ordering (UCS) /Supplement 0 >> def\n"
      "/CMapName /Adobe-Identity-UCS def\n/CMapType 2 def\n"
      "1 begincodespacerange\n<0000> <FFFF>\nendcodespacerange\n";
  constexpr std::size_t most = 100;  // entries per block (CMap specification)
  for (std::size_t i = 0; i < lines.size(); i += most) {
    const std::size_t n = std::min(most, lines.size() - i);
    pdf::append_int(out, static_cast<long long>(n));
    out += " beginbfchar\n";
    for (std::size_t k = i; k < i + n; ++k) out += lines[k];
    out += "endbfchar\n";
  }
  return out + "endcmap\nCMapName currentdict /CMap defineresource pop\nend\nend\n";
}

/// The W array, by ranges: [0 [365 278 ...] 97 [556]].
std::string widths_array(const std::vector<std::uint16_t>& advance, const Numbers& numbers) {
  std::string out = "[";
  for (std::size_t n = 0; n < numbers.size(); ++n) {
    if (numbers[n] == no_glyph) continue;
    if (n == 0 || numbers[n - 1] == no_glyph) {
      pdf::append_int(out, static_cast<long long>(n));
      out += " [";
    }
    pdf::append_int(out, advance[static_cast<unsigned>(numbers[n])]);
    out += n + 1 < numbers.size() && numbers[n + 1] != no_glyph ? ' ' : ']';
  }
  return out + "]";
}

std::string subset_name(std::string_view bytes, std::string_view path) {
  std::uint64_t hash = 1469598103934665603U;  // FNV-1a, 64 bits
  for (const char c : bytes) hash = (hash ^ static_cast<unsigned char>(c)) * 1099511628211U;
  std::string name;
  for (int i = 0; i < 6; ++i, hash /= 26) name += static_cast<char>('A' + hash % 26);
  name += '+';
  path = path.substr(path.find_last_of('/') + 1);
  for (const char c : path.substr(0, path.find_last_of('.')))
    if ((c >= '0' && c <= '9') || (c >= 'A' && c <= 'Z') || (c >= 'a' && c <= 'z') || c == '-')
      name += c;
  return name.substr(0, 100);
}

bool is_common(std::size_t c) {
  constexpr std::u16string_view signs =
      u"\u2013\u2014\u2018\u2019\u201C\u201D\u201E\u2022\u2026"
      u"\u2190\u2191\u2192\u2193\u2212\u2248\u2264\u2265";
  return (c >= 0x20 && c < 0x7F) || (c > 0xA0 && c <= 0xFF) ||
         signs.find(static_cast<char16_t>(c)) != std::u16string_view::npos;
}

pdf::EmbeddedFont embedded(const Font& font, std::string_view file, const Numbers& numbers,
                           int level) {
  return {subset_name(file, font.name), file.size(), pdf::deflated(file, level),
          widths_array(font.advance, numbers), pdf::deflated(to_unicode(font, numbers), level)};
}

// Each process does it anew: the levels above take four times as long and save 1 %.
constexpr int once_level = 9;

void compress(Font& font) {
  const std::string subset = font_subset(font.bytes, font.common);
  if (subset.empty()) {
    font.with_common = with_all(font);
    return;
  }
  Numbers common;
  for (std::size_t g = 0; g < font.common.size(); ++g)
    common.push_back(font.common[g] != 0 ? static_cast<int>(g) : no_glyph);
  font.with_common = embedded(font, subset, common, once_level);
}

std::string_view directory_of(std::string_view font) {
  return font.substr(0, 12 + 16 * std::size_t{FontReader(font).u16(4)});
}

/// The bytes that the font refers to may be gone, so that only `file` is read.
bool same_font(const Font& font, FontFile file) {
  return font.name == file.name && font.bytes.data() == file.bytes.data() &&
         font.bytes.size() == file.bytes.size() && font.directory == directory_of(file.bytes);
}

}  // namespace

const pdf::EmbeddedFont& with_all(const Font& font) {
  std::call_once(font.whole->made, [&] {
    Numbers all(font.common.size());
    std::iota(all.begin(), all.end(), 0);
    font.whole->embedded = embedded(font, font.bytes, all, once_level);
  });
  return font.whole->embedded;
}

pdf::EmbeddedFont embedded_part(const Font& font, const std::vector<std::uint16_t>& glyphs) {
  constexpr int level = 1;
  const std::string part = font_part(font.bytes, glyphs);
  return part.empty() ? pdf::EmbeddedFont{}
                      : embedded(font, part, Numbers(glyphs.begin(), glyphs.end()), level);
}

Expected<Font> parse_font(FontFile file) {
  const FontReader r(file.bytes);
  const auto broken = [&](std::string_view why) {
    return fail(
        Error{"a TrueType font was expected, but " + std::string(why), std::string(file.name)});
  };
  if (r.u32(0) != 0x00010000) return broken("the file does not begin as one");
  const auto head = r.table("head"), hhea = r.table("hhea"), hmtx = r.table("hmtx");
  const auto cmap = r.table("cmap"), maxp = r.table("maxp");
  if (!head || !hhea || !hmtx || !cmap || !maxp || !r.table("glyf") || !r.table("loca"))
    return broken("a table of it is missing");
  const double units = r.u16(*head + 18);
  if (units < 16) return broken("its units per em are " + std::to_string(r.u16(*head + 18)));
  const auto scaled = [&](int value) {
    return static_cast<int>(value * 1000.0 / units + (value < 0 ? -0.5 : 0.5));
  };
  Font font;
  font.units = static_cast<int>(units);
  for (std::size_t i = 0; i < 4; ++i) font.box[i] = scaled(r.s16(*head + 36 + 2 * i));
  font.ascent = scaled(r.s16(*hhea + 4));
  font.descent = scaled(r.s16(*hhea + 6));
  font.cap_height = font.ascent * 8 / 10;
  if (const auto os2 = r.table("OS/2"); os2 && r.u16(*os2) >= 2)
    font.cap_height = scaled(r.s16(*os2 + 88));
  const std::size_t glyphs = r.u16(*maxp + 4), metrics = r.u16(*hhea + 34);
  if (metrics == 0 || metrics > glyphs) return broken("its widths are not those of its glyphs");
  for (std::size_t g = 0; g < glyphs; ++g)
    font.advance.push_back(static_cast<std::uint16_t>(
        scaled(static_cast<int>(r.u16(*hmtx + 4 * std::min(g, metrics - 1))))));
  if (!read_cmap(r, *cmap, font.glyphs)) return broken("it has no Unicode cmap of format 4");
  if (!r.ok()) return broken("the file ends early");
  for (std::uint16_t& g : font.glyphs)
    if (g >= glyphs) g = 0;
  font.common.assign(glyphs, 0);
  font.common[0] = 1;
  for (std::size_t c = 0; c < font.glyphs.size(); ++c)
    if (is_common(c)) font.common[font.glyphs[c]] = 1;
  font.name = file.name;
  font.bytes = file.bytes;
  font.directory = directory_of(file.bytes);
  return font;
}

Expected<std::shared_ptr<const Fonts>> shared_fonts(FontFile regular, FontFile bold,
                                                    FontFile wide) {
  struct Memo {
    std::mutex mutex;
    std::shared_ptr<const Fonts> fonts;
  };
  static Memo memo;
  const std::lock_guard lock(memo.mutex);
  if (memo.fonts && same_font(memo.fonts->regular, regular) && same_font(memo.fonts->bold, bold) &&
      same_font(memo.fonts->wide, wide))
    return memo.fonts;
  Fonts fonts;
  for (const auto& [font, file] :
       {std::pair(&fonts.regular, regular), {&fonts.bold, bold}, {&fonts.wide, wide}}) {
    if (file.bytes.empty() && font == &fonts.wide) continue;
    NONIO_TRY(auto parsed, parse_font(file));
    *font = std::move(parsed);
    if (font != &fonts.wide) compress(*font);
  }
  memo.fonts = std::make_shared<const Fonts>(std::move(fonts));
  return memo.fonts;
}

}  // namespace nonio::reports
