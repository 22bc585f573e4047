// SPDX-License-Identifier: Apache-2.0
//
// write_scripts FOLDER: a page in each script, and the same pages with a part of a letter lost, for
// tests/external/pages.
#include <iostream>
#include <map>

#include "fixtures.h"
#include "font_reader.h"
#include "nonio/reports/document.h"

namespace {

using namespace nonio;
using namespace nonio::reports;

Document page(const std::string& language, const std::vector<std::string>& lines,
              const std::string& paragraph) {
  Document document;
  document.style.page_width = 260;
  document.style.page_height = 190;
  document.style.left = document.style.right = document.style.top = document.style.bottom = 10;
  document.language = language;
  document.title = lines[0];
  document.foot = lines[1];
  document.blocks = {{Heading{lines[0], 0}}, {Heading{lines[1]}}, {Paragraph{paragraph}}};
  Grid grid;
  for (const std::string& line : lines) grid.rows.push_back({line, line, "line"});
  document.blocks.push_back({grid});
  return document;
}

std::vector<std::pair<std::string, Document>> pages() {
  const std::vector<std::string> chinese = {"校准证书", "哈尔滨精密机床（集团）有限公司"},
                                 greek = {"Ψηφιακή Ώθηση", "Ταΰγετος, ΐ Ό Ή, Κ. Παπαΐωάννου"},
                                 cyrillic = {"Шара́пова Ёлка", "Їжак, Ѐ Ѝ й ї, Ўзда́, Б́"};
  return {
      {"zh", page("zh", chinese,
                  "在重复性条件下，用激光干涉仪对每个目标位置双向趋近五次（GB/T 17421.2）；"
                  "扩展不确定度U的包含因子k = 2。反向差值为4.2 µm，双向定位精度为12.7 µm。")},
      {"el", page("el", greek, "Οι μετρήσεις έγιναν με συμβολόμετρο λέιζερ: ά έ ή ί ό ύ ώ ϊ ϋ.")},
      {"ru", page("ru", cyrillic, "Измере́ния вы́полнены ла́зерным интерферо́метром: и́ ы́ э́ ю́ я́ Я́.")}};
}

/// The first part that a glyph is composed of becomes an empty one.
void lose_part(const Font& font, std::string& bytes, char32_t c, std::uint16_t empty) {
  const FontReader r(bytes);
  const Outlines outlines(r, *r.table("head"), *r.table("loca"), *r.table("glyf"));
  const std::size_t at = outlines.begin(font.glyph(c)) + 12;
  if (outlines.components(font.glyph(c)).empty()) return;
  bytes[at] = static_cast<char>(empty >> 8);
  bytes[at + 1] = static_cast<char>(empty & 0xFF);
}

/// Once in the smallest letters of the page.
Document without(Document document, const std::string& letter, const std::string& other) {
  std::string& text = std::get<Paragraph>(document.blocks[2].what).text;
  std::string& small = std::get<Grid>(document.blocks[3].what).rows[1].value;
  std::string& where = small.find(letter) != std::string::npos ? small : text;
  where.replace(where.find(letter), letter.size(), other);
  return document;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 2) return std::cerr << "usage: write_scripts FOLDER\n", 2;
  const std::filesystem::path folder = argv[1];
  const Templates templates = fixtures::read_templates(NONIO_TEMPLATES);
  const auto file = [&](const char* name) {
    return FontFile{templates.files.at(std::string("fonts/") + name + ".ttf"), name};
  };
  const auto fonts = shared_fonts(file("LiberationSans-Regular"), file("LiberationSans-Bold"),
                                  file("DroidSansFallback"));
  if (!fonts) return std::cerr << fonts.error().message << '\n', 1;
  const auto write = [&](const std::string& name, const Document& document, const Fonts& with) {
    const auto bytes = pdf_bytes(document, with);
    if (!bytes) return std::cerr << bytes.error().message << '\n', false;
    std::ofstream(folder / (name + ".pdf"), std::ios::binary) << *bytes;
    return true;
  };
  std::map<std::string, Document> all;
  for (auto& [name, document] : pages()) {
    if (!write(name, document, **fonts)) return 1;
    all[name] = std::move(document);
  }
  Fonts broken = **fonts;
  std::string bytes(broken.wide.bytes);
  for (const char32_t c : U"校准证书")
    lose_part(broken.wide, bytes, c, broken.wide.glyph(U'\u3000'));
  broken.wide.bytes = bytes;
  return write("zh-lost-parts", all["zh"], broken) &&
                 write("el-lost-tonos", without(all["el"], "ύ", "υ"), **fonts) &&
                 write("ru-lost-accent", without(all["ru"], "а\u0301", "а"), **fonts)
             ? 0
             : 1;
}
